#include <array>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/mesh.h"
#include "files/load.h"
#include "tests/files/load_test.h"
#include "tests/support/caught.h"
#include "tests/support/same_corners.h"
#include "tests/support/shapes.h"
#include "tests/support/three_mf_xml.h"
#include "tests/support/zip.h"

// Packages as programs write them: units, components, placements, slicers' projects.
namespace aerate::test {
namespace {

TEST_F(Load, UnitOf3mfIsApplied) {
  const Mesh box = make_box({0, 0, 0}, {1, 2, 3});
  const std::array<std::pair<std::string, double>, 7> units{{{"", 1.0},
                                                             {"micron", 0.001},
                                                             {"millimeter", 1.0},
                                                             {"centimeter", 10.0},
                                                             {"inch", 25.4},
                                                             {"foot", 304.8},
                                                             {"meter", 1000.0}}};
  for (const auto& [unit, factor] : units) {
    const LoadedModel model =
        load("box.3mf", make_3mf(model_xml(object_xml(1, mesh_xml(box)), item_xml(1), "", unit)));
    EXPECT_EQ(model.format, "3MF");
    Mesh expected = box;
    for (Vec3f& p : expected.positions) p = to_float(to_double(p) * factor);
    expect_same_corners(model.mesh, expected);
  }
}

TEST_F(Load, UnitThatContradictsThe3mfIsAUsageError) {
  const std::filesystem::path path =
      write("box.3mf", make_3mf(model_xml(object_xml(1, mesh_xml(odd_box())), item_xml(1), "", "inch")));
  const auto load_as = [&](LengthUnit unit) { return load_model(path, {.unit = unit}); };
  EXPECT_TRUE(contains(message_of<UsageError>([&] { load_as(LengthUnit::millimetre); }), "inch"));
  EXPECT_EQ(load_as(LengthUnit::inch).mesh.triangles.size(), 12u);
  EXPECT_NEAR(signed_volume(load_model(path, {.unit = {}, .scale = {1 / 25.4, 1 / 25.4, 1 / 25.4}}).mesh),
              signed_volume(odd_box()), 1e-5);
}

TEST_F(Load, ComponentsAndBuildTransformsOf3mf) {
  const Mesh box = make_box({0, 0, 0}, {1, 2, 3});
  // The component turns the box by 90 degrees about z and shifts it along x; the item doubles and shifts
  // along z.
  const std::string resources =
      object_xml(1, mesh_xml(box)) +
      object_xml(2, R"(<components><component objectid="1"/>)"
                    R"(<component objectid="1" transform="0 1 0 -1 0 0 0 0 1 10 0 0"/></components>)") +
      object_xml(3, mesh_xml(make_box({50, 50, 50}, {60, 60, 60})));
  const LoadedModel model =
      load("parts.3mf",
           make_3mf(model_xml(resources, R"(<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 100"/>)"
                                         R"(<item objectid="1"/>)")));
  EXPECT_EQ(model.part_count, 3u);  // object 3 is not built
  Mesh first = box, second = box;
  for (Vec3f& p : first.positions) p = {2 * p.x, 2 * p.y, 2 * p.z + 100};
  for (Vec3f& p : second.positions) p = {2 * (10 - p.y), 2 * p.x, 2 * p.z + 100};
  expect_same_corners(model.mesh, join(join(first, second), box));
}

TEST_F(Load, MirroredPartOf3mfStaysRightSideOut) {
  const LoadedModel model = load(
      "mirrored.3mf", make_3mf(model_xml(object_xml(1, mesh_xml(make_box({1, 0, 0}, {2, 2, 3}))),
                                         R"(<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>)")));
  EXPECT_NEAR(signed_volume(model.mesh), 6.0, 1e-6);
  EXPECT_EQ(bounding_box(model.mesh).lower.x, -2.0f);
}

TEST_F(Load, SupportObjectsOf3mfAreLeftOut) {
  const std::string resources =
      object_xml(1, mesh_xml(odd_box())) + object_xml(2, mesh_xml(odd_box()), R"(type="support")");
  const LoadedModel model =
      load("support.3mf", make_3mf(model_xml(resources, R"(<item objectid="1"/><item objectid="2"/>)")));
  EXPECT_EQ(model.part_count, 1u);
  EXPECT_EQ(model.mesh.triangles.size(), 12u);
}

// A package as slicers write it: with files of their own, and a relation to a thumbnail that is not there.
std::string slicer_project(const std::string& config_name, const std::string& config) {
  return make_zip(
      {{"[Content_Types].xml",
        R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
<Default Extension="png" ContentType="image/png"/></Types>)"},
       {"_rels/.rels",
        R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel-1"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
<Relationship Target="/Metadata/thumbnail.png" Id="rel-2"
 Type="http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail"/></Relationships>)"},
       {"3D/3dmodel.model", model_xml(object_xml(1, mesh_xml(odd_box())), R"(<item objectid="1"/>)")},
       {config_name, config}});
}

TEST_F(Load, ProjectsOfSlicers) {
  const auto prusa = [](const std::string& metadata) {
    return slicer_project("Metadata/Slic3r_PE_model.config",
                          R"(<config><object id="1"><volume firstid="0" lastid="11">)"
                          R"(<metadata type="volume" key="name" value="Box"/>)" +
                              metadata + "</volume></object></config>");
  };
  const auto orca = [](const std::string& subtype) {
    return slicer_project("Metadata/model_settings.config",
                          R"(<config><object id="2"><part id="1" subtype=")" + subtype +
                              R"("><metadata key="name" value="Box"/></part></object></config>)");
  };
  const std::string type = R"(<metadata type="volume" key="volume_type" value=")";
  for (const std::string& project : {prusa(type + R"(ModelPart"/>)"), prusa(""), orca("normal_part")})
    expect_same_corners(load("project.3mf", project).mesh, odd_box());
  // In the package these look like bodies of the model.
  for (const std::string& project :
       {prusa(type + R"(ParameterModifier"/>)"), prusa(type + R"(NegativeVolume"/>)"),
        prusa(R"(<metadata type="volume" key="modifier" value="1"/>)"), orca("modifier_part"), orca(""),
        orca("support_blocker")}) {
    const std::string message = input_error("project.3mf", project);
    EXPECT_TRUE(contains(message, "a volume that is not part of the model")) << message;
    EXPECT_TRUE(contains(message, "'Box'")) << message;
  }
}

// Two boxes in one mesh of a project of PrusaSlicer, or as components as OrcaSlicer has them; the second is a modifier.
std::string project_with_modifiers(bool as_components, const std::string& kind, const std::string& placed) {
  const Mesh model = odd_box(), modifier = make_box({1, 1, 1}, {2, 2, 2});
  const std::string objects =
      as_components
          ? object_xml(1, mesh_xml(model)) + object_xml(2, mesh_xml(modifier)) +
                object_xml(3, R"(<components><component objectid="1"/><component objectid="2" transform=")"
                              R"(1 0 0 0 1 0 0 0 1 10 0 0"/></components>)")
          : object_xml(3, mesh_xml(join(model, moved(modifier, {10, 0, 0}))));
  const std::string config =
      as_components
          ? R"(<config><object id="3"><part id="1" subtype="normal_part"/><part id="2" subtype=")" + kind +
                R"("><metadata key="name" value="screw &amp; nut"/></part></object></config>)"
          : R"(<config><object id="3"><volume firstid="0" lastid="11"><metadata key="volume_type" value="ModelPart"/>)"
            R"(</volume><volume firstid="12" lastid="23"><metadata key="name" value="screw &amp; nut"/>)"
            R"(<metadata key="volume_type" value=")" +
                kind + R"("/></volume></object></config>)";
  return make_zip(
      {{"3D/3dmodel.model", model_xml(objects, R"(<item objectid="3")" + placed + "/>")},
       {as_components ? "Metadata/model_settings.config" : "Metadata/Slic3r_PE_model.config", config}});
}

TEST_F(Load, ModifiersOfProjectsAreReadApartWhereTheyAreAskedFor) {
  const LoadOptions options{
      .unit = {}, .volume_lists = volume_lists(), .wanted_modifiers = {"screw & nut", "not there"}};
  for (const bool as_components : {false, true}) {
    const std::string kind = as_components ? "modifier_part" : "ParameterModifier";
    const LoadedModel loaded = load("p.3mf", project_with_modifiers(as_components, kind, ""), options);
    expect_same_corners(loaded.mesh, odd_box());
    EXPECT_EQ(loaded.part_count, 1U);
    ASSERT_EQ(loaded.modifiers.size(), 1U);
    EXPECT_EQ(loaded.modifiers[0].name, "screw & nut");
    expect_same_corners(loaded.modifiers[0].mesh, make_box({11, 1, 1}, {12, 2, 2}));
    // Where the build puts them.
    const LoadedModel placed =
        load("p.3mf", project_with_modifiers(as_components, kind, R"( transform="1 0 0 0 1 0 0 0 1 0 0 5")"),
             options);
    expect_same_corners(placed.modifiers[0].mesh, make_box({11, 1, 6}, {12, 2, 7}));
    // What else is no part of the model is never taken for one.
    const std::string other = as_components ? "negative_part" : "NegativeVolume";
    const auto path = write("p.3mf", project_with_modifiers(as_components, other, ""));
    const std::string refused = message_of<InputError>([&] { load_model(path, options); });
    EXPECT_TRUE(contains(refused, "'screw & nut'"));
    EXPECT_TRUE(contains(refused, "not part of the model"));
  }
}

TEST_F(Load, Bad3mf) {
  const std::string good = make_3mf(model_xml(object_xml(1, mesh_xml(odd_box())), R"(<item objectid="1"/>)"));
  EXPECT_TRUE(contains(input_error("cut.3mf", good.substr(0, good.size() / 2)), "cut short or damaged"));
  EXPECT_TRUE(contains(input_error("tail.3mf", good.substr(0, good.size() - 1)), "cut short or damaged"));
  EXPECT_TRUE(contains(input_error("text.3mf", "solid cube"), "does not begin as a zip archive"));
  EXPECT_TRUE(contains(input_error("letter.3mf", make_zip({{"word/document.xml", "<w:document/>"}})),
                       "a zip archive without a model"));
  std::string altered = good;
  altered[altered.find("<vertex ") + 11] ^= 1;
  EXPECT_TRUE(contains(input_error("altered.3mf", altered), "'3D/3dmodel.model' in the 3MF package"));
  EXPECT_TRUE(
      contains(input_error("nothing.3mf", make_3mf(model_xml(object_xml(1, mesh_xml(odd_box())), ""))),
               "no triangles"));
  Mesh bad = odd_box();
  bad.triangles[3][1] = 77;
  input_error("index.3mf", make_3mf(model_xml(object_xml(1, mesh_xml(bad)), R"(<item objectid="1"/>)")));
  input_error("xml.3mf", make_3mf("<model"));
}

}  // namespace
}  // namespace aerate::test
