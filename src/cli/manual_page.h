#pragma once

#include <string>

#include "cli/command_words.h"

namespace aerate::cli {

// Manual pages of section 1 as man(7) macros.
//   date: "2026-11-30", as their foot has it; may be empty

// aerate(1)
std::string manual_of_program(const ProgramWords& words, const std::string& date);

// aerate-hollow(1) and so on: of one of the commands of `words`.
std::string manual_of_command(const ProgramWords& words, const CommandWords& command,
                              const std::string& date);

}  // namespace aerate::cli
