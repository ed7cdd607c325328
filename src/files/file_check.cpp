#include "files/file_check.h"

#include <cerrno>
#include <fmt/format.h>
#include <fstream>
#include <system_error>

#include "core/error.h"

namespace aerate {

void check_readable(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: no such file", name));
  if (std::filesystem::is_directory(status))
    throw InputError(fmt::format("{}: a directory, not a file", name));
  if (!std::filesystem::is_regular_file(status))
    throw InputError(fmt::format("{}: not a regular file", name));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw InputError(fmt::format("{}: {}", name, error.message()));
  if (size == 0) throw InputError(fmt::format("{}: the file is empty", name));
}

FileBytes read_file(const std::filesystem::path& path) {
  check_readable(path);
  const std::string name = path.string();
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: {}", name, std::generic_category().message(errno)));
  FileBytes bytes;
  bytes.size = static_cast<std::size_t>(std::filesystem::file_size(path));
  bytes.data = std::make_unique_for_overwrite<char[]>(bytes.size);
  if (!file.read(bytes.data.get(), static_cast<std::streamsize>(bytes.size))) {
    throw InputError(fmt::format("{}: only {} of {} bytes could be read", name, file.gcount(), bytes.size));
  }
  return bytes;
}

}  // namespace aerate
