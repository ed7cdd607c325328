#include "studio/private_folder.h"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace aerate::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "aerate-studio-";

FailureError cannot(const char* what, const fs::path& path) {
  return FailureError(
      fmt::format("{}: it cannot be {}: {}", path.string(), what, std::generic_category().message(errno)),
      "TMPDIR names the folder for temporary files");
}

// Folders of this kind that nobody holds.
void remove_left_over(const fs::path& parent) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, error)) {
    if (!entry.path().filename().string().starts_with(kPrefix)) continue;
    struct stat found {};
    if (::lstat(entry.path().c_str(), &found) != 0 || !S_ISDIR(found.st_mode) || found.st_uid != ::geteuid())
      continue;
    const int folder = ::open(entry.path().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0) continue;
    if (::flock(folder, LOCK_EX | LOCK_NB) == 0) fs::remove_all(entry.path(), error);
    ::close(folder);
  }
}

}  // namespace

PrivateFolder::PrivateFolder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  if (error)
    throw FailureError("there is no folder for temporary files: " + error.message(),
                       "TMPDIR names one that can be written to");
  remove_left_over(parent);
  std::string name = (parent / (std::string(kPrefix) + "XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) throw cannot("made", name);  // with mode 0700
  path_ = name;
  lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    const FailureError failure = cannot("locked", path_);
    fs::remove_all(path_, error);
    throw failure;
  }
}

PrivateFolder::~PrivateFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
  ::close(lock_);
}

NewFolder::NewFolder(fs::path path) : path_(std::move(path)) {
  if (::mkdir(path_.c_str(), S_IRWXU) != 0) throw cannot("made", path_);
}

NewFolder::~NewFolder() {
  std::error_code error;
  if (!kept_) fs::remove_all(path_, error);
}

void write_private_file(const fs::path& path, std::string_view bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) throw cannot("made", path);
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const FailureError failure = cannot("written", path);
      ::close(file);
      throw failure;
    }
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  ::close(file);
}

}  // namespace aerate::studio
