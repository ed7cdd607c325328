#include "pipeline/options.h"

namespace aerate {

const char* name_of(PackingMethod method) {
  switch (method) {
    case PackingMethod::hexagonal:
      return "hexagonal";
  }
  return "unknown";
}

}  // namespace aerate
