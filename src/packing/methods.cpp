#include "packing/methods.h"

#include <algorithm>

#include "core/error.h"
#include "packing/adaptive.h"
#include "packing/hexagonal.h"

namespace aerate {
namespace {

const PackingMethod kMethods[] = {adaptive_method(), hexagonal_method()};

}  // namespace

std::span<const PackingMethod> packing_methods() {
  return kMethods;
}

const PackingMethod& packing_method(std::string_view name) {
  const auto found = std::ranges::find(kMethods, name, &PackingMethod::name);
  if (found == std::end(kMethods)) throw UsageError("there is no packing " + std::string(name));
  return *found;
}

}  // namespace aerate
