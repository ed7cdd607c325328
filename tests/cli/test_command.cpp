#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"

namespace aerate::test {
namespace {

using Json = nlohmann::json;

TEST(Command, HelpNamesUnitsDefaultsAndExitCodes) {
  const ProcessResult program = run({AERATE_EXECUTABLE, "--help"});
  EXPECT_EQ(program.exit_code, 0);
  for (const char* part : {"hollow", "pack", "inspect", "millimetres", "--config", "Exit status", "130"})
    EXPECT_TRUE(contains(program.out, part));
  const ProcessResult hollow = run({AERATE_EXECUTABLE, "hollow", "--help"});
  EXPECT_EQ(hollow.exit_code, 0);
  for (const char* part :
       {"--wall MM=1.2", "--gap MM=0.9", "--min-radius MM=0.62", "default 0.05, of cells 0.1"})
    EXPECT_TRUE(contains(hollow.out, part));
  EXPECT_EQ(hollow.err, "");
}

TEST(Command, VersionTellsWhatPackingCanRunOn) {
  const ProcessResult result = run({AERATE_EXECUTABLE, "--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out.substr(0, 7), "aerate ");
  EXPECT_TRUE(contains(result.out, "\ncpu: "));
  EXPECT_TRUE(contains(result.out, "\ncuda")) << result.out;
}

TEST(Command, DeviceIsAChoiceThatTheReportNames) {
  const Job job;
  const ProcessResult cpu = run(job.hollow(sample("bracket.stl"), {"--device", "cpu", "--json", "-"}));
  ASSERT_EQ(cpu.exit_code, 0) << cpu.err;
  EXPECT_EQ(Json::parse(cpu.out)["packing"]["device"]["name"], "cpu");
  EXPECT_EQ(Json::parse(cpu.out)["packing"]["device"]["reason"], "asked for");
  const ProcessResult unknown = run(job.hollow(sample("bracket.stl"), {"--device", "gpu"}));
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_TRUE(contains(unknown.err, "'gpu' is not auto, cpu, cuda or cuda:N")) << unknown.err;
}

TEST(Command, WithoutASubcommandSaysWhatToDo) {
  const ProcessResult result = run({AERATE_EXECUTABLE});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "aerate --help"));
}

TEST(Command, HollowsEachSampleIntoEachFormat) {
  for (const char* model : {"bunny.stl", "bracket.stl", "pawn.obj"}) {
    for (const char* name : {"out.stl", "out.obj", "out.ply", "OUT.STL"}) {
      const Job job;
      const ProcessResult result = run({AERATE_EXECUTABLE, "hollow", sample(model), "-o", job.output(name)});
      EXPECT_EQ(result.exit_code, 0) << model << ": " << result.err;
      EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{name});
      EXPECT_TRUE(contains(result.out, "removed"));
    }
  }
}

TEST(Command, ResultIsAModelThatTheProgramReadsAgain) {
  const Job job;
  ASSERT_EQ(run(job.hollow(sample("bunny.stl"))).exit_code, 0);
  const ProcessResult inspected = run({AERATE_EXECUTABLE, "inspect", job.output(), "--json", "-"});
  ASSERT_EQ(inspected.exit_code, 0) << inspected.err;
  const Json report = Json::parse(inspected.out);
  EXPECT_TRUE(report["input"]["closed"].get<bool>());
  EXPECT_EQ(report["input"]["non_manifold_edges"], 0);
  EXPECT_EQ(report["shells"][0]["triangles"], 7202);
  EXPECT_LT(report["shells"][1]["signed_volume_mm3"].get<double>(), 0);
}

TEST(Command, SameBytesForAnyNumberOfThreads) {
  std::vector<std::string> results;
  for (const char* threads : {"1", "2", "8"}) {
    const Job job;
    const std::vector<std::string> arguments{"--threads", threads, "--max-radius", "2", "--gap", "0.5"};
    ASSERT_EQ(run(job.hollow(sample("bunny.stl"), arguments)).exit_code, 0);
    results.push_back(read_bytes(job.output()));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(Command, SameBytesForAnyNumberOfThreadsWhenRemeshing) {
  std::vector<std::string> results;
  for (const char* threads : {"1", "2", "8"}) {
    const Job job;
    ASSERT_EQ(run(job.hollow(sample("pawn.obj"), {"--threads", threads, "--surface", "remesh"})).exit_code,
              0);
    results.push_back(read_bytes(job.output()));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(Command, MaxTrianglesLoosensTheToleranceAndSaysSo) {
  const Job job;
  const auto report = job.folder() / "report.json";
  const ProcessResult result =
      run(job.hollow(sample("bunny.stl"),
                     {"--packing", "hexagonal", "--max-triangles", "30000", "--json", report.string()}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "tolerance"));
  const Json json = Json::parse(read_bytes(report));
  EXPECT_LE(json["output"]["triangles"], 30000);
  EXPECT_GT(json["voids"]["tolerance_used_mm"], 0.05);
  EXPECT_EQ(json["limits"]["tolerance_mm"], 0.05);
  EXPECT_LE(json["voids"]["deviation_mm"], json["voids"]["tolerance_used_mm"]);
}

TEST(Command, JsonHasTheFieldsOfTheSchema) {
  const Job job;
  const ProcessResult result = run(job.hollow(sample("bracket.stl"), {"--json", "-", "--material", "petg"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["schema"], "aerate.hollow");
  EXPECT_EQ(json["schema_version"], 1);
  for (const char* pointer : {"/program",
                              "/input/path",
                              "/input/format",
                              "/input/triangles",
                              "/input/closed",
                              "/limits/wall_mm",
                              "/limits/gap_mm",
                              "/limits/min_radius_mm",
                              "/limits/max_radius_mm",
                              "/limits/tolerance_mm",
                              "/packing/method",
                              "/packing/device/name",
                              "/packing/device/reason",
                              "/packing/density",
                              "/packing/candidates",
                              "/surface/mode",
                              "/output/path",
                              "/output/bytes",
                              "/output/triangles",
                              "/output/outer_triangles",
                              "/output/void_triangles",
                              "/voids/count",
                              "/voids/min_radius_mm",
                              "/voids/max_radius_mm",
                              "/measured/wall_mm",
                              "/measured/gap_mm",
                              "/volume/before_mm3",
                              "/volume/after_mm3",
                              "/volume/removed_mm3",
                              "/volume/removed_percent",
                              "/centre_of_mass/before_mm",
                              "/centre_of_mass/after_mm",
                              "/material/name",
                              "/material/mass_before_g",
                              "/material/mass_after_g",
                              "/material/cost_before",
                              "/material/cost_after",
                              "/stages",
                              "/seconds",
                              "/peak_memory_bytes",
                              "/notices"}) {
    EXPECT_TRUE(json.contains(Json::json_pointer(pointer))) << pointer;
  }
  EXPECT_EQ(json["material"]["name"], "PETG");
  EXPECT_EQ(json["output"]["bytes"], std::filesystem::file_size(job.output()));
  EXPECT_GE(json["measured"]["wall_mm"], json["limits"]["wall_mm"].get<double>() - 1e-6);
  EXPECT_GE(json["measured"]["gap_mm"], json["limits"]["gap_mm"].get<double>() - 1e-6);
  EXPECT_NEAR(json["volume"]["before_mm3"].get<double>() - json["volume"]["removed_mm3"].get<double>(),
              json["volume"]["after_mm3"].get<double>(), 1e-3);
  // Grams are the volume times the density.
  EXPECT_NEAR(
      json["material"]["mass_after_g"].get<double>(),
      json["volume"]["after_mm3"].get<double>() * json["material"]["density_g_cm3"].get<double>() / 1000,
      1e-6);
}

TEST(Command, MassAndCostFollowDensityAndPrice) {
  const Job job;
  const auto model = job.input("block.stl", block());
  const ProcessResult result =
      run(job.hollow(model, {"--json", "-", "--material", "oak", "--density", "0.7", "--price", "10"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["material"]["name"], "oak");
  EXPECT_NEAR(json["material"]["mass_before_g"].get<double>(), 27 * 0.7, 1e-9);
  EXPECT_NEAR(json["material"]["cost_before"].get<double>(), 27 * 0.7 / 1000 * 10, 1e-9);
}

TEST(Command, UnitAndScaleApply) {
  const Job job;
  const auto model = job.input("inches.stl", make_box({0, 0, 0}, {1, 1, 1}));
  const ProcessResult result =
      run({AERATE_EXECUTABLE, "inspect", model, "--unit", "inch", "--scale", "2", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NEAR(Json::parse(result.out)["input"]["signed_volume_mm3"].get<double>(), 8 * 25.4 * 25.4 * 25.4,
              0.1);
}

TEST(Command, EachAxisIsScaledByItsOwnFactor) {
  const Job job;
  const auto model = job.input("box.stl", make_box({0, 0, 0}, {20, 30, 40}));
  const auto report = [&](const std::string& scale) {
    const ProcessResult result = run(job.hollow(model, {"--scale", scale, "--json", "-"}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? Json::parse(result.out) : Json();
  };
  const Json uneven = report("1.1,1,1.2");
  EXPECT_EQ(uneven["input"]["scale"], Json::array({1.1, 1.0, 1.2}));
  EXPECT_NEAR(uneven["input"]["box"]["upper_mm"][0].get<double>(), 22, 1e-4);
  EXPECT_NEAR(uneven["input"]["box"]["upper_mm"][1].get<double>(), 30, 1e-4);
  EXPECT_NEAR(uneven["input"]["box"]["upper_mm"][2].get<double>(), 48, 1e-4);
  EXPECT_EQ(report("2")["input"]["scale"], Json::array({2.0, 2.0, 2.0}));
  const ProcessResult text = run(job.hollow(model, {"--scale", "1.1,1,1.2"}));
  EXPECT_TRUE(contains(text.out, "scaled by 1.1 along x, 1 along y, 1.2 along z"));
  // From a configuration file as well.
  const auto config = job.input("scale.toml", "scale = \"1.5,1,1\"\n");
  const ProcessResult configured = run(job.hollow(model, {"--config", config, "--json", "-"}));
  ASSERT_EQ(configured.exit_code, 0) << configured.err;
  EXPECT_EQ(Json::parse(configured.out)["input"]["scale"], Json::array({1.5, 1.0, 1.0}));
}

TEST(Command, SeveralPartsAreAllUsedAndSaidSo) {
  const Job job;
  const std::string two =
      "o a\nv 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
      "o b\nv 20 0 0\nv 29 0 0\nv 20 9 0\nv 20 0 9\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n";
  const ProcessResult result = run({AERATE_EXECUTABLE, "inspect", job.input("two.obj", two)});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(contains(result.err, "2 parts"));
}

TEST(Command, ConfigFileGivesOptionsAndTheCommandLineGoesFirst) {
  const Job job;
  const auto limits_with = [&](const std::string& config, const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"--json", "-", "--config", job.input("aerate.toml", config).string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ProcessResult result = run(job.hollow(sample("bracket.stl"), all));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out)["limits"];
  };
  const Json flat = limits_with("wall = 2\nmax-radius = 3\n", {"--wall", "1.5"});
  EXPECT_EQ(flat["wall_mm"], 1.5);
  EXPECT_EQ(flat["max_radius_mm"], 3);
  const Json sections = limits_with("[pack]\nwall = 9\n[hollow]\nwall = 2\n", {});
  EXPECT_EQ(sections["wall_mm"], 2);
}

TEST(Command, ConfigFileWithAnUnknownKeyOrNonsenseIsRefused) {
  const Job job;
  for (const char* config : {"wal = 2\n", "wall = -2\n", "[hollow]\nwall = thick\n"}) {
    const auto path = job.input("aerate.toml", config);
    const ProcessResult result = run(job.hollow(sample("bracket.stl"), {"--config", path.string()}));
    EXPECT_EQ(result.exit_code, 2) << config;
    EXPECT_TRUE(contains(result.err, "wal"));
  }
  const auto unknown = job.input("aerate.toml", "wal = 2\n");
  const ProcessResult named = run(job.hollow(sample("bracket.stl"), {"--config", unknown.string()}));
  EXPECT_TRUE(contains(named.err, unknown.string() + ": 'hollow.wal' is no option"));
  const ProcessResult missing =
      run(job.hollow(sample("bracket.stl"), {"--config", (job.folder() / "none.toml").string()}));
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_TRUE(contains(missing.err, "none.toml"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(Command, UnknownCommandIsNamed) {
  const ProcessResult result = run({AERATE_EXECUTABLE, "hallow", sample("bracket.stl")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(contains(result.err, "'hallow' is no command"));
}

TEST(Command, NoBarAndNoColourUnlessOnATerminal) {
  const Job job;
  const auto model = job.input("turned.stl", turned_inside_out(block()));
  const ProcessResult result = run(job.hollow(model));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err.find('\r'), std::string::npos);
  EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
  EXPECT_EQ(result.out.find('\x1b'), std::string::npos);
}

TEST(Command, TerminalShowsABarAndObeysNoColor) {
  const Job job;
  const auto model = job.input("turned.stl", turned_inside_out(block()));
  const ProcessResult coloured = run_on_terminal(job.hollow(model), {{"TERM", "xterm"}, {"NO_COLOR", ""}});
  EXPECT_EQ(coloured.exit_code, 0);
  EXPECT_TRUE(contains(coloured.err, "[33m"));
  EXPECT_TRUE(contains(coloured.err, "\r"));
  const ProcessResult plain = run_on_terminal(job.hollow(model), {{"TERM", "xterm"}, {"NO_COLOR", "1"}});
  EXPECT_TRUE(contains(plain.err, "\r"));
  EXPECT_EQ(plain.err.find("m\x1b"), std::string::npos);
  EXPECT_EQ(plain.err.find("[33m"), std::string::npos);
  const ProcessResult dumb = run_on_terminal(job.hollow(model), {{"TERM", "dumb"}});
  EXPECT_EQ(dumb.err.find('\x1b'), std::string::npos);
}

TEST(Command, QuietSaysNothingUnlessSomethingIsWrong) {
  const Job job;
  const auto model = job.input("turned.stl", turned_inside_out(block()));
  const ProcessResult result = run(job.hollow(model, {"--quiet"}));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out + result.err, "");
  EXPECT_EQ(run(job.hollow(job.folder() / "none.stl", {"--quiet"})).exit_code, 3);
}

TEST(Command, PackWritesATable) {
  const Job job;
  const auto table = job.output("spheres.csv");
  const ProcessResult result =
      run({AERATE_EXECUTABLE, "pack", sample("bracket.stl"), "-o", table, "--max-radius", "3.5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string csv = read_bytes(table);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "x,y,z,radius,kind");
  EXPECT_TRUE(contains(csv, ",lattice\n"));
  EXPECT_EQ(
      run({AERATE_EXECUTABLE, "pack", sample("bracket.stl"), "-o", job.output("spheres.dat")}).exit_code, 2);
}

TEST(Command, PackStopsAtTheDensityThatItReports) {
  const Job job;
  const auto model =
      job.input("parts.stl", join(make_box({0, 0, 0}, {30, 30, 30}), make_box({18, 0, 0}, {60, 30, 30})));
  const ProcessResult result = run({AERATE_EXECUTABLE, "pack", model, "-o", job.output("spheres.csv"),
                                    "--target-density", "20", "--min-radius", "0.5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, " 20."));
}

// Each line's sphere keeps the default wall to the sides of a box.
void expect_inside(const std::string& csv, Vec3d lower, Vec3d upper) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  std::size_t count = 0;
  for (; std::getline(lines, line); ++count) {
    double x = 0, y = 0, z = 0, radius = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,", &x, &y, &z, &radius), 4) << line;
    const double inset = radius + 1.2;
    EXPECT_TRUE(x >= lower.x + inset && x <= upper.x - inset) << line;
    EXPECT_TRUE(y >= lower.y + inset && y <= upper.y - inset) << line;
    EXPECT_TRUE(z >= lower.z + inset && z <= upper.z - inset) << line;
  }
  EXPECT_EQ(count, 40U);
}

// A block away from the origin, packed into each format: what was written is a packing in the model's own
// coordinates, and voids made of it are the same whatever the format.
TEST(Command, PackedSpheresOfEachFormatMakeTheSameVoids) {
  const Job job;
  const auto model = job.input("block.stl", make_box({100, -50, 20}, {130, -20, 50}));
  const std::vector<std::pair<std::string, std::string>> beginnings{
      {"csv", "x,y,z,radius,kind\n"},
      {"json", "{\"schema\": \"aerate.spheres\", \"schema_version\": 1, \"unit\": \"mm\", \"spheres\": [\n["},
      {"ply", "ply\nformat ascii 1.0\ncomment spheres, mm\nelement vertex "}};
  std::string voids;
  for (const auto& [ending, beginning] : beginnings) {
    const auto table = job.folder() / ("spheres." + ending);
    const ProcessResult packed = run({AERATE_EXECUTABLE, "pack", model, "-o", table, "--max-voids", "40"});
    ASSERT_EQ(packed.exit_code, 0) << packed.err;
    EXPECT_EQ(read_bytes(table).substr(0, beginning.size()), beginning);
    if (ending == "csv") expect_inside(read_bytes(table), {100, -50, 20}, {130, -20, 50});
    const auto hollow = job.output(ending + ".stl");
    const ProcessResult result = run({AERATE_EXECUTABLE, "hollow", model, "-o", hollow, "--spheres", table});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    if (voids.empty()) voids = read_bytes(hollow);
    EXPECT_EQ(read_bytes(hollow), voids);
  }
}

TEST(Command, InspectTellsWhatIsWrong) {
  const Job job;
  Mesh mesh = block();
  mesh.triangles.resize(10);
  const auto model = job.input("open.stl", mesh);
  const ProcessResult text = run({AERATE_EXECUTABLE, "inspect", model});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_TRUE(contains(text.out, "closed      no"));
  EXPECT_TRUE(contains(text.out, "near (30.00, 15.00, 15.00) mm"));
  const Json json = Json::parse(run({AERATE_EXECUTABLE, "inspect", model, "--json", "-"}).out);
  EXPECT_EQ(json["schema"], "aerate.inspect");
  EXPECT_EQ(json["holes"].size(), 1);
  EXPECT_EQ(json["holes"][0]["edges"], 4);
  EXPECT_TRUE(json["self_intersections"].is_null());
}

TEST(Command, InspectFindsSelfIntersectionsOnDemand) {
  const Job job;
  const Mesh crossed = join(block(), make_box({10, 10, 10}, {50, 20, 20}));
  const ProcessResult result = run({AERATE_EXECUTABLE, "inspect", job.input("crossed.stl", crossed),
                                    "--self-intersections", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_GT(json["self_intersections"]["pairs"], 0);
  EXPECT_GT(json["self_intersections"]["places_mm"].size(), 0);
}

// A model that keeps the program busy for a second or more after its temporary file has appeared.
std::filesystem::path long_job_model(const Job& job) {
  return job.input("large.stl", make_uv_sphere(60, 700, 700));
}
const std::vector<std::string> kLongJob{"--max-radius", "0.7", "--gap", "0.2"};

// Waits until the program has begun to write beside its target.
bool temporary_file_appears(Process& process, const std::filesystem::path& folder) {
  while (process.running()) {
    if (!entries_of(folder).empty()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

TEST(Command, InterruptLeavesNothingBehind) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Job job;
    Process process(job.hollow(long_job_model(job), kLongJob));
    ASSERT_TRUE(temporary_file_appears(process, job.outputs()));
    process.send(signal);
    const ProcessResult result = process.wait();
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_TRUE(contains(result.err, "interrupted"));
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  }
}

// A flat bunny: the packing itself finds no place for a radius of 2.8 mm.
TEST(Command, APlaceThatARefusalWouldNameIsFound) {
  const Job job;
  const std::vector<std::string> flat{"--process", "sls",    "--shape", "spheres",      "--scale",
                                      "1,1,0.12",  "--wall", "0.7",     "--max-radius", "60"};
  std::vector<std::string> command{AERATE_EXECUTABLE, "pack", sample("bunny.stl"), "-o", job.output("a.csv"),
                                   "--json",          "-",    "--min-radius",      "2.8"};
  command.insert(command.end(), flat.begin(), flat.end());
  const ProcessResult result = run(command);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json spheres = Json::parse(result.out)["packing"];
  EXPECT_GE(spheres.at("spheres"), 1) << spheres;
  // And one that is larger than all is refused as ever.
  command[8] = "3.4";
  EXPECT_EQ(run(command).exit_code, 5);
  // It is a void like others.
  std::vector<std::string> arguments = flat;
  arguments.insert(arguments.end(), {"--min-radius", "2.8", "--no-drain"});
  EXPECT_EQ(run(job.hollow(sample("bunny.stl"), arguments)).exit_code, 0);
}

// A packing of minutes ends within moments of the signal.
TEST(Command, InterruptEndsALongPacking) {
  const std::vector<std::vector<std::string>> methods{
      {"adaptive", "--min-radius", "0.5", "--max-radius", "1"},
      {"hexagonal", "--min-radius", "0.05", "--max-radius", "0.4"}};
  for (const std::vector<std::string>& method : methods) {
    const Job job;
    const auto model = job.input("cube.stl", make_box({0, 0, 0}, {100, 100, 100}));
    std::vector<std::string> command{AERATE_EXECUTABLE,         "pack",  model, "-o",
                                     job.output("spheres.csv"), "--gap", "0",   "--packing"};
    command.insert(command.end(), method.begin(), method.end());
    Process process(command);
    ASSERT_TRUE(temporary_file_appears(process, job.outputs()));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    process.send(SIGINT);
    const ProcessResult result = process.wait();
    EXPECT_EQ(result.exit_code, 130) << method.front() << ": " << result.err;
    EXPECT_TRUE(contains(result.err, "interrupted"));
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  }
}

TEST(Command, SecondInterruptStopsAtOnceAndLeavesNothingBehind) {
  const Job job;
  Process process(job.hollow(long_job_model(job), kLongJob));
  ASSERT_TRUE(temporary_file_appears(process, job.outputs()));
  // So that the file is known to the handler: it is announced right after it is made.
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  process.send(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  process.send(SIGINT);
  EXPECT_EQ(process.wait().exit_code, 130);
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

TEST(Command, InterruptKeepsAnEarlierResult) {
  const Job job;
  std::ofstream(job.output()) << "an earlier result";
  Process process(job.hollow(long_job_model(job), kLongJob));
  while (process.running() && entries_of(job.outputs()).size() < 2)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  process.send(SIGINT);
  EXPECT_EQ(process.wait().exit_code, 130);
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{"out.stl"});
  EXPECT_EQ(read_bytes(job.output()), "an earlier result");
}

}  // namespace
}  // namespace aerate::test
