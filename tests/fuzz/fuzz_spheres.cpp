#include <bit>
#include <cmath>
#include <vector>

#include "files/input_file.h"
#include "files/sphere_table.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using aerate::Sphere;
using aerate::SphereFormat;

bool same(const Sphere& a, const Sphere& b) {
  return a.centre.x == b.centre.x && a.centre.y == b.centre.y && a.centre.z == b.centre.z &&
         a.radius == b.radius && a.kind == b.kind;
}

std::vector<Sphere> read(const SphereFormat& format, std::string_view bytes) {
  return format.read(aerate::file_in_memory("spheres", bytes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = aerate::fuzz::text_of(data, size);
  const SphereFormat& format = bytes.starts_with("{")     ? SphereFormat::json
                               : bytes.starts_with("ply") ? SphereFormat::ply
                                                          : SphereFormat::csv;
  return aerate::fuzz::run([&] {
    const std::vector<Sphere> spheres = read(format, bytes);
    for (const Sphere& sphere : spheres) {
      const auto& [x, y, z] = sphere.centre;
      aerate::fuzz::require(std::isfinite(x) && std::isfinite(y) && std::isfinite(z), "places are finite");
      aerate::fuzz::require(std::isfinite(sphere.radius) && sphere.radius > 0, "radii are positive");
    }
    const std::vector<Sphere> again = read(format, format.write(spheres, {}));
    aerate::fuzz::require(std::equal(spheres.begin(), spheres.end(), again.begin(), again.end(), same),
                          "what is written reads back as it was");
  });
}
