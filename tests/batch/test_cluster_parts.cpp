#include <cstddef>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "batch/run_jobs.h"
#include "batch/submission.h"
#include "batch/task_arrays.h"
#include "core/error.h"
#include "tests/support/temporary_folder.h"

// How a batch is divided into a cluster's tasks, and how these learn what to do.
namespace aerate::batch {
namespace {

namespace fs = std::filesystem;

constexpr double kGib = 1024.0 * 1024.0 * 1024.0;

struct Rows {
  explicit Rows(const std::vector<JobEstimate>& estimates) {
    for (const JobEstimate& estimate : estimates) {
      PlannedJob job;
      job.number = jobs.size() + 1;
      job.estimate = estimate;
      jobs.push_back(std::move(job));
    }
    for (const PlannedJob& job : jobs) rows.push_back({.job = &job});
    for (BatchRow& row : rows) to_do.push_back(&row);
  }

  std::vector<PlannedJob> jobs;
  std::vector<BatchRow> rows;
  std::vector<BatchRow*> to_do;
};

std::vector<TaskArray> divided(const Rows& rows, const TaskSizes& sizes = {}) {
  return task_arrays(rows.to_do, std::vector<bool>(rows.to_do.size()), sizes);
}

TEST(TaskArrays, ATaskHasA64thOfTheWorkButNeitherTooLittleNorTooMuch) {
  const auto of = [](std::size_t jobs) {
    return Rows(std::vector<JobEstimate>(jobs, {.memory_bytes = 1e8, .seconds = 1}));
  };
  const auto arrays = divided(of(98));
  ASSERT_EQ(arrays.size(), 1U);
  ASSERT_EQ(arrays[0].tasks.size(), 20U);
  EXPECT_EQ(arrays[0].tasks[0].jobs.size(), 5U);
  EXPECT_EQ(arrays[0].tasks[19].jobs, (std::vector<std::size_t>{95, 96, 97}));
  EXPECT_EQ(arrays[0].memory_bytes, kGib);
  EXPECT_EQ(arrays[0].seconds, 10 * 5 + 60);
  EXPECT_EQ(divided(of(640))[0].tasks.size(), 64U);
  EXPECT_EQ(divided(of(6000))[0].tasks.size(), 100U);
  // One that takes longer has its own.
  EXPECT_EQ(divided(Rows({{.seconds = 500}, {.seconds = 500}}))[0].tasks.size(), 2U);
}

TEST(TaskArrays, WhatIsAskedForGoesBeforeTheEstimates) {
  const Rows rows(std::vector<JobEstimate>(10, {.seconds = 100}));
  const auto arrays = divided(rows, {.models = 4});
  ASSERT_EQ(arrays[0].tasks.size(), 3U);
  EXPECT_EQ(arrays[0].tasks[2].jobs, (std::vector<std::size_t>{8, 9}));
}

TEST(TaskArrays, AnArrayHasNoMoreTasksThanTheClusterTakes) {
  const Rows rows(std::vector<JobEstimate>(100, {.seconds = 100}));
  for (const std::size_t models : {std::size_t{0}, std::size_t{1}}) {
    const auto arrays = divided(rows, {.models = models, .most_tasks = 30});
    ASSERT_EQ(arrays.size(), 1U);
    EXPECT_LE(arrays[0].tasks.size(), 30U);
    std::size_t jobs = 0;
    for (const ArrayTask& task : arrays[0].tasks) jobs += task.jobs.size();
    EXPECT_EQ(jobs, 100U);
  }
}

TEST(TaskArrays, ModelsThatNeedMoreMemoryAreInAnArrayOfTheirOwn) {
  const auto arrays = divided(Rows({{.memory_bytes = 5 * kGib}, {.memory_bytes = 3.9 * kGib}, {}, {}}));
  ASSERT_EQ(arrays.size(), 3U);
  EXPECT_EQ(arrays[0].memory_bytes, 8 * kGib);
  EXPECT_EQ(arrays[1].memory_bytes, 4 * kGib);
  EXPECT_EQ(arrays[2].tasks[0].jobs, (std::vector<std::size_t>{2, 3}));
}

TEST(TaskArrays, WhatCutATaskOffHasOneOfItsOwn) {
  const Rows rows(std::vector<JobEstimate>(5, JobEstimate{}));
  const auto arrays = task_arrays(rows.to_do, {false, true, false, true, false}, {.most_tasks = 1});
  ASSERT_EQ(arrays.size(), 3U);
  EXPECT_EQ(arrays[0].tasks[0].jobs, (std::vector<std::size_t>{0, 2, 4}));
  EXPECT_EQ(arrays[1].tasks[0].jobs, (std::vector<std::size_t>{1}));
  EXPECT_EQ(arrays[2].tasks[0].jobs, (std::vector<std::size_t>{3}));
}

TEST(Submissions, AreReadAsTheyWereWrittenWhateverTheFolderIsCalled) {
  const test::TemporaryFolder folder;
  const fs::path results = folder.path() / "results";
  EXPECT_FALSE(last_submission(results));
  clear_submissions(results);
  Submission written{.name = "aerate-1", .version = "aerate 9", .working_folder = "/w \xff", .threads = 3};
  written.plan.push_back(
      {.number = 1,
       .model = "m/a\xff\n.stl",
       .origin = "list.csv: line 2",
       .name = "sub/a\xff\n-hollow.stl",
       .paths = {.result = results / "sub/a\xff\n-hollow.stl", .report = results / "sub/a.json"},
       .arguments = {"--wall=2", "--process=x\xff"},
       .key = "abc",
       .model_bytes = 684,
       .estimate = {.triangles = 12, .memory_bytes = 1e8, .seconds = 0.3}});
  written.plan.push_back({.number = 2, .model = "b.stl", .fault = "it is none", .fault_code = 3});
  written.arrays.push_back({.memory_bytes = kGib, .seconds = 70, .tasks = {{{0}}}, .id = "17"});
  keep_submission(results, written);
  fs::rename(results, folder.path() / "moved");
  const auto read = last_submission(folder.path() / "moved");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->name, written.name);
  EXPECT_EQ(read->version, written.version);
  EXPECT_EQ(read->working_folder, written.working_folder);
  EXPECT_EQ(read->threads, 3);
  ASSERT_EQ(read->plan.size(), 2U);
  const PlannedJob &job = read->plan[0], &was = written.plan[0];
  EXPECT_EQ(job.number, 1U);
  EXPECT_EQ(job.model, was.model);
  EXPECT_EQ(job.origin, was.origin);
  EXPECT_EQ(job.name, was.name);
  EXPECT_EQ(job.paths.result, folder.path() / "moved/sub/a\xff\n-hollow.stl");
  EXPECT_EQ(job.paths.report, folder.path() / "moved/sub/a.json");
  EXPECT_TRUE(job.paths.picture.empty());
  EXPECT_EQ(job.arguments, was.arguments);
  EXPECT_EQ(job.key, "abc");
  EXPECT_EQ(job.model_bytes, 684);
  EXPECT_EQ(job.estimate.seconds, 0.3);
  EXPECT_EQ(read->plan[1].fault, "it is none");
  EXPECT_EQ(read->plan[1].fault_code, 3);
  ASSERT_EQ(read->arrays.size(), 1U);
  EXPECT_EQ(read->arrays[0].id, "17");
  EXPECT_EQ(read->arrays[0].tasks[0].jobs, (std::vector<std::size_t>{0}));
  EXPECT_FALSE(read->is_over);
  mark_submission_over(folder.path() / "moved", *read);
  EXPECT_TRUE(last_submission(folder.path() / "moved")->is_over);
  // Another one is not over by that.
  written.name = "aerate-2";
  keep_submission(folder.path() / "moved", written);
  EXPECT_FALSE(last_submission(folder.path() / "moved")->is_over);
  // What is left of one that was being removed is none.
  fs::remove(submission_path(folder.path() / "moved", "aerate-2"));
  EXPECT_FALSE(last_submission(folder.path() / "moved"));
}

TEST(Submissions, AFileThatIsNoneIsRefused) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(read_submission(folder.path() / "none.cbor"), InputError);
  EXPECT_THROW(read_submission(folder.write("junk.cbor", "junk")), InputError);
  EXPECT_THROW(read_submission(folder.write("map.cbor", "\xa0")), InputError);
}

}  // namespace
}  // namespace aerate::batch
