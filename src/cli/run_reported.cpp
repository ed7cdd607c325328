#include "cli/run_reported.h"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <iostream>
#include <optional>
#include <system_error>

#include "cli/interrupt.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "core/listed.h"
#include "pipeline/announced_file.h"
#include "pipeline/thread_limit.h"

namespace aerate::cli {
namespace {

namespace fs = std::filesystem;

// By what the names stand for, where there is something.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path whole_a = fs::weakly_canonical(a, error), whole_b = fs::weakly_canonical(b, error);
  return !error && whole_a == whole_b;
}

void require_other_files(const std::string& json, const JobFiles& files) {
  const bool has_json = !json.empty() && json != "-";
  for (const auto& [what, input] : files.inputs) {
    if (input.empty()) continue;
    for (const fs::path& output : files.outputs) {
      if (is_same_file(input, output))
        throw UsageError(fmt::format("{}: the output is the {} itself", output.string(), what),
                         fmt::format("give another name; the {} is never overwritten", what));
    }
    if (has_json && is_same_file(input, json))
      throw UsageError(fmt::format("--json {} would replace the {}", json, what), "give another name");
  }
  for (std::size_t i = 1; i < files.outputs.size(); ++i) {
    const fs::path& output = files.outputs[i];
    const auto before = files.outputs.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::any_of(files.outputs.begin(), before,
                    [&](const fs::path& other) { return is_same_file(other, output); }))
      throw UsageError(fmt::format("{} would be written twice", output.string()),
                       "give each output a name of its own");
  }
  for (const fs::path& output : files.outputs) {
    if (has_json && is_same_file(output, json))
      throw UsageError(fmt::format("--json {} would replace {}", json, output.string()), "give another name");
  }
}

void write_report(const RenderedReport& report, const RunOptions& options,
                  std::optional<AnnouncedFile>& file) {
  if (file) file->commit_text(report.json);
  if (options.json == "-") {
    std::cout << report.json;
  } else if (options.verbosity() != Verbosity::quiet) {
    std::cout << report.text;
  }
  require_stdout_written();
}

// What is done is done: a script has to know that the result is there.
FailureError report_lost(const FailureError& error, const JobFiles& files) {
  if (files.outputs.empty()) return error;
  std::vector<std::string> names;
  for (const fs::path& output : files.outputs) names.push_back(output.string());
  return FailureError(
      fmt::format("{} was written, but its report could not be: {}", listed(names, "and"), error.what()),
      error.hint());
}

}  // namespace

void run_rendered(const RunOptions& options, const JobFiles& files,
                  const std::function<RenderedReport(Monitor&)>& job, Verbosity notices) {
  InterruptGuard interrupt;
  TerminalMonitor monitor(interrupt, notices);
  require_other_files(options.json, files);
  std::optional<AnnouncedFile> file;
  if (!options.json.empty() && options.json != "-") {
    file.emplace(options.json, monitor);
  }
  RenderedReport report;
  run_with_threads(options.threads, [&] { report = job(monitor); });
  monitor.clear();
  try {
    write_report(report, options, file);
  } catch (const FailureError& error) {
    throw report_lost(error, files);
  }
}

void run_called(const RunOptions& options, JobFiles files, const Call& call,
                const std::function<void()>& job) {
  if (!options.json.empty())
    throw UsageError("--json: the report is what this function returns", "leave it out");
  if (call.arrays != nullptr)
    std::erase_if(files.inputs, [&](const NamedInput& input) { return input.what == "model"; });
  require_other_files("", files);
  run_with_threads(options.threads, job);
}

}  // namespace aerate::cli
