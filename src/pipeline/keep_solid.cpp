#include "pipeline/keep_solid.h"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "kernels/constants.h"
#include "mesh/common.h"
#include "mesh/pressed.h"
#include "mesh/primitives.h"
#include "mesh/topology.h"
#include "pipeline/prepare.h"

namespace aerate {
namespace {

// Regions are of no interest further out of the model's box than this share of its diagonal, and need not be larger.
constexpr double kMarginShare = 0.05;

// Pieces of a region's surface reach out of the model by no more than this share of the wall; mm where there is none.
constexpr double kPrecisionShare = 0.25, kLeastPrecision = 0.05;

// Hands notices on, but begins no stages.
class WithinAStage : public Monitor {
 public:
  WithinAStage(Monitor& monitor, std::string about) : monitor_(monitor), about_(std::move(about)) {}

  void notice(std::string_view text) override { monitor_.notice(fmt::format("{}{}", about_, text)); }
  void check_interrupted() override { monitor_.check_interrupted(); }

 private:
  Monitor& monitor_;
  std::string about_;
};

Mesh whole(PreparedModel region, const RegionRequest& request, const KeepSolidPolicy& policy,
           Monitor& monitor) {
  try {
    return make_usable(std::move(region), {.mode = SurfaceMode::keep, .weld = policy.weld}, monitor).mesh;
  } catch (const MeshError& error) {
    throw MeshError(fmt::format("--keep-solid {}: {}", request.text, error.what()),
                    "a region has to be closed: mend its surface in a mesh editor");
  }
}

PreparedModel inspected(const NamedModifier& modifier) {
  PreparedModel region;
  region.mesh = modifier.mesh;
  region.input.path = modifier.name;
  region.inspection = inspect(region.mesh);
  return region;
}

Mesh named_mesh(const NamedRegion& name, const RegionRequest& request, const PreparedModel& model,
                const KeepSolidPolicy& policy, Monitor& monitor) {
  WithinAStage within(monitor, "--keep-solid: ");
  const auto modifier = std::ranges::find(model.modifiers, name.string(), &NamedModifier::name);
  if (modifier != model.modifiers.end()) return whole(inspected(*modifier), request, policy, within);
  std::error_code error;
  if (!std::filesystem::exists(name, error)) {
    throw InputError(fmt::format("--keep-solid {}: there is no file of this name, and no modifier in {}",
                                 request.text, model.input.path.filename().string()),
                     "give a mesh file, a modifier's name as the slicer shows it, or box:, sphere: or "
                     "cylinder: with numbers");
  }
  return whole(load_and_inspect({name}, policy.load, within), request, policy, within);
}

struct MeshOfRegion {
  const RegionRequest& request;
  const PreparedModel& model;
  const KeepSolidPolicy& policy;
  Monitor& monitor;

  Mesh operator()(const NamedRegion& name) const { return named_mesh(name, request, model, policy, monitor); }
  Mesh operator()(const Box3d& box) const { return box_mesh(box.lower, box.upper); }
  Mesh operator()(const BallRegion& ball) const { return ball_mesh(ball.centre, ball.radius); }
  Mesh operator()(const CylinderRegion& cylinder) const {
    return cylinder_mesh(cylinder.start, cylinder.end, cylinder.radius);
  }
};

Box3f with_margin(const Box3f& box, double margin) {
  const Vec3d by{margin, margin, margin};
  return {to_float(to_double(box.lower) - by), to_float(to_double(box.upper) + by)};
}

void append(Mesh& mesh, const Mesh& other) {
  const auto offset = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles)
    mesh.triangles.push_back({a + offset, b + offset, c + offset});
}

Mesh turned_inward(Mesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

std::string in_words(const Box3f& box) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) mm", box.lower.x, box.lower.y,
                     box.lower.z, box.upper.x, box.upper.y, box.upper.z);
}

// Throws unless there is something of the region in the model.
void require_within(double volume, const Mesh& region, const RegionRequest& request,
                    const PreparedModel& model) {
  if (volume > 0) return;
  throw InputError(
      fmt::format("--keep-solid {}: nothing of it is in the model: it reaches from {}, {} from {}",
                  request.text, in_words(bounding_box(region)), model.input.path.filename().string(),
                  in_words(model.inspection.box)),
      "regions are in the model's own coordinates, in mm after --unit and --scale");
}

}  // namespace

std::vector<std::string> names_of_regions(std::span<const RegionRequest> regions) {
  std::vector<std::string> names;
  for (const RegionRequest& region : regions) {
    if (const auto* name = std::get_if<NamedRegion>(&region.shape)) names.push_back(name->string());
  }
  return names;
}

std::optional<KeptSolid> keep_solid(const PreparedModel& model, std::span<const RegionRequest> requests,
                                    const KeepSolidPolicy& policy, Monitor& monitor) {
  if (requests.empty()) return std::nullopt;
  monitor.stage("keep solid");
  const SurfaceIndex surface(model.mesh);
  const Box3f box =
      with_margin(model.inspection.box, policy.wall + kMarginShare * diagonal_of(model.inspection.box));
  double volume = 0;
  Mesh regions;
  std::vector<kernels::HostWinding> earlier;
  std::vector<kernels::WindingView> views;
  for (const RegionRequest& request : requests) {
    const Mesh asked = std::visit(MeshOfRegion{request, model, policy, monitor}, request.shape);
    const Mesh region = pressed_into(box, asked);
    kernels::HostWinding winding(region.positions, region.triangles);
    const double own = common_volume(winding.view(), surface.winding(), {});
    require_within(own, asked, request, model);
    volume += views.empty() ? own : common_volume(winding.view(), surface.winding(), views);
    earlier.push_back(std::move(winding));
    views.push_back(earlier.back().view());
    append(regions, region);
    monitor.check_interrupted();
  }
  const double precision = std::max(kLeastPrecision, kPrecisionShare * policy.wall);
  const Mesh within = surface_within(regions, surface, precision);
  Mesh room = model.mesh;
  append(room, turned_inward(regions));
  SurfaceIndex room_surface(room);
  return KeptSolid{requests.size(),      volume,          SurfaceIndex(regions),
                   SurfaceIndex(within), std::move(room), std::move(room_surface)};
}

}  // namespace aerate
