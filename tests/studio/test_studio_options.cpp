#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <vector>

#include "cli/hollow_forms.h"
#include "cli/studio_plan.h"
#include "core/error.h"
#include "tests/support/caught.h"

namespace aerate::cli {
namespace {

using studio::GivenOption;
using studio::OptionKind;
using studio::OptionRow;
using test::contains;
using test::message_of;

class StudioOptions : public testing::Test {
 protected:
  const studio::Lent lent_ = lent_to_studio();

  studio::Plan plan(const std::vector<GivenOption>& options, const std::string& name = "bunny.stl") const {
    return lent_.plan({"/private/m1/model.stl", name, "/private/j1/result", options});
  }
  std::string refusal(const std::vector<GivenOption>& options) const {
    return message_of<UsageError>([&] { static_cast<void>(plan(options)); });
  }
  const OptionRow& row(const std::string& name) const {
    return *std::ranges::find(lent_.options, name, &OptionRow::name);
  }
};

// An option that comes to be has to be looked at: does it name a file?
TEST_F(StudioOptions, AreAllButThoseOfFilesAndOfTheProgram) {
  std::set<std::string> left_out;
  visit_hollow_options([&](const CLI::Option& option) {
    const std::string name = option.get_lnames().empty() ? option.get_name() : option.get_lnames().front();
    if (std::ranges::find(lent_.options, name, &OptionRow::name) == lent_.options.end())
      left_out.insert(name);
  });
  EXPECT_EQ(left_out,
            (std::set<std::string>{"MODEL", "output", "help", "json", "threads", "quiet", "device", "view",
                                   "picture", "picture-cut", "picture-size", "picture-colour", "spheres",
                                   "print-settings", "plugs", "plug-clearance", "plug-taper"}));
  for (const OptionRow& each : lent_.options) EXPECT_FALSE(each.description.empty()) << each.name;
}

TEST_F(StudioOptions, SayTheirKindUnitAndDefault) {
  EXPECT_EQ(row("wall").kind, OptionKind::number);
  EXPECT_EQ(row("wall").unit, "mm");
  EXPECT_EQ(row("wall").default_value, "1.2");
  EXPECT_EQ(row("overhang").unit, "deg");
  EXPECT_EQ(row("as").kind, OptionKind::choice);
  EXPECT_EQ(row("as").choices, (std::vector<std::string>{"voids", "modifiers"}));
  EXPECT_EQ(row("process").choices, (std::vector<std::string>{"fdm", "sla", "sls", "metal"}));
  EXPECT_EQ(row("drain").kind, OptionKind::flag);
  EXPECT_TRUE(row("drain").may_be_off);
  EXPECT_EQ(row("holes-on").kind, OptionKind::list);
  EXPECT_EQ(row("stand").kind, OptionKind::number);
  EXPECT_TRUE(row("stand").may_be_bare);
  EXPECT_EQ(row("scale").kind, OptionKind::text);
}

TEST_F(StudioOptions, NamesOfFilesAreRefused) {
  for (const char* name : {"output", "o", "json", "view", "picture", "spheres", "print-settings", "plugs",
                           "config", "threads", "help", "version", "wall=3 --spheres", "", "--wall"})
    EXPECT_TRUE(contains(refusal({{name, {"/etc/passwd"}}}), "no such option")) << name;
  for (const char* process : {"/etc/passwd", "../x.json", "mine", "x.json", "list"})
    EXPECT_TRUE(contains(refusal({{"process", {process}}}), "unknown process")) << process;
  for (const char* region : {"/etc/passwd", "part.stl", "modifier", ""})
    EXPECT_FALSE(refusal({{"keep-solid", {region}}}).empty()) << region;
  EXPECT_EQ(
      plan({{"keep-solid", {"sphere:0,0,0,5", "box:0,0,0,1,1,1"}}}).forms.front().options.keep_solid.size(),
      2u);
}

TEST_F(StudioOptions, AValueIsNeverAnotherOption) {
  EXPECT_TRUE(contains(refusal({{"wall", {"--spheres"}}}), "--wall"));
  EXPECT_TRUE(contains(refusal({{"material", {"--spheres=/etc/passwd"}}}), "--spheres=/etc/passwd"));
}

TEST_F(StudioOptions, AreRefusedInTheWordsOfTheCommandLine) {
  EXPECT_TRUE(contains(refusal({{"wall", {"-1"}}}), "--wall: "));
  EXPECT_TRUE(contains(refusal({{"process", {"sla"}}, {"wall", {"0.1"}}}), "is less than sla can print"));
  EXPECT_TRUE(contains(refusal({{"as", {"x"}}}), "--as: x not in {voids,modifiers}"));
  EXPECT_TRUE(contains(refusal({{"channel-diameter", {"3"}}}), "add --drain"));
}

TEST_F(StudioOptions, ShapeOfValuesIsChecked) {
  EXPECT_TRUE(contains(refusal({{"wall", {}}}), "needs a value"));
  EXPECT_TRUE(contains(refusal({{"wall", {"1", "2"}}}), "more than once"));
  EXPECT_TRUE(contains(refusal({{"drain", {"1"}}}), "takes no value"));
  EXPECT_TRUE(contains(refusal({{"support-blockers", {}, true}}), "cannot be turned off"));
  EXPECT_NE(plan({{"stand", {}}}).forms.front().options.stand, std::nullopt);
}

TEST_F(StudioOptions, TheCommandDoesTheSame) {
  EXPECT_EQ(plan({{"process", {"sla"}}, {"wall", {"2"}}, {"drain", {}, true}}).command,
            "aerate hollow bunny.stl -o bunny-hollow.stl --process=sla --wall=2 --no-drain");
  EXPECT_EQ(plan({{"as", {"modifiers"}}}).command,
            "aerate hollow bunny.stl -o bunny-hollow.3mf --as=modifiers");
  EXPECT_EQ(plan({}, "-o it's; rm -rf ~.stl").command,
            "aerate hollow './-o it'\\''s; rm -rf ~.stl' -o './-o it'\\''s; rm -rf ~-hollow.stl'");
  EXPECT_EQ(plan({{"material", {"a b"}}, {"density", {"1"}}, {"price", {"2"}}}).command,
            "aerate hollow bunny.stl -o bunny-hollow.stl '--material=a b' --density=1 --price=2");
}

TEST_F(StudioOptions, ResultsGoIntoTheFolderUnderANameOfOurs) {
  EXPECT_EQ(plan({}, "x.stl").forms.front().options.output, "/private/j1/result.stl");
  EXPECT_EQ(plan({{"as", {"modifiers"}}}).forms.front().options.output, "/private/j1/result.3mf");
  EXPECT_EQ(plan({{"as", {"modifiers"}}, {"flavor", {"slic3r"}}}).forms.front().options.output,
            "/private/j1/result.amf");
  EXPECT_EQ(plan({{"support-blockers", {}}}).forms.front().options.output, "/private/j1/result.3mf");
}

}  // namespace
}  // namespace aerate::cli
