/// \file io_files.h
/// What the tests of the file formats share: a folder of their own, and glTF files made by hand.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <stdlib.h>

namespace darboux::test {

using Json = nlohmann::ordered_json;

/// A new empty folder that goes away with the object.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "darboux_io_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  ~TempFolder() { std::filesystem::remove_all(path_); }

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline std::string write_bytes(const std::string& path, std::string_view bytes) {
  std::filesystem::remove(path);  // some file systems are slow to truncate
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  EXPECT_TRUE(stream.flush()) << path;
  return path;
}

template <class T>
std::string pack(std::initializer_list<T> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(T)};
}

inline std::uint32_t u32_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// A GLB of these two chunks, put together independently of the library's writer.
inline std::string make_glb(std::string json, std::string bin) {
  while (json.size() % 4 != 0) json += ' ';
  while (bin.size() % 4 != 0) bin += '\0';
  const auto u32 = [](std::size_t n) { return pack({static_cast<std::uint32_t>(n)}); };
  const std::string bin_chunk = bin.empty() ? "" : u32(bin.size()) + std::string("BIN\0", 4) + bin;
  return "glTF" + u32(2) + u32(20 + json.size() + bin_chunk.size()) + u32(json.size()) + "JSON" + json +
         bin_chunk;
}

/// The two chunks of a GLB, found by hand.
struct Glb {
  Json json;
  std::string bin;
};
inline Glb split_glb(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(u32_at(bytes, 4), 2u);
  EXPECT_EQ(u32_at(bytes, 8), bytes.size());
  const std::size_t length = u32_at(bytes, 12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(length % 4, 0u);
  Glb glb{Json::parse(bytes.substr(20, length)), {}};
  if (20 + length < bytes.size()) {
    EXPECT_EQ(bytes.substr(24 + length, 4), std::string("BIN\0", 4));
    EXPECT_EQ(u32_at(bytes, 20 + length) % 4, 0u);
    glb.bin = bytes.substr(28 + length, u32_at(bytes, 20 + length));
  }
  return glb;
}

/// A document over one buffer, grown piece by piece.
struct Builder {
  Json json = Json::parse(R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 0}], "bufferViews": [],
                              "accessors": [], "meshes": [{"name": "made by hand", "primitives": []}]})");
  std::string bin;

  std::size_t view(const std::string& bytes, Json more = Json::object()) {
    while (bin.size() % 4 != 0) bin += '\0';
    more.update(Json{{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}});
    bin += bytes;
    json["buffers"][0]["byteLength"] = bin.size();
    json["bufferViews"].push_back(more);
    return json["bufferViews"].size() - 1;
  }
  std::size_t accessor(const std::string& type, int component_type, std::size_t count, Json more) {
    more.update(Json{{"type", type}, {"componentType", component_type}, {"count", count}});
    json["accessors"].push_back(more);
    return json["accessors"].size() - 1;
  }
  /// A tightly packed accessor with a bufferView of its own.
  template <class T>
  std::size_t packed(const std::string& type, int component_type, std::size_t count,
                     std::initializer_list<T> values, Json more = Json::object()) {
    more["bufferView"] = view(pack(values));
    return accessor(type, component_type, count, more);
  }
  std::size_t positions(std::initializer_list<float> values) {
    return packed<float>("VEC3", 5126, values.size() / 3, values);
  }
  Json& primitive(Json attributes, Json more = Json::object()) {
    more["attributes"] = std::move(attributes);
    json["meshes"][0]["primitives"].push_back(more);
    return json["meshes"][0]["primitives"].back();
  }
  std::string glb() const { return make_glb(json.dump(), bin); }
};

inline Builder one_triangle() {
  Builder b;
  b.primitive({{"POSITION", b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}});
  return b;
}

}  // namespace darboux::test
