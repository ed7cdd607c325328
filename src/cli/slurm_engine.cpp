#include "cli/slurm_engine.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <fmt/format.h>
#include <iostream>
#include <optional>
#include <random>
#include <set>
#include <string_view>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

#include "batch/job_state.h"
#include "batch/summary.h"
#include "cli/batch_outcome.h"
#include "cli/command_line.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "core/listed.h"
#include "core/printable.h"
#include "pipeline/memory.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/text_file.h"

namespace aerate::cli {
namespace {

namespace fs = std::filesystem;
using batch::BatchRow;
using batch::Outcome;
using batch::Submission;
using batch::TaskArray;
using batch::TasksUnderWay;

std::string new_name() {
  std::random_device random;
  return fmt::format("aerate-{:08x}{:08x}", random(), random());
}

std::string identities(const Submission& submission) {
  std::vector<std::string> names;
  for (const TaskArray& array : submission.arrays)
    if (!array.id.empty()) names.push_back(array.id);
  return names.empty() ? submission.name : listed(names, "and");
}

std::string job_in_words(const Submission& submission) {
  return (submission.arrays.size() > 1 ? "Slurm jobs " : "Slurm job ") + identities(submission);
}

std::string under_way_in_words(const TasksUnderWay& tasks) {
  std::string words = fmt::format("{} running", counted(tasks.running, "task", "tasks"));
  for (const auto& [reason, count] : tasks.waiting)
    words += fmt::format(", {} waiting{}", count,
                         reason.empty() || reason == "None" ? "" : fmt::format(" ({})", printable(reason)));
  return words;
}

// Why a job was not done, where what its task wrote says so.
std::string why_not_done(const batch::PlannedJob& job, const fs::path& log) {
  std::error_code ignored;
  if (!fs::is_regular_file(log, ignored)) return "its task was not begun";
  const std::string begin = told({.job = &job});
  std::string why, why_ended;
  for_each_line(read_text(log), [&](std::string_view line) {
    constexpr std::string_view kError = "error:";
    if (line.starts_with(begin)) why = line.substr(begin.size());
    if (const std::size_t at = line.find(kError); at != std::string_view::npos)
      why_ended = without_blanks(line.substr(at + kError.size()));
    return true;
  });
  if (!why.empty()) return why;
  return why_ended.empty() ? "its task was ended" : "its task was ended: " + why_ended;
}

// Those for which tasks wait that will be begun.
bool is_usual(const std::string& reason) {
  constexpr std::array<std::string_view, 5> kUsual{"", "None", "Priority", "Resources", "JobArrayTaskLimit"};
  return std::ranges::find(kUsual, reason) != kUsual.end();
}

// What is known of jobs that are tried again is forgotten, and known again where they could not be.
class RetriedJobs {
 public:
  RetriedJobs(const std::vector<BatchRow*>& to_do, const fs::path& results) : results_(results) {
    for (const BatchRow* const row : to_do) {
      std::optional<batch::JobRecord> known = batch::known_record(results_, *row->job);
      if (!known) continue;
      records_.emplace_back(row->job, *std::move(known));
      batch::forget(results_, *row->job);
    }
  }

  void restore() const {
    for (const auto& [job, record] : records_)
      if (!batch::known_record(results_, *job)) batch::keep(results_, *job, record);
  }

 private:
  const fs::path& results_;
  std::vector<std::pair<const batch::PlannedJob*, batch::JobRecord>> records_;
};

// Opens the folders in which other machines have written: a network file system may say for a minute that a file is not there, but looks again then.
void look_anew(const Submission& submission, const fs::path& results) {
  std::set<fs::path> folders{batch::state_folder(results)};
  for (const batch::PlannedJob& job : submission.plan)
    if (job.fault.empty()) folders.insert(job.paths.result.parent_path());
  for (const fs::path& folder : folders) {
    std::error_code ignored;
    for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
         entry.increment(ignored)) {
    }
  }
}

void sleep(std::chrono::milliseconds time, Monitor& monitor) {
  constexpr std::chrono::milliseconds kStep(50);
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
    monitor.check_interrupted();
    std::this_thread::sleep_for(kStep);
  }
}

std::string name_of_this_machine() {
  std::string name(256, '\0');
  if (::gethostname(name.data(), name.size() - 1) != 0) return "this machine";
  return name.substr(0, name.find('\0'));
}

// The place in which the batch was begun, with the program that it was begun by.
void enter(const Submission& submission) {
  const std::string machine = name_of_this_machine();
  if (submission.version != kBatchVersion)
    throw FailureError(fmt::format("{}: the program here is {}, the batch is of {}", machine, kBatchVersion,
                                   submission.version));
  std::error_code error;
  fs::current_path(submission.working_folder, error);
  if (error)
    throw FailureError(
        fmt::format("{}: {}: {}", machine, submission.working_folder.string(), error.message()),
        "the folder in which the batch was begun has to be there under the same name on all nodes");
}

// The number that Slurm gives a task in its array.
std::size_t number_of_task() {
  const char* const text = std::getenv("SLURM_ARRAY_TASK_ID");
  const std::string_view digits = text == nullptr ? "" : text;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size())
    throw UsageError(
        "SLURM_ARRAY_TASK_ID is no number: this command is for tasks of 'aerate batch --engine slurm'");
  return number;
}

}  // namespace

std::string SlurmEngine::in_words(const std::vector<BatchRow*>& to_do) const {
  const std::vector<TaskArray> arrays =
      batch::task_arrays(to_do, std::vector<bool>(to_do.size()), {.models = options_.models_of_task});
  std::vector<std::string> words;
  words.reserve(arrays.size());
  for (const TaskArray& array : arrays)
    words.push_back(fmt::format("{} of {} and {} each at most", counted(array.tasks.size(), "task", "tasks"),
                                format_bytes(array.memory_bytes), in_time(array.seconds)));
  return listed(words, "and");
}

bool SlurmEngine::submit(const std::vector<batch::PlannedJob>& plan, bool retry_failed,
                         const fs::path& program) {
  batch::require_usable(options_.request, results_);
  const batch::ResultsFolder folder(results_, plan, monitor_);
  require_no_cluster_at_work(results_, monitor_);  // since it was asked for the last time
  std::vector<BatchRow> rows = batch::known_rows(plan, results_, retry_failed);
  const std::vector<BatchRow*> to_do = batch::rows_to_do(rows);
  if (!options_.is_quiet) tell_known_failures(rows);
  if (to_do.empty()) {
    finish_batch(rows, results_, 0, options_.is_quiet);
    return false;
  }
  std::vector<bool> cut_off;
  cut_off.reserve(to_do.size());
  for (const BatchRow* const row : to_do) cut_off.push_back(batch::is_marked_begun(results_, *row->job));
  Submission submission{.name = new_name(),
                        .version = kBatchVersion,
                        .working_folder = fs::current_path(),
                        .threads = options_.threads,
                        .plan = plan,
                        .arrays = batch::task_arrays(to_do, cut_off,
                                                     {.models = options_.models_of_task,
                                                      .most_tasks = batch::most_tasks_of_array(monitor_)})};
  const fs::path results = results_;
  const RetriedJobs retried(to_do, results);
  try {
    hand_over(submission, program);
  } catch (const FailureError&) {
    retried.restore();
    throw;
  }
  std::size_t tasks = 0;
  for (const TaskArray& array : submission.arrays) tasks += array.tasks.size();
  try_to_summarise(rows, results_, options_.is_quiet);
  if (!options_.is_quiet)
    std::cout << fmt::format("{} handed over in {}: {}\n", counted(to_do.size(), "model", "models"),
                             counted(tasks, "task", "tasks"), job_in_words(submission))
              << std::flush;
  return true;
}

void SlurmEngine::hand_over(Submission& submission, const fs::path& program) const {
  batch::clear_submissions(results_);
  // Known before it is handed over: what is killed in between finds it by its name.
  batch::keep_submission(results_, submission);
  for (std::size_t i = 0; i < submission.arrays.size(); ++i) {
    try {
      submission.arrays[i].id =
          batch::submit_array(submission, i, results_, program, options_.request, monitor_);
    } catch (const FailureError&) {
      take_back(submission);
      throw;
    }
    batch::keep_submission(results_, submission);
  }
}

// Of which Slurm may have taken a part, whatever it said. It stays known where that cannot be found out.
void SlurmEngine::take_back(const Submission& submission) const {
  try {
    batch::cancel_tasks(submission, monitor_);
    if (wait_for_end(submission)) batch::clear_submissions(results_);
  } catch (const FailureError&) {
    // What was refused is told, and not this.
  }
}

// False if it takes too long.
bool SlurmEngine::wait_for_end(const Submission& submission) const {
  constexpr std::chrono::seconds kLongest(120);
  constexpr std::chrono::milliseconds kPause(250);
  const auto start = std::chrono::steady_clock::now();
  while (!batch::tasks_under_way(submission, monitor_).none()) {
    if (std::chrono::steady_clock::now() - start > kLongest) return false;
    sleep(kPause, monitor_);
  }
  return true;
}

Submission SlurmEngine::submission() const {
  std::optional<Submission> last = batch::last_submission(results_);
  if (!last)
    throw UsageError(fmt::format("{}: nothing of it is in the hands of a cluster", results_),
                     "hand it over by 'aerate batch MODELS -o FOLDER --engine slurm'");
  return *std::move(last);
}

std::vector<BatchRow> SlurmEngine::rows_of(const Submission& submission, bool is_over) const {
  if (is_over) look_anew(submission, results_);
  std::vector<BatchRow> rows = batch::known_rows(submission.plan, results_, false);
  for (const TaskArray& array : submission.arrays)
    for (std::size_t task = 0; task < array.tasks.size(); ++task)
      for (const std::size_t job : array.tasks[task].jobs) {
        BatchRow& row = rows[job];
        row.is_new = row.record.outcome != Outcome::not_done;
        if (is_over && !row.is_new)
          row.record.message = why_not_done(*row.job, batch::task_log(results_, array, task));
      }
  return rows;
}

// A controller that is begun anew says nothing for a while.
TasksUnderWay SlurmEngine::patiently_asked(const Submission& submission) const {
  constexpr std::chrono::seconds kLongest(120), kPause(2);
  const auto start = std::chrono::steady_clock::now();
  for (bool is_told = options_.is_quiet;; is_told = true) {
    try {
      return batch::tasks_under_way(submission, monitor_);
    } catch (const FailureError& error) {
      if (std::chrono::steady_clock::now() - start > kLongest) throw;
      if (!is_told) print_note(fmt::format("{}; asked again", error.what()));
    }
    sleep(kPause, monitor_);
  }
}

// Where nothing runs, and what waits may wait for ever.
void SlurmEngine::tell_what_waits(const Submission& submission, const TasksUnderWay& tasks,
                                  std::set<std::string>& told) const {
  if (options_.is_quiet || tasks.running > 0) return;
  bool is_new = false;
  for (const auto& [reason, count] : tasks.waiting)
    if (!is_usual(reason)) is_new = told.insert(reason).second || is_new;
  if (is_new)
    std::cout << fmt::format("{}: {}\n", job_in_words(submission), under_way_in_words(tasks)) << std::flush;
}

void SlurmEngine::follow() {
  constexpr std::chrono::milliseconds kFirst(250), kLongest(10000);
  const Submission followed = submission();
  std::vector<bool> is_told(followed.plan.size());
  std::vector<std::size_t> handed_over;
  for (const TaskArray& array : followed.arrays)
    for (const batch::ArrayTask& task : array.tasks)
      handed_over.insert(handed_over.end(), task.jobs.begin(), task.jobs.end());
  std::size_t ended = 0;
  std::set<std::string> reasons_told;
  for (std::chrono::milliseconds pause = kFirst;; pause = std::min(pause * 3 / 2, kLongest)) {
    // Asked first: what ends between the two is told.
    const TasksUnderWay tasks = patiently_asked(followed);
    const bool is_over = tasks.none();
    tell_what_waits(followed, tasks, reasons_told);
    const std::vector<BatchRow> rows = rows_of(followed, is_over);
    for (const std::size_t job : handed_over) {
      if (is_told[job] || !rows[job].is_new) continue;
      is_told[job] = true;
      ++ended;
      if (!options_.is_quiet)
        std::cout << fmt::format("[{}/{}] {}\n", ended, handed_over.size(), told(rows[job])) << std::flush;
    }
    if (is_over) return;
    if (pause >= kLongest) try_to_summarise(rows, results_, options_.is_quiet);
    sleep(pause, monitor_);
  }
}

void SlurmEngine::follow_if_any() {
  if (batch::last_submission(results_)) follow();
}

void SlurmEngine::status() {
  const Submission asked = submission();
  const TasksUnderWay tasks = batch::tasks_under_way(asked, monitor_);
  const batch::Counts counts = batch::counts_of(rows_of(asked, tasks.none()));
  std::cout << fmt::format("{} of {} done, {} could not be, {} yet to do; {}: {}\n", counts.done,
                           counted(asked.plan.size(), "model", "models"), counts.not_done, counts.yet_to_do,
                           job_in_words(asked), tasks.none() ? "ended" : under_way_in_words(tasks));
  require_stdout_written();
}

// Alone in the folder: what has been handed over since it was asked for is seen now.
TasksUnderWay SlurmEngine::end_submission(const Submission& submission) const {
  TasksUnderWay tasks = batch::tasks_under_way(submission, monitor_);
  if (tasks.none()) batch::mark_submission_over(results_, submission);
  return tasks;
}

void SlurmEngine::cancel() {
  const Submission cancelled = submission();
  batch::cancel_tasks(cancelled, monitor_);
  if (!wait_for_end(cancelled))
    throw FailureError(fmt::format("{} has not ended yet", job_in_words(cancelled)),
                       "ask again with --status");
  const batch::ResultsFolder folder(results_, cancelled.plan, monitor_);
  end_submission(cancelled);
  const std::vector<BatchRow> rows = rows_of(cancelled, true);
  try_to_summarise(rows, results_, options_.is_quiet);
  const batch::Counts counts = batch::counts_of(rows);
  if (!options_.is_quiet)
    std::cout << fmt::format("{} was cancelled; {} of {} done\n", job_in_words(cancelled), counts.done,
                             counted(rows.size(), "model", "models"));
  require_stdout_written();
}

void SlurmEngine::collect() {
  const Submission collected = submission();
  TasksUnderWay tasks = batch::tasks_under_way(collected, monitor_);
  std::optional<batch::ResultsFolder> folder;  // alone in it when all have ended
  if (tasks.none()) {
    folder.emplace(results_, collected.plan, monitor_);
    tasks = end_submission(collected);
  }
  const std::vector<BatchRow> rows = rows_of(collected, tasks.none());
  const auto is_new =
      static_cast<std::size_t>(std::ranges::count_if(rows, [](const BatchRow& row) { return row.is_new; }));
  if (!tasks.none() && !options_.is_quiet)
    std::cout << fmt::format("{}: {}\n", job_in_words(collected), under_way_in_words(tasks));
  finish_batch(rows, results_, is_new, options_.is_quiet);
}

void require_no_cluster_at_work(const fs::path& results, Monitor& monitor) {
  const std::optional<Submission> last = batch::last_submission(results);
  if (!last) return;
  TasksUnderWay tasks;
  try {
    tasks = batch::tasks_under_way(*last, monitor);
  } catch (const FailureError& error) {
    throw FailureError(
        fmt::format("{}: was handed over to a cluster ({}), which cannot be asked whether it is at work: {}",
                    results.string(), job_in_words(*last), error.what()),
        fmt::format("run this where 'squeue' answers; if the cluster is gone, remove {}",
                    (batch::submissions_folder(results) / "last").string()));
  }
  if (tasks.none()) return;
  throw FailureError(
      fmt::format("{}: {} is at work there ({})", results.string(), job_in_words(*last),
                  under_way_in_words(tasks)),
      fmt::format(
          "'aerate batch -o {} --status' says how far it is, --cancel ends it; with --engine slurm --wait "
          "this command waits for it",
          results.string()));
}

void run_cluster_task(const fs::path& submission_file, std::size_t array, Monitor& monitor) {
  const Submission submission = batch::read_submission(submission_file);
  enter(submission);
  const OwnCommands commands(exit_status_of);  // in the folder that names of models are relative to
  const std::size_t number = number_of_task();
  if (array >= submission.arrays.size() || number >= submission.arrays[array].tasks.size())
    throw UsageError(fmt::format("{} has no task {} of array {}", submission_file.string(), number, array));
  const fs::path results = batch::results_of(submission_file);
  std::vector<batch::PlannedJob> jobs;
  for (const std::size_t job : submission.arrays[array].tasks[number].jobs)
    jobs.push_back(submission.plan[job]);
  std::vector<BatchRow> rows;
  rows.reserve(jobs.size());
  for (const batch::PlannedJob& job : jobs) rows.push_back({.job = &job});
  std::vector<BatchRow*> in_task;
  in_task.reserve(rows.size());
  for (BatchRow& row : rows) in_task.push_back(&row);
  const batch::ResultsFolder folder(results, jobs, monitor, batch::Use::together);
  std::cout << fmt::format("{} on {}\n", counted(jobs.size(), "model", "models"), name_of_this_machine())
            << std::flush;
  const auto run = [&](const ChildCommand& command, Monitor& of_job) {
    return commands.run(command, of_job);
  };
  batch::run_task(
      in_task, run, folder, submission.threads,
      [](const BatchRow& row) { std::cout << told(row) << "\n"
                                          << std::flush; }, monitor);
}

}  // namespace aerate::cli
