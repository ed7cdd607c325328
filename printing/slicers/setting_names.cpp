#include "printing/slicers/setting_names.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "printing/slicers/gcode.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

// Letters put in, left out or exchanged that make one word of another.
std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

// "print_settings_id", "inherits_cummulative", "compatible_printers_condition" and the like.
bool says_where_from(std::string_view name) {
  return name.ends_with("_settings_id") || name.starts_with("inherits") || name.starts_with("compatible_");
}

}  // namespace

std::string_view nearest_name(std::string_view word, const std::vector<std::string_view>& names) {
  constexpr std::size_t kSlips = 2, kLongest = 64;
  if (word.size() > kLongest) return {};
  const auto found =
      std::ranges::find_if(names, [&](std::string_view name) { return edits_between(word, name) <= kSlips; });
  return found == names.end() ? std::string_view() : *found;
}

SettingNames names_in(std::string_view plain_lines, const std::set<std::string, std::less<>>& known) {
  SettingNames names;
  for_each_line(plain_lines, [&](std::string_view line) {
    const auto setting = setting_in_line(line);
    if (!setting || says_where_from(setting->key)) return true;
    if (known.contains(setting->key)) {
      ++names.known;
    } else {
      names.unknown.emplace_back(setting->key);
    }
    return true;
  });
  return names;
}

}  // namespace aerate
