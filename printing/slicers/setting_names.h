#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace aerate {

// The one of `names` that a word is but for a slip or two; empty if none is.
std::string_view nearest_name(std::string_view word, const std::vector<std::string_view>& names);

// The names in plain lines "key = value" that are not among those known.
struct SettingNames {
  std::size_t known = 0;  // how many are
  std::vector<std::string> unknown;
};

// Names that say where settings come from, and are none themselves, count as neither.
SettingNames names_in(std::string_view plain_lines, const std::set<std::string, std::less<>>& known);

}  // namespace aerate
