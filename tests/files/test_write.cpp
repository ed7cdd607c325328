#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <iterator>
#include <sstream>
#include <string>
#include <sys/mount.h>
#include <sys/stat.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include "core/error.h"
#include "files/formats.h"
#include "files/load.h"
#include "files/output_file.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

// An empty folder of its own for every test, removed afterwards.
class WriteTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() /
              ("aerate-" + std::string(info->name()) + "-" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override {
    ::umount(folder_.c_str());  // fails but for the test that mounted something there
    fs::remove_all(folder_);
  }

  std::size_t files_in_folder() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

std::string contents_of(const fs::path& path) {
  std::string bytes(fs::file_size(path), '\0');
  std::ifstream(path, std::ios::binary).read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

template <typename T>
T read_at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

// A wavy sheet with coordinates of many digits and some triangles without area; more than one block.
Mesh make_sheet(std::uint32_t side) {
  Mesh mesh;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
      mesh.positions.push_back({fx / 3, -fy / 7, 1e-6f * fx * fy});
    }
  }
  for (std::uint32_t y = 0; y + 1 < side; ++y) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t corner = y * side + x;
      mesh.triangles.push_back({corner, corner + 1, corner + side + 1});
      mesh.triangles.push_back({corner, corner + side + 1, corner + side});
    }
  }
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 1, 2});
  return mesh;
}

std::string reason_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const FailureError& error) {
    return error.what();
  }
  return "no FailureError";
}

TEST_F(WriteTest, StlHoldsEveryTriangleWithItsUnitNormal) {
  const Mesh mesh = make_sheet(90);
  const fs::path path = folder_ / "sheet.stl";
  write_mesh(mesh, path, MeshFormat::stl);

  const std::string bytes = contents_of(path);
  ASSERT_EQ(bytes.size(), 84 + 50 * mesh.triangles.size());
  EXPECT_NE(bytes.substr(0, 5), "solid");
  ASSERT_EQ(read_at<std::uint32_t>(bytes, 80), mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::size_t record = 84 + 50 * i;
    Vec3d corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = read_at<Vec3f>(bytes, record + 12 * (k + 1));
      ASSERT_EQ(corner, mesh.positions[mesh.triangles[i][k]]) << "triangle " << i;
      corners[k] = to_double(corner);
    }
    const Vec3d normal = to_double(read_at<Vec3f>(bytes, record));
    EXPECT_NEAR(length(normal), 1, 1e-6) << "triangle " << i;
    const Vec3d area = cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (length(area) > 0) {
      EXPECT_NEAR(dot(normal, area) / length(area), 1, 1e-6) << "triangle " << i;
    } else {
      EXPECT_EQ(normal, (Vec3d{0, 0, 1})) << "triangle " << i;
    }
    EXPECT_EQ(read_at<std::uint16_t>(bytes, record + 48), 0);
  }
}

TEST_F(WriteTest, StlNormalsOfVerySmallAndVeryLargeTrianglesAreUnit) {
  for (const float size : {1e-30f, 1e-12f, 1e18f}) {
    const Mesh mesh = test::make_box({0, 0, 0}, {size, size, size});
    const fs::path path = folder_ / "box.stl";
    write_mesh(mesh, path, MeshFormat::stl);
    const std::string bytes = contents_of(path);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Vec3d normal = to_double(read_at<Vec3f>(bytes, 84 + 50 * i));
      EXPECT_EQ(length(normal), 1) << "edge " << size << ", triangle " << i;
    }
  }
}

TEST_F(WriteTest, ObjReadsBackToTheSameFloatsAndIndices) {
  Mesh mesh = make_sheet(100);
  mesh.positions[0] = {1e-40f, 3.4e38f, 0};
  mesh.positions[1] = {0.1f, 16777216.0f, 1.0f / 3.0f};
  const fs::path path = folder_ / "sheet.obj";
  write_mesh(mesh, path, MeshFormat::obj);

  std::ifstream file(path);
  Mesh read;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind, a, b, c;
    words >> kind >> a >> b >> c;
    if (kind == "v") {
      read.positions.push_back({std::strtof(a.c_str(), nullptr), std::strtof(b.c_str(), nullptr),
                                std::strtof(c.c_str(), nullptr)});
    }
    if (kind == "f") {
      read.triangles.push_back({static_cast<std::uint32_t>(std::stoul(a) - 1),
                                static_cast<std::uint32_t>(std::stoul(b) - 1),
                                static_cast<std::uint32_t>(std::stoul(c) - 1)});
    }
  }
  EXPECT_EQ(read.triangles, mesh.triangles);
  EXPECT_EQ(read.positions, mesh.positions);
}

TEST_F(WriteTest, TheLoaderReadsBackWhatWasWritten) {
  // Coordinates of every size and with all their bits in use; every vertex in its own place.
  Mesh mesh;
  std::uint32_t state = 1;
  for (std::uint32_t i = 0; i < 30000; ++i) {
    float coordinates[3];
    for (float& coordinate : coordinates) {
      state = state * 1664525 + 1013904223;
      coordinate = std::ldexp(static_cast<float>(state >> 8) - 8388608.0f, static_cast<int>(i % 16) - 28);
    }
    mesh.positions.push_back({coordinates[0], coordinates[1], coordinates[2]});
    if (i % 3 == 2) mesh.triangles.push_back({i - 2, i - 1, i});
  }
  for (const char* name : {"mesh.stl", "mesh.obj", "mesh.ply"}) {
    const fs::path path = folder_ / name;
    write_mesh(mesh, path, format_to_write(path));
    const Mesh read = load_model(path).mesh;
    EXPECT_EQ(read.positions, mesh.positions) << name;
    EXPECT_EQ(read.triangles, mesh.triangles) << name;
  }
}

TEST_F(WriteTest, PlyReadsBackToTheSameBytes) {
  const Mesh mesh = make_sheet(100);
  const fs::path path = folder_ / "sheet.ply";
  write_mesh(mesh, path, MeshFormat::ply);

  const std::string bytes = contents_of(path);
  const std::string end = "end_header\n";
  const std::size_t vertices = bytes.find(end) + end.size();
  const std::string header = bytes.substr(0, vertices);
  EXPECT_NE(header.find("format binary_little_endian 1.0\n"), std::string::npos);
  EXPECT_NE(header.find("element vertex 10000\n"), std::string::npos);
  EXPECT_NE(header.find("element face " + std::to_string(mesh.triangles.size()) + "\n"), std::string::npos);
  const std::size_t faces = vertices + 12 * mesh.positions.size();
  ASSERT_EQ(bytes.size(), faces + 13 * mesh.triangles.size());
  EXPECT_EQ(std::memcmp(bytes.data() + vertices, mesh.positions.data(), 12 * mesh.positions.size()), 0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    ASSERT_EQ(bytes[faces + 13 * i], 3);
    ASSERT_EQ(read_at<Triangle>(bytes, faces + 13 * i + 1), mesh.triangles[i]);
  }
}

TEST_F(WriteTest, SameBytesForAnyThreadCount) {
  const Mesh mesh = make_sheet(200);
  for (const MeshFormat* const format : {&MeshFormat::stl, &MeshFormat::obj, &MeshFormat::ply}) {
    std::string first;
    for (const std::size_t threads : {1u, 2u, 8u}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      const fs::path path = folder_ / (std::to_string(threads) + format->ending);
      write_mesh(mesh, path, *format);
      const std::string bytes = contents_of(path);
      if (first.empty()) first = bytes;
      EXPECT_EQ(bytes, first) << format->name << " with " << threads << " threads";
    }
  }
}

TEST(FormatToWrite, LooksAtTheEndingInAnyCase) {
  EXPECT_EQ(&format_to_write("a/b.stl"), &MeshFormat::stl);
  EXPECT_EQ(&format_to_write("b.STL"), &MeshFormat::stl);
  EXPECT_EQ(&format_to_write("b.v2.Obj"), &MeshFormat::obj);
  EXPECT_EQ(&format_to_write("b.ply"), &MeshFormat::ply);
  EXPECT_THROW(format_to_write("b.step"), UsageError);
  EXPECT_THROW(format_to_write("stl"), UsageError);
}

TEST_F(WriteTest, CommitReplacesTheTargetAndLeavesNothingElse) {
  const fs::path target = folder_ / "model.stl";
  std::ofstream(target) << "old";
  PendingFile file(target);
  EXPECT_EQ(file.path().parent_path(), folder_);
  EXPECT_EQ(file.path().extension(), ".stl");
  EXPECT_EQ(contents_of(target), "old");
  write_mesh(test::make_box({0, 0, 0}, {1, 1, 1}), file, MeshFormat::stl);
  EXPECT_EQ(contents_of(target), "old");
  file.commit();
  EXPECT_EQ(contents_of(target).size(), 84 + 50 * 12);
  EXPECT_EQ(files_in_folder(), 1);
}

TEST_F(WriteTest, AnExceptionLeavesTheTargetAndTheFolderAsTheyWere) {
  const fs::path target = folder_ / "model.stl";
  std::ofstream(target) << "old";
  try {
    const PendingFile file(target);
    write_mesh(test::make_box({0, 0, 0}, {1, 1, 1}), file, MeshFormat::stl);
    EXPECT_EQ(files_in_folder(), 2);
    throw InterruptedError();
  } catch (const InterruptedError&) {
  }
  EXPECT_EQ(files_in_folder(), 1);
  EXPECT_EQ(contents_of(target), "old");
}

TEST_F(WriteTest, TwoFilesAreCommittedTogetherOrNotAtAll) {
  const fs::path first = folder_ / "a.stl", second = folder_ / "b.stl";
  std::ofstream(first) << "old";
  {
    PendingFile a(first), b(second);
    write_bytes("new a", a);
    fs::remove(b.path());  // lost before it is on disk
    EXPECT_THROW(commit_all(std::array{&a, &b}), FailureError);
  }
  EXPECT_EQ(contents_of(first), "old");
  EXPECT_EQ(files_in_folder(), 1);
  {
    PendingFile a(first), b(second);
    write_bytes("new a", a);
    fs::create_directory(second);  // comes into the way: only renaming fails
    EXPECT_THROW(commit_all(std::array{&a, &b}), FailureError);
  }
  EXPECT_FALSE(fs::exists(first));
  fs::remove(second);
  PendingFile a(first), b(second);
  write_bytes("new a", a);
  write_bytes("new b", b);
  commit_all(std::array{&a, &b});
  EXPECT_EQ(contents_of(first), "new a");
  EXPECT_EQ(contents_of(second), "new b");
  EXPECT_EQ(files_in_folder(), 2);
}

TEST_F(WriteTest, ASymbolicLinkStaysALink) {
  fs::create_directory(folder_ / "elsewhere");
  std::ofstream(folder_ / "elsewhere" / "real.stl") << "old";
  const fs::path link = folder_ / "link.stl";
  fs::create_symlink(folder_ / "elsewhere" / "real.stl", link);
  PendingFile file(link);
  write_mesh(test::make_box({0, 0, 0}, {1, 1, 1}), file, MeshFormat::stl);
  file.commit();
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(fs::file_size(folder_ / "elsewhere" / "real.stl"), 84 + 50 * 12);
}

TEST_F(WriteTest, ALinkToAFileThatIsNotThereYetStaysALink) {
  fs::create_directory(folder_ / "elsewhere");
  const fs::path link = folder_ / "link.stl", second = folder_ / "second.stl";
  fs::create_symlink("elsewhere/new.stl", link);
  fs::create_symlink("link.stl", second);
  PendingFile file(second);
  write_bytes("new", file);
  file.commit();
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_TRUE(fs::is_symlink(second));
  EXPECT_EQ(contents_of(folder_ / "elsewhere" / "new.stl"), "new");
}

TEST_F(WriteTest, FilesOfSeveralNamesAreNotPartedFromThem) {
  std::ofstream(folder_ / "a.stl") << "old";
  fs::create_hard_link(folder_ / "a.stl", folder_ / "b.stl");
  EXPECT_NE(
      reason_of([&] { const PendingFile file(folder_ / "a.stl"); }).find("a.stl: has 2 names (hard links)"),
      std::string::npos);
  EXPECT_EQ(files_in_folder(), 2);
}

TEST_F(WriteTest, AReplacedFileHandsOnItsModeAndOwner) {
  const fs::path target = folder_ / "model.stl";
  std::ofstream(target) << "old";
  ASSERT_EQ(::chmod(target.c_str(), 0640), 0);
  const bool other_owner = ::chown(target.c_str(), 12345, 23456) == 0;  // as root
  {
    PendingFile file(target);
    struct stat pending {};
    ASSERT_EQ(::stat(file.path().c_str(), &pending), 0);
    EXPECT_EQ(pending.st_mode & 0777, 0600u);
    write_bytes("new", file);
    file.commit();
  }
  struct stat facts {};
  ASSERT_EQ(::stat(target.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0640u);
  if (other_owner) {
    EXPECT_EQ(facts.st_uid, 12345u);
    EXPECT_EQ(facts.st_gid, 23456u);
  }
}

TEST_F(WriteTest, TheModeOfANewFileIsByTheUmask) {
  const mode_t before = ::umask(027);
  PendingFile file(folder_ / "new.stl");
  file.commit();
  ::umask(before);
  struct stat facts {};
  ASSERT_EQ(::stat((folder_ / "new.stl").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0640u);
}

TEST_F(WriteTest, ALongNameIsStillWritable) {
  const fs::path target = folder_ / (std::string(250, 'n') + ".stl");
  PendingFile file(target);
  file.commit();
  EXPECT_TRUE(fs::exists(target));
}

TEST_F(WriteTest, TargetsThatAreNoFilesAreRefusedByName) {
  fs::create_directory(folder_ / "sub.stl");
  std::ofstream(folder_ / "file") << "x";
  const auto reason = [&](const fs::path& target) {
    return reason_of([&] { const PendingFile file(target); });
  };
  EXPECT_EQ(reason(folder_ / "sub.stl"),
            (folder_ / "sub.stl").string() + ": is a directory, not a file to write");
  EXPECT_NE(reason("/dev/null").find("/dev/null: is not a regular file"), std::string::npos);
  EXPECT_NE(reason(folder_ / "missing" / "a.stl").find("missing/a.stl: cannot be written: No such file"),
            std::string::npos);
  EXPECT_NE(reason(folder_ / "file" / "a.stl").find("file/a.stl: cannot be written: Not a directory"),
            std::string::npos);
  EXPECT_NE(reason("/proc/a.stl").find("/proc/a.stl: cannot be written: "), std::string::npos);
  EXPECT_EQ(files_in_folder(), 2);
}

TEST_F(WriteTest, AFullDeviceIsReported) {
  // Writing to it fails as on a full disk, without privileges.
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  EXPECT_EQ(reason_of([&] { write_mesh(make_sheet(100), fs::path("/dev/full"), MeshFormat::stl); }),
            "/dev/full: cannot be written: No space left on device");
}

TEST_F(WriteTest, AFullDiskLeavesNothingBehind) {
  if (::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=256k") != 0) {
    GTEST_SKIP() << "cannot mount a tmpfs: " << std::strerror(errno);
  }
  const fs::path target = folder_ / "model.stl";
  for (const MeshFormat* const format : {&MeshFormat::stl, &MeshFormat::obj, &MeshFormat::ply}) {
    EXPECT_EQ(reason_of([&] {
                PendingFile file(target);
                write_mesh(make_sheet(200), file, *format);
                file.commit();
              }),
              target.string() + ": cannot be written: No space left on device");
    EXPECT_EQ(files_in_folder(), 0);
  }
}

}  // namespace
}  // namespace aerate
