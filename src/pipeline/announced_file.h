#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "core/monitor.h"
#include "files/output_file.h"

namespace aerate {

// A pending file that the monitor knows of for as long as it is pending, so that it does not stay behind when
// the process is ended.
class AnnouncedFile {
 public:
  AnnouncedFile(const std::filesystem::path& target, Monitor& monitor);
  ~AnnouncedFile();
  AnnouncedFile(const AnnouncedFile&) = delete;
  AnnouncedFile& operator=(const AnnouncedFile&) = delete;

  PendingFile& file() { return *file_; }

  // Fills the file with `text` and makes it the target. Throws FailureError with the system's reason.
  void commit_text(std::string_view text);

 private:
  Monitor& monitor_;
  std::optional<PendingFile> file_;
};

}  // namespace aerate
