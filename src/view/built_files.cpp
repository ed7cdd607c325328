#include "view/built_files.h"

#include "view/embedded_files.h"

namespace aerate {

std::optional<std::string_view> built_file(std::string_view name) {
  for (const EmbeddedFile& file : embedded_files())
    if (file.name == name) return file.bytes;
  return std::nullopt;
}

std::string why_no_built_file(std::string_view name) {
  constexpr char kWhy[] = AERATE_WHY_NO_PAGE;
  return sizeof kWhy == 1 ? "what it was built with has no " + std::string(name) : kWhy;
}

}  // namespace aerate
