#include <csignal>

#include "cli/command_line.h"
#include "cli/huge_pages.h"
#include "cli/terminal.h"

int main(int argc, char** argv) {
  aerate::cli::use_huge_pages();
  aerate::cli::keep_standard_descriptors();
  // A limit of the size of files is to be an error of writing, not an end without a word.
  std::signal(SIGXFSZ, SIG_IGN);
  return aerate::cli::exit_status_of(argc, argv);
}
