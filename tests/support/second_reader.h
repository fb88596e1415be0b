// glTF files as TinyGLTF reads them, held against what the library reads, bit for bit.
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/io.h>

#define TINYGLTF_NO_INCLUDE_JSON
#include <tiny_gltf.h>

namespace darboux::test {

inline std::uint32_t bits(double x) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(x));
}

inline bool ignore_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
                         const unsigned char*, int, void*) {
  return true;
}

inline tinygltf::Model load_second(const std::string& path) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(ignore_image, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  EXPECT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, path)) << error;
  EXPECT_EQ(error, "");
  EXPECT_EQ(warning, "");
  return model;
}

inline const unsigned char* bytes_of(const tinygltf::Model& model, int accessor, std::size_t element) {
  const auto& a = model.accessors.at(static_cast<std::size_t>(accessor));
  const auto& view = model.bufferViews.at(static_cast<std::size_t>(a.bufferView));
  return model.buffers.at(static_cast<std::size_t>(view.buffer)).data.data() + view.byteOffset +
         a.byteOffset + element * static_cast<std::size_t>(a.ByteStride(view));
}

inline std::vector<std::uint32_t> second_floats(const tinygltf::Model& model, int accessor_index) {
  const auto& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
  const auto components =
      static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
  EXPECT_EQ(accessor.componentType, TINYGLTF_COMPONENT_TYPE_FLOAT);
  std::vector<std::uint32_t> values(accessor.count * components);
  for (std::size_t i = 0; i < accessor.count; ++i)
    std::memcpy(&values[i * components], bytes_of(model, accessor_index, i), components * 4);
  return values;
}

inline std::vector<std::uint32_t> second_indices(const tinygltf::Model& model, int accessor_index) {
  const auto& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
  const bool narrow = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  EXPECT_TRUE(narrow || accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
  std::vector<std::uint32_t> values(accessor.count, 0);  // little endian
  for (std::size_t i = 0; i < accessor.count; ++i)
    std::memcpy(&values[i], bytes_of(model, accessor_index, i), narrow ? 2 : 4);
  return values;
}

inline std::vector<std::uint32_t> own_bits(const Mesh& mesh, const std::string& attribute, int texcoord) {
  std::vector<std::uint32_t> values;
  if (attribute == "POSITION")
    for (const auto& a : mesh.positions) values.insert(values.end(), {bits(a.x), bits(a.y), bits(a.z)});
  if (attribute == "NORMAL")
    for (const auto& a : mesh.normals) values.insert(values.end(), {bits(a.x), bits(a.y), bits(a.z)});
  if (attribute == "TEXCOORD_" + std::to_string(texcoord))
    for (const auto& a : mesh.uvs) values.insert(values.end(), {bits(a.x), bits(a.y)});
  if (attribute == "TANGENT")
    for (const auto& a : mesh.tangents)
      values.insert(values.end(), {bits(a.x), bits(a.y), bits(a.z), bits(a.w)});
  return values;
}

// Compares every attribute and index of a file as the library and as tinygltf read it.
inline void expect_second_reader_agrees(const std::string& path) {
  SCOPED_TRACE(path);
  const Asset asset = read_asset(path);
  const tinygltf::Model model = load_second(path);
  std::size_t count = 0, compared = 0;
  for (const auto& mesh : model.meshes) count += mesh.primitives.size();
  ASSERT_EQ(asset.primitives.size() + asset.skipped.size(), count);
  ASSERT_FALSE(asset.primitives.empty());
  for (const Primitive& own : asset.primitives) {
    const auto& second = model.meshes.at(own.mesh).primitives.at(own.primitive);
    EXPECT_EQ(own.name, model.meshes.at(own.mesh).name);
    for (const std::string attribute : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"}) {
      const auto found = second.attributes.find(attribute);
      const auto expected = found == second.attributes.end() ? std::vector<std::uint32_t>{}
                                                             : second_floats(model, found->second);
      EXPECT_EQ(own_bits(own.data, attribute, own.texcoord), expected) << attribute;
      compared += expected.size();
    }
    std::vector<std::uint32_t> indices;
    for (const Triangle& t : own.data.triangles) indices.insert(indices.end(), t.begin(), t.end());
    EXPECT_EQ(indices, second_indices(model, second.indices));
  }
  EXPECT_GT(compared, 0u);
}

}  // namespace darboux::test
