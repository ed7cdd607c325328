#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace aerate {

// Process files in the user's configuration folder are known by their names: NAME.json as NAME.

// $XDG_CONFIG_HOME/aerate/processes, else ~/.config/aerate/processes; nothing if the environment has neither. The folder
// need not exist. As the XDG specification has it, a relative $XDG_CONFIG_HOME counts as none.
std::optional<std::filesystem::path> own_processes_folder();

// The file of this name there, readable or not; nothing if there is none.
std::optional<std::filesystem::path> own_process_file(const std::string& name);

// All files there, by name; those that start with a dot are hidden. Throws InputError, naming it, for a folder that is there
// and cannot be read.
std::vector<std::filesystem::path> own_process_files();

}  // namespace aerate
