#include "pipeline/announced_file.h"

#include <fmt/format.h>
#include <system_error>

#include "core/error.h"

namespace aerate {

AnnouncedFile::AnnouncedFile(const std::filesystem::path& target, Monitor& monitor) : monitor_(monitor) {
  file_.emplace(target);
  monitor_.temporary_file_made(file_->path());
}

AnnouncedFile::~AnnouncedFile() {
  const std::filesystem::path path = file_->path();
  file_.reset();
  monitor_.temporary_file_gone(path);
}

void AnnouncedFile::commit_text(std::string_view text) {
  write_bytes(text, *file_);
  file_->commit();
}

void require_other_file(const std::filesystem::path& model, const std::filesystem::path& output) {
  std::error_code none;
  if (std::filesystem::equivalent(model, output, none)) {
    throw UsageError(fmt::format("{}: the output is the model itself", output.string()),
                     "give another name; the model is never overwritten");
  }
}

}  // namespace aerate
