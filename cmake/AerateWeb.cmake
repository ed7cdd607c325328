# The page of --view and the studio's files: those that are given, or built from web/ where node and npm are there. Without them
# the program builds, and says what was missing.

set(AERATE_VIEW_PAGE "" CACHE FILEPATH
  "The built page of --view, as a release archive has it, with the studio's files beside it (default: web/built/view.html, or made from web/)")

set(aerate_web "${PROJECT_SOURCE_DIR}/web")
set(aerate_studio_files studio.html studio.js studio.css)
set(aerate_built_files "")
set(aerate_built_studio "")
set(aerate_why_no_page "")
set(aerate_builds_page OFF)

# The page and what of the studio's files is beside it.
function(aerate_take_built page)
  get_filename_component(folder "${page}" DIRECTORY)
  set(files "${page}")
  foreach(name ${aerate_studio_files})
    if(EXISTS "${folder}/${name}")
      list(APPEND files "${folder}/${name}")
    endif()
  endforeach()
  set(aerate_built_files "${files}" PARENT_SCOPE)
endfunction()

if(AERATE_VIEW_PAGE)
  if(NOT EXISTS "${AERATE_VIEW_PAGE}")
    message(FATAL_ERROR "AERATE_VIEW_PAGE: there is no ${AERATE_VIEW_PAGE}")
  endif()
  get_filename_component(page "${AERATE_VIEW_PAGE}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
  aerate_take_built("${page}")
elseif(EXISTS "${aerate_web}/built/view.html")
  aerate_take_built("${aerate_web}/built/view.html")
elseif(AERATE_BUILD_FUZZERS)
  set(aerate_why_no_page "fuzzers have no use for it")
else()
  # Quick, and without network, once the packages of the lock file are there.
  execute_process(COMMAND "${PROJECT_SOURCE_DIR}/scripts/web-packages"
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(result EQUAL 0)
    set(aerate_built_files "${PROJECT_BINARY_DIR}/web/view.html")
    if(EXISTS "${aerate_web}/studio.html")
      list(TRANSFORM aerate_studio_files PREPEND "${PROJECT_BINARY_DIR}/web/" OUTPUT_VARIABLE aerate_built_studio)
      list(APPEND aerate_built_files ${aerate_built_studio})
    endif()
    set(aerate_builds_page ON)
  else()
    string(REGEX REPLACE ".*\n" "" aerate_why_no_page "${output}")  # its last line
  endif()
endif()
if(aerate_why_no_page)
  message(STATUS "The page of --view and the studio are left out: ${aerate_why_no_page}")
endif()

# aerate_embed_built_files(LIBRARY): these as a unit of C++, or none, and why there are none.
function(aerate_embed_built_files library)
  string(REGEX REPLACE "[\"\\\\]" "'" why "${aerate_why_no_page}")
  set_source_files_properties(built_files.cpp PROPERTIES COMPILE_DEFINITIONS "AERATE_WHY_NO_PAGE=\"${why}\"")
  if(aerate_builds_page)
    file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${aerate_web}/src/*")
    file(GLOB settings CONFIGURE_DEPENDS "${aerate_web}/*.ts" "${aerate_web}/*.html")
    set(sources ${sources} ${settings} "${aerate_web}/package.json" "${aerate_web}/package-lock.json")
    set(vite "${CMAKE_COMMAND}" -E env "AERATE_WEB_OUT=${PROJECT_BINARY_DIR}/web"
      node node_modules/vite/bin/vite.js build --logLevel warn)
    add_custom_command(OUTPUT "${PROJECT_BINARY_DIR}/web/view.html" COMMAND ${vite}
      WORKING_DIRECTORY "${aerate_web}" DEPENDS ${sources} COMMENT "Building the page of --view" VERBATIM)
    if(aerate_built_studio)
      add_custom_command(OUTPUT ${aerate_built_studio} COMMAND ${vite} --mode studio
        WORKING_DIRECTORY "${aerate_web}" DEPENDS ${sources} COMMENT "Building the studio" VERBATIM)
    endif()
  endif()
  set(unit "${CMAKE_CURRENT_BINARY_DIR}/embedded_files.cpp")
  set(embed "${PROJECT_SOURCE_DIR}/cmake/embed-files.cmake")
  add_custom_command(OUTPUT "${unit}"
    COMMAND "${CMAKE_COMMAND}" "-DOUTPUT=${unit}" -P "${embed}" ${aerate_built_files}
    DEPENDS ${aerate_built_files} "${embed}" VERBATIM)
  target_sources(${library} PRIVATE "${unit}")
endfunction()
