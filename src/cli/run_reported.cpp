#include "cli/run_reported.h"

#include <iostream>
#include <optional>

#include "cli/interrupt.h"
#include "cli/terminal.h"
#include "core/error.h"
#include "pipeline/announced_file.h"
#include "pipeline/thread_limit.h"

namespace aerate::cli {
namespace {

void require_other_files(const std::string& json, std::initializer_list<std::filesystem::path> files) {
  for (const std::filesystem::path& file : files) {
    if (weakly_canonical(file) == weakly_canonical(std::filesystem::path(json)))
      throw UsageError("--json " + json + " would replace " + file.string(), "give another name");
  }
}

}  // namespace

void run_rendered(const RunOptions& options, std::initializer_list<std::filesystem::path> files,
                  const std::function<RenderedReport(Monitor&)>& job, Verbosity notices) {
  InterruptGuard interrupt;
  TerminalMonitor monitor(interrupt, notices);
  std::optional<AnnouncedFile> file;
  if (!options.json.empty() && options.json != "-") {
    require_other_files(options.json, files);
    file.emplace(options.json, monitor);
  }
  RenderedReport report;
  run_with_threads(options.threads, [&] { report = job(monitor); });
  monitor.clear();
  if (file) file->commit_text(report.json);
  if (options.json == "-") {
    std::cout << report.json;
  } else if (options.verbosity() != Verbosity::quiet) {
    std::cout << report.text;
  }
}

}  // namespace aerate::cli
