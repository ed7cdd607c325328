#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/job.h"
#include "tests/support/caught.h"
#include "tests/support/counterweight.h"

// --infill and what describes the print: whether voids pay, and what is refused; and how the result stands.
namespace aerate::test {
namespace {

using Json = nlohmann::json;

constexpr int kUsage = 2;
constexpr int kNothing = 5;

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

ProcessResult hollow(const Job& job, const Mesh& model, const std::vector<std::string>& arguments) {
  return run(job.hollow(job.input("model.stl", model), arguments));
}

Json report_of(const Job& job, const Mesh& model, const std::vector<std::string>& arguments) {
  const ProcessResult result = hollow(job, model, with(arguments, {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

void expect_refused(const Job& job, const Mesh& model, const std::vector<std::string>& arguments,
                    int exit_code, const std::vector<std::string>& said) {
  const ProcessResult result = hollow(job, model, arguments);
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  for (const std::string& part : said) EXPECT_TRUE(contains(result.err, part));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
}

void expect_refused(const Job& job, const std::vector<std::string>& arguments, int exit_code,
                    const std::vector<std::string>& said) {
  expect_refused(job, block(), arguments, exit_code, said);
}

// By what the whole print takes, where there is room for voids that may save among others.
TEST(PrintOptions, SparsePrintsThatWouldBecomeHeavierAreRefusedWithFigures) {
  const Job job;
  expect_refused(job, {"--infill", "15%"}, kNothing,
                 {"would become heavier", "cm3 of filament (+", "15 % infill", "these voids save above",
                  "modifier", "--force"});
  expect_refused(job, {"--infill", "20%", "--shape", "spheres"}, kNothing,
                 {"would become heavier", "20 % infill", "these voids save above", "modifier", "--force"});
  const ProcessResult refused = hollow(job, block(), {"--infill", "20%", "--shape", "spheres"});
  EXPECT_FALSE(contains(refused.err, "are made")) << refused.err;
}

TEST(PrintOptions, TheVersionOfTheSlicerChangesThePrediction) {
  const Job job;
  const auto report = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--infill", "60%", "--shape", "spheres", "--force"});
    return report_of(job, block(), more);
  };
  const Json older = report({}), named = report({"--slicer-version", "2.5.2"}),
             newer = report({"--slicer-version", "2.9"});
  EXPECT_EQ(older["print"]["filament_after_mm3"], named["print"]["filament_after_mm3"]);
  EXPECT_LT(newer["print"]["filament_after_mm3"], older["print"]["filament_after_mm3"]);
  EXPECT_EQ(newer["print"]["origins"]["slicer_version"]["origin"], "command line");
  EXPECT_FALSE(older["print"]["origins"].contains("slicer_version"));
  const Job other;
  expect_refused(other, {"--slicer-version", "new"}, kUsage, {"'new' is not a version such as 2.9"});
}

TEST(PrintOptions, SparsePrintsWhereNoVoidPaysAreRefusedWithFigures) {
  const Job job;
  const auto cube = [](float edge) { return make_box({0, 0, 0}, {edge, edge, edge}); };
  expect_refused(job, cube(7), {"--infill", "30%", "--shape", "spheres"}, kNothing,
                 {"30 % infill", "above a radius of 8.8", "the largest that fits has radius 2.3 mm",
                  "voids of 2.3 mm save above", "modifier", "--force"});
  expect_refused(job, {"--infill", "15%", "--max-radius", "3.5"}, kNothing,
                 {"15 % infill", "above a radius of 18", "3.5 mm (--max-radius)",
                  "voids of 3.5 mm save above", "modifier", "--force"});
  expect_refused(job, {"--infill", "0%"}, kNothing,
                 {"0 % infill", "however large it is", "where they fit", "modifier", "--force"});
}

// Walls and skins of a void near the model's own are partly printed anyway, the more so where lines are wide.
TEST(PrintOptions, SmallerVoidsAreMadeWhereThePredictedPrintBecomesLighter) {
  const Job job;
  // PrusaSlicer: 6.74 -> 6.00 cm3, -11.0 %.
  const ProcessResult result = run(job.hollow(
      sample("pawn.obj"), {"--scale", "0.8", "--infill", "40%", "--layer-height", "0.3", "--line-width",
                           "0.65", "--wall", "1.2", "--gap", "0.9", "--shape", "spheres", "--json", "-"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json report = Json::parse(result.out);
  const Json& print = report["print"];
  EXPECT_NEAR(print["filament_change_percent"].get<double>(), -11, 2);
  EXPECT_LT(report["voids"]["max_radius_mm"], print["break_even_radius_mm"]);
  EXPECT_TRUE(contains(report["process"].dump(), "0.7 of break-even at 40 % infill"));
  EXPECT_TRUE(contains(report["notices"].dump(), "which gave nothing here"));
}

// Infill of modifiers joins its lines along every small border.
TEST(PrintOptions, ModifiersThatMakeAPrintHeavierAreRefused) {
  const Job job;
  const auto modifiers = [&](const std::vector<std::string>& options) {
    return run(with({AERATE_EXECUTABLE, "hollow", job.input("model.stl", make_box({0, 0, 0}, {20, 20, 20})),
                     "-o", job.output("out.3mf"), "--as", "modifiers", "--json", "-"},
                    options));
  };
  const std::vector<std::string> bad{"--shape",      "spheres", "--min-radius",      "0.62",
                                     "--max-radius", "2",       "--modifier-infill", "5"};
  const ProcessResult refused = modifiers(with(bad, {"--infill", "15%"}));
  EXPECT_EQ(refused.exit_code, kNothing);
  EXPECT_TRUE(contains(refused.err, "would become heavier"));
  EXPECT_TRUE(contains(refused.err, "a lower --modifier-infill"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});

  const ProcessResult forced = modifiers(with(bad, {"--infill", "15%", "--force"}));
  ASSERT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_GT(Json::parse(forced.out)["print"]["filament_change_percent"].get<double>(), 3);

  // Without a description 15 % is assumed, and that it may cost is said.
  const Json assumed = Json::parse(modifiers(bad).out);
  EXPECT_FALSE(assumed["print"]["described"].get<bool>());
  EXPECT_EQ(assumed["print"]["infill_percent"], 15.0);
  EXPECT_TRUE(contains(assumed["notices"].dump(), "becomes heavier"));

  const Json cells = Json::parse(modifiers({"--infill", "15%"}).out);
  EXPECT_LT(cells["print"]["filament_change_percent"].get<double>(), -15);
  EXPECT_TRUE(cells["print"]["break_even_radius_mm"].is_null());
}

TEST(PrintOptions, ModifiersTooSmallToMatterAreNotMade) {
  const Job job;
  const auto modifiers = [&](const std::vector<std::string>& options) {
    const ProcessResult result =
        run(with({AERATE_EXECUTABLE, "hollow", job.input("model.stl", make_box({0, 0, 0}, {20, 16, 30})),
                  "-o", job.output("out.3mf"), "--as", "modifiers", "--shape", "spheres", "--json", "-"},
                 options));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  };
  const Json few = modifiers({}), all = modifiers({"--min-radius", "0.62"});
  EXPECT_LT(few["voids"]["count"].get<int>(), all["voids"]["count"].get<int>() / 2);
  EXPECT_TRUE(contains(few["notices"].dump(), "smaller ones would save less than 0.5 %"));
  EXPECT_EQ(all["notices"], Json::array());
  EXPECT_LT(few["print"]["filament_after_mm3"].get<double>(),
            1.0051 * all["print"]["filament_after_mm3"].get<double>());
}

// Nothing, or less than nothing, would be saved.
TEST(PrintOptions, ModifiersWithoutLessInfillAreRefused) {
  const Job job;
  const auto model = job.input("model.stl", make_box({0, 0, 0}, {20, 20, 20}));
  const auto modifiers = [&](const std::vector<std::string>& options) {
    return run(with(
        {AERATE_EXECUTABLE, "hollow", model, "-o", job.output("out.3mf"), "--as", "modifiers", "--json", "-"},
        options));
  };
  struct Case {
    std::vector<std::string> options;
    std::string said;
  };
  for (const Case& each :
       {Case{{"--infill", "0"}, "a print of 0 % infill has none that modifiers could lower"},
        Case{{"--infill", "0", "--modifier-infill", "10"}, "a print of 0 % infill has none"},
        Case{{"--infill", "15%", "--modifier-infill", "15"}, "modifiers of 15 % infill in a print of 15 %"},
        Case{{"--infill", "15%", "--modifier-infill", "40"}, "give a --modifier-infill below 15"},
        Case{{"--modifier-infill", "100"}, "modifiers of 100 % infill in a print of 100 % at most"}}) {
    const ProcessResult refused = modifiers(each.options);
    EXPECT_EQ(refused.exit_code, kNothing) << each.said;
    EXPECT_TRUE(contains(refused.err, "nothing would be saved: ")) << refused.err;
    EXPECT_TRUE(contains(refused.err, each.said)) << refused.err;
    EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{});
  }
  EXPECT_EQ(modifiers({"--infill", "15%", "--modifier-infill", "40", "--force"}).exit_code, 0);
  // That of the print is not known.
  const ProcessResult assumed = modifiers({"--modifier-infill", "40"});
  EXPECT_EQ(assumed.exit_code, 0);
  EXPECT_TRUE(contains(assumed.err, "at 15 % infill, which is assumed")) << assumed.err;
}

TEST(PrintOptions, OptionsOfModifiersAreRefusedForVoids) {
  const Job job;
  expect_refused(job, {"--flavor", "orca"}, kUsage,
                 {"--flavor without --as modifiers or --support-blockers has no effect"});
  expect_refused(job, {"--as", "voids", "--modifier-infill", "5"}, kUsage,
                 {"--modifier-infill without --as modifiers has no effect"});
  const ProcessResult sliced =
      run({AERATE_EXECUTABLE, "slice", job.input("model.stl", block()), "-o", job.output("out.gcode"),
           "--slicer", "prusa-slicer", "--as", "voids", "--modifier-infill", "5"});
  EXPECT_EQ(sliced.exit_code, kUsage);
  EXPECT_TRUE(contains(sliced.err, "--modifier-infill with --as voids has no effect")) << sliced.err;
  // A configuration file may hold them for other runs.
  const auto config = job.input("aerate.toml", "[hollow]\nflavor = \"orca\"\nmodifier-infill = 5\n");
  EXPECT_EQ(run({AERATE_EXECUTABLE, "--config", config, "hollow", job.input("model.stl", block()), "-o",
                 job.output(), "--max-voids", "1"})
                .exit_code,
            0);
}

TEST(PrintOptions, HintsForModifiersThatAreCellsDoNotProposeCells) {
  const Job job;
  const auto refused = [&](const char* shape) {
    return run({AERATE_EXECUTABLE, "hollow", job.input("model.stl", block()), "-o", job.output("out.3mf"),
                "--as", "modifiers", "--infill", "15%", "--modifier-infill", "14", "--max-radius", "3",
                "--shape", shape});
  };
  const ProcessResult cells = refused("cells"), spheres = refused("spheres");
  for (const ProcessResult& each : {cells, spheres}) {
    EXPECT_EQ(each.exit_code, kNothing);
    EXPECT_TRUE(contains(each.err, "would become heavier")) << each.err;
  }
  EXPECT_FALSE(contains(cells.err, "--shape cells")) << cells.err;
  EXPECT_TRUE(contains(cells.err, "larger ones (--cell-size)")) << cells.err;
  EXPECT_TRUE(contains(spheres.err, "--shape cells")) << spheres.err;
}

// Closer to no change than the prediction is to the slicer.
TEST(PrintOptions, APrintThatMayBecomeHeavierIsSaidSo) {
  const Job job;
  const Json close = report_of(job, block(), {"--infill", "27", "--shape", "spheres"});
  EXPECT_LT(close["print"]["filament_change_percent"].get<double>(), 0);
  EXPECT_GT(close["print"]["filament_change_percent"].get<double>(), -1.5);
  EXPECT_TRUE(contains(close["notices"].dump(), "may become heavier"));
  const Json clear = report_of(job, block(), {"--infill", "50"});
  EXPECT_FALSE(contains(clear["notices"].dump(), "may become heavier"));
}

TEST(PrintOptions, VoidsThatCostMoreThanTheySaveAreNotMade) {
  const Job job;
  const std::vector<std::string> limits{"--max-radius", "12", "--shape", "spheres"};
  const Json report = report_of(job, block(), with(limits, {"--infill", "50"}));
  const double least = report["limits"]["min_radius_mm"].get<double>();
  EXPECT_NEAR(least, report["print"]["break_even_radius_mm"].get<double>(), 0.01);
  EXPECT_GT(least, 3);
  EXPECT_GT(report["voids"]["min_radius_mm"].get<double>(), least - 0.1);
  EXPECT_LT(report["print"]["filament_change_percent"].get<double>(), 0);
  EXPECT_TRUE(contains(report["notices"].dump(), "smaller ones are not made"));
  EXPECT_TRUE(contains(report["process"].dump(), "break-even at 50 % infill"));
  // Small voids besides would have cost more.
  const Json with_small = report_of(job, block(), with(limits, {"--infill", "50", "--force"}));
  EXPECT_GT(with_small["print"]["filament_after_mm3"], report["print"]["filament_after_mm3"]);
  EXPECT_GT(with_small["voids"]["count"], report["voids"]["count"]);
}

TEST(PrintOptions, AHeavierPrintIsWrittenOnlyByForceAndSaysSo) {
  const Job job;
  const auto spheres = job.input("spheres.csv", "x,y,z,radius,kind\n15,15,15,3,adaptive\n");
  const std::vector<std::string> given{"--spheres", spheres, "--infill", "20%"};
  expect_refused(job, given, kNothing,
                 {"heavier", "cm3 of filament (+", "these voids save above", "--force"});
  const Json report = report_of(job, block(), with(given, {"--force"}));
  EXPECT_GT(report["print"]["filament_change_percent"].get<double>(), 0);
  EXPECT_TRUE(contains(report["notices"].dump(), "becomes heavier"));
  EXPECT_EQ(entries_of(job.outputs()), std::vector<std::string>{"out.stl"});
}

TEST(PrintOptions, WithoutInfillTheReportNamesTheInfillAboveWhichTheseVoidsSave) {
  const Job job;
  const Json report = report_of(job, block(), {});
  EXPECT_FALSE(report["print"]["described"].get<bool>());
  const double infill = report["print"]["break_even_infill_percent"].get<double>();
  EXPECT_GT(infill, 30);
  EXPECT_LT(infill, 65);
  EXPECT_EQ(report["material"]["assumes"], "solid material (100 % infill)");
  const ProcessResult text = hollow(job, block(), {});
  EXPECT_TRUE(contains(text.out, "as solid material (100 % infill)"));
  EXPECT_TRUE(contains(text.out, "these voids save filament above"));
}

// The first line says what a usual print becomes, on standard error too where that is heavier.
TEST(PrintOptions, TheVerdictComesFirst) {
  const Job job;
  const ProcessResult text = hollow(job, block(), {});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_TRUE(text.out.starts_with("verdict     at 15 % infill this print takes ")) << text.out;
  EXPECT_TRUE(contains(text.out, " % more filament; it saves from "));
  EXPECT_TRUE(contains(text.out, "; solid: -"));
  EXPECT_TRUE(contains(text.out, "for sparse prints: "));
  EXPECT_TRUE(contains(text.out, "PLA, if printed solid: "));
  EXPECT_TRUE(contains(text.err, "at 15 % infill this print takes "));
  EXPECT_TRUE(contains(text.err, "lightning infill"));

  const Json report = report_of(job, block(), {});
  const Json& verdict = report["print"]["verdict"];
  EXPECT_EQ(verdict["infill_percent"], 15.0);
  EXPECT_TRUE(verdict["infill_is_assumed"].get<bool>());
  EXPECT_GT(verdict["filament_change_percent"].get<double>(), 10);
  EXPECT_NEAR(verdict["solid_change_percent"].get<double>(),
              report["print"]["filament_change_percent"].get<double>(), 1e-9);
  EXPECT_TRUE(contains(report["notices"].dump(), verdict["text"].get<std::string>()));
  // The same as where the infill is said.
  const Json forced = report_of(job, block(), {"--infill", "15", "--force", "--shape", "spheres"});
  EXPECT_NEAR(forced["print"]["filament_change_percent"].get<double>(),
              verdict["filament_change_percent"].get<double>(), 1e-9);
  EXPECT_FALSE(forced["print"]["verdict"]["infill_is_assumed"].get<bool>());
}

// What the same voids take as modifiers is what they take when they are written as such.
TEST(PrintOptions, TheVerdictOfModifiersIsThatOfTheSameVoids) {
  const Job job;
  const std::vector<std::string> voids{"--shape", "spheres",      "--wall", "1.2",      "--max-radius",
                                       "8",       "--min-radius", "3",      "--infill", "15"};
  const Json as_voids = report_of(job, block(), with(voids, {"--force"}));
  const double predicted = as_voids["print"]["verdict"]["as_modifiers_change_percent"].get<double>();
  EXPECT_LT(predicted, -2);
  const ProcessResult written = run(with({AERATE_EXECUTABLE, "hollow", job.input("model.stl", block()), "-o",
                                          job.output("out.3mf"), "--as", "modifiers", "--json", "-"},
                                         voids));
  ASSERT_EQ(written.exit_code, 0) << written.err;
  const Json print = Json::parse(written.out)["print"];
  EXPECT_NEAR(print["filament_change_percent"].get<double>(), predicted, 0.01);
  EXPECT_TRUE(contains(print["verdict"]["text"], "lightning infill, where it has one, may save more"));
  EXPECT_TRUE(print["verdict"]["as_modifiers_change_percent"].is_null());
}

TEST(PrintOptions, TheVerdictIsForTheInfillThatIsSaid) {
  const Job job;
  const ProcessResult dense = hollow(job, block(), {"--infill", "60"});
  ASSERT_EQ(dense.exit_code, 0) << dense.err;
  EXPECT_TRUE(dense.out.starts_with("verdict     at 60 % infill this print takes ")) << dense.out;
  EXPECT_TRUE(contains(dense.out, " % less filament; solid: -"));
  EXPECT_FALSE(contains(dense.err, "more filament"));
  const ProcessResult resin = hollow(job, make_box({0, 0, 0}, {40, 40, 40}), {"--process", "sls"});
  EXPECT_TRUE(resin.out.starts_with("model ")) << resin.out;
}

TEST(PrintOptions, ASlicersFileDescribesThePrint) {
  const Job job;
  const std::string settings =
      job.input("my.ini",
                "# generated by PrusaSlicer 2.5.0 on 2026-01-02 at 03:04:05 UTC\nfill_density = 60%\n"
                "perimeters = 3\nextrusion_width = 0.5\nlayer_height = 0.25\nnozzle_diameter = 0.4\n")
          .string();
  const Json report = report_of(job, block(), {"--print-settings", settings, "--perimeters", "1"});
  const Json& print = report["print"];
  EXPECT_TRUE(print["described"].get<bool>());
  EXPECT_EQ(print["infill_percent"], 60.0);
  EXPECT_EQ(print["perimeters"], 1);
  EXPECT_EQ(print["line_width_mm"], 0.5);
  EXPECT_EQ(print["layer_height_mm"], 0.25);
  EXPECT_EQ(print["origins"]["infill"]["origin"], "my.ini");
  EXPECT_EQ(print["origins"]["infill"]["key"], "fill_density");
  EXPECT_EQ(print["origins"]["perimeters"]["origin"], "command line");
  EXPECT_EQ(print["origins"]["top_layers"]["origin"], "default");
  const ProcessResult text = hollow(job, block(), {"--print-settings", settings, "--perimeters", "1"});
  EXPECT_TRUE(contains(text.out, "infill 60 %, lines of 0.5 mm, layers of 0.25 mm (my.ini)"));
  EXPECT_TRUE(contains(text.out, "1 perimeter (command line)"));
  // The same by options.
  const Json by_options = report_of(
      job, block(), {"--infill", "60", "--perimeters", "1", "--line-width", "0.5", "--layer-height", "0.25"});
  EXPECT_EQ(by_options["print"]["filament_after_mm3"], print["filament_after_mm3"]);

  std::filesystem::remove(job.output());
  const ProcessResult misspelt =
      hollow(job, block(), {"--print-settings", job.input("bad.ini", "fill_densty = 15%\n").string()});
  EXPECT_EQ(misspelt.exit_code, 3);
  EXPECT_TRUE(contains(misspelt.err, "is fill_density meant?")) << misspelt.err;
  expect_refused(job, {"--print-settings", settings, "--process", "sla"}, kUsage,
                 {"--print-settings", "--process sla"});
  expect_refused(job, {"--print-settings", settings, "--json", settings}, kUsage,
                 {"would replace the file of print settings"});
}

TEST(PrintOptions, WallAndGapFollowAWidthThatIsGiven) {
  const Job job;
  const auto limits_with = [&](const std::vector<std::string>& options) {
    return report_of(job, block(), with(options, {"--max-voids", "4"}))["limits"];
  };
  EXPECT_EQ(limits_with({})["wall_mm"], 1.2);
  const Json wide = limits_with({"--line-width", "0.6"});
  EXPECT_NEAR(wide["wall_mm"].get<double>(), 1.8, 1e-12);
  EXPECT_NEAR(wide["gap_mm"].get<double>(), 1.2, 1e-12);
  const Json given = limits_with({"--line-width", "0.6", "--wall", "1", "--gap", "0.7"});
  EXPECT_EQ(given["wall_mm"], 1.0);
  EXPECT_EQ(given["gap_mm"], 0.7);
  const Json own = limits_with(
      {"--line-width", "0.6", "--process", job.input("own.json", R"({"base": "fdm", "wall": 2})").string()});
  EXPECT_EQ(own["wall_mm"], 2.0);
  EXPECT_EQ(own["gap_mm"], 0.9);
}

TEST(PrintOptions, FiguresForMaterialAreThoseOfThePrint) {
  const Job job;
  const Json report = report_of(
      job, block(),
      {"--max-radius", "12", "--infill", "60%", "--perimeters", "3", "--line-width", "0.5", "--layer-height",
       "0.25", "--top-layers", "3", "--bottom-layers", "2", "--infill-pattern", "lines"});
  EXPECT_EQ(report["print"]["perimeters"], 3);
  EXPECT_EQ(report["print"]["infill_pattern"], "lines");
  EXPECT_NEAR(report["material"]["mass_before_g"].get<double>(),
              report["print"]["filament_before_mm3"].get<double>() * 1.24e-3, 1e-9);
  EXPECT_EQ(report["material"]["assumes"], "the predicted filament");
}

// The infill above which voids save depends on the walls round them.
TEST(PrintOptions, ThePrintMayBeDescribedWithoutItsInfill) {
  const Job job;
  const std::vector<std::string> few{"--max-voids", "4"};
  const auto break_even = [&](const std::vector<std::string>& options) {
    const Json print = report_of(job, block(), with(few, options))["print"];
    EXPECT_FALSE(print["described"].get<bool>());
    return print["break_even_infill_percent"].get<double>();
  };
  EXPECT_GT(break_even({"--perimeters", "4"}), break_even({}));
  const ProcessResult text = hollow(job, block(), with(few, {"--perimeters", "1", "--line-width", "0.5"}));
  EXPECT_TRUE(contains(text.out, "(1 perimeter of 0.5 mm, ")) << text.out;
}

TEST(PrintOptions, WhatPrintsNoFilamentIsNotPredicted) {
  const Job job;
  EXPECT_TRUE(report_of(job, make_box({0, 0, 0}, {40, 40, 40}), {"--process", "sls"})["print"].is_null());
}

TEST(PrintOptions, ThatMakeNoSense) {
  const Job job;
  const auto refused = [&](const std::vector<std::string>& arguments, const std::vector<std::string>& said) {
    expect_refused(job, arguments, kUsage, said);
  };
  for (const char* infill : {"-5%", "101", "much", "15%%", "nan", ""})
    refused({"--infill", infill}, {"--infill"});
  refused({"--infill", "100%", "--perimeters", "-1"}, {"--perimeters"});
  refused({"--infill", "100%", "--perimeters", "two"}, {"--perimeters"});
  refused({"--infill", "100%", "--line-width", "0"}, {"--line-width"});
  refused({"--infill", "100%", "--layer-height", "0.6"}, {"--layer-height 0.6 mm", "--line-width 0.45 mm"});
  refused({"--infill", "100%", "--gap", "0.3"}, {"--gap 0.3 mm", "--line-width 0.45 mm"});
  refused({"--infill", "100%", "--wall", "0.3"}, {"--wall 0.3 mm", "--line-width 0.45 mm"});
  refused({"--infill", "100%", "--infill-pattern", "stars"}, {"stars"});
  refused({"--infill", "15%", "--process", "sla"}, {"--infill 15%", "--process sla"});
  refused({"--perimeters", "3", "--process", "sla"}, {"--perimeters 3", "--process sla"});
  refused({"--layer-height", "0.6"}, {"--layer-height 0.6 mm", "--line-width 0.45 mm"});
  refused({"--force"}, {"--force", "--infill"});
}

TEST(PrintOptions, AModelThatTipsOverByItsVoidsIsReported) {
  const Job job;
  const Json report = report_of(job, counterweight(), {"--max-radius", "14"});
  const Json& balance = report["strength_and_balance"];
  EXPECT_GT(balance["footing_margin_before_mm"].get<double>(), 0);
  EXPECT_LT(balance["footing_margin_after_mm"].get<double>(), 0);
  EXPECT_TRUE(balance["tips_over"].get<bool>());
  EXPECT_TRUE(contains(report["notices"].dump(), "it tips over"));
  EXPECT_LT(balance["relative_stiffness_upper_bound"].get<double>(), balance["solid_fraction"].get<double>());
  const Json cells = report_of(job, counterweight(), {"--max-radius", "14", "--shape", "cells"});
  EXPECT_NE(balance["blocks_relative_to_bound"], cells["strength_and_balance"]["blocks_relative_to_bound"]);

  const Json stands = report_of(job, block(), {});
  EXPECT_FALSE(stands["strength_and_balance"]["tips_over"].get<bool>());
  EXPECT_NEAR(stands["strength_and_balance"]["footing_margin_before_mm"].get<double>(), 15, 1e-6);
}

}  // namespace
}  // namespace aerate::test
