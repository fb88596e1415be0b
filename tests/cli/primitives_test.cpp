// Meshes that are cut into primitives, one per material.
#include <array>
#include <cstddef>
#include <fstream>
#include <string>
#include <vector>

#include <darboux/frame.h>

#include "base/base64.h"
#include "cli.h"

namespace darboux::test::primitives_test {
namespace {

using V = Vec3<double>;

// A flat octahedron, each of its triangles a primitive. Normals are averages over all, as smooth shading has
// them: up to 87 degrees from a triangle's own.
struct SmoothOctahedron {
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

  SmoothOctahedron() {
    for (const double z : {0.05, -0.05})
      for (int k = 0; k < 4; ++k) {
        std::vector<float> positions, normals;
        const auto add = [&](const V& p) {
          for (const double x : {p.x, p.y, p.z}) positions.push_back(static_cast<float>(x));
          for (const double x : {p.x, p.y, p.z}) normals.push_back(static_cast<float>(x / norm(p)));
        };
        const std::array<V, 4> round{V{1, 0, 0}, V{0, 1, 0}, V{-1, 0, 0}, V{0, -1, 0}};
        const V a = round[static_cast<std::size_t>(k)], b = round[static_cast<std::size_t>((k + 1) % 4)];
        add(z > 0 ? a : b), add(z > 0 ? b : a), add({0, 0, z});
        Json attributes;
        attributes["POSITION"] = accessor(positions, "VEC3", 3);
        attributes["NORMAL"] = accessor(normals, "VEC3", 3);
        primitives.emplace_back()["attributes"] = attributes;
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

// How many findings are no notes.
std::size_t warnings(const Json& document) {
  std::size_t result = 0;
  for (const Json& mesh : document["files"][0]["meshes"])
    for (const Json& finding : mesh["findings"]) result += finding["severity"] != "info";
  return result;
}

TEST_F(Cli, ASmoothMeshOfManyMaterialsPasses) {
  SmoothOctahedron shape;
  shape.write(path("one.gltf"), {shape.primitives});
  const Json document = json("darboux validate one.gltf --json");
  EXPECT_EQ(document["verdict"], "pass");
  EXPECT_EQ(warnings(document), 0U) << document;
  // In meshes of their own the triangles alone judge.
  std::vector<Json> alone;
  for (const Json& primitive : shape.primitives) alone.push_back(Json::array({primitive}));
  shape.write(path("apart.gltf"), alone);
  EXPECT_GT(warnings(json("darboux validate apart.gltf --json")), 0U);
}

}  // namespace
}  // namespace darboux::test::primitives_test
