#include "batch/run_jobs.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <fmt/format.h>
#include <mutex>
#include <string_view>
#include <system_error>
#include <tbb/parallel_for.h>
#include <thread>
#include <utility>

#include "batch/job_state.h"
#include "core/error.h"
#include "core/printable.h"
#include "files/output_file.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/text_file.h"
#include "view/png_bytes.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;

constexpr int kFirstSignal = 128;
constexpr int kThumbnailWidth = 200;

Outcome outcome_of(int exit_code) {
  if (exit_code == 0) return Outcome::done;
  if (exit_code == static_cast<int>(ExitCode::interrupted) || exit_code == kFirstSignal + SIGTERM)
    return Outcome::not_done;
  if (exit_code > kFirstSignal) return Outcome::crashed;
  return exit_code == static_cast<int>(ExitCode::failure) ? Outcome::failed : Outcome::refused;
}

// The last error that a job printed, with its hint.
std::string error_in(std::string_view printed) {
  constexpr std::string_view kError = "aerate: error: ", kHint = "aerate: hint: ";
  std::string error;
  for_each_line(printed, [&](std::string_view line) {
    if (line.starts_with(kError)) error = line.substr(kError.size());
    if (line.starts_with(kHint)) error += fmt::format(" ({})", line.substr(kHint.size()));
    return true;
  });
  return error;
}

std::string message_of(const ChildOutcome& outcome, const fs::path& model) {
  std::string said = error_in(outcome.printed);
  // The row names the model.
  if (const std::string name = printable(model.string()) + ": "; said.starts_with(name))
    said.erase(0, name.size());
  if (!said.empty()) return said;
  if (outcome_of(outcome.exit_code) == Outcome::not_done) return "its process was told to end";
  if (outcome.exit_code <= kFirstSignal)
    return fmt::format("it ended with exit status {}", outcome.exit_code);
  const int signal = outcome.exit_code - kFirstSignal;
  return fmt::format("its process was ended by signal {}{}", signal,
                     signal == SIGKILL ? ", as the system does where memory runs out" : "");
}

// A name that cannot be taken for an option.
std::string as_argument(const fs::path& path) {
  return path.string().starts_with('-') ? "./" + path.string() : path.string();
}

ChildCommand command_of(const PlannedJob& job, int threads, fs::path folder) {
  ChildCommand command;
  command.folder = std::move(folder);
  command.add({"aerate", "hollow", as_argument(job.model), "--output=" + job.paths.result.string(),
               "--json=" + job.paths.report.string(), fmt::format("--threads={}", threads)});
  command.arguments.insert(command.arguments.end(), job.arguments.begin(), job.arguments.end());
  const auto add_file = [&](const char* option, const fs::path& file) {
    if (!file.empty()) command.add({option + file.string()});
  };
  add_file("--picture=", job.paths.picture);
  add_file("--view=", job.paths.page);
  add_file("--plugs=", job.paths.plugs);
  return command;
}

void write_text(const fs::path& path, std::string_view text) {
  PendingFile file(path);
  write_bytes(text, file);
  file.commit();
}

void make_thumbnail(const PlannedJob& job, const fs::path& results) {
  if (job.paths.picture.empty()) return;
  write_text(thumbnail_path(results, job), smaller_png(read_text(job.paths.picture), kThumbnailWidth));
}

JobRecord refused_before(const Error& error) {
  return {.outcome = outcome_of(static_cast<int>(error.code())),
          .exit_code = static_cast<int>(error.code()),
          .message = error.what()};
}

// Its key is of files that are there no more: a record would call done what is not.
JobRecord not_done_for(const fs::path& changed) {
  return {.message = fmt::format("{}: was changed since the batch was planned", changed.string())};
}

// One job, from its start to its record.
JobRecord run_job(const PlannedJob& job, const RunCommand& run, int threads, const fs::path& folder,
                  const ResultsFolder& results, Monitor& monitor) {
  if (const auto changed = changed_file(job)) return not_done_for(*changed);
  forget(results.path(), job);
  JobRecord record;
  try {
    std::error_code error;
    fs::create_directories(job.paths.result.parent_path(), error);
    if (error)
      throw FailureError(
          fmt::format("{}: cannot be made: {}", job.paths.result.parent_path().string(), error.message()));
    const auto start = std::chrono::steady_clock::now();
    ChildCommand command = command_of(job, threads, folder);
    command.held = results.lock();
    const ChildOutcome outcome = run(command, monitor);
    record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    record.exit_code = outcome.exit_code;
    record.outcome = outcome_of(outcome.exit_code);
    if (outcome.exit_code > kFirstSignal) results.remove_left_files();
    if (const auto changed = changed_file(job)) {
      remove_files(job);
      return not_done_for(*changed);
    }
    if (record.outcome == Outcome::done) {
      read_report(job.paths.report, record);
    } else {
      record.message = message_of(outcome, job.model);
    }
    if (record.outcome == Outcome::not_done) return record;
    write_text(job.paths.log, outcome.printed);
    if (record.outcome == Outcome::done) make_thumbnail(job, results.path());
    keep(results.path(), job, record);
  } catch (const InterruptedError&) {
    throw;
  } catch (const Error& error) {
    // Of what is beside the result; what the job itself said comes first.
    if (record.message.empty()) record = refused_before(error);
  }
  return record;
}

// Gives jobs to threads, in their order but for those that memory has no room for yet.
class Scheduler {
 public:
  Scheduler(const std::vector<BatchRow*>& rows, double memory) : waiting_(rows), memory_(memory) {}

  // The next one; null where there is none left, or nothing is to be begun any more.
  BatchRow* next() {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (stopped_ || waiting_.empty()) return nullptr;
      const auto fits = std::ranges::find_if(waiting_, [&](const BatchRow* row) {
        return running_ == 0 || used_ + row->job->estimate.memory_bytes <= memory_;
      });
      if (fits != waiting_.end()) {
        BatchRow* const row = *fits;
        waiting_.erase(fits);
        used_ += row->job->estimate.memory_bytes;
        ++running_;
        return row;
      }
      ended_.wait(lock);
    }
  }

  void ended(const BatchRow& row) {
    const std::scoped_lock lock(mutex_);
    used_ -= row.job->estimate.memory_bytes;
    --running_;
    ended_.notify_all();
  }

  void stop(std::exception_ptr why) {
    const std::scoped_lock lock(mutex_);
    if (!stopped_) why_ = std::move(why);
    stopped_ = true;
    ended_.notify_all();
  }

  void rethrow() const {
    if (why_) std::rethrow_exception(why_);
  }

 private:
  std::vector<BatchRow*> waiting_;
  double memory_, used_ = 0;
  int running_ = 0;
  bool stopped_ = false;
  std::exception_ptr why_;
  std::mutex mutex_;
  std::condition_variable ended_;
};

}  // namespace

std::vector<BatchRow> known_rows(const std::vector<PlannedJob>& jobs, const fs::path& results,
                                 bool retry_failed) {
  std::vector<BatchRow> rows(jobs.size());
  tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t i) {
    const PlannedJob& job = jobs[i];
    BatchRow& row = rows[i];
    row.job = &job;
    if (!job.fault.empty()) {
      row.record = {.outcome = outcome_of(job.fault_code), .exit_code = job.fault_code, .message = job.fault};
      return;
    }
    auto known = known_record(results, job);
    if (known && (known->outcome == Outcome::done || !retry_failed)) row.record = *std::move(known);
  });
  return rows;
}

std::vector<BatchRow*> rows_to_do(std::vector<BatchRow>& rows) {
  std::vector<BatchRow*> to_do;
  for (BatchRow& row : rows)
    if (row.record.outcome == Outcome::not_done) to_do.push_back(&row);
  std::ranges::stable_sort(to_do, std::greater{},
                           [](const BatchRow* row) { return row->job->estimate.triangles; });
  return to_do;
}

Shares shares_of(const RunBounds& bounds, std::size_t to_do) {
  const int jobs = std::max(1, std::min(bounds.jobs, static_cast<int>(std::min<std::size_t>(to_do, 1024))));
  return {jobs, std::max(1, bounds.threads / jobs)};
}

void run_jobs(const std::vector<BatchRow*>& to_do, const RunCommand& run, const ResultsFolder& results,
              const RunBounds& bounds, const std::function<void(const BatchRow&)>& ended, Monitor& monitor) {
  if (to_do.empty()) return;
  const PrivateFolder folder(monitor);
  const Shares shares = shares_of(bounds, to_do.size());
  Scheduler scheduler(to_do, bounds.memory_bytes);
  std::mutex one_at_a_time;
  const auto work = [&](int worker) {
    try {
      const fs::path own = folder.path() / std::to_string(worker);
      fs::create_directory(own);
      while (BatchRow* const row = scheduler.next()) {
        monitor.check_interrupted();
        JobRecord record = run_job(*row->job, run, shares.threads, own, results, monitor);
        scheduler.ended(*row);
        const std::scoped_lock lock(one_at_a_time);
        row->record = std::move(record);
        row->is_new = true;
        ended(*row);
      }
    } catch (...) {
      scheduler.stop(std::current_exception());
    }
  };
  {
    std::vector<std::jthread> threads;
    threads.reserve(static_cast<std::size_t>(shares.jobs));
    for (int worker = 0; worker < shares.jobs; ++worker) threads.emplace_back(work, worker);
  }
  try {
    scheduler.rethrow();
  } catch (const InterruptedError&) {
    results.remove_left_files();
    throw;
  }
}

void run_task(const std::vector<BatchRow*>& rows, const RunCommand& run, const ResultsFolder& results,
              int threads, const std::function<void(const BatchRow&)>& ended, Monitor& monitor) {
  const PrivateFolder folder(monitor);
  std::vector<BatchRow*> in_order = rows;
  // Not std::ranges': clang 14 does not compile that.
  std::stable_partition(in_order.begin(), in_order.end(),
                        [&](const BatchRow* row) { return !is_marked_begun(results.path(), *row->job); });
  for (BatchRow* const row : in_order) {
    monitor.check_interrupted();
    const PlannedJob& job = *row->job;
    if (auto known = known_record(results.path(), job)) {
      row->record = *std::move(known);
      continue;
    }
    mark_begun(results.path(), job);
    row->record = run_job(job, run, threads, folder.path(), results, monitor);
    row->is_new = true;
    if (row->record.outcome != Outcome::not_done) mark_ended(results.path(), job);
    ended(*row);
  }
}

}  // namespace aerate::batch
