#include "printing/slicers/text_file.h"

#include <fstream>
#include <sstream>
#include <utility>

#include "core/error.h"
#include "files/input_file.h"

namespace aerate {

std::string read_text(const std::filesystem::path& path) {
  check_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  // Of an empty file nothing can be taken, which counts as a failure.
  if (stream.peek() != std::ifstream::traits_type::eof()) text << stream.rdbuf();
  if (!stream.is_open() || stream.bad() || text.fail()) throw InputError(path.string() + ": cannot be read");
  return std::move(text).str();
}

}  // namespace aerate
