#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "kernels/adaptive_packing.h"
#include "kernels/exec_cpu.h"
#include "kernels/exec_cuda.h"
#include "tests/cuda/cuda_test.h"
#include "tests/cuda/same_bits.h"
#include "tests/support/adaptive_input.h"
#include "tests/support/shapes.h"

// Each kernel of the adaptive packer on a CUDA device and in a serial loop, on a model that is half packed:
// the same bytes.

namespace aerate::kernels {
namespace {

using AdaptiveKernelsCuda = test::CudaTest;
using Bytes = std::vector<std::uint8_t>;

constexpr double kWall = 0.1, kGap = 0.05, kReach = 0.9;

template <typename T>
Bytes bytes_of(const std::vector<T>& values) {
  Bytes bytes(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

template <typename Executor, typename T>
Bytes bytes_at(const Executor& executor, View<T> view) {
  return bytes_of(executor.download(View<const T>(view)));
}

// Two tori through each other: closed, curved, with a region of winding number 2.
Mesh two_tori() {
  Mesh upright = test::make_torus(5, 2, 32, 16);
  for (Vec3f& p : upright.positions) p = {p.z + 4.5f, p.x, p.y};
  return test::join(test::make_torus(5, 2, 40, 20), upright);
}

struct Job {
  Mesh mesh = two_tori();
  AdaptiveInput input = test::adaptive_input(mesh);
  std::vector<Ball> balls;

  Job() {
    input.parameters.wall = kWall;
    input.parameters.gap = kGap;
    input.parameters.min_radius = 0.5;
    input.parameters.max_count = 30;
    balls = AdaptivePacking<>::pack(SerialExecutor{}, input).balls;
  }
};

// The field of the half-packed model in an executor's memory.
template <typename Executor>
struct Packed {
  const Executor& executor;
  typename Executor::template Buffer<Facet> facets;
  TriangleBvh<Executor> bvh;
  WindingIndex<Executor> winding;
  typename Executor::template Buffer<Ball> balls;
  BallGrid<Executor> grid;

  Packed(const Executor& exec, const Job& job)
      : executor(exec),
        facets(gather_facets(exec, job.input.positions, job.input.triangles)),
        bvh(build_triangle_bvh(exec, View<const Facet>(facets.view()), job.input.box)),
        winding(build_winding_index(exec, bvh.view.facets, job.input.box)),
        balls(exec.upload(std::span<const Ball>(job.balls))),
        grid(exec) {
    grid.reset(job.input.box, kReach, kGap, 64);
    grid.enter(balls.view(), 0, job.balls.front().radius);
  }

  FieldView<BallShape> field() { return {bvh.view, winding.view, grid.view(), kWall}; }
};

TEST_F(AdaptiveKernelsCuda, JobIsHalfPacked) {
  const Job job;
  ASSERT_EQ(job.balls.size(), 30U);
  EXPECT_LT(job.balls.back().radius, kReach);
}

struct Answer {
  double ball_clearance, signed_distance, value, radius;
  Vec3d centre;
  std::uint32_t ball, facet;
};

struct AskField {
  FieldView<BallShape> field;
  View<const Vec3d> points;
  View<Answer> answers;

  AERATE_HD void operator()(std::size_t i) const {
    const Vec3d p = points[i];
    const NearestBall ball = field.balls.nearest(p, kReach);
    SurfaceAnchor anchor = anchor_at(field, {p, 0, kNone}, p);
    Answer answer{ball.clearance, anchor.signed_distance, 0, 0, {0, 0, 0}, ball.ball, anchor.facet};
    // From an anchor some way off, and with less than all that is known asked for.
    const Vec3d q = p + Vec3d{0.07, -0.03, 0.05};
    const Clearance clearance = clearance_at(field, anchor, q, kReach, i % 2 == 0 ? kReach : 0.2);
    answer.value = clearance.value;
    answer.radius = clearance.radius;
    answer.centre = clearance.centre;
    answers[i] = answer;
  }
};

std::vector<Vec3d> points_in(const Box3d& box, std::size_t count) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(-0.02, 1.02);
  std::vector<Vec3d> points(count);
  for (Vec3d& p : points) {
    const double x = share(random), y = share(random), z = share(random);
    p = box.lower + Vec3d{x * (box.upper.x - box.lower.x), y * (box.upper.y - box.lower.y),
                          z * (box.upper.z - box.lower.z)};
  }
  return points;
}

template <typename Executor>
std::vector<Answer> ask_field(const Executor& executor, const Job& job) {
  Packed<Executor> packed(executor, job);
  const std::vector<Vec3d> points = points_in(job.input.box, 2000);
  const auto uploaded = executor.upload(std::span<const Vec3d>(points));
  auto answers = executor.template allocate<Answer>(points.size());
  executor.for_each_index(points.size(), AskField{packed.field(), uploaded.view(), answers.view()});
  return executor.download(View<const Answer>(answers.view()));
}

TEST_F(AdaptiveKernelsCuda, QueriesOfTheField) {
  const Job job;
  const std::vector<Answer> expected = ask_field(SerialExecutor{}, job);
  const auto near_ball = [](const Answer& a) { return a.ball != kNone; };
  const auto inside = [](const Answer& a) { return a.signed_distance > 0; };
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), near_ball), 100);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), inside), 100);
  EXPECT_EQ(bytes_of(ask_field(CudaExecutor(0), job)), bytes_of(expected));
}

// The balls that each cell names, in the order of their numbers: that of the lists is free.
template <typename Executor>
std::vector<std::vector<std::uint32_t>> cells_of(const Executor& executor,
                                                 const BallGridView<BallShape>& grid) {
  const auto entries = executor.download(View<const BallEntry>(grid.entries));
  const auto heads = executor.download(View<const std::uint32_t>(grid.heads));
  const auto starts = executor.download(grid.starts);
  const auto listed = executor.download(grid.listed);
  std::vector<std::vector<std::uint32_t>> cells;
  cells.reserve(heads.size());
  for (std::size_t k = 0; k < heads.size(); ++k) {
    std::vector<std::uint32_t> cell(listed.begin() + starts.at(k), listed.begin() + starts.at(k + 1));
    const std::uint32_t head = heads[k];
    if (head != kNone && (head & BallGridView<BallShape>::kInsideBit) != 0) {
      cell.push_back(head);
    } else {
      for (std::uint32_t i = head; i != kNone; i = entries[i].next) cell.push_back(entries[i].ball);
    }
    std::sort(cell.begin(), cell.end());
    cells.push_back(cell);
  }
  return cells;
}

constexpr double kReachOfSmallCells = kReach / 3;  // so small that some lie within balls

// All balls listed.
template <typename Executor>
std::vector<std::vector<std::uint32_t>> cells_of_grid(const Executor& executor, const Job& job) {
  Packed<Executor> packed(executor, job);
  packed.grid.reset(job.input.box, kReachOfSmallCells, kGap, 64);
  EXPECT_EQ(packed.grid.view().entries.size, 0U);
  return cells_of(executor, packed.grid.view());
}

// Most balls listed, and the last few linked.
template <typename Executor>
std::vector<std::vector<std::uint32_t>> cells_with_latecomers(const Executor& executor, const Job& job) {
  const std::size_t early = job.balls.size() - 5;
  Packed<Executor> packed(executor, job);
  BallGrid<Executor> grid(executor);
  grid.reset(job.input.box, kReachOfSmallCells, kGap, 64);
  grid.enter({packed.balls.view().data, early}, 0, job.balls.front().radius);
  grid.reset(job.input.box, kReachOfSmallCells, kGap, 64);
  EXPECT_GT(grid.view().listed.size, 0U);
  grid.enter(packed.balls.view(), early, job.balls.front().radius);
  EXPECT_GT(grid.view().entries.size, 0U);
  return cells_of(executor, grid.view());
}

TEST_F(AdaptiveKernelsCuda, GridOfBalls) {
  const Job job;
  const auto expected = cells_of_grid(SerialExecutor{}, job);
  const auto shared = [](const std::vector<std::uint32_t>& cell) { return cell.size() > 2; };
  const auto inside = [](const std::vector<std::uint32_t>& cell) {
    return cell.size() == 1 && (cell[0] & BallGridView<BallShape>::kInsideBit) != 0;
  };
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), shared), 5);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), inside), 5);
  EXPECT_EQ(cells_of_grid(CudaExecutor(0), job), expected);
}

// A cell that turned out to lie within a ball only later may name others beside it, which no query sees.
TEST_F(AdaptiveKernelsCuda, GridOfBallsWithLatecomers) {
  const Job job;
  EXPECT_EQ(cells_with_latecomers(CudaExecutor(0), job), cells_with_latecomers(SerialExecutor{}, job));
}

// The tree of cells after each kernel that handles it.
struct TreeStages {
  Bytes roots, root_bounds, fates, parents, searched, child_fates, children, cells, bounds, kept;
  Tally examined{}, made{};
};

template <typename Executor>
TreeStages run_tree(const Executor& executor, const Job& job) {
  using namespace cell_tree_detail;
  Packed<Executor> packed(executor, job);
  const FieldView<BallShape> field = packed.field();
  constexpr std::uint32_t kAlong = 9;
  constexpr std::size_t kRoots = kAlong * kAlong * kAlong, kMost = 9 * kRoots;
  constexpr double kThreshold = 0.5, kLeast = 0.3;
  const Vec3d size = job.input.box.upper - job.input.box.lower;
  const double edge = max_of(size.x, max_of(size.y, size.z)) / kAlong;
  const double half_diagonal = edge * kHalfDiagonalOfEdge;
  auto cell_buffer = executor.template allocate<Cell>(kMost);
  auto bound_buffer = executor.template allocate<double>(kMost);
  const CellsView cells{cell_buffer.view(), bound_buffer.view(), half_diagonal};
  TreeStages stages;

  executor.for_each_index(kRoots,
                          MakeRoots<BallShape>{cells, field, job.input.box.lower, edge, kAlong, kAlong});
  stages.roots = bytes_at(executor, View<Cell>{cells.cells.data, kRoots});
  stages.root_bounds = bytes_at(executor, View<double>{cells.bounds.data, kRoots});

  // Coarse enough that some are searched at once, and others halved.
  const double finest = half_diagonal;
  auto fates = executor.template allocate<CellFate>(kRoots);
  executor.for_each_index(kRoots,
                          Examine<BallShape>{cells, field, 0, kThreshold, 0.5 * finest, fates.view()});
  stages.fates = bytes_at(executor, fates.view());
  auto parents = executor.template allocate<Cell>(kRoots);
  auto next_parents = executor.template allocate<Cell>(8 * kRoots);
  auto searched = executor.template allocate<std::uint32_t>(kMost);
  stages.examined = executor.select(kRoots, TallyCells{cells, fates.view(), 0, kLeast},
                                    ListCells{cells, fates.view(), 0, parents.view(), searched.view()});
  stages.parents = bytes_at(executor, View<Cell>{parents.view().data, stages.examined.first});

  const std::size_t made = 8 * std::size_t{stages.examined.first};
  auto children = executor.template allocate<Child>(made);
  auto child_fates = executor.template allocate<CellFate>(made);
  executor.for_each_index(
      made, MakeChildren<BallShape>{field, half_diagonal, parents.view(), kThreshold, 0.5 * finest, kLeast,
                                    children.view(), child_fates.view()});
  stages.child_fates = bytes_at(executor, child_fates.view());
  stages.made = executor.select(made, TallyChildren{child_fates.view()},
                                AppendChildren{children.view(), child_fates.view(), cells, kRoots,
                                               next_parents.view(), searched.view()});
  const std::size_t count = kRoots + stages.made.third;
  stages.searched = bytes_at(executor, View<std::uint32_t>{searched.view().data, stages.made.second});
  stages.cells = bytes_at(executor, View<Cell>{cells.cells.data, count});
  stages.bounds = bytes_at(executor, View<double>{cells.bounds.data, count});

  auto kept = executor.template allocate<Child>(count);
  const Tally useful = executor.select(count, TallyUseful{{cells.bounds.data, count}, kLeast},
                                       KeepUseful{cells.cells, cells.bounds, kLeast, kept.view()});
  executor.for_each_index(useful.first, PutBack{kept.view(), cells, 0});
  stages.kept = bytes_at(executor, View<Cell>{cells.cells.data, useful.first});
  return stages;
}

TEST_F(AdaptiveKernelsCuda, TreeOfCells) {
  const Job job;
  const TreeStages cpu = run_tree(SerialExecutor{}, job);
  const TreeStages cuda = run_tree(CudaExecutor(0), job);
  EXPECT_GT(cpu.examined.first, 20U);
  EXPECT_GT(cpu.made.second, 20U);
  EXPECT_GT(cpu.made.third, cpu.made.second);
  EXPECT_LT(cpu.kept.size(), cpu.cells.size());
  EXPECT_EQ(cuda.roots, cpu.roots);
  EXPECT_EQ(cuda.root_bounds, cpu.root_bounds);
  EXPECT_EQ(cuda.fates, cpu.fates);
  EXPECT_EQ(cuda.parents, cpu.parents);
  EXPECT_EQ(cuda.child_fates, cpu.child_fates);
  EXPECT_EQ(cuda.searched, cpu.searched);
  EXPECT_EQ(cuda.cells, cpu.cells);
  EXPECT_EQ(cuda.bounds, cpu.bounds);
  EXPECT_EQ(cuda.kept, cpu.kept);
}

// Searches in cells of a grid, and what becomes of what they find.
struct RoundStages {
  Bytes found, bounds, candidates, keys, order, ranked, verdicts, balls;
  std::size_t searches = 0, accepted = 0;
};

template <typename Executor>
RoundStages run_round(const Executor& executor, const Job& job) {
  using namespace adaptive_detail;
  using namespace selection_detail;
  Packed<Executor> packed(executor, job);
  constexpr std::uint32_t kAlong = 16;
  constexpr std::size_t kCells = kAlong * kAlong * kAlong;
  const Vec3d size = job.input.box.upper - job.input.box.lower;
  const double edge = max_of(size.x, max_of(size.y, size.z)) / kAlong;
  auto cell_buffer = executor.template allocate<Cell>(kCells);
  auto bound_buffer = executor.template allocate<double>(kCells);
  const CellsView cells{cell_buffer.view(), bound_buffer.view(),
                        edge * cell_tree_detail::kHalfDiagonalOfEdge};
  executor.for_each_index(kCells, cell_tree_detail::MakeRoots<BallShape>{
                                      cells, packed.field(), job.input.box.lower, edge, kAlong, kAlong});
  std::vector<std::uint32_t> list;
  for (std::uint32_t i = 0; i < kCells; i += 3) list.push_back(i);
  const auto listed = executor.upload(std::span<const std::uint32_t>(list));
  auto searched = executor.template allocate<Candidate>(list.size());
  auto found = executor.template allocate<std::uint8_t>(list.size());
  RoundStages stages;
  stages.searches = list.size();
  executor.for_each_index(list.size(), Search<BallShape>{cells,
                                                         packed.field(),
                                                         listed.view(),
                                                         {0.3, kReach, 3e-5, 1.25},
                                                         1e-12,
                                                         searched.view(),
                                                         found.view()});
  stages.found = bytes_at(executor, found.view());
  stages.bounds = bytes_at(executor, cells.bounds);

  auto candidates = executor.template allocate<Candidate>(list.size());
  auto keys = executor.template allocate<std::uint64_t>(list.size());
  auto order = executor.template allocate<std::uint32_t>(list.size());
  const std::size_t count =
      executor
          .select(
              list.size(), TallyMarked{found.view()},
              ListFound{
                  searched.view(), found.view(), 0, false, {}, candidates.view(), keys.view(), order.view()})
          .first;
  stages.candidates = bytes_at(executor, View<Candidate>{candidates.view().data, count});
  executor.sort_pairs({keys.view().data, count}, {order.view().data, count});
  stages.keys = bytes_at(executor, View<std::uint64_t>{keys.view().data, count});
  stages.order = bytes_at(executor, View<std::uint32_t>{order.view().data, count});

  CandidateGrid<BallShape> grid;
  grid.cells.origin = job.input.box.lower;
  grid.cells.cells_per_mm = 1 / (2.1 * kReach);
  grid.cells.count_x = grid.cells.count_y = grid.cells.count_z = 8;
  grid.gap = kGap;
  auto heads = executor.template allocate<std::uint32_t>(8 * 8 * 8);
  auto next = executor.template allocate<std::uint32_t>(count);
  grid.heads = heads.view();
  grid.next = next.view();
  executor.for_each_index(heads.size(), SetAll<std::uint32_t>{heads.view(), kNone});
  auto ranked = executor.template allocate<Candidate>(count);
  auto even = executor.template allocate<Verdict>(count);
  auto odd = executor.template allocate<Verdict>(count);
  executor.for_each_step(
      Decide<BallShape>::kSteps, count,
      Decide<BallShape>{grid, candidates.view(), order.view(), ranked.view(), even.view(), odd.view()});
  stages.ranked = bytes_at(executor, ranked.view());
  stages.verdicts = bytes_at(executor, even.view());
  auto balls = executor.template allocate<Ball>(count);
  stages.accepted =
      executor
          .select(count, TallyAccepted{even.view()}, PlaceAccepted{ranked.view(), even.view(), balls.view()})
          .first;
  stages.balls = bytes_at(executor, View<Ball>{balls.view().data, stages.accepted});
  return stages;
}

TEST_F(AdaptiveKernelsCuda, SearchesAndSelection) {
  const Job job;
  const RoundStages cpu = run_round(SerialExecutor{}, job);
  const RoundStages cuda = run_round(CudaExecutor(0), job);
  const std::size_t candidates = cpu.order.size() / sizeof(std::uint32_t);
  EXPECT_GT(candidates, 50U);
  EXPECT_LT(candidates, cpu.searches);
  EXPECT_GT(cpu.accepted, 10U);
  EXPECT_LT(cpu.accepted, candidates);
  EXPECT_EQ(cuda.found, cpu.found);
  EXPECT_EQ(cuda.bounds, cpu.bounds);
  EXPECT_EQ(cuda.candidates, cpu.candidates);
  EXPECT_EQ(cuda.keys, cpu.keys);
  EXPECT_EQ(cuda.order, cpu.order);
  EXPECT_EQ(cuda.ranked, cpu.ranked);
  EXPECT_EQ(cuda.verdicts, cpu.verdicts);
  EXPECT_EQ(cuda.balls, cpu.balls);
}

struct SettleStages {
  Bytes candidates, found, paths, awake;

  bool operator==(const SettleStages&) const = default;
};

template <typename Executor>
SettleStages settle(const Executor& executor, const Job& job) {
  using namespace adaptive_detail;
  Packed<Executor> packed(executor, job);
  // Where the largest balls might go: points of a grid that are far enough from everything.
  const Settling settling{0.4};
  const std::vector<Vec3d> points = points_in(job.input.box, 3000);
  std::vector<Candidate> starts;
  std::vector<Cell> places;
  std::vector<std::uint32_t> numbers;
  for (const Vec3d& p : points) {
    starts.push_back({p, 0.45});
    places.push_back({p, 0.45, kNone, 0});
    numbers.push_back(static_cast<std::uint32_t>(numbers.size()));
  }
  auto candidates = executor.upload(std::span<const Candidate>(starts));
  auto cells = executor.upload(std::span<const Cell>(places));
  const auto list = executor.upload(std::span<const std::uint32_t>(numbers));
  auto found = executor.template allocate<std::uint8_t>(starts.size());
  executor.for_each_index(starts.size(), SetAll<std::uint8_t>{found.view(), 1});
  const CellsView view{cells.view(), {}, 1};
  IdleCells<Executor> idle(executor);
  GrowingBuffer<Executor, Ball> balls;
  idle.reset(job.input.box, 1.0, 0.1, balls.size());
  const std::size_t all = idle.awake(view, list.view(), 0, balls).size;
  executor.for_each_index(all, Settle<BallShape>{view, list.view(), packed.field(), settling, 1e-12,
                                                 candidates.view(), found.view(), idle.paths()});
  SettleStages stages{bytes_at(executor, candidates.view()),
                      bytes_at(executor, found.view()),
                      bytes_at(executor, idle.paths()),
                      {}};
  // Some balls are placed near some ways.
  const std::vector<Ball> placed{{points[100], 0.4}, {points[1500], 0.4}};
  const auto uploaded = executor.upload(std::span<const Ball>(placed));
  balls.resize(executor, placed.size());
  executor.for_each_index(placed.size(), CopyElements<Ball>{uploaded.view(), balls.view()});
  auto chosen = idle.awake(view, list.view(), 0, balls);
  stages.awake = bytes_at(executor, chosen);
  return stages;
}

TEST_F(AdaptiveKernelsCuda, LargestBallsSettle) {
  const Job job;
  const SettleStages cpu = settle(SerialExecutor{}, job);
  const auto at_rest = std::count(cpu.found.begin(), cpu.found.end(), 1);
  const auto nowhere = std::count(cpu.found.begin(), cpu.found.end(), 0);
  EXPECT_GT(at_rest, 20);
  EXPECT_GT(nowhere, 20);
  // Those that came to rest, and some of the others.
  EXPECT_GT(cpu.awake.size(), sizeof(std::uint32_t) * static_cast<std::size_t>(at_rest));
  EXPECT_LT(cpu.awake.size(), sizeof(std::uint32_t) * static_cast<std::size_t>(at_rest + nowhere));
  EXPECT_TRUE(settle(CudaExecutor(0), job) == cpu);
}

template <typename Executor>
Bytes order_balls(const Executor& executor, const Job& job, std::size_t count) {
  std::vector<Ball> balls;
  for (const Vec3d& p : points_in(job.input.box, count)) balls.push_back({p, 0.1});
  auto uploaded = executor.upload(std::span<const Ball>(balls));
  BallOrder<Executor>().order(executor, job.input.box, uploaded.view());
  return bytes_at(executor, uploaded.view());
}

// In one block and in several.
TEST_F(AdaptiveKernelsCuda, OrderOfBalls) {
  const Job job;
  for (const std::size_t count : {1, 500, 5000}) {
    EXPECT_EQ(order_balls(CudaExecutor(0), job, count), order_balls(SerialExecutor{}, job, count));
  }
}

template <typename Executor>
std::pair<Bytes, Bytes> run_lattice(const Executor& executor, const Job& job, std::uint32_t trial) {
  Packed<Executor> packed(executor, job);
  const Lattice lattice = make_lattice(job.input.box, 0.4, 0.5, trial);
  auto fits = executor.template allocate<std::uint8_t>(lattice.size());
  executor.for_each_index(lattice.size(),
                          LatticeFit{packed.bvh.view, packed.winding.view, 0.5, lattice, 0, fits.view()});
  auto balls = executor.template allocate<Ball>(lattice.size());
  const Tally total = executor.select(lattice.size(), TallyMarked{fits.view()},
                                      PlaceLattice{lattice, 0, fits.view(), 0.4, balls.view()});
  return {bytes_at(executor, fits.view()), bytes_at(executor, View<Ball>{balls.view().data, total.first})};
}

TEST_F(AdaptiveKernelsCuda, Lattices) {
  const Job job;
  for (const std::uint32_t trial : {0U, 1U, 2U, 4U, 11U}) {
    const auto cpu = run_lattice(SerialExecutor{}, job, trial);
    EXPECT_GT(cpu.second.size(), 50 * sizeof(Ball));
    EXPECT_EQ(run_lattice(CudaExecutor(0), job, trial), cpu) << "trial " << trial;
  }
}

}  // namespace
}  // namespace aerate::kernels
