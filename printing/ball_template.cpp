#include "printing/ball_template.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "printing/level_set.h"

namespace aerate {
namespace {

// A ladder of level sets. A centre off the voxel lattice, without a symmetry of it, gives many more different
// triangulations, so that the steps of the ladder are small.
constexpr double kCoarsestRadiusVoxels = 1.6;
constexpr double kRadiusStep = 1.05;
constexpr Vec3d kCentreVoxels{0.37, 0.259, 0.148};
constexpr std::size_t kLevelCount = 95;  // the last has about 1.1 million triangles
constexpr double kLeastVolumeShare = 0.9;
static_assert(kCoarsestRadiusVoxels >= LevelSet::kSmallestRadiusVoxels);

// Sagitta of a relaxed template times its squared radius in voxels, as measured: 0.145..0.18 over the ladder.
constexpr double kTypicalSagitta = 0.15;

// fp32 has to resolve this many steps within the tolerance and within the radius.
constexpr double kMarginsPerTolerance = 4;
constexpr double kMarginsPerRadius = 256;

// Height of a vertex above its neighbour's plane, over twice that triangle's area, that counts as flat. Exact
// symmetry gives 0, curvature about 1/2 on the unit sphere.
constexpr double kFlat = 1e-9;

constexpr std::uint32_t next(std::uint32_t half_edge) {
  return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}

Vec3d normalised(Vec3d v) {
  return v * (1 / length(v));
}

// Half-edge 3 t + k runs from corner k to corner k + 1 of triangle t; twins run between the same vertices.
class Triangulation {
 public:
  Triangulation(std::vector<Vec3d> positions, std::vector<Triangle> triangles)
      : positions_(std::move(positions)), triangles_(std::move(triangles)) {}

  // False unless closed, 2-manifold, connected and of genus 0.
  bool connect() {
    const std::size_t edges = 3 * triangles_.size() / 2;
    if (triangles_.empty() || positions_.size() + triangles_.size() != edges + 2) return false;
    return pair_half_edges() && is_connected();
  }

  // Flips edges that lie below the surface's convex hull until none is left: each flip adds volume.
  void flip_to_hull() {
    std::vector<std::uint32_t> unchecked;
    unchecked.reserve(3 * triangles_.size());
    for (std::uint32_t h = 0; h < 3 * triangles_.size(); ++h) unchecked.push_back(h);
    while (!unchecked.empty()) {
      const std::uint32_t h = unchecked.back();
      unchecked.pop_back();
      if (!is_below_hull(h)) continue;
      const std::uint32_t g = twins_[h];
      flip(h);
      for (const std::uint32_t side : {h, next(h), next(next(h)), g, next(g), next(next(g))}) {
        unchecked.push_back(side);
      }
    }
  }

  // Moves every vertex to the unit vector along the sum of its triangles' area vectors, each weighted by a
  // power of the triangle's sagitta. Power 0 puts the vertex where the volume is largest with all others
  // fixed, because the volume is linear in it; higher powers pull it towards the deepest triangles.
  void spread(int power) {
    sort_stars();
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      Vec3d sum{0, 0, 0};
      for (std::uint32_t i = star_offsets_[v]; i < star_offsets_[v + 1]; ++i) {
        const auto [a, b, c] = corners(star_triangles_[i]);
        const Vec3d area = cross(b - a, c - a);
        const double depth = std::max(0.0, 1 - dot(area, a) / length(area));
        sum = sum + area * (power == 0 ? 1.0 : power == 1 ? depth : depth * depth);
      }
      positions_[v] = normalised(sum);
    }
  }

  // nullopt if a triangle does not face outward.
  std::optional<BallTemplate> measured() && {
    BallTemplate ball;
    double six_volumes = 0;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const auto [a, b, c] = corners(t);
      const Vec3d area = cross(b - a, c - a);
      const double six_volume = dot(area, a);
      // The plane is nearest to the centre inside the triangle, or else the bound is on the safe side.
      const double depth = 1 - six_volume / length(area);
      if (!(six_volume > 0) || !(depth < 1)) return std::nullopt;
      ball.sagitta = std::max(ball.sagitta, depth);
      six_volumes += six_volume;
    }
    ball.volume_share = six_volumes / (8 * std::numbers::pi);
    // Triangles that all face outward could still wind twice around the centre.
    if (!(ball.volume_share < 1)) return std::nullopt;
    ball.directions = std::move(positions_);
    ball.triangles = std::move(triangles_);
    return ball;
  }

 private:
  std::uint32_t start(std::uint32_t half_edge) const { return triangles_[half_edge / 3][half_edge % 3]; }

  std::array<Vec3d, 3> corners(std::uint32_t triangle) const {
    const Triangle& t = triangles_[triangle];
    return {positions_[t[0]], positions_[t[1]], positions_[t[2]]};
  }

  bool pair_half_edges() {
    struct Side {
      std::uint64_t edge;
      std::uint32_t half_edge;
    };
    std::vector<Side> sides(3 * triangles_.size());
    for (std::uint32_t h = 0; h < sides.size(); ++h) {
      const std::uint64_t from = start(h), to = start(next(h));
      sides[h] = {std::min(from, to) << 32 | std::max(from, to), h};
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return a.edge != b.edge ? a.edge < b.edge : a.half_edge < b.half_edge;
    });
    twins_.resize(sides.size());
    for (std::size_t i = 0; i < sides.size(); i += 2) {
      if (i + 1 == sides.size() || sides[i].edge != sides[i + 1].edge) return false;
      if (i + 2 < sides.size() && sides[i + 2].edge == sides[i].edge) return false;
      const std::uint32_t g = sides[i].half_edge, h = sides[i + 1].half_edge;
      if (start(g) == start(h)) return false;
      twins_[g] = h;
      twins_[h] = g;
    }
    return true;
  }

  bool is_connected() const {
    std::vector<bool> reached(triangles_.size());
    std::vector<std::uint32_t> unvisited{0};
    reached[0] = true;
    std::size_t count = 1;
    while (!unvisited.empty()) {
      const std::uint32_t t = unvisited.back();
      unvisited.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t neighbour = twins_[h] / 3;
        if (reached[neighbour]) continue;
        reached[neighbour] = true;
        ++count;
        unvisited.push_back(neighbour);
      }
    }
    return count == triangles_.size();
  }

  bool is_below_hull(std::uint32_t h) const {
    const auto [a, b, c] = corners(h / 3);
    const Vec3d opposite = positions_[start(next(next(twins_[h])))];
    const Vec3d area = cross(b - a, c - a);
    return dot(area, opposite - a) > kFlat * length_squared(area);
  }

  // a -> b with c on its left and d on its right becomes d -> c; the four outer sides keep their twins.
  void flip(std::uint32_t h) {
    const std::uint32_t g = twins_[h];
    const std::uint32_t bc = next(h), ca = next(bc), ad = next(g), db = next(ad);
    const std::uint32_t c = start(ca), d = start(db);
    const std::uint32_t twin_bc = twins_[bc], twin_ad = twins_[ad];
    // Half-edge h becomes a -> d, bc becomes d -> c; g becomes b -> c, ad becomes c -> d.
    triangles_[bc / 3][bc % 3] = d;
    triangles_[ad / 3][ad % 3] = c;
    pair(h, twin_ad);
    pair(g, twin_bc);
    pair(bc, ad);
  }

  void pair(std::uint32_t g, std::uint32_t h) {
    twins_[g] = h;
    twins_[h] = g;
  }

  // The triangles around each vertex in CSR form.
  void sort_stars() {
    star_offsets_.assign(positions_.size() + 1, 0);
    star_triangles_.resize(3 * triangles_.size());
    for (const Triangle& t : triangles_) {
      for (const std::uint32_t v : t) ++star_offsets_[v];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& offset : star_offsets_) offset = sum += offset;
    for (std::uint32_t i = static_cast<std::uint32_t>(triangles_.size()); i-- > 0;) {
      for (const std::uint32_t v : triangles_[i]) star_triangles_[--star_offsets_[v]] = i;
    }
  }

  std::vector<Vec3d> positions_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint32_t> star_offsets_, star_triangles_;
};

double largest_coordinate(const Sphere& ball) {
  const Vec3d c = ball.centre;
  return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}) + ball.radius;
}

// Greatest sagitta of a template for the ball, whose surface then lies at most `radius * sagitta + 2 *
// rounding_margin` deep. Negative or tiny if there is none.
double allowed_sagitta(const Sphere& ball, double tolerance) {
  return (tolerance - 2 * rounding_margin(ball)) / ball.radius;
}

// Throws unless fp32 can hold the ball's surface within `tolerance` mm where it is.
void check_resolvable(const Sphere& ball, double tolerance) {
  const double margin = rounding_margin(ball);
  if (tolerance >= kMarginsPerTolerance * margin && ball.radius >= kMarginsPerRadius * margin) return;
  throw FailureError("a void of radius " + std::to_string(ball.radius) + " mm at coordinates up to " +
                         std::to_string(largest_coordinate(ball)) +
                         " mm cannot be kept within a tolerance of " + std::to_string(tolerance) +
                         " mm: coordinates in a mesh file are single precision",
                     "move the model nearer to the origin, or raise --tolerance");
}

// Does the template keep the surface within `tolerance` mm of the sphere, and enough of its volume?
bool suits(const BallTemplate& ball_template, const Sphere& ball, double tolerance) {
  const double shrunk = 1 - rounding_margin(ball) / ball.radius;
  return ball_template.sagitta <= allowed_sagitta(ball, tolerance) &&
         ball_template.volume_share * shrunk * shrunk * shrunk >= kLeastVolumeShare;
}

// Scales and moves a template into its place in a mesh, turned inside out.
void place_void(const BallTemplate& ball_template, const Sphere& ball, const ShellRange& range, Mesh& mesh) {
  const double radius = ball.radius - rounding_margin(ball);
  Vec3f* position = mesh.positions.data() + range.first_vertex;
  for (const Vec3d& direction : ball_template.directions) {
    *position++ = to_float(ball.centre + direction * radius);
  }
  const auto first = static_cast<std::uint32_t>(range.first_vertex);
  Triangle* triangle = mesh.triangles.data() + range.first_triangle;
  for (const Triangle& t : ball_template.triangles) *triangle++ = {t[0] + first, t[2] + first, t[1] + first};
}

double radius_voxels(std::size_t level) {
  return kCoarsestRadiusVoxels * std::pow(kRadiusStep, static_cast<double>(level));
}

// Where to begin to look for a level with such a sagitta; monotone.
std::size_t likely_level(double sagitta) {
  const double radius = std::sqrt(kTypicalSagitta / sagitta);
  const double level = std::ceil(std::log(radius / kCoarsestRadiusVoxels) / std::log(kRadiusStep));
  return static_cast<std::size_t>(std::clamp(level, 0.0, static_cast<double>(kLevelCount)));
}

}  // namespace

// The largest coordinate M of the ball rounds by at most 2^-24 M, so a vertex moves by at
// most sqrt(3) 2^-24 M < 2^-23 M; what is left covers the rounding of the fp64 arithmetic.
double rounding_margin(const Sphere& ball) {
  return std::ldexp(largest_coordinate(ball), -23);
}

std::optional<BallTemplate> project_onto_ball(const Mesh& surface, Vec3d centre) {
  std::vector<Vec3d> directions;
  directions.reserve(surface.positions.size());
  for (const Vec3f& p : surface.positions) directions.push_back(normalised(to_double(p) - centre));
  Triangulation triangulation(std::move(directions), surface.triangles);
  if (!triangulation.connect()) return std::nullopt;
  triangulation.flip_to_hull();
  return std::move(triangulation).measured();
}

std::optional<BallTemplate> relax(BallTemplate ball) {
  Triangulation triangulation(std::move(ball.directions), std::move(ball.triangles));
  if (!triangulation.connect()) return std::nullopt;
  // Passes at each power: 6 come within some per cent of what more of them reach. Going straight to the power
  // of 2 diverges.
  constexpr std::array<int, 3> kPasses{6, 6, 8};
  for (int power = 0; power < 3; ++power) {
    for (int pass = 0; pass < kPasses[static_cast<std::size_t>(power)]; ++pass) {
      triangulation.spread(power);
      triangulation.flip_to_hull();
    }
  }
  return std::move(triangulation).measured();
}

Solid assemble(Mesh outer, std::span<const Sphere> balls, std::span<const BallTemplate* const> templates) {
  assert(balls.size() == templates.size());
  Solid solid;
  solid.outer_triangle_count = outer.triangles.size();
  solid.outer_vertex_count = outer.positions.size();
  solid.void_shells.reserve(templates.size());
  ShellRange range{solid.outer_triangle_count, 0, solid.outer_vertex_count, 0};
  for (const BallTemplate* ball_template : templates) {
    range.triangle_count = ball_template->triangles.size();
    range.vertex_count = ball_template->directions.size();
    solid.void_shells.push_back(range);
    range.first_triangle += range.triangle_count;
    range.first_vertex += range.vertex_count;
  }
  if (range.first_vertex > std::numeric_limits<std::uint32_t>::max()) {
    throw FailureError("the voids would take " + std::to_string(range.first_triangle) + " triangles",
                       "raise --tolerance, or set --max-triangles");
  }

  solid.mesh = std::move(outer);
  solid.mesh.positions.resize(range.first_vertex);
  solid.mesh.triangles.resize(range.first_triangle);
  tbb::parallel_for(std::size_t{0}, templates.size(), [&](std::size_t i) {
    place_void(*templates[i], balls[i], solid.void_shells[i], solid.mesh);
  });
  return solid;
}

BallLadder::BallLadder() : levels_(kLevelCount) {}
BallLadder::~BallLadder() = default;

const BallLadder::Level& BallLadder::make(std::size_t level) {
  if (!levels_[level]) {
    auto made = std::make_unique<Level>();
    made->ball =
        project_onto_ball(LevelSet::of_ball(kCentreVoxels, radius_voxels(level), 1).surface(), kCentreVoxels);
    if (made->ball) made->ball = relax(std::move(*made->ball));
    levels_[level] = std::move(made);
  }
  return *levels_[level];
}

std::size_t BallLadder::level_for(const Sphere& ball, double tolerance) {
  check_resolvable(ball, tolerance);
  for (std::size_t level = likely_level(allowed_sagitta(ball, tolerance)); level < kLevelCount; ++level) {
    const std::optional<BallTemplate>& made = make(level).ball;
    if (made && suits(*made, ball, tolerance)) return level;
  }
  throw FailureError("a void of radius " + std::to_string(ball.radius) + " mm at a tolerance of " +
                         std::to_string(tolerance) + " mm needs more than a million triangles",
                     "raise --tolerance");
}

void BallLadder::prepare(std::span<const Sphere> balls, double tolerance) {
  std::vector<std::size_t> wanted;
  for (const Sphere& ball : balls) {
    const double sagitta = allowed_sagitta(ball, tolerance);
    const std::size_t level = sagitta > 0 ? likely_level(sagitta) : kLevelCount;
    if (level < kLevelCount && !levels_[level]) wanted.push_back(level);
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  tbb::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t i) { make(wanted[i]); });
}

}  // namespace aerate
