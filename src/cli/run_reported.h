#pragma once

#include <filesystem>
#include <initializer_list>

#include "cli/interrupt.h"
#include "cli/model_options.h"
#include "cli/report_json.h"
#include "cli/report_output.h"
#include "cli/report_text.h"
#include "cli/slice_report.h"
#include "cli/terminal.h"
#include "pipeline/thread_limit.h"

namespace aerate::cli {

// Runs a job under the options that all commands share, and writes its report.
//   files: what the job reads and writes, which the report must not replace
//   job: Report(Monitor&)
template <typename Job>
void run_reported(const RunOptions& options, std::initializer_list<std::filesystem::path> files,
                  InterruptGuard& interrupt, const Job& job) {
  TerminalMonitor monitor(interrupt, options.verbosity());
  ReportOutput output(options, files, monitor);
  decltype(job(monitor)) report;
  run_with_threads(options.threads, [&] { report = job(monitor); });
  monitor.clear();
  output.write([&] { return to_text(report); }, [&] { return to_json(report); });
}

}  // namespace aerate::cli
