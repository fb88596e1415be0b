/// \file gltf_corners.h
/// What a GLB says of each corner of its triangles, read independently of the library, and whether a
/// rewritten one says the same.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "io_files.h"

namespace darboux::test {

/// The bytes of each element of an accessor, strides removed and sparse values laid over. No matrices.
inline std::vector<std::string> elements(const Glb& glb, std::size_t index) {
  const Json& accessor = glb.json.at("accessors").at(index);
  const auto bytes_of = [](int type) { return type <= 5121 ? 1U : type <= 5123 ? 2U : 4U; };
  const std::string type = accessor.at("type");
  const std::size_t size = bytes_of(accessor.at("componentType")) *
                           (type == "SCALAR" ? 1U : static_cast<std::size_t>(type.back() - '0'));
  const auto read = [&](const Json& from, std::size_t element_bytes, std::size_t count) {
    const Json& view = glb.json.at("bufferViews").at(from.at("bufferView").get<std::size_t>());
    const std::size_t offset = view.value("byteOffset", 0U) + from.value("byteOffset", 0U);
    const std::size_t stride = view.value("byteStride", element_bytes);
    std::vector<std::string> result;
    for (std::size_t i = 0; i < count; ++i)
      result.push_back(glb.bin.substr(offset + i * stride, element_bytes));
    return result;
  };
  const std::size_t count = accessor.at("count");
  std::vector<std::string> result = accessor.contains("bufferView")
                                        ? read(accessor, size, count)
                                        : std::vector<std::string>(count, std::string(size, '\0'));
  if (accessor.contains("sparse")) {
    const Json& sparse = accessor["sparse"];
    const std::size_t replaced = sparse.at("count");
    const auto places = read(sparse.at("indices"), bytes_of(sparse["indices"].at("componentType")), replaced);
    const auto values = read(sparse.at("values"), size, replaced);
    for (std::size_t i = 0; i < replaced; ++i) {
      std::uint32_t place = 0;
      std::memcpy(&place, places[i].data(), places[i].size());
      result.at(place) = values[i];
    }
  }
  return result;
}

/// The vertex of each corner: of triangle lists, and of strips and fans as glTF's section 3.7.2.1 unrolls
/// them.
inline std::vector<std::uint32_t> corner_vertices(const Glb& glb, const Json& primitive) {
  std::vector<std::uint32_t> list, corners;
  if (primitive.contains("indices")) {
    for (const std::string& bytes : elements(glb, primitive["indices"])) {
      std::uint32_t index = 0;
      std::memcpy(&index, bytes.data(), bytes.size());
      list.push_back(index);
    }
  } else {
    list.resize(elements(glb, primitive.at("attributes").at("POSITION")).size());
    for (std::uint32_t i = 0; i < list.size(); ++i) list[i] = i;
  }
  const int mode = primitive.value("mode", 4);
  if (mode == 4) return list;
  for (std::size_t i = 0; i + 2 < list.size(); ++i)
    for (const std::size_t k : mode == 6    ? std::array{i + 1, i + 2, std::size_t{0}}
                               : i % 2 == 0 ? std::array{i, i + 1, i + 2}
                                            : std::array{i, i + 2, i + 1})
      corners.push_back(list[k]);
  return corners;
}

/// The bytes of an attribute at each corner.
inline std::vector<std::string> corner_values(const Glb& glb, const Json& primitive, std::size_t accessor) {
  const auto values = elements(glb, accessor);
  std::vector<std::string> result;
  for (const std::uint32_t v : corner_vertices(glb, primitive)) result.push_back(values.at(v));
  return result;
}

/// The floats of an attribute at each corner, N each.
template <std::size_t N>
std::vector<std::array<float, N>> corner_floats(const Glb& glb, const Json& primitive, std::size_t accessor) {
  std::vector<std::array<float, N>> result;
  for (const std::string& bytes : corner_values(glb, primitive, accessor)) {
    EXPECT_EQ(bytes.size(), N * sizeof(float));
    std::memcpy(result.emplace_back().data(), bytes.data(), N * sizeof(float));
  }
  return result;
}

/// A set of attributes before and after: the same at every corner but for TANGENT, which may have come in
/// last. Puts the old references back into `after`.
inline void expect_same_attributes(const Glb& a, const Json& old_primitive, const Json& before, const Glb& b,
                                   const Json& new_primitive, Json& after) {
  for (const auto& [name, accessor] : before.items()) {
    ASSERT_TRUE(after.contains(name)) << name;
    if (name != "TANGENT") {
      EXPECT_EQ(corner_values(a, old_primitive, accessor), corner_values(b, new_primitive, after[name]))
          << name;
    }
    after[name] = accessor;
  }
  if (!before.contains("TANGENT")) {
    EXPECT_EQ(std::prev(after.end()).key(), "TANGENT");
    after.erase("TANGENT");
  }
}

/// Whether only the tangents of these primitives (mesh, primitive) were rewritten: old bytes first, the same
/// JSON values in the same order, and the same attributes, targets and triangles corner by corner.
inline void expect_only_tangents_changed(const Glb& before, const Glb& after,
                                         const std::vector<std::pair<std::size_t, std::size_t>>& rewritten) {
  EXPECT_TRUE(after.bin.starts_with(before.bin));
  Json json = after.json;
  for (const auto& [mesh, primitive] : rewritten) {
    SCOPED_TRACE("mesh " + std::to_string(mesh) + " primitive " + std::to_string(primitive));
    const Json& old = before.json["meshes"][mesh]["primitives"][primitive];
    const Json& fresh = after.json["meshes"][mesh]["primitives"][primitive];
    Json& restored = json["meshes"][mesh]["primitives"][primitive];
    expect_same_attributes(before, old, old["attributes"], after, fresh, restored["attributes"]);
    for (std::size_t k = 0; old.contains("targets") && k < old["targets"].size(); ++k)
      expect_same_attributes(before, old, old["targets"][k], after, fresh, restored["targets"][k]);
    for (const char* key : {"indices", "mode"})
      if (old.contains(key))
        restored[key] = old[key];
      else
        restored.erase(key);
    for (const auto& t : corner_floats<4>(after, fresh, fresh["attributes"]["TANGENT"])) {
      // As the Khronos validator asks: |t|² within 0.0005 of 1.
      EXPECT_NEAR(t[0] * t[0] + t[1] * t[1] + t[2] * t[2], 1, 0.0005);
      EXPECT_EQ(std::fabs(t[3]), 1);
    }
  }
  for (const char* key : {"accessors", "bufferViews"})
    while (json.contains(key) && json[key].size() > before.json[key].size())
      json[key].erase(json[key].size() - 1);
  json["buffers"][0]["byteLength"] = before.json["buffers"][0]["byteLength"];
  EXPECT_EQ(json.dump(), before.json.dump());
}

}  // namespace darboux::test
