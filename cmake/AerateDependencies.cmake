# Everything comes from the system's packages; scripts/install-dependencies names them for Debian.

find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(assimp REQUIRED)
find_package(CGAL 5.5 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(fmt REQUIRED)
find_package(pugixml REQUIRED)
find_package(EXPAT REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)

# Not through libzip's own CMake files: Debian's refer to tools of three further packages.
find_path(LIBZIP_INCLUDE_DIR zip.h REQUIRED)
find_library(LIBZIP_LIBRARY zip REQUIRED)
add_library(libzip::zip UNKNOWN IMPORTED)
set_target_properties(libzip::zip PROPERTIES
  IMPORTED_LOCATION "${LIBZIP_LIBRARY}"
  INTERFACE_INCLUDE_DIRECTORIES "${LIBZIP_INCLUDE_DIR}")

# Its header has to be compiled as its library was: Debian's pkg-config file says how.
find_package(PkgConfig REQUIRED)
pkg_check_modules(cpp-httplib REQUIRED IMPORTED_TARGET cpp-httplib)
add_library(cpp-httplib::cpp-httplib ALIAS PkgConfig::cpp-httplib)

# Debian keeps OpenVDB's find module beside the library instead of on CMake's path.
if(NOT OpenVDB_FOUND)
  list(APPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
  find_package(OpenVDB REQUIRED)
endif()

if(AERATE_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()
