# cmake -DOUTPUT=embedded_files.cpp -P embed-files.cmake FILE...: files that were built from web/ as a unit of C++.
set(arrays "")
set(rows "")
set(count 0)
set(is_file OFF)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE ${last})
  set(file "${CMAKE_ARGV${i}}")
  if(NOT is_file)
    if(file MATCHES "embed-files\\.cmake$")
      set(is_file ON)
    endif()
    continue()
  endif()
  get_filename_component(name "${file}" NAME)
  file(READ "${file}" bytes HEX)
  if(name STREQUAL "view.html")
    string(FIND "${bytes}" "3c212d2d646174612d2d3e" place)  # <!--data-->
    if(place EQUAL -1)
      message(FATAL_ERROR "${file} is not a built page of aerate: it has no place for data")
    endif()
  endif()
  if(bytes STREQUAL "")
    message(FATAL_ERROR "${file} is empty")
  endif()
  string(REGEX REPLACE "(................................................................)" "\\1\n" bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr unsigned char kFile${count}[] = {\n${bytes}\n};\n\n")
  string(APPEND rows "\n    {\"${name}\", {reinterpret_cast<const char*>(kFile${count}), sizeof kFile${count}}},")
  math(EXPR count "${count} + 1")
endforeach()
file(WRITE "${OUTPUT}.new" "// Made from built files (cmake/embed-files.cmake).
#include <vector>

#include \"view/embedded_files.h\"

namespace aerate {
namespace {

${arrays}}  // namespace

std::span<const EmbeddedFile> embedded_files() {
  static const std::vector<EmbeddedFile> kFiles{${rows}
  };
  return kFiles;
}

}  // namespace aerate
")
file(RENAME "${OUTPUT}.new" "${OUTPUT}")
