// Broken and hostile files: each is refused by a FileError of one line that names the file, what is wrong and
// what is expected. Nothing else may be thrown, and no count in a file may make the reader allocate more
// than it has.
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "refused_files.h"

namespace darboux::io_bad_files_test {
namespace {

using test::Builder;
using test::check_message;
using test::content_is_read;
using test::expect_bytes_refused;
using test::expect_refused;
using test::Json;
using test::TempFolder;

/// Everything a caller can do with a file; true when it was read. Errors of the library are fine, others are
/// not.
bool survives(const std::string& path) {
  try {
    GltfDocument document = GltfDocument::load(path);
    const Asset asset = document.asset();
    for (const Primitive& p : asset.primitives) {
      check_consistent(p.data, path);
      document.set_tangents(p.mesh, p.primitive, std::vector<Vec4<float>>(p.data.positions.size()));
      const std::vector<std::uint32_t> source = {0, 0, 0}, indices = {0, 1, 2};
      document.remap_vertices(p.mesh, p.primitive, source, indices);
    }
    document.save_glb(path + ".out");
    read_asset(path + ".out");
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return false;
  }
}

/// A small file with something of everything.
Builder rich() {
  Builder b;
  const auto position = b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  b.json["accessors"][position]["min"] = {0, 0, 0};
  b.json["accessors"][position]["max"] = {1, 1, 0};
  const auto view = b.view(test::pack<float>({0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 0}),
                           {{"byteStride", 20}});
  const auto normal = b.accessor("VEC3", 5126, 4, {{"bufferView", view}, {"byteOffset", 0}});
  const auto uv = b.accessor("VEC2", 5126, 4, {{"bufferView", view}, {"byteOffset", 12}});
  const auto sparse_indices = b.view(test::pack<std::uint16_t>({0, 1, 2, 3}));
  const auto sparse_values = b.view(test::pack<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}));
  const auto tangent =
      b.accessor("VEC4", 5126, 4,
                 {{"sparse",
                   {{"count", 4},
                    {"indices", {{"bufferView", sparse_indices}, {"byteOffset", 0}, {"componentType", 5123}}},
                    {"values", {{"bufferView", sparse_values}, {"byteOffset", 0}}}}}});
  const auto indices = b.packed<std::uint8_t>("SCALAR", 5121, 6, {0, 1, 2, 0, 2, 3});
  b.primitive({{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}, {"TANGENT", tangent}},
              {{"indices", indices}, {"mode", 4}, {"material", 0}});
  b.json["materials"] = Json::parse(R"([{"normalTexture": {"index": 0, "texCoord": 0}}])");
  b.json["nodes"] = Json::parse(
      R"([{"children": [1], "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]},
                                    {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])");
  b.json["scenes"] = Json::parse(R"([{"nodes": [0]}])");
  b.json["scene"] = 0;
  b.json["images"] = Json::parse(R"([{"uri": "none.png"}])");
  b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  return b;
}

// ---- the file and its container
// -------------------------------------------------------------------------------

TEST(BadFiles, NoFileAtAll) {
  const TempFolder folder;
  expect_refused(folder / "missing.glb", "expected a readable file, got no file of this name");
  expect_refused(folder / "missing/missing.glb", "expected a readable file, got no file of this name");
  std::filesystem::create_directory(folder / "folder.glb");
  expect_refused(folder / "folder.glb", "expected a file, got a folder");
  ASSERT_EQ(::mkfifo((folder / "pipe.glb").c_str(), 0600), 0);
  expect_refused(folder / "pipe.glb",
                 "expected a regular file, got a device or a pipe");  // and does not wait for a writer
  expect_refused("/dev/zero", "expected a regular file, got a device or a pipe");
  expect_refused("", "expected a readable file, got no file of this name");
}

TEST(BadFiles, Unreadable) {
  if (::geteuid() == 0) GTEST_SKIP() << "root reads every file: permissions are not tested";
  const TempFolder folder;
  const std::string path = test::write_bytes(folder / "secret.glb", rich().glb());
  ASSERT_EQ(::chmod(path.c_str(), 0), 0);
  expect_refused(path, "cannot be opened: expected a readable file, got Permission denied");
}

TEST(BadFiles, NotGltf) {
  for (const char* name : {"bad.glb", "bad.gltf"}) {
    expect_bytes_refused("", "got an empty file", name);
    expect_bytes_refused("hello", "expected a GLB, which begins \"glTF\", or a JSON object, got neither",
                         name);
    expect_bytes_refused("   \n", "expected a GLB, which begins \"glTF\", or a JSON object, got neither",
                         name);
    expect_bytes_refused("[]", "expected a GLB, which begins \"glTF\", or a JSON object, got neither", name);
    expect_bytes_refused("{", "expected JSON in UTF-8, got something else at byte", name);
    expect_bytes_refused("{} {}", "expected JSON in UTF-8, got something else at byte", name);
    expect_bytes_refused("{\"asset\": {\"version\": \"2.0\"}, \"\xFF\": 1}",
                         "expected JSON in UTF-8, got something else at byte", name);
    expect_bytes_refused("{\"asset\": {\"version\": \"\xC3\"}}",
                         "expected JSON in UTF-8, got something else at byte", name);
    expect_bytes_refused("{\"a\": 1e999}", "got '1e999'", name);
    expect_bytes_refused("{}", "the document: expected an object with asset, got one without", name);
    expect_bytes_refused("{\"asset\": 3}", "asset: expected an object, got 3", name);
    expect_bytes_refused("{\"asset\": {\"version\": 2.0}}", "asset.version: expected a text, got 2.0", name);
    expect_bytes_refused("{\"asset\": {\"version\": \"1.0\"}}",
                         "asset.version: expected glTF \"2.0\" or one of its minor versions, got \"1.0\"",
                         name);
    expect_bytes_refused("{\"asset\": {\"version\": \"2.1\", \"minVersion\": \"2.1\"}}",
                         "asset.minVersion: expected \"2.0\", got \"2.1\"", name);
  }
  expect_bytes_refused("ply\n", "expected a GLB by its content, or one of the extensions", "mesh.off");
  expect_bytes_refused("x", "expected a GLB by its content, or one of the extensions", "no_extension");
  expect_bytes_refused("1 2 3\n", "got \".xyz\", which holds points: darboux fit reads them", "scan.xyz");
}

// Line ends of Windows and a byte order mark are read; UTF-16, NUL bytes and numbers that JSON lacks are not.
TEST(BadFiles, TextInOtherClothes) {
  const TempFolder folder;
  Builder b = rich();
  b.json["buffers"][0]["uri"] = "a.bin";
  test::write_bytes(folder / "a.bin", b.bin);
  const std::string good = b.json.dump(2);
  std::string windows = "\xEF\xBB\xBF", wide = "\xFF\xFE";
  for (const char c : good) {
    windows += c == '\n' ? "\r\n" : std::string(1, c);
    wide += std::string{c, '\0'};
  }
  EXPECT_EQ(read_asset(test::write_bytes(folder / "windows.gltf", windows)).primitives.size(), 1u);
  const auto refuse = [&](const std::string& text, const std::string& part) {
    expect_refused(test::write_bytes(folder / "bad.gltf", text), part);
  };
  refuse(wide, "expected a GLB, which begins \"glTF\", or a JSON object, got neither");
  refuse(std::string(good).insert(good.size() / 2, 1, '\0'),
         "expected JSON in UTF-8, got something else at byte");
  for (const char* number : {"0x1p3", "1,5", "nan", "inf", "1e", "--1", "1_000", "01", "+1", ".5", "1e400"}) {
    std::string text = good;
    text.replace(text.find("\"translation\": ["), 16, std::string("\"translation\": [") + number + ",");
    refuse(text, number == std::string("1,5") ? "translation: expected 3 numbers, got 5" : "");
  }
}

TEST(BadFiles, TruncatedAtEveryByte) {
  const TempFolder folder;
  const std::string bytes = rich().glb();
  ASSERT_TRUE(survives(test::write_bytes(folder / "whole.glb", bytes)));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    SCOPED_TRACE("cut to " + std::to_string(length) + " bytes");
    EXPECT_FALSE(content_is_read(bytes.substr(0, length)));
    if (length < 12) continue;
    // The same cut under a header that agrees with it: now the chunks must notice. A cut between the chunks
    // leaves a sound container, whose buffer has no data.
    std::string agreed = bytes.substr(0, length);
    const auto stated = static_cast<std::uint32_t>(length);
    std::memcpy(agreed.data() + 8, &stated, 4);
    EXPECT_FALSE(content_is_read(agreed));
  }
}

TEST(BadFiles, LyingHeaders) {
  const std::string good = rich().glb();
  const auto with = [&](std::size_t at, std::uint32_t value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &value, 4);
    return bytes;
  };
  const std::uint32_t json_length = test::u32_at(good, 12);
  expect_bytes_refused(with(4, 1), "expected GLB version 2, got version 1");
  expect_bytes_refused(with(4, 3), "expected GLB version 2, got version 3");
  const std::string size = std::to_string(good.size());
  expect_bytes_refused(with(8, 0), "expected a stated length of at least 20 bytes, got 0");
  expect_bytes_refused(with(8, 19), "expected a stated length of at least 20 bytes, got 19");
  expect_bytes_refused(with(8, 0xFFFFFFFF), "expected the 4294967295 bytes that its header states, got " +
                                                size + ": the file is cut off");
  expect_bytes_refused(with(12, 0xFFFFFFFF), "chunk 0: expected at most the");
  expect_bytes_refused(with(12, static_cast<std::uint32_t>(good.size()) - 19),
                       "chunk 0: expected at most the");
  expect_bytes_refused(with(12, json_length - 4), "chunk 1: expected at most the");
  expect_bytes_refused(with(12, 0), "chunk 1: expected at most the");
  expect_bytes_refused(with(16, 0x004E4942), "expected the JSON chunk first, got another");
  expect_bytes_refused(with(20 + json_length, 0xFFFFFFFF), "chunk 1: expected at most the");
  expect_bytes_refused(with(20 + json_length, 4), "expected at most the");
  expect_bytes_refused(with(24 + json_length, 0x12345678),
                       "buffers[0]: expected a uri or, for buffer 0, the binary chunk of a GLB, got no data");
}

TEST(BadFiles, NestingBombs) {
  const auto deep = [](std::size_t levels, const char* open, const char* close) {
    std::string text = R"({"asset": {"version": "2.0"}, "extras": )";
    for (std::size_t i = 0; i < levels; ++i) text += open;
    text += "1";
    for (std::size_t i = 0; i < levels; ++i) text += close;
    return text + "}";
  };
  expect_bytes_refused(deep(1000000, "[", "]"), "expected JSON of at most 256 levels, got one more",
                       "bomb.gltf");
  expect_bytes_refused(deep(300, "{\"a\": ", "}"), "expected JSON of at most 256 levels, got one more",
                       "bomb.gltf");
  expect_bytes_refused(std::string(1000000, '['),
                       "expected a GLB, which begins \"glTF\", or a JSON object, got neither", "bomb.gltf");
  expect_bytes_refused(R"({"a": )" + std::string(1000000, '['),
                       "expected JSON of at most 256 levels, got one more", "bomb.gltf");
  std::string keys = "{";
  for (int i = 0; i < 20000; ++i) keys += "\"" + std::to_string(i) + "\": 0,";
  expect_bytes_refused(keys, "the object at byte 0 of the document: expected at most 10000 keys, got 20000",
                       "bomb.gltf");
  expect_bytes_refused(
      R"({"asset": {"version": "2.0"}, "extras": {"a\\": )" + keys.substr(0, keys.size() - 1) + "}}}",
      "the object at byte 48 of the document: expected at most 10000 keys, got 20000", "bomb.gltf");
  // Of a document, whose arrays are looked for most often.
  expect_bytes_refused(
      R"({"asset": {"version": "2.0"},)" + keys.substr(1, keys.find("\"1000\"") - 2) + "}",
      "the document: expected an object of at most 1000 keys, of which glTF defines 19, got 1001",
      "bomb.gltf");

  const TempFolder folder;
  const std::string path = test::write_bytes(folder / "fine.gltf", deep(200, "[", "]"));
  EXPECT_TRUE(survives(path));
}

// ---- the document
// ---------------------------------------------------------------------------------------------

struct Patch {
  const char* pointer;
  const char* value;  // JSON, or nullptr to take the entry away
  const char* message;
};

void expect_patch_refused(const Patch& patch) {
  SCOPED_TRACE(std::string(patch.pointer) + " = " + (patch.value != nullptr ? patch.value : "(taken away)"));
  Builder b = rich();
  const Json::json_pointer pointer(patch.pointer);
  if (patch.value != nullptr)
    b.json[pointer] = Json::parse(patch.value);
  else
    b.json[pointer.parent_pointer()].erase(pointer.back());
  expect_bytes_refused(b.glb(), patch.message);
}

TEST(BadFiles, Extensions) {
  // What is unknown and hangs on something with triangles may change them.
  for (const char* where :
       {"/bufferViews/0", "/accessors/0", "/buffers/0", "/meshes/0", "/meshes/0/primitives/0"}) {
    Builder b = rich();
    b.json["extensionsRequired"].push_back("KHR_meshopt_compression");
    b.json[Json::json_pointer(where)]["extensions"]["KHR_meshopt_compression"] = Json::object();
    expect_bytes_refused(b.glb(),
                         "extensionsRequired[1]: expected one of KHR_mesh_quantization, "
                         "KHR_draco_mesh_compression, EXT_meshopt_compression");
  }
  expect_patch_refused({"/extensionsRequired", "[3]", "extensionsRequired[0]: expected a text, got 3"});
  expect_patch_refused({"/extensionsRequired", "{}", "extensionsRequired: expected an array, got object"});
}

TEST(BadFiles, ValuesThatAreNotWhatTheyShouldBe) {
  // Accessors of rich(): 0 positions, 1 normals, 2 uvs, 3 tangents (sparse), 4 indices.
  for (const Patch& patch : std::initializer_list<Patch>{
           {"/accessors/0/count", "4294967295", "got 4294967295 elements of 12 bytes from byte"},
           {"/accessors/0/count", "9007199254740992", "got 9007199254740992 elements"},
           {"/accessors/0/count", "18446744073709551615", "got 18446744073709551615 elements"},
           {"/accessors/0/count", "1537228672809129302",
            "got 1537228672809129302 elements of 12 bytes"},  // 12 times it is 8 mod 2^64
           {"/accessors/0/count", "5", "got 5 elements"},
           {"/accessors/0/count", "3", "expected an accessor of as many elements as POSITION's, 3, got 4"},
           {"/accessors/0/count", "0", "accessors[0].count: expected an integer not below 1, got 0"},
           {"/accessors/0/count", "-1", "accessors[0].count: expected an integer not below 1, got -1"},
           {"/accessors/0/count", "4.5", "accessors[0].count: expected an integer not below 1, got 4.5"},
           {"/accessors/0/count", "1e30", "accessors[0].count: expected an integer not below 1, got 1e+30"},
           {"/accessors/0/count", "100000000000000000000",
            "accessors[0].count: expected an integer not below 1, got 1e+20"},
           {"/accessors/0/count", "\"4\"", "accessors[0].count: expected an integer not below 1, got \"4\""},
           {"/accessors/0/count", nullptr, "accessors[0]: expected an object with count, got one without"},
           {"/accessors/0/bufferView", "99",
            "accessors[0].bufferView: expected 0 to 4, the bufferViews there are, got 99"},
           {"/accessors/0/bufferView", "-1",
            "accessors[0].bufferView: expected an integer not below 0, got -1"},
           {"/accessors/0/byteOffset", "4", "got 4 elements of 12 bytes from byte 4"},
           {"/accessors/0/byteOffset", "18446744073709551612", "from byte 18446744073709551612"},
           {"/accessors/0/componentType", "5124", "expected 5120, 5121, 5122, 5123, 5125 or 5126, got 5124"},
           {"/accessors/0/componentType", "\"FLOAT\"", "expected an integer not below 0, got \"FLOAT\""},
           {"/accessors/0/type", "\"VEC5\"",
            "accessors[0].type: expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4, got \"VEC5\""},
           {"/accessors/0/type", "3", "accessors[0].type: expected a text, got 3"},
           {"/accessors/0/type", "\"VEC2\"", "POSITION: expected an accessor of type VEC3, got VEC2"},
           {"/accessors/0/normalized", "1", "accessors[0].normalized: expected true or false, got 1"},
           {"/accessors/1/type", "\"VEC4\"", "NORMAL: expected an accessor of type VEC3, got VEC4"},
           {"/accessors/1/count", "3",
            "NORMAL: expected an accessor of as many elements as POSITION's, 4, got 3"},
           {"/accessors/2/byteOffset", "13", "got 4 elements of 8 bytes from byte 13"},
           {"/accessors/3/count", "9007199254740992", "got 9007199254740992 elements of 16 bytes"},
           {"/accessors/3/count", "1000000", "got 1000000 elements of"},
           {"/accessors/3/sparse/count", "5",
            "accessors[3].sparse.count: expected an integer from 1 to 4, got 5"},
           {"/accessors/3/sparse/count", "0",
            "accessors[3].sparse.count: expected an integer from 1 to 4, got 0"},
           {"/accessors/3/sparse/indices/componentType", "5126", "expected 5121, 5123 or 5125, got 5126"},
           {"/accessors/3/sparse/indices/componentType", "5125", "got 4 elements of 4 bytes"},
           {"/accessors/3/sparse/indices/bufferView", "3",
            "accessors[3].sparse.indices: expected elements below 4, got 16256"},
           {"/accessors/3/sparse/values/byteOffset", "1",
            "accessors[3].sparse.values: expected elements within the"},
           {"/accessors/3/sparse/values", nullptr,
            "accessors[3].sparse: expected an object with values, got one without"},
           {"/accessors/4/componentType", "5126", "got 6 elements of 4 bytes"},
           {"/accessors/4/componentType", "5120",
            "expected an accessor of type SCALAR and componentType 5121, 5123 or 5125, got SCALAR and 5120"},
           {"/accessors/4/bufferView", "3", "indices: expected indices below 4, got 128 at place 2"},
           {"/accessors", "{}", "accessors: expected an array, got object"},
           {"/bufferViews/0/buffer", "1",
            "bufferViews[0].buffer: expected 0 to 0, the buffers there are, got 1"},
           {"/bufferViews/0/byteLength", "18446744073709551615", "got 18446744073709551615 bytes"},
           {"/bufferViews/0/byteLength", "47", "accessors[0]: expected elements within the"},
           {"/bufferViews/0/byteOffset", "18446744073709551600", "from byte 18446744073709551600"},
           {"/bufferViews/0/byteOffset", "100000", "from byte 100000"},
           {"/bufferViews/1/byteStride", "0",
            "bufferViews[1].byteStride: expected an integer from 4 to 252, got 0"},
           {"/bufferViews/1/byteStride", "256", "bufferViews[1].byteStride: expected an integer"},
           {"/bufferViews/1/byteStride", "8", "of the byteStride of its bufferView, got 12 bytes"},
           {"/buffers/0/byteLength", "100000", "buffers[0].byteLength: expected at most the"},
           {"/buffers/0/byteLength", "-5", "buffers[0].byteLength: expected an integer"},
           {"/buffers", nullptr, "bufferViews[0].buffer: expected none: there are no buffers, got 0"},
           {"/meshes/0/primitives/0/attributes/POSITION", "77",
            "POSITION: expected 0 to 4, the accessors there are, got 77"},
           {"/meshes/0/primitives/0/attributes", "[]", "attributes: expected an object, got array"},
           {"/meshes/0/primitives/0/mode", "7", "mode: expected an integer from 0 to 6, got 7"},
           {"/meshes/0/primitives/0/material", "1",
            "material: expected 0 to 0, the materials there are, got 1"},
           {"/meshes/0/primitives", nullptr,
            "meshes[0]: expected an object with primitives, got one without"},
           {"/meshes/0/name", "7", "meshes[0].name: expected a text, got 7"},
           {"/meshes", "null", "meshes: expected an array, got null"},
           {"/nodes/0/children", "[0]",
            "nodes[0]: expected trees of nodes, got a node that is its own ancestor or has two parents"},
           {"/nodes/1/children", "[0]", "is its own ancestor or has two parents"},
           {"/nodes/0/children", "[1, 1]", "nodes[1]: expected trees of nodes"},
           {"/nodes/0/children", "[2]", "nodes[0].children[0]: expected 0 to 1, the nodes there are, got 2"},
           {"/nodes/0/translation", "[1, 2]", "nodes[0].translation: expected 3 numbers, got 2"},
           {"/nodes/0/rotation", "[1, 2, 3, null]", "nodes[0].rotation[3]: expected a number, got null"},
           {"/nodes/1/matrix", "[]", "nodes[1].matrix: expected 16 numbers, got 0"},
           {"/nodes/1/mesh", "1", "nodes[1].mesh: expected 0 to 0, the meshes there are, got 1"},
           {"/scene", "1", "scene: expected 0 to 0, the scenes there are, got 1"},
           {"/scenes/0/nodes", "[5]", "scenes[0].nodes[0]: expected 0 to 1, the nodes there are, got 5"},
       })
    expect_patch_refused(patch);
}

TEST(BadFiles, AnIndexOutOfRangeIsNamed) {
  Builder b = rich();
  b.bin[b.json["bufferViews"].back()["byteOffset"].get<std::size_t>() + 4] = 4;
  expect_bytes_refused(b.glb(), "indices: expected indices below 4, got 4 at place 4");
}

TEST(BadFiles, CyclesWithoutScenes) {
  Builder b = rich();
  b.json.erase("scenes");
  b.json.erase("scene");
  b.json["nodes"][1]["children"] = {0};
  expect_bytes_refused(b.glb(), "is its own ancestor or has two parents");
}

TEST(BadFiles, AttributesMadeOfNothing) {
  // A whole mesh without a byte of data: bounded, however many primitives show it.
  Builder b = rich();
  b.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 300000}});
  b.json["meshes"][0]["primitives"] = {{{"attributes", {{"POSITION", 5}}}}};
  expect_bytes_refused(b.glb(), "without a bufferView for a file of this size, got 300000 elements of");
  b.json["accessors"][5]["count"] = 30000;
  EXPECT_NO_THROW({
    const TempFolder folder;
    EXPECT_EQ(
        read_asset(test::write_bytes(folder / "zeros.glb", b.glb())).primitives.at(0).data.positions.size(),
        30000u);
  });
}

TEST(BadFiles, Uris) {
  const TempFolder folder;
  test::write_bytes(folder / "short.bin", "1234");
  std::filesystem::create_directory(folder / "folder.bin");
  const auto refuse = [&](const std::string& uri, const std::string& part) {
    Builder b = rich();
    b.json["buffers"][0]["uri"] = uri;
    expect_refused(test::write_bytes(folder / "bad.gltf", b.json.dump()), part);
  };
  refuse("", "buffers[0].uri: expected a relative path or a base64 data URI, got \"\"");
  refuse("/etc/passwd", "buffers[0].uri: expected a relative path or a base64 data URI, got \"/etc/passwd\"");
  refuse("%2Fetc/passwd", "expected a relative path or a base64 data URI");
  refuse("\\\\server\\share", "expected a relative path or a base64 data URI");
  refuse("file:///etc/passwd", "expected a relative path or a base64 data URI");
  refuse("https://example.org/a.bin", "expected a relative path or a base64 data URI");
  refuse("C:\\a.bin", "expected a relative path or a base64 data URI");
  refuse("a%00.bin", "expected a relative path or a base64 data URI");
  refuse("line\nbreak.bin\n", "buffers[0].uri: ");
  refuse("missing.bin", "missing.bin: expected a readable file");
  refuse("folder.bin", "folder.bin: expected a file, got a folder");
  refuse("../../../../../../../../dev/zero", "unless --allow-outside is given, got");
  refuse("short.bin", "expected at most the 4 bytes there are");
  refuse("data:application/octet-stream,abc", "expected a relative path or a base64 data URI");
  refuse("data:;base64", "expected a relative path or a base64 data URI");
  refuse("data:;base64,AA*A", "got \"*\" at position 2");
  refuse("data:;base64,AAAAA", "one that is cut short");
  refuse("data:;base64,", "expected at most the 0 bytes there are");
  refuse("DATA:;base64,AAAA", "expected at most the 3 bytes there are");
}

// ---- mutations
// ------------------------------------------------------------------------------------------------

TEST(BadFiles, EveryValueOfTheDocumentReplaced) {
  const TempFolder folder;
  const Builder good = rich();
  const Json nasty =
      Json::parse(R"([0, 1, -1, 3, 255, 5121, 5125, 65535, 2147483648, 4294967295, 9007199254740992,
    18446744073709551615, -9223372036854775808, 1.5, -1e308, 1e30, null, true, "", "x", "VEC3", "MAT4", [],
    [0], [[]], {}, {"a": 1}])");
  std::size_t read = 0, tried = 0;
  // Every place, objects and arrays included. The replacements are sound JSON, so only the document is
  // tested.
  std::vector<Json::json_pointer> places = {Json::json_pointer()};
  for (std::size_t next = 0; next < places.size(); ++next) {
    const Json::json_pointer place = places[next];
    const Json& value = good.json[place];
    if (value.is_object())
      for (const auto& [key, child] : value.items()) places.push_back(place / key);
    if (value.is_array())
      for (std::size_t i = 0; i < value.size(); ++i) places.push_back(place / i);
    for (const Json& replacement : nasty) {
      Builder b = good;
      b.json[place] = replacement;
      SCOPED_TRACE(place.to_string() + " = " + replacement.dump());
      ++tried;
      if (!content_is_read(b.glb())) continue;
      survives(test::write_bytes(folder / "mutated.glb", b.glb()));
      ++read;
      ASSERT_FALSE(HasFailure());
    }
  }
  RecordProperty("tried", static_cast<int>(tried));
  EXPECT_GT(tried, 3000u);
  EXPECT_GT(read, 100u);  // names, minima and the like may be anything
  EXPECT_LT(read, tried / 2);
}

TEST(BadFiles, EveryByteReplaced) {
  const std::string good = rich().glb();
  std::mt19937 random(20261121);
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const int change : {0, 0xFF, int{'9'}, int{'"'}, static_cast<int>(random() % 256)}) {
      std::string bytes = good;
      bytes[i] = static_cast<char>(change);
      SCOPED_TRACE("byte " + std::to_string(i) + " = " + std::to_string(change));
      content_is_read(bytes);
    }
  }
}

// ---- OBJ
// ------------------------------------------------------------------------------------------------------

TEST(BadFiles, Obj) {
  expect_bytes_refused("", "expected an OBJ with faces, got an empty file", "bad.obj");
  expect_bytes_refused("f", "expected an OBJ with faces", "bad.obj");
  expect_bytes_refused("# only a comment, and nothing else\n", "expected an OBJ with faces", "bad.obj");
  expect_bytes_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "expected an OBJ with faces", "bad.obj");
  expect_bytes_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "expected an OBJ with faces", "bad.obj");
  expect_bytes_refused("v 0 0 0\nv 1 0 0\nl 1 2\n", "has no faces", "bad.obj");
  expect_bytes_refused(std::string(1000, '\xFF'), "expected an OBJ with faces", "bad.obj");
}

TEST(BadFiles, UnusualObj) {
  const TempFolder folder;
  const auto read = [&](const std::string& text) {
    return read_asset(test::write_bytes(folder / "a.obj", text)).primitives.at(0).data;
  };
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(read("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3").triangles.size(), 1u);
  EXPECT_EQ(read(triangle + "vt 0.5 0.25 0.125\nf 1/1 2/1 3/1\n").uvs.at(0), (Vec2<double>{0.5, 0.25}));
  // A quad that is concave at its second corner, which both triangles must have.
  const Mesh concave = read("v 0 0 0\nv 0.25 0.25 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n");
  ASSERT_EQ(concave.triangles.size(), 2u);
  for (const auto& [a, b, c] : concave.triangles)
    EXPECT_GT(
        cross(concave.positions[b] - concave.positions[a], concave.positions[c] - concave.positions[a]).z, 0);
}

TEST(BadFiles, TruncatedObj) {
  const TempFolder folder;
  const std::string good =
      "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1 4/2/1\nf "
      "-4/1/1 -3//1 -2/1/1\n";
  std::size_t read = 0;
  for (std::size_t length = 0; length <= good.size(); ++length) {
    const std::string path = test::write_bytes(folder / "cut.obj", good.substr(0, length));
    try {
      EXPECT_FALSE(read_asset(path).primitives.empty());
      ++read;
    } catch (const FileError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(read, 0u);
}

}  // namespace
}  // namespace darboux::io_bad_files_test
