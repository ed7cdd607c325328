#include "pipeline/announced_file.h"

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

}  // namespace aerate
