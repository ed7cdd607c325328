#include "view/page_template.h"

namespace aerate {

std::optional<std::string_view> page_template() {
  return std::nullopt;
}

std::string_view why_no_page() {
  return AERATE_WHY_NO_PAGE;
}

}  // namespace aerate
