#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "batch/job_record.h"
#include "batch/plan_jobs.h"
#include "core/monitor.h"

namespace aerate::batch {

// Who works in a folder of results: one batch, or the tasks of a cluster together.
enum class Use { alone, together };

// The folder of results, and the folder in it in which the batch keeps what it knows of them. Throws
// FailureError if another batch is at work in it and stays so for a few seconds (a minute for tasks), which its jobs have to end after it was killed; and if
// it cannot be made. Who is alone removes temporary files that killed jobs left for these results.
class ResultsFolder {
 public:
  ResultsFolder(std::filesystem::path results, const std::vector<PlannedJob>& jobs, Monitor& monitor,
                Use use = Use::alone);
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

  const std::filesystem::path& path() const { return results_; }

  // A descriptor that holds the folder for as long as any process has it.
  int lock() const { return lock_; }

  // Of jobs that were killed.
  void remove_left_files() const;

 private:
  std::filesystem::path results_;
  const std::vector<PlannedJob>& jobs_;
  Use use_;
  int lock_ = -1;
};

// The folder in it in which the batch keeps what it knows.
std::filesystem::path state_folder(const std::filesystem::path& results);

// Where a job's record and its small picture are kept.
std::filesystem::path record_path(const std::filesystem::path& results, const PlannedJob& job);
std::filesystem::path thumbnail_path(const std::filesystem::path& results, const PlannedJob& job);

// What is known of a job as it is planned now: nothing if it has not been done, or something that its result depends on has changed, or a file of its
// is not there as it was written.
std::optional<JobRecord> known_record(const std::filesystem::path& results, const PlannedJob& job);

// Forgets a job that begins, and removes what an earlier run made for it: a refusal is to leave no result standing that says otherwise.
void forget(const std::filesystem::path& results, const PlannedJob& job);

// Removes what a job made, where that counts for nothing.
void remove_files(const PlannedJob& job);

// Written whole or not at all. Throws FailureError.
void keep(const std::filesystem::path& results, const PlannedJob& job, const JobRecord& record);

// A task of a cluster begins with a job; and: it has ended, however. What is marked and has no task is what a task was ended with, and perhaps by.
void mark_begun(const std::filesystem::path& results, const PlannedJob& job);
void mark_ended(const std::filesystem::path& results, const PlannedJob& job);
bool is_marked_begun(const std::filesystem::path& results, const PlannedJob& job);

// Those of a report of 'aerate hollow'; none of a file that is no such report.
void read_report(const std::filesystem::path& report, JobRecord& record);

}  // namespace aerate::batch
