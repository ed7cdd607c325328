#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace aerate::batch {

// An option of 'aerate hollow' as the batch knows it.
struct OptionRule {
  enum class Kind { value, flag, list };

  std::string name;  // long, without dashes
  Kind kind = Kind::value;
  bool may_be_off = false;   // a flag that has a --no-NAME
  bool may_be_bare = false;  // as a flag, without its value
  bool names_file = false;   // its value is always a file's name
};

// One that was given, be it on the command line or in a manifest.
struct GivenOption {
  std::string name;
  std::vector<std::string> values = {};  // none of a flag
  bool is_off = false;

  friend bool operator==(const GivenOption&, const GivenOption&) = default;
};

const OptionRule* find_rule(std::span<const OptionRule> rules, std::string_view name);

// The options of all models with those of one in their place. A flag that is off and has no --no-NAME is left out. In the order of
// the rules, so that equal options are equal whatever the order in which they were given.
std::vector<GivenOption> merged(std::span<const OptionRule> rules, const std::vector<GivenOption>& shared,
                                const std::vector<GivenOption>& own);

// As they are written on a command line. A value cannot be taken for another option.
std::vector<std::string> arguments_of(const std::vector<GivenOption>& options);

}  // namespace aerate::batch
