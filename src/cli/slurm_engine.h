#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "batch/plan_jobs.h"
#include "batch/slurm.h"
#include "batch/task_arrays.h"
#include "core/monitor.h"

namespace aerate::cli {

// What the user asks of a batch on a cluster.
struct SlurmOptions {
  batch::SlurmRequest request = {};
  std::size_t models_of_task = 0;  // 0: by the estimates
  int threads = 1;                 // of each model
  bool is_quiet = false;
};

// A batch whose jobs are done by a Slurm cluster, in a folder that all its machines share. Each function says what it finds on standard output.
class SlurmEngine {
 public:
  SlurmEngine(std::string results, SlurmOptions options, Monitor& monitor)
      : results_(std::move(results)), options_(std::move(options)), monitor_(monitor) {}

  // How a batch would be handed over, in words.
  std::string in_words(const std::vector<batch::BatchRow*>& to_do) const;

  // Hands over what is yet to be done, and returns at once; with nothing to do it ends the batch as `collect` does. Throws FailureError if an
  // earlier batch is under way in this folder, or the cluster refuses: nothing is in its hands then. Throws UsageError for options that cannot be given.
  // Whether something was.
  bool submit(const std::vector<batch::PlannedJob>& plan, bool retry_failed,
              const std::filesystem::path& program);

  // Returns when no task is under way any more.
  void follow();
  void follow_if_any();  // of an earlier batch

  void status();
  void cancel();
  // The summary of what is done by now; throws as finish_batch does.
  void collect();

 private:
  batch::Submission submission() const;
  void hand_over(batch::Submission& submission, const std::filesystem::path& program) const;
  void take_back(const batch::Submission& submission) const;
  bool wait_for_end(const batch::Submission& submission) const;
  batch::TasksUnderWay patiently_asked(const batch::Submission& submission) const;
  void tell_what_waits(const batch::Submission& submission, const batch::TasksUnderWay& tasks,
                       std::set<std::string>& told) const;
  batch::TasksUnderWay end_submission(const batch::Submission& submission) const;
  std::vector<batch::BatchRow> rows_of(const batch::Submission& submission, bool is_over) const;

  std::string results_;
  SlurmOptions options_;
  Monitor& monitor_;
};

// Throws FailureError if a cluster is at work in this folder, or it cannot be asked whether it is.
void require_no_cluster_at_work(const std::filesystem::path& results, Monitor& monitor);

// What a task of the cluster does, 'aerate batch-task SUBMISSION ARRAY'.
void run_cluster_task(const std::filesystem::path& submission, std::size_t array, Monitor& monitor);

}  // namespace aerate::cli
