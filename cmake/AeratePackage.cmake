# CPack: the Debian package (cpack -G DEB in a build tree of the preset "package"; scripts/release does it). What Debian keeps elsewhere
# than other systems is put there by debian-files.cmake.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME aerate)
set(CPACK_PACKAGE_VENDOR "aerate maintainers")
set(CPACK_PACKAGE_CONTACT "aerate maintainers <maintainers@users.noreply.github.com>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "hollows printable models by packed voids")
set(CPACK_PACKAGE_DESCRIPTION
"Makes a 3D-printable model need less material: packs disjoint spheres, or
the cells round them, inside it, removes them as internal voids, and writes a
watertight model that any slicer accepts, with figures measured on the
written file. Limits of the printer are kept exactly; resin and powder run
out through channels and escape holes.
.
It reads STL, 3MF, OBJ, PLY, OFF, GLB, glTF and 3DS and writes STL, 3MF, OBJ
and PLY. It comes with a command line, a studio in the browser, batches
for many models, and with modifiers and a post-processing hook for slicers.")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")

set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # the packages of the libraries that the program is linked to
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "xdg-utils")  # opens the studio in the browser
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "prusa-slicer")
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/cmake/debian-files.cmake")
set(CPACK_AERATE_PACKAGING "${PROJECT_SOURCE_DIR}/packaging")  # for that script

# The Python module is for the interpreter of one version. Who has no use for it needs none.
if(TARGET aerate_python)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  string(APPEND CPACK_DEBIAN_PACKAGE_RECOMMENDS ", python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR})"
    ", python3 (<< ${Python_VERSION_MAJOR}.${next_minor}), python3-numpy")
  foreach(script postinst prerm)
    configure_file("packaging/debian-${script}" "${PROJECT_BINARY_DIR}/debian/${script}" COPYONLY)
    list(APPEND CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA "${PROJECT_BINARY_DIR}/debian/${script}")
  endforeach()
endif()
include(CPack)
