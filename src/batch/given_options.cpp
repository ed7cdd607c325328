#include "batch/given_options.h"

#include <algorithm>

namespace aerate::batch {

const OptionRule* find_rule(std::span<const OptionRule> rules, std::string_view name) {
  const auto found = std::ranges::find(rules, name, &OptionRule::name);
  return found == rules.end() ? nullptr : &*found;
}

std::vector<GivenOption> merged(std::span<const OptionRule> rules, const std::vector<GivenOption>& shared,
                                const std::vector<GivenOption>& own) {
  std::vector<GivenOption> options;
  options.reserve(shared.size() + own.size());
  for (const OptionRule& rule : rules) {
    auto given = std::ranges::find(own, rule.name, &GivenOption::name);
    if (given == own.end()) {
      given = std::ranges::find(shared, rule.name, &GivenOption::name);
      if (given == shared.end()) continue;
    }
    if (!given->is_off || rule.may_be_off) options.push_back(*given);
  }
  return options;
}

std::vector<std::string> arguments_of(const std::vector<GivenOption>& options) {
  std::vector<std::string> arguments;
  arguments.reserve(options.size());
  for (const GivenOption& option : options) {
    if (option.values.empty()) arguments.push_back((option.is_off ? "--no-" : "--") + option.name);
    for (const std::string& value : option.values) arguments.push_back("--" + option.name + "=" + value);
  }
  return arguments;
}

}  // namespace aerate::batch
