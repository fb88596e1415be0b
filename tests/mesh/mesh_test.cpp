#include <functional>
#include <string>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/mesh.h>

namespace darboux::mesh_test {
namespace {

Mesh one_triangle() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TEST(CheckConsistent, AcceptsAbsentAndCompleteAttributes) {
  Mesh mesh = one_triangle();
  EXPECT_EQ(mesh.corners(), 3U);
  EXPECT_NO_THROW(check_consistent(mesh, "mesh"));
  mesh.normals.resize(3);
  mesh.uvs.resize(3);
  mesh.tangents.resize(3);
  EXPECT_NO_THROW(check_consistent(mesh, "mesh"));
  EXPECT_NO_THROW(check_consistent(Mesh{}, "empty"));
}

TEST(CheckConsistent, NamesTheMeshAndWhatIsWrong) {
  const auto message_after = [](const std::function<void(Mesh&)>& damage) -> std::string {
    Mesh mesh = one_triangle();
    damage(mesh);
    try {
      check_consistent(mesh, "part 7");
    } catch (const MeshError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message_after([](Mesh& m) { m.normals.resize(2); }),
            "part 7: expected no normals or one per position, 3, got 2");
  EXPECT_EQ(message_after([](Mesh& m) { m.uvs.resize(4); }),
            "part 7: expected no uvs or one per position, 3, got 4");
  EXPECT_EQ(message_after([](Mesh& m) { m.tangents.resize(1); }),
            "part 7: expected no tangents or one per position, 3, got 1");
  for (const std::uint32_t index : {3U, 4294967295U})
    EXPECT_EQ(message_after([&](Mesh& m) {
                m.triangles.push_back({0, index, 1});
              }),
              "part 7: triangle 1: expected indices below 3, got " + std::to_string(index));
}

}  // namespace
}  // namespace darboux::mesh_test
