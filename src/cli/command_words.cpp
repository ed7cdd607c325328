#include "cli/command_words.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <sstream>
#include <string_view>

#include "cli/command_line.h"
#include "files/formats.h"
#include "printing/materials.h"
#include "printing/processes.h"

namespace aerate::cli {
namespace {

// "a,b" -> a, b
std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::vector<std::string> names_of_processes() {
  std::vector<std::string> names;
  for (const Process& process : processes()) names.push_back(process.name);
  names.emplace_back("list");
  return names;
}

std::vector<std::string> names_of_materials() {
  std::vector<std::string> names;
  for (const Material& material : materials()) names.emplace_back(material.name);
  return names;
}

// Values with a name, of options that take others too.
std::vector<std::string> named_values(const std::string& option) {
  const std::vector<std::string> sides{"bottom", "top", "left", "right", "front", "back"};
  static const std::map<std::string, std::vector<std::string>> kNamed{{"--process", names_of_processes()},
                                                                      {"--material", names_of_materials()},
                                                                      {"--device", {"auto", "cpu", "cuda"}},
                                                                      {"--up", {"+x", "+y", "+z"}},
                                                                      {"--picture-cut", {"x", "y", "z"}},
                                                                      {"--holes-on", sides},
                                                                      {"--holes-not-on", sides}};
  const auto found = kNamed.find(option);
  return found == kNamed.end() ? std::vector<std::string>{} : found->second;
}

// The endings of files whose formats a word of a description names: "(.png)", "JSON", "STL,".
std::string ending_named_by(std::string_view word) {
  static const std::map<std::string, std::string, std::less<>> kOthers{
      {"JSON", ".json"}, {"TOML", ".toml"}, {"INI", ".ini"}, {"G-code", ".gcode"}};
  const auto is_around = [](char c) { return std::string_view("(),;:").find(c) != std::string_view::npos; };
  while (!word.empty() && is_around(word.front())) word.remove_prefix(1);
  while (!word.empty() && is_around(word.back())) word.remove_suffix(1);
  const auto is_of_ending = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); };
  if (word.size() > 1 && word.front() == '.' && std::ranges::all_of(word.substr(1), is_of_ending))
    return std::string(word);
  if (const auto other = kOthers.find(word); other != kOthers.end()) return other->second;
  for (const MeshFormat* format : kMeshFormats)
    if (word == format->name) return format->ending;
  return {};
}

std::vector<std::string> endings_named_in(const std::string& description) {
  std::vector<std::string> endings;
  std::istringstream words(description);
  for (std::string word; words >> word;) {
    std::string ending = ending_named_by(word);
    if (!ending.empty() && std::ranges::find(endings, ending) == endings.end())
      endings.push_back(std::move(ending));
  }
  return endings;
}

void add_models(std::vector<std::string>& endings) {
  for (const MeshFormat* format : kMeshFormats)
    if (std::ranges::find(endings, format->ending) == endings.end()) endings.emplace_back(format->ending);
}

ValueKind kind_of(const OptionWords& option) {
  if (option.names.empty() || option.value == "FILE" || option.value == "REGION") return ValueKind::file;
  return option.value == "FOLDER" ? ValueKind::folder : ValueKind::other;
}

OptionWords words_of(const CLI::Option& option) {
  OptionWords words;
  words.description = option.get_description();
  words.group = option.get_group();
  words.default_value = option.get_default_str();
  words.form = form_of(option);
  words.is_required = option.get_required();
  for (const std::string& name : option.get_snames()) words.names.push_back(fmt::format("-{}", name));
  for (const std::string& name : option.get_lnames()) words.names.push_back(fmt::format("--{}", name));
  // With what the parser adds: "UNIT:{mm,cm}", "N:INT in [0 - 100]".
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  if (words.names.empty()) {
    words.value = option.get_name();
    words.form.is_list = option.get_expected_max() > 1;
  } else if (!words.form.is_flag || words.form.may_be_bare) {
    words.value = type.substr(0, colon);
    if (words.form.may_be_bare) words.value = words.value.substr(2, words.value.size() - 3);  // "[=MM]"
  }
  if (colon != std::string::npos && type.substr(colon + 1).starts_with('{')) {
    const std::size_t begin = colon + 2;
    words.choices = split(std::string_view(type).substr(begin, type.find('}', begin) - begin), ',');
    words.has_choices_alone = true;
  } else if (!words.names.empty()) {
    words.choices = named_values(words.names.back());
  }
  words.kind = kind_of(words);
  if (words.kind == ValueKind::file) {
    words.endings = endings_named_in(words.description);
    if (words.value == "MODELS") add_models(words.endings);
    if (words.value == "REGION") words.endings.clear();
  }
  return words;
}

CommandWords words_of(const CLI::App& app) {
  CommandWords words;
  words.name = app.get_name();
  words.description = app.get_description();
  words.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;  // not shown
    std::vector<OptionWords>& list = option->get_positional() ? words.arguments : words.options;
    list.push_back(words_of(*option));
  }
  return words;
}

}  // namespace

ProgramWords words_of_program() {
  ProgramWords words;
  words.version = AERATE_VERSION;
  visit_program([&](const CLI::App& app) {
    words.program = words_of(app);
    for (const CLI::App* command : app.get_subcommands(nullptr))
      if (!command->get_group().empty()) words.commands.push_back(words_of(*command));  // else not shown
  });
  return words;
}

std::vector<OptionWords> options_after(const CommandWords& command, const CommandWords& program) {
  std::vector<OptionWords> options = command.options;
  for (const OptionWords& option : program.options) {
    const bool is_there = std::ranges::any_of(command.options, [&](const OptionWords& own) {
      return std::ranges::find(own.names, option.names.back()) != own.names.end();
    });
    // --version is for the program alone.
    if (!is_there && !option.value.empty()) options.push_back(option);
  }
  return options;
}

std::string in_short(const std::string& description, std::size_t most) {
  std::size_t end = description.size();
  for (const std::string_view stop : {"; ", ". ", " ("}) end = std::min(end, description.find(stop));
  std::string text = description.substr(0, end);
  if (text.size() <= most) return text;
  text.resize(most - 3);
  text.resize(std::min(text.size(), text.rfind(' ')));
  return text + "...";
}

}  // namespace aerate::cli
