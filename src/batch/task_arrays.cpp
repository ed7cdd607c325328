#include "batch/task_arrays.h"

#include <algorithm>
#include <map>
#include <utility>

namespace aerate::batch {
namespace {

constexpr double kSecondsOfTask = 60;

double memory_class(double bytes) {
  double memory = 1024.0 * 1024 * 1024;
  while (memory < bytes) memory *= 2;
  return memory;
}

double estimated_seconds(const BatchRow& row) {
  return row.job->estimate.seconds;
}

// Places of jobs in rows as places in the plan.
std::size_t place_of(const BatchRow& row) {
  return row.job->number - 1;
}

// One after the other until a task is full.
std::vector<ArrayTask> filled(const std::vector<const BatchRow*>& rows, std::size_t most_models,
                              double most_seconds) {
  std::vector<ArrayTask> tasks;
  double seconds = 0;
  for (const BatchRow* const row : rows) {
    const bool is_full = tasks.empty() || tasks.back().jobs.size() >= most_models ||
                         seconds + estimated_seconds(*row) > most_seconds;
    if (is_full) {
      tasks.emplace_back();
      seconds = 0;
    }
    tasks.back().jobs.push_back(place_of(*row));
    seconds += estimated_seconds(*row);
  }
  return tasks;
}

std::vector<ArrayTask> tasks_of(const std::vector<const BatchRow*>& rows, const TaskSizes& sizes) {
  std::size_t models = sizes.models == 0 ? rows.size() : sizes.models;
  double seconds = 0;
  for (const BatchRow* const row : rows) seconds += estimated_seconds(*row);
  // What is asked for goes before a minute.
  double each = sizes.models == 0 ? kSecondsOfTask : seconds + 1;
  std::vector<ArrayTask> tasks = filled(rows, models, each);
  while (tasks.size() > sizes.most_tasks) {
    models *= 2;
    each *= 2;
    tasks = filled(rows, models, each);
  }
  return tasks;
}

}  // namespace

std::vector<TaskArray> task_arrays(std::span<BatchRow* const> to_do, const std::vector<bool>& cut_off,
                                   const TaskSizes& sizes) {
  std::map<double, std::vector<const BatchRow*>> together;
  std::map<double, std::vector<const BatchRow*>> alone;
  std::map<std::size_t, double> seconds_of;
  for (std::size_t i = 0; i < to_do.size(); ++i) {
    const BatchRow* const row = to_do[i];
    auto& rows = cut_off[i] ? alone : together;
    rows[memory_class(row->job->estimate.memory_bytes)].push_back(row);
    seconds_of[place_of(*row)] = estimated_seconds(*row);
  }
  std::vector<TaskArray> arrays;
  const auto add = [&](double memory, std::vector<ArrayTask> tasks) {
    // Those of one model may be more than an array holds.
    constexpr double kTimesEstimate = 10, kAtLeast = 60;
    while (!tasks.empty()) {
      TaskArray array{.memory_bytes = memory};
      const auto count = static_cast<std::ptrdiff_t>(std::min(tasks.size(), sizes.most_tasks));
      array.tasks.assign(tasks.begin(), tasks.begin() + count);
      tasks.erase(tasks.begin(), tasks.begin() + count);
      for (const ArrayTask& task : array.tasks) {
        double seconds = 0;
        for (const std::size_t job : task.jobs) seconds += seconds_of.at(job);
        array.seconds = std::max(array.seconds, kTimesEstimate * seconds + kAtLeast);
      }
      arrays.push_back(std::move(array));
    }
  };
  for (auto rows = together.rbegin(); rows != together.rend(); ++rows)
    add(rows->first, tasks_of(rows->second, sizes));
  for (const auto& [memory, rows] : alone) add(memory, filled(rows, 1, 0));
  return arrays;
}

}  // namespace aerate::batch
