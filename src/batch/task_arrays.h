#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "batch/run_jobs.h"

namespace aerate::batch {

// Models that one process of a cluster does, one after the other.
struct ArrayTask {
  std::vector<std::size_t> jobs = {};  // places in the plan
};

// Tasks that are submitted together and may each take as much memory and time.
struct TaskArray {
  double memory_bytes = 0, seconds = 0;  // of a task, at most
  std::vector<ArrayTask> tasks = {};
  std::string id = {};  // as the cluster calls it, once it is submitted
};

struct TaskSizes {
  std::size_t models = 0;         // of each task; 0: by the estimates
  std::size_t most_tasks = 1000;  // of an array
};

// Tasks for the jobs that are yet to be done, in the order in which they are given (the largest first): an array for each doubling of memory from
// 1 GiB on. A task has as many models as a minute is estimated to do, or more where there would be too many tasks. What has cut
// a task off before has one of its own. Memory is what estimates say; time is ten times that and a minute, since
// options decide it as much as sizes.
//   cut_off: for each of them
std::vector<TaskArray> task_arrays(std::span<BatchRow* const> to_do, const std::vector<bool>& cut_off,
                                   const TaskSizes& sizes);

}  // namespace aerate::batch
