#include "pipeline/options.h"

namespace aerate {

const char* name_of(PackingMethod method) {
  switch (method) {
    case PackingMethod::adaptive:
      return "adaptive";
    case PackingMethod::given:
      return "given";
    case PackingMethod::hexagonal:
      return "hexagonal";
  }
  return "unknown";
}

}  // namespace aerate
