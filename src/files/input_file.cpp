#include "files/input_file.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

namespace aerate {

void check_regular_file(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (error && error != std::errc::no_such_file_or_directory)
    throw InputError(fmt::format("{}: {}", name, error.message()));
  if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: no such file", name));
  if (std::filesystem::is_directory(status))
    throw InputError(fmt::format("{}: a directory, not a file", name));
  if (!std::filesystem::is_regular_file(status))
    throw InputError(fmt::format("{}: not a regular file", name));
}

void check_readable(const std::filesystem::path& path) {
  check_regular_file(path);
  const std::string name = path.string();
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw InputError(fmt::format("{}: {}", name, error.message()));
  if (size == 0) throw InputError(fmt::format("{}: the file is empty", name));
}

InputFile file_in_memory(std::string name, std::string_view bytes) {
  InputFile file;
  file.name = std::move(name);
  file.data = std::make_unique_for_overwrite<char[]>(bytes.size());
  file.size = bytes.size();
  std::copy(bytes.begin(), bytes.end(), file.data.get());
  return file;
}

InputFile read_file(const std::filesystem::path& path, std::size_t most) {
  check_readable(path);
  InputFile file;
  file.name = path.string();
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail_to_read(file, "{}", std::generic_category().message(errno));
  file.size = static_cast<std::size_t>(std::filesystem::file_size(path));
  if (file.size > most) fail_to_read(file, "more than {} bytes", most);
  file.data = std::make_unique_for_overwrite<char[]>(file.size);
  if (!stream.read(file.data.get(), static_cast<std::streamsize>(file.size)))
    fail_to_read(file, "only {} of {} bytes could be read", stream.gcount(), file.size);
  return file;
}

}  // namespace aerate
