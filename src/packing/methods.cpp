#include "packing/methods.h"

#include <algorithm>

#include "core/error.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"

namespace aerate {

std::span<const PackingMethod> packing_methods() {
  static const PackingMethod methods[] = {adaptive_method(), hexagonal_method()};
  return methods;
}

const PackingMethod& packing_method(std::string_view name) {
  const auto found = std::ranges::find(packing_methods(), name, &PackingMethod::name);
  if (found == packing_methods().end()) throw UsageError("there is no packing " + std::string(name));
  return *found;
}

}  // namespace aerate
