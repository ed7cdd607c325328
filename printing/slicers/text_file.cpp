#include "printing/slicers/text_file.h"

#include <fstream>
#include <sstream>

#include "core/error.h"

namespace aerate {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  // Copying an empty file sets the failure bit of the stream copied to.
  if (stream && stream.peek() != std::ifstream::traits_type::eof()) text << stream.rdbuf();
  if (!stream.is_open() || stream.bad() || !text) throw InputError(path.string() + ": cannot be read");
  return std::move(text).str();
}

}  // namespace aerate
