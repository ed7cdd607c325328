#include "cli/option_form.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>

namespace aerate::cli {

OptionForm form_of(const CLI::Option& option) {
  // A value in braces after a flag's name counts as one that turns it off, too.
  const bool may_be_off = std::ranges::any_of(
      option.get_fnames(), [](const std::string& name) { return name.starts_with("no-"); });
  return {.is_list = option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll,
          .is_flag = option.get_items_expected_max() == 0,
          .may_be_off = may_be_off,
          .may_be_bare = option.get_type_name().starts_with("[=")};
}

}  // namespace aerate::cli
