#include "files/write.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <system_error>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <unistd.h>

#include "core/error.h"
#include "files/decimal.h"
#include "files/three_mf.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little,
              "binary STL and PLY are written as memory holds them");

constexpr int kTemporaryNameAttempts = 16;
constexpr std::size_t kLongestStem =
    128;  // of a temporary name: a file system allows 255 bytes for all of it
constexpr std::size_t kRecordsPerBlock = 8192;

FailureError cannot_write(const fs::path& path, int error) {
  std::string hint;
  if (error == ENOSPC || error == EDQUOT) hint = "free some space or write to another disk";
  if (error == ENOENT || error == ENOTDIR) hint = "create the folder first";
  return FailureError(path.string() + ": cannot be written: " + std::generic_category().message(error), hint);
}

// A file descriptor opened for writing. Errors name `shown`.
class OutputFile {
 public:
  OutputFile(const fs::path& path, fs::path shown, int flags) : shown_(std::move(shown)) {
    descriptor_ = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throw cannot_write(shown_, errno);
  }
  ~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0) {
        if (errno == EINTR) continue;
        throw cannot_write(shown_, errno);
      }
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void flush_to_disk() {
    if (::fsync(descriptor_) != 0) throw cannot_write(shown_, errno);
  }

  // Network file systems report some write errors only here.
  void close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (::close(descriptor) != 0 && errno != EINTR) throw cannot_write(shown_, errno);
  }

 private:
  fs::path shown_;
  int descriptor_ = -1;
};

// Formats `count` records in blocks on all threads and writes the blocks in order.
// format(i, out) appends record i to the string `out`.
template <typename Format>
void write_records(OutputFile& file, std::size_t count, std::size_t expected_bytes_each, Format format) {
  // A pipeline that an exception leaves forgets the blocks in flight, so that one which fails to be written
  // ends the input instead.
  std::exception_ptr failure;
  std::atomic<bool> failed = false;
  std::size_t next = 0;
  const auto next_block = [&](tbb::flow_control& control) {
    const std::size_t first = next;
    if (first >= count || failed) control.stop();
    next = first + kRecordsPerBlock;
    return first;
  };
  const auto format_block = [&](std::size_t first) {
    const std::size_t last = std::min(count, first + kRecordsPerBlock);
    std::string block;
    block.reserve((last - first) * expected_bytes_each);
    for (std::size_t i = first; i < last; ++i) format(i, block);
    return block;
  };
  const auto write_block = [&](const std::string& block) {
    if (failed) return;
    try {
      file.write(block);
    } catch (...) {
      failure = std::current_exception();
      failed = true;
    }
  };
  using tbb::filter_mode;
  const auto tokens = 2 * static_cast<std::size_t>(tbb::info::default_concurrency());
  tbb::parallel_pipeline(tokens,
                         tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, next_block) &
                             tbb::make_filter<std::size_t, std::string>(filter_mode::parallel, format_block) &
                             tbb::make_filter<std::string, void>(filter_mode::serial_in_order, write_block));
  if (failure) std::rethrow_exception(failure);
}

template <typename T>
void append_bytes(std::string& out, const T& value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

Vec3f unit_normal(Vec3f a, Vec3f b, Vec3f c) {
  const Vec3d origin = to_double(a);
  const Vec3d normal = cross(to_double(b) - origin, to_double(c) - origin);
  const double norm = length(normal);
  if (!(norm > 0)) return {0, 0, 1};
  return to_float(normal * (1 / norm));
}

void write_stl(const Mesh& mesh, OutputFile& file) {
  constexpr std::size_t kRecordBytes = 50;  // normal, three corners, two bytes that mean nothing
  // A header that begins with "solid" would make readers take the file for ASCII.
  std::array<char, 80> header{};
  constexpr std::string_view kTitle = "binary STL in millimetres, written by aerate";
  std::copy(kTitle.begin(), kTitle.end(), header.begin());
  std::string start(header.data(), header.size());
  append_bytes(start, static_cast<std::uint32_t>(mesh.triangles.size()));
  file.write(start);

  write_records(file, mesh.triangles.size(), kRecordBytes, [&](std::size_t i, std::string& out) {
    const Triangle& t = mesh.triangles[i];
    const Vec3f a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const Vec3f vectors[] = {unit_normal(a, b, c), a, b, c};
    std::array<char, kRecordBytes> record{};
    std::memcpy(record.data(), vectors, sizeof(vectors));
    out.append(record.data(), record.size());
  });
}

void write_obj(const Mesh& mesh, OutputFile& file) {
  file.write("# millimetres, written by aerate\n");
  write_records(file, mesh.positions.size(), 40, [&](std::size_t i, std::string& out) {
    out += 'v';
    for (const float coordinate : {mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z}) {
      out += ' ';
      append_coordinate(out, coordinate);
    }
    out += '\n';
  });
  write_records(file, mesh.triangles.size(), 28, [&](std::size_t i, std::string& out) {
    out += 'f';
    for (const std::uint32_t vertex : mesh.triangles[i]) {
      out += ' ';
      append_index(out, std::uint64_t{vertex} + 1);
    }
    out += '\n';
  });
}

void write_ply(const Mesh& mesh, OutputFile& file) {
  file.write("ply\nformat binary_little_endian 1.0\ncomment millimetres, written by aerate\nelement vertex " +
             std::to_string(mesh.positions.size()) +
             "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
             std::to_string(mesh.triangles.size()) +
             "\nproperty list uchar int vertex_indices\nend_header\n");
  write_records(file, mesh.positions.size(), sizeof(Vec3f),
                [&](std::size_t i, std::string& out) { append_bytes(out, mesh.positions[i]); });
  write_records(file, mesh.triangles.size(), 1 + sizeof(Triangle), [&](std::size_t i, std::string& out) {
    out += '\3';
    append_bytes(out, mesh.triangles[i]);
  });
}

void write_mesh(const Mesh& mesh, const fs::path& path, const fs::path& shown, MeshFormat format) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max() ||
      mesh.positions.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw FailureError(shown.string() + ": " + std::to_string(mesh.triangles.size()) +
                           " triangles are more than the format can count",
                       "raise --tolerance");
  }
  OutputFile file(path, shown, O_WRONLY | O_CREAT | O_TRUNC);
  switch (format) {
    case MeshFormat::stl:
      write_stl(mesh, file);
      break;
    case MeshFormat::obj:
      write_obj(mesh, file);
      break;
    case MeshFormat::ply:
      write_ply(mesh, file);
      break;
    case MeshFormat::three_mf:
      file.write(to_3mf(mesh));
      break;
  }
  file.close();
}

// Throws unless a file may be renamed onto `target`.
void check_replaceable(const fs::path& target) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (!target.has_filename() || fs::is_directory(status)) {
    throw FailureError(target.string() + ": is a directory, not a file to write", "name a file in it");
  }
  if (!fs::exists(status)) return;
  // A rename would replace a device such as /dev/null itself.
  if (!fs::is_regular_file(status)) throw FailureError(target.string() + ": is not a regular file");
  if (::access(target.c_str(), W_OK) != 0) throw cannot_write(target, errno);
}

void write_bytes(std::string_view bytes, const fs::path& path, const fs::path& shown) {
  OutputFile output(path, shown, O_WRONLY | O_CREAT | O_TRUNC);
  output.write(bytes);
  output.close();
}

}  // namespace

MeshFormat mesh_format_of(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".stl") return MeshFormat::stl;
  if (ending == ".obj") return MeshFormat::obj;
  if (ending == ".ply") return MeshFormat::ply;
  if (ending == ".3mf") return MeshFormat::three_mf;
  throw UsageError(path.string() + ": cannot write " + (ending.empty() ? "a file without an ending" : ending),
                   "use a name that ends in .stl, .3mf, .obj or .ply");
}

PendingFile::PendingFile(fs::path target) : target_(std::move(target)) {
  std::error_code error;
  if (fs::is_symlink(fs::symlink_status(target_, error))) {
    const fs::path resolved = fs::weakly_canonical(target_, error);
    if (!error) target_ = resolved;
  }
  check_replaceable(target_);

  std::random_device random;
  int reason = EEXIST;
  for (int attempt = 0; attempt < kTemporaryNameAttempts && reason == EEXIST; ++attempt) {
    std::array<char, 16> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), random(), 36).ptr;
    std::string name = ".";
    name.append(target_.stem().string(), 0, kLongestStem).append(".aerate-");
    name.append(std::to_string(::getpid())).append("-").append(digits.data(), end);
    path_ = target_.parent_path() / name.append(target_.extension().string());
    const int descriptor = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      ::close(descriptor);
      return;
    }
    reason = errno;
  }
  throw cannot_write(target_, reason);
}

PendingFile::~PendingFile() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void PendingFile::commit() {
  OutputFile file(path_, target_, O_WRONLY);
  file.flush_to_disk();
  file.close();
  if (::rename(path_.c_str(), target_.c_str()) != 0) throw cannot_write(target_, errno);
  committed_ = true;

  // The new name is on disk only when the folder is. Not every file system can do that, and the file is in
  // place whether or not.
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

void write_mesh(const Mesh& mesh, const fs::path& path, MeshFormat format) {
  write_mesh(mesh, path, path, format);
}

void write_mesh(const Mesh& mesh, const PendingFile& file, MeshFormat format) {
  write_mesh(mesh, file.path(), file.target(), format);
}

void write_bytes(std::string_view bytes, const fs::path& path) {
  write_bytes(bytes, path, path);
}

void write_bytes(std::string_view bytes, const PendingFile& file) {
  write_bytes(bytes, file.path(), file.target());
}

}  // namespace aerate
