// Meshes that are cut into primitives, one per material.
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <darboux/frame.h>

#include "base/base64.h"
#include "cli.h"

namespace darboux::test::primitives_test {
namespace {

using V = Vec3<double>;

// The six sides of a cube, each a quad of its own with the uvs [0, 1]², in as many primitives of one mesh.
// Normals are radial, as smooth shading has them; tangents are MikkTSpace's: in each corner along u.
struct SmoothCube {
  std::string buffer;
  Json gltf, primitives = Json::array();

  std::size_t accessor(const std::vector<float>& numbers, const char* type, std::size_t components) {
    std::string bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
    gltf["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    buffer += bytes;
    gltf["accessors"].push_back({{"bufferView", gltf["bufferViews"].size() - 1},
                                 {"componentType", 5126},
                                 {"count", numbers.size() / components},
                                 {"type", type}});
    return gltf["accessors"].size() - 1;
  }

  SmoothCube() {
    const std::array<V, 3> axes{V{1, 0, 0}, V{0, 1, 0}, V{0, 0, 1}};
    for (std::size_t side = 0; side < 6; ++side) {
      const V c = (side < 3 ? 1.0 : -1.0) * axes[side % 3], a = axes[(side + 1) % 3], b = cross(c, a);
      std::vector<float> positions, normals, uvs, tangents;
      const auto add = [](std::vector<float>& to, const V& x) {
        for (const double k : {x.x, x.y, x.z}) to.push_back(static_cast<float>(k));
      };
      for (const auto& [u, v] : {std::array{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
        const V p = c + (2.0 * u - 1) * a + (2.0 * v - 1) * b, n = unit(p);
        add(positions, p);
        add(normals, n);
        uvs.insert(uvs.end(), {static_cast<float>(u), static_cast<float>(1 - v)});
        add(tangents, unit(a - dot(a, n) * n));
        tangents.push_back(1);
      }
      primitives.push_back({{"attributes",
                             {{"POSITION", accessor(positions, "VEC3", 3)},
                              {"NORMAL", accessor(normals, "VEC3", 3)},
                              {"TEXCOORD_0", accessor(uvs, "VEC2", 2)},
                              {"TANGENT", accessor(tangents, "VEC4", 4)}}}});
    }
  }

  // \param meshes lists of primitives
  void write(const std::string& path, const std::vector<Json>& meshes) {
    gltf["asset"]["version"] = "2.0";
    gltf["meshes"] = Json::array();
    for (const Json& of_mesh : meshes) gltf["meshes"].emplace_back()["primitives"] = of_mesh;
    Json& only = gltf["buffers"][0];
    only["byteLength"] = buffer.size();
    only["uri"] = "data:application/octet-stream;base64," + base64(buffer);
    std::ofstream(path) << gltf;
  }
};

TEST_F(Cli, ASmoothMeshOfManyMaterialsPasses) {
  SmoothCube cube;
  cube.write(path("cube.gltf"), {cube.primitives});
  const Json document = json("darboux validate cube.gltf --json");
  EXPECT_EQ(document["verdict"], "pass");
  for (const Json& mesh : document["files"][0]["meshes"])
    for (const Json& finding : mesh["findings"]) EXPECT_EQ(finding["severity"], "info") << finding;
  // Each alone, in a mesh of its own, is judged by its only triangles.
  std::vector<Json> alone;
  for (const Json& primitive : cube.primitives) alone.push_back(Json::array({primitive}));
  cube.write(path("sides.gltf"), alone);
  EXPECT_NE(json("darboux validate sides.gltf --json", 1)["verdict"], "pass");
}

}  // namespace
}  // namespace darboux::test::primitives_test
