#pragma once

namespace CLI {
class App;
}

namespace aerate::cli {

// Adds --config FILE to the program (TOML or INI). Keys outside any section belong to the command being run.
// An unknown key is an error.
void read_config_files(CLI::App& app);

}  // namespace aerate::cli
