#include "bench/containers.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>

#include "files/load.h"

namespace aerate::bench {
namespace {

// A point of a profile curve in the (distance from axis, height) half plane.
struct ProfilePoint {
  double radius, height;
};

// The profile, from the lowest point to the highest, turned about the y axis. Ends on the axis become one
// vertex. An end off the axis is closed by a fan without a centre vertex, as the paper's triangle counts
// require.
Mesh revolve(const std::vector<ProfilePoint>& profile, std::uint32_t sides) {
  Mesh mesh;
  std::vector<std::uint32_t> first_vertex;
  for (const ProfilePoint& point : profile) {
    first_vertex.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    const std::uint32_t count = point.radius == 0 ? 1 : sides;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      mesh.positions.push_back(
          to_float({point.radius * std::sin(angle), point.height, point.radius * std::cos(angle)}));
    }
  }
  const auto vertex = [&](std::size_t ring, std::uint32_t side) {
    return first_vertex[ring] + (profile[ring].radius == 0 ? 0 : side % sides);
  };
  for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
    for (std::uint32_t side = 0; side < sides; ++side) {
      const std::uint32_t a = vertex(ring, side), b = vertex(ring, side + 1);
      const std::uint32_t c = vertex(ring + 1, side + 1), d = vertex(ring + 1, side);
      if (a != b) mesh.triangles.push_back({a, b, c});
      if (c != d) mesh.triangles.push_back({a, c, d});
    }
  }
  const auto close = [&](std::size_t ring, bool upwards) {
    if (profile[ring].radius == 0) return;
    for (std::uint32_t side = 1; side + 1 < sides; ++side) {
      const std::uint32_t a = vertex(ring, 0), b = vertex(ring, side), c = vertex(ring, side + 1);
      mesh.triangles.push_back(upwards ? Triangle{a, b, c} : Triangle{a, c, b});
    }
  };
  close(0, false);
  close(profile.size() - 1, true);
  return mesh;
}

// Quarter arcs of `steps` segments: from the lowest point outwards, or from the equator upwards.
void append_arc(std::vector<ProfilePoint>& profile, double radius, double centre_height, int first, int last,
                int steps) {
  for (int i = first; i <= last; ++i) {
    const double angle = std::numbers::pi / 2 * i / steps;
    const bool pole = i == -steps || i == steps;
    profile.push_back({pole ? 0.0 : radius * std::cos(angle), centre_height + radius * std::sin(angle)});
  }
}

Mesh make_torus(double ring_radius, double tube_radius, std::uint32_t rings, std::uint32_t sides) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < rings; ++i) {
    const double u = 2 * std::numbers::pi * i / rings;
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double v = 2 * std::numbers::pi * j / sides;
      const double distance = ring_radius + tube_radius * std::cos(v);
      mesh.positions.push_back(
          to_float({distance * std::sin(u), tube_radius * std::sin(v), distance * std::cos(u)}));
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t j = 0; j < sides; ++j) {
      const std::uint32_t i1 = (i + 1) % rings, j1 = (j + 1) % sides;
      const std::uint32_t a = i * sides + j, b = i1 * sides + j, c = i1 * sides + j1, d = i * sides + j1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

Mesh make_analytic(const std::string& name) {
  constexpr std::uint32_t kSides = 32;
  std::vector<ProfilePoint> profile;
  if (name == "Cube") {
    Mesh mesh;
    for (unsigned corner = 0; corner < 8; ++corner) {
      mesh.positions.push_back({(corner & 1U) != 0 ? 5.0F : -5.0F, (corner & 2U) != 0 ? 5.0F : -5.0F,
                                (corner & 4U) != 0 ? 5.0F : -5.0F});
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
  }
  if (name == "Cone") return revolve({{5, -5}, {0, 5}}, kSides);
  if (name == "Cylinder") return revolve({{5, -5}, {5, 5}}, kSides);
  if (name == "Torus") return make_torus(5, 1.25, 48, 12);
  if (name == "Capsule") {
    append_arc(profile, 2.5, -5, -6, 0, 6);
    profile.push_back({2.5, 0});
    append_arc(profile, 2.5, 5, 0, 6, 6);
    return revolve(profile, kSides);
  }
  append_arc(profile, 5, 0, -8, 8, 8);
  return revolve(profile, kSides);
}

}  // namespace

const std::vector<Container>& paper_containers() {
  static const std::vector<Container> containers = {
      {"Cube", 0.2, 1000.0, 71.96, 0.07, 2.28, 0.21, ""},
      {"Cone", 0.2, 261.80, 69.34, 0.30, 1.56, 0.21, ""},
      {"Cylinder", 0.2, 785.40, 71.11, 0.76, 2.42, 0.22, ""},
      {"Capsule", 0.2, 245.44, 72.95, 3.06, 0.78, 0.17, ""},
      {"Sphere", 0.2, 523.60, 70.65, 8.43, 3.67, 0.27, ""},
      {"Torus", 0.15, 154.21, 63.27, 11.44, 4.82, 0.31, ""},
      {"Bunny", 0.2, std::nullopt, 64.69, 42.97, 4.47, 0.39, "bunny-7202.stl"},
      {"Dragon", 0.05, std::nullopt, 64.00, 910.12, 78.82, 1.65, "dragon-21782.stl"},
      {"Bunny HT", 0.2, std::nullopt, 64.78, 411.39, 47.56, 4.32, "bunny-144k.stl"},
      {"Dragon HT", 0.05, std::nullopt, 64.07, 17639.96, 1144.77, 47.28, "dragon-871k.stl"},
  };
  return containers;
}

std::optional<Mesh> container_mesh(const Container& container, const std::string& model_folder) {
  if (container.model_file.empty()) return make_analytic(container.name);
  const std::filesystem::path file = std::filesystem::path(model_folder) / container.model_file;
  if (!std::filesystem::exists(file)) return std::nullopt;
  return load_model(file).mesh;
}

}  // namespace aerate::bench
