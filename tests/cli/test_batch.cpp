#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include "tests/cli/job.h"
#include "tests/cli/many_models.h"
#include "tests/support/caught.h"

// Many models in one command, seen from the shell: what is done, what is said of the rest, and what is left after
// it was stopped at any moment.
namespace aerate::test {
namespace {

TEST(Batch, ModelsBecomeWhatHollowMakesOfThemWithReportLogPictureAndSummary) {
  const Batch batch;
  const fs::path first = batch.block("first.stl"), second = batch.block("second.stl", 30);
  const ProcessResult result = batch.run({first, second, "--pictures", "--views"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(batch.result("first-hollow.stl"), batch.hollowed(first));
  EXPECT_EQ(batch.result("second-hollow.stl"), batch.hollowed(second));
  for (const char* ending : {".json", ".txt", ".png", ".html"})
    EXPECT_TRUE(fs::exists(batch.results() / (std::string("first-hollow") + ending))) << ending;
  const Json report = Json::parse(batch.result("second-hollow.json")), row = batch.row("second.stl");
  EXPECT_EQ(row.at("removed_mm3"), report.at("volume").at("removed_mm3"));
  EXPECT_EQ(row.at("cost_after"), report.at("material").at("cost_after"));
  EXPECT_EQ(row.at("outcome"), "done");
  const Json totals = batch.summary().at("totals");
  EXPECT_DOUBLE_EQ(
      totals.at("removed_mm3").get<double>(),
      batch.row("first.stl").at("removed_mm3").get<double>() + row.at("removed_mm3").get<double>());
  EXPECT_TRUE(contains(batch.result("first-hollow.txt"), "void"));
  const std::string page = batch.result("summary.html");
  EXPECT_TRUE(contains(page, "data:image/png;base64,iVBOR"));
  EXPECT_FALSE(contains(page, "<script"));
  EXPECT_FALSE(contains(page, "http"));
  EXPECT_TRUE(contains(batch.result("summary.csv"), "second-hollow.stl,done,0"));
}

TEST(Batch, WhatFailsIsARowAndAllElseIsDone) {
  const Batch batch;
  batch.block("good.stl");
  batch.file("models/junk.stl", "no model");
  batch.file("models/thin.stl", to_binary_stl(make_box({0, 0, 0}, {20, 20, 1})));
  const ProcessResult result = batch.run({batch.models()});
  EXPECT_EQ(result.exit_code, kSomeNotDone) << result.err;
  EXPECT_EQ(batch.row("good.stl").at("outcome"), "done");
  EXPECT_EQ(batch.row("junk.stl").at("outcome"), "refused");
  EXPECT_EQ(batch.row("junk.stl").at("exit_status"), kUnreadable);
  EXPECT_EQ(batch.row("thin.stl").at("exit_status"), 5);
  EXPECT_TRUE(contains(batch.result("junk-hollow.txt"), "STL"));
  EXPECT_FALSE(fs::exists(batch.results() / "junk-hollow.stl"));
  EXPECT_TRUE(contains(batch.result("summary.html"), "too few for an STL file"));
}

TEST(Batch, NoneDoneHasAnExitStatusOfItsOwn) {
  const Batch batch;
  EXPECT_EQ(batch.run({batch.file("models/junk.stl", "no model"), "nowhere.stl"}).exit_code, kNoneDone);
  EXPECT_TRUE(contains(batch.row("nowhere.stl").at("message").get<std::string>(), "nowhere.stl"));
}

TEST(Batch, AJobThatIsKilledIsARowThatIsTriedAgainOnlyWhenThatIsAskedFor) {
  const Batch batch;
  batch.block("quick.stl");
  fs::copy(sample("bunny.stl"), batch.models() / "slow.stl");
  // Some seconds, so that there is something to kill.
  const std::vector<std::string> arguments{batch.models(), "--jobs",      "1",  "--tolerance",
                                           "0.01",         "--max-voids", "500"};
  Process process(batch.command(arguments));
  wait_until([&] { return !temporary_files(batch.results()).empty(); });
  kill(process_that_made(temporary_files(batch.results()).front()), SIGKILL);  // the largest is first
  EXPECT_EQ(process.wait().exit_code, kSomeNotDone);
  EXPECT_EQ(batch.row("quick.stl").at("outcome"), "done");
  EXPECT_EQ(batch.row("slow.stl").at("outcome"), "crashed");
  EXPECT_EQ(batch.row("slow.stl").at("exit_status"), 128 + SIGKILL);
  EXPECT_EQ(temporary_files(batch.results()), std::vector<std::string>{});

  EXPECT_EQ(batch.run(arguments).exit_code, kSomeNotDone);
  EXPECT_FALSE(fs::exists(batch.results() / "slow-hollow.stl"));
  std::vector<std::string> again = arguments;
  again.emplace_back("--retry-failed");
  const ProcessResult result = batch.run(again);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "2 of 2 models are done, 1 in this run"));
}

// For one model that takes some seconds, so that there is something to disturb.
std::vector<std::string> slow_command(const Batch& batch, const std::string& name) {
  fs::copy(sample("bunny.stl"), batch.models() / name);
  return batch.command({batch.models(), "--tolerance", "0.01", "--max-voids", "500"});
}

TEST(Batch, AJobThatIsToldToEndIsStillToBeDone) {
  const Batch batch;
  Process process(slow_command(batch, "slow.stl"));
  wait_until([&] { return !temporary_files(batch.results()).empty(); });
  kill(process_that_made(temporary_files(batch.results()).front()), SIGTERM);
  const ProcessResult result = process.wait();
  EXPECT_EQ(result.exit_code, kNoneDone);
  EXPECT_TRUE(contains(result.err, "1 of 1 model is yet to be done, 0 could not be")) << result.err;
  EXPECT_TRUE(contains(result.out, "not done: ")) << result.out;
  EXPECT_EQ(batch.row("slow.stl").at("outcome"), "not done");
  EXPECT_EQ(batch.run({batch.models()}).exit_code, 0);
}

TEST(Batch, AModelThatChangesMeanwhileIsStillToBeDone) {
  const Batch batch;
  Process process(slow_command(batch, "a.stl"));
  wait_until([&] { return !temporary_files(batch.results()).empty(); });
  batch.block("a.stl");
  EXPECT_EQ(process.wait().exit_code, kNoneDone);
  EXPECT_TRUE(contains(batch.row("a.stl").at("message").get<std::string>(), "was changed since"));
  EXPECT_FALSE(fs::exists(batch.results() / "a-hollow.stl"));
  // Of what is there now.
  EXPECT_EQ(batch.run({batch.models()}).exit_code, 0);
  EXPECT_EQ(batch.result("a-hollow.stl"), batch.hollowed(batch.models() / "a.stl"));
}

TEST(Batch, OnlyWhatIsMissingOrChangedIsDoneAgain) {
  const Batch batch;
  batch.block("a.stl");
  batch.block("b.stl", 25);
  const fs::path process = batch.file("own.json", R"({"base": "fdm"})");
  const auto done_now = [&](std::vector<std::string> more = {}) {
    more.insert(more.begin(), {batch.models(), "--process", process});
    const ProcessResult result = batch.run(more);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::size_t at = result.out.find("are done, ");
    return at == std::string::npos ? -1 : std::stoi(result.out.substr(at + 10));
  };
  EXPECT_EQ(done_now(), 2);
  EXPECT_EQ(done_now(), 0);
  EXPECT_EQ(done_now({"--threads", "1", "--jobs", "2", "--device", "cpu"}), 0);  // results are the same
  const std::string before = batch.result("a-hollow.stl");
  fs::remove(batch.results() / "a-hollow.stl");
  EXPECT_EQ(done_now(), 1);
  EXPECT_EQ(batch.result("a-hollow.stl"), before);
  fs::resize_file(batch.results() / "b-hollow.stl", 1000);
  EXPECT_EQ(done_now(), 1);
  fs::remove(batch.results() / "b-hollow.json");
  EXPECT_EQ(done_now(), 1);
  batch.block("a.stl", 21);  // as many bytes
  EXPECT_EQ(done_now(), 1);
  EXPECT_NE(batch.result("a-hollow.stl"), before);
  EXPECT_EQ(done_now({"--wall", "2"}), 2);
  EXPECT_EQ(done_now({"--wall", "2"}), 0);
  EXPECT_EQ(done_now(), 2);
  batch.file("own.json", R"({"base": "fdm", "wall": 2.5})");
  EXPECT_EQ(done_now(), 2);
  EXPECT_EQ(done_now({"--pictures"}), 2);
  EXPECT_EQ(done_now({"--pictures"}), 0);
}

TEST(Batch, ARefusalLeavesNoResultOfOtherOptionsStanding) {
  const Batch batch;
  batch.block("a.stl");
  EXPECT_EQ(batch.run({batch.models()}).exit_code, 0);
  EXPECT_EQ(batch.run({batch.models(), "--wall", "15"}).exit_code, kNoneDone);
  EXPECT_FALSE(fs::exists(batch.results() / "a-hollow.stl"));
  EXPECT_FALSE(fs::exists(batch.results() / "a-hollow.json"));
  EXPECT_TRUE(fs::exists(batch.results() / "a-hollow.txt"));
}

TEST(Batch, ADryRunSaysWhatWouldBeDoneAndDoesNothing) {
  const Batch batch;
  batch.block("a.stl");
  fs::remove(batch.results());
  const ProcessResult result = batch.run({batch.models(), "--dry-run"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "to do: " + (batch.models() / "a.stl").string()));
  EXPECT_TRUE(contains(result.out, " MB"));
  EXPECT_TRUE(contains(result.out, "1 to do, 0 done"));
  EXPECT_FALSE(fs::exists(batch.results()));
  EXPECT_EQ(batch.run({batch.models()}).exit_code, 0);
  EXPECT_TRUE(contains(batch.run({batch.models(), "--dry-run"}).out, "0 to do, 1 done"));
}

TEST(Batch, AManifestSetsOptionsForEachModel) {
  const Batch batch;
  const fs::path a = batch.block("a.stl"), b = batch.block("b.stl", 30);
  batch.file("own.json", R"({"base": "fdm", "wall": 2.5})");
  const fs::path table = batch.file("list.csv",
                                    "model,output,wall,drain,keep-solid,process\r\n"
                                    "models/a.stl,\"x, y.stl\",3,,\"sphere:1,1,1,1;box:0,0,0,1,1,1\",\r\n"
                                    "models/b.stl,,,no,,own.json\r\n");
  ProcessResult result = batch.run({table, "--wall", "2"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::vector<std::string> of_a = kQuick, of_b = kQuick;
  of_a.insert(of_a.end(),
              {"--wall", "3", "--keep-solid", "sphere:1,1,1,1", "--keep-solid", "box:0,0,0,1,1,1"});
  of_b.insert(of_b.end(), {"--wall", "2", "--no-drain", "--process", batch.folder() / "own.json"});
  EXPECT_EQ(batch.result("x, y.stl"), batch.hollowed(a, of_a));
  EXPECT_EQ(batch.result("b-hollow.stl"), batch.hollowed(b, of_b));
  const Json report = Json::parse(batch.result("x, y.json"));
  EXPECT_EQ(report.at("limits").at("wall_mm"), 3);

  const fs::path lines =
      batch.file("list.jsonl",
                 "{\"model\": \"models/a.stl\", \"wall\": 4, \"keep-solid\": [\"sphere:1,1,1,1\"]}\n\n"
                 "{\"model\": \"models/b.stl\", \"drain\": false, \"output\": \"sub/c.obj\"}\n");
  result = batch.run({lines});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(Json::parse(batch.result("a-hollow.json")).at("limits").at("wall_mm"), 4);
  EXPECT_TRUE(contains(batch.result("sub/c.obj"), "v "));
}

TEST(Batch, FaultsOfAManifestAreNamedByLine) {
  const Batch batch;
  batch.block("a.stl");
  const auto refused = [&](const std::string& name, const std::string& text, int code,
                           const std::vector<std::string>& said) {
    const ProcessResult result = batch.run({batch.file(name, text)});
    EXPECT_EQ(result.exit_code, code) << text << result.err;
    for (const std::string& words : said) EXPECT_TRUE(contains(result.out + result.err, words));
  };
  refused("l.csv", "model,wal\nmodels/a.stl,2\n", kUsage, {"l.csv: line 1", "'wal'"});
  refused("l.csv", "wall\n2\n", kUsage, {"line 1", "'model'"});
  refused("l.csv", "model,wall,wall\nmodels/a.stl,2,3\n", kUsage, {"line 1", "twice"});
  refused("l.csv", "model\n\"models/a.stl\n", kUnreadable, {"line 2", "quote"});
  refused("l.csv", "", kUnreadable, {"empty"});
  EXPECT_FALSE(fs::exists(batch.results() / "a-hollow.stl"));
  // What is wrong with one line is no reason to leave out the others.
  refused("l.csv", "model,wall\nmodels/a.stl,2\nmodels/a.stl,much\n,3\nmodels/a.stl,2,3\n", kSomeNotDone,
          {"line 3", "much", "line 4", "names no model", "line 5", "3 fields"});
  EXPECT_TRUE(fs::exists(batch.results() / "a-hollow.stl"));
  refused("l.jsonl",
          "{\"model\": \"models/a.stl\"}\n{\"model\": \"models/a.stl\", \"wal\": 2}\n{nothing\n[1]\n"
          "{\"model\": \"models/a.stl\", \"wall\": {\"a\": 1}}\n",
          kSomeNotDone, {"line 2", "'wal'", "line 3", "JSON", "line 4", "line 5"});
}

TEST(Batch, TwoModelsOfOneNameAreToldBeforeWorkStartsAndTheRestIsDone) {
  const Batch batch;
  const fs::path first = batch.file("a/part.stl", to_binary_stl(block())),
                 second = batch.file("b/part.obj", "v 0 0 0\n"), third = batch.block("other.stl");
  ProcessResult result = batch.run({first, second, third});
  EXPECT_EQ(result.exit_code, kSomeNotDone);
  EXPECT_TRUE(contains(result.out, "part-hollow.stl, as that of " + second.string()));
  EXPECT_LT(result.out.find("as that of"), result.out.find("other-hollow.stl"));
  EXPECT_FALSE(fs::exists(batch.results() / "part-hollow.stl"));
  EXPECT_EQ(batch.row("other.stl").at("outcome"), "done");
  result = batch.run({first, third, "--name", "{folder}-{process}-{n}-{name}.3mf"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(fs::exists(batch.results() / "a-fdm-1-part.3mf"));
  EXPECT_TRUE(fs::exists(batch.results() / "models-fdm-2-other.3mf"));
}

TEST(Batch, NamesThatAreNoneAreRefused) {
  const Batch batch;
  const fs::path model = batch.block("a.stl");
  for (const char* name : {"{what}.stl", "../{name}.stl", "/{name}.stl", "x/", ".{name}.stl"})
    EXPECT_EQ(batch.run({model, "--name", name}).exit_code, kUsage) << name;
  // A result that would replace a model, or the summary.
  EXPECT_EQ(batch.run({model, "--name", "../models/{name}.stl"}).exit_code, kUsage);
  EXPECT_EQ(batch.run({model, "--name", "summary.stl"}).exit_code, kNoneDone);
  const std::string before = read_bytes(model);
  const ProcessResult result =
      run({AERATE_EXECUTABLE, "batch", model, "-o", batch.models(), "--name", "{name}.stl"});
  EXPECT_EQ(result.exit_code, kNoneDone);
  EXPECT_EQ(read_bytes(model), before);
}

TEST(Batch, FoldersAreSearchedForModelsAndSubFoldersKept) {
  const Batch batch;
  batch.block("a.stl");
  batch.block("deep/er/b.STL");
  batch.block("deep/.hidden.stl");
  batch.file("models/notes.txt", "no model");
  EXPECT_EQ(batch.run({batch.models()}).exit_code, 0);
  EXPECT_EQ(batch.summary().at("models").size(), 1U);
  EXPECT_EQ(batch.run({batch.models().string() + "/", "--recursive"}).exit_code, 0);
  EXPECT_EQ(batch.summary().at("models").size(), 2U);
  EXPECT_TRUE(fs::exists(batch.results() / "deep/er/b-hollow.stl"));
  // Results are no models of the next run.
  const ProcessResult inside = run({AERATE_EXECUTABLE, "batch", batch.models(), "-o", batch.models() / "out",
                                    "--recursive", "--max-voids", "1"});
  EXPECT_EQ(inside.exit_code, 0) << inside.err;
  EXPECT_TRUE(contains(run({AERATE_EXECUTABLE, "batch", batch.models(), "-o", batch.models() / "out",
                            "--recursive", "--max-voids", "1"})
                           .out,
                       "2 of 2 models are done, 0 in this run"));
  EXPECT_EQ(run({AERATE_EXECUTABLE, "batch", batch.models(), "-o", batch.models()}).exit_code, kUsage);
}

TEST(Batch, AnEmptyFolderIsAnErrorUnlessThereIsMore) {
  const Batch batch;
  ProcessResult result = batch.run({batch.models()});
  EXPECT_EQ(result.exit_code, kUnreadable);
  EXPECT_TRUE(contains(result.err, "no models in it"));
  EXPECT_TRUE(contains(result.err, "--recursive"));
  const fs::path more = batch.file("more/a.stl", to_binary_stl(block()));
  result = batch.run({batch.models(), more});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(contains(result.err, "no models in it"));
}

TEST(Batch, OptionsThatContradictEachOtherAreRefusedOnceBeforeAnyIsBegun) {
  const Batch batch;
  batch.block("a.stl");
  fs::remove(batch.results());
  const ProcessResult result = batch.run({batch.models(), "--min-radius", "5", "--max-radius", "2"});
  EXPECT_EQ(result.exit_code, kUsage);
  EXPECT_FALSE(fs::exists(batch.results()));
  EXPECT_EQ(batch.run({batch.models(), "--wall", "much"}).exit_code, kUsage);
  EXPECT_EQ(batch.run({batch.models(), "--no-such-option"}).exit_code, kUsage);
  EXPECT_EQ(run({AERATE_EXECUTABLE, "batch", "--process", "list"}).out,
            run({AERATE_EXECUTABLE, "hollow", "--process", "list"}).out);
}

TEST(Batch, OptionsMayStandInAConfigurationFile) {
  const Batch batch;
  const fs::path model = batch.block("a.stl"),
                 config = batch.file("options.ini", "[batch]\nwall = 2.5\nprocess = \"sla\"\n");
  ASSERT_EQ(batch.run({model, "--config", config, "--plugs"}).exit_code, 0);
  EXPECT_EQ(Json::parse(batch.result("a-hollow.json")).at("limits").at("wall_mm"), 2.5);
  EXPECT_TRUE(fs::exists(batch.results() / "a-hollow-plugs.stl"));
  EXPECT_TRUE(contains(batch.run({model, "--wall", "2.5", "--process", "sla", "--plugs"}).out,
                       "1 model is done, 0 in this run"));
}

TEST(Batch, NamesMayHoldSpacesLineFeedsAndAnyLetters) {
  const Batch batch;
  const std::string odd = "a <b> & \"c\"\n\xc3\xbc \xe6\xa8\xa1,\x01-x.stl", not_utf8 = "bad\xff.stl";
  batch.block(odd);
  batch.block(not_utf8);
  const ProcessResult result = batch.run({batch.models(), "--pictures"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string stem = odd.substr(0, odd.size() - 4);
  EXPECT_TRUE(fs::exists(batch.results() / (stem + "-hollow.stl")));
  EXPECT_TRUE(fs::exists(batch.results() / "bad\xff-hollow.png"));
  EXPECT_EQ(batch.summary().at("models").size(), 2U);
  const std::string page = batch.result("summary.html");
  EXPECT_TRUE(contains(page, "a &lt;b&gt; &amp; &quot;c&quot;\\x0a"));
  EXPECT_TRUE(contains(page, "a%20%3Cb%3E%20%26%20%22c%22%0A%C3%BC"));
  EXPECT_FALSE(contains(page, "<b>"));
  EXPECT_FALSE(contains(result.out, "\x01"));
  EXPECT_TRUE(contains(batch.run({batch.models(), "--pictures"}).out, "2 models are done, 0 in this run"));
}

TEST(Batch, AFullDiskIsARowForWhatDoesNotFit) {
  const Batch batch;
  const fs::path disk = batch.folder() / "disk";
  fs::create_directory(disk);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=300k") != 0)
    GTEST_SKIP() << "no permission to mount a small tmpfs";
  batch.block("small.stl");
  fs::copy(sample("bunny.stl"), batch.models() / "large.stl");  // 360 kB and its voids
  const ProcessResult result = run({AERATE_EXECUTABLE, "batch", batch.models(), "-o", disk / "out", "--jobs",
                                    "1", "--max-voids", "2", "--tolerance", "0.3"});
  EXPECT_EQ(result.exit_code, kSomeNotDone) << result.err;
  EXPECT_TRUE(contains(result.out, "No space left on device"));
  EXPECT_TRUE(fs::exists(disk / "out/small-hollow.stl"));
  EXPECT_FALSE(fs::exists(disk / "out/large-hollow.stl"));
  EXPECT_EQ(temporary_files(disk), std::vector<std::string>{});
  umount(disk.c_str());
}

TEST(Batch, WhatKilledJobsLeftIsRemovedAndNothingElse) {
  const Batch batch;
  batch.block("a.stl");
  const pid_t ended = fork();
  if (ended == 0) _exit(0);
  waitpid(ended, nullptr, 0);
  const auto left = [&](const std::string& stem, pid_t process) {
    const std::string name = "." + stem + ".aerate-" + std::to_string(process) + "-ab12.stl";
    batch.file("outputs/" + name, "half");
    return batch.results() / name;
  };
  const fs::path of_killed = left("a-hollow", ended), of_other = left("other", ended),
                 of_living = left("a-hollow", getpid());
  ASSERT_EQ(batch.run({batch.models()}).exit_code, 0);
  EXPECT_FALSE(fs::exists(of_killed));
  EXPECT_TRUE(fs::exists(of_other));
  EXPECT_TRUE(fs::exists(of_living));
}

TEST(Batch, InterruptedItEndsItsJobsAndLeavesNothingHalfDone) {
  const Batch batch;
  batch.block("quick.stl");
  for (const char* name : {"slow.stl", "slower.stl"}) fs::copy(sample("bunny.stl"), batch.models() / name);
  const std::vector<std::string> arguments{batch.models(), "--tolerance", "0.01", "--max-voids", "500"};
  Process process(batch.command(arguments));
  wait_until([&] { return !temporary_files(batch.results()).empty(); });
  process.send(SIGINT);
  const ProcessResult result = process.wait();
  EXPECT_EQ(result.exit_code, kInterrupted) << result.err;
  EXPECT_TRUE(contains(result.err, "of 3 models are done"));
  EXPECT_TRUE(at_work_for(batch.folder()).empty());
  EXPECT_EQ(temporary_files(batch.results()), std::vector<std::string>{});
  EXPECT_GT(batch.summary().at("totals").at("yet_to_do"), 0);
}

TEST(Batch, TwoAtWorkInOneFolderAreOneTooMany) {
  const Batch batch;
  batch.block("a.stl");
  ASSERT_EQ(batch.run({batch.models()}).exit_code, 0);
  const fs::path lock = batch.results() / ".aerate-batch/lock";
  const int held = open(lock.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(held, LOCK_EX | LOCK_NB), 0);  // as another batch has it
  const ProcessResult second = batch.run({batch.models()});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_TRUE(contains(second.err, "another batch is at work"));
  close(held);
  EXPECT_EQ(batch.run({batch.models()}).exit_code, 0);
}

// What ends them is slow here.
TEST(Batch, ABatchWaitsForTheJobsOfOneThatWasKilled) {
  const Batch batch;
  Process process(slow_command(batch, "slow.stl"));
  wait_until([&] { return !temporary_files(batch.results()).empty(); });
  const pid_t job = process_that_made(temporary_files(batch.results()).front());
  const pid_t keeper = parent_of(job);
  kill(keeper, SIGSTOP);
  process.send(SIGKILL);
  process.wait();
  const ProcessResult refused = batch.run({batch.models()});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(contains(refused.err, "another batch is at work"));
  EXPECT_EQ(kill(job, 0), 0);
  kill(keeper, SIGCONT);
  EXPECT_EQ(batch.run({batch.models()}).exit_code, 0);
  EXPECT_NE(kill(job, 0), 0);
  EXPECT_EQ(temporary_files(batch.results()), std::vector<std::string>{});
}

// Killed at moments that a seed chooses, and started again: nothing is lost, and nothing done twice but what was under way.
TEST(Batch, KilledAtAnyMomentItGoesOnWhereItWas) {
  const Batch batch;
  constexpr int kModels = 12, kKills = 5;
  std::map<std::string, std::string> expected;
  for (int i = 0; i < kModels; ++i) {
    const std::string name = "m" + std::to_string(i);
    const fs::path model = batch.block(name + ".stl", 20 + static_cast<float>(i));
    expected[name + "-hollow.stl"] = batch.hollowed(model);
  }
  const std::vector<std::string> command = batch.command({batch.models(), "--jobs", "2"});
  const fs::path records = batch.results() / ".aerate-batch";
  // Records of jobs that are done, with when they were written.
  const auto known = [&] {
    std::map<std::string, fs::file_time_type> found;
    if (!fs::exists(records)) return found;
    for (const std::string& name : entries_of(records))
      if (name.ends_with(".json") && !name.starts_with("."))
        found[name] = fs::last_write_time(records / name);
    return found;
  };
  std::mt19937 random(20);
  std::map<std::string, fs::file_time_type> before;
  for (int i = 0; i < kKills; ++i) {
    Process process(command);
    // After some more are done, and then at any moment.
    const std::size_t enough = std::min<std::size_t>(before.size() + random() % 3, kModels - 1);
    wait_until([&] { return known().size() >= enough || !process.running(); });
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 200));
    process.send(SIGKILL);
    process.wait();
    wait_until([&] { return at_work_for(batch.folder()).empty(); });
    for (const auto& [name, bytes] : expected) {
      if (fs::exists(batch.results() / name)) {
        EXPECT_EQ(batch.result(name), bytes) << name;
      }
    }
    const auto after = known();
    for (const auto& [name, time] : before) {
      ASSERT_TRUE(after.contains(name)) << "lost";
      EXPECT_EQ(after.at(name), time) << "done twice";
    }
    before = after;
  }
  const ProcessResult last = run(command);
  EXPECT_EQ(last.exit_code, 0) << last.err;
  const std::string left = std::to_string(expected.size() - before.size());
  EXPECT_TRUE(
      contains(last.out, std::string("12 of 12 models are done, ").append(left).append(" in this run")));
  for (const auto& [name, bytes] : expected) EXPECT_EQ(batch.result(name), bytes) << name;
  for (const auto& [name, time] : before) EXPECT_EQ(known().at(name), time);
  EXPECT_EQ(temporary_files(batch.results()), std::vector<std::string>{});
  EXPECT_EQ(batch.summary().at("totals").at("done"), kModels);
}

TEST(Batch, LargestModelsAreFirst) {
  const Batch batch;
  batch.block("a.stl");
  fs::copy(sample("pawn.obj"), batch.models() / "b.obj");
  fs::copy(sample("bunny.stl"), batch.models() / "c.stl");
  const ProcessResult result = batch.run({batch.models(), "--jobs", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(result.out.find("c-hollow"), result.out.find("b-hollow"));
  EXPECT_LT(result.out.find("b-hollow"), result.out.find("a-hollow"));
  // The summary is in the order of names.
  EXPECT_EQ(batch.summary().at("models").at(0).at("n"), 1);
  EXPECT_TRUE(contains(batch.summary().at("models").at(0).at("result").get<std::string>(), "a-hollow"));
}

}  // namespace
}  // namespace aerate::test
