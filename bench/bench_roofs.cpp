#include <filesystem>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "bench/benchmark.h"
#include "bench/figures.h"
#include "core/monitor.h"
#include "pipeline/hollow.h"
#include "pipeline/process_choice.h"

// What roofs cost: void volume under the limits of processes that have them, with and without a rule for ceilings, sealed.

namespace aerate::bench {
namespace {

ProcessChoice choice_of(const Process& process, const Limits& given = {}) {
  return limits_under(process, given, ProcessCheck::strict);
}

HollowOptions options_for(const std::filesystem::path& model, const std::filesystem::path& folder,
                          const ProcessChoice& choice) {
  HollowOptions options;
  options.model = model;
  options.output = folder / "hollow.stl";
  options.packing.process = choice;
  return options;
}

std::string widest_ceiling(const OutputFacts& output) {
  return output.ceilings ? fmt::format("{:.2f}", output.ceilings->widest) : "not limited";
}

void print_roofs(const std::filesystem::path& model, const std::filesystem::path& folder) {
  const Limits wide{{Limit::min_radius, {1.5}}, {Limit::max_radius, {10}}};
  const Limits without_rule{{Limit::bridge, {100}}};
  Limits wide_without_rule = wide;
  wide_without_rule.insert(without_rule.begin(), without_rule.end());
  const Process& fdm = *find_process("fdm");
  const Process& metal = *find_process("metal");
  struct Pair {
    const char* name;
    ProcessChoice with, without;
  };
  const std::vector<Pair> pairs{
      {"fdm, radius 1.5 to 10", choice_of(fdm, wide), choice_of(fdm, wide_without_rule)},
      {"metal", choice_of(metal), choice_of(metal, without_rule)}};
  Table table({"limits", "voids", "with roofs", "void volume, mm3", "without roofs, mm3", "ratio",
               "widest ceiling, mm"});
  for (const Pair& pair : pairs) {
    Monitor monitor;
    const OutputFacts with = hollow(options_for(model, folder, pair.with), monitor).output;
    const OutputFacts without = hollow(options_for(model, folder, pair.without), monitor).output;
    table.add({pair.name, fmt::format("{}", with.void_count), fmt::format("{}", with.roof_count),
               fmt::format("{:.0f}", with.volume_removed), fmt::format("{:.0f}", without.volume_removed),
               fmt::format("{:.3f}", with.volume_removed / without.volume_removed), widest_ceiling(with)});
  }
  fmt::print("\n");
}

int run(const Arguments& arguments) {
  const ScratchFolder folder;
  for (const char* name : {"dragon-47k-100mm.stl", "bunny-100mm.stl"}) {
    const std::filesystem::path model = std::filesystem::path(arguments.text(0, "../shared/models")) / name;
    if (!std::filesystem::exists(model)) {
      fmt::print(stderr, "skipped: {} is not there\n", model.string());
      continue;
    }
    fmt::print("{}\n\n", name);
    print_roofs(model, folder.path());
  }
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"[MODELS]", 0, 1}, aerate::bench::run);
}
