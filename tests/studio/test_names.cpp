#include <gtest/gtest.h>
#include <string>

#include "core/error.h"
#include "studio/names.h"
#include "tests/support/caught.h"

namespace aerate::studio {
namespace {

TEST(Names, AreShownWithoutFoldersAndControlCharacters) {
  EXPECT_EQ(shown_name("bunny.stl"), "bunny.stl");
  EXPECT_EQ(shown_name("../../etc/passwd.stl"), "passwd.stl");
  EXPECT_EQ(shown_name("C:\\models\\b.stl"), "b.stl");
  EXPECT_EQ(shown_name(std::string("a\n\x1b\0.stl", 8)), "a___.stl");
  EXPECT_EQ(shown_name("h\xc3\xa4se.stl"), "h\xc3\xa4se.stl");
  EXPECT_EQ(shown_name("h\xe4se.stl"), "h_se.stl");  // no UTF-8
  EXPECT_EQ(shown_name("\xe2\x82"), "__");
}

TEST(Names, KeepTheirEndingWhenTheyAreLong) {
  const std::string name = shown_name(std::string(5000, 'x') + ".3mf");
  EXPECT_LE(name.size(), 124u);
  EXPECT_TRUE(name.ends_with("x.3mf"));
  const std::string wide = shown_name([] {
    std::string text;
    for (int i = 0; i < 200; ++i) text += "\xe2\x82\xac";
    return text + ".stl";
  }());
  EXPECT_TRUE(wide.ends_with("\xe2\x82\xac.stl"));
}

TEST(Names, SayWhichFormat) {
  EXPECT_EQ(ending_of_model("a.b.STL"), ".stl");
  for (const char* name : {"a.exe", "a", "", ".stl.exe"})
    EXPECT_NE(test::message_of<InputError>([&] { static_cast<void>(ending_of_model(name)); }), "") << name;
}

TEST(Names, OfResultsFollowTheModels) {
  EXPECT_EQ(name_of_result("bunny.stl", ".3mf"), "bunny-hollow.3mf");
  EXPECT_EQ(name_of_result("a.b.obj", ".stl"), "a.b-hollow.stl");
  EXPECT_EQ(name_of_result(".stl", ".stl"), "model-hollow.stl");
}

TEST(Names, OfAttachmentsCannotEndTheHeader) {
  const std::string value = attachment_called("a\"\r\nSet-Cookie: x\xc3\xa9.stl");
  EXPECT_EQ(value.find_first_of("\r\n"), std::string::npos);
  EXPECT_EQ(value,
            "attachment; filename=\"a___Set-Cookie__x__.stl\"; "
            "filename*=UTF-8''a%22%0D%0ASet-Cookie%3A%20x%C3%A9.stl");
}

TEST(ShownPaths, ReplacesEveryPlace) {
  ShownPaths shown;
  shown.add("/tmp/x/m1/aerate-model.stl", "bunny.stl");
  EXPECT_EQ(shown.in("/tmp/x/m1/aerate-model.stl: open (aerate-model.stl)"), "bunny.stl: open (bunny.stl)");
}

}  // namespace
}  // namespace aerate::studio
