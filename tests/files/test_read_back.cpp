#include <cstring>
#include <gtest/gtest.h>
#include <string>

#include "core/error.h"
#include "files/formats.h"
#include "tests/support/caught.h"
#include "tests/support/files.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

TEST(ReadBack, EveryFormatGivesTheSameBitsAgain) {
  const Mesh mesh = test::make_uv_sphere(1.0 / 3.0, 9, 11);  // coordinates that are no short decimals
  const test::TemporaryFolder folder;
  for (const char* name : {"a.stl", "a.obj", "a.ply", "a.3mf"}) {
    const auto path = folder.path() / name;
    const MeshFormat& format = format_to_write(path);
    write_mesh(mesh, path, format);
    Monitor silent;
    const Mesh again = read_back(path, format, silent);
    ASSERT_EQ(again.triangles.size(), mesh.triangles.size()) << name;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_EQ(again.positions[again.triangles[i][k]], mesh.positions[mesh.triangles[i][k]]) << name;
    }
  }
}

// `change` damages the bytes of a file as it was written.
template <typename F>
void expect_damage_is_seen(const char* name, const F& change, const char* said) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / name;
  write_mesh(test::make_box({0, 0, 0}, {1, 2, 3}), path, format_to_write(path));
  std::string bytes = test::read_bytes(path);
  change(bytes);
  folder.write(name, bytes);
  Monitor silent;
  const std::string message =
      message_of<FailureError>([&] { read_back(path, format_to_write(path), silent); });
  EXPECT_TRUE(contains(message, said)) << name;
}

TEST(ReadBack, DamagedFilesAreNotTakenForWhatWasWritten) {
  const auto shorten = [](std::string& bytes) { bytes.pop_back(); };
  const auto lengthen = [](std::string& bytes) { bytes.push_back('x'); };
  const auto promise_more = [](std::string& bytes) { bytes[83] = 127; };  // two thousand million triangles
  expect_damage_is_seen("a.stl", shorten, "ends too early");
  expect_damage_is_seen("a.stl", lengthen, "something follows");
  expect_damage_is_seen("a.stl", promise_more, "ends too early");
  expect_damage_is_seen(
      "a.stl", [](std::string& bytes) { bytes.resize(40); }, "ends too early");

  const auto replace_in_header = [](const char* old, const char* with) {
    return [old, with](std::string& bytes) { bytes.replace(bytes.find(old), std::strlen(old), with); };
  };
  expect_damage_is_seen("a.ply", shorten, "ends too early");
  expect_damage_is_seen("a.ply", lengthen, "something follows");
  expect_damage_is_seen("a.ply", replace_in_header("face 12", "face 99999999999"), "ends too early");
  expect_damage_is_seen("a.ply", replace_in_header("vertex 8", "vertex many"), "number of its elements");
  expect_damage_is_seen("a.ply", replace_in_header("end_header", "header_end"), "header ends");
  const auto name_absent_vertex = [](std::string& bytes) { bytes.replace(bytes.size() - 4, 4, "\1\1\1\1"); };
  expect_damage_is_seen("a.ply", name_absent_vertex, "no triangle of its vertices");

  for (const char* text : {"v 0 0\n", "v 0 0 0\nf 1 1 2\n", "v 0 0 0\nf 0 1 1\n", "nonsense\n"})
    expect_damage_is_seen(
        "a.obj", [text](std::string& bytes) { bytes = text; }, "line");
}

TEST(ReadBack, StopsWhenAskedTo) {
  class Stopping final : public Monitor {
   public:
    void check_interrupted() override { throw InterruptedError(); }
  } stopping;
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "a.stl";
  write_mesh(test::make_box({0, 0, 0}, {1, 2, 3}), path, MeshFormat::stl);
  EXPECT_THROW(read_back(path, MeshFormat::stl, stopping), InterruptedError);
}

}  // namespace
}  // namespace aerate
