# Run by CPack between installing and packing: files as Debian's policy wants them. Their dates are those of SOURCE_DATE_EPOCH, where
# that is set.
set(share "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr/share")
set(doc "${share}/doc/${CPACK_PACKAGE_NAME}")

function(compress)
  execute_process(COMMAND gzip -9n ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(GLOB pages "${share}/man/man1/*.1")
compress(${pages})

string(TIMESTAMP day "%d %b %Y %H:%M:%S" UTC)
string(TIMESTAMP weekday "%a" UTC)
file(WRITE "${doc}/changelog.Debian"
"${CPACK_PACKAGE_NAME} (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Packed from the sources of ${CPACK_PACKAGE_VERSION}; changelog.gz has what changed in them.

 -- ${CPACK_PACKAGE_CONTACT}  ${weekday}, ${day} +0000
")
file(RENAME "${doc}/CHANGELOG.md" "${doc}/changelog")
compress("${doc}/changelog.Debian" "${doc}/changelog")
file(REMOVE "${doc}/LICENSE")  # Debian has that text once for all packages
file(COPY_FILE "${CPACK_AERATE_PACKAGING}/debian-copyright" "${doc}/copyright")

# Where Debian's zsh looks for what packages bring.
file(RENAME "${share}/zsh/site-functions" "${share}/zsh/vendor-completions")

file(CHMOD "${doc}/copyright" "${doc}/changelog.gz" "${doc}/changelog.Debian.gz"
  PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
