#include <cstdint>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/support/files.h"
#include "tests/support/shapes.h"
#include "tests/view/page_reader.h"
#include "view/built_files.h"
#include "view/deflate.h"
#include "view/page.h"

namespace aerate {
namespace {

using Json = nlohmann::json;

// A box of 20 mm with a round void. tests/data/page-data.txt is its data, from which the page's own tests read.
Scene box_with_a_void() {
  const Mesh outside = test::make_box({0, 0, 0}, {20, 20, 20});
  const Mesh inside = test::moved(test::turned_inside_out(test::make_uv_sphere(5, 8, 12)), {10, 10, 8});
  Scene scene;
  scene.title = "box </script> \xc3\xa9.stl";
  scene.is = "hollowed by 1 void";
  scene.mesh = test::join(outside, inside);
  const std::size_t first = outside.triangles.size();
  scene.parts = {{PartKind::outer, 0, first}, {PartKind::void_surface, first, inside.triangles.size()}};
  scene.voids = {{.number = 1, .place = {10, 10, 8}, .radius = 5, .volume = 500.25, .wall = 3}};
  scene.marks = {{MarkKind::thinnest_wall, {10, 10, 3}, "3 mm at void 1", {}}};
  scene.figures = {{"wall", "3 mm at least"}};
  scene.changes = {{"Volume", "mm3", 8000, 7499.75}};
  scene.layer_height = 0.25;
  scene.tolerance = 0.05;
  return scene;
}

struct Unpacked {
  Json header;
  std::string streams;
};

Unpacked unpacked(const std::string& data) {
  const std::string bytes = test::inflated(test::from_base64(data));
  std::uint32_t length = 0;
  for (unsigned i = 0; i < 4; ++i)
    length |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(i))) << 8 * i;
  return {Json::parse(bytes.substr(4, length)), bytes.substr(4 + length)};
}

TEST(Page, DataSaysWhatTheSceneSays) {
  const auto [header, streams] = unpacked(page_data(box_with_a_void(), "aerate 1"));
  EXPECT_EQ(header["title"], "box </script> \xc3\xa9.stl");
  EXPECT_EQ(header["program"], "aerate 1");
  EXPECT_EQ(header["use"], "removed");
  EXPECT_EQ(header["parts"], Json::parse(R"({"kind": [0, 2], "triangles": [12, 168]})"));
  EXPECT_EQ(header["voids"], Json::parse(R"({"number": [1], "place": [10.0, 10.0, 8.0], "radius": [5.0],
                                             "volume": [500.25], "wall": [3.0]})"));
  EXPECT_EQ(header["figures"], Json::parse(R"([["wall", "3 mm at least"]])"));
  EXPECT_EQ(header["changes"][0]["after"], 7499.75);
  EXPECT_EQ(header["marks"][0]["text"], "3 mm at void 1");
  EXPECT_EQ(header["layerHeight"], 0.25);
  EXPECT_TRUE(header["bridge"].is_null());
  std::size_t bytes = 0;
  for (const Json& size : header["streams"]) bytes += size.get<std::size_t>();
  EXPECT_EQ(bytes, streams.size());
}

// The page's own tests read this file (web/tests): who changes the format changes both.
TEST(Page, DataIsWhatThePageIsTestedWith) {
  const auto now = unpacked(page_data(box_with_a_void(), "aerate 1"));
  const auto kept = unpacked(test::read_bytes(AERATE_TEST_DATA "/page-data.txt"));
  EXPECT_EQ(now.header, kept.header);
  EXPECT_EQ(now.streams, kept.streams);
}

TEST(Page, WhatIsNotUtf8IsReplaced) {
  Scene scene = box_with_a_void();
  scene.title = "a\xff.stl";
  EXPECT_EQ(unpacked(page_data(scene, "aerate 1")).header["title"], "a\xef\xbf\xbd.stl");
}

TEST(Page, AWallThatIsNotKnownIsNull) {
  Scene scene = box_with_a_void();
  scene.voids[0].wall.reset();
  EXPECT_TRUE(unpacked(page_data(scene, "aerate 1")).header["voids"]["wall"][0].is_null());
}

TEST(Page, IsOneFileThatAsksForNothing) {
  if (!built_file("view.html")) GTEST_SKIP() << "built without the page: " << why_no_built_file("view.html");
  const Scene scene = box_with_a_void();
  const std::string page = page_of(scene, "aerate 1");
  EXPECT_NE(page.find(page_data(scene, "aerate 1")), std::string::npos);
  EXPECT_EQ(page.find("<!--"), std::string::npos);  // nothing is left open
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_NE(page.find("three.js authors"), std::string::npos);
  EXPECT_LT(page.size(), 900'000U);
}

TEST(Page, SaysWhatTheBuildWasMissing) {
  if (built_file("view.html")) GTEST_SKIP() << "built with the page";
  try {
    require_page();
    FAIL() << "nothing was said";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find(std::string(why_no_built_file("view.html"))), std::string::npos);
  }
}

TEST(Deflate, Base64IsThatOfTheStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Deflate, PacksAndComesBack) {
  const std::string bytes(100'000, 'a');
  EXPECT_LT(deflated(bytes).size(), 1000U);
  EXPECT_EQ(test::inflated(deflated(bytes)), bytes);
  EXPECT_EQ(test::inflated(deflated("")), "");
}

}  // namespace
}  // namespace aerate
