#include "batch/slurm.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <string_view>

#include "core/error.h"
#include "core/printable.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/text_file.h"

namespace aerate::batch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kUsualMostTasks = 1000;
constexpr int kNotFound = 127;

// What a command printed. Its refusal is an error in its own words.
std::string said_by(std::vector<std::string> arguments, Monitor& monitor) {
  constexpr const char* kHint = "is Slurm there, and does 'sinfo' answer? Without it: --engine local";
  const PrivateFolder folder(monitor);
  ChildCommand command;
  command.arguments = std::move(arguments);
  command.folder = folder.path();
  // Which would choose among tasks, or change what is printed of them.
  command.without = {"SQUEUE_*", "SCANCEL_*", "SBATCH_WAIT", "SBATCH_CLUSTERS"};
  // All commands are for the one that sbatch is for.
  if (const char* const clusters = std::getenv("SBATCH_CLUSTERS"))
    command.environment = {{"SLURM_CLUSTERS", clusters}};
  const std::string& name = command.arguments.front();
  ChildOutcome outcome;
  try {
    outcome = run_child(command, monitor);
  } catch (const FailureError& error) {
    throw FailureError(error.what(), kHint);
  }
  if (outcome.exit_code == kNotFound) throw FailureError(name + ": cannot be run", kHint);
  if (outcome.exit_code != 0) {
    const std::string said = printable(on_one_line(without_blanks(outcome.printed)));
    throw FailureError(
        fmt::format("{}: {}", name,
                    said.empty() ? fmt::format("ended with exit status {}", outcome.exit_code) : said),
        kHint);
  }
  return outcome.printed;
}

// For the shell that runs a task's script.
std::string shell_word(std::string_view text) {
  std::string word = "'";
  for (const char byte : text) word += byte == '\'' ? std::string("'\\''") : std::string(1, byte);
  return word + "'";
}

// As Slurm takes them: whole minutes, and whole MiB.
std::string minutes(double seconds) {
  return fmt::format("{:.0f}", std::ceil(seconds / 60));
}
std::string mebibytes(double bytes) {
  return fmt::format("{:.0f}M", std::ceil(bytes / (1024.0 * 1024.0)));
}

// As Slurm takes a name for which it puts numbers in place of patterns.
std::string without_patterns(const fs::path& path) {
  std::string text;
  for (const char byte : path.string()) text += byte == '%' ? "%%" : std::string(1, byte);
  return text;
}

// The identity that 'sbatch --parsable' prints, without the cluster's name; warnings may go before it.
std::string identity_in(std::string_view printed) {
  std::string identity;
  for_each_line(printed, [&](std::string_view line) {
    const std::string_view digits = line.substr(0, line.find(';'));
    if (!digits.empty() && digits.find_first_not_of("0123456789") == std::string_view::npos)
      identity = digits;
    return true;
  });
  if (identity.empty())
    throw FailureError(fmt::format("sbatch: names no job: {}", printable(on_one_line(printed))));
  return identity;
}

}  // namespace

std::size_t TasksUnderWay::waiting_in_all() const {
  std::size_t count = 0;
  for (const auto& [reason, tasks] : waiting) count += tasks;
  return count;
}

void require_usable(const SlurmRequest& request, const fs::path& results) {
  const std::string folder = fs::absolute(results).string();
  if (folder.find('\\') != std::string::npos)
    throw UsageError(
        fmt::format("{}: Slurm takes a backslash in the name of a folder for a sign of its own", folder),
        "give another folder with -o");
  constexpr std::array<std::string_view, 6> kRefused{"-W", "--wait", "-M", "--cluster", "--test", "--wrap"};
  for (const std::string& option : request.options) {
    if (!option.starts_with('-') || option == "-" || option == "--")
      throw UsageError(fmt::format("--sbatch-option: '{}' is no option of sbatch", printable(option)),
                       "write an option and its value as one, as in --sbatch-option=--qos=low");
    for (const std::string_view refused : kRefused)
      if (option.starts_with(refused) && !option.starts_with("--wait-all-nodes"))
        throw UsageError(
            fmt::format("--sbatch-option: with '{}' the batch would not know of its tasks",
                        printable(option)),
            "--wait of the batch waits; for another cluster set SLURM_CLUSTERS for all its commands");
  }
}

std::size_t most_tasks_of_array(Monitor& monitor) {
  std::size_t most = kUsualMostTasks;
  for_each_line(said_by({"scontrol", "show", "config"}, monitor), [&](std::string_view line) {
    constexpr std::string_view kName = "MaxArraySize";
    if (!line.starts_with(kName)) return true;
    const std::string_view value = without_blanks(line.substr(std::min(line.find('=') + 1, line.size())));
    std::size_t size = 0;
    if (std::from_chars(value.data(), value.data() + value.size(), size).ec == std::errc() && size > 0)
      most = size;
    return false;
  });
  return most;
}

std::string submit_array(const Submission& submission, std::size_t array, const fs::path& results,
                         const fs::path& program, const SlurmRequest& request, Monitor& monitor) {
  const TaskArray& tasks = submission.arrays.at(array);
  std::string range = fmt::format("0-{}", tasks.tasks.size() - 1);
  if (request.most_tasks_at_a_time > 0) range += fmt::format("%{}", request.most_tasks_at_a_time);
  std::vector<std::string> command{"sbatch",
                                   "--ntasks=1",
                                   fmt::format("--cpus-per-task={}", submission.threads),
                                   "--mem=" + mebibytes(tasks.memory_bytes),
                                   "--time=" + minutes(tasks.seconds),
                                   "--requeue"};
  if (!request.partition.empty()) command.push_back("--partition=" + request.partition);
  if (!request.account.empty()) command.push_back("--account=" + request.account);
  command.insert(command.end(), request.options.begin(), request.options.end());
  // By which the batch knows its tasks: last, so that it holds. An option without its value takes the first one for it, so that stands there twice.
  const std::string log = without_patterns(fs::absolute(submissions_folder(results))) + "/%A-%a.txt";
  const fs::path file = fs::absolute(submission_path(results, submission.name));
  command.insert(command.end(),
                 {"--parsable", "--parsable", "--job-name=" + submission.name, "--array=" + range,
                  "--open-mode=append", "--chdir=/", "--output=" + log, "--error=" + log,
                  fmt::format("--wrap=exec {} batch-task {} {}", shell_word(program.string()),
                              shell_word(file.string()), array)});
  return identity_in(said_by(std::move(command), monitor));
}

TasksUnderWay tasks_under_way(const Submission& submission, Monitor& monitor) {
  if (submission.is_over) return {};
  const std::string printed = said_by(
      {"squeue", "--all", "--noheader", "--array", "--name=" + submission.name, "--format=%T %r"}, monitor);
  TasksUnderWay under_way;
  for_each_line(printed, [&](std::string_view line) {
    line = without_blanks(line);
    const std::string_view state = line.substr(0, line.find(' '));
    constexpr std::string_view kWaiting = "PENDING";
    // Warnings, and the name of the cluster where SLURM_CLUSTERS is set.
    if (state.ends_with(':') || state.empty()) return true;
    if (state == kWaiting)
      ++under_way.waiting[std::string(without_blanks(line.substr(state.size())))];
    else
      ++under_way.running;
    return true;
  });
  return under_way;
}

void cancel_tasks(const Submission& submission, Monitor& monitor) {
  static_cast<void>(said_by({"scancel", "--name=" + submission.name}, monitor));
}

}  // namespace aerate::batch
