#pragma once

#include <string>
#include <vector>

#include "cli/option_form.h"

namespace aerate::cli {

// What the parser knows of the program's commands, for its manual pages and for the completions of shells.

enum class ValueKind { other, file, folder };

struct OptionWords {
  std::vector<std::string> names;  // "-o", "--output"; empty for an argument that stands alone
  std::string value;               // what its value, or the argument, is called: "FILE"; empty for a flag
  std::string description;
  std::string group;          // the heading that it is listed below
  std::string default_value;  // empty if none is told
  OptionForm form;
  bool is_required = false;
  bool has_choices_alone = false;     // it takes nothing else
  std::vector<std::string> choices;   // values that can be named
  ValueKind kind = ValueKind::other;  // of what it takes
  // ".stl": of the files that it takes, in the order of its description; none for any.
  std::vector<std::string> endings;
};

struct CommandWords {
  std::string name;  // "hollow"
  std::string description;
  std::string footer;
  std::vector<OptionWords> arguments, options;
};

struct ProgramWords {
  // Its own options may stand before a command and, but where that has one of the name, after it.
  CommandWords program;
  std::vector<CommandWords> commands;
  std::string version;
};
ProgramWords words_of_program();

// The options that may stand after the name of a command.
std::vector<OptionWords> options_after(const CommandWords& command, const CommandWords& program);

// The beginning of a description that says enough on a line of many: at most `most` characters, whole words.
std::string in_short(const std::string& description, std::size_t most);

}  // namespace aerate::cli
