#include "pipeline/lightning_modifiers.h"

#include <utility>

namespace aerate {

HollowOptions holding_lightning(HollowOptions options, double infill_percent) {
  options.modifiers->infill_percent = infill_percent;
  options.modifiers->hold_lightning = true;
  options.packing.process = held_up_by_infill(std::move(options.packing.process));
  PackingStop& stop = options.packing.stop;
  if (options.cells && stop.max_count == PackingStop{}.max_count) stop.max_count = 1;
  return options;
}

}  // namespace aerate
