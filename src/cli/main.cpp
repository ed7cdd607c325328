#include <csignal>
#include <exception>
#include <new>

#include "cli/command_line.h"
#include "cli/terminal.h"
#include "core/error.h"

int main(int argc, char** argv) {
  using aerate::ExitCode;
  ExitCode code = ExitCode::failure;
  aerate::cli::keep_standard_descriptors();
  // A limit of the size of files is to be an error of writing, not an end without a word.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    aerate::cli::run_command_line(argc, argv);
    code = ExitCode::done;
  } catch (const aerate::Error& error) {
    aerate::cli::print_error(error.what(), error.hint());
    code = error.code();
  } catch (const std::bad_alloc&) {
    aerate::cli::print_error("out of memory; no output was written",
                             "give a larger --max-radius, --min-radius or --tolerance, or a smaller model");
  } catch (const std::exception& error) {
    aerate::cli::print_error(error.what(), "this should not happen: please report it with the command line");
  }
  return static_cast<int>(code);
}
