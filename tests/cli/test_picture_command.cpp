#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/slicer/fake_slicer.h"
#include "tests/support/caught.h"

// Pictures of jobs, seen from the shell.
namespace aerate::test {
namespace {

namespace fs = std::filesystem;

// Width and height as a PNG's header says.
std::pair<std::uint32_t, std::uint32_t> size_of_png(const fs::path& path) {
  const std::string bytes = read_bytes(path);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(bytes.substr(bytes.size() - 8, 4), "IEND");
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  return {number(16), number(20)};
}

ProcessResult aerate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), AERATE_EXECUTABLE);
  return run(arguments);
}

TEST(PictureCommand, IsWrittenBesideTheResultForAnyNumberOfThreads) {
  const Job job;
  const fs::path model = job.input("block.stl", block());
  const fs::path picture = job.outputs() / "block.png", report = job.outputs() / "report.json";
  const ProcessResult result =
      run(job.hollow(model, {"--picture", picture, "--json", report, "--threads", "1"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(size_of_png(picture), (std::pair<std::uint32_t, std::uint32_t>{1000, 800}));
  const auto json = nlohmann::json::parse(read_bytes(report));
  EXPECT_EQ(json["stages"].back()["name"], "picture");
  const std::string bytes = read_bytes(picture), solid = read_bytes(job.output());
  ASSERT_EQ(run(job.hollow(model, {"--picture", picture, "--threads", "3"})).exit_code, 0);
  EXPECT_EQ(read_bytes(picture), bytes);
  // The result is what it is without.
  ASSERT_EQ(run(job.hollow(model)).exit_code, 0);
  EXPECT_EQ(read_bytes(job.output()), solid);
  EXPECT_EQ(entries_of(job.outputs()), (std::vector<std::string>{"block.png", "out.stl", "report.json"}));
}

TEST(PictureCommand, HasTheSizeCutAndColoursAskedFor) {
  const Job job;
  const fs::path model = job.input("block.stl", block());
  const fs::path first = job.outputs() / "a.PNG", second = job.outputs() / "b.png";
  ASSERT_EQ(run(job.hollow(model, {"--picture", first, "--picture-size", "320x240"})).exit_code, 0);
  EXPECT_EQ(size_of_png(first), (std::pair<std::uint32_t, std::uint32_t>{320, 240}));
  std::string before = read_bytes(first);
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--picture-cut", "x=10%"}, {"--picture-cut", "z=100"}, {"--picture-colour", "thickness"}}) {
    std::vector<std::string> options{"--picture", second, "--picture-size", "320x240"};
    options.insert(options.end(), more.begin(), more.end());
    ASSERT_EQ(run(job.hollow(model, options)).exit_code, 0);
    EXPECT_NE(read_bytes(second), before) << more.back();
    before = read_bytes(second);
  }
}

TEST(PictureCommand, ShowsPackingsAndModelsThatWereRead) {
  const Job job;
  const fs::path model = job.input("block.stl", block());
  for (const std::vector<std::string>& as :
       std::vector<std::vector<std::string>>{{"-o", job.outputs() / "spheres.csv"},
                                             {"-o", job.outputs() / "planes.json", "--shape", "cells"},
                                             {"-o", job.outputs() / "pieces.stl", "--shape", "cells"}}) {
    const fs::path picture = job.outputs() / "packed.png";
    std::vector<std::string> command{"pack", model, "--picture", picture};
    command.insert(command.end(), as.begin(), as.end());
    const ProcessResult packed = aerate(command);
    EXPECT_EQ(packed.exit_code, 0) << packed.err;
    EXPECT_TRUE(fs::exists(as[1]));
    EXPECT_GT(fs::file_size(picture), 5000U);
    fs::remove(picture);
  }
  // A surface that is open, has an edge with three triangles, or holds nothing at all.
  Mesh open = block();
  open.triangles.resize(open.triangles.size() - 2);
  Mesh finned = block();
  finned.positions.push_back({15, 15, 60});
  finned.triangles.push_back({0, 1, static_cast<std::uint32_t>(finned.positions.size() - 1)});
  for (const Mesh& mesh : {open, finned, join(block(), moved(block(), {15, 15, 15}))}) {
    const fs::path broken = job.input("broken.stl", mesh), picture = job.outputs() / "broken.png";
    const ProcessResult inspected = aerate({"inspect", broken, "--self-intersections", "--picture", picture});
    EXPECT_EQ(inspected.exit_code, 0) << inspected.err;
    EXPECT_GT(fs::file_size(picture), 5000U);
    fs::remove(picture);
  }
}

// With a program that stands for a slicer.
TEST(PictureCommand, ShowsTheFormThatIsSliced) {
  const Job job;
  const TemporaryFolder folder;
  const FakeSlicer slicer(folder);
  const fs::path model = job.input("block.stl", block()), picture = job.outputs() / "sliced.png";
  std::vector<std::string> seen;
  for (const double voids : {4000.0, 6000.0}) {
    slicer.hands_out("solid", fake_gcode(5000));
    slicer.hands_out("voids", fake_gcode(voids));
    slicer.hands_out("modifiers", fake_gcode(7000));
    const ProcessResult result =
        aerate({"slice", model, "--slicer", "prusa-slicer", "--slicer-path", slicer.program(), "--compare",
                "forms", "--as", "auto", "-o", job.outputs() / "out.gcode", "--picture", picture});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(entries_of(job.outputs()), (std::vector<std::string>{"out.gcode", "sliced.png"}));
    seen.push_back(read_bytes(picture));
  }
  // Hollowed, then solid.
  EXPECT_NE(seen[0], seen[1]);
}

TEST(PictureCommand, NothingIsLeftOfAJobThatFails) {
  const Job job;
  const fs::path model = job.input("thin.stl", make_box({0, 0, 0}, {30, 30, 1}));
  const ProcessResult result = run(job.hollow(model, {"--picture", job.outputs() / "thin.png"}));
  EXPECT_EQ(result.exit_code, 5) << result.err;
  EXPECT_TRUE(entries_of(job.outputs()).empty());
}

TEST(PictureCommand, APlaceThatCannotBeWrittenToIsFoundBeforeTheWork) {
  const Job job;
  // A model that cannot be read: the picture's place is looked at first.
  const fs::path model = job.input("garbage.stl", "solid garbage");
  const auto refused = [&](const std::vector<std::string>& command, int code, const std::string& said) {
    const ProcessResult result = aerate(command);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_TRUE(contains(result.err, said));
    EXPECT_TRUE(entries_of(job.outputs()).empty());
  };
  const std::string nowhere = job.outputs() / "missing" / "a.png";
  refused({"hollow", model, "-o", job.output(), "--picture", nowhere}, 1, "cannot be written");
  refused({"inspect", model, "--picture", nowhere}, 1, "cannot be written");
  refused({"hollow", model, "-o", job.output(), "--picture", job.outputs()}, 2, ".png");
  refused({"hollow", model, "-o", job.output(), "--picture", job.outputs() / "a.jpg"}, 2, "ends in .png");
}

TEST(PictureCommand, ReplacesNothingThatIsReadOrWritten) {
  const Job job;
  const fs::path model = job.input("block.png", block());
  const std::string before = read_bytes(model);
  const ProcessResult same = run(job.hollow(model, {"--picture", model}));
  EXPECT_EQ(same.exit_code, 2) << same.err;
  EXPECT_EQ(read_bytes(model), before);
  const fs::path stl = job.input("block.stl", block());
  const ProcessResult twice =
      aerate({"hollow", stl, "-o", job.outputs() / "a.png", "--picture", job.outputs() / "a.png"});
  EXPECT_EQ(twice.exit_code, 2) << twice.err;
  const ProcessResult report =
      run(job.hollow(stl, {"--picture", job.outputs() / "b.png", "--json", job.outputs() / "b.png"}));
  EXPECT_EQ(report.exit_code, 2) << report.err;
  EXPECT_TRUE(entries_of(job.outputs()).empty());
}

TEST(PictureCommand, RefusesWhatItCannotDraw) {
  const Job job;
  const fs::path model = job.input("block.stl", block());
  const std::string picture = job.outputs() / "a.png";
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"--picture-cut", "w"},
                                             {"--picture-cut", "y="},
                                             {"--picture-cut", "y=101"},
                                             {"--picture-cut", "y=-1%"},
                                             {"--picture-cut", "y=nan"},
                                             {"--picture-cut", "yy"},
                                             {"--picture-size", "800"},
                                             {"--picture-size", "0x100"},
                                             {"--picture-size", "100x800"},
                                             {"--picture-size", "8000x8000"},
                                             {"--picture-size", "1e9x1e9"},
                                             {"--picture-size", "800.5x600"},
                                             {"--picture-colour", "red"}}) {
    std::vector<std::string> options{"--picture", picture};
    options.insert(options.end(), wrong.begin(), wrong.end());
    const ProcessResult result = run(job.hollow(model, options));
    EXPECT_EQ(result.exit_code, 2) << wrong[0] << ' ' << wrong[1] << result.err;
    EXPECT_TRUE(contains(result.err, wrong[0]));
  }
  const ProcessResult alone = run(job.hollow(model, {"--picture-cut", "y"}));
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_TRUE(contains(alone.err, "--picture-cut without --picture"));
  EXPECT_TRUE(entries_of(job.outputs()).empty());
}

}  // namespace
}  // namespace aerate::test
