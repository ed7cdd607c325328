#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "batch/job_record.h"
#include "batch/plan_jobs.h"
#include "core/monitor.h"
#include "printing/slicers/child_process.h"

namespace aerate::batch {

class ResultsFolder;

// What the machine gives to all jobs together.
struct RunBounds {
  int jobs = 1;             // at a time, at most
  int threads = 1;          // of all
  double memory_bytes = 0;  // that estimates may come to; one job is always begun
};

// A job and what became of it.
struct BatchRow {
  const PlannedJob* job = nullptr;
  JobRecord record = {};
  bool is_new = false;  // done in this run, not found as it had been left
};

// Rows of what need not be done, in the order of the jobs: faults, and what is known. The others are not done yet.
//   retry_failed: those that are not done are to be tried again
std::vector<BatchRow> known_rows(const std::vector<PlannedJob>& jobs, const std::filesystem::path& results,
                                 bool retry_failed);

// Those that are yet to be done, the largest first.
std::vector<BatchRow*> rows_to_do(std::vector<BatchRow>& rows);

// How many of these would run at a time, and the threads of each.
struct Shares {
  int jobs = 1, threads = 1;
};
Shares shares_of(const RunBounds& bounds, std::size_t to_do);

// Runs a command of this program, in a process of its own: "aerate hollow ...".
using RunCommand = std::function<ChildOutcome(const ChildCommand&, Monitor&)>;

// Does them, each in a process of its own. Each row is filled in when its job has ended, and `ended` called with it, one at a
// time and from any thread; it may look at all rows. What is told to end stays to be done, as does what a file was changed of since it was planned. Throws InterruptedError once all processes that were started have ended; rows of these are as if not begun.
void run_jobs(const std::vector<BatchRow*>& to_do, const RunCommand& run, const ResultsFolder& results,
              const RunBounds& bounds, const std::function<void(const BatchRow&)>& ended, Monitor& monitor);

// The same for a task of a cluster: one after the other, and a job that cut this task off before as the last one. What another task has done is not done again.
//   threads: of each
void run_task(const std::vector<BatchRow*>& rows, const RunCommand& run, const ResultsFolder& results,
              int threads, const std::function<void(const BatchRow&)>& ended, Monitor& monitor);

}  // namespace aerate::batch
