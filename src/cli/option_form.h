#pragma once

namespace CLI {
class Option;
}

namespace aerate::cli {

// How an option is written, for who offers the options of another command.
struct OptionForm {
  bool is_list = false;      // may be given several times, and all count
  bool is_flag = false;      // without a value
  bool may_be_off = false;   // there is a --no-NAME
  bool may_be_bare = false;  // with a value or, as a flag, without
};
OptionForm form_of(const CLI::Option& option);

}  // namespace aerate::cli
