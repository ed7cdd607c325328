#include "files/output_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <exception>
#include <fcntl.h>
#include <fmt/format.h>
#include <random>
#include <sys/stat.h>
#include <system_error>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

constexpr int kTemporaryNameAttempts = 16;
constexpr std::size_t kLongestStem =
    128;  // of a temporary name: a file system allows 255 bytes for all of it
constexpr std::size_t kRecordsPerBlock = 8192;

FailureError cannot_write(const fs::path& path, int error) {
  std::string hint;
  if (error == ENOSPC || error == EDQUOT) hint = "free some space or write to another disk";
  if (error == ENOENT || error == ENOTDIR) hint = "create the folder first";
  if (error == EFBIG) hint = "raise the limit of the size of files (ulimit -f)";
  return FailureError(
      fmt::format("{}: cannot be written: {}", path.string(), std::generic_category().message(error)), hint);
}

// Where a chain of symbolic links ends, whether or not there is a file.
fs::path followed(fs::path path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  std::error_code error;
  for (int links = 0; fs::is_symlink(fs::symlink_status(path, error)); ++links) {
    if (links == kMostLinks) throw cannot_write(path, ELOOP);
    const fs::path next = fs::read_symlink(path, error);
    if (error) throw cannot_write(path, error.value());
    path = path.parent_path() / next;  // which is `next` if that is absolute
  }
  return path;
}

// Throws unless a file may be renamed onto `target`.
void check_replaceable(const fs::path& target) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (!target.has_filename() || fs::is_directory(status)) {
    throw FailureError(fmt::format("{}: is a directory, not a file to write", target.string()),
                       "name a file in it");
  }
  if (error && !fs::exists(status) && status.type() != fs::file_type::not_found)
    throw cannot_write(target, error.value());
  if (!fs::exists(status)) return;
  // A rename would replace a device such as /dev/null itself.
  if (!fs::is_regular_file(status))
    throw FailureError(fmt::format("{}: is not a regular file", target.string()));
  if (::access(target.c_str(), W_OK) != 0) throw cannot_write(target, errno);
  const std::uintmax_t names = fs::hard_link_count(target, error);
  if (!error && names > 1) {
    throw FailureError(fmt::format("{}: has {} names (hard links), and the others would keep the old content",
                                   target.string(), names),
                       "remove it first, or give another name");
  }
}

void flush_to_disk(const fs::path& path, const fs::path& target) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  const int failure = descriptor < 0 || ::fsync(descriptor) != 0 ? errno : 0;
  const bool closed = descriptor < 0 || ::close(descriptor) == 0 || errno == EINTR;
  if (failure != 0 || !closed) throw cannot_write(target, failure != 0 ? failure : errno);
}

}  // namespace

PendingFile::PendingFile(fs::path target) : target_(followed(std::move(target))) {
  check_replaceable(target_);
  // What replaces a file may be as secret as that one was.
  std::error_code error;
  create(fs::exists(target_, error) ? 0600 : 0666);
}

void PendingFile::create(unsigned mode) {
  std::random_device random;
  int reason = EEXIST;
  for (int attempt = 0; attempt < kTemporaryNameAttempts && reason == EEXIST; ++attempt) {
    const std::string name =
        fmt::format(".{}.aerate-{}-{:x}{}", target_.stem().string().substr(0, kLongestStem), ::getpid(),
                    random(), target_.extension().string());
    path_ = target_.parent_path() / name;
    const int descriptor = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor >= 0) {
      ::close(descriptor);
      return;
    }
    reason = errno;
  }
  throw cannot_write(target_, reason);
}

PendingFile::~PendingFile() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
}

// Of the file that is replaced. Handing a file to another owner takes privileges, and doing without is no
// failure.
void PendingFile::take_over_attributes() const {
  struct stat replaced {};
  if (::stat(target_.c_str(), &replaced) != 0) return;
  if (::chown(path_.c_str(), replaced.st_uid, replaced.st_gid) != 0)
    static_cast<void>(::chown(path_.c_str(), static_cast<uid_t>(-1), replaced.st_gid) == 0);
  if (::chmod(path_.c_str(), replaced.st_mode & 0777) != 0) throw cannot_write(target_, errno);
}

void PendingFile::prepare() {
  if (prepared_) return;
  flush_to_disk(path_, target_);
  take_over_attributes();
  prepared_ = true;
}

void PendingFile::commit() {
  prepare();
  if (::rename(path_.c_str(), target_.c_str()) != 0) throw cannot_write(target_, errno);
  committed_ = true;

  // The new name is on disk only when the folder is. Not every file system can do that, and the file is in
  // place whether or not.
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

void commit_all(std::span<PendingFile* const> files) {
  for (PendingFile* const file : files) file->prepare();
  std::size_t committed = 0;
  try {
    for (; committed < files.size(); ++committed) files[committed]->commit();
  } catch (...) {
    std::error_code ignored;
    for (PendingFile* const file : files.first(committed)) fs::remove(file->target(), ignored);
    throw;
  }
}

OutputFile::OutputFile(Destination destination)
    : destination_(std::move(destination)),
      descriptor_(::open(destination_.path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw cannot_write(destination_.shown, errno);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

// NOLINTNEXTLINE(readability-make-member-function-const): it changes the file
void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      throw cannot_write(destination_.shown, errno);
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void OutputFile::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR)
    throw cannot_write(destination_.shown, errno);
}

void write_bytes(std::string_view bytes, const Destination& destination) {
  OutputFile file(destination);
  file.write(bytes);
  file.close();
}

void write_blocks(OutputFile& file, std::size_t count,
                  const std::function<std::string(std::size_t first, std::size_t last)>& format) {
  // A pipeline that an exception leaves forgets the blocks in flight, so that one which fails to be written
  // ends the input instead.
  std::exception_ptr failure;
  std::atomic<bool> failed = false;
  std::size_t next = 0;
  const auto next_block = [&](tbb::flow_control& control) {
    const std::size_t first = next;
    if (first >= count || failed) control.stop();
    next = first + kRecordsPerBlock;
    return first;
  };
  const auto format_block = [&](std::size_t first) {
    return format(first, std::min(count, first + kRecordsPerBlock));
  };
  const auto write_block = [&](const std::string& block) {
    if (failed) return;
    try {
      file.write(block);
    } catch (...) {
      failure = std::current_exception();
      failed = true;
    }
  };
  using tbb::filter_mode;
  const auto tokens = 2 * static_cast<std::size_t>(tbb::info::default_concurrency());
  tbb::parallel_pipeline(tokens,
                         tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, next_block) &
                             tbb::make_filter<std::size_t, std::string>(filter_mode::parallel, format_block) &
                             tbb::make_filter<std::string, void>(filter_mode::serial_in_order, write_block));
  if (failure) std::rethrow_exception(failure);
}

}  // namespace aerate
