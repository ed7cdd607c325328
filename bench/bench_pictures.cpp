// How long pictures of hollowed models take, beyond the jobs themselves, and how large they are.

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <string>

#include "bench/benchmark.h"
#include "core/mesh.h"
#include "files/load.h"
#include "pipeline/carve_model.h"
#include "pipeline/hollow.h"
#include "pipeline/process_choice.h"
#include "pipeline/scene_of.h"
#include "view/picture.h"
#include "view/png_bytes.h"

namespace aerate::bench {
namespace {

constexpr double kLongestSide = 100;  // mm: models are scaled to it

// The process's own limits, and the tolerance at which the result has about so many triangles.
HollowOptions options_for(const std::string& model, const std::filesystem::path& output) {
  HollowOptions options;
  options.model = model;
  options.output = output;
  const Box3f box = bounding_box(load_model(model, {}).mesh);
  const Vec3d size = to_double(box.upper) - to_double(box.lower);
  const double scale = kLongestSide / std::max({size.x, size.y, size.z});
  options.load.scale = {scale, scale, scale};
  options.packing.process = limits_under(processes().front(), {}, ProcessCheck::none);
  return options;
}

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

int run(const Arguments& arguments) {
  fmt::print("model triangles colour scene_s draw_s png_s all_s processor_s bytes\n");
  const ScratchFolder folder;
  for (const std::string& model : arguments.positional) {
    Monitor monitor;
    const HollowOptions options = options_for(model, folder.path() / "result.stl");
    PreparedModels models;
    const HollowedModel hollowed = carve_model(options, models, monitor);
    const HollowReport report = write_hollowed(hollowed, options, monitor);
    for (const PictureColour colour : {PictureColour::radius, PictureColour::thickness}) {
      const double processor = processor_seconds();
      std::optional<Scene> scene;
      const double scene_seconds = seconds_of([&] { scene = scene_of(hollowed, report); });
      PictureRequest request;
      request.colour = colour;
      std::optional<Picture> picture;
      const double draw_seconds =
          seconds_of([&] { picture.emplace(draw_picture(*scene, request, monitor)); });
      std::string bytes;
      const double png_seconds = seconds_of([&] { bytes = png_of(picture->image); });
      fmt::print("{} {} {} {:.3f} {:.3f} {:.3f} {:.3f} {:.3f} {}\n",
                 std::filesystem::path(model).filename().string(), report.output.triangle_count,
                 colour == PictureColour::radius ? "radius" : "thickness", scene_seconds, draw_seconds,
                 png_seconds, scene_seconds + draw_seconds + png_seconds, processor_seconds() - processor,
                 bytes.size());
    }
  }
  return 0;
}

}  // namespace
}  // namespace aerate::bench

int main(int argc, char** argv) {
  return aerate::bench::run_benchmark(argc, argv, {"MODEL...", 1, aerate::bench::kAnyNumber},
                                      aerate::bench::run);
}
