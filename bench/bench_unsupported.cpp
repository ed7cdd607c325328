// How much of what a G-code of PrusaSlicer prints has nothing below it, by kind of line.

#include <array>
#include <fmt/format.h>
#include <string>

#include "bench/benchmark.h"
#include "bench/unsupported_lines.h"
#include "files/input_file.h"

namespace aerate::bench {
namespace {

int run(const Arguments& arguments) {
  const InputFile file = read_file(arguments.positional[0]);
  const auto lengths = unsupported_length(printed_lines(file.text()));
  fmt::print("kind length_mm unsupported_mm longest_mm\n");
  for (const LineKind kind : kLineKinds) {
    const UnsupportedLength& found = lengths[static_cast<std::size_t>(kind)];
    fmt::print("{} {:.1f} {:.1f} {:.1f}\n", name_of(kind), found.length, found.unsupported, found.longest);
  }
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"MODEL.gcode", 1, 1}, aerate::bench::run);
}
