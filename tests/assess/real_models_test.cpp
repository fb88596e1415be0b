// Models of other people, ../shared/meshes/real: a correct file of somebody else's is never called wrong.
#include <cmath>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/frame.h>
#include <darboux/io.h>
#include <darboux/mesh_frames.h>

namespace darboux::real_models_test {
namespace {

const std::string folder = std::string(DARBOUX_SHARED) + "/meshes/real/";

class RealModels : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder))
      GTEST_SKIP() << "SKIPPED: " << folder << " is absent, its models are not judged";
  }
};

// Their normals are 90 degrees off; signs are mixed within islands; tangents are zero where uvs have area.
const std::set<std::string> wrong{"cube.saschawillems", "MosquitoInAmber.drx3d",
                                  "maya_tri_cone_7500_binary.ufbx"};

TEST_F(RealModels, OnlyThreeFail) {
  std::size_t files = 0;
  std::set<std::string> failed;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (std::ranges::find(asset_extensions(), extension) == asset_extensions().end()) continue;
    ++files;
    const std::string model = entry.path().parent_path().lexically_relative(folder).begin()->string();
    for (const Primitive& p : read_asset(entry.path().string()).primitives) {
      AssessOptions options;
      options.other_uvs = p.other_uvs;
      options.names_uv_set = p.names_uv_set;
      options.texture_transform = p.texture_transform;
      for (const Assessment& j : assess_parts(p.data, options)) {
        if (j.report.verdict != Verdict::fail) continue;
        failed.insert(model);
        EXPECT_TRUE(wrong.contains(model)) << entry.path() << ": " << j.report.findings.front().code << ' '
                                           << j.report.findings.front().message;
      }
    }
  }
  EXPECT_GE(files, 38u);
  EXPECT_EQ(failed, wrong);
}

// By hand: cos 80° = 0.17, and each normal's cosine with the cross product of each of its own triangles'
// edges is less, so that no triangle that has it supports it.
TEST_F(RealModels, TheCubesNormalsAreWrong) {
  const Asset asset = read_asset(folder + "cube.saschawillems/cube.gltf");
  ASSERT_EQ(asset.primitives.size(), 1u);
  const Mesh& mesh = asset.primitives[0].data;
  std::size_t off = 0;
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const auto& [i, j, k] = mesh.triangles[c / 3];
    const Vec3<double> face =
        unit(cross(mesh.positions[j] - mesh.positions[i], mesh.positions[k] - mesh.positions[i]));
    const double degrees =
        180 / std::numbers::pi * std::acos(dot(unit(mesh.normals[mesh.triangles[c / 3][c % 3]]), face));
    off += std::fabs(degrees - 90) < 0.5;
  }
  std::cout << off << " of " << mesh.corners() << " corners are 90 degrees off\n";
  EXPECT_EQ(off, 24u);
  EXPECT_EQ(mesh.corners(), 36u);
}

// By hand: two triangles that share an edge, with the same vertices there, whose uvs wind alike and whose w
// differ.
TEST_F(RealModels, TheMosquitosSignsAreMixed) {
  std::size_t mixed = 0;
  for (const Primitive& p : read_asset(folder + "MosquitoInAmber.drx3d/MosquitoInAmber.gltf").primitives) {
    const Mesh& mesh = p.data;
    if (mesh.tangents.empty() || mesh.uvs.empty()) continue;
    // Three vertices of one triangle with uv area need one sign.
    for (const auto& [a, b, c] : mesh.triangles) {
      const double area = signed_uv_area2(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]);
      if (std::fabs(area) > 1e-7)
        mixed += mesh.tangents[a].w != mesh.tangents[b].w || mesh.tangents[b].w != mesh.tangents[c].w;
    }
  }
  std::cout << mixed << " triangles have two signs\n";
  EXPECT_GT(mixed, 100u);
}

}  // namespace
}  // namespace darboux::real_models_test
