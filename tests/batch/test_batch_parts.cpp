#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "batch/digest.h"
#include "batch/job_state.h"
#include "batch/manifest.h"
#include "batch/name_template.h"
#include "batch/plan_jobs.h"
#include "batch/run_jobs.h"
#include "batch/summary.h"
#include "core/error.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"
#include "view/image.h"
#include "view/png_bytes.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;
using Fields = std::vector<std::string>;

TEST(BatchParts, ADigestIsSha256) {
  EXPECT_EQ(digest_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const test::TemporaryFolder folder;
  const std::string long_text(1000000, 'a');
  EXPECT_EQ(digest_of_file(folder.write("a", long_text)),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_THROW(digest_of_file(folder.path()), InputError);
}

TEST(BatchParts, TablesAreReadAsRfc4180HasThem) {
  const auto records = parse_csv("a,\"b \"\"c\"\"\nd\",\r\n\n\"\",e;f\n,", ',', "t");
  ASSERT_EQ(records.size(), 3U);
  EXPECT_EQ(records[0].fields, (Fields{"a", "b \"c\"\nd", ""}));
  EXPECT_EQ(records[1].fields, (Fields{"", "e;f"}));
  EXPECT_EQ(records[1].line, 4U);
  EXPECT_EQ(records[2].fields, (Fields{"", ""}));
  EXPECT_THROW(parse_csv("a\n\"b", ',', "t"), InputError);
}

TEST(BatchParts, TablesOfOtherCountriesHaveSemicolons) {
  const test::TemporaryFolder folder;
  const std::vector<OptionRule> rules{{.name = "wall"}};
  const auto rows = read_manifest(folder.write("l.csv", "\xef\xbb\xbfmodel;wall\r\na.stl;2\r\n"), rules);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].model, folder.path() / "a.stl");
  EXPECT_EQ(rows[0].options, (std::vector<GivenOption>{{.name = "wall", .values = {"2"}}}));
}

TEST(BatchParts, OptionsOfAModelGoBeforeThoseOfAll) {
  const std::vector<OptionRule> rules{{.name = "wall"},
                                      {.name = "drain", .kind = OptionRule::Kind::flag, .may_be_off = true},
                                      {.name = "force", .kind = OptionRule::Kind::flag}};
  const std::vector<GivenOption> all{{.name = "force"}, {.name = "wall", .values = {"1"}}, {.name = "drain"}};
  EXPECT_EQ(arguments_of(merged(rules, all, {})), (Fields{"--wall=1", "--drain", "--force"}));
  EXPECT_EQ(arguments_of(merged(rules, all,
                                {{.name = "drain", .is_off = true},
                                 {.name = "force", .is_off = true},
                                 {.name = "wall", .values = {"2"}}})),
            (Fields{"--wall=2", "--no-drain"}));
}

TEST(BatchParts, NamesComeFromTemplates) {
  const NameParts parts{"a{n}", "folder", "sla", 7};
  EXPECT_EQ(name_from("{folder}/{name}-{process}-{n}.stl", parts), "folder/a{n}-sla-7.stl");
  EXPECT_EQ(name_from("x{.stl", parts), "x{.stl");
  EXPECT_THROW(name_from("{other}", parts), UsageError);
  EXPECT_THROW(name_from("../{name}", parts), UsageError);
}

TEST(BatchParts, SmallPicturesAreMeansOfLargeOnes) {
  Image image(400, 300, {0, 0, 0});
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 400; x += 2) image.set(x, y, {200, 100, 50});
  Image mean(100, 75, {100, 50, 25});
  EXPECT_EQ(smaller_png(png_of(image), 100), png_of(mean));
  EXPECT_EQ(smaller_png(png_of(mean), 100), png_of(mean));
  EXPECT_THROW(smaller_png("no picture", 100), InputError);
  EXPECT_THROW(smaller_png(png_of(image).substr(0, 200), 100), InputError);
}

// Jobs for a program that writes down when it begins and ends.
class Jobs {
 public:
  explicit Jobs(std::size_t count, double memory) {
    for (std::size_t i = 0; i < count; ++i) {
      PlannedJob& job = jobs_.emplace_back();
      job.name = std::to_string(i) + ".stl";
      const fs::path stem = folder_.path() / std::to_string(i);
      job.paths.result = stem.string() + ".stl";
      job.paths.report = stem.string() + ".json";
      job.paths.log = stem.string() + ".txt";
      job.estimate.memory_bytes = memory;
      job.model = "model";
    }
  }

  // The most that were under way at a time.
  int most_at_a_time(const std::string& script, const RunBounds& bounds) {
    const fs::path program = folder_.write("program", "#!/bin/sh\n" + script);
    fs::permissions(program, fs::perms::owner_all);
    Monitor monitor;
    const ResultsFolder results(folder_.path(), jobs_, monitor);
    rows_ = known_rows(jobs_, results.path(), true);
    run_jobs(
        rows_to_do(rows_),
        [&](const ChildCommand& hollow, Monitor& of_job) {
          ChildCommand command = hollow;
          command.arguments.front() = program;
          return run_child(command, of_job);
        },
        results, bounds, [](const BatchRow&) {}, monitor);
    std::ifstream log(folder_.path() / "moments");
    int now = 0, most = 0;
    for (std::string word; log >> word;) most = std::max(most, now += word == "begin" ? 1 : -1);
    EXPECT_EQ(now, 0);
    return most;
  }

  const std::vector<BatchRow>& rows() const { return rows_; }
  std::string moments() const { return (folder_.path() / "moments").string(); }

 private:
  test::TemporaryFolder folder_;
  std::vector<PlannedJob> jobs_;
  std::vector<BatchRow> rows_;
};

TEST(BatchParts, NoMoreAtATimeThanMemoryHolds) {
  for (const int room : {0, 2, 3}) {
    Jobs jobs(8, 100);
    const std::string script = "echo begin >>" + jobs.moments() + "; sleep 0.1; echo end >>" + jobs.moments();
    const int most =
        jobs.most_at_a_time(script, {.jobs = 8, .threads = 8, .memory_bytes = 100.0 * room + 50});
    EXPECT_LE(most, std::max(room, 1));  // one is always begun
    EXPECT_EQ(counts_of(jobs.rows()).done, 8U);
  }
  Jobs jobs(8, 100);
  const std::string script = "echo begin >>" + jobs.moments() + "; sleep 0.1; echo end >>" + jobs.moments();
  EXPECT_LE(jobs.most_at_a_time(script, {.jobs = 2, .threads = 8, .memory_bytes = 1e9}), 2);
}

TEST(BatchParts, ThreadsAreSharedOut) {
  EXPECT_EQ(shares_of({.jobs = 8, .threads = 8}, 2).jobs, 2);
  EXPECT_EQ(shares_of({.jobs = 8, .threads = 8}, 2).threads, 4);
  EXPECT_EQ(shares_of({.jobs = 8, .threads = 4}, 100).threads, 1);
}

TEST(BatchParts, HowAJobEndedIsToldFromItsExitStatusAndItsWords) {
  Jobs jobs(1, 100);
  jobs.most_at_a_time("echo 'aerate: error: model: open' >&2; echo 'aerate: hint: close it' >&2; exit 4",
                      {.memory_bytes = 1e9});
  EXPECT_EQ(jobs.rows()[0].record.outcome, Outcome::refused);
  EXPECT_EQ(jobs.rows()[0].record.message, "open (close it)");
  jobs.most_at_a_time("kill -SEGV $$", {.memory_bytes = 1e9});
  EXPECT_EQ(jobs.rows()[0].record.outcome, Outcome::crashed);
  EXPECT_EQ(jobs.rows()[0].record.exit_code, 128 + 11);
}

}  // namespace
}  // namespace aerate::batch
