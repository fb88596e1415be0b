#include "io_files.h"

#include <fstream>
#include <iterator>

#include <stdlib.h>

NLOHMANN_JSON_NAMESPACE_BEGIN
void PrintTo(const ordered_json& json, std::ostream* out) {
  *out << json.dump();
}
NLOHMANN_JSON_NAMESPACE_END

namespace darboux::test {

TempFolder::TempFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "darboux_io_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

std::size_t TempFolder::files() const {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
}

std::string read_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string write_bytes(const std::string& path, std::string_view bytes) {
  std::filesystem::remove(path);  // some file systems are slow to truncate
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  EXPECT_TRUE(stream.flush()) << path;
  return path;
}

std::string make_glb(std::string json, std::string bin) {
  while (json.size() % 4 != 0) json += ' ';
  while (bin.size() % 4 != 0) bin += '\0';
  const auto u32 = [](std::size_t n) { return pack({static_cast<std::uint32_t>(n)}); };
  const std::string bin_chunk = bin.empty() ? "" : u32(bin.size()) + std::string("BIN\0", 4) + bin;
  return "glTF" + u32(2) + u32(20 + json.size() + bin_chunk.size()) + u32(json.size()) + "JSON" + json +
         bin_chunk;
}

Glb split_glb(const std::string& bytes) {
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

Builder::Builder()
    : json(Json::parse(R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 0}], "bufferViews": [],
                           "accessors": [], "meshes": [{"name": "made by hand", "primitives": []}]})")) {}

std::size_t Builder::view(const std::string& bytes, const Json& more) {
  while (bin.size() % 4 != 0) bin += '\0';
  Json view = more;
  view.update(Json{{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}});
  bin += bytes;
  json["buffers"][0]["byteLength"] = bin.size();
  json["bufferViews"].push_back(view);
  return json["bufferViews"].size() - 1;
}

std::size_t Builder::accessor(const std::string& type, int component_type, std::size_t count, Json more) {
  more.update(Json{{"type", type}, {"componentType", component_type}, {"count", count}});
  json["accessors"].push_back(more);
  return json["accessors"].size() - 1;
}

std::size_t Builder::packed_bytes(const std::string& type, int component_type, std::size_t count,
                                  const std::string& bytes, Json more) {
  more["bufferView"] = view(bytes);
  return accessor(type, component_type, count, more);
}

Json& Builder::primitive(Json attributes, Json more) {
  more["attributes"] = std::move(attributes);
  json["meshes"][0]["primitives"].push_back(more);
  return json["meshes"][0]["primitives"].back();
}

std::string Builder::glb() const {
  return make_glb(json.dump(), bin);
}

Builder one_triangle() {
  Builder b;
  b.primitive({{"POSITION", b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}});
  return b;
}

}  // namespace darboux::test
