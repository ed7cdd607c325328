#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "cli/command_words.h"
#include "cli/completions.h"
#include "cli/manual_page.h"

// aerate_command_files FOLDER DATE: writes what the build makes of the program's commands, its manual pages and completions, in
// place of what is in the folder.

namespace fs = std::filesystem;
using namespace aerate::cli;

namespace {

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

void write_all(const fs::path& folder, const std::string& date) {
  const ProgramWords words = words_of_program();
  const std::string& program = words.program.name;
  const fs::path pages = folder / "man1";
  fs::remove_all(pages);
  write(pages / (program + ".1"), manual_of_program(words, date));
  for (const CommandWords& command : words.commands)
    write(pages / fmt::format("{}-{}.1", program, command.name), manual_of_command(words, command, date));
  write(folder / "bash" / program, bash_completion(words));
  write(folder / "zsh" / ("_" + program), zsh_completion(words));
  write(folder / "fish" / (program + ".fish"), fish_completion(words));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: aerate_command_files FOLDER DATE\n";
    return 2;
  }
  try {
    write_all(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << "aerate_command_files: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
