#include <array>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "files/load.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/three_mf_xml.h"
#include "tests/support/zip.h"

namespace aerate::test {
namespace {

using Files = std::vector<std::pair<std::string, std::string>>;

std::string box_xml(const std::string& beside = "") {
  return mesh_xml(make_box({0, 0, 0}, {20, 20, 20}), beside);
}

std::string components_xml(const std::vector<int>& ids) {
  std::string xml = "<components>";
  for (const int id : ids) xml += fmt::format(R"(<component objectid="{}"/>)", id);
  return xml + "</components>";
}

std::string box_model(const std::string& attributes = "") {
  return model_xml(object_xml(1, box_xml()), item_xml(1), attributes);
}

std::string relations_xml(const std::string& target) {
  return R"(<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">)"
         R"(<Relationship Id="a" Target="/Metadata/missing.png" Type="http://example.org/thumbnail"/>)"
         R"(<Relationship Id="b" Target=")" +
         target +
         R"(" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>)";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

class ThreeMfInput : public testing::Test {
 protected:
  LoadedModel load_zip(const std::string& bytes) const { return load_model(folder_.write("a.3mf", bytes)); }
  LoadedModel load(const std::string& model) const { return load_zip(make_3mf(model)); }
  std::string zip_error(const std::string& bytes) const {
    return message_of<InputError>([&] { load_zip(bytes); });
  }
  std::string error(const std::string& model) const { return zip_error(make_3mf(model)); }

  void expect_box(const LoadedModel& read) const {
    const Mesh box = make_box({0, 0, 0}, {20, 20, 20});
    ASSERT_EQ(read.mesh.triangles.size(), box.triangles.size());
    for (std::size_t i = 0; i < box.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(read.mesh.positions[read.mesh.triangles[i][k]], box.positions[box.triangles[i][k]]);
  }

  TemporaryFolder folder_;
};

// ---- Packages

TEST_F(ThreeMfInput, ThePartsMayComeInAnyOrderAndNameOthersThatAreMissing) {
  const std::pair<std::string, std::string> types{"[Content_Types].xml", "<Types/>"},
      model{"3D/3dmodel.model", box_model()}, relations{"_rels/.rels", relations_xml("/3D/3dmodel.model")};
  for (const Files& files :
       {Files{types, model, relations}, Files{relations, model}, Files{model, relations}, Files{model}})
    expect_box(load_zip(make_zip(files)));
}

TEST_F(ThreeMfInput, TheModelIsFoundWhereverItIs) {
  expect_box(load_zip(make_zip(
      {{"_rels/.rels", relations_xml("/3D/My%20Model.model")}, {"3D/My Model.model", box_model()}})));
  expect_box(load_zip(
      make_zip({{"_rels\\.rels", relations_xml("/3D/3dmodel.model")}, {"3D\\3dmodel.model", box_model()}})));
  expect_box(load_zip(make_zip({{"_rels/.rels", relations_xml("/3d/other.MODEL")},
                                {"3D/3dmodel.model", "<model/>"},
                                {"3D/Other.model", box_model()}})));
  expect_box(load_zip(make_zip({{"a.model", box_model()}})));
  EXPECT_TRUE(contains(zip_error(make_zip({{"a.model", box_model()}, {"b.model", box_model()}})),
                       "nothing says which"));
}

TEST_F(ThreeMfInput, ObjectsOfOtherModelPartsAreFollowed) {
  const std::string production =
      R"(xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" requiredextensions="p")";
  const auto root = [&](const std::string& path) {
    return model_xml(
        object_xml(1, R"(<components><component p:path=")" + path +
                          R"(" objectid="7" transform="1 0 0 0 1 0 0 0 1 0 0 5"/></components>)"),
        item_xml(1), production);
  };
  const std::string other = model_xml(object_xml(7, box_xml()), "");
  const LoadedModel read = load_zip(
      make_zip({{"3D/3dmodel.model", root("/3D/Objects/box.model")}, {"3D/Objects/box.model", other}}));
  EXPECT_EQ(read.part_count, 1u);
  EXPECT_EQ(bounding_box(read.mesh).lower, (Vec3f{0, 0, 5}));
  EXPECT_TRUE(contains(
      zip_error(make_zip({{"3D/3dmodel.model", root("/3D/none.model")}, {"3D/Objects/box.model", other}})),
      "object 7 is in a part that is missing"));
}

TEST_F(ThreeMfInput, ArchivesThatUnpackToFarTooMuchAreRefusedUnopened) {
  std::string archive = make_3mf(box_model());
  const std::size_t entry = archive.rfind("PK\x01\x02");
  archive[entry + 10] = 8;     // deflated
  archive[entry + 27] = 0x20;  // 512 MiB
  EXPECT_TRUE(contains(zip_error(archive), "would unpack from")) << zip_error(archive);

  Files many(20001, {"", "x"});
  for (std::size_t i = 0; i < many.size(); ++i) many[i].first = std::to_string(i);
  EXPECT_TRUE(contains(zip_error(make_zip(many)), "more than 20000 files"));
}

// ---- XML

TEST_F(ThreeMfInput, XmlIsReadAsSlicersReadIt) {
  const std::string model = box_model();
  expect_box(load(replaced(model, "<resources>", "<?x y?><resources>")));
  expect_box(load(replaced(model, "<resources>",
                           "<metadata name=\"Title\"><![CDATA[<vertex/> & ]]></metadata><resources>")));
  expect_box(load(replaced(model, "<resources>", "<!-- <build> --><resources>")));
  expect_box(load(replaced(model, "<resources>", "<x:y q:z=\"1\"><object/></x:y><resources>")));
  expect_box(load("\xef\xbb\xbf" + model));
  std::string wide = "\xff\xfe";
  for (const char c : replaced(model, "UTF-8", "UTF-16")) wide += {c, '\0'};
  expect_box(load(wide));
}

TEST_F(ThreeMfInput, TheCoreMayHaveAPrefix) {
  std::string model = box_model();
  for (std::size_t at = 0; (at = model.find('<', at)) != std::string::npos; at += 3) {
    if (model[at + 1] == '?') continue;
    model.insert(at + (model[at + 1] == '/' ? 2 : 1), "c:");
  }
  expect_box(load(replaced(model, "xmlns=", "xmlns:c=")));
}

TEST_F(ThreeMfInput, XmlThatIsNoneOrHostileIsRefusedWithItsPlace) {
  const std::string model = box_model();
  EXPECT_TRUE(contains(error(replaced(model, "</resources>", "")), "line 5, column 3: not well-formed XML"));
  EXPECT_TRUE(contains(error(model.substr(0, model.size() / 2)), "not well-formed XML"));
  EXPECT_TRUE(contains(error("<html/>"), "a <html> is not a 3MF model"));
  EXPECT_TRUE(contains(error(replaced(model, "<model", "<!DOCTYPE model [<!ENTITY a \"b\">]><model")),
                       "document type"));
  EXPECT_TRUE(
      contains(error(replaced(model, "<resources>", "<!--" + std::string(3 << 20, ' ') + "--><resources>")),
               "a tag or comment of more than"));
  std::string deep;
  for (int i = 0; i < 300; ++i) deep += "<a>";
  EXPECT_TRUE(contains(error(replaced(model, "<resources>", deep)), "nested deeper than 256"));
}

// ---- Numbers

TEST_F(ThreeMfInput, NumbersAreReadWholeOrRefused) {
  const auto with = [&](const std::string& number) {
    return replaced(box_model(), R"(x="20")", "x=\"" + number + "\"");
  };
  for (const char* number : {"20", " 20 ", "+20", "2e1", "2.0E+1", "20.", "200e-1", "20.0000000001"})
    expect_box(load(with(number)));
  for (const char* number : {"20mm", "20,5", "", " ", "2 0", "0x14", "+-20", "--20", "twenty"}) {
    const std::string message = error(with(number));
    EXPECT_TRUE(contains(message, fmt::format("x=\"{}\" is not a number", number))) << message;
    EXPECT_TRUE(contains(message, "'3D/3dmodel.model' in the 3MF package, line 3, column ")) << message;
  }
  for (const char* number : {"nan", "inf", "-infinity", "1e39"})
    EXPECT_TRUE(contains(error(with(number)), "is NaN, infinite or too large")) << number;
  // Too small for fp32 is nothing.
  EXPECT_EQ(load(replaced(box_model(), R"(x="0")", R"(x="1e-60")")).mesh.positions.size(), 8u);
  EXPECT_LT(error(with(std::string(100000, '9') + "x")).size(), 400u);
}

TEST_F(ThreeMfInput, IndicesAreReadWholeAndInRange) {
  const auto with = [&](const std::string& number) {
    return error(replaced(box_model(), R"(v1="0")", "v1=\"" + number + "\""));
  };
  for (const char* number : {"-1", "1.0", "1x", "4294967296"})
    EXPECT_TRUE(contains(with(number), "is not a whole number")) << number;
  EXPECT_TRUE(contains(with("8"), "uses vertex 8, and there are 8"));
  EXPECT_TRUE(contains(error(replaced(box_model(), R"(v1="0")", "")), "<triangle> has no v1"));
}

TEST_F(ThreeMfInput, TransformsAreTwelveNumbersOverAnyLines) {
  const auto with = [&](const std::string& transform) {
    return model_xml(object_xml(1, box_xml()), item_xml(1, "transform=\"" + transform + "\""));
  };
  const LoadedModel moved = load(with("1 0 0\n0 1 0\n0 0 1\n5 6 7"));
  EXPECT_EQ(bounding_box(moved.mesh).lower, (Vec3f{5, 6, 7}));
  for (const char* transform :
       {"1 0 0 0 1 0 0 0 1 5 6", "1 0 0 0 1 0 0 0 1 5 6 7 8", "1,0,0,0,1,0,0,0,1,5,6,7", ""})
    EXPECT_TRUE(contains(error(with(transform)), "twelve numbers")) << transform;
}

TEST_F(ThreeMfInput, TrianglesWithoutAreaAreRead) {
  Mesh mesh = make_box({0, 0, 0}, {20, 20, 20});
  mesh.triangles.push_back({0, 0, 1});
  const LoadedModel read = load(model_xml(object_xml(1, mesh_xml(mesh)), item_xml(1)));
  EXPECT_EQ(read.mesh.triangles.size(), 13u);
}

// ---- What makes the shape

TEST_F(ThreeMfInput, RequiredExtensionsThatAreNotReadAreRefusedByName) {
  const auto requiring = [&](const std::string& name) {
    return box_model("xmlns:e=\"" + name + "\" requiredextensions=\"e\"");
  };
  const std::string microsoft = "http://schemas.microsoft.com/3dmanufacturing/";
  for (const auto& [name, words] : std::vector<std::pair<std::string, std::string>>{
           {microsoft + "beamlattice/2017/02", "beam lattices"},
           {microsoft + "slice/2015/07", "slices"},
           {microsoft + "securecontent/2019/04", "secure content"},
           {"http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07", "boolean operations"},
           {"http://example.org/new", "'http://example.org/new'"}}) {
    const std::string message = error(requiring(name));
    EXPECT_TRUE(contains(message, "requires an extension of 3MF that is not read: " + words)) << message;
    expect_box(load(replaced(requiring(name), "requiredextensions", "recommendedextensions")));
  }
  EXPECT_TRUE(contains(error(box_model("requiredextensions=\"q\"")), "'q', whose namespace is not declared"));
  // These leave the shape as it is.
  for (const char* name : {"material/2015/02", "production/2015/06", "trianglesets/2021/07"})
    expect_box(load(requiring(microsoft + name)));
}

TEST_F(ThreeMfInput, ShapesOfExtensionsAreNeverDropped) {
  const std::string beams = "xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\"";
  EXPECT_TRUE(
      contains(error(model_xml(object_xml(1, box_xml("<b:beamlattice radius=\"1\"/>")), item_xml(1), beams)),
               "object 1 has a beam lattice, which is not read"));
  EXPECT_TRUE(contains(error(model_xml(object_xml(1, "<o:booleanshape/>"), item_xml(1))),
                       "object 1 is a <o:booleanshape>, which is not read"));
  EXPECT_TRUE(contains(error(model_xml(object_xml(1, ""), item_xml(1))), "neither a mesh nor components"));
}

TEST_F(ThreeMfInput, ItemsThatAreNotToBePrintedAreLeftOutWithANotice) {
  const std::string objects =
      object_xml(1, box_xml()) + object_xml(2, mesh_xml(make_box({40, 0, 0}, {60, 20, 20})));
  const LoadedModel read =
      load(model_xml(objects, item_xml(1, R"(printable="1")") + item_xml(2, R"(printable="0")")));
  expect_box(read);
  ASSERT_EQ(read.notices.size(), 1u);
  EXPECT_TRUE(contains(read.notices.front(), "1 of 2 items of the build are not to be printed"));
  EXPECT_TRUE(
      contains(error(model_xml(objects, item_xml(2, R"(printable="0")"))), "nothing to print: all 1 items"));
}

TEST_F(ThreeMfInput, ObjectsThatAreNoPartOfTheModelAreNamed) {
  const auto with = [&](const std::string& type) {
    return model_xml(object_xml(1, box_xml()) + object_xml(2, box_xml(), "type=\"" + type + "\""),
                     item_xml(1) + item_xml(2));
  };
  const LoadedModel read = load(with("surface"));
  expect_box(read);
  ASSERT_EQ(read.notices.size(), 1u);
  EXPECT_TRUE(contains(read.notices.front(), "object 2 is of type 'surface'"));
  EXPECT_TRUE(contains(error(with("solid")), "of a type that 3MF does not have: 'solid'"));
  EXPECT_TRUE(contains(error(model_xml(object_xml(1, box_xml(), "type=\"surface\""), item_xml(1))),
                       "object 1 is of type 'surface'"));
}

TEST_F(ThreeMfInput, ObjectsWithoutTrianglesAreNamed) {
  const LoadedModel read =
      load(model_xml(object_xml(1, box_xml()) + object_xml(2, mesh_xml({})), item_xml(1) + item_xml(2)));
  expect_box(read);
  EXPECT_EQ(read.part_count, 1u);
  EXPECT_EQ(read.notices, std::vector<std::string>{"object 2 has no triangles"});
}

TEST_F(ThreeMfInput, ObjectsThatAreMissingOrTwiceAreRefused) {
  EXPECT_TRUE(contains(error(model_xml(object_xml(1, box_xml()), item_xml(2))), "there is no object 2"));
  EXPECT_TRUE(contains(error(model_xml(object_xml(1, box_xml()) + object_xml(1, box_xml()), item_xml(1))),
                       "two objects of id 1"));
  EXPECT_TRUE(
      contains(error(model_xml(object_xml(1, box_xml() + box_xml()), item_xml(1))), "more than one shape"));
}

// ---- Components

TEST_F(ThreeMfInput, AFewBytesOfComponentsThatAreEndlesslyManyPartsAreRefusedAtOnce) {
  for (const std::string& first : {box_xml(), components_xml({})}) {
    std::string objects = object_xml(1, first);
    for (int i = 2; i <= 62; ++i) objects += object_xml(i, components_xml({i - 1, i - 1}));
    EXPECT_TRUE(contains(error(model_xml(objects, item_xml(62))), "more than 100000 parts"));
  }
}

TEST_F(ThreeMfInput, ComponentsOfThemselvesAreRefused) {
  const std::string circle = object_xml(1, components_xml({3})) + object_xml(2, components_xml({1})) +
                             object_xml(3, components_xml({2}));
  EXPECT_TRUE(contains(error(model_xml(circle, item_xml(1))), "object 1 is a component of itself"));
}

TEST_F(ThreeMfInput, ComponentsMayBeNestedButNotEndlessly) {
  const auto nested = [&](int depth) {
    std::string objects = object_xml(1, box_xml());
    for (int i = 2; i <= depth; ++i) objects += object_xml(i, components_xml({i - 1}));
    return model_xml(objects, item_xml(depth));
  };
  expect_box(load(nested(64)));
  EXPECT_TRUE(contains(error(nested(66)), "nested deeper than 64"));
  EXPECT_TRUE(contains(error(nested(20000)), "nested deeper than 64"));
}

TEST_F(ThreeMfInput, ComponentsThatMultiplyTrianglesAreLimited) {
  const Mesh ring = make_torus(10, 3, 25, 20);  // 1,000 triangles
  const std::vector<int> many(190, 1);
  std::vector<int> more(190, 2);
  const std::string objects = object_xml(1, mesh_xml(ring)) + object_xml(2, components_xml(many)) +
                              object_xml(3, components_xml(more));
  EXPECT_TRUE(contains(error(model_xml(objects, item_xml(3))), "more than 33554432 triangles of 1000"));
}

}  // namespace
}  // namespace aerate::test
