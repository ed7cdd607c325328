#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "batch/submission.h"
#include "core/monitor.h"

// Slurm's own commands (sbatch, squeue, scancel, scontrol), looked for on the path. All functions throw FailureError with what these said if one
// is not there, or refuses.
namespace aerate::batch {

// What is passed on to sbatch as it stands.
struct SlurmRequest {
  std::string partition, account;    // empty: the cluster's own
  std::vector<std::string> options;  // "--qos=low"
  int most_tasks_at_a_time = 0;      // 0: as many as there is room for
};

// Tasks that are not over.
struct TasksUnderWay {
  std::size_t running = 0;
  std::map<std::string, std::size_t> waiting = {};  // by Slurm's reason

  std::size_t waiting_in_all() const;
  bool none() const { return running == 0 && waiting.empty(); }
};

// Throws UsageError for options with which the batch would not know of its tasks, and for a folder that Slurm cannot write to.
void require_usable(const SlurmRequest& request, const std::filesystem::path& results);

// How many tasks an array may have.
std::size_t most_tasks_of_array(Monitor& monitor);

// Submits one array of a submission that has been kept; its identity in the cluster. What is asked for goes before what the batch itself decides by estimates.
//   program: this one, by the name that it has on the nodes
std::string submit_array(const Submission& submission, std::size_t array,
                         const std::filesystem::path& results, const std::filesystem::path& program,
                         const SlurmRequest& request, Monitor& monitor);

// Does not ask where it is known that all have ended.
TasksUnderWay tasks_under_way(const Submission& submission, Monitor& monitor);

void cancel_tasks(const Submission& submission, Monitor& monitor);

}  // namespace aerate::batch
