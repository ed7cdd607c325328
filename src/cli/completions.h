#pragma once

#include <string>

#include "cli/command_words.h"

namespace aerate::cli {

// What completes commands, options, their values and files of the right endings in a shell: files for it to source, or to keep where
// it looks for completions.
std::string bash_completion(const ProgramWords& words);
std::string zsh_completion(const ProgramWords& words);  // "#compdef aerate"
std::string fish_completion(const ProgramWords& words);

}  // namespace aerate::cli
