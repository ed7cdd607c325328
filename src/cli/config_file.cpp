#include "cli/config_file.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "files/input_file.h"

namespace aerate::cli {
namespace {

// Empty for a file that can be opened.
std::string why_unreadable(const std::string& path) {
  try {
    check_regular_file(path);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::ptrdiff_t kDeepest = 8;

// The program has sections one deep, and CLI11 compares all levels of a name with each other.
void require_shallow(const std::string& text) {
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    // A key ends before its value; a section's name fills its line.
    const std::string_view name = std::string_view(line).substr(0, line.find('='));
    if (std::ranges::count(name, '.') >= kDeepest)
      throw CLI::ConfigError(fmt::format("line {} is nested deeper than {}", number, kDeepest));
  }
}

std::string read_config(std::istream& input) {
  std::string text(kMostBytes + 1, '\0');
  input.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(input.gcount()));
  if (text.size() > kMostBytes) throw CLI::ConfigError(fmt::format("more than {} bytes", kMostBytes));
  require_shallow(text);
  return text;
}

class CommandConfig final : public CLI::ConfigTOML {
 public:
  CommandConfig(const CLI::App& app, std::set<std::string> ignored,
                std::shared_ptr<std::set<std::string>> read)
      : app_(app), ignored_(std::move(ignored)), read_(std::move(read)) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::istringstream text(read_config(input));
    std::vector<CLI::ConfigItem> found = CLI::ConfigTOML::from_config(text);
    std::erase_if(found, [&](const CLI::ConfigItem& item) {
      return !item.parents.empty() && ignored_.contains(item.parents.front());
    });
    const std::vector<CLI::App*> commands =
        const_cast<CLI::App&>(app_).get_subcommands();  // NOLINT: the const overload lists only all of them
    if (commands.empty()) return found;
    for (CLI::ConfigItem& item : found) {
      if (item.parents.empty()) item.parents.push_back(commands.front()->get_name());
      // The command line goes before the file, and has been read by now.
      const CLI::Option* option = commands.front()->get_option_no_throw("--" + item.name);
      if (option != nullptr && option->count() == 0) read_->insert(option->get_name());
    }
    return found;
  }

 private:
  const CLI::App& app_;
  std::set<std::string> ignored_;
  std::shared_ptr<std::set<std::string>> read_;
};

}  // namespace

ConfigFile::ConfigFile(CLI::App& app, std::set<std::string> ignored)
    : read_(std::make_shared<std::set<std::string>>()) {
  // Looked at before it is opened.
  option_ = app.set_config("--config", "", "Read options from this file (TOML or INI)")
                ->type_name("FILE")
                ->check(why_unreadable)
                ->trigger_on_parse();
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<CommandConfig>(app, std::move(ignored), read_));
}

std::string ConfigFile::path() const {
  return option_->count() > 0 ? option_->as<std::string>() : std::string();
}

bool ConfigFile::is_on_command_line(const CLI::Option& option) const {
  return !read_->contains(option.get_name());
}

std::string ConfigFile::origin_of(const CLI::Option& option) const {
  return is_on_command_line(option) ? "command line" : "configuration file";
}

}  // namespace aerate::cli
