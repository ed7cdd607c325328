#pragma once

#include <cstddef>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace aerate {

// A file in memory. Writable: a check may rewrite text into the plainer form that an importer understands.
struct InputFile {
  std::string name;  // as the user gave it, for messages
  std::unique_ptr<char[]> data;
  std::size_t size = 0;

  std::string_view text() const { return {data.get(), size}; }
};

// Bytes that were made here, under the name of the file that they stand for.
InputFile file_in_memory(std::string name, std::string_view bytes);

// Throws InputError if the file is missing, a directory, or a pipe or a device, which may never end: every
// input of the user's is looked at before it is opened.
void check_regular_file(const std::filesystem::path& path);

// Throws InputError if the file is missing, not a regular file, or empty.
void check_readable(const std::filesystem::path& path);

// Reads a whole file. Throws InputError as above, for more than `most` bytes, or with the system's reason.
InputFile read_file(const std::filesystem::path& path,
                    std::size_t most = std::numeric_limits<std::size_t>::max());

inline constexpr const char* kCopyAgain = "export or copy the file again";

// Throws InputError: the file's name and what is wrong with it.
template <typename... Arguments>
[[noreturn]] void fail_to_read(const std::string& name, fmt::format_string<Arguments...> what,
                               Arguments&&... arguments) {
  throw InputError(fmt::format("{}: {}", name, fmt::format(what, std::forward<Arguments>(arguments)...)));
}

template <typename... Arguments>
[[noreturn]] void fail_to_read(const InputFile& file, fmt::format_string<Arguments...> what,
                               Arguments&&... arguments) {
  fail_to_read(file.name, what, std::forward<Arguments>(arguments)...);
}

}  // namespace aerate
