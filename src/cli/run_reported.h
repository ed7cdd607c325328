#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/called_commands.h"
#include "cli/model_options.h"
#include "cli/reports.h"
#include "core/monitor.h"

namespace aerate::cli {

// A report for people and for programs.
struct RenderedReport {
  std::string text;
  std::string json;
};

// What a job reads and writes. No output, nor the report, may replace what is read.
struct JobFiles {
  std::vector<NamedInput> inputs;
  std::vector<std::filesystem::path> outputs;

  void add_outputs(const std::vector<std::filesystem::path>& more) {
    outputs.insert(outputs.end(), more.begin(), more.end());
  }
};

// As `run_reported`, for a job whose report is rendered.
void run_rendered(const RunOptions& options, const JobFiles& files,
                  const std::function<RenderedReport(Monitor&)>& job, Verbosity notices);

// As `run_reported`, for a caller who makes what he likes of what the job returns. Throws UsageError for a report that was to be
// written, too.
void run_called(const RunOptions& options, JobFiles files, const Call& call,
                const std::function<void()>& job);

// Runs a job under the options that all commands share, and writes its report: as text to standard output, or
// as JSON there, or as JSON to a file beside the text. That file is opened first, so that a place which cannot
// be written to is found before the work.
//   job: Report(Monitor&)
//   notices: whether they are shown, if not as the options say
// Throws UsageError if an output is one of the inputs, by whatever name, or the report's; FailureError if the
// report cannot be written, naming the outputs that were; and what the job throws.
template <typename Job>
void run_reported(const RunOptions& options, const JobFiles& files, const Job& job,
                  std::optional<Verbosity> notices = {}) {
  const auto rendered = [&](Monitor& monitor) {
    const auto report = job(monitor);
    return RenderedReport{to_text(report), to_json(report)};
  };
  run_rendered(options, files, rendered, notices.value_or(options.verbosity()));
}

}  // namespace aerate::cli
