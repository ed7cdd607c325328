# cmake -DPAGE=view.html -DOUTPUT=page_template.cpp -P embed-page.cmake: the page as a unit of C++.
file(READ "${PAGE}" bytes HEX)
string(FIND "${bytes}" "3c212d2d646174612d2d3e" place)  # <!--data-->
if(place EQUAL -1)
  message(FATAL_ERROR "${PAGE} is not a built page of aerate: it has no place for data")
endif()
string(REGEX REPLACE "(................................................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE "${OUTPUT}.new" "// Made from a built page (cmake/embed-page.cmake).
#include \"view/page_template.h\"

namespace aerate {
namespace {

constexpr unsigned char kPage[] = {
${bytes}
};

}  // namespace

std::optional<std::string_view> page_template() {
  return std::string_view(reinterpret_cast<const char*>(kPage), sizeof kPage);
}

std::string_view why_no_page() {
  return \"\";
}

}  // namespace aerate
")
file(RENAME "${OUTPUT}.new" "${OUTPUT}")
