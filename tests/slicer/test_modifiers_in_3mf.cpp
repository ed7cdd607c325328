#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "core/error.h"
#include "files/three_mf.h"
#include "printing/slicers/slicers.h"
#include "printing/slicers/support_blockers.h"
#include "tests/support/caught.h"
#include "tests/support/files.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/zip.h"

// What each slicer's row writes into a package about modifiers, and reads back.
namespace aerate::test {
namespace {

// A box with one void: the void's shell is inward, as in every solid.
Solid box_with_a_void() {
  const Mesh outer = make_box({0, 0, 0}, {20, 20, 20});
  const Mesh shell = turned_inside_out(make_box({8, 8, 8}, {12, 12, 12}));
  Solid solid;
  solid.mesh = join(outer, shell);
  solid.parts = {{PartKind::outer, 0, outer.triangles.size()}};
  solid.close_part(PartKind::void_surface);
  return solid;
}

class ModifiersIn3mf : public testing::Test {
 protected:
  static std::vector<SlicerProfile> those_that_take_them() {
    std::vector<SlicerProfile> all;
    for (const SlicerProfile& slicer : slicers()) {
      if (slicer.modifiers) all.push_back(slicer);
    }
    return all;
  }

  std::filesystem::path file(const std::string& bytes, const std::string& ending = ".3mf") const {
    return folder_.write("model" + ending, bytes);
  }
  std::filesystem::path file(const Solid& solid, double infill, const SlicerProfile& slicer,
                             const std::string& pattern = {}) const {
    const std::vector<ObjectPart> parts = modifier_parts(solid, infill, pattern);
    return file(
        slicer.modifiers->file(with_void_shells_turned(solid.mesh, solid), parts.front(), parts.back(), ""),
        slicer.modifiers->ending);
  }

  TemporaryFolder folder_;
};

TEST_F(ModifiersIn3mf, TheModelAndItsModifierAreNamed) {
  const Solid solid = box_with_a_void();
  EXPECT_EQ(those_that_take_them().size(), 4u);
  for (const SlicerProfile& slicer : those_that_take_them()) {
    SCOPED_TRACE(slicer.name);
    const auto path = file(solid, 12.5, slicer);
    EXPECT_EQ(slicer.modifiers->read(path), modifier_parts(solid, 12.5));
    if (slicer.modifiers->read_mesh != nullptr) {
      const Mesh bodies = slicer.modifiers->read_mesh(path);
      EXPECT_EQ(bodies.triangles.size(), solid.mesh.triangles.size());
      EXPECT_EQ(signed_volume(bodies), 8000 + 64);
    } else {
      EXPECT_EQ(signed_volume(load_model(path).mesh), 8000 + 64);
    }
    if (slicer.modifiers->ending != ".3mf") continue;
    // As a model it would print the voids.
    EXPECT_TRUE(contains(
        message_of<InputError>([&] { load_model(path, {.unit = {}, .volume_lists = volume_lists()}); }),
        "not part of the model"));
  }
}

TEST_F(ModifiersIn3mf, ThePatternInsideIsNamedWhereTheSlicerHasIt) {
  const Solid solid = box_with_a_void();
  for (const SlicerProfile& slicer : those_that_take_them()) {
    if (!slicer.modifiers->has_lightning) continue;
    SCOPED_TRACE(slicer.name);
    EXPECT_EQ(slicer.modifiers->read(file(solid, 15, slicer, kLightning)),
              modifier_parts(solid, 15, kLightning));
    EXPECT_NE(slicer.modifiers->read(file(solid, 15, slicer)), modifier_parts(solid, 15, kLightning));
  }
}

// Alphas of PrusaSlicer 3.0 read modifiers of its own packages alone, of versions that it takes for older ones; OrcaSlicer asks
// about those of Bambu Studio, and its command line crashes.
TEST_F(ModifiersIn3mf, PackagesSayWhoMadeThem) {
  const Solid solid = box_with_a_void();
  const auto application = [&](const SlicerProfile& slicer) {
    const std::string model = read_3mf_entry(file(solid, 0, slicer), kThreeMfModel);
    const std::string begin = "<metadata name=\"Application\">";
    const std::size_t at = model.find(begin) + begin.size();
    return model.substr(at, model.find('<', at) - at);
  };
  const std::string prusa = application(prusa_slicer());
  ASSERT_TRUE(prusa.starts_with("PrusaSlicer-")) << prusa;
  EXPECT_LT(version_of("PrusaSlicer", prusa).value(), (SlicerVersion{2, 99, 0}));
  EXPECT_TRUE(application(orca_slicer()).starts_with("aerate ")) << application(orca_slicer());
}

TEST_F(ModifiersIn3mf, FilesThatAreCutOffAreNoticed) {
  const Solid solid = box_with_a_void();
  for (const SlicerProfile& slicer : those_that_take_them()) {
    if (slicer.modifiers->read_mesh == nullptr) continue;
    SCOPED_TRACE(slicer.name);
    const std::string bytes = read_bytes(file(solid, 0, slicer));
    const auto cut = file(bytes.substr(0, bytes.size() / 2), slicer.modifiers->ending);
    EXPECT_TRUE(
        contains(message_of<FailureError>([&] { slicer.modifiers->read_mesh(cut); }), "that was written"));
    EXPECT_TRUE(contains(message_of<FailureError>([&] { slicer.modifiers->read(cut); }), "that was written"));
  }
}

TEST_F(ModifiersIn3mf, SupportBlockersAreNamedAndKnownAgain) {
  const Solid solid = box_with_a_void();
  const std::vector<ObjectPart> parts = blocker_parts(solid);
  std::size_t count = 0;
  for (const SlicerProfile& slicer : those_that_take_them()) {
    if (!slicer.modifiers->has_blockers) continue;
    ++count;
    SCOPED_TRACE(slicer.name);
    const auto path =
        file(slicer.modifiers->file(with_support_blockers(solid, 0.4), parts.front(), parts.back(), "part"));
    EXPECT_EQ(slicer.modifiers->read(path), parts);
    EXPECT_NE(slicer.modifiers->read(path), modifier_parts(solid, 0));
    const LoadedModel loaded = load_model(path, {.unit = {}, .volume_lists = volume_lists()});
    EXPECT_EQ(signed_volume(loaded.mesh), 8000 - 64);
    EXPECT_EQ(loaded.part_count, 1u);
    // Those of somebody else stay what is no part of the model.
    ObjectPart other = parts.back();
    other.name = "mine";
    const auto others =
        file(slicer.modifiers->file(with_support_blockers(solid, 0.4), parts.front(), other, "part"));
    EXPECT_TRUE(contains(
        message_of<InputError>([&] { load_model(others, {.unit = {}, .volume_lists = volume_lists()}); }),
        "'mine'"));
  }
  EXPECT_EQ(count, 2u);
}

TEST_F(ModifiersIn3mf, SupportsAreAPartWithSettings) {
  const Mesh model = make_box({0, 0, 0}, {10, 10, 10});
  const Mesh both = join(model, make_box({20, 0, 0}, {30, 10, 5}));
  std::size_t count = 0;
  for (const SlicerProfile& slicer : those_that_take_them()) {
    if (slicer.modifiers->support_settings.empty()) continue;
    ++count;
    SCOPED_TRACE(slicer.name);
    std::vector<PartSetting> settings = slicer.modifiers->support_settings;
    settings.push_back({"extruder", "2"});
    const std::vector<ObjectPart> parts = support_parts(12, 12, settings);
    const auto path = file(slicer.modifiers->file(both, parts.front(), parts.back(), "part"));
    EXPECT_EQ(slicer.modifiers->read(path), parts);
    settings.back().value = "1";
    EXPECT_NE(slicer.modifiers->read(path), support_parts(12, 12, settings));
    // They are no part of the model when it is read again...
    const LoadedModel loaded = load_model(path, {.unit = {}, .volume_lists = volume_lists()});
    EXPECT_EQ(signed_volume(loaded.mesh), 1000);
    EXPECT_EQ(loaded.part_count, 1U);
    ASSERT_EQ(loaded.notices.size(), 1U);
    EXPECT_EQ(loaded.notices[0], "'supports' is no part of the model, and left out");
    // ...which bodies are that are called so, but are filled as the model is.
    const auto others = file(
        slicer.modifiers->file(both, parts.front(), support_parts(12, 12, {{"extruder", "2"}}).back(), ""));
    EXPECT_EQ(signed_volume(load_model(others, {.unit = {}, .volume_lists = volume_lists()}).mesh),
              1000 + 500);
  }
  EXPECT_EQ(count, 2u);
}

TEST_F(ModifiersIn3mf, AreBodiesOfTheirOwn) {
  const Solid solid = box_with_a_void();
  const Mesh bodies = with_void_shells_turned(solid.mesh, solid);
  EXPECT_DOUBLE_EQ(signed_volume(solid.mesh), 8000 - 64);
  EXPECT_DOUBLE_EQ(signed_volume(bodies), 8000 + 64);
  EXPECT_EQ(with_void_shells_turned(bodies, solid).triangles, solid.mesh.triangles);
}

TEST_F(ModifiersIn3mf, PartsThatAreNotThoseMeantAreNoticed) {
  const Solid solid = box_with_a_void();
  Solid shifted = solid;
  shifted.parts.front().triangle_count -= 1;
  for (const SlicerProfile& slicer : those_that_take_them()) {
    SCOPED_TRACE(slicer.name);
    EXPECT_NE(slicer.modifiers->read(file(shifted, 0, slicer)), modifier_parts(solid, 0));
    EXPECT_NE(slicer.modifiers->read(file(solid, 10, slicer)), modifier_parts(solid, 0));
  }
}

TEST_F(ModifiersIn3mf, PackagesOfAnotherKindAreRefused) {
  for (const SlicerProfile& slicer : those_that_take_them()) {
    SCOPED_TRACE(slicer.name);
    if (!slicer.modifiers->volumes) continue;
    const std::string list = slicer.modifiers->volumes->entry;
    const auto read = [&](const std::filesystem::path& path) {
      return message_of<FailureError>([&] { slicer.modifiers->read(path); });
    };
    EXPECT_TRUE(contains(read(file(to_3mf(make_box({0, 0, 0}, {1, 1, 1})))), list + " is missing"));
    EXPECT_TRUE(contains(read(file(make_zip({{list, "<config><object>"}}))), list + ": "));
  }
}

}  // namespace
}  // namespace aerate::test
