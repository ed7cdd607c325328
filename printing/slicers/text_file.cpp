#include "printing/slicers/text_file.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "core/error.h"

namespace aerate {

std::string read_text(const std::filesystem::path& path) {
  constexpr std::size_t kLeastBlock = 4096;
  const auto fail = [&]() -> InputError { return InputError(path.string() + ": cannot be read"); };
  std::ifstream stream(path, std::ios::binary);
  if (!stream.is_open()) throw fail();
  // The size is but a hint: a file that is no plain one says nothing of it.
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::string text;
  std::size_t length = 0;
  for (std::size_t block = error ? kLeastBlock : static_cast<std::size_t>(size) + 1; stream;
       block = std::max(length, kLeastBlock)) {
    text.resize(length + block);
    stream.read(text.data() + length, static_cast<std::streamsize>(block));
    length += static_cast<std::size_t>(stream.gcount());
  }
  if (stream.bad()) throw fail();
  text.resize(length);
  return text;
}

}  // namespace aerate
