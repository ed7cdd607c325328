#pragma once

#include <memory>
#include <set>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace aerate::cli {

// --config FILE of the program (TOML or INI). Keys outside any section belong to the command being run. An
// unknown key is an error. What the parser would take long for is refused before it reads: more than 1 MiB, and
// sections or keys nested deeper than 8.
class ConfigFile {
 public:
  // Adds the option.
  //   ignored: sections of commands that this program does not have
  explicit ConfigFile(CLI::App& app, std::set<std::string> ignored = {});

  // The file, if one was given.
  std::string path() const;

  // Whether an option that was given was given there.
  bool is_on_command_line(const CLI::Option& option) const;

  // Where the value of an option that was given came from: "command line" or "configuration file".
  std::string origin_of(const CLI::Option& option) const;

 private:
  const CLI::Option* option_;
  std::shared_ptr<std::set<std::string>> read_;  // the options whose values the file gave
};

}  // namespace aerate::cli
