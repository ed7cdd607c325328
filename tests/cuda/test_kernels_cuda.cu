#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "kernels/exec_cpu.h"
#include "kernels/exec_cuda.h"
#include "kernels/facet_grid.h"
#include "kernels/hexagonal_packing.h"
#include "kernels/nearest_point.h"
#include "kernels/triangle_bvh.h"
#include "kernels/winding.h"
#include "tests/cuda/cuda_test.h"
#include "tests/cuda/same_bits.h"
#include "tests/support/shapes.h"

// Each kernel on a CUDA device and in a serial loop: the same bytes. What the kernels of an index write is
// compared as the index they build.

namespace aerate::kernels {
namespace {

using KernelsCuda = test::CudaTest;

// Two tori through each other: closed, curved, with a region of winding number 2.
Mesh two_tori() {
  Mesh upright = test::make_torus(5, 2, 40, 20);
  for (Vec3f& p : upright.positions) p = {p.z + 4.5f, p.x, p.y};
  return test::join(test::make_torus(5, 2, 48, 24), upright);
}

Box3d box_of(const Mesh& mesh) {
  const Box3f box = bounding_box(mesh);
  return {to_double(box.lower), to_double(box.upper)};
}

std::vector<Vec3d> points_about(const Box3d& box, std::size_t count) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> share(-0.05, 1.05);
  const Vec3d extent = box.upper - box.lower;
  std::vector<Vec3d> points(count);
  for (Vec3d& p : points) {
    const double x = share(random), y = share(random), z = share(random);
    p = box.lower + Vec3d{x * extent.x, y * extent.y, z * extent.z};
  }
  return points;
}

// The same mesh's facets in the memory of both executors.
struct Both {
  Mesh mesh = two_tori();
  Box3d box = box_of(mesh);
  SerialExecutor cpu;
  CudaExecutor cuda{0};
  HostBuffer<Facet> cpu_facets = gather_facets(cpu, mesh.positions, mesh.triangles);
  CudaBuffer<Facet> cuda_facets = gather_facets(cuda, mesh.positions, mesh.triangles);

  View<const Facet> on_cpu() const { return cpu_facets.view(); }
  View<const Facet> on_cuda() const { return cuda_facets.view(); }
};

std::vector<float> numbers_of(const std::vector<Facet>& facets) {
  std::vector<float> numbers;
  for (const Facet& f : facets) {
    for (const Vec3f& p : {f.a, f.b, f.c}) numbers.insert(numbers.end(), {p.x, p.y, p.z});
  }
  return numbers;
}

TEST_F(KernelsCuda, GatherFacets) {
  const Both both;
  EXPECT_EQ(numbers_of(both.cuda.download(both.on_cuda())), numbers_of(both.cpu.download(both.on_cpu())));
}

// References cell by cell, each cell's sorted: their order within a cell is free.
std::vector<std::uint32_t> canonical(const std::vector<std::uint32_t>& offsets,
                                     std::vector<std::uint32_t> references) {
  for (std::size_t cell = 0; cell + 1 < offsets.size(); ++cell) {
    std::sort(references.begin() + offsets[cell], references.begin() + offsets[cell + 1]);
  }
  return references;
}

template <typename CpuIndex, typename CudaIndex>
void expect_same_references(const Both& both, const CpuIndex& cpu, const CudaIndex& cuda) {
  const auto cpu_offsets = both.cpu.download(cpu.view.offsets);
  const auto cuda_offsets = both.cuda.download(cuda.view.offsets);
  ASSERT_EQ(cuda_offsets, cpu_offsets);
  EXPECT_EQ(canonical(cuda_offsets, both.cuda.download(cuda.view.references)),
            canonical(cpu_offsets, both.cpu.download(cpu.view.references)));
}

struct QueryWinding {
  WindingView winding;
  View<const Vec3d> points;
  View<int> numbers;

  AERATE_HD void operator()(std::size_t i) const { numbers[i] = winding.winding_number(points[i]); }
};

template <typename Executor>
std::vector<int> winding_numbers(const Executor& executor, const WindingView& winding,
                                 const std::vector<Vec3d>& points) {
  const auto uploaded = executor.upload(std::span<const Vec3d>(points));
  auto numbers = executor.template allocate<int>(points.size());
  executor.for_each_index(points.size(), QueryWinding{winding, uploaded.view(), numbers.view()});
  return executor.download(numbers.view());
}

TEST_F(KernelsCuda, WindingIndex) {
  const Both both;
  const auto cpu = build_winding_index(both.cpu, both.on_cpu(), both.box);
  const auto cuda = build_winding_index(both.cuda, both.on_cuda(), both.box);
  expect_same_references(both, cpu, cuda);

  const std::vector<Vec3d> points = points_about(both.box, 3000);
  const std::vector<int> expected = winding_numbers(both.cpu, cpu.view, points);
  EXPECT_GT(std::count(expected.begin(), expected.end(), 2), 5);
  EXPECT_GT(std::count(expected.begin(), expected.end(), 1), 100);
  EXPECT_EQ(winding_numbers(both.cuda, cuda.view, points), expected);
}

struct QueryNearness {
  FacetGridView grid;
  View<const Vec3d> points;
  double distance;
  View<std::uint8_t> near;

  AERATE_HD void operator()(std::size_t i) const {
    near[i] = grid.any_facet_within(points[i], distance) ? 1 : 0;
  }
};

template <typename Executor>
std::vector<std::uint8_t> nearness(const Executor& executor, const FacetGridView& grid,
                                   const std::vector<Vec3d>& points, double distance) {
  const auto uploaded = executor.upload(std::span<const Vec3d>(points));
  auto near = executor.template allocate<std::uint8_t>(points.size());
  executor.for_each_index(points.size(), QueryNearness{grid, uploaded.view(), distance, near.view()});
  return executor.download(near.view());
}

TEST_F(KernelsCuda, FacetGrid) {
  const Both both;
  for (const double cell_size : {0.4, 1.7}) {
    const CellGrid grid = make_cell_grid(both.box, cell_size);
    const auto cpu = build_facet_grid(both.cpu, both.on_cpu(), grid);
    const auto cuda = build_facet_grid(both.cuda, both.on_cuda(), grid);
    expect_same_references(both, cpu, cuda);
    const auto sums = [&](const auto& executor, const auto& index) {
      auto all = executor.download(index.view.summed);
      all.resize(grid.cell_count());  // one more counter is allocated than summed
      return all;
    };
    EXPECT_EQ(sums(both.cuda, cuda), sums(both.cpu, cpu));

    const std::vector<Vec3d> points = points_about(both.box, 2000);
    for (const double distance : {0.05, 0.9}) {
      const auto expected = nearness(both.cpu, cpu.view, points, distance);
      EXPECT_GT(std::count(expected.begin(), expected.end(), 1), 5);
      EXPECT_GT(std::count(expected.begin(), expected.end(), 0), 5);
      EXPECT_EQ(nearness(both.cuda, cuda.view, points, distance), expected);
    }
  }
}

struct QueryNearest {
  TriangleBvhView bvh;
  View<const Vec3d> points;
  View<NearestFacet> nearest;

  AERATE_HD void operator()(std::size_t i) const {
    nearest[i] = bvh.nearest(points[i], 1.7976931348623157e308);
  }
};

struct QueryNearestPoint {
  View<const Facet> facets;
  View<const Vec3d> points;
  View<FacetPoint> nearest;

  AERATE_HD void operator()(std::size_t i) const {
    nearest[i] = nearest_point_on_facet(points[i], facets[i % facets.size]);
  }
};

template <typename Executor>
std::vector<NearestFacet> nearest_facets(const Executor& executor, const TriangleBvhView& bvh,
                                         const std::vector<Vec3d>& points) {
  const auto uploaded = executor.upload(std::span<const Vec3d>(points));
  auto nearest = executor.template allocate<NearestFacet>(points.size());
  executor.for_each_index(points.size(), QueryNearest{bvh, uploaded.view(), nearest.view()});
  return executor.download(nearest.view());
}

TEST_F(KernelsCuda, TriangleBvh) {
  const Both both;
  const auto cpu = build_triangle_bvh(both.cpu, both.on_cpu(), both.box);
  const auto cuda = build_triangle_bvh(both.cuda, both.on_cuda(), both.box);
  EXPECT_EQ(both.cuda.download(cuda.view.order), both.cpu.download(cpu.view.order));
  EXPECT_EQ(numbers_of(both.cuda.download(cuda.view.facets)), numbers_of(both.cpu.download(cpu.view.facets)));
  const auto cpu_boxes = both.cpu.download(cpu.view.boxes);
  const auto cuda_boxes = both.cuda.download(cuda.view.boxes);
  ASSERT_EQ(cuda_boxes.size(), cpu_boxes.size());
  for (std::size_t i = 1; i < cpu_boxes.size(); ++i) {
    ASSERT_EQ(cuda_boxes[i].lower, cpu_boxes[i].lower) << "node " << i;
    ASSERT_EQ(cuda_boxes[i].upper, cpu_boxes[i].upper) << "node " << i;
  }

  const std::vector<Vec3d> points = points_about(both.box, 1000);
  const auto expected = nearest_facets(both.cpu, cpu.view, points);
  const auto found = nearest_facets(both.cuda, cuda.view, points);
  std::vector<double> expected_distances, found_distances;
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(found[i].facet, expected[i].facet) << "point " << i;
    expected_distances.push_back(expected[i].distance_squared);
    found_distances.push_back(found[i].distance_squared);
  }
  test::expect_same_bits(found_distances, expected_distances);
}

template <typename Executor>
std::vector<double> nearest_points(const Executor& executor, View<const Facet> facets,
                                   const std::vector<Vec3d>& points) {
  const auto uploaded = executor.upload(std::span<const Vec3d>(points));
  auto nearest = executor.template allocate<FacetPoint>(points.size());
  executor.for_each_index(points.size(), QueryNearestPoint{facets, uploaded.view(), nearest.view()});
  std::vector<double> numbers;
  for (const FacetPoint& p : executor.download(nearest.view())) {
    numbers.insert(numbers.end(),
                   {p.point.x, p.point.y, p.point.z, p.feature == FacetFeature::rim ? 1.0 : 0.0});
  }
  return numbers;
}

TEST_F(KernelsCuda, NearestPointOnFacet) {
  const Both both;
  const std::vector<Vec3d> points = points_about(both.box, 3000);
  test::expect_same_bits(nearest_points(both.cuda, both.on_cuda(), points),
                         nearest_points(both.cpu, both.on_cpu(), points));
}

// Facets without area, and some as long and thin as fp32 has them.
TEST_F(KernelsCuda, NearestPointOnDegenerateFacets) {
  const SerialExecutor cpu;
  const CudaExecutor cuda(0);
  const std::vector<Facet> facets{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}},
                                  {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}},
                                  {{0, 0, 0}, {1000, 0, 0}, {500, 1e-6f, 0}},
                                  {{-0.0f, 0, 0}, {0, -0.0f, 1}, {1e-38f, 0, 0}}};
  const std::vector<Vec3d> points = points_about({{-1, -1, -1}, {3, 3, 3}}, 400);
  const auto on_cpu = cpu.upload(std::span<const Facet>(facets));
  const auto on_cuda = cuda.upload(std::span<const Facet>(facets));
  test::expect_same_bits(nearest_points(cuda, on_cuda.view(), points),
                         nearest_points(cpu, on_cpu.view(), points));
}

// A kind of sphere's places after each kernel that handles them.
struct FamilyStages {
  std::vector<CandidateState> states;
  std::vector<std::uint64_t> state_counts;
  std::vector<std::uint32_t> met;
  std::vector<Sphere> spheres;
};

template <typename Executor>
FamilyStages run_family(const Executor& executor, View<const Facet> facets, const Box3d& box,
                        SphereKind kind) {
  using namespace hexagonal_detail;
  const auto winding = build_winding_index(executor, facets, box);
  const auto grid = build_facet_grid(executor, facets, make_cell_grid(box, 0.8));
  const HexagonalLattice lattice = make_hexagonal_lattice(box, 0.7);
  const auto centres = executor.upload(std::span<const Vec3d>(kCentresOf61InUnitSphere));
  std::vector<std::uint32_t> replaced;
  for (std::uint32_t slot = 3; slot < lattice.cell_count() * kLatticePerCell; slot += 17) {
    replaced.push_back(slot);
  }
  const auto uploaded = executor.upload(std::span<const std::uint32_t>(replaced));
  const CandidateFamily family{lattice, kind,           kind == SphereKind::lattice ? 0.7 : 0.15,
                               0.1,     centres.view(), uploaded.view()};
  const std::uint32_t first_slot = kind == SphereKind::replacement ? 0 : 37;
  const std::size_t count = kind == SphereKind::replacement ? replaced.size() * kReplacements
                                                            : lattice.cell_count() * kLatticePerCell - 37;
  FamilyStages stages;
  auto states = executor.template allocate<CandidateState>(count);
  executor.for_each_index(count, Classify{family, first_slot, winding.view, grid.view, 0.05, states.view()});
  stages.states = executor.download(states.view());

  auto counters = executor.template allocate<std::uint64_t>(kCandidateStates);
  executor.for_each_index(kCandidateStates, SetAll<std::uint64_t>{counters.view(), 0});
  executor.for_each_index(CountStates::threads_for(count), CountStates{states.view(), counters.view()});
  stages.state_counts = executor.download(counters.view());

  const bool lists_met = kind == SphereKind::lattice;
  auto spheres = executor.template allocate<Sphere>(count);
  auto met = executor.template allocate<std::uint32_t>(count);
  const Tally total =
      executor.select(count, TallyStates{states.view(), lists_met},
                      Emit{states.view(), family, first_slot, lists_met, spheres.view(), met.view()});
  stages.spheres = executor.download(View<const Sphere>{spheres.view().data, total.first});
  stages.met = executor.download(View<const std::uint32_t>{met.view().data, total.second});
  return stages;
}

TEST_F(KernelsCuda, HexagonalFamilies) {
  const Both both;
  for (const SphereKind kind :
       {SphereKind::lattice, SphereKind::interstice, SphereKind::tetrahedral, SphereKind::replacement}) {
    SCOPED_TRACE(static_cast<int>(kind));
    const FamilyStages cpu = run_family(both.cpu, both.on_cpu(), both.box, kind);
    const FamilyStages cuda = run_family(both.cuda, both.on_cuda(), both.box, kind);
    EXPECT_GT(cpu.spheres.size(), 5U);
    EXPECT_EQ(cuda.states, cpu.states);
    EXPECT_EQ(cuda.state_counts, cpu.state_counts);
    EXPECT_EQ(cuda.met, cpu.met);
    EXPECT_EQ(cpu.met.size() > 5, kind == SphereKind::lattice);
    test::expect_same_spheres(cuda.spheres, cpu.spheres);
  }
}

// The counts themselves, beside a count by hand.
TEST_F(KernelsCuda, CountsOfStatesAreRight) {
  const CudaExecutor cuda(0);
  for (const std::size_t count : {1, 31, 33, 4096, 10007}) {
    std::mt19937 random(3);
    std::vector<CandidateState> states(count);
    std::vector<std::uint64_t> expected(kCandidateStates, 0);
    for (CandidateState& state : states) {
      state = static_cast<CandidateState>(random() % kCandidateStates);
      ++expected[static_cast<std::size_t>(state)];
    }
    const auto uploaded = cuda.upload(std::span<const CandidateState>(states));
    auto counters = cuda.allocate<std::uint64_t>(kCandidateStates);
    cuda.for_each_index(kCandidateStates, SetAll<std::uint64_t>{counters.view(), 0});
    cuda.for_each_index(hexagonal_detail::CountStates::threads_for(count),
                        hexagonal_detail::CountStates{uploaded.view(), counters.view()});
    EXPECT_EQ(cuda.download(counters.view()), expected) << count << " states";
  }
}

}  // namespace
}  // namespace aerate::kernels
