#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "files/cell_table.h"
#include "kernels/exec_cpu.h"
#include "kernels/power_cells.h"
#include "tests/support/balls.h"

namespace aerate {
namespace {

using Json = nlohmann::json;

Vec3d vector_of(const Json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

struct Cells {
  Packing packing;
  CellPlanes planes;
};

// Balls of a face-centred cubic lattice in a box of cubes, a gap from each other.
Cells face_centred(int count, double cube, double gap) {
  Cells cells;
  cells.packing.limits = {.wall = 1.2, .gap = gap, .min_radius = 0.1, .max_radius = cube};
  std::vector<kernels::Ball> balls;
  for (const kernels::Ball& ball : test::face_centred_balls(count, cube)) {
    balls.push_back({ball.centre, ball.radius - gap / 2});
    cells.packing.spheres.push_back({ball.centre, ball.radius - gap / 2, SphereKind::lattice});
  }
  cells.planes = kernels::power_cells(kernels::SerialExecutor{}, balls, gap,
                                      {{0, 0, 0}, Vec3d{cube, cube, cube} * count});
  return cells;
}

TEST(CellTable, OfAFaceCentredLatticeHasRhombicDodecahedra) {
  constexpr double kCube = 2.3, kGap = 0.25;
  const Cells cells = face_centred(4, kCube, kGap);
  const Json file = Json::parse(cell_table(cells.packing, cells.planes, CellTableFormat::json));
  EXPECT_EQ(file["gap"], kGap);
  EXPECT_EQ(file["wall"], 1.2);
  ASSERT_EQ(file["cells"].size(), cells.packing.spheres.size());
  std::size_t whole = 0;
  for (std::size_t i = 0; i < file["cells"].size(); ++i) {
    const Json& cell = file["cells"][i];
    const Vec3d centre = vector_of(cell["sphere"]);
    EXPECT_EQ(centre, cells.packing.spheres[i].centre);
    EXPECT_EQ(cell["sphere"][4], "lattice");
    const bool is_inner = std::min({centre.x, centre.y, centre.z}) > kCube &&
                          std::max({centre.x, centre.y, centre.z}) < 3 * kCube;
    if (!is_inner) continue;
    ++whole;
    ASSERT_EQ(cell["planes"].size(), 12U) << i;
    for (const Json& plane : cell["planes"]) {
      const Vec3d normal = vector_of(plane);
      // Along the diagonals of squares: two coordinates alike and one 0.
      double squares = 0;
      for (const double x : {normal.x, normal.y, normal.z}) {
        EXPECT_NEAR(std::abs(x) * (std::abs(x) - 1 / std::numbers::sqrt2), 0, 1e-12);
        squares += x * x;
      }
      EXPECT_NEAR(squares, 1, 1e-12);
      // The face touches its sphere, and the one behind it is the gap away.
      EXPECT_NEAR(plane[3].get<double>() - dot(normal, centre), cells.packing.spheres[i].radius, 1e-12);
      const Vec3d beyond = vector_of(file["cells"][plane[4].get<std::size_t>()]["sphere"]);
      EXPECT_NEAR(dot(normal, beyond) - plane[3].get<double>(), cells.packing.spheres[i].radius + kGap,
                  1e-12);
    }
  }
  EXPECT_EQ(whole, 32U);
}

TEST(CellTable, ReadsBackToTheSameBits) {
  const Cells cells = face_centred(2, 1.0 / 3, 0.01);
  const Json file = Json::parse(cell_table(cells.packing, cells.planes, CellTableFormat::json));
  for (std::size_t i = 0; i < cells.planes.size(); ++i) {
    const Json& planes = file["cells"][i]["planes"];
    ASSERT_EQ(planes.size(), cells.planes.of(i).size());
    EXPECT_EQ(file["cells"][i]["sphere"][3], cells.packing.spheres[i].radius);
    for (std::size_t k = 0; k < planes.size(); ++k) {
      const CellPlane& plane = cells.planes.of(i)[k];
      EXPECT_EQ(vector_of(planes[k]), plane.normal);
      EXPECT_EQ(planes[k][3], plane.offset);
      EXPECT_EQ(planes[k][4], plane.neighbour);
    }
  }
}

TEST(CellTable, ACellWithoutPlanesHasALineOfItsOwn) {
  Cells cells;
  cells.packing.spheres = {{{1.5, -2, 0.1}, 3, SphereKind::adaptive}};
  cells.planes.first = {0, 0};
  cells.planes.boxes.resize(1);
  EXPECT_EQ(cell_table(cells.packing, cells.planes, CellTableFormat::csv),
            "cell,x,y,z,radius,normal_x,normal_y,normal_z,offset,neighbour\n0,1.5,-2,0.1,3,,,,,\n");
  const Json file = Json::parse(cell_table(cells.packing, cells.planes, CellTableFormat::json));
  EXPECT_EQ(file["cells"][0]["planes"], Json::array());
}

TEST(CellTable, FormatsGoByTheEndingInAnyCase) {
  EXPECT_STREQ(find_cell_table_format("a.CSV").value().ending, ".csv");
  EXPECT_STREQ(find_cell_table_format("folder.ply/a.json").value().ending, ".json");
  for (const char* name : {"a.ply", "a.stl", "csv", "a.csv.stl", ""})
    EXPECT_FALSE(find_cell_table_format(name).has_value()) << name;
}

}  // namespace
}  // namespace aerate
