// Idle tangents leave a file, their bytes too, and everything else keeps its bits.
#include <map>
#include <random>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/file_tangents.h>

#include "io_files.h"
#include "refusal_of.h"

namespace darboux::drop_idle_tangents_test {
namespace {

using test::Builder;
using test::Glb;
using test::Json;
using test::TempFolder;

// The elements of an accessor, read by hand.
std::string elements(const Glb& glb, std::size_t index) {
  const std::map<std::string, std::size_t> components{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  const std::map<int, std::size_t> sizes{{5120, 1}, {5121, 1}, {5122, 2}, {5123, 2}, {5125, 4}, {5126, 4}};
  const Json& accessor = glb.json["accessors"][index];
  const Json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const std::size_t size = components.at(accessor["type"]) * sizes.at(accessor["componentType"]);
  const std::size_t stride = view.value("byteStride", size),
                    offset = accessor.value("byteOffset", std::size_t{0});
  std::string result;
  for (std::size_t i = 0; i < accessor["count"].get<std::size_t>(); ++i) {
    EXPECT_LE(offset + i * stride + size, view["byteLength"].get<std::size_t>());
    result += glb.bin.substr(view.value("byteOffset", std::size_t{0}) + offset + i * stride, size);
  }
  return result;
}

// Everything that a document has, by name.
std::map<std::string, std::string> content(const Glb& glb) {
  std::map<std::string, std::string> result;
  for (std::size_t m = 0; m < glb.json["meshes"].size(); ++m)
    for (std::size_t p = 0; p < glb.json["meshes"][m]["primitives"].size(); ++p) {
      const Json& primitive = glb.json["meshes"][m]["primitives"][p];
      const std::string name = std::to_string(m) + "/" + std::to_string(p) + "/";
      for (const auto& [key, value] : primitive["attributes"].items())
        result[name + key] = elements(glb, value.get<std::size_t>());
      if (primitive.contains("indices"))
        result[name + "indices"] = elements(glb, primitive["indices"].get<std::size_t>());
      if (primitive.contains("targets"))
        for (std::size_t t = 0; t < primitive["targets"].size(); ++t)
          for (const auto& [key, value] : primitive["targets"][t].items())
            result[name + std::to_string(t) + key] = elements(glb, value.get<std::size_t>());
    }
  if (glb.json.contains("images"))
    for (const Json& image : glb.json["images"]) {
      const Json& view = glb.json["bufferViews"][image["bufferView"].get<std::size_t>()];
      result["image"] =
          glb.bin.substr(view["byteOffset"].get<std::size_t>(), view["byteLength"].get<std::size_t>());
    }
  return result;
}

struct Dropped {
  DroppedIdle report;
  Glb before, after;
};
Dropped drop(const Builder& builder) {
  const TempFolder folder;
  GltfDocument document = GltfDocument::load(test::write_bytes(folder / "in.glb", builder.glb()));
  Dropped result{drop_idle_tangents(document), test::split_glb(builder.glb()), {}};
  document.save_glb(folder / "out.glb");
  result.after = test::split_glb(test::read_bytes(folder / "out.glb"));
  GltfDocument::load(folder / "out.glb").asset();  // reads
  return result;
}

std::string random_bytes(std::size_t n) {
  static std::mt19937 random(20261124);
  std::string bytes;
  // Floats near 1, so that meshes can be read.
  for (std::size_t i = 0; i < n / 4; ++i) {
    const float x = 1 + static_cast<float>(random() % 1024) / 4096;
    bytes.append(reinterpret_cast<const char*>(&x), 4);
  }
  bytes.resize(n, 'x');
  return bytes;
}

constexpr std::size_t count = 7;
const char* const names[] = {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"};
const char* const types[] = {"VEC3", "VEC3", "VEC4", "VEC2"};
constexpr std::size_t sizes[] = {12, 12, 16, 8};

// A primitive whose attributes have bufferViews of their own, share one behind each other, or interleave.
enum class Layout { own, behind, interleaved };
Json attributes(Builder& b, Layout layout) {
  Json result;
  const std::size_t shared = layout == Layout::own ? 0
                             : layout == Layout::behind
                                 ? b.view(random_bytes(48 * count))
                                 : b.view(random_bytes(48 * count), Json{{"byteStride", 48}});
  for (std::size_t k = 0, at = 0; k < 4; ++k) {
    const std::size_t view = layout == Layout::own ? b.view(random_bytes(sizes[k] * count)) : shared;
    Json more{{"bufferView", view}};
    if (layout != Layout::own) more["byteOffset"] = at;
    at += layout == Layout::behind ? sizes[k] * count : sizes[k];
    if (k == 0) more.update(Json{{"min", {1, 1, 1}}, {"max", {1.25, 1.25, 1.25}}});
    result[names[k]] = b.accessor(types[k], 5126, count, more);
  }
  return result;
}

void expect_all_but_tangents(const Dropped& d, std::size_t tangents) {
  auto before = content(d.before);
  const auto after = content(d.after);
  EXPECT_EQ(after.size() + tangents, before.size());
  for (const auto& [name, bytes] : after) EXPECT_EQ(bytes, before[name]) << name;
  EXPECT_EQ(d.before.bin.size() - d.after.bin.size(), d.report.bytes);
}

TEST(DropIdleTangents, LeavesEverythingElseAsItIsInEveryLayout) {
  for (const Layout layout : {Layout::own, Layout::behind, Layout::interleaved}) {
    SCOPED_TRACE(static_cast<int>(layout));
    Builder b;
    b.view("before");
    b.primitive(attributes(b, layout));
    const std::size_t image = b.view("an image of odd size!");
    b.json["images"] = Json::array({{{"bufferView", image}, {"mimeType", "image/png"}}});
    b.primitive(attributes(b, layout));
    const Dropped d = drop(b);
    EXPECT_EQ(d.report.primitives.size(), 2u);
    EXPECT_EQ(d.report.bytes, 2 * 16 * count);
    EXPECT_EQ(d.report.bytes_kept, "");
    expect_all_but_tangents(d, 2);
    EXPECT_EQ(d.after.json["accessors"].size(), 6u);
    EXPECT_EQ(d.after.json["bufferViews"].size(), layout == Layout::own ? 8u : 4u);
    if (layout == Layout::interleaved) {
      EXPECT_EQ(d.after.json["bufferViews"][1]["byteStride"], 32);
    }
  }
}

TEST(DropIdleTangents, KeepsWhatAnotherPrimitiveReads) {
  Builder b;
  b.json["materials"] = Json::array({Json{{"normalTexture", {{"index", 0}}}}});
  const Json shared = attributes(b, Layout::interleaved);
  b.primitive(shared);
  b.primitive(shared, {{"material", 0}});
  const Dropped d = drop(b);
  ASSERT_EQ(d.report.primitives.size(), 1u);
  EXPECT_EQ(d.report.primitives[0].primitive, 0u);
  EXPECT_EQ(d.report.bytes, 0u);
  expect_all_but_tangents(d, 1);
  EXPECT_TRUE(d.after.json["meshes"][0]["primitives"][1]["attributes"].contains("TANGENT"));
}

TEST(DropIdleTangents, OfMorphTargetsLeaveTooUnlessATargetHasNothingElse) {
  Builder b;
  Json a = attributes(b, Layout::own);
  const auto delta = [&] {
    return b.accessor("VEC3", 5126, count, {{"bufferView", b.view(random_bytes(12 * count))}});
  };
  Json position = delta(), tangent = delta();
  b.json["accessors"][position.get<std::size_t>()].update(Json{{"min", {1, 1, 1}}, {"max", {2, 2, 2}}});
  b.primitive(a, {{"targets", Json::array({{{"POSITION", position}, {"TANGENT", tangent}}})}});
  const Dropped d = drop(b);
  EXPECT_EQ(d.report.bytes, (16 + 12) * count);
  expect_all_but_tangents(d, 2);
  b.json["meshes"][0]["primitives"][0]["targets"].push_back({{"TANGENT", tangent}});
  const Dropped alone = drop(b);
  EXPECT_TRUE(alone.report.primitives.empty());
  EXPECT_EQ(alone.report.bytes, 0u);
}

TEST(DropIdleTangents, LeavesBytesWhereNumbersMayBeNamedElsewhere) {
  Builder b;
  b.json["extensionsUsed"] = Json::array({"KHR_materials_sheen", "ACME_tables"});
  b.primitive(attributes(b, Layout::own));
  const Dropped d = drop(b);
  EXPECT_EQ(d.report.primitives.size(), 1u);
  EXPECT_NE(d.report.bytes_kept.find("ACME_tables"), std::string::npos);
  EXPECT_EQ(d.report.bytes, 0u);
  EXPECT_EQ(d.before.json["accessors"], d.after.json["accessors"]);
  expect_all_but_tangents(d, 1);
}

TEST(DropIdleTangents, LeavesBytesThatOthersLieOn) {
  Builder b;
  Json a = attributes(b, Layout::own);
  // The same bytes as colours.
  a["COLOR_0"] = b.accessor("VEC4", 5126, count, {{"bufferView", b.json["accessors"][2]["bufferView"]}});
  b.primitive(a);
  const Dropped d = drop(b);
  EXPECT_EQ(d.report.bytes, 0u);
  EXPECT_EQ(d.report.bytes_kept, "");
  expect_all_but_tangents(d, 1);
}

TEST(DropIdleTangents, RefusesADocumentThatContradictsItself) {
  Builder b;
  b.primitive(attributes(b, Layout::own));
  b.json["skins"] = Json::array({Json{{"inverseBindMatrices", 99}, {"joints", Json::array()}}});
  const TempFolder folder;
  GltfDocument document = GltfDocument::load(test::write_bytes(folder / "in.glb", b.glb()));
  EXPECT_NE(test::refusal_of<FileError>([&] { drop_idle_tangents(document); }).find("in.glb"),
            std::string::npos);
  EXPECT_EQ(document.asset().primitives.at(0).data.tangents.size(), count) << "as it was";
  // Counts whose bytes would wrap round 2^64.
  for (const std::uint64_t elements : {std::uint64_t{1} << 60, std::uint64_t{100}}) {
    b = Builder();
    b.primitive(attributes(b, Layout::own));
    b.json["accessors"][2]["count"] = elements;
    document = GltfDocument::load(test::write_bytes(folder / "in.glb", b.glb()));
    EXPECT_NE(test::refusal_of<FileError>([&] { drop_idle_tangents(document); }).find("accessors[2]"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace darboux::drop_idle_tangents_test
