#include <CLI/CLI.hpp>
#include <cmath>

#include "cli/config_file.h"
#include "cli/limit_options.h"
#include "tests/fuzz/fuzz_input.h"

// The configuration file of a command with the options of all limits, which are numbers in bounds, and one of
// each other kind: text, flag, list.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const aerate::fuzz::MemoryFile kFile;
  CLI::App app("", "aerate");
  app.require_subcommand(1);
  const aerate::cli::ConfigFile config(app);
  CLI::App& command = *app.add_subcommand("hollow", "");
  command.fallthrough();
  using enum aerate::LimitGroup;
  const aerate::cli::LimitOptions limits(command, config, {packing, ceilings, drainage});
  std::string text;
  bool flag = false;
  std::vector<std::string> list;
  command.add_option("--up", text, "");
  command.add_flag("--drain,!--no-drain", flag, "");
  command.add_option("--escape-hole", list, "");
  const std::string path = kFile.with(aerate::fuzz::text_of(data, size)).string();
  try {
    app.parse(std::vector<std::string>{"hollow", path, "--config"});  // from the last to the first
  } catch (const CLI::ParseError& error) {
    return 0;
  } catch (const aerate::Error& error) {
    aerate::fuzz::require_readable(error);
    return 0;
  }
  for (const auto& [limit, figure] : limits.given()) {
    const aerate::LimitRow& row = aerate::row_of(limit);
    aerate::fuzz::require(figure.value >= row.least.value_or(0) && figure.value <= row.most,
                          "limits are in range");
    aerate::fuzz::require(figure.origin == "configuration file", "a limit says where it is from");
  }
  return 0;
}
