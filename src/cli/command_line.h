#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace aerate::cli {

// Parses the arguments and runs the command they name. Results go to standard output, notices to standard
// error. Throws aerate::Error for whatever keeps the command from being done, the command line included.
void run_command_line(int argc, const char* const* argv);

// The same as a whole process does it: what is thrown is printed as an error, and becomes the exit status.
int exit_status_of(int argc, char* const* argv);

// The parser of the command line, with all commands and their options.
void visit_program(const std::function<void(const CLI::App&)>& visit);

}  // namespace aerate::cli
