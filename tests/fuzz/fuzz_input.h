#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <sys/mman.h>
#include <unistd.h>

#include "core/error.h"

namespace aerate::fuzz {

// Ends the process, which libFuzzer counts as a crash and keeps the input of.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "PROPERTY BROKEN: %s\n", what);
  std::abort();
}

// A message is for people: of a few lines, and nothing in it that a terminal would act upon.
inline void require_readable(const Error& error) {
  constexpr std::size_t kLongest = 4000;
  require(error.what()[0] != '\0', "an error says what is wrong");
  require(std::string_view(error.what()).size() + error.hint().size() < kLongest, "messages are short");
}

// Runs a reader, which may refuse what it gets by an error of the program's own kind and by nothing else.
template <typename Read>
int run(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    require(error.code() == ExitCode::unreadable_input || error.code() == ExitCode::usage,
            "a file that cannot be used is unreadable input or wrong usage");
    require_readable(error);
  }
  return 0;
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// A file in memory with a path, for what reads paths only.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(::memfd_create("fuzz", 0)) {}
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::filesystem::path with(std::string_view bytes) const {
    require(::ftruncate(descriptor_, 0) == 0 &&
                ::pwrite(descriptor_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()),
            "the file in memory takes its bytes");
    return "/proc/self/fd/" + std::to_string(descriptor_);
  }

 private:
  int descriptor_;
};

}  // namespace aerate::fuzz
