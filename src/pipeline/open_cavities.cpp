#include "pipeline/open_cavities.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "check/check_opened.h"
#include "core/error.h"
#include "core/listed.h"
#include "core/surface_index.h"
#include "kernels/constants.h"
#include "mesh/outward_shells.h"
#include "mesh/topology.h"
#include "packing/hole_showing.h"
#include "pipeline/prepare.h"
#include "printing/cut_through.h"

namespace aerate {
namespace {

std::string point(Vec3d p) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", p.x + 0.0, p.y + 0.0, p.z + 0.0);
}

// The largest first.
std::vector<SealedCavity> cavities_in(const Mesh& mesh) {
  const ShellLabels labels = label_shells(mesh, EdgeUses(mesh));
  const std::vector<Shell> shells = describe_shells(mesh, labels);
  std::vector<SealedCavity> of_shell(shells.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t label = labels.of_triangle[t];
    if (label != kNone && shells[label].volume <= -kLeastCavity) of_shell[label].triangles.push_back(t);
  }
  std::vector<SealedCavity> cavities;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (of_shell[i].triangles.empty()) continue;
    of_shell[i].volume = -shells[i].volume;
    of_shell[i].place = (to_double(shells[i].box.lower) + to_double(shells[i].box.upper)) * 0.5;
    cavities.push_back(std::move(of_shell[i]));
  }
  std::ranges::stable_sort(cavities, std::greater<>(), &SealedCavity::volume);
  return cavities;
}

OpenedSurface still_closed(const Mesh& mesh, const std::vector<SealedCavity>& cavities) {
  OpenedSurface surface{mesh, std::vector<std::uint32_t>(mesh.triangles.size(), OpenedSurface::kOutside)};
  for (std::uint32_t i = 0; i < cavities.size(); ++i) {
    for (const std::uint32_t t : cavities[i].triangles) surface.bounds[t] = i;
  }
  return surface;
}

double lowest_along(const Mesh& mesh, Vec3d up) {
  double lowest = kInfinity;
  for (const Vec3f position : mesh.positions) lowest = std::min(lowest, dot(to_double(position), up));
  return lowest;
}

// Of the usual width before narrow ones, and off the build plate before all others.
std::vector<DrainageRequest> requests_in_turn(const DrainageRequest& asked) {
  std::vector<DrainageRequest> requests;
  for (const bool avoids_plate : {true, false}) {
    for (const double radius : {asked.hole_radius, asked.narrow_hole_radius}) {
      if (!(radius > 0)) continue;
      requests.push_back(asked);
      requests.back().hole_radius = radius;
      requests.back().avoids_plate = avoids_plate;
    }
  }
  return requests;
}

class Opener {
 public:
  Opener(const PreparedModel& model, const OpeningPolicy& policy, Monitor& monitor)
      : mesh_(model.mesh),
        policy_(policy),
        monitor_(monitor),
        index_(model.mesh),
        outward_(model.mesh, model.inspection, index_),
        drainable_{index_, outward_.winding(), model.kept ? &model.kept->within : nullptr,
                   lowest_along(model.mesh, policy.limits.roof.up)},
        requests_(requests_in_turn(policy.request)),
        cavities_(cavities_in(model.mesh)),
        surface_(still_closed(model.mesh, cavities_)) {}

  // The holes of each cavity, the largest cavity first.
  OpenedCavities open() {
    OpenedCavities opened;
    for (std::uint32_t i = 0; i < cavities_.size(); ++i) {
      OpenedCavity cavity{cavities_[i].volume, cavities_[i].place, {}};
      const Vec3d up = policy_.limits.roof.up;
      for (const Vec3d down : {-up, up}) {
        if (auto hole = open_at(i, down)) cavity.holes.push_back(*hole);
      }
      opened.cavities.push_back(std::move(cavity));
    }
    return opened;
  }

  Mesh take() { return std::move(surface_.mesh); }
  std::vector<Tube> tubes() const {
    std::vector<Tube> tubes;
    tubes.reserve(holes_.size());
    for (const CavityHole& hole : holes_) tubes.push_back(hole.tube);
    return tubes;
  }

 private:
  // Cuts the best hole there is, if any.
  std::optional<CavityHole> open_at(std::uint32_t cavity, Vec3d down) {
    const auto can_cut = [&](const CavityHole& hole) {
      monitor_.check_interrupted();
      if (is_crossed_along(surface_.mesh, hole.tube)) return false;
      auto cut = cut_through(surface_, hole.tube, cavity, policy_.tolerance);
      if (!cut || is_crossed_along(cut->mesh, hole.tube)) return false;
      surface_ = std::move(*cut);
      return true;
    };
    for (const DrainageRequest& request : requests_) {
      auto hole = find_cavity_hole(mesh_, drainable_, cavities_[cavity], cavity, request, policy_.limits,
                                   down, holes_, can_cut);
      if (!hole) continue;
      holes_.push_back(*hole);
      return hole;
    }
    return std::nullopt;
  }

  const Mesh& mesh_;
  const OpeningPolicy& policy_;
  Monitor& monitor_;
  SurfaceIndex index_;
  OutwardShells outward_;
  DrainableModel drainable_;
  std::vector<DrainageRequest> requests_;
  std::vector<SealedCavity> cavities_;
  OpenedSurface surface_;
  std::vector<CavityHole> holes_;
};

void require_opened(const OpenedCavities& opened, const OpeningPolicy& policy, const std::string& file) {
  for (const OpenedCavity& cavity : opened.cavities) {
    if (!cavity.holes.empty()) continue;
    const double narrow = policy.request.narrow_hole_radius;
    throw NothingToRemoveError(
        fmt::format(
            "{}: its own cavity near {} ({:.3f} mm3) cannot be opened: no escape hole of {:g} mm leads "
            "straight out of it and keeps a wall of {:g} mm from other surface",
            file, point(cavity.place), cavity.volume, 2 * (narrow > 0 ? narrow : policy.request.hole_radius),
            policy.limits.wall),
        "give a smaller --hole-diameter or --wall, fill the cavity in a mesh editor (take its inner surface "
        "away), or leave out --drain-cavities");
  }
}

void tell_of(const OpenedCavities& opened, const OpeningPolicy& policy, double plate, Monitor& monitor) {
  std::size_t with_one = 0, narrow = 0, on_plate = 0;
  std::string first;
  for (const OpenedCavity& cavity : opened.cavities) {
    if (cavity.holes.size() == 1 && with_one++ == 0) first = point(cavity.place);
    for (const CavityHole& hole : cavity.holes) {
      narrow += hole.tube.radius < policy.request.hole_radius ? 1U : 0U;
      on_plate += opens_onto_plate(hole.tube, policy.limits.roof.up, plate) ? 1U : 0U;
    }
  }
  if (with_one > 0)
    monitor.notice(
        fmt::format("{} of the model's own {} {} a single hole, by which air has to get in as well (near "
                    "{}): there is no "
                    "place for another",
                    with_one, counted(opened.cavities.size(), "cavity", "cavities"),
                    with_one == 1 ? "has" : "have", first));
  if (narrow > 0)
    monitor.notice(fmt::format(
        "{} of {} of its own cavities {} {:g} mm wide, as channels are: there is no place for {:g} mm",
        narrow, counted(opened.hole_count(), "hole", "holes"), narrow == 1 ? "is" : "are",
        2 * policy.request.narrow_hole_radius, 2 * policy.request.hole_radius));
  if (on_plate > 0)
    monitor.notice(fmt::format("{} of {} of its own cavities {} onto the build plate: print it on supports",
                               on_plate, counted(opened.hole_count(), "hole", "holes"),
                               on_plate == 1 ? "opens" : "open"));
}

}  // namespace

double OpenedCavities::volume() const {
  double sum = 0;
  for (const OpenedCavity& cavity : cavities) sum += cavity.volume;
  return sum;
}

std::size_t OpenedCavities::hole_count() const {
  std::size_t count = 0;
  for (const OpenedCavity& cavity : cavities) count += cavity.holes.size();
  return count;
}

PreparedModel with_open_cavities(PreparedModel model, const OpeningPolicy& policy, Monitor& monitor) {
  monitor.stage("open");
  Opener opener(model, policy, monitor);
  OpenedCavities opened = opener.open();
  require_opened(opened, policy, model.input.path.filename().string());
  if (opened.cavities.empty()) {
    monitor.notice("the model has no sealed cavity of its own that --drain-cavities could open");
  } else {
    const std::vector<Tube> tubes = opener.tubes();
    Mesh mesh = opener.take();
    Inspection inspection = inspect(mesh);
    check_opened({model.mesh, model.inspection, mesh, inspection, tubes}, monitor);
    opened.removed = signed_volume(model.mesh) - signed_volume(mesh);
    drop_unused_vertices(mesh);
    inspection.vertex_count = mesh.positions.size();
    tell_of(opened, policy, lowest_along(model.mesh, policy.limits.roof.up), monitor);
    model.mesh = std::move(mesh);
    model.inspection = std::move(inspection);
  }
  model.opened = std::move(opened);
  return model;
}

}  // namespace aerate
