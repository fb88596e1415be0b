// The uv sets of a primitive: which are read, and that tangents which follow another than the one assessed by
// are named.
#include <cmath>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/error.h>
#include <darboux/io.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/vertex_normals.h>

#include "append_mesh.h"
#include "fbx_files.h"
#include "refusal_of.h"

namespace darboux::uv_sets_test {
namespace {

using Uvs = std::vector<Vec2<double>>;

// Turned by 45 degrees.
Uvs turned(const Uvs& uvs) {
  Uvs result;
  for (const Vec2<double>& uv : uvs) result.push_back({0.7 * uv.x - 0.7 * uv.y, 0.7 * uv.x + 0.7 * uv.y});
  return result;
}

// MikkTSpace's tangents under these uvs, with glTF's sign.
void bake(Mesh& mesh, const Uvs& uvs) {
  Mesh under = mesh;
  under.uvs = uvs;
  const MeshFrames frames = mesh_frames(under, find_frame_method("mikktspace"));
  mesh.tangents.resize(mesh.positions.size());
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const CornerFrame& f = frames.corner(c);
    mesh.tangents[mesh.triangles[c / 3][c % 3]] = {f.t.x, f.t.y, f.t.z, -f.sign};
  }
}

Mesh torus_along(bool other) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 48, .rows = 24});
  bake(mesh, other ? turned(mesh.uvs) : mesh.uvs);
  return mesh;
}

// A GLB with more sets, as they come.
std::string glb(const Mesh& mesh, const std::vector<std::pair<std::string, Uvs>>& more) {
  const test::TempFolder folder;
  write_glb(folder / "a.glb", mesh, "mesh");
  test::Glb parts = test::split_glb(test::read_bytes(folder / "a.glb"));
  for (const auto& [name, uvs] : more) {
    const std::size_t offset = parts.bin.size();
    for (const Vec2<double>& uv : uvs)
      parts.bin += test::pack({static_cast<float>(uv.x), static_cast<float>(uv.y)});
    parts.json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", parts.bin.size() - offset}});
    parts.json["accessors"].push_back({{"bufferView", parts.json["bufferViews"].size() - 1},
                                       {"componentType", 5126},
                                       {"count", uvs.size()},
                                       {"type", "VEC2"}});
    parts.json["meshes"][0]["primitives"][0]["attributes"][name] = parts.json["accessors"].size() - 1;
  }
  parts.json["buffers"][0]["byteLength"] = parts.bin.size();
  return test::make_glb(parts.json.dump(), parts.bin);
}

Primitive read(const std::string& name, const std::string& bytes) {
  const test::TempFolder folder;
  return read_asset(test::write_bytes(folder / name, bytes)).primitives.at(0);
}

std::vector<Assessment> assess_with(const Mesh& mesh, const std::vector<std::pair<int, Uvs>>& sets) {
  AssessOptions options;
  options.other_uvs = sets;
  return assess_parts(mesh, options);
}

// The message of the finding, empty where there is none.
std::string uv_set_finding(const Assessment& assessment) {
  for (const Finding& f : assessment.report.findings)
    if (f.code == "TANGENT_UV_SET") return f.message;
  return "";
}

TEST(UvSets, TangentsThatFollowAnotherAreNamed) {
  for (const bool other : {false, true}) {
    const Mesh mesh = torus_along(other);
    const Uvs second = turned(mesh.uvs);
    for (const auto& [name, bytes] : {std::pair{std::string("a.glb"), glb(mesh, {{"TEXCOORD_1", second}})},
                                      {"a.dae", test::dae_text(mesh, {second})},
                                      {"a.fbx", test::fbx_text(mesh, {second})}}) {
      SCOPED_TRACE(name);
      const Primitive primitive = read(name, bytes);
      EXPECT_EQ(primitive.texcoord, 0);
      ASSERT_EQ(primitive.other_uvs.size(), 1u);
      EXPECT_EQ(primitive.other_uvs[0].first, 1);
      EXPECT_EQ(primitive.other_uvs[0].second.size(), primitive.data.positions.size());
      const std::vector<Assessment> assessments = assess_with(primitive.data, primitive.other_uvs);
      ASSERT_EQ(assessments.size(), 1u);
      EXPECT_EQ(assessments[0].report.verdict, other ? Verdict::fail : Verdict::pass);
      EXPECT_EQ(uv_set_finding(assessments[0]).find("TEXCOORD_1") != std::string::npos, other)
          << uv_set_finding(assessments[0]);
      EXPECT_EQ(uv_set_finding(assessments[0]).empty(), !other);
    }
  }
}

// A coarse mesh's cones are wide: most hold the tangents that follow the transformed uvs too, so that cones
// alone do not tell which they follow.
TEST(UvSets, TangentsMayFollowTheTextureTransform) {
  for (const auto& [columns, rows] : {std::pair{16, 8}, {24, 12}, {48, 24}})
    for (const double angle : {0.15, 0.3, 0.5, 0.8, 2.5}) {
      SCOPED_TRACE(std::to_string(columns) + " columns, turned by " + std::to_string(angle));
      Mesh mesh = sample_mesh(make_surface("torus"), {.columns = columns, .rows = rows});
      AssessOptions options;
      const double c = std::cos(angle), s = std::sin(angle);
      options.texture_transform = {c, s, -s, c, 0, 0};
      const auto assessed = [&] {
        const std::vector<Assessment> assessments = assess_parts(mesh, options);
        bool transformed = false, angles = false;
        for (const Finding& f : assessments.front().report.findings) {
          transformed = transformed || f.code == "TANGENT_TEXTURE_TRANSFORM";
          angles = angles || f.code == "TANGENT_ANGLE";
        }
        EXPECT_EQ(assessments.front().report.verdict, Verdict::pass);
        EXPECT_FALSE(angles);
        return transformed;
      };
      EXPECT_FALSE(assessed());
      for (Vec2<double>& uv : mesh.uvs) uv = {c * uv.x - s * uv.y, s * uv.x + c * uv.y};
      EXPECT_TRUE(assessed());
    }
}

// t is the same before and after v is mirrored: w alone tells which of both it follows.
TEST(UvSets, SignsMayFollowATransformThatMirrorsV) {
  Mesh wave = sample_mesh(make_surface("plane"), {.columns = 12, .rows = 12});
  for (auto& p : wave.positions) p.z = std::sin(5 * p.x) + 0.7 * std::cos(4 * p.y + p.x);
  wave.normals = vertex_normals(wave, NormalWeight::angle);
  bake(wave, wave.uvs);
  for (const Mesh& mesh : {torus_along(false), wave})
    for (const bool mirrored : {false, true})
      for (const bool negated : {false, true}) {
        Mesh signs = mesh;
        if (negated)
          for (auto& t : signs.tangents) t.w = -t.w;
        AssessOptions options;
        options.texture_transform = {1, 0, 0, mirrored ? -1. : 1., 0, 1};
        std::string codes;
        const MeshReport report = assess_parts(signs, options).front().report;
        for (const Finding& f : report.findings)
          if (f.code.starts_with("TANGENT_")) codes += f.code;
        EXPECT_EQ(report.verdict, Verdict::pass);
        EXPECT_EQ(codes, !negated   ? ""
                         : mirrored ? "TANGENT_TEXTURE_TRANSFORM"
                                    : "TANGENT_HANDEDNESS_CONVENTION")
            << mirrored << negated;
      }
}

TEST(UvSets, OthersAreReadOnlyWhereTangentsMayFollowThem) {
  Mesh mesh = torus_along(false);
  const Uvs second = turned(mesh.uvs);
  const std::vector<std::pair<std::string, Uvs>> sets{
      {"TEXCOORD_1", second}, {"TEXCOORD_3", mesh.uvs}, {"TEXCOORD_8", second}};
  const Primitive primitive = read("a.glb", glb(mesh, sets));
  ASSERT_EQ(primitive.other_uvs.size(), 2u);  // of eight
  EXPECT_EQ(primitive.other_uvs[1].first, 3);
  EXPECT_EQ(primitive.other_uvs[1].second, primitive.data.uvs);
  mesh.tangents.clear();
  EXPECT_TRUE(read("a.glb", glb(mesh, sets)).other_uvs.empty());
  EXPECT_TRUE(read("a.dae", test::dae_text(mesh, {second})).other_uvs.empty());
  EXPECT_TRUE(read("a.fbx", test::fbx_text(mesh, {second})).other_uvs.empty());
}

// Of several surfaces in one mesh, each part is assessed with its own share of the other set, whatever the
// order of vertices.
TEST(UvSets, PartsHaveTheirShare) {
  Mesh both = torus_along(true);
  Mesh sphere = sample_mesh(make_surface("sphere:radius=3"), {.columns = 48, .rows = 24});
  bake(sphere, turned(sphere.uvs));
  append(both, sphere);
  std::reverse(both.triangles.begin(), both.triangles.end());
  const std::vector<Assessment> assessments = assess_with(both, {{2, turned(both.uvs)}});
  ASSERT_EQ(assessments.size(), 2u);
  for (const Assessment& j : assessments) {
    EXPECT_TRUE(j.part);
    EXPECT_NE(uv_set_finding(j).find("TEXCOORD_2"), std::string::npos);
  }
}

TEST(UvSets, AnotherNumberOfUvsIsRefused) {
  const Mesh mesh = torus_along(false);
  Uvs few = mesh.uvs;
  few.pop_back();
  const std::string refusal = test::refusal_of<MeshError>([&] { assess_with(mesh, {{1, few}}); });
  EXPECT_NE(refusal.find("uv set 1 has " + std::to_string(few.size())), std::string::npos) << refusal;
}

}  // namespace
}  // namespace darboux::uv_sets_test
