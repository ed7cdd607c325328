#include "printing/level_set.h"

#include <atomic>
#include <cassert>
#include <cmath>
#include <exception>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/ParticlesToLevelSet.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/TopologyToLevelSet.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <openvdb/tree/LeafManager.h>
#include <thread>
#include <vector>

#include "kernels/winding.h"

namespace aerate {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

const float kBandVoxels = static_cast<float>(openvdb::LEVEL_SET_HALF_WIDTH);

// Lets a monitor stop OpenVDB, which asks from all its threads, by an exception on the caller's own.
class MonitorInterrupter : public openvdb::util::NullInterrupter {
 public:
  explicit MonitorInterrupter(Monitor& monitor) : monitor_(monitor) {}

  bool wasInterrupted(int /*percent*/ = -1) override {
    if (!interrupted_ && std::this_thread::get_id() == caller_) {
      try {
        monitor_.check_interrupted();
      } catch (...) {
        reason_ = std::current_exception();
        interrupted_ = true;
      }
    }
    return interrupted_;
  }

  void rethrow() const {
    if (interrupted_) std::rethrow_exception(reason_);
  }

 private:
  Monitor& monitor_;
  std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<bool> interrupted_{false};
  std::exception_ptr reason_;
};

// What ParticlesToLevelSet reads; its names are OpenVDB's.
struct BallList {
  using PosType = openvdb::Vec3R;

  std::span<const Sphere> balls;

  std::size_t size() const { return balls.size(); }
  void getPos(std::size_t i, openvdb::Vec3R& position) const {
    position = {balls[i].centre.x, balls[i].centre.y, balls[i].centre.z};
  }
  void getPosRad(std::size_t i, openvdb::Vec3R& position, openvdb::Real& radius) const {
    getPos(i, position);
    radius = balls[i].radius;
  }
};

openvdb::FloatGrid::Ptr distances_to(const Mesh& mesh, double voxel_size, int flags, Monitor& monitor) {
  std::vector<openvdb::Vec3s> points;
  points.reserve(mesh.positions.size());
  for (const Vec3f& p : mesh.positions) {
    const Vec3f voxels = to_float(to_double(p) * (1 / voxel_size));
    points.emplace_back(voxels.x, voxels.y, voxels.z);
  }
  std::vector<openvdb::Vec3I> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);

  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_size);
  MonitorInterrupter interrupter(monitor);
  openvdb::util::NullInterrupter& base = interrupter;
  auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(base, adapter, *transform, kBandVoxels,
                                                               kBandVoxels, flags);
  interrupter.rethrow();
  return grid;
}

// Dual contouring of a voxel whose value is 0 gives vertices at one and the same place, which no mesh file
// can keep apart. So the surface keeps this far from voxel centres, in voxels.
constexpr float kLeastValueVoxels = 0.01f;

void keep_off_voxel_centres(openvdb::FloatGrid& grid) {
  const float least = kLeastValueVoxels * static_cast<float>(grid.voxelSize()[0]);
  openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid.tree());
  leaves.foreach ([least](Leaf& leaf, std::size_t) {
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      if (std::abs(*voxel) < least) voxel.setValue(std::copysign(least, *voxel));
    }
  });
}

// Makes unsigned distances negative where the winding number of the voxel's centre is not 0.
void sign_by_winding(openvdb::FloatGrid& grid, const Mesh& mesh, double voxel_size) {
  const kernels::HostWinding index(mesh.positions, mesh.triangles);
  const kernels::WindingView winding = index.view();
  openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid.tree());
  leaves.foreach ([&](Leaf& leaf, std::size_t) {
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      const openvdb::Coord at = voxel.getCoord();
      const Vec3d centre{at.x() * voxel_size, at.y() * voxel_size, at.z() * voxel_size};
      if (winding.winding_number(centre) != 0) voxel.setValue(-std::abs(*voxel));
    }
  });
  openvdb::tools::signedFloodFill(grid.tree());
  grid.setGridClass(openvdb::GRID_LEVEL_SET);
}

}  // namespace

struct LevelSet::Grid {
  openvdb::FloatGrid::Ptr values;
};

LevelSet::LevelSet(std::unique_ptr<Grid> grid) : grid_(std::move(grid)) {
  keep_off_voxel_centres(*grid_->values);
}
LevelSet::~LevelSet() = default;
LevelSet::LevelSet(LevelSet&&) noexcept = default;
LevelSet& LevelSet::operator=(LevelSet&&) noexcept = default;

LevelSet LevelSet::of_solid(const Mesh& mesh, double voxel_size, Interior interior, Monitor& monitor) {
  openvdb::FloatGrid::Ptr grid;
  if (interior == Interior::enclosed) {
    grid = distances_to(mesh, voxel_size, 0, monitor);
  } else {
    grid = distances_to(mesh, voxel_size, openvdb::tools::UNSIGNED_DISTANCE_FIELD, monitor);
    sign_by_winding(*grid, mesh, voxel_size);
  }
  monitor.check_interrupted();
  return LevelSet(std::make_unique<Grid>(Grid{std::move(grid)}));
}

LevelSet LevelSet::of_ball(Vec3d centre, double radius, double voxel_size) {
  assert(radius >= kSmallestRadiusVoxels * voxel_size);
  const Vec3f where = to_float(centre);
  return LevelSet(std::make_unique<Grid>(Grid{openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(
      static_cast<float>(radius), {where.x, where.y, where.z}, static_cast<float>(voxel_size),
      kBandVoxels)}));
}

LevelSet LevelSet::of_balls(std::span<const Sphere> balls, double voxel_size) {
  auto grid = openvdb::createLevelSet<openvdb::FloatGrid>(voxel_size, kBandVoxels);
  if (!balls.empty()) {  // OpenVDB takes the first one unseen
    openvdb::tools::ParticlesToLevelSet<openvdb::FloatGrid> raster(*grid);
    raster.rasterizeSpheres(BallList{balls});
    raster.finalize();
    assert(!raster.ignoredParticles());
  }
  return LevelSet(std::make_unique<Grid>(Grid{std::move(grid)}));
}

LevelSet LevelSet::of_voxels(std::span<const std::array<int, 3>> voxels, double voxel_size) {
  constexpr int kClosing = 0, kDilation = 0, kSmoothing = 2;
  auto mask = openvdb::MaskGrid::create(false);
  mask->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
  auto accessor = mask->getAccessor();
  for (const auto& [x, y, z] : voxels) accessor.setValueOn({x, y, z});
  auto grid = openvdb::tools::topologyToLevelSet(*mask, openvdb::LEVEL_SET_HALF_WIDTH, kClosing, kDilation,
                                                 kSmoothing);
  return LevelSet(std::make_unique<Grid>(Grid{std::move(grid)}));
}

LevelSet LevelSet::without(const std::function<double(Vec3d, double)>& taken) const {
  auto grid = grid_->values->deepCopy();
  const double size = grid->voxelSize()[0];
  openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid->tree());
  leaves.foreach ([&](Leaf& leaf, std::size_t) {
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      const openvdb::Coord at = voxel.getCoord();
      const auto least = static_cast<float>(
          taken({at.x() * size, at.y() * size, at.z() * size}, static_cast<double>(*voxel)));
      if (least > *voxel) voxel.setValue(least);
    }
  });
  return LevelSet(std::make_unique<Grid>(Grid{std::move(grid)}));
}

LevelSet LevelSet::minus(const LevelSet& other) const {
  return LevelSet(
      std::make_unique<Grid>(Grid{openvdb::tools::csgDifferenceCopy(*grid_->values, *other.grid_->values)}));
}

Mesh LevelSet::surface() const {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid_->values, points, quads);
  Mesh mesh;
  mesh.positions.reserve(points.size());
  for (const openvdb::Vec3s& p : points) mesh.positions.push_back({p.x(), p.y(), p.z()});
  // OpenVDB winds its quads clockwise seen from outside.
  mesh.triangles.reserve(2 * quads.size());
  for (const openvdb::Vec4I& q : quads) {
    if ((points[q[0]] - points[q[2]]).lengthSqr() <= (points[q[1]] - points[q[3]]).lengthSqr()) {
      mesh.triangles.push_back({q[0], q[2], q[1]});
      mesh.triangles.push_back({q[0], q[3], q[2]});
    } else {
      mesh.triangles.push_back({q[0], q[3], q[1]});
      mesh.triangles.push_back({q[1], q[3], q[2]});
    }
  }
  return mesh;
}

std::size_t LevelSet::bytes() const {
  return grid_->values->memUsage();
}

}  // namespace aerate
