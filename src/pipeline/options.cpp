#include "pipeline/options.h"

namespace aerate {

std::string name_of_method(const PackingRequest& request) {
  return request.spheres.empty() ? std::string(request.method->name) : "given";
}

}  // namespace aerate
