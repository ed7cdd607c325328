#include "cli/batch_outcome.h"

#include <filesystem>
#include <fmt/format.h>
#include <iostream>

#include "batch/summary.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "core/listed.h"
#include "core/printable.h"

namespace aerate::cli {
namespace {

using batch::BatchRow;
using batch::Outcome;

// Exit status of a batch beside those of all commands.
constexpr ExitCode kSomeNotDone{6}, kNoneDone{7};

}  // namespace

std::string in_time(double seconds) {
  if (seconds < 120) return fmt::format("{:.1f} s", seconds);
  return seconds < 7200 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

std::string told(const BatchRow& row) {
  const batch::JobRecord& record = row.record;
  const std::string model = printable(row.job->model.string());
  if (record.outcome != Outcome::done)
    return fmt::format("{}: {}{}: {}", name_of(record.outcome), model,
                       row.job->origin.empty() ? "" : fmt::format(" ({})", printable(row.job->origin)),
                       printable(record.message));
  const auto& share = record.figures.removed_percent;
  return fmt::format("done: {} ({}{})", printable(row.job->name.string()),
                     share ? fmt::format("{:.1f} % removed, ", *share) : "", in_time(record.seconds));
}

void tell_known_failures(std::span<const BatchRow> rows) {
  for (const BatchRow& row : rows)
    if (row.record.outcome != Outcome::done && row.record.outcome != Outcome::not_done)
      std::cout << told(row) << "\n";
}

void try_to_summarise(std::span<const BatchRow> rows, const std::string& results, bool is_quiet) {
  try {
    write_summary(rows, results, kBatchVersion);
  } catch (const FailureError& error) {
    if (!is_quiet) print_note(error.what());
  }
}

void finish_batch(std::span<const BatchRow> rows, const std::string& results, std::size_t in_this_run,
                  bool is_quiet) {
  const batch::Counts counts = batch::counts_of(rows);
  const bool is_all = counts.done == rows.size();
  if (is_all) {
    write_summary(rows, results, kBatchVersion);
  } else {
    try_to_summarise(rows, results, is_quiet);
  }
  const std::string page = (std::filesystem::path(results) / "summary.html").string();
  const std::string all = counted(rows.size(), "model", "models");
  if (!is_quiet)
    std::cout << fmt::format("{} of {} {} done, {} in this run; {}\n", counts.done, all,
                             rows.size() == 1 ? "is" : "are", in_this_run, printable(page));
  require_stdout_written();
  if (is_all) return;
  const ExitCode code = counts.done > 0 ? kSomeNotDone : kNoneDone;
  if (counts.yet_to_do > 0)
    throw Error(code,
                fmt::format("{} of {} {} yet to be done, {} could not be", counts.yet_to_do, all,
                            counts.yet_to_do == 1 ? "is" : "are", counts.not_done),
                fmt::format("{} has the reasons; the same command goes on from there", page));
  throw Error(code, fmt::format("{} of {} could not be hollowed", counts.not_done, all),
              fmt::format("{} has the reasons; they are tried again when something changed, or with "
                          "--retry-failed",
                          page));
}

}  // namespace aerate::cli
