#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <sys/mount.h>
#include <sys/stat.h>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// What a user with a broken file, a full disk or a wrong flag meets: the exit code, a message that says what
// is wrong, and no file left behind.
namespace aerate::test {
namespace {

constexpr int kFailure = 1;
constexpr int kUsage = 2;
constexpr int kUnreadable = 3;
constexpr int kUnusable = 4;
constexpr int kNothing = 5;

void expect_refused(const Job& job, const ProcessResult& result, int exit_code,
                    const std::vector<std::string>& said) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  EXPECT_TRUE(contains(result.err, "aerate: error: "));
  for (const std::string& part : said) EXPECT_TRUE(contains(result.err, part));
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

std::string stl_with(float coordinate) {
  Mesh mesh = block();
  mesh.positions[3].y = coordinate;
  return to_binary_stl(mesh);
}

TEST(BadInput, MissingFile) {
  const Job job;
  expect_refused(job, run(job.hollow(job.folder() / "nowhere.stl")), kUnreadable, {"nowhere.stl"});
}

TEST(BadInput, Directory) {
  const Job job;
  std::filesystem::create_directory(job.folder() / "folder.stl");
  expect_refused(job, run(job.hollow(job.folder() / "folder.stl")), kUnreadable, {"folder.stl", "directory"});
}

// Whoever opens a pipe that nobody writes to waits for ever.
TEST(BadInput, PipesAreRefusedAsAnyInput) {
  const Job job;
  const auto pipe = [&](const std::string& name) {
    const std::filesystem::path path = job.folder() / name;
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    return path.string();
  };
  const auto model = job.input("block.stl", block());
  expect_refused(job, run(job.hollow(pipe("p.stl"))), kUnreadable, {"p.stl", "not a regular file"});
  expect_refused(job, run(job.hollow(model, {"--spheres", pipe("p.csv")})), kUnreadable, {"p.csv"});
  expect_refused(job, run(job.hollow(model, {"--process", pipe("p.json")})), kUnreadable, {"p.json"});
  expect_refused(job, run({AERATE_EXECUTABLE, "hook", pipe("p.gcode")}), kUnreadable, {"p.gcode"});
  std::vector<std::string> configured = job.hollow(model);
  configured.insert(configured.begin() + 1, {"--config", pipe("p.toml")});
  expect_refused(job, run(configured), kUsage, {"p.toml", "not a regular file"});
}

TEST(BadInput, NothingFromOutsideReachesTheTerminalRaw) {
  const Job job;
  const std::string name = "red\x1b[31m\x9b\xff.stl", shown = "red\\x1b[31m\\x9b\\xff.stl";
  const auto broken = job.input(name, "solid \x1b[2J\nfacet \x1b[2J");
  expect_refused(job, run(job.hollow(broken)), kUnreadable, {shown});
  const ProcessResult found = run({AERATE_EXECUTABLE, "inspect", job.input(name, block())});
  EXPECT_TRUE(contains(found.out, shown));
  const std::string obj = "v 0 0 0\nf 1 1 \x1b]0;title\x07\n";
  expect_refused(job, run(job.hollow(job.input("a.obj", obj))), kUnreadable, {"'\\x1b]0;title\\x07'"});
  for (const std::string& text : {found.out, found.err, run(job.hollow(broken)).err})
    EXPECT_EQ(text.find_first_of("\x1b\x07\x9b\xff"), std::string::npos);
}

TEST(BadInput, EmptyFile) {
  for (const char* ending : {"stl", "obj", "ply", "off", "3mf"}) {
    const Job job;
    const auto model = job.input(std::string("empty.") + ending, "");
    expect_refused(job, run(job.hollow(model)), kUnreadable, {"empty.", "empty"});
  }
}

TEST(BadInput, TruncatedBinaryStl) {
  const Job job;
  std::string bytes = to_binary_stl(block());
  bytes.resize(bytes.size() - 120);
  expect_refused(job, run(job.hollow(job.input("cut.stl", bytes))), kUnreadable, {"cut.stl", "12"});
}

TEST(BadInput, WrongTriangleCount) {
  for (const std::uint32_t count : {11U, 13U, 4000000000U}) {
    const Job job;
    std::string bytes = to_binary_stl(block());
    std::memcpy(bytes.data() + 80, &count, sizeof(count));
    bytes += "a comment";
    expect_refused(job, run(job.hollow(job.input("count.stl", bytes))), kUnreadable,
                   {"count.stl", std::to_string(count)});
  }
}

TEST(BadInput, CoordinatesThatAreNoNumbers) {
  const Job job;
  const auto nan = job.input("nan.stl", stl_with(std::numeric_limits<float>::quiet_NaN()));
  const auto infinite = job.input("inf.stl", stl_with(-std::numeric_limits<float>::infinity()));
  expect_refused(job, run(job.hollow(nan)), kUnreadable, {"nan.stl"});
  expect_refused(job, run(job.hollow(infinite)), kUnreadable, {"inf.stl"});
}

TEST(BadInput, RandomBytesWithEachEnding) {
  std::mt19937 random(7);
  for (const char* ending : {"stl", "obj", "ply", "off", "3mf"}) {
    for (const std::size_t size : {std::size_t{3}, std::size_t{200}, std::size_t{20000}}) {
      const Job job;
      std::string bytes(size, '\0');
      for (char& byte : bytes) byte = static_cast<char>(random());
      const auto model = job.input(std::string("noise.") + ending, bytes);
      expect_refused(job, run(job.hollow(model)), kUnreadable, {"noise."});
    }
  }
}

TEST(BadInput, UnknownEnding) {
  const Job job;
  const auto model = job.input("model.step", "ISO-10303-21;");
  expect_refused(job, run(job.hollow(model)), kUnreadable, {"model.step"});
}

TEST(BadInput, AnOutputWithoutAName) {
  const Job job;
  const auto model = job.input("block.stl", block());
  for (const char* command : {"hollow", "pack"}) {
    const ProcessResult result = run({AERATE_EXECUTABLE, command, model, "-o", ""});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_TRUE(contains(result.err, "no name was given")) << result.err;
  }
}

// A block without one of its sides: a hole as large as the model.
Mesh open_block() {
  Mesh mesh = block();
  mesh.triangles.resize(mesh.triangles.size() - 2);  // x = 30
  return mesh;
}

// A sphere with one small triangle missing.
Mesh pricked_sphere() {
  Mesh mesh = make_uv_sphere(15, 40, 60);
  mesh.triangles.erase(mesh.triangles.begin() + 1500);
  return mesh;
}

TEST(BadInput, OpenMeshSaysWhereTheHoleIs) {
  const Job job;
  const auto model = job.input("open.stl", open_block());
  const std::vector<std::string> said{"open.stl", "4 boundary edges form 1 hole near (30.0, 15.0, 15.0) mm",
                                      "42.4 mm across", "--max-hole"};
  for (const char* surface : {"auto", "keep", "remesh"})
    expect_refused(job, run(job.hollow(model, {"--surface", surface})), kUnusable, said);
}

TEST(BadInput, SmallHoleIsClosedWhenRemeshing) {
  for (const char* surface : {"remesh", "auto"}) {
    const Job job;
    const auto model = job.input("pricked.stl", pricked_sphere());
    const ProcessResult result = run(job.hollow(model, {"--surface", surface}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(contains(result.out, "remeshed"));
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{"out.stl"});
  }
}

TEST(BadInput, SmallHoleIsNamedWhenTheSurfaceIsToBeKept) {
  const Job job;
  const auto model = job.input("pricked.stl", pricked_sphere());
  expect_refused(job, run(job.hollow(model, {"--surface", "keep"})), kUnusable,
                 {"pricked.stl", "3 boundary edges form 1 hole near", "--surface remesh"});
}

TEST(BadInput, FlatMesh) {
  const Job job;
  const Mesh flat = make_box({0, 0, 5}, {30, 30, 5});
  expect_refused(job, run(job.hollow(job.input("flat.stl", flat))), kUnusable, {"flat.stl", "flat"});
}

TEST(BadInput, ZeroVolume) {
  // A closed surface that returns along itself.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {30, 0, 0}, {0, 30, 0}, {10, 10, 20}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}, {0, 1, 3}, {0, 3, 1}};
  const Job job;
  expect_refused(job, run(job.hollow(job.input("thin.stl", mesh))), kUnusable, {"thin.stl", "no volume"});
}

TEST(BadInput, InsideOutMeshIsTurnedWithANotice) {
  const Job job;
  const auto model = job.input("turned.stl", turned_inside_out(block()));
  const ProcessResult result = run(job.hollow(model));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "aerate: note: "));
  EXPECT_TRUE(contains(result.err, "inside out"));
  const auto written = job.input("same.stl", block());
  EXPECT_EQ(run(job.hollow(written)).exit_code, 0);
}

TEST(BadInput, TwistedTriangleIsTurnedWithANotice) {
  Mesh mesh = block();
  std::swap(mesh.triangles[4][1], mesh.triangles[4][2]);
  const Job job;
  const ProcessResult result = run(job.hollow(job.input("twisted.stl", mesh)));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "aerate: note: "));
  const std::string turned = read_bytes(job.output());
  EXPECT_EQ(run(job.hollow(job.input("sound.stl", block()))).exit_code, 0);
  EXPECT_EQ(read_bytes(job.output()).size(), turned.size());
}

TEST(BadInput, SurfaceWithoutTwoSides) {
  // A Moebius strip of 12 quads: no choice of orientation is consistent, and it is open besides.
  Mesh strip;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2 * std::numbers::pi * i / 12;
    for (const double side : {-3.0, 3.0}) {
      const double radius = 15 + side * std::cos(angle / 2);
      strip.positions.push_back(
          to_float({radius * std::cos(angle), radius * std::sin(angle), side * std::sin(angle / 2)}));
    }
  }
  for (std::uint32_t i = 0; i < 12; ++i) {
    const std::uint32_t a = 2 * i, b = a + 1;
    const std::uint32_t c = i < 11 ? a + 2 : 1, d = i < 11 ? a + 3 : 0;
    strip.triangles.push_back({a, b, d});
    strip.triangles.push_back({a, d, c});
  }
  for (const char* surface : {"keep", "auto", "remesh"}) {
    const Job job;
    const ProcessResult result = run(job.hollow(job.input("moebius.stl", strip), {"--surface", surface}));
    EXPECT_EQ(result.exit_code, kUnusable) << result.err;
    EXPECT_TRUE(contains(result.err, "moebius.stl"));
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  }
}

TEST(BadInput, ModelSmallerThanTwiceTheWall) {
  const Job job;
  const auto model = job.input("tiny.stl", make_box({0, 0, 0}, {20, 20, 2}));
  expect_refused(job, run(job.hollow(model)), kNothing, {"tiny.stl", "nothing to remove", "radius 1 mm"});
}

TEST(BadInput, ModelInAnotherUnitIsNotToldToChangeTheWall) {
  const Job job;
  const auto model = job.input("metres.stl", make_box({0, 0, 0}, {0.02F, 0.02F, 0.02F}));
  expect_refused(job, run(job.hollow(model)), kNothing,
                 {"radius 0.01 mm", "near (0.0, 0.0, 0.0) mm", "--unit"});
}

TEST(BadInput, NothingAsLargeAsAskedSaysWhatWouldFit) {
  const Job job;
  const auto model = job.input("thin.stl", make_box({0, 0, 0}, {20, 20, 4}));
  // 4 mm less two walls of 1.2 mm leave spheres of 0.8 mm.
  expect_refused(job, run(job.hollow(model, {"--min-radius", "2"})), kNothing, {"thin.stl", "radius 0.8"});
}

TEST(BadInput, OutputThatCannotBeWritten) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const auto refused = [&](const std::string& output, int exit_code) {
    const ProcessResult result = run({AERATE_EXECUTABLE, "hollow", model, "-o", output});
    expect_refused(job, result, exit_code, {output});
  };
  refused((job.outputs() / "no" / "such" / "folder" / "out.stl").string(), kFailure);
  refused("/proc/out.stl", kFailure);
  refused((job.outputs() / "out.xyz").string(), kUsage);

  std::filesystem::create_directory(job.folder() / "folder.stl");
  refused((job.folder() / "folder.stl").string(), kFailure);
  EXPECT_TRUE(std::filesystem::is_directory(job.folder() / "folder.stl"));
  refused("/dev/null", kUsage);  // has no ending that names a format
}

TEST(BadInput, OutputThatIsTheModel) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const std::string before = read_bytes(model);
  std::filesystem::create_symlink(model, job.folder() / "link.stl");
  for (const auto& output : {model, job.folder() / "link.stl"}) {
    const ProcessResult result = run({AERATE_EXECUTABLE, "hollow", model, "-o", output});
    expect_refused(job, result, kUsage, {"the output is the model itself"});
    EXPECT_EQ(read_bytes(model), before);
  }
}

TEST(BadInput, ReportThatCannotBeWrittenIsFoundBeforeTheWork) {
  const Job job;
  const auto model = job.input("block.stl", block());
  expect_refused(job, run(job.hollow(model, {"--json", (job.folder() / "no" / "report.json").string()})),
                 kFailure, {"report.json"});
  const std::string before = read_bytes(model);
  expect_refused(job, run(job.hollow(model, {"--json", model.string()})), kUsage, {"--json"});
  EXPECT_EQ(read_bytes(model), before);
}

// A small file system of its own, or nothing where mounting is not allowed.
class SmallDisk {
 public:
  SmallDisk(const std::filesystem::path& folder, const char* options) : folder_(folder) {
    mounted_ = mount("tmpfs", folder_.c_str(), "tmpfs", 0, options) == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount(folder_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }

 private:
  std::filesystem::path folder_;
  bool mounted_;
};

TEST(BadInput, FullDisk) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const SmallDisk disk(job.outputs(), "size=64k");
  if (!disk.mounted()) GTEST_SKIP() << "no permission to mount a small tmpfs";
  expect_refused(job, run(job.hollow(model)), kFailure, {"out.stl", "No space left on device"});
}

TEST(BadInput, FullDiskKeepsWhatWasThere) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const SmallDisk disk(job.outputs(), "size=64k");
  if (!disk.mounted()) GTEST_SKIP() << "no permission to mount a small tmpfs";
  std::ofstream(job.output()) << "an earlier result";
  EXPECT_EQ(run(job.hollow(model)).exit_code, kFailure);
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{"out.stl"});
  EXPECT_EQ(read_bytes(job.output()), "an earlier result");
}

TEST(BadInput, FullStandardOutput) {
  const Job job;
  const auto model = job.input("block.stl", block());
  std::string command = std::string(AERATE_EXECUTABLE) + " inspect " + model.string() + " > /dev/full";
  const ProcessResult result = run({"sh", "-c", command});
  EXPECT_EQ(result.exit_code, kFailure);
  EXPECT_TRUE(contains(result.err, "standard output"));
}

TEST(BadInput, NumbersThatMakeNoSense) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& said) {
    expect_refused(job, run(job.hollow(model, arguments)), kUsage, {arguments.front(), said});
  };
  refused({"--wall", "-1"}, "-1 mm");
  refused({"--wall", "nan"}, "not a number");
  refused({"--wall", "inf"}, "not a number");
  refused({"--wall", "1.2mm"}, "not a number");
  refused({"--wall", "1e300"}, "too much");
  refused({"--gap", "-0.5"}, "-0.5 mm");
  refused({"--max-radius", "0"}, "0 mm");
  refused({"--min-radius", "0"}, "0 mm");
  refused({"--min-radius", "30"}, "more than --max-radius 25 mm");
  refused({"--tolerance", "0"}, "0 mm");
  refused({"--tolerance", "0.5"}, "--min-radius 0.62 mm");
  refused({"--scale", "0"}, "more than 0");
  refused({"--scale", "1,1,0"}, "more than 0");
  refused({"--scale", "1,-1,1"}, "-1 is too little");
  refused({"--scale", "1,1"}, "'1,1' is neither a number nor three");
  refused({"--scale", "1,1,1e10"}, "too much");
  refused({"--unit", "furlong"}, "furlong");
  refused({"--threads", "0"}, "at least 1");
  refused({"--density", "-1"}, "-1 g/cm3");
  refused({"--max-triangles", "3"}, "3 triangles");
  refused({"--max-triangles", "4000.5"}, "not a whole number");
  refused({"--max-voids", "2.5"}, "not a whole number");
  refused({"--threads", "1.5"}, "not a whole number");
  refused({"--max-triangles", "20"}, "12 triangles of its own");
  refused({"--surface", "paint"}, "paint");
  refused({"--packing", "random"}, "random");
  refused({"--no-such-option"}, "");
}

TEST(BadInput, GivenSpheresThatAreNoPackingOfTheModel) {
  const auto file_refused = [&](const std::string& name, const std::string& text, int exit_code,
                                const std::vector<std::string>& said) {
    const Job job;
    const auto model = job.input("block.stl", make_box({0, 0, 0}, {30, 30, 30}));
    const auto spheres = job.input(name, text);
    expect_refused(job, run(job.hollow(model, {"--spheres", spheres.string()})), exit_code, said);
  };
  const auto refused = [&](const std::string& rows, const std::vector<std::string>& said) {
    file_refused("list.csv", "x,y,z,radius,kind\n" + rows, kUnreadable, said);
  };
  refused("10,10,10,3,adaptive\n12,10,10,3,adaptive\n", {"list.csv", "sphere", "gap of -4 mm", "sphere 1"});
  refused("10,10,10,3,adaptive\n50,10,10,3,adaptive\n", {"sphere 2", "(50.000, 10.000, 10.000)", "outside"});
  refused("3.5,10,10,3,adaptive\n", {"sphere 1", "wall of 0.5 mm"});
  refused("10,10,10,-3,adaptive\n", {"line 2", "radius of -3"});
  refused("10,10,nan,3,adaptive\n", {"line 2", "not finite"});
  refused("10,10,ten,3,adaptive\n", {"line 2", "'ten'"});
  refused("10,10,10,3,cube\n", {"line 2", "'cube'"});
  refused("10,10\n", {"line 2", "2 fields"});
  refused("1e308,10,10,3,adaptive\n", {"sphere 1", "outside"});
  refused("10,10,10,1e308,adaptive\n", {"sphere 1", "wall of"});
  refused("", {"no spheres"});
  file_refused("list.csv", "", kUnreadable, {"list.csv", "the file is empty"});
  file_refused("list.csv", "x,y,z,diameter\n10,10,10,3\n", kUnreadable, {"list.csv", "line 1", "header"});
  file_refused("list.csv", "10,10,10,3,adaptive\n", kUnreadable, {"list.csv", "line 1", "header"});
  file_refused("list.json", "{\"spheres\": [[10, 10, 10, 3]]}", kUnreadable, {"list.json", "schema"});
  file_refused("list.ply", "solid\n", kUnreadable, {"list.ply", "line 1", "PLY"});
  file_refused("list.stl", "solid\n", kUsage, {"list.stl", ".csv, .json or .ply"});
}

TEST(BadInput, GivenSpheresOfOtherRadiiThanAskedFor) {
  const Job job;
  const auto model = job.input("block.stl", make_box({0, 0, 0}, {30, 30, 30}));
  const auto spheres = job.input("list.csv", "x,y,z,radius,kind\n10,10,10,3,adaptive\n20,20,20,2,adaptive\n");
  const auto hollow = [&](const char* option, const char* radius) {
    return run(job.hollow(model, {"--spheres", spheres.string(), option, radius}));
  };
  expect_refused(job, hollow("--min-radius", "2.01"), kUnreadable,
                 {"list.csv: sphere 2 (radius 2 mm", "smaller than --min-radius 2.01 mm"});
  expect_refused(job, hollow("--max-radius", "2.99"), kUnreadable,
                 {"list.csv: sphere 1 (radius 3 mm", "larger than --max-radius 2.99 mm"});
  EXPECT_EQ(hollow("--min-radius", "2.00001").exit_code, 0);
  EXPECT_EQ(hollow("--max-radius", "2.99999").exit_code, 0);
}

TEST(BadInput, UnknownMaterialListsTheKnownOnes) {
  const Job job;
  const auto model = job.input("block.stl", block());
  expect_refused(job, run(job.hollow(model, {"--material", "cheese"})), kUsage, {"cheese", "PETG"});
}

TEST(BadInput, MoreThanMemoryHoldsIsRefusedBeforeWorkStarts) {
  const Job job;
  const auto model = job.input("large.stl", make_box({0, 0, 0}, {200, 200, 200}));
  const auto refused = [&](const std::string& method, const std::string& radius) {
    const ProcessResult result =
        run(job.hollow(model, {"--packing", method, "--max-radius", "0.01", "--min-radius", "0.001", "--gap",
                               "0", "--tolerance", "0.0001"}));
    expect_refused(job, result, kUsage, {"would need about", "are available", radius});
  };
  refused("adaptive", "--min-radius");
  refused("adaptive", "--max-voids");
  refused("hexagonal", "--max-radius");
}

TEST(BadInput, ScaleBeyondTheRangeOfTheCoordinates) {
  const Job job;
  const auto model = job.input("block.stl", make_box({0, 0, 0}, {3e37F, 3e37F, 3e37F}));
  const ProcessResult result = run(job.hollow(model, {"--scale", "1e9"}));
  EXPECT_NE(result.exit_code, 0);
  EXPECT_TRUE(contains(result.err, "block.stl"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

}  // namespace
}  // namespace aerate::test
