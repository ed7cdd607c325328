#pragma once

#include <filesystem>
#include <string>

namespace aerate {

// All bytes of a file. Throws InputError if it cannot be read.
std::string read_text(const std::filesystem::path& path);

}  // namespace aerate
