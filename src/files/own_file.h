#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/monitor.h"
#include "files/raw_bytes.h"
#include "files/weld.h"

namespace aerate {

// A file that one of our writers wrote, from its front to its end, a block at a time. What is not as it was
// written is a FailureError. The monitor may interrupt between blocks.
class OwnFile {
 public:
  OwnFile(std::filesystem::path path, Monitor& monitor);

  const std::filesystem::path& path() const { return path_; }

  void read(char* bytes, std::size_t count);
  std::optional<std::string> next_line();
  void require_room_for(std::size_t bytes);  // before memory is taken by a count that the file gives
  void require_end();

  // Calls f(bytes of a record) for each of `count` records.
  template <std::size_t kRecordBytes, typename F>
  void for_each_record(std::size_t count, const F& f) {
    std::vector<char> block(std::min(count, kRecordsPerBlock) * kRecordBytes);
    for (std::size_t first = 0; first < count; first += kRecordsPerBlock) {
      monitor_.check_interrupted();
      const std::size_t records = std::min(kRecordsPerBlock, count - first);
      read(block.data(), records * kRecordBytes);
      for (std::size_t i = 0; i < records; ++i) f(block.data() + i * kRecordBytes);
    }
  }

  [[noreturn]] void fail(std::string_view why) const;

 private:
  // Or lines of text, between two questions to the monitor.
  static constexpr std::size_t kRecordsPerBlock = std::size_t{1} << 16;

  std::filesystem::path path_;
  Monitor& monitor_;
  std::ifstream stream_;
  std::size_t lines_ = 0;
};

}  // namespace aerate
