#include "bench/benchmark.h"

#include <exception>
#include <fmt/format.h>
#include <random>
#include <stdexcept>
#include <system_error>

namespace aerate::bench {
namespace {

Arguments parse(int argc, char** argv, const Usage& usage) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool is_table = argument == "--table";
    if (usage.tables == Tables::written && (is_table || argument == "--summary")) {
      if (++i == argc) throw std::invalid_argument(argument + " wants a file");
      (is_table ? arguments.table_file : arguments.summary_file) = argv[i];
    } else if (argument.starts_with("-")) {
      throw std::invalid_argument("what is " + argument + '?');
    } else {
      arguments.positional.push_back(argument);
    }
  }
  const std::size_t count = arguments.positional.size();
  if (count < usage.least || count > usage.most) throw std::invalid_argument("too few or too many arguments");
  return arguments;
}

}  // namespace

std::string Arguments::text(std::size_t i, const std::string& otherwise) const {
  return i < positional.size() ? positional[i] : otherwise;
}

double Arguments::number(std::size_t i, double otherwise) const {
  if (i >= positional.size()) return otherwise;
  std::size_t read = 0;
  const double value = std::stod(positional[i], &read);
  if (read != positional[i].size() || !(value > 0))
    throw std::invalid_argument(positional[i] + " is no number above 0");
  return value;
}

int run_benchmark(int argc, char** argv, const Usage& usage, int (*run)(const Arguments&)) {
  const std::string name = std::filesystem::path(argv[0]).filename().string();
  try {
    return run(parse(argc, argv, usage));
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "{}: {}\nusage: {} {}{}\n", name, error.what(), name, usage.arguments,
               usage.tables == Tables::written ? " [--table FILE] [--summary FILE]" : "");
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return 1;
  }
}

ScratchFolder::ScratchFolder()
    : path_(std::filesystem::temp_directory_path() / fmt::format("aerate-bench-{}", std::random_device{}())) {
  std::filesystem::create_directory(path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace aerate::bench
