#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>

#include "cli/model_options.h"
#include "core/monitor.h"
#include "pipeline/announced_file.h"

namespace aerate::cli {

// Where a command's report goes: as text to standard output, or as JSON there, or as JSON to a file beside
// the text. The file is opened when this is made, so that a place which cannot be written to is found before
// the work.
class ReportOutput {
 public:
  // Throws UsageError if the JSON would replace one of `others`, FailureError if the file cannot be made.
  ReportOutput(const RunOptions& options, std::initializer_list<std::filesystem::path> others,
               Monitor& monitor);

  // Writes what was asked for; each rendering is made only if it is needed.
  void write(const std::function<std::string()>& as_text, const std::function<std::string()>& as_json);

 private:
  const RunOptions& options_;
  std::optional<AnnouncedFile> file_;
};

}  // namespace aerate::cli
