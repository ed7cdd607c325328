#include "pipeline/print_verdict.h"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aerate {
namespace {

// Without the sign of a zero.
double rounded_percent(double share) {
  return std::round(in_percent(share)) + 0.0;
}

// "52 % more filament"
std::string change_in_words(double share) {
  if (std::abs(share) <= kUncertainShare)
    return fmt::format("about as much filament as without voids ({:+.1f} %)", in_percent(share));
  return fmt::format("{:.0f} % {} filament", std::abs(rounded_percent(share)), share > 0 ? "more" : "less");
}

std::string saving_infill(const PrintPrediction& prediction) {
  if (!prediction.break_even_infill) return "it saves at no infill";
  const double percent = std::ceil(in_percent(*prediction.break_even_infill));
  return percent >= 100 ? "it saves only if it is printed solid"
                        : fmt::format("it saves from {:.0f} % up", percent);
}

std::string first_line(const PrintPrediction& prediction) {
  const FilamentChange& usual = prediction.usual;
  std::string line =
      fmt::format("at {:g} % infill{} this print takes {}", in_percent(usual.infill),
                  prediction.of_modifiers && !prediction.described ? ", which is assumed," : "",
                  change_in_words(usual.share()));
  if (usual.heavier()) line += "; " + saving_infill(prediction);
  if (usual.infill < 1) line += fmt::format("; solid: {:+.0f} %", rounded_percent(prediction.solid.share()));
  return line;
}

// What may take less filament than these voids do, if anything is known to.
std::string other_ways(const PrintPrediction& prediction) {
  constexpr const char* kLightning = "your slicer's lightning infill";
  if (prediction.of_modifiers) return fmt::format("{}, where it has one, may save more", kLightning);
  if (!prediction.usual.heavier()) return "";
  const bool do_modifiers_save = prediction.as_modifiers && *prediction.as_modifiers < -kUncertainShare;
  return do_modifiers_save ? fmt::format(
                                 "for sparse prints: --as modifiers ({:+.0f} % with these voids; the cells "
                                 "that it makes as a rule save more), or {}",
                                 rounded_percent(*prediction.as_modifiers), kLightning)
                           : fmt::format("for sparse prints: {}", kLightning);
}

}  // namespace

std::vector<std::string> verdict_of(const PrintPrediction& prediction) {
  std::vector<std::string> lines{first_line(prediction)};
  if (std::string others = other_ways(prediction); !others.empty()) lines.push_back(std::move(others));
  return lines;
}

std::string verdict_in_words(const PrintPrediction& prediction) {
  return fmt::format("{}", fmt::join(verdict_of(prediction), "; "));
}

}  // namespace aerate
