#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace aerate::batch {

// SHA-256 as 64 hexadecimal digits.
std::string digest_of(std::string_view bytes);

// Of a file's bytes. Throws InputError if it cannot be read to its end.
std::string digest_of_file(const std::filesystem::path& path);

}  // namespace aerate::batch
