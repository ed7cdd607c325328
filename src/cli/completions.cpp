#include "cli/completions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string_view>
#include <vector>

namespace aerate::cli {
namespace {

constexpr std::size_t kMostShown = 70;  // characters of a description beside an option

constexpr const char* kMade = "made from the program's own options";

// In single quotes, for bash and zsh.
std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

bool is_flag(const OptionWords& option) {
  return option.value.empty();
}

// "stl stp": without their points.
std::vector<std::string> bare(const std::vector<std::string>& endings) {
  std::vector<std::string> result;
  result.reserve(endings.size());
  for (const std::string& ending : endings) result.push_back(ending.substr(1));
  return result;
}

std::vector<std::string> names_of(const std::vector<CommandWords>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CommandWords& command : commands) names.push_back(command.name);
  return names;
}

// ---- bash

constexpr const char* kBashBegin =
    R"(# Completion of {0} for bash, {1}.

# Files of these endings, of any if there are none of them, and folders.
_{0}_files() {{
  local file ending others=()
  compopt -o filenames 2>/dev/null
  # As it stands on the line it may be quoted.
  cur=${{cur#[\'\"]}}
  while IFS= read -r file; do
    if [[ -d ${{file/#\~/$HOME}} ]]; then
      COMPREPLY+=("$file")
      continue
    fi
    others+=("$file")
    for ending; do [[ ${{file,,}} != *".$ending" ]] || COMPREPLY+=("$file"); done
  done < <(compgen -f -- "${{cur//\\/}}")
  for file in "${{COMPREPLY[@]}}"; do [[ -d ${{file/#\~/$HOME}} ]] || return 0; done
  COMPREPLY+=("${{others[@]}}")
}}

_{0}_folders() {{
  compopt -o filenames 2>/dev/null
  cur=${{cur#[\'\"]}}
  mapfile -t COMPREPLY < <(compgen -d -- "${{cur//\\/}}")
}}

_{0}_words() {{
  mapfile -t COMPREPLY < <(compgen -W "$*" -- "$cur")
}}

_{0}() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD - 1]}} command= i
  COMPREPLY=()
  # --wall=1 comes as three words.
  if [[ $cur == = ]]; then
    cur=
  elif [[ $prev == = && COMP_CWORD -ge 2 ]]; then
    prev=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case ${{COMP_WORDS[i]}} in
      --config) ((++i)); [[ ${{COMP_WORDS[i]}} != = ]] || ((++i)) ;;
      -*) ;;
      *) command=${{COMP_WORDS[i]}}; break ;;
    esac
  done
)";

std::string bash_action(const OptionWords& option, const std::string& program) {
  if (option.kind == ValueKind::folder) return fmt::format("_{}_folders", program);
  if (option.kind == ValueKind::file)
    return fmt::format("_{}_files {}", program, fmt::join(bare(option.endings), " "));
  if (!option.choices.empty()) return fmt::format("_{}_words {}", program, fmt::join(option.choices, " "));
  return ":";
}

// What completes after these options, and else their names and the argument.
std::string bash_branch(const std::vector<OptionWords>& options, const std::string& at_last,
                        const std::string& program) {
  std::string values;
  std::vector<std::string> names;
  for (const OptionWords& option : options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
    // What may be bare has its value in the same word alone.
    if (!is_flag(option) && !option.form.may_be_bare)
      values += fmt::format("        {}) {}; return ;;\n", fmt::join(option.names, " | "),
                            bash_action(option, program));
  }
  return fmt::format(
      "      case $prev in\n{0}      esac\n"
      "      if [[ $cur == -* ]]; then _{1}_words {2}; else {3}; fi\n",
      values, program, fmt::join(names, " "), at_last);
}

// ---- zsh

// Inside of [..] of a specification of _arguments.
std::string in_brackets(const std::string& description) {
  std::string text;
  for (const char c : in_short(description, kMostShown)) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') text += '\\';
    text += c;
  }
  return "[" + text + "]";
}

std::string zsh_action(const OptionWords& option) {
  if (option.kind == ValueKind::folder) return "_files -/";
  if (option.kind == ValueKind::file && option.endings.empty()) return "_files";
  if (option.kind == ValueKind::file)
    return fmt::format("_files -g \"*.(#i)({})(-.)\"", fmt::join(bare(option.endings), "|"));
  if (!option.choices.empty()) return fmt::format("({})", fmt::join(option.choices, " "));
  return " ";
}

// "AXIS[=SHARE%]" -> "AXIS"
std::string zsh_message(const std::string& value) {
  return value.substr(0, value.find_first_of("[:"));
}

// A line for each name of it, which exclude each other.
std::string zsh_option(const OptionWords& option) {
  std::string lines;
  const std::string others = option.form.is_list ? "*" : fmt::format("({})", fmt::join(option.names, " "));
  for (const std::string& name : option.names) {
    std::string spec = others + name;
    const bool is_long = name.starts_with("--");
    if (option.form.may_be_bare)
      spec += "=-";
    else if (!is_flag(option))
      spec += is_long ? "=" : "+";
    spec += in_brackets(option.description);
    if (option.form.may_be_bare) spec += ":";
    if (!is_flag(option)) spec += fmt::format(":{}:{}", zsh_message(option.value), zsh_action(option));
    lines += fmt::format(" \\\n        {}", in_quotes(spec));
  }
  return lines;
}

std::string zsh_argument(const OptionWords& argument) {
  const std::string spec =
      fmt::format("{}:{}:{}", argument.form.is_list ? "*" : "", argument.value, zsh_action(argument));
  return fmt::format(" \\\n        {}", in_quotes(argument.form.is_list ? spec : "1" + spec));
}

// ---- fish

std::string fish_quoted(std::string_view text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c;
  }
  return result + "'";
}

constexpr const char* kFishBegin =
    R"(# Completion of {0} for fish, {1}.

# True after this command; without a name, before any.
function __{0}_after
    set -l words (commandline -opc)
    set -l is_value 0
    for word in $words[2..-1]
        if test $is_value = 1
            set is_value 0
        else if test "$word" = --config
            set is_value 1
        else if not string match -q -- '-*' $word
            test "$word" = "$argv[1]"
            return
        end
    end
    test (count $argv) = 0
end

# Files of these endings, of any if there are none of them, and folders.
function __{0}_files
    set -l token (string replace -r -- '^--?[^=]*=' '' (commandline -ct))
    set -l files (complete -C "__{0}_no_command $token")
    set -l found (string match -ri -- '^[^\t]*\.(?:'(string join -- '|' $argv)')(?:\t.*)?$' $files)
    if test (count $found) = 0
        string join -- \n $files
    else
        string join -- \n $found
        string match -r -- '^[^\t]*/(?:\t.*)?$' $files
    end
    return 0
end

complete -c {0} -f
)";

std::string fish_values(const OptionWords& option, const std::string& program) {
  if (option.kind == ValueKind::folder) return " -x -a '(__fish_complete_directories)'";
  if (option.kind == ValueKind::file && option.endings.empty()) return " -r -F";
  if (option.kind == ValueKind::file)
    return fmt::format(" -k -x -a '(__{}_files {})'", program, fmt::join(bare(option.endings), " "));
  if (!option.choices.empty())
    return " -x -a " + fish_quoted(fmt::format("{}", fmt::join(option.choices, " ")));
  return " -x";
}

std::string fish_option(const OptionWords& option, const std::string& condition, const std::string& program) {
  std::string line = fmt::format("complete -c {} -n {}", program, fish_quoted(condition));
  for (const std::string& name : option.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  // What may be bare has its value in the same word alone.
  if (!is_flag(option) && !option.form.may_be_bare) line += fish_values(option, program);
  return line + fmt::format(" -d {}\n", fish_quoted(in_short(option.description, kMostShown)));
}

}  // namespace

std::string bash_completion(const ProgramWords& words) {
  const std::string& program = words.program.name;
  std::string text = fmt::format(fmt::runtime(kBashBegin), program, kMade);
  text += "  case $command in\n    '')\n";
  text +=
      bash_branch(words.program.options,
                  fmt::format("_{}_words {}", program, fmt::join(names_of(words.commands), " ")), program);
  text += "      ;;\n";
  for (const CommandWords& command : words.commands) {
    const std::string argument =
        command.arguments.empty() ? ":" : bash_action(command.arguments.front(), program);
    text += fmt::format("    {})\n{}      ;;\n", command.name,
                        bash_branch(options_after(command, words.program), argument, program));
  }
  return text + fmt::format("  esac\n}}\n\ncomplete -F _{0} {0}\n", program);
}

std::string zsh_completion(const ProgramWords& words) {
  const std::string& program = words.program.name;
  std::string text =
      fmt::format("#compdef {0}\n# Completion of {0} for zsh, {1}.\n\n_{0}() {{\n", program, kMade);
  text += "  local curcontext=$curcontext state line\n  typeset -A opt_args\n  _arguments -C -A '-*'";
  for (const OptionWords& option : words.program.options) text += zsh_option(option);
  text += " \\\n        '1:command:->command' \\\n        '*::argument:->after'\n";
  text += "  case $state in\n    command)\n      local -a commands=(\n";
  for (const CommandWords& command : words.commands)
    text +=
        fmt::format("        {}\n",
                    in_quotes(fmt::format("{}:{}", command.name, in_short(command.description, kMostShown))));
  text += "      )\n      _describe command commands ;;\n    after)\n      case $words[1] in\n";
  for (const CommandWords& command : words.commands) {
    text += fmt::format("        {})\n          _arguments", command.name);
    for (const OptionWords& option : options_after(command, words.program)) text += zsh_option(option);
    for (const OptionWords& argument : command.arguments) text += zsh_argument(argument);
    text += " ;;\n";
  }
  return text + fmt::format("      esac ;;\n  esac\n}}\n\n_{} \"$@\"\n", program);
}

std::string fish_completion(const ProgramWords& words) {
  const std::string& program = words.program.name;
  std::string text = fmt::format(fmt::runtime(kFishBegin), program, kMade);
  const std::string before = fmt::format("__{}_after", program);
  for (const OptionWords& option : words.program.options) text += fish_option(option, before, program);
  for (const CommandWords& command : words.commands)
    text += fmt::format("complete -c {} -n {} -a {} -d {}\n", program, before, command.name,
                        fish_quoted(in_short(command.description, kMostShown)));
  for (const CommandWords& command : words.commands) {
    const std::string after = fmt::format("__{}_after {}", program, command.name);
    for (const OptionWords& argument : command.arguments)
      text += fmt::format("complete -c {} -n {}{}\n", program, fish_quoted(after),
                          fish_values(argument, program));
    for (const OptionWords& option : options_after(command, words.program))
      text += fish_option(option, after, program);
  }
  return text;
}

}  // namespace aerate::cli
