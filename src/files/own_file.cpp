#include "files/own_file.h"

#include <fmt/format.h>
#include <utility>

#include "core/error.h"

namespace aerate {

OwnFile::OwnFile(std::filesystem::path path, Monitor& monitor)
    : path_(std::move(path)), monitor_(monitor), stream_(path_, std::ios::binary) {
  monitor_.check_interrupted();
}

void OwnFile::read(char* bytes, std::size_t count) {
  if (!stream_.read(bytes, static_cast<std::streamsize>(count))) fail("it ends too early");
}

std::optional<std::string> OwnFile::next_line() {
  if (++lines_ % kRecordsPerBlock == 0) monitor_.check_interrupted();
  std::string line;
  if (!std::getline(stream_, line)) return std::nullopt;
  return line;
}

void OwnFile::require_room_for(std::size_t bytes) {
  const auto size = std::filesystem::file_size(path_);
  if (size - static_cast<std::size_t>(stream_.tellg()) < bytes) fail("it ends too early");
}

void OwnFile::require_end() {
  if (stream_.peek() != std::ifstream::traits_type::eof()) fail("something follows after its end");
}

void OwnFile::fail(std::string_view why) const {
  throw FailureError(fmt::format("{}: the file on disk is not what was written: {}", path_.string(), why));
}

}  // namespace aerate
