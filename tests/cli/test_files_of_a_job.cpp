#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

// What a job reads and writes, seen from the shell: which files stay as they are, what is left behind, and
// what is said when one cannot be had.
namespace aerate::test {
namespace {

constexpr int kFailure = 1;
constexpr int kUsage = 2;
constexpr int kUnreadable = 3;

// `command` for a shell, with aerate as $A.
ProcessResult shell(const std::string& command) {
  return run({"bash", "-c", "A='" AERATE_EXECUTABLE "'; " + command});
}

TEST(FilesOfAJob, NoFileThatIsReadIsReplacedByWhateverName) {
  const Job job;
  const std::string model = job.input("block.stl", block());
  const std::string spheres = job.input("spheres.csv", "x,y,z,radius\n15,15,15,5\n");
  const std::string config = job.input("options.ply", "[hollow]\nwall = 1.5\n");
  const std::string process = job.input("own.json", R"({"base": "fdm"})");
  const std::string settings = job.input("print.ini", "perimeters = 3\n");
  const std::vector<std::string> options{"--spheres", spheres, "--config",         config,
                                         "--process", process, "--print-settings", settings};
  const auto refused = [&](const std::string& output, std::vector<std::string> more,
                           const std::string& said) {
    std::vector<std::string> command{AERATE_EXECUTABLE, "hollow", model, "-o", output};
    command.insert(command.end(), options.begin(), options.end());
    command.insert(command.end(), more.begin(), more.end());
    const ProcessResult result = run(command);
    EXPECT_EQ(result.exit_code, kUsage) << output << result.err;
    EXPECT_TRUE(contains(result.err, said));
  };
  const std::string out = job.output();
  for (const auto& [file, what] :
       std::vector<std::pair<std::string, std::string>>{{model, "model"},
                                                        {spheres, "list of spheres"},
                                                        {config, "configuration file"},
                                                        {process, "process file"},
                                                        {settings, "file of print settings"}}) {
    const std::string before = read_bytes(file);
    const std::filesystem::path hard = job.folder() / "hard.ply", soft = job.folder() / "soft.ply";
    std::filesystem::create_hard_link(file, hard);
    std::filesystem::create_symlink(file, soft);
    for (const std::string& name : {hard.string(), soft.string(), job.folder().string() + "/./soft.ply"}) {
      refused(name, {}, "the output is the " + what + " itself");
      refused(out, {"--json", name}, "would replace the " + what);
    }
    refused(out, {"--json", file}, "would replace the " + what);
    EXPECT_EQ(read_bytes(file), before);
    std::filesystem::remove(hard);
    std::filesystem::remove(soft);
  }
  refused(out, {"--json", job.outputs().string() + "/../outputs/out.stl"}, "would replace " + out);
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(FilesOfAJob, OptionsBeforeTheModelLeaveIt) {
  const Job job;
  const std::string model = job.input("block.stl", block());
  const ProcessResult result = run({AERATE_EXECUTABLE, "hollow", "--process", "sla", "--escape-hole",
                                    "15,15,0", "--escape-hole", "15,15,30", model, "-o", job.output()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // That there is no such slicer is all that is wrong.
  const ProcessResult sliced =
      run({AERATE_EXECUTABLE, "slice", "--slicer", "prusa-slicer", "--slicer-path", "/nowhere", "-o",
           job.output("out.gcode"), "--config", job.input("a.ini", "a = 1\n"), model});
  EXPECT_TRUE(contains(sliced.err, "/nowhere")) << sliced.err;
}

TEST(FilesOfAJob, AReplacedFileKeepsItsMode) {
  const Job job;
  const std::string model = job.input("block.stl", block());
  for (const mode_t mode : {0600U, 0640U, 0755U}) {
    std::ofstream(job.output()) << "old";
    ASSERT_EQ(chmod(job.output().c_str(), mode), 0);
    ASSERT_EQ(run(job.hollow(model, {"--max-voids", "1", "--quiet"})).exit_code, 0);
    struct stat facts {};
    ASSERT_EQ(stat(job.output().c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 0777, mode);
    EXPECT_GT(facts.st_size, 1000);
  }
}

TEST(FilesOfAJob, AResultWithoutItsReportIsNamed) {
  const Job job;
  const std::string model = job.input("block.stl", block()), out = job.output();
  const std::string hollow = "$A hollow " + model + " --max-voids 1 -o " + out;
  for (const char* way : {" > /dev/full", " >&-", " --json - > /dev/full"}) {
    const ProcessResult result = shell(hollow + way);
    EXPECT_EQ(result.exit_code, kFailure) << way;
    EXPECT_TRUE(contains(
        result.err, "aerate: error: " + out + " was written, but its report could not be: standard output"));
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{"out.stl"});
    std::filesystem::remove(out);
  }
  // Nothing to report, nothing lost.
  EXPECT_EQ(shell(hollow + " --quiet >&-").exit_code, 0);
}

TEST(FilesOfAJob, ClosedDescriptorsDoNotEndUpInTheResult) {
  const Job job;
  Mesh mesh = block();
  mesh.triangles.push_back({0, 0, 1});  // makes a notice
  const std::string model = job.input("block.stl", mesh);
  const std::string hollow = "$A hollow " + model + " --max-voids 1 -o ";
  ASSERT_EQ(shell(hollow + job.output("a.stl").string()).exit_code, 0);
  ASSERT_EQ(shell(hollow + job.output("b.stl").string() + " 2>&-").exit_code, 0);
  ASSERT_EQ(shell(hollow + job.output("c.stl").string() + " <&- 2>&- >&-").exit_code, kFailure);
  EXPECT_EQ(read_bytes(job.output("b.stl")), read_bytes(job.output("a.stl")));
  EXPECT_EQ(read_bytes(job.output("c.stl")), read_bytes(job.output("a.stl")));
}

TEST(FilesOfAJob, ALimitOfTheSizeOfFilesIsAnError) {
  const Job job;
  const std::string model = job.input("block.stl", block());
  for (const char* ending : {"stl", "3mf", "obj", "ply"}) {
    const std::string out = job.output(std::string("out.") + ending);
    const ProcessResult result = shell("ulimit -f 8; $A hollow " + model + " -o " + out);
    EXPECT_EQ(result.exit_code, kFailure) << ending;
    EXPECT_TRUE(contains(result.err, out + ": cannot be written: File too large"));
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  }
}

TEST(FilesOfAJob, ALimitOfTheAddressSpaceIsAnError) {
  const Job job;
  const std::string model = job.input("block.stl", block());
  for (const int mebibytes : {100, 140, 300}) {
    const std::string limited = "ulimit -v " + std::to_string(1024 * mebibytes) + "; ulimit -c 0; $A ";
    // Libraries that are loaded end the program themselves where they cannot start.
    if (shell(limited + "--version").exit_code != 0) continue;
    const ProcessResult result = shell(limited + "hollow " + model + " --threads 1 --max-voids 20 " +
                                       "--tolerance 0.002 -o " + job.output().string());
    EXPECT_LT(result.exit_code, 3) << mebibytes << ' ' << result.err;
    EXPECT_EQ(entries_of(job.outputs()).size(), result.exit_code == 0 ? 1U : 0U) << mebibytes;
    std::filesystem::remove(job.output());
  }
}

TEST(FilesOfAJob, PathsThatLoopAreErrors) {
  const Job job;
  const std::string model = job.input("block.stl", block());
  const std::filesystem::path loop = job.folder() / "loop.stl";
  std::filesystem::create_symlink("loop.stl", loop);
  const ProcessResult input = run(job.hollow(loop));
  EXPECT_EQ(input.exit_code, kUnreadable);
  EXPECT_TRUE(contains(input.err, "loop.stl: Too many levels of symbolic links"));
  const ProcessResult output = run({AERATE_EXECUTABLE, "hollow", model, "-o", loop});
  EXPECT_EQ(output.exit_code, kFailure);
  EXPECT_TRUE(contains(output.err, "loop.stl: cannot be written: Too many levels of symbolic links"));
  EXPECT_TRUE(std::filesystem::is_symlink(loop));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(FilesOfAJob, ConfigurationsThatWouldTakeLongAreRefusedAtOnce) {
  const Job job;
  const std::string model = job.input("block.stl", block());
  const auto refused = [&](const std::string& text, const std::string& said) {
    const std::string config = job.input("c.toml", text);
    const ProcessResult result = run(job.hollow(model, {"--config", config}));
    EXPECT_EQ(result.exit_code, kUsage) << result.err;
    EXPECT_TRUE(contains(result.err, "c.toml: " + said));
  };
  std::string deep = "a";
  for (int i = 0; i < 20000; ++i) deep += ".a";
  refused("[" + deep + "]\nx=1\n", "line 1 is nested deeper than 8");
  refused("wall = 1.2\n" + deep + " = 1\n", "line 2 is nested deeper than 8");
  refused(std::string(2 << 20, '#'), "more than 1048576 bytes");
  const ProcessResult device = run(job.hollow(model, {"--config", "/dev/zero"}));
  EXPECT_EQ(device.exit_code, kUsage);
  EXPECT_TRUE(contains(device.err, "/dev/zero: not a regular file"));
}

TEST(FilesOfAJob, ProcessFilesThatAreNoneAreRefusedAtOnce) {
  const Job job;
  const std::string model = job.input("block.stl", block());
  const auto refused = [&](const std::string& text, const std::string& said) {
    const std::string process = job.input("p.json", text);
    const ProcessResult result = run(job.hollow(model, {"--process", process}));
    EXPECT_EQ(result.exit_code, kUnreadable) << result.err;
    EXPECT_TRUE(contains(result.err, said));
    EXPECT_LT(result.err.size(), 1000u);
  };
  refused(std::string(1000000, '['), "p.json: not JSON");
  refused(std::string(1000000, '[') + std::string(48000, ']'), "p.json: not JSON");
  refused("{\"wall\": " + std::string(2 << 20, '1') + "}", "p.json: more than 1048576 bytes");
  refused("", "p.json: the file is empty");
}

TEST(FilesOfAJob, NamesOfAnyBytesAreNames) {
  const Job job;
  for (const std::string& name :
       {std::string("caf\xe9"), std::string("a\nb\x1b[31m"), std::string("<&\">")}) {
    const std::string model = job.input(name + ".stl", block());
    const std::string report = job.folder() / "report.json";
    for (const char* ending : {".stl", ".3mf"}) {
      const std::string out = job.output(name + ending);
      const ProcessResult result =
          run({AERATE_EXECUTABLE, "hollow", model, "-o", out, "--max-voids", "1", "--json", report});
      EXPECT_EQ(result.exit_code, 0) << result.err;
      EXPECT_GT(std::filesystem::file_size(out), 684u);
      const nlohmann::json json = nlohmann::json::parse(read_bytes(report));
      EXPECT_TRUE(json.is_object());
    }
  }
}

}  // namespace
}  // namespace aerate::test
