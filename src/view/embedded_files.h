#pragma once

#include <span>
#include <string_view>

namespace aerate {

// A file that the build made a unit of C++ of (cmake/embed-files.cmake).
struct EmbeddedFile {
  std::string_view name, bytes;
};
std::span<const EmbeddedFile> embedded_files();

}  // namespace aerate
