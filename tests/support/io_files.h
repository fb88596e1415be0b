/// \file io_files.h
/// What the tests of the file formats share: a folder of their own, and glTF files made by hand. Compiled
/// once, in io_files.cpp: each use of the JSON library adds seconds to the build of every test that includes
/// it.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

NLOHMANN_JSON_NAMESPACE_BEGIN
void PrintTo(const ordered_json& json, std::ostream* out);  // for GoogleTest
NLOHMANN_JSON_NAMESPACE_END

namespace darboux::test {

using Json = nlohmann::ordered_json;

/// A new empty folder that goes away with the object.
class TempFolder {
 public:
  TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  ~TempFolder() { std::filesystem::remove_all(path_); }

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::size_t files() const;

 private:
  std::filesystem::path path_;
};

std::string read_bytes(const std::string& path);

std::string write_bytes(const std::string& path, std::string_view bytes);

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
std::string make_glb(std::string json, std::string bin);

/// The two chunks of a GLB, found by hand.
struct Glb {
  Json json;
  std::string bin;
};
Glb split_glb(const std::string& bytes);

/// A document over one buffer, grown piece by piece.
struct Builder {
  Builder();

  Json json;
  std::string bin;

  std::size_t view(const std::string& bytes, const Json& more = Json::object());
  std::size_t accessor(const std::string& type, int component_type, std::size_t count, Json more);
  /// A tightly packed accessor with a bufferView of its own.
  template <class T>
  std::size_t packed(const std::string& type, int component_type, std::size_t count,
                     const std::vector<T>& values, const Json& more = Json::object()) {
    const std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return packed_bytes(type, component_type, count, bytes, more);
  }
  std::size_t positions(std::initializer_list<float> values) {
    return packed<float>("VEC3", 5126, values.size() / 3, values);
  }
  Json& primitive(Json attributes, Json more = Json::object());
  std::string glb() const;

 private:
  std::size_t packed_bytes(const std::string& type, int component_type, std::size_t count,
                           const std::string& bytes, Json more);
};

Builder one_triangle();

}  // namespace darboux::test
