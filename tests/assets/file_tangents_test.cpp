// Tangents for files: right, and nothing else touched.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/file_tangents.h>

#include "generated_gltf.h"
#include "gltf_corners.h"
#include "refusal_of.h"
#include "rewritten.h"

namespace darboux::file_tangents_test {
namespace {

using test::Builder;
using test::Glb;
using test::Json;
using test::Made;
using test::rewrite;
using test::Rewritten;
using test::TempFolder;
using M = test::GeneratedMesh;

const float nan_f = std::numeric_limits<float>::quiet_NaN();
const float inf_f = std::numeric_limits<float>::infinity();

FileTangentOptions by(const std::string& method) {
  FileTangentOptions options;
  options.method = method;
  return options;
}

Builder one_triangle(std::initializer_list<float> normals, std::initializer_list<float> uvs) {
  Builder b;
  const auto position = b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const auto normal = b.packed<float>("VEC3", 5126, 3, normals);
  const auto uv = b.packed<float>("VEC2", 5126, 3, uvs);
  b.primitive({{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}});
  return b;
}

Builder one_triangle() {
  return one_triangle({0, 0, 1, 0, 0, 1, 0, 0, 1}, {0, 0, 1, 0, 0, 1});
}

// ---- nothing else changes

void expect_files_are_kept(const std::filesystem::path& folder, std::size_t least) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".glb") continue;
    SCOPED_TRACE(entry.path().string());
    ++files;
    for (const char* method : {"mikktspace", "average", "face"}) {
      SCOPED_TRACE(method);
      const Rewritten r = rewrite(entry.path().string(), by(method));
      test::expect_only_tangents_changed(r.before, r.after, r.made());
      if (entry.path().filename() == "AnimatedMorphSphere.glb") {
        EXPECT_TRUE(r.made().empty());
        ASSERT_EQ(r.report.skipped.size(), 1u);
        EXPECT_EQ(r.report.skipped[0].reason, "has no uvs");
        EXPECT_EQ(r.report.incapable, 1u);
        EXPECT_EQ(r.before.bin, r.after.bin);
      } else if (r.report.incapable == 0) {
        EXPECT_FALSE(r.made().empty());
      }
    }
  }
  EXPECT_GE(files, least);
}

TEST(FileTangents, FilesOfOtherToolsAreKept) {
  expect_files_are_kept(DARBOUX_TEST_DATA, 10);
}

TEST(FileTangents, SharedFilesAreKept) {
  const std::string shared = DARBOUX_SHARED "/meshes";
  if (!std::filesystem::exists(shared)) GTEST_SKIP() << shared << " is not here: its files are not rewritten";
  expect_files_are_kept(shared, 30);
}

// ---- the generated file: what the base and the targets must get, from its numbers

Mesh generated_mesh(int target) {
  Mesh mesh;
  const auto number = [](auto x) {
    return static_cast<double>(x) / static_cast<double>(std::numeric_limits<decltype(x)>::max());
  };
  for (std::size_t i = 0; i < M::vertices; ++i) {
    const auto* p = M::positions[i];
    const auto* n = M::normals[i % 3];
    mesh.positions.push_back({number(p[0]), number(p[1]), number(p[2])});
    mesh.normals.push_back({number(n[0]), number(n[1]), number(n[2])});
    mesh.uvs.push_back({number(M::us[i % 3]), number(M::vs[i / 3])});
  }
  if (target == 0)
    for (const int k : {0, 1}) {
      Vec3<double>& p = mesh.positions[k == 0 ? 1 : 4];
      p = p + Vec3<double>{M::moved[k][0], M::moved[k][1], M::moved[k][2]};
    }
  if (target == 1)
    for (Vec3<double>& n : mesh.normals) {
      n = n + Vec3<double>{M::turned[0], M::turned[1], M::turned[2]};
      n = n / norm(n);
    }
  return mesh;
}

template <class List>
void set_triangles(Mesh& mesh, const List& indices) {
  for (std::size_t i = 0; i + 2 < std::size(indices); i += 3)
    mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
}

void expect_generated(const Rewritten& r, std::size_t mesh, std::size_t primitive,
                      const std::vector<std::uint32_t>& corners, const std::string& method, float sign) {
  SCOPED_TRACE(std::to_string(mesh) + " " + std::to_string(primitive));
  const Json& json = r.after.json["meshes"][mesh]["primitives"][primitive];
  // Perpendicular to the stored normals, which only some methods read.
  const auto tangents = [&](int target) {
    Mesh m = generated_mesh(target);
    set_triangles(m, corners);
    const MeshFrames frames = mesh_frames(m, find_frame_method(method));
    std::vector<std::pair<std::array<float, 3>, float>> result;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      Vec3<double> t = frames.corner(c).t;
      const Vec3<double>& n = m.normals[corners[c]];
      if (std::fabs(dot(t, n)) > 1e-6 * norm(n) * norm(t)) t = unit(t - (dot(t, n) / dot(n, n)) * n);
      result.push_back({{static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z)},
                        static_cast<float>(frames.corner(c).sign)});
    }
    return result;
  };
  const auto base = tangents(-1);
  const auto stored = test::corner_floats<4>(r.after, json, json["attributes"]["TANGENT"]);
  ASSERT_EQ(stored.size(), corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const auto& [t, s] = base[c];
    EXPECT_EQ(stored[c], (std::array{t[0], t[1], t[2], sign * s}));
  }
  for (int k = 0; json.contains("targets") && k < 2; ++k) {
    const auto moved = tangents(k);
    const auto deltas =
        test::corner_floats<3>(r.after, json, json["targets"][static_cast<std::size_t>(k)]["TANGENT"]);
    bool any = false;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const auto &from = base[c].first, &to = moved[c].first;
      EXPECT_EQ(deltas[c], (std::array{to[0] - from[0], to[1] - from[1], to[2] - from[2]}));
      any = any || deltas[c] != std::array{0.0f, 0.0f, 0.0f};
    }
    EXPECT_TRUE(any) << "target " << k;
  }
}

// Of methods whose normals are not the file's: up to 0.93 of t lay along the stored normal.
TEST(FileTangents, ArePerpendicularToTheStoredNormals) {
  Builder b;
  std::vector<float> position, normal, uv;
  std::vector<std::uint16_t> index;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const auto x = static_cast<float>(i), y = static_cast<float>(j);
      position.insert(position.end(), {x, y, 0.2f * x * x});
      normal.insert(normal.end(), {0, 0, 1});  // as if it were flat
      uv.insert(uv.end(), {x / 3, y / 3});
    }
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      for (const int k : {0, 1, 5, 0, 5, 4}) index.push_back(static_cast<std::uint16_t>(4 * j + i + k));
  const auto positions = b.packed<float>("VEC3", 5126, 16, position);
  const auto normals = b.packed<float>("VEC3", 5126, 16, normal);
  const auto uvs = b.packed<float>("VEC2", 5126, 16, uv);
  const auto indices = b.packed<std::uint16_t>("SCALAR", 5123, 54, index);
  b.primitive({{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}}, {{"indices", indices}});
  for (const FrameMethod& method : frame_methods()) {
    const Rewritten r = rewrite(b, by(std::string(method.name)));
    const Json& json = r.after.json["meshes"][0]["primitives"][0];
    const auto stored = test::corner_floats<4>(r.after, json, json["attributes"]["TANGENT"]);
    ASSERT_EQ(stored.size(), 54U) << method.name;
    for (const auto& t : stored) {
      EXPECT_NEAR(t[2], 0, 1e-6) << method.name;
      EXPECT_NEAR(t[0] * t[0] + t[1] * t[1], 1, 1e-6) << method.name;
    }
  }
}

TEST(FileTangents, MorphTargetsQuantisedSparseInterleavedAndSharedAccessors) {
  const Builder builder = test::generated_gltf();
  const std::vector<std::uint32_t> all(std::begin(M::indices), std::end(M::indices)),
      few(std::begin(M::few), std::end(M::few)), strip = {0, 1, 3, 1, 4, 3, 3, 4, 6, 4, 7, 6};
  for (const char* method : {"mikktspace", "average", "face", "angle", "fragment-gradient"})
    for (const SignConvention sign : {SignConvention::gltf, SignConvention::raw}) {
      SCOPED_TRACE(method);
      FileTangentOptions options = by(method);
      options.sign = sign;
      options.threads = 2;
      const Rewritten r = rewrite(builder, options);
      EXPECT_TRUE(r.report.skipped.empty());
      EXPECT_EQ(r.made(), (Made{{0, 0}, {0, 1}, {1, 0}}));
      test::expect_only_tangents_changed(r.before, r.after, r.made());
      const float factor = sign == SignConvention::raw ? 1.0f : -1.0f;
      expect_generated(r, 0, 0, all, method, factor);
      expect_generated(r, 0, 1, few, method, factor);
      expect_generated(r, 1, 0, strip, method, factor);
      EXPECT_EQ(r.report.primitives[0].morph_targets, 2u);
      EXPECT_EQ(r.report.primitives[2].morph_targets, 0u);
      EXPECT_EQ(r.report.primitives[0].old_vertices, 9u);
    }
  // The fold splits the middle column, and nothing else.
  EXPECT_EQ(rewrite(builder).report.primitives[0].vertices, 12u);
  EXPECT_EQ(rewrite(builder).report.primitives[1].vertices, 9u);
  EXPECT_EQ(rewrite(builder, by("average")).report.primitives[0].vertices, 9u);
}

// What is to be replaced is not copied: of the first primitive 7 attributes, 2 targets, the indices, TANGENT
// and 2 deltas are new, of the second TANGENT and 2 deltas, of the third TANGENT.
TEST(FileTangents, OldTangentsAreNotCopied) {
  Builder b = test::generated_gltf();
  const std::size_t old =
      b.packed<float>("VEC4", 5126, 9, {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0,
                                        0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
  for (Json& primitive : b.json["meshes"][0]["primitives"]) primitive["attributes"]["TANGENT"] = old;
  const Rewritten r = rewrite(b);
  test::expect_only_tangents_changed(r.before, r.after, r.made());
  EXPECT_EQ(r.after.json["accessors"].size() - r.before.json["accessors"].size(), 17u);
}

// Corners whose base tangents agree part where a target's differ.
TEST(FileTangents, TargetsAloneCanSplitAVertex) {
  Builder b;
  const auto position = b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  const auto normal = b.packed<float>("VEC3", 5126, 4, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const auto uv = b.packed<float>("VEC2", 5126, 4, {0, 0, 1, 0, 1, 1, 0, 1});
  const auto moved = b.packed<float>("VEC3", 5126, 4, {0, 0, 0, 0, 0.5F, 0, 0, 0, 0, 0, 0, 0});
  const auto indices = b.packed<std::uint8_t>("SCALAR", 5121, 6, {0, 1, 2, 0, 2, 3});
  b.primitive({{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}},
              {{"indices", indices}, {"targets", {{{"POSITION", moved}}}}});
  const Rewritten r = rewrite(b, by("face"));
  test::expect_only_tangents_changed(r.before, r.after, r.made());
  // Without the target all corners have (1, 0, 0). With it the two triangles differ at the diagonal's ends.
  EXPECT_EQ(r.report.primitives.at(0).vertices, 6u);
  const Json& json = r.after.json["meshes"][0]["primitives"][0];
  const float s = 1 / std::sqrt(5.0f);
  const auto deltas = test::corner_floats<3>(r.after, json, json["targets"][0]["TANGENT"]);
  for (std::size_t c = 0; c < 6; ++c) {
    EXPECT_NEAR(deltas[c][0], c < 3 ? 2 * s - 1 : 0, 1e-7);  // two roundings to float
    EXPECT_NEAR(deltas[c][1], c < 3 ? s : 0, 1e-7);
  }
}

TEST(FileTangents, TargetsThatMoveUvs) {
  Builder b = one_triangle();
  const auto swapped = b.packed<float>("VEC2", 5126, 3, {0, 0, -1, 1, 1, -1});  // then u runs along y
  b.json["meshes"][0]["primitives"][0]["targets"] = {{{"TEXCOORD_0", swapped}}};
  const Rewritten r = rewrite(b);
  const Json& json = r.after.json["meshes"][0]["primitives"][0];
  for (const auto& delta : test::corner_floats<3>(r.after, json, json["targets"][0]["TANGENT"]))
    EXPECT_EQ(delta, (std::array{-1.0f, 1.0f, 0.0f}));
}

// A target that leaves all triangles without area says nothing of tangents: those of the base stay.
TEST(FileTangents, TargetsWithoutDirectionsChangeNothing) {
  // The base's tangent lies along y, where no method's default does.
  Builder b = one_triangle({0, 0, 1, 0, 0, 1, 0, 0, 1}, {0, 0, 0, 1, 1, 0});
  const auto collapsed = b.positions({0, 0, 0, -1, 0, 0, 0, -1, 0});
  b.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", collapsed}}};
  for (const char* method : {"mikktspace", "average", "face"}) {
    const Rewritten r = rewrite(b, by(method));
    const Json& json = r.after.json["meshes"][0]["primitives"][0];
    for (const auto& delta : test::corner_floats<3>(r.after, json, json["targets"][0]["TANGENT"]))
      EXPECT_EQ(delta, (std::array{0.0f, 0.0f, 0.0f})) << method;
  }
}

// ---- what cannot be done, and what is repaired

TEST(FileTangents, OneTriangle) {
  const Rewritten r = rewrite(one_triangle());
  const Json& json = r.after.json["meshes"][0]["primitives"][0];
  for (const auto& t : test::corner_floats<4>(r.after, json, json["attributes"]["TANGENT"]))
    EXPECT_EQ(t, (std::array{1.0f, 0.0f, 0.0f, -1.0f}));
  EXPECT_EQ(r.report.primitives.at(0).fallback_corners, 0u);
}

TEST(FileTangents, PrimitivesThatLackSomethingAreLeftAlone) {
  Builder b = one_triangle();
  const Json attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  for (const char* missing : {"NORMAL", "TEXCOORD_0"}) {
    Json fewer = attributes;
    fewer.erase(missing);
    b.primitive(fewer);
  }
  b.primitive(attributes, {{"mode", 0}});
  b.primitive(attributes, {{"mode", 1}});
  for (const char* method : {"mikktspace", "face"}) {
    const Rewritten r = rewrite(b, by(method));
    EXPECT_EQ(r.made(), (Made{{0, 0}}));
    ASSERT_EQ(r.report.skipped.size(), 4u);
    const char* reasons[] = {"has no normals", "has no uvs", "mode 0 (points) has no triangles",
                             "mode 1 (lines) has no triangles"};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(r.report.skipped[i].primitive, i + 1);
      EXPECT_EQ(r.report.skipped[i].reason, reasons[i]);
    }
    EXPECT_EQ(r.report.incapable, 2u);
    test::expect_only_tangents_changed(r.before, r.after, r.made());
  }
}

TEST(FileTangents, NumbersThatAreNotFiniteAreRefusedByName) {
  const auto refusal = [](const Builder& b) {
    const TempFolder folder;
    const std::string path = test::write_bytes(folder / "in.glb", b.glb());
    const std::string message = test::refusal_of<MeshError>([&] { rewrite(path); });
    return message.starts_with(path + ": ") ? message.substr(path.size() + 2) : message;
  };
  const std::string first = "meshes[0].primitives[0]",
                    rest = ": expected finite numbers, got NaN or infinity";
  for (const float bad : {nan_f, inf_f, -inf_f}) {
    EXPECT_EQ(refusal(one_triangle({0, 0, 1, 0, bad, 1, bad, 0, 1}, {0, 0, 1, 0, 0, 1})),
              first + ": normal of vertex 1" + rest);
    EXPECT_EQ(refusal(one_triangle({0, 0, 1, 0, 0, 1, 0, 0, 1}, {0, 0, 1, 0, 0, bad})),
              first + ": uv of vertex 2" + rest);
    Builder position = one_triangle();
    position.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
        position.positions({0, bad, 0, 1, 0, 0, 0, 1, 0});
    EXPECT_EQ(refusal(position), first + ": position of vertex 0" + rest);
    for (const std::string name : {"POSITION", "NORMAL"}) {
      Builder target = one_triangle();
      const auto fine = target.positions({0, 0, 0, 0, 0, 0, 0, 0, 0});
      const auto wrong = target.positions({0, 0, 0, 0, 0, 0, 0, 0, bad});
      target.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", fine}}, {{name, wrong}}};
      EXPECT_EQ(refusal(target), first + " with targets[1]: " + (name == "NORMAL" ? "normal" : "position") +
                                     " of vertex 2" + rest);
    }
    // Tangents that are to be replaced need not be good.
    Builder old = one_triangle();
    old.json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] =
        old.packed<float>("VEC4", 5126, 3, {bad, 0, 0, 1, bad, 0, 0, 1, bad, 0, 0, 1});
    EXPECT_EQ(refusal(old), "accepted");
  }
}

TEST(FileTangents, BrokenFilesAreRefused) {
  const auto refusal = [](const Builder& b) { return test::refusal_of<FileError>([&] { rewrite(b); }); };
  Builder b = one_triangle();
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["indices"] = b.packed<std::uint8_t>("SCALAR", 5121, 3, {0, 1, 3});
  EXPECT_NE(refusal(b).find("indices: expected indices below 3, got 3 at place 2"), std::string::npos)
      << refusal(b);
  b.json["accessors"].back()["count"] = 0;  // no triangle
  EXPECT_NE(refusal(b).find("count: expected an integer not below 1, got 0"), std::string::npos)
      << refusal(b);
  primitive.erase("indices");
  primitive["targets"] = {{{"POSITION", b.positions({0, 0, 0})}}};
  EXPECT_NE(refusal(b).find(
                "targets[0].POSITION: expected an accessor of as many elements as POSITION's, 3, got 1"),
            std::string::npos)
      << refusal(b);
  EXPECT_THROW(rewrite(one_triangle(), by("no such method")), ParameterError);
}

// The normal lies along the direction in which u grows: MikkTSpace leaves (0, 0, 0) there.
TEST(FileTangents, ADirectionAcrossTheNormalWhereTheMethodHasNone) {
  const Rewritten r = rewrite(one_triangle({1, 0, 0, 0, 0, 1, 1, 0, 0}, {0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(r.report.primitives.at(0).fallback_corners, 2u);
  const Json& json = r.after.json["meshes"][0]["primitives"][0];
  const auto tangents = test::corner_floats<4>(r.after, json, json["attributes"]["TANGENT"]);
  for (const std::size_t c : {0u, 2u}) {
    EXPECT_EQ(tangents[c][0], 0);
    EXPECT_NEAR(std::hypot(tangents[c][1], tangents[c][2]), 1, 1e-7);
  }
  EXPECT_EQ(tangents[1], (std::array{1.0f, 0.0f, 0.0f, -1.0f}));
}

// Without uv area no triangle serves: what is written lies across the normal all the same.
TEST(FileTangents, ADirectionAcrossTheNormalWhereNoTriangleServes) {
  const Rewritten r = rewrite(one_triangle({0.6F, 0, 0.8F, 0, 0.6F, 0.8F, 0, 0, 1}, {0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(r.report.primitives.at(0).fallback_corners, 3u);
  const Json& json = r.after.json["meshes"][0]["primitives"][0];
  const auto tangents = test::corner_floats<4>(r.after, json, json["attributes"]["TANGENT"]);
  const auto normals = test::corner_floats<3>(r.after, json, json["attributes"]["NORMAL"]);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& t = tangents[c];
    const auto& n = normals[c];
    EXPECT_NEAR(std::hypot(t[0], t[1], t[2]), 1, 1e-6);
    EXPECT_NEAR(t[0] * n[0] + t[1] * n[1] + t[2] * n[2], 0, 1e-6) << c;
  }
}

// No method leaves anything in a file that is not a unit direction and a sign, whatever the mesh.
TEST(FileTangents, DegenerateMeshesGetUnitTangents) {
  const std::vector<Builder> meshes = {
      one_triangle({0, 0, 1, 0, 0, 1, 0, 0, 1}, {0, 0, 0, 0, 0, 0}),  // all uvs equal
      one_triangle({0, 0, 1, 0, 0, 1, 0, 0, 1}, {0, 0, 1, 1, 2, 2}),  // collinear uvs
      one_triangle({0, 0, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 1}),  // normals of no length
      one_triangle({1, 0, 0, 0, 1, 0, 1, 1, 0}, {0, 0, 1, 0, 0, 1}),  // normals in the plane
      one_triangle({0, 0, 1, 0, 0, 1, 0, 0, 1}, {0, 0, 1e-30f, 0, 0, 1e-30f}),
      one_triangle({0, 0, 1, 0, 0, 1, 0, 0, 1}, {0, 0, 1e30f, 0, 0, 1e30f})};
  for (const Builder& flat : meshes)
    for (const float size : {1.0f, 0.0f, 1e-30f, 1e30f})
      for (const FrameMethod& method : frame_methods()) {
        SCOPED_TRACE(std::string(method.name) + " at " + std::to_string(&flat - meshes.data()) + ", " +
                     std::to_string(size));
        Builder b = flat;
        b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
            b.positions({0, 0, 0, size, 0, 0, 0, size, 0});
        const Rewritten r = rewrite(b, by(std::string(method.name)));
        EXPECT_EQ(r.made().size(), 1u);
        test::expect_only_tangents_changed(r.before, r.after, r.made());
      }
}

// ---- which primitives, which uvs

TEST(FileTangents, OnlyWhereTheMaterialReadsThem) {
  Builder b = one_triangle();
  const Json attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  b.json["materials"] = Json::parse(R"([{}, {"normalTexture": {"index": 0}},
    {"extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1}}},
    {"extensions": {"KHR_materials_clearcoat": {"clearcoatNormalTexture": {"index": 0}}}},
    {"extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 0.5}}},
    {"extensions": {"MSFT_packing_normalRoughnessMetallic":
      {"normalRoughnessMetallicTexture": {"index": 0}}}},
    {"occlusionTexture": {"index": 0},
      "extensions": {"KHR_materials_sheen": {}, "KHR_materials_iridescence": {}}}])");
  for (std::size_t m = 0; m < b.json["materials"].size(); ++m) b.primitive(attributes, {{"material", m}});
  b.primitive(
      attributes,
      {{"material", 0},
       {"extensions",
        {{"KHR_materials_variants",
          {{"mappings", {{{"material", 6}, {"variants", {0}}}, {{"material", 4}, {"variants", {1}}}}}}}}}});
  FileTangentOptions options;
  options.only_needed = true;
  const Rewritten r = rewrite(b, options);
  EXPECT_EQ(r.made(), (Made{{0, 2}, {0, 4}, {0, 5}, {0, 6}, {0, 8}}));
  test::expect_only_tangents_changed(r.before, r.after, r.made());
  ASSERT_EQ(r.report.skipped.size(), 4u);
  for (const SkippedPrimitive& s : r.report.skipped) EXPECT_EQ(s.reason, "its material reads no tangents");
  EXPECT_EQ(r.report.incapable, 0u);
  EXPECT_EQ(rewrite(b).made().size(), 9u);
}

TEST(FileTangents, FollowTheUvsOfTheTextureThatReadsThem) {
  Builder b = one_triangle();
  Json attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_1"] = b.packed<float>("VEC2", 5126, 3, {0, 0, 0, 1, 1, 0});  // u along y
  b.json["materials"] = Json::parse(R"([
    {"normalTexture": {"index": 0, "texCoord": 1}},
    {"extensions": {"KHR_materials_clearcoat": {"clearcoatNormalTexture": {"index": 0, "texCoord": 1}}}},
    {"extensions": {"KHR_materials_anisotropy": {"anisotropyTexture": {"index": 0, "texCoord": 1}}}},
    {"normalTexture": {"index": 0},
     "extensions": {"KHR_materials_anisotropy": {"anisotropyTexture": {"index": 0, "texCoord": 1}}}}])");
  for (std::size_t m = 0; m < 4; ++m) b.primitive(attributes, {{"material", m}});
  const Rewritten r = rewrite(b);
  for (std::size_t p = 1; p < 5; ++p) {
    const Json& json = r.after.json["meshes"][0]["primitives"][p];
    const auto t = test::corner_floats<4>(r.after, json, json["attributes"]["TANGENT"]).at(0);
    EXPECT_EQ(t, (p < 4 ? std::array{0.0f, 1.0f, 0.0f, 1.0f} : std::array{1.0f, 0.0f, 0.0f, -1.0f})) << p;
  }
}

// What reads the frame reads the uvs after its KHR_texture_transform. The formula is the extension's:
// translation rotation scale uv, with columns (cos, -sin) and (sin, cos) of the rotation.
TEST(FileTangents, FollowTheTransformOfTheTextureThatReadsThem) {
  const double angle = 0.7, c = std::cos(angle), s = std::sin(angle);
  const double scale[] = {-2, 0.5}, offset[] = {0.25, -3};  // mirrored: w turns too
  const auto by_hand = [&](double u, double v) {
    return std::array{static_cast<float>(c * scale[0] * u + s * scale[1] * v + offset[0]),
                      static_cast<float>(-s * scale[0] * u + c * scale[1] * v + offset[1])};
  };
  // Four triangles about a vertex off the plane, sheared uvs; a morph target that moves uvs.
  const std::vector<float> uvs{0, 0, 1, 0.1f, 1.2f, 1, 0, 0.9f, 0.4f, 0.6f};
  const std::vector<float> moves{0, 0, 0.5f, 0, 0, 0.25f, 0, 0, 0.125f, 0.25f};
  std::vector<float> hand, hand_moves;
  for (std::size_t i = 0; i < uvs.size(); i += 2) {
    const auto at = by_hand(uvs[i], uvs[i + 1]);
    const auto moved = by_hand(double(uvs[i]) + moves[i], double(uvs[i + 1]) + moves[i + 1]);
    for (std::size_t k = 0; k < 2; ++k) hand.push_back(at[k]), hand_moves.push_back(moved[k] - at[k]);
  }
  const auto file = [&](const std::vector<float>& of, const std::vector<float>& moved, const Json& material) {
    Builder b;
    const auto packed = [&](const std::vector<float>& values) {
      const std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
      return b.accessor("VEC2", 5126, 5, {{"bufferView", b.view(bytes)}});
    };
    b.primitive(
        {{"POSITION", b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5f, 0.5f, 0.5f})},
         {"NORMAL", b.packed<float>("VEC3", 5126, 5, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})},
         {"TEXCOORD_0", packed(uvs)},
         {"TEXCOORD_1", packed(of)}},
        {{"indices", b.packed<std::uint16_t>("SCALAR", 5123, 12, {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4})},
         {"targets", {{{"TEXCOORD_1", packed(moved)}}}},
         {"material", 0}});
    b.json["materials"] = Json::array({material});
    return b;
  };
  const auto tangents = [&](const Builder& b) {
    const Rewritten r = rewrite(b);
    const Json& json = r.after.json["meshes"][0]["primitives"][0];
    std::vector<float> values;
    for (const auto& t : test::corner_floats<4>(r.after, json, json["attributes"]["TANGENT"]))
      values.insert(values.end(), t.begin(), t.end());
    for (const auto& t : test::corner_floats<3>(r.after, json, json["targets"][0]["TANGENT"]))
      values.insert(values.end(), t.begin(), t.end());
    return values;
  };
  const auto texture = [](const Json& transform) {
    return Json{{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}};
  };
  const Json transform{{"offset", offset}, {"rotation", angle}, {"scale", scale}, {"texCoord", 1}};
  const Json turned = texture(transform), plain{{"index", 0}, {"texCoord", 1}};
  const auto extension = [](const char* name, const char* property, const Json& value) {
    return Json{{"extensions", {{name, {{property, value}}}}}};
  };
  const auto expected = tangents(file(hand, hand_moves, {{"normalTexture", plain}}));
  const auto untransformed = tangents(file(uvs, moves, {{"normalTexture", plain}}));
  EXPECT_NE(expected, untransformed);
  for (const Json& material : {Json{{"normalTexture", turned}},
                               extension("KHR_materials_clearcoat", "clearcoatNormalTexture", turned),
                               extension("KHR_materials_anisotropy", "anisotropyTexture", turned)}) {
    const auto got = tangents(file(uvs, moves, material));
    ASSERT_EQ(got.size(), expected.size());
    // The uvs by hand are rounded to float twice, base and delta; a float's last bit of uvs up to 4, over
    // edges of 0.2 and more.
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], expected[i], 4 * 1.2e-7 / 0.2) << i;
  }
  // The first texture decides; a transform that leaves no direction is not applied.
  Json both = extension("KHR_materials_clearcoat", "clearcoatNormalTexture", turned);
  both["normalTexture"] = plain;
  EXPECT_EQ(tangents(file(uvs, moves, both)), untransformed);
  Json flat = transform;
  flat["scale"] = {0, 1};
  EXPECT_EQ(tangents(file(uvs, moves, {{"normalTexture", texture(flat)}})), untransformed);
}

// ---- the document's own functions

#define EXPECT_MESH_REFUSED(statement, words) \
  EXPECT_NE(test::refusal_of<MeshError>([&] { statement; }).find(words), std::string::npos)

TEST(SetTangents, DeltasThatDoNotFitAreRefused) {
  const TempFolder folder;
  GltfDocument document =
      GltfDocument::load(test::write_bytes(folder / "in.glb", test::generated_gltf().glb()));
  const std::vector<Vec4<float>> tangents(9, {1, 0, 0, 1});
  const std::vector<std::vector<Vec3<float>>> one(1, std::vector<Vec3<float>>(9)),
      small(2, std::vector<Vec3<float>>(8)), good(2, std::vector<Vec3<float>>(9));
  EXPECT_MESH_REFUSED(document.set_tangents(0, 0, tangents, one),
                      "expected one list of deltas per morph target, 2, got 1");
  EXPECT_MESH_REFUSED(document.set_tangents(0, 0, tangents, small),
                      "expected one delta per vertex, 9, got 8");
  EXPECT_MESH_REFUSED(document.set_tangents(1, 0, tangents, one),
                      "expected one list of deltas per morph target, 0, got 1");
  document.set_tangents(0, 0, tangents, good);
}

}  // namespace
}  // namespace darboux::file_tangents_test
