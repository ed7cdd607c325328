#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace aerate {

// A file being written beside its target, under a temporary name in the same folder that ends like the
// target's. It becomes the target only by `commit`; otherwise the destructor removes it. A target that is a
// symbolic link is followed, to a file that is yet to be made too. A file that is replaced hands on its mode
// and, where the system allows it, its owner and group; a new one's mode is by the umask. Throws FailureError
// if it cannot be created, or if the target is a directory, has further names (hard links, which would keep
// the old content), or is anything else that a file must not replace.
class PendingFile {
 public:
  explicit PendingFile(std::filesystem::path target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::filesystem::path& path() const { return path_; }      // where to write
  const std::filesystem::path& target() const { return target_; }  // what the user asked for
  void
  prepare();      // flushes to disk: all of `commit` that fails for want of room or rights in the file itself
  void commit();  // prepares unless that was done, and renames onto the target, atomically

 private:
  void create(unsigned mode);
  void take_over_attributes() const;

  std::filesystem::path target_, path_;
  bool prepared_ = false, committed_ = false;
};

// Makes all files their targets, or none: all that can fail but renaming is done before the first takes its place.
// Should renaming a later one fail, those before it are removed again; a file that one of them replaced is then gone.
void commit_all(std::span<PendingFile* const> files);

// Where bytes go, and the name that errors use: of a pending file, its target.
struct Destination {
  Destination(const std::filesystem::path& file) : path(file), shown(file) {}
  Destination(const PendingFile& file) : path(file.path()), shown(file.target()) {}

  std::filesystem::path path, shown;
};

// A file that is emptied and written from its front. Throws FailureError with the system's reason (disk full,
// ...).
class OutputFile {
 public:
  explicit OutputFile(Destination destination);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  void close();  // network file systems report some write errors only here

 private:
  Destination destination_;
  int descriptor_;
};

// Fills a file with bytes that were made elsewhere. Throws as OutputFile does.
void write_bytes(std::string_view bytes, const Destination& destination);

// Makes `count` records in blocks on all threads, format(first, last) each, and writes the blocks in order.
void write_blocks(OutputFile& file, std::size_t count,
                  const std::function<std::string(std::size_t first, std::size_t last)>& format);

// The same where format(i, out) appends record i to the string `out`.
template <typename Format>
void write_records(OutputFile& file, std::size_t count, std::size_t expected_bytes_each,
                   const Format& format) {
  write_blocks(file, count, [&](std::size_t first, std::size_t last) {
    std::string block;
    block.reserve((last - first) * expected_bytes_each);
    for (std::size_t i = first; i < last; ++i) format(i, block);
    return block;
  });
}

}  // namespace aerate
