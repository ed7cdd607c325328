#pragma once

#include <string>
#include <vector>

#include "pipeline/print_prediction.h"

namespace aerate {

inline double in_percent(double share) {
  return 100 * share;
}

// What a hobbyist wants to know first, in one line or two: what voids save or cost at the print's infill, or at the usual
// one, from which infill on they save, and what else there is where they cost.
std::vector<std::string> verdict_of(const PrintPrediction& prediction);

// The same in one sentence.
std::string verdict_in_words(const PrintPrediction& prediction);

}  // namespace aerate
