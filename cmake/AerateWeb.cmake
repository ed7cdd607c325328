# The page of --view: one that is given, or built from web/ where node and npm are there. Without one the program builds,
# and says what was missing.

set(AERATE_VIEW_PAGE "" CACHE FILEPATH
  "The built page of --view, as a release archive has it (default: web/built/view.html, or made from web/)")

set(aerate_web "${PROJECT_SOURCE_DIR}/web")
set(aerate_page "")
set(aerate_why_no_page "")
set(aerate_builds_page OFF)

if(AERATE_VIEW_PAGE)
  if(NOT EXISTS "${AERATE_VIEW_PAGE}")
    message(FATAL_ERROR "AERATE_VIEW_PAGE: there is no ${AERATE_VIEW_PAGE}")
  endif()
  get_filename_component(aerate_page "${AERATE_VIEW_PAGE}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
elseif(EXISTS "${aerate_web}/built/view.html")
  set(aerate_page "${aerate_web}/built/view.html")
elseif(AERATE_BUILD_FUZZERS)
  set(aerate_why_no_page "fuzzers have no use for it")
else()
  # Quick, and without network, once the packages of the lock file are there.
  execute_process(COMMAND "${PROJECT_SOURCE_DIR}/scripts/web-packages"
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(result EQUAL 0)
    set(aerate_page "${PROJECT_BINARY_DIR}/web/view.html")
    set(aerate_builds_page ON)
  else()
    string(REGEX REPLACE ".*\n" "" aerate_why_no_page "${output}")  # its last line
  endif()
endif()
if(aerate_why_no_page)
  message(STATUS "The page of --view is left out: ${aerate_why_no_page}")
endif()

# aerate_add_page(LIBRARY): the page as a unit of C++, or one that says why there is none.
function(aerate_add_page library)
  if(NOT aerate_page)
    string(REGEX REPLACE "[\"\\\\]" "'" why "${aerate_why_no_page}")
    set_source_files_properties(no_page.cpp PROPERTIES COMPILE_DEFINITIONS "AERATE_WHY_NO_PAGE=\"${why}\"")
    target_sources(${library} PRIVATE no_page.cpp)
    return()
  endif()
  if(aerate_builds_page)
    file(GLOB sources CONFIGURE_DEPENDS "${aerate_web}/*.ts" "${aerate_web}/src/*")
    add_custom_command(OUTPUT "${aerate_page}"
      COMMAND "${CMAKE_COMMAND}" -E env "AERATE_WEB_OUT=${PROJECT_BINARY_DIR}/web"
        node node_modules/vite/bin/vite.js build --logLevel warn
      WORKING_DIRECTORY "${aerate_web}"
      DEPENDS ${sources} "${aerate_web}/view.html" "${aerate_web}/package-lock.json"
      COMMENT "Building the page of --view" VERBATIM)
  endif()
  set(unit "${CMAKE_CURRENT_BINARY_DIR}/page_template.cpp")
  set(embed "${PROJECT_SOURCE_DIR}/cmake/embed-page.cmake")
  add_custom_command(OUTPUT "${unit}"
    COMMAND "${CMAKE_COMMAND}" "-DPAGE=${aerate_page}" "-DOUTPUT=${unit}" -P "${embed}"
    DEPENDS "${aerate_page}" "${embed}" VERBATIM)
  target_sources(${library} PRIVATE "${unit}")
endfunction()
