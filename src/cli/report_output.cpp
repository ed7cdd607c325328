#include "cli/report_output.h"

#include <iostream>

#include "core/error.h"

namespace aerate::cli {

ReportOutput::ReportOutput(const RunOptions& options, std::initializer_list<std::filesystem::path> others,
                           Monitor& monitor)
    : options_(options) {
  if (options_.json.empty() || options_.json == "-") return;
  for (const std::filesystem::path& other : others) {
    if (weakly_canonical(other) == weakly_canonical(std::filesystem::path(options_.json)))
      throw UsageError("--json " + options_.json + " would replace " + other.string(), "give another name");
  }
  file_.emplace(options_.json, monitor);
}

void ReportOutput::write(const std::function<std::string()>& as_text,
                         const std::function<std::string()>& as_json) {
  if (file_) file_->commit_text(as_json());
  if (options_.json == "-") {
    std::cout << as_json();
  } else if (options_.verbosity() != Verbosity::quiet) {
    std::cout << as_text();
  }
}

}  // namespace aerate::cli
