#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include "tests/cli/job.h"
#include "tests/cli/many_models.h"
#include "tests/support/caught.h"

// The batch in the hands of a real Slurm: a controller and a node on this machine, begun for each test and ended after it.
namespace aerate::test {
namespace {

using Environment = std::vector<std::pair<std::string, std::string>>;

class Cluster {
 public:
  Cluster() : begun_(test::run({AERATE_CLUSTER, "start", folder_.path()})) {}
  ~Cluster() { test::run({AERATE_CLUSTER, "stop", folder_.path()}); }
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

  // Why there is none, empty where there is one.
  std::string missing() const {
    EXPECT_TRUE(begun_.exit_code == 0 || begun_.exit_code == 77) << begun_.err;
    return begun_.exit_code == 0 ? "" : begun_.err;
  }
  void kill_node() const { EXPECT_EQ(test::run({AERATE_CLUSTER, "kill-node", folder_.path()}).exit_code, 0); }
  void start_node() const {
    EXPECT_EQ(test::run({AERATE_CLUSTER, "start-node", folder_.path()}).exit_code, 0);
  }

  Environment environment() const { return {{"SLURM_CONF", folder_.path() / "slurm.conf"}}; }
  ProcessResult run(const std::vector<std::string>& command) const {
    return test::run(command, environment());
  }

 private:
  TemporaryFolder folder_;
  ProcessResult begun_;
};

// Which are found before others of their names.
Environment with_programs_in(const fs::path& folder) {
  return {{"PATH", folder.string().append(":").append(std::getenv("PATH"))}};
}

class BatchOnSlurm : public testing::Test {
 protected:
  void SetUp() override {
    if (!cluster_.missing().empty()) GTEST_SKIP() << cluster_.missing();
  }

  ProcessResult submit(std::vector<std::string> arguments, const Environment& more = {}) const {
    arguments.insert(arguments.begin(), {batch_.models(), "--engine", "slurm"});
    Environment environment = cluster_.environment();
    environment.insert(environment.end(), more.begin(), more.end());
    return test::run(batch_.command(arguments), environment);
  }
  ProcessResult ask(const std::string& what) const {
    return cluster_.run({AERATE_EXECUTABLE, "batch", "-o", batch_.results(), what});
  }

  // What the program's own folder knows of jobs that are done, and since when.
  std::map<std::string, fs::file_time_type> records() const {
    std::map<std::string, fs::file_time_type> found;
    const fs::path folder = batch_.results() / ".aerate-batch";
    if (!fs::exists(folder)) return found;
    for (const std::string& name : entries_of(folder))
      if (name.ends_with(".json") && !name.starts_with(".")) found[name] = fs::last_write_time(folder / name);
    return found;
  }

  // What a node failure puts off by minutes is begun now.
  void begin_what_waits() const {
    const ProcessResult waiting =
        cluster_.run({"squeue", "--noheader", "--array", "--states=PENDING", "--format=%F_%K"});
    std::istringstream lines(waiting.out);
    for (std::string task; lines >> task;)
      cluster_.run({"scontrol", "update", "JobId=" + task, "StartTime=now"});
  }

  void set_partition(const std::string& state) const {
    ASSERT_EQ(cluster_.run({"scontrol", "update", "PartitionName=work", "State=" + state}).exit_code, 0);
  }

  Batch batch_;
  Cluster cluster_;
};

// Without what may differ: times and memory.
Json comparable(Json summary) {
  summary.at("totals").erase("seconds");
  for (Json& model : summary.at("models"))
    for (const char* key : {"seconds", "seconds_in_job", "peak_memory_bytes"}) model.erase(key);
  return summary;
}

TEST_F(BatchOnSlurm, FortyModelsBecomeWhatOneMachineMakesOfThem) {
  for (int i = 0; i < 38; ++i) batch_.block("m" + std::to_string(i) + ".stl", 20 + static_cast<float>(i) / 4);
  batch_.block("a %j 'b'\n\xc3\xbc.stl", 33);
  batch_.file("models/junk.stl", "no model");
  const ProcessResult result = submit({"--wait", "--chunk", "5", "--pictures"});
  EXPECT_EQ(result.exit_code, kSomeNotDone) << result.err;
  EXPECT_TRUE(contains(result.out, "40 models handed over in 8 tasks"));
  EXPECT_TRUE(contains(result.out, "[40/40] "));
  EXPECT_TRUE(contains(result.out, "39 of 40 models are done"));
  EXPECT_EQ(temporary_files(batch_.results()), std::vector<std::string>{});

  const fs::path here = batch_.folder() / "here";
  std::vector<std::string> command = batch_.command({batch_.models(), "--pictures"});
  std::ranges::replace(command, batch_.results().string(), here.string());
  EXPECT_EQ(run(command).exit_code, kSomeNotDone);
  for (const std::string& name : entries_of(here)) {
    if (!name.ends_with(".stl") && !name.ends_with(".png")) continue;
    EXPECT_EQ(batch_.result(name), read_bytes(here / name)) << name;
  }
  EXPECT_EQ(comparable(batch_.summary()), comparable(Json::parse(read_bytes(here / "summary.json"))));
  // Nothing is left to do.
  const ProcessResult again = submit({"--pictures"});
  EXPECT_EQ(again.exit_code, kSomeNotDone);
  EXPECT_TRUE(contains(again.out, "0 in this run"));
  EXPECT_TRUE(contains(ask("--status").out, "39 of 40 models done, 1 could not be, 0 yet to do"));
}

TEST_F(BatchOnSlurm, WhatANodeThatFailsHadUnderWayIsDoneAgainAndNothingElse) {
  constexpr int kModels = 8;
  for (int i = 0; i < kModels; ++i)
    fs::copy(sample("bunny.stl"), batch_.models() / ("m" + std::to_string(i) + ".stl"));
  const std::vector<std::string> slow{"--max-voids", "60", "--chunk", "4"};
  ASSERT_EQ(submit(slow).exit_code, 0);
  wait_until([&] { return records().size() >= 2; });
  cluster_.kill_node();
  wait_until([&] { return at_work_for(batch_.folder()).empty(); });
  const auto before = records();
  ASSERT_LT(before.size(), kModels);
  cluster_.start_node();
  std::vector<std::string> arguments = slow;
  arguments.emplace_back("--wait");
  arguments.insert(arguments.begin(), {batch_.models(), "--engine", "slurm"});
  // It waits for the tasks that are begun anew, and has nothing more to hand over.
  Process waiting(batch_.command(arguments), cluster_.environment());
  for (int i = 0; i < 600 && waiting.running(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    begin_what_waits();
  }
  const ProcessResult result = waiting.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(contains(result.out, "handed over"));
  EXPECT_EQ(records().size(), kModels);
  for (const auto& [name, time] : before) EXPECT_EQ(records().at(name), time) << "done twice";
  EXPECT_EQ(temporary_files(batch_.results()), std::vector<std::string>{});
  EXPECT_EQ(batch_.result("m0-hollow.stl"),
            batch_.hollowed(batch_.models() / "m0.stl", {"--max-voids", "60", "--tolerance", "0.3"}));
}

TEST_F(BatchOnSlurm, CancelledItLeavesWhatIsDoneAndGoesOnFromThere) {
  batch_.block("quick.stl");
  for (const char* name : {"slow.stl", "slower.stl"}) fs::copy(sample("bunny.stl"), batch_.models() / name);
  const std::vector<std::string> slow{"--max-voids", "500", "--tolerance", "0.01", "--chunk", "1"};
  ASSERT_EQ(submit(slow).exit_code, 0);
  wait_until([&] { return !temporary_files(batch_.results()).empty(); });
  EXPECT_TRUE(contains(ask("--status").out, "running"));
  // Neither this machine nor the cluster gets a second batch there.
  ProcessResult second = cluster_.run(batch_.command({batch_.models()}));
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_TRUE(contains(second.err, "is at work there"));
  EXPECT_EQ(submit(slow).exit_code, 1);
  const ProcessResult cancelled = ask("--cancel");
  EXPECT_EQ(cancelled.exit_code, 0) << cancelled.err;
  EXPECT_TRUE(contains(cancelled.out, "was cancelled"));
  EXPECT_TRUE(at_work_for(batch_.folder()).empty());
  EXPECT_EQ(temporary_files(batch_.results()), std::vector<std::string>{});
  EXPECT_GT(batch_.summary().at("totals").at("yet_to_do"), 0);
  EXPECT_EQ(ask("--collect").exit_code,
            batch_.summary().at("totals").at("done") > 0 ? kSomeNotDone : kNoneDone);
  // Here, by the same command but for the engine.
  EXPECT_EQ(cluster_.run(batch_.command({batch_.models()})).exit_code, 0);
}

TEST_F(BatchOnSlurm, WhatEndsItsTaskIsToldAndGetsATaskOfItsOwn) {
  for (const char* name : {"a.stl", "b.stl"}) fs::copy(sample("bunny.stl"), batch_.models() / name);
  const std::vector<std::string> slow{"--max-voids", "300", "--tolerance", "0.01", "--chunk", "2"};
  ASSERT_EQ(submit(slow).exit_code, 0);
  wait_until([&] { return !temporary_files(batch_.results()).empty(); });
  ASSERT_EQ(
      cluster_.run({"scancel", "--signal=KILL", "--full", "--user=" + std::to_string(getuid())}).exit_code,
      0);
  wait_until([&] { return cluster_.run({"squeue", "--noheader"}).out.empty(); });
  const ProcessResult collected = ask("--collect");
  EXPECT_EQ(collected.exit_code, kNoneDone);
  EXPECT_TRUE(contains(collected.err, "2 of 2 models are yet to be done"));
  EXPECT_TRUE(contains(batch_.row("a.stl").at("message").get<std::string>(), "its task was ended"));
  // The one that was under way when it ended, and the other.
  const ProcessResult again =
      submit({"--max-voids", "300", "--tolerance", "0.01", "--chunk", "2", "--dry-run"});
  EXPECT_EQ(again.exit_code, 0);
  const ProcessResult anew = submit(slow);
  EXPECT_TRUE(contains(anew.out, "2 models handed over in 2 tasks")) << anew.out;
  ask("--cancel");
}

TEST_F(BatchOnSlurm, WhatTheClusterRefusesIsToldInItsWordsAndNothingIsInItsHands) {
  batch_.block("a.stl");
  ProcessResult refused = submit({"--partition", "nowhere"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(contains(refused.err, "sbatch: ")) << refused.err;
  EXPECT_TRUE(contains(refused.err, "nvalid partition")) << refused.err;
  EXPECT_EQ(cluster_.run({"squeue", "--noheader"}).out, "");
  refused = submit({"--sbatch-option=--mem=900000G"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(contains(refused.err, "sbatch: ")) << refused.err;
  EXPECT_EQ(cluster_.run(batch_.command({batch_.models()})).exit_code, 0);
  // What is there stays as it is.
  const std::string before = batch_.result("a-hollow.stl");
  EXPECT_EQ(submit({"--wall", "3", "--partition", "nowhere"}).exit_code, 1);
  EXPECT_EQ(batch_.result("a-hollow.stl"), before);
  // What could not be done is tried again if that is asked for.
  batch_.file("models/b.stl", "no model");
  EXPECT_EQ(submit({"--wait"}).exit_code, kSomeNotDone);
  EXPECT_TRUE(contains(submit({"--wait"}).out, "0 in this run"));
  EXPECT_TRUE(contains(submit({"--wait", "--retry-failed"}).out, "[1/1] refused"));
}

TEST_F(BatchOnSlurm, TasksThatWaitAreToldWithTheReason) {
  batch_.block("a.stl");
  set_partition("DOWN");
  ASSERT_EQ(submit({"--partition", "work", "--sbatch-option=--comment=mine"}).exit_code, 0);
  ProcessResult status;
  wait_until([&] { return contains((status = ask("--status")).out, "PartitionDown"); });
  EXPECT_TRUE(contains(status.out, "0 tasks running, 1 waiting (PartitionDown)")) << status.out;
  EXPECT_EQ(ask("--collect").exit_code, kNoneDone);
  set_partition("UP");
  EXPECT_EQ(submit({"--wait"}).exit_code, 0);
}

// Which waits until its partition is up.
TEST_F(BatchOnSlurm, AModelThatChangesWhileItsTaskWaitsIsStillToBeDone) {
  batch_.block("a.stl");
  batch_.block("b.stl", 22);
  set_partition("DOWN");
  ASSERT_EQ(submit({"--chunk", "2"}).exit_code, 0);
  batch_.block("a.stl", 25);
  set_partition("UP");
  // The one that changed is handed over again, with its own reason in between.
  wait_until([&] { return contains(ask("--status").out, "ended"); });
  ProcessResult result = ask("--collect");
  EXPECT_EQ(result.exit_code, kSomeNotDone);
  EXPECT_TRUE(contains(batch_.row("a.stl").at("message").get<std::string>(), "a.stl: was changed since"))
      << batch_.row("a.stl");
  EXPECT_FALSE(fs::exists(batch_.results() / "a-hollow.stl"));
  result = submit({"--wait"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(batch_.result("a-hollow.stl"), batch_.hollowed(batch_.models() / "a.stl"));
}

TEST_F(BatchOnSlurm, NamesMayBeRelativeAndHoldPatternsOfSlurm) {
  const fs::path folder = batch_.folder() / "at %A %% 'work'";
  fs::create_directories(folder / "in");
  fs::copy(batch_.block("a.stl"), folder / "in/a.stl");
  std::ofstream(folder / "own.json") << R"({"base": "sls"})";
  const std::vector<std::string> command{
      "env",      "--chdir",     folder,   AERATE_EXECUTABLE, "batch", "in",
      "-o",       "out %j %A",   "--wait", "--engine",        "slurm", "--process",
      "own.json", "--max-voids", "2",      "--tolerance",     "0.3"};
  const ProcessResult result = cluster_.run(command);
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_TRUE(fs::exists(folder / "out %j %A/a-hollow.stl"));
  std::size_t logs = 0;
  for (const std::string& name : entries_of(folder / "out %j %A/.aerate-batch/slurm"))
    logs += name.ends_with("-0.txt");
  EXPECT_EQ(logs, 1U);
}

// Of sbatch's own options and variables, whatever they are.
TEST_F(BatchOnSlurm, NothingHidesTasksFromTheBatch) {
  const fs::path elsewhere = batch_.folder() / "elsewhere";
  fs::create_directory(elsewhere);
  const Environment variables{{"SQUEUE_STATES", "COMPLETED"},
                              {"SQUEUE_FORMAT", "%i"},
                              {"SQUEUE_USERS", "nobody"},
                              {"SBATCH_WAIT", "1"},
                              {"SCANCEL_STATE", "COMPLETING"}};
  batch_.block("a.stl");
  set_partition("DOWN");
  ASSERT_EQ(submit({"--sbatch-option=--job-name=mine", "--sbatch-option=--array=5-9",
                    "--sbatch-option=--output=/nowhere/%j", "--sbatch-option=--error=e",
                    "--sbatch-option=--chdir=" + elsewhere.string(), "--sbatch-option=--comment"},
                   variables)
                .exit_code,
            0);
  const ProcessResult second = submit({}, variables);
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_TRUE(contains(second.err, "1 waiting")) << second.err;
  set_partition("UP");
  EXPECT_EQ(submit({"--wait"}, variables).exit_code, 0);
  EXPECT_EQ(entries_of(elsewhere), std::vector<std::string>{});
  for (const char* option :
       {"--wait", "-W", "--clusters=other", "-Mother", "--test-only", "--wrap=true", "word"}) {
    const ProcessResult refused = submit({"--sbatch-option", option});
    EXPECT_EQ(refused.exit_code, kUsage) << option;
    EXPECT_TRUE(contains(refused.err, "--sbatch-option: ")) << refused.err;
  }
}

TEST_F(BatchOnSlurm, WhoWaitsIsToldWhyNothingBegins) {
  batch_.block("a.stl");
  set_partition("DOWN");
  std::vector<std::string> arguments{batch_.models(), "--engine", "slurm", "--wait"};
  Process waiting(batch_.command(arguments), cluster_.environment());
  std::this_thread::sleep_for(std::chrono::seconds(3));
  set_partition("UP");
  const ProcessResult result = waiting.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "0 tasks running, 1 waiting (PartitionDown)")) << result.out;
}

// As while its controller is begun anew.
TEST_F(BatchOnSlurm, WhoWaitsAsksAgainWhereSlurmDoesNotAnswer) {
  batch_.block("a.stl");
  set_partition("DOWN");
  ASSERT_EQ(submit({}).exit_code, 0);
  const fs::path programs = batch_.folder() / "programs";
  fs::create_directory(programs);
  std::ofstream(programs / "squeue")
      << "#!/bin/sh\nif mkdir " << programs.string()
      << "/asked 2>/dev/null; then echo 'squeue: error: Unable to contact'; exit 1; fi\n"
      << "exec /usr/bin/squeue \"$@\"\n";
  fs::permissions(programs / "squeue", fs::perms::owner_all);
  set_partition("UP");
  const ProcessResult result = submit({"--wait"}, with_programs_in(programs));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "Unable to contact; asked again")) << result.err;
}

TEST_F(BatchOnSlurm, WhatIsTriedAgainIsToldByItsNewOutcome) {
  batch_.file("models/a.stl", "no model");
  ASSERT_EQ(submit({"--wait"}).exit_code, kNoneDone);
  set_partition("DOWN");
  ASSERT_EQ(submit({"--retry-failed"}).exit_code, 0);
  EXPECT_TRUE(contains(ask("--status").out, "0 of 1 model done, 0 could not be, 1 yet to do"));
  set_partition("UP");
  const ProcessResult result = submit({"--wait", "--retry-failed"});
  EXPECT_EQ(result.exit_code, kNoneDone);
  EXPECT_TRUE(contains(result.out, "[1/1] refused: ")) << result.out;
  // Where it is not handed over, what is known of it stays.
  EXPECT_EQ(submit({"--retry-failed", "--partition", "nowhere"}).exit_code, 1);
  EXPECT_TRUE(contains(submit({}).out, "0 in this run"));
}

TEST_F(BatchOnSlurm, AHandingOverThatFailsHalfWayIsTakenBack) {
  batch_.block("a.stl");
  set_partition("DOWN");
  const fs::path programs = batch_.folder() / "programs";
  fs::create_directory(programs);
  std::ofstream(programs / "sbatch")
      << "#!/bin/sh\n/usr/bin/sbatch \"$@\"; echo 'sbatch: error: timed out'; exit 1\n";
  fs::permissions(programs / "sbatch", fs::perms::owner_all);
  const ProcessResult result = submit({}, with_programs_in(programs));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(contains(result.err, "timed out")) << result.err;
  EXPECT_EQ(cluster_.run({"squeue", "--noheader"}).out, "");
  EXPECT_EQ(ask("--status").exit_code, kUsage);  // nothing is known of it
}

TEST(BatchWithoutSlurm, AClusterThatIsNotThereIsToldAndNothingIsInItsHands) {
  const Batch batch;
  batch.block("a.stl");
  const auto submit = [&](const Environment& environment) {
    return run(batch.command({batch.models(), "--engine", "slurm"}), environment);
  };
  ProcessResult result = submit({{"PATH", "/nowhere"}});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(contains(result.err, "scontrol: cannot be run")) << result.err;
  EXPECT_TRUE(contains(result.err, "--engine local")) << result.err;
  EXPECT_EQ(run(batch.command({batch.models()}), {{"PATH", "/nowhere"}}).exit_code, 0);
}

TEST(BatchWithoutSlurm, OptionsThatMakeNoSenseAreRefused) {
  const Batch batch;
  const fs::path model = batch.block("a.stl");
  const std::vector<std::vector<std::string>> refused{{},
                                                      {model, "--status"},
                                                      {"--status", "--cancel"},
                                                      {"--status", "--wait"},
                                                      {model, "--wait"},
                                                      {model, "--chunk", "3"},
                                                      {model, "--partition", "p"},
                                                      {model, "--engine", "pbs"},
                                                      {model, "--engine", "slurm", "--chunk", "0"},
                                                      {"--status"}};
  ProcessResult backslash =
      run({AERATE_EXECUTABLE, "batch", model, "--engine", "slurm", "-o", batch.folder() / "a\\b"});
  EXPECT_EQ(backslash.exit_code, kUsage) << backslash.err;
  EXPECT_TRUE(contains(backslash.err, "backslash"));
  for (const std::vector<std::string>& arguments : refused) {
    const ProcessResult result = batch.run(arguments);
    EXPECT_EQ(result.exit_code, kUsage) << testing::PrintToString(arguments) << result.err;
  }
  EXPECT_EQ(run({AERATE_EXECUTABLE, "batch-task", "x", "0"}).exit_code, kUnreadable);
  EXPECT_FALSE(contains(run({AERATE_EXECUTABLE, "--help"}).out, "batch-task"));
}

}  // namespace
}  // namespace aerate::test
