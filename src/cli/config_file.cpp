#include "cli/config_file.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <vector>

namespace aerate::cli {
namespace {

class CommandConfig final : public CLI::ConfigTOML {
 public:
  explicit CommandConfig(const CLI::App& app) : app_(app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> found = CLI::ConfigTOML::from_config(input);
    const std::vector<CLI::App*> commands =
        const_cast<CLI::App&>(app_).get_subcommands();  // NOLINT: the const overload lists only all of them
    if (commands.empty()) return found;
    for (CLI::ConfigItem& item : found) {
      if (item.parents.empty()) item.parents.push_back(commands.front()->get_name());
    }
    return found;
  }

 private:
  const CLI::App& app_;
};

}  // namespace

void read_config_files(CLI::App& app) {
  app.set_config("--config", "", "Read options from this file (TOML or INI)")->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.config_formatter(std::make_shared<CommandConfig>(app));
}

}  // namespace aerate::cli
