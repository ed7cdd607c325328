#include "cli/manual_page.h"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "core/listed.h"

namespace aerate::cli {
namespace {

// Text that stands as it is: in roff a hyphen is one that lines break at, and quotation marks become curved.
std::string plain(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '\\':
        result += "\\e";
        break;
      case '-':
        result += "\\-";
        break;
      case '\'':
        result += "\\(aq";
        break;
      case '`':
        result += "\\(ga";
        break;
      case '^':
        result += "\\(ha";
        break;
      case '~':
        result += "\\(ti";
        break;
      default:
        result += c == '\n' ? ' ' : c;
    }
  }
  // A line of text must not begin as a request does.
  return result.starts_with('.') ? "\\&" + result : result;
}

std::string bold(const std::string& text) {
  return "\\fB" + plain(text) + "\\fR";
}

std::string italic(const std::string& text) {
  return "\\fI" + plain(text) + "\\fR";
}

std::string in_capitals(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

// As the line of a name has it: "Remove spheres" -> "remove spheres".
std::string uncapitalised(std::string text) {
  text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string heading(const std::string& title) {
  return fmt::format(".SH {}\n", plain(in_capitals(title)));
}

std::string begin(const std::string& name, const ProgramWords& words, const std::string& date) {
  return fmt::format(
      ".\\\" Made from the program's own options.\n.TH {} 1 \"{}\" \"{} {}\" \"User Commands\"\n",
      in_capitals(plain(name)), date, words.program.name, words.version);
}

// "-o FILE", "--stand[=MM]"
std::string usage_of(const OptionWords& option) {
  if (option.names.empty()) return italic(option.value) + (option.form.is_list ? " ..." : "");
  std::vector<std::string> names;
  for (const std::string& name : option.names) names.push_back(bold(name));
  std::string text = fmt::format("{}", fmt::join(names, ", "));
  if (option.value.empty()) return text;
  if (option.form.may_be_bare) return fmt::format("{}[={}]", text, italic(option.value));
  return fmt::format("{} {}", text, italic(option.value));
}

std::string paragraph_of(const OptionWords& option) {
  std::string text = fmt::format(".TP\n{}\n{}.\n", usage_of(option), plain(option.description));
  if (option.has_choices_alone && option.choices.size() > 1)
    text += fmt::format("One of {}.\n", plain(listed(option.choices, "and")));
  if (!option.default_value.empty()) text += fmt::format("Default: {}.\n", plain(option.default_value));
  if (option.is_required && !option.names.empty()) text += "It has to be given.\n";
  if (option.form.is_list && !option.names.empty()) text += "It may be given several times.\n";
  return text;
}

// Below their headings, in the order in which these come up.
std::string paragraphs_of(const std::vector<OptionWords>& options) {
  std::vector<std::string> groups;
  for (const OptionWords& option : options)
    if (std::ranges::find(groups, option.group) == groups.end()) groups.push_back(option.group);
  std::string text;
  for (const std::string& group : groups) {
    text += group == "Options" ? heading(group) : fmt::format(".SS {}\n", plain(group));
    for (const OptionWords& option : options)
      if (option.group == group) text += paragraph_of(option);
  }
  return text;
}

// Lines of "    2  usage: options" as paragraphs with what stands first beside them; a line without goes on with the one above.
std::string table_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) {
    const std::size_t begin = line.find_first_not_of(' ');
    const std::size_t gap = line.find("  ", begin);
    if (gap != std::string::npos)
      text += fmt::format(".TP\n{}\n{}\n", bold(line.substr(begin, gap - begin)),
                          plain(line.substr(line.find_first_not_of(' ', gap))));
    else
      text += plain(line.substr(begin)) + "\n";
  }
  return text;
}

// The footer of the help: paragraphs with empty lines between them. One that begins with "Exit status:" and has indented lines is a
// section of that name, all others are notes.
std::string sections_of(const std::string& footer) {
  std::string notes, sections;
  std::vector<std::string> lines;
  const auto end_paragraph = [&] {
    if (lines.empty()) return;
    if (lines.size() > 1 && lines[0].ends_with(':') && lines[1].starts_with(' ')) {
      std::string title = lines[0].substr(0, lines[0].size() - 1);
      sections += heading(title) + table_of({lines.begin() + 1, lines.end()});
    } else {
      notes += notes.empty() ? heading("Notes") : ".PP\n";
      for (const std::string& line : lines) notes += plain(line) + "\n";
    }
    lines.clear();
  };
  std::istringstream text(footer);
  for (std::string line; std::getline(text, line);) {
    if (line.empty())
      end_paragraph();
    else
      lines.push_back(line);
  }
  end_paragraph();
  return notes + sections;
}

std::string page_of(const std::string& name) {
  return bold(name) + "(1)";
}

std::string see_also(const ProgramWords& words, const std::string& but) {
  std::vector<std::string> pages;
  if (but != words.program.name) pages.push_back(page_of(words.program.name));
  for (const CommandWords& command : words.commands) {
    const std::string name = words.program.name + "-" + command.name;
    if (name != but) pages.push_back(page_of(name));
  }
  return fmt::format("{}{}\n", heading("See also"), fmt::join(pages, ",\n"));
}

}  // namespace

std::string manual_of_program(const ProgramWords& words, const std::string& date) {
  const CommandWords& program = words.program;
  std::string text = begin(program.name, words, date);
  text += fmt::format("{}{} \\- hollows printable models by packed voids\n", heading("Name"),
                      plain(program.name));
  text += fmt::format("{}{}\n[{}] {} [{} ...]\n", heading("Synopsis"), bold(program.name), italic("OPTIONS"),
                      italic("COMMAND"), italic("ARGUMENT"));
  text += fmt::format("{}{}\n", heading("Description"), plain(program.description));
  text += heading("Commands");
  for (const CommandWords& command : words.commands)
    text += fmt::format(".TP\n{}\n{}. See {}.\n", bold(command.name), plain(command.description),
                        page_of(program.name + "-" + command.name));
  text += paragraphs_of(program.options);
  return text + sections_of(program.footer) + see_also(words, program.name);
}

std::string manual_of_command(const ProgramWords& words, const CommandWords& command,
                              const std::string& date) {
  const std::string name = words.program.name + "-" + command.name;
  std::string text = begin(name, words, date);
  text +=
      fmt::format("{}{} \\- {}\n", heading("Name"), plain(name), plain(uncapitalised(command.description)));
  text += fmt::format("{}{}\n[{}]", heading("Synopsis"), bold(words.program.name + " " + command.name),
                      italic("OPTIONS"));
  for (const OptionWords& argument : command.arguments)
    text += fmt::format(fmt::runtime(argument.is_required ? " {}" : " [{}]"), usage_of(argument));
  text += fmt::format("\n{}{}.\n", heading("Description"), plain(command.description));
  for (const OptionWords& argument : command.arguments) text += paragraph_of(argument);
  text += paragraphs_of(options_after(command, words.program));
  return text + sections_of(command.footer) + see_also(words, name);
}

}  // namespace aerate::cli
