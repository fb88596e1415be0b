// Tangents of meshes whose numbers lie in the file as floats: the same bits as by way of doubles, and no
// copy.
#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <darboux/file_tangents.h>
#include <darboux/mesh_frames.h>

#include "generated_gltf.h"
#include "gltf_corners.h"
#include "io/files.h"
#include "io/float_mesh.h"
#include "rewritten.h"

namespace darboux::floats_in_place_test {
namespace {

using test::Builder;
using test::Json;
using test::rewrite;
using test::Rewritten;
using test::TempFolder;

// Random triangles on few vertices, some degenerate in space or in the uvs, some normals of no length or
// along dpdu; numbers stored as `stride` and `offset` say, indices of `index_type`, 0: none.
Builder random_triangles(unsigned seed, std::size_t stride, std::size_t offset, int index_type,
                         std::size_t corners) {
  std::mt19937 random(seed);
  const auto pick = [&](std::initializer_list<float> list) { return list.begin()[random() % list.size()]; };
  Builder b;
  const std::size_t vertices = index_type == 0 ? corners : 40;
  const auto attribute = [&](std::size_t n, std::initializer_list<float> values) {
    const std::size_t step = stride == 0 ? 4 * n : stride;
    std::string bytes(offset, '\0');
    for (std::size_t v = 0; v < vertices; ++v) {
      for (std::size_t k = 0; k < n; ++k) bytes += test::pack({pick(values)});
      bytes.append(step - 4 * n, '\0');
    }
    Json view = Json::object(), more{{"byteOffset", offset}};
    if (stride != 0) view["byteStride"] = stride;
    more["bufferView"] = b.view(bytes, view);
    return b.accessor("VEC" + std::to_string(n), 5126, vertices, more);
  };
  Json attributes;
  attributes["POSITION"] = attribute(3, {0, 1, -1, 0.25F, 3, 1e-20F});
  attributes["NORMAL"] = attribute(3, {0, -0.0F, 1, -1, 0.5F});
  attributes["TEXCOORD_0"] = attribute(2, {0, 1, 0.5F, 2, -0.0F});
  Json more = Json::object();
  if (index_type != 0) {
    std::string bytes;
    for (std::size_t c = 0; c < corners; ++c) {
      const auto v = static_cast<std::uint32_t>(random() % vertices);
      bytes += index_type == 5125 ? test::pack({v}) : test::pack({static_cast<std::uint16_t>(v)});
    }
    more["indices"] = b.accessor("SCALAR", index_type, corners, {{"bufferView", b.view(bytes)}});
  }
  b.primitive(attributes, more);
  return b;
}

// What the file got is what mesh_frames() gives its doubles, and so are the counts.
void expect_mesh_frames(const std::string& path, SignConvention sign) {
  const Mesh mesh = read_asset(path).primitives.at(0).data;
  const MeshFrames frames = mesh_frames(mesh, find_frame_method("mikktspace"));
  FileTangentOptions options;
  options.sign = sign;
  const Rewritten r = rewrite(path, options);
  const PrimitiveTangents& made = r.report.primitives.at(0);
  EXPECT_EQ(made.corners, mesh.corners());
  EXPECT_EQ(made.old_vertices, mesh.positions.size());
  EXPECT_EQ(made.degenerate_triangles, frames.degenerate_triangles);
  EXPECT_EQ(made.degenerate_uv_triangles, frames.degenerate_uv_triangles);
  EXPECT_EQ(made.fallback_corners, frames.fallback_corners);
  const Json& json = r.after.json["meshes"][0]["primitives"][0];
  const auto tangents = test::corner_floats<4>(r.after, json, json["attributes"]["TANGENT"]);
  ASSERT_EQ(tangents.size() / 3 * 3, mesh.corners());
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const CornerFrame& f = frames.corner(c);
    const double w = sign == SignConvention::raw ? f.sign : -f.sign;
    const std::array expected{static_cast<float>(f.t.x), static_cast<float>(f.t.y), static_cast<float>(f.t.z),
                              static_cast<float>(w)};
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(tangents[c][k]), std::bit_cast<std::uint32_t>(expected[k]))
          << "corner " << c << " component " << k;
  }
}

TEST(FloatsInPlace, FloatsThatLieInTheFileGiveTheSameBits) {
  const TempFolder folder;
  std::size_t fallbacks = 0, split = 0;
  for (unsigned seed = 1; seed <= 20; ++seed)
    for (const int index_type : {0, 5123, 5125})
      for (const auto& [stride, offset] :
           {std::pair<std::size_t, std::size_t>{0, 0}, {0, 8}, {16, 0}, {20, 4}})
        for (const std::size_t corners : {300u, 3u, 301u, 302u}) {
          const Builder b = random_triangles(seed, stride, offset, index_type, corners);
          SCOPED_TRACE("seed " + std::to_string(seed) + ", indices " + std::to_string(index_type) +
                       ", stride " + std::to_string(stride) + ", offset " + std::to_string(offset) +
                       ", corners " + std::to_string(corners));
          const std::string path = test::write_bytes(folder / "in.glb", b.glb());
          expect_mesh_frames(path, seed % 2 == 0 ? SignConvention::raw : SignConvention::gltf);
          const Rewritten r = rewrite(path);
          if (corners % 3 == 0)  // a new index list leaves out what is no whole triangle
            test::expect_only_tangents_changed(r.before, r.after, r.made());
          fallbacks += r.report.primitives[0].fallback_corners;
          split += r.report.primitives[0].vertices - r.report.primitives[0].old_vertices;
        }
  EXPECT_GT(fallbacks, 1000u) << "the rule for corners without a direction is not met";
  EXPECT_GT(split, 1000u);
}

// No triangle is degenerate: tangents go by vertex, and vertices are split at the mirror and about triangles
// that are turned over. One vertex is used by none.
TEST(FloatsInPlace, FloatsOfAMirroredGridGiveTheSameBits) {
  constexpr int columns = 8, rows = 6;
  const TempFolder folder;
  Builder b;
  std::string positions, normals, uvs, indices;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const auto x = static_cast<float>(i), y = static_cast<float>(j);
      positions += test::pack({x, y, 0.1F * x * y});
      normals += test::pack({0.0F, 0.0F, 1.0F});
      uvs += test::pack({std::fabs(x - 4), y});
    }
  positions += test::pack({9.0F, 9.0F, 9.0F}), normals += test::pack({0.0F, 0.0F, 1.0F});
  uvs += test::pack({0.0F, 0.0F});
  const auto at = [](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const bool over = (i + 3 * j) % 7 == 0;
      for (const std::uint32_t v : {at(i, j), at(i + 1, over ? j + 1 : j), at(i + 1, over ? j : j + 1)})
        indices += test::pack({v});
      for (const std::uint32_t v : {at(i, j), at(i + 1, j + 1), at(i, j + 1)}) indices += test::pack({v});
    }
  constexpr std::size_t vertices = (columns + 1) * (rows + 1) + 1;
  const auto attribute = [&](const std::string& bytes, const char* type) {
    return b.accessor(type, 5126, vertices, {{"bufferView", b.view(bytes)}});
  };
  const Json attributes{{"POSITION", attribute(positions, "VEC3")},
                        {"NORMAL", attribute(normals, "VEC3")},
                        {"TEXCOORD_0", attribute(uvs, "VEC2")}};
  b.primitive(
      attributes,
      {{"indices", b.accessor("SCALAR", 5125, 6 * columns * rows, {{"bufferView", b.view(indices)}})}});
  const std::string path = test::write_bytes(folder / "in.glb", b.glb());
  for (const SignConvention sign : {SignConvention::raw, SignConvention::gltf})
    expect_mesh_frames(path, sign);
  const Rewritten r = rewrite(path);
  test::expect_only_tangents_changed(r.before, r.after, r.made());
  EXPECT_GT(r.report.primitives[0].vertices, vertices + 5);
}

// Where they lie is where they are read; numbers beside others, or not at multiples of four bytes, are
// copied.
TEST(FloatsInPlace, FloatsAreReadWhereTheyLie) {
  const TempFolder folder;
  const auto lies_in_the_file = [&](std::size_t stride, std::size_t offset) {
    Builder b = random_triangles(7, stride, offset, 5125, 300);
    if (offset == 2)
      for (Json& accessor : b.json["accessors"])
        if (accessor["componentType"] == 5126) accessor["byteOffset"] = 2;
    const std::string path = test::write_bytes(folder / "in.glb", b.glb());
    const GltfFile file = io::load_gltf(path, io::map_file(path), {});
    Primitive primitive;
    const auto mesh = io::read_float_mesh(
        file, io::JsonCursor(path, file.json["meshes"][0]["primitives"][0], "meshes[0].primitives[0]"),
        io::triangles, primitive);
    EXPECT_TRUE(mesh);
    if (!mesh) return false;
    const std::string_view bytes = file.buffers.at(0).value().pieces().at(0).bytes;
    const auto* const first = reinterpret_cast<const char*>(mesh->positions.span().data());
    return bytes.data() <= first && first < bytes.data() + bytes.size();
  };
  EXPECT_TRUE(lies_in_the_file(0, 0));
  EXPECT_FALSE(lies_in_the_file(16, 0));
  EXPECT_FALSE(lies_in_the_file(0, 2));
}

// A GLB whose numbers do not lie at multiples of four bytes, as glTF forbids and files have.
TEST(FloatsInPlace, FloatsThatAreNotAlignedAreCopied) {
  const TempFolder folder;
  Builder b = random_triangles(7, 0, 2, 0, 300);
  for (Json& accessor : b.json["accessors"]) accessor["byteOffset"] = 2;
  expect_mesh_frames(test::write_bytes(folder / "in.glb", b.glb()), SignConvention::gltf);
}

}  // namespace
}  // namespace darboux::floats_in_place_test
