#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "batch/job_record.h"
#include "batch/plan_jobs.h"
#include "core/monitor.h"

namespace aerate::batch {

// The folder of results, and the folder in it in which the batch keeps what it knows of them. One batch at a time is at work in it: throws
// FailureError if another is after a few seconds, which its jobs have to end after it was killed; and if it cannot be made. Temporary files that
// killed jobs left for these results are removed.
class ResultsFolder {
 public:
  ResultsFolder(std::filesystem::path results, const std::vector<PlannedJob>& jobs, Monitor& monitor);
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

  const std::filesystem::path& path() const { return results_; }

  // Of jobs that were killed.
  void remove_left_files() const;

 private:
  std::filesystem::path results_;
  const std::vector<PlannedJob>& jobs_;
  int lock_ = -1;
};

// Where a job's record and its small picture are kept.
std::filesystem::path record_path(const std::filesystem::path& results, const PlannedJob& job);
std::filesystem::path thumbnail_path(const std::filesystem::path& results, const PlannedJob& job);

// What is known of a job as it is planned now: nothing if it has not been done, or something that its result depends on has changed, or a file of its
// is not there as it was written.
std::optional<JobRecord> known_record(const std::filesystem::path& results, const PlannedJob& job);

// Forgets a job that begins, and removes what an earlier run made for it: a refusal is to leave no result standing that says otherwise.
void forget(const std::filesystem::path& results, const PlannedJob& job);

// Written whole or not at all. Throws FailureError.
void keep(const std::filesystem::path& results, const PlannedJob& job, const JobRecord& record);

// Those of a report of 'aerate hollow'; none of a file that is no such report.
void read_report(const std::filesystem::path& report, JobRecord& record);

}  // namespace aerate::batch
