// EXT_meshopt_compression: a compressed file is read as its plain twin, is rewritten as a plain file, and
// broken streams are refused. The streams are made by meshoptimizer's own encoders; the filters are undone
// here by their formulas.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <darboux/file_tangents.h>
#include <darboux/io.h>

#include "generated_gltf.h"
#include "refused_files.h"
#include "same_asset.h"

namespace darboux::meshopt_test {
namespace {

using test::Builder;
using test::Json;
using test::TempFolder;

constexpr const char* extension = "EXT_meshopt_compression";

std::string attribute_stream(const std::string& bytes, std::size_t count, std::size_t stride) {
  std::string stream(meshopt_encodeVertexBufferBound(count, stride), '\0');
  stream.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(stream.data()), stream.size(),
                                           bytes.data(), count, stride));
  return stream;
}

std::string index_stream(const std::string& mode, const std::vector<unsigned>& indices) {
  const std::size_t count = indices.size(), vertices = std::size_t{1} << 20;
  const bool list = mode == "TRIANGLES";
  std::string stream(list ? meshopt_encodeIndexBufferBound(count, vertices)
                          : meshopt_encodeIndexSequenceBound(count, vertices),
                     '\0');
  auto* to = reinterpret_cast<unsigned char*>(stream.data());
  stream.resize(list ? meshopt_encodeIndexBuffer(to, stream.size(), indices.data(), count)
                     : meshopt_encodeIndexSequence(to, stream.size(), indices.data(), count));
  return stream;
}

/// A file whose buffer 0 holds streams and whose buffer 1 stands for what they decode to.
struct Compressed {
  Builder builder;
  std::size_t decoded = 0;

  Compressed() {
    builder.json["buffers"].push_back(
        {{"byteLength", 0}, {"extensions", {{extension, {{"fallback", true}}}}}});
    builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {extension};
  }
  std::size_t view(const std::string& stream, const std::string& mode, std::size_t count, std::size_t stride,
                   Json more = Json::object(), const char* filter = nullptr) {
    const std::size_t index = builder.view(stream);
    Json& view = builder.json["bufferViews"][index];
    Json compressed = view;
    compressed.update(Json{{"byteStride", stride}, {"count", count}, {"mode", mode}});
    if (filter != nullptr) compressed["filter"] = filter;
    view.update(Json{{"buffer", 1}, {"byteOffset", decoded}, {"byteLength", count * stride}});
    view.update(more);
    view["extensions"][extension] = compressed;
    decoded += (count * stride + 3) / 4 * 4;
    builder.json["buffers"][1]["byteLength"] = decoded;
    return index;
  }
};

/// The file with every view compressed that can be; those of indices as `mode` where their count permits it.
Compressed compressed_twin(const Builder& plain, const std::string& mode) {
  Compressed twin;
  Json& json = twin.builder.json;
  const Json extensions = {"KHR_mesh_quantization", extension};
  const Json buffers = json["buffers"];
  json = plain.json;
  json["buffers"] = buffers;
  json["bufferViews"] = Json::array();
  json["extensionsUsed"] = json["extensionsRequired"] = extensions;
  std::map<std::size_t, Json> indices;  // accessors of indices by their bufferView
  for (const Json& mesh : json["meshes"])
    for (const Json& primitive : mesh["primitives"])
      if (primitive.contains("indices")) {
        const Json& accessor = json["accessors"][primitive["indices"].get<std::size_t>()];
        indices[accessor["bufferView"]] = accessor;
      }
  for (std::size_t i = 0; i < plain.json["bufferViews"].size(); ++i) {
    Json more = plain.json["bufferViews"][i];
    const std::string bytes = plain.bin.substr(more["byteOffset"], more["byteLength"]);
    for (const char* key : {"buffer", "byteOffset", "byteLength"}) more.erase(key);
    if (indices.contains(i)) {
      const std::size_t size = indices[i]["componentType"] == 5123 ? 2 : 4, count = bytes.size() / size;
      std::vector<unsigned> list(count, 0);
      for (std::size_t k = 0; k < count; ++k) std::memcpy(&list[k], bytes.data() + k * size, size);
      const std::string used = count % 3 == 0 ? mode : "INDICES";
      twin.view(index_stream(used, list), used, count, size, more);
    } else if (bytes.size() % 4 == 0) {
      const std::size_t stride = more.value("byteStride", std::size_t{4});
      twin.view(attribute_stream(bytes, bytes.size() / stride, stride), "ATTRIBUTES", bytes.size() / stride,
                stride, more);
    } else {
      twin.builder.view(bytes, more);
    }
  }
  return twin;
}

Asset read(const Builder& builder) {
  const TempFolder folder;
  return read_asset(test::write_bytes(folder / "made.glb", builder.glb()));
}

/// Triangles begun with their least index: the triangle codec may turn them.
Asset turned(Asset asset) {
  for (Primitive& p : asset.primitives)
    for (Triangle& t : p.data.triangles)
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return asset;
}

// ---- reading

TEST(ReadMeshopt, TheTwinIsReadTheSame) {
  const Builder plain = test::generated_gltf();
  const Asset expected = read(plain);
  ASSERT_EQ(expected.primitives.size(), 3u);
  test::expect_same_asset(read(compressed_twin(plain, "INDICES").builder), expected);
  const Asset lists = read(compressed_twin(plain, "TRIANGLES").builder);
  test::expect_same_asset(turned(lists), turned(expected));
}

TEST(ReadMeshopt, ManyBlocksOfFloats) {
  // 1000 vertices are several of the codec's blocks of at most 256; NaN and infinities pass through.
  std::mt19937 random(20261123);
  const std::size_t count = 1000;
  std::vector<float> values(3 * count);
  for (float& x : values) x = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
  std::vector<unsigned> indices(3 * 700);
  for (unsigned& i : indices) i = random() % count;
  const std::string bytes(reinterpret_cast<const char*>(values.data()), 4 * values.size());

  Builder plain;
  const auto p = plain.accessor("VEC3", 5126, count, {{"bufferView", plain.view(bytes)}});
  const std::string index_bytes(reinterpret_cast<const char*>(indices.data()), 4 * indices.size());
  const auto i = plain.accessor("SCALAR", 5125, indices.size(), {{"bufferView", plain.view(index_bytes)}});
  plain.primitive({{"POSITION", p}}, {{"indices", i}});

  for (const char* mode : {"TRIANGLES", "INDICES"}) {
    Compressed twin;
    twin.view(attribute_stream(bytes, count, 12), "ATTRIBUTES", count, 12);
    twin.view(index_stream(mode, indices), mode, indices.size(), 4);
    twin.builder.json["accessors"] = plain.json["accessors"];
    twin.builder.json["meshes"] = plain.json["meshes"];
    test::expect_same_asset(turned(read(twin.builder)), turned(read(plain)));
  }
}

/// A triangle whose normals are a compressed view of `stride` bytes per element.
Compressed with_normals(const std::string& stream, const char* filter, std::size_t stride,
                        int component_type) {
  Compressed made;
  const auto normals = made.view(stream, "ATTRIBUTES", 3, stride, {{"byteStride", stride}}, filter);
  const auto normal = made.builder.accessor(
      "VEC3", component_type, 3, {{"bufferView", normals}, {"normalized", component_type != 5126}});
  made.builder.primitive(
      {{"POSITION", made.builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}, {"NORMAL", normal}});
  return made;
}

/// The unit vector of octahedral coordinates x and y in integers, z the integer that stands for 1. (Appendix
/// B)
Vec3<double> octahedral(int x, int y, int one) {
  double a = 1.0 * x / one, b = 1.0 * y / one;
  const double z = 1 - std::abs(a) - std::abs(b), t = std::max(-z, 0.0);
  a -= a >= 0 ? t : -t;
  b -= b >= 0 ? t : -t;
  const Vec3<double> v{a, b, z};
  return v / norm(v);
}

TEST(ReadMeshopt, OctahedralFilter) {
  const std::vector<float> directions = {0.6f, 0, 0.8f, 0, -0.36f, 0.48f, -0.8f, 0, -0.6f, 0.64f, 0.48f, 0};
  const auto check = [&](auto zero, int bits) {
    using T = decltype(zero);
    constexpr int most = std::numeric_limits<T>::max();
    const std::size_t stride = 4 * sizeof(T);
    std::string encoded(3 * stride, '\0');
    meshopt_encodeFilterOct(encoded.data(), 3, stride, bits, directions.data());
    const Mesh mesh = read(with_normals(attribute_stream(encoded, 3, stride), "OCTAHEDRAL", stride,
                                        sizeof(T) == 1 ? 5120 : 5122)
                               .builder)
                          .primitives.at(0)
                          .data;
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<T, 4> e;
      std::memcpy(e.data(), encoded.data() + i * stride, stride);
      const Vec3<double> expected = octahedral(e[0], e[1], e[2]),
                         given{directions[4 * i], directions[4 * i + 1], directions[4 * i + 2]};
      // The library rounds to the nearest integer; in 8 bits it multiplies by a reciprocal root of 12 bits,
      // which may round to the integer beside it.
      EXPECT_LE(norm(mesh.normals[i] - expected), std::sqrt(3.0) * (0.5 + (sizeof(T) == 1)) / most);
      // A step of the octahedral grid is at most 2 sqrt(2) / one long on the sphere, half of it lost in each
      // coordinate.
      EXPECT_LE(norm(mesh.normals[i] - given / norm(given)), 4.0 / ((1 << (bits - 1)) - 1));
    }
  };
  check(std::int8_t{}, 8);
  check(std::int8_t{}, 6);
  check(std::int16_t{}, 16);
  check(std::int16_t{}, 12);
}

TEST(ReadMeshopt, ExponentialFilter) {
  // 2^e m with whole m: floats of up to 23 bits are exact.
  const std::vector<float> values = {0.375f, -1.5f, 0, 1, 0.25f, -0.125f, 8388607.0f / 1024, 3, -5};
  std::string encoded(36, '\0');
  meshopt_encodeFilterExp(encoded.data(), 9, 4, 24, values.data());
  const Mesh mesh = read(with_normals(attribute_stream(encoded, 3, 12), "EXPONENTIAL", 12, 5126).builder)
                        .primitives.at(0)
                        .data;
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(mesh.normals[i], (Vec3<double>{values[3 * i], values[3 * i + 1], values[3 * i + 2]}));
}

TEST(ReadMeshopt, QuaternionFilter) {
  // Meshes have no quaternions, but the view is decoded: read as bytes of an attribute.
  const std::vector<float> quaternions = {0.5f, 0.5f, -0.5f, 0.5f, 0, 0, 0.6f, 0.8f, 0.8f, 0, 0, -0.6f};
  std::string encoded(24, '\0');
  meshopt_encodeFilterQuat(encoded.data(), 3, 8, 16, quaternions.data());
  Compressed made;
  const auto view =
      made.view(attribute_stream(encoded, 3, 8), "ATTRIBUTES", 3, 8, {{"byteStride", 8}}, "QUATERNION");
  const auto tangent = made.builder.accessor("VEC4", 5122, 3, {{"bufferView", view}, {"normalized", true}});
  made.builder.primitive(
      {{"POSITION", made.builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}, {"TANGENT", tangent}});
  const Mesh mesh = read(made.builder).primitives.at(0).data;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec4<double> q = mesh.tangents[i];
    const float* g = &quaternions[4 * i];
    const double dot = q.x * g[0] + q.y * g[1] + q.z * g[2] + q.w * g[3];
    // The same turn, of either sign: three components of 15 bits within 1/sqrt(2), the fourth from the unit
    // length.
    EXPECT_NEAR(std::abs(dot), 1, 1e-4) << i;
  }
}

// ---- buffers

TEST(ReadMeshopt, Fallbacks) {
  const Builder plain = test::generated_gltf();
  const Asset expected = read(plain);
  const Compressed twin = compressed_twin(plain, "INDICES");
  const TempFolder folder;
  const auto read_json = [&](const Json& json) {
    return read_asset(test::write_bytes(folder / "made.gltf", json.dump()));
  };
  test::write_bytes(folder / "streams.bin", twin.builder.bin);
  Json json = twin.builder.json;
  json["buffers"][0]["uri"] = "streams.bin";
  test::expect_same_asset(read_json(json), expected);

  Json unmarked = json;  // no data and no mark
  unmarked["buffers"][1].erase("extensions");
  test::expect_same_asset(read_json(unmarked), expected);

  Json missing = json;  // a mark: the file need not be there
  missing["buffers"][1]["uri"] = "missing.bin";
  test::expect_same_asset(read_json(missing), expected);

  Json first = json;  // the placeholder stands first
  std::swap(first["buffers"][0], first["buffers"][1]);
  for (Json& view : first["bufferViews"]) {
    view["buffer"] = 1 - view["buffer"].get<int>();
    if (view.contains("extensions")) view["extensions"][extension]["buffer"] = 1;
  }
  test::expect_same_asset(read_json(first), expected);
  GltfDocument document = GltfDocument::load(folder / "made.gltf");
  document.save_glb(folder / "first.glb");
  test::expect_same_asset(read_asset(folder / "first.glb"), expected);

  // Uncompressed data beside the streams: the streams are what is read, so other data do not matter.
  Json both = json;
  test::write_bytes(folder / "plain.bin", std::string(twin.decoded, '\x7F'));
  both["buffers"][1] = {{"byteLength", twin.decoded}, {"uri", "plain.bin"}};
  both.erase("extensionsRequired");
  test::expect_same_asset(read_json(both), expected);
}

// ---- rewriting

TEST(RewriteMeshopt, APlainFileIsWritten) {
  const TempFolder folder;
  const Builder plain = test::generated_gltf();
  const std::string plain_path = test::write_bytes(folder / "plain.glb", plain.glb()),
                    path =
                        test::write_bytes(folder / "in.glb", compressed_twin(plain, "INDICES").builder.glb());
  const auto rewritten = [&](const std::string& from, const std::function<void(GltfDocument&)>& edit) {
    GltfDocument document = GltfDocument::load(from);
    edit(document);
    document.save_glb(folder / "out.glb");
    const std::string bytes = test::read_bytes(folder / "out.glb");
    const Json json = test::split_glb(bytes).json;
    EXPECT_EQ(json.dump().find("meshopt"), std::string::npos);
    EXPECT_EQ(json["extensionsRequired"], Json({"KHR_mesh_quantization"}));
    EXPECT_EQ(json["buffers"].size(), 1u);
    return read_asset(folder / "out.glb");
  };
  const auto nothing = [](GltfDocument&) {};
  test::expect_same_asset(rewritten(path, nothing), read_asset(plain_path));
  const auto tangents = [](GltfDocument& document) { add_tangents(document, {}); };
  test::expect_same_asset(rewritten(path, tangents), rewritten(plain_path, tangents));
  const auto remap = [](GltfDocument& document) {
    const std::vector<std::uint32_t> source = {4, 1, 0, 4}, indices = {0, 1, 2, 3, 2, 1};
    document.remap_vertices(0, 0, source, indices);
  };
  test::expect_same_asset(rewritten(path, remap), rewritten(plain_path, remap));
}

// ---- broken files

TEST(BadMeshopt, ValuesThatAreNotWhatTheyShouldBe) {
  const Builder good = compressed_twin(test::generated_gltf(), "TRIANGLES").builder;
  ASSERT_TRUE(test::content_is_read(good.glb()));
  struct Patch {
    const char *pointer, *value, *message;
  };
  // View 0 is 9 vertices of 20 bytes, the last but 4 is 24 indices of 2 bytes.
  const std::string indices = "/bufferViews/" + std::to_string(good.json["bufferViews"].size() - 5);
  ASSERT_EQ(good.json[Json::json_pointer(indices + "/extensions/EXT_meshopt_compression/count")], 24);
  for (const auto& [pointer, value, message] : std::initializer_list<Patch>{
           {"0/mode", "\"ATTRIBUTE\"",
            "mode: expected one of ATTRIBUTES, TRIANGLES, INDICES, got \"ATTRIBUTE\""},
           {"0/mode", "1", "mode: expected a text, got 1"},
           {"0/filter", "\"EXP\"", "expected one of NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL, got \"EXP\""},
           {"0/filter", "\"OCTAHEDRAL\"", "byteStride: expected 4 or 8 with filter OCTAHEDRAL, got 20"},
           {"0/filter", "\"QUATERNION\"", "byteStride: expected 8 with filter QUATERNION, got 20"},
           {"0/byteStride", "0", "byteStride: expected an integer from 1 to 256, got 0"},
           {"0/byteStride", "260", "byteStride: expected an integer from 1 to 256, got 260"},
           {"0/byteStride", "18", "byteStride: expected a multiple of 4 with mode ATTRIBUTES, got 18"},
           {"0/byteStride", "24",
            "bufferViews[0].byteStride: expected 24, that of its EXT_meshopt_compression, got 20"},
           {"0/count", "0", "count: expected an integer not below 1, got 0"},
           {"0/count", "10",
            "bufferViews[0].byteLength: expected the bytes of the 10 elements of 20 bytes of its"},
           {"0/count", "4294967296", "got 4294967296 elements of 20 bytes"},
           {"0/count", "9007199254740992", "got 9007199254740992 elements of 20 bytes"},
           {"0/count", "922337203685477581",
            "got 922337203685477581 elements of 20 bytes"},  // 20 times it is 4 mod 2^64
           {"0/count", "18446744073709551615", "got 18446744073709551615 elements of 20 bytes"},
           {"0/buffer", "1",
            "buffers[1]: expected a uri or, for buffer 0, the binary chunk of a GLB, got no data"},
           {"0/buffer", "2", "buffer: expected 0 to 1, the buffers there are, got 2"},
           {"0/byteOffset", "1", "got one that cannot be decoded"},
           {"0/byteOffset", "100000", "bytes from byte 100000"},
           {"0/byteLength", "18446744073709551615", "got 18446744073709551615 bytes from byte"},
           {"0/byteLength", "40", "expected a whole stream of mode ATTRIBUTES"},
           {"i/mode", "\"ATTRIBUTES\"", "byteStride: expected a multiple of 4 with mode ATTRIBUTES, got 2"},
           {"i/mode", "\"INDICES\"", "got one that cannot be decoded"},
           {"i/filter", "\"EXPONENTIAL\"", "filter: expected NONE with mode TRIANGLES, got \"EXPONENTIAL\""},
           {"i/byteStride", "8", "byteStride: expected 2 or 4 with mode TRIANGLES, got 8"},
           {"i/count", "25", "count: expected a multiple of 3 with mode TRIANGLES, got 25"},
       }) {
    SCOPED_TRACE(std::string(pointer) + " = " + value);
    Builder b = good;
    const std::string at = (*pointer == '0' ? "/bufferViews/0" : indices) + "/extensions/" + extension;
    b.json[Json::json_pointer(at + (pointer + 1))] = Json::parse(value);
    test::expect_bytes_refused(b.glb(), message);
  }
  Builder b = good;
  b.json["bufferViews"][0]["extensions"] = Json::array();
  test::expect_bytes_refused(b.glb(), "bufferViews[0].extensions: expected an object, got array");
}

TEST(BadMeshopt, OneStreamReadOverAndOver) {
  // Each view alone is sound; together they decode more than the file's bytes can stand for.
  Compressed made;
  const std::size_t count = 3 << 12;
  const std::string stream = attribute_stream(std::string(16 * count, '\0'), count, 16);
  ASSERT_GT(16 * count, 50 * stream.size());
  const auto view = made.view(stream, "ATTRIBUTES", count, 16);
  made.builder.accessor("VEC3", 5126, count, {{"bufferView", view}});
  made.builder.primitive({{"POSITION", 0}});
  ASSERT_TRUE(test::content_is_read(made.builder.glb()));
  const Json one = made.builder.json["bufferViews"][0];
  for (int i = 0; i < 1000; ++i) made.builder.json["bufferViews"].push_back(one);
  test::expect_bytes_refused(made.builder.glb(), "bytes for its stream of");
}

TEST(BadMeshopt, StreamsCutShort) {
  const Builder good = compressed_twin(test::generated_gltf(), "TRIANGLES").builder;
  for (const Json& view : good.json["bufferViews"]) {
    if (!view.contains("extensions")) continue;
    const std::size_t index = static_cast<std::size_t>(&view - &good.json["bufferViews"][0]),
                      length = view["extensions"][extension]["byteLength"];
    for (std::size_t cut = 0; cut < length; ++cut) {
      SCOPED_TRACE("bufferViews[" + std::to_string(index) + "] cut to " + std::to_string(cut));
      Builder b = good;
      b.json["bufferViews"][index]["extensions"][extension]["byteLength"] = cut;
      EXPECT_FALSE(test::content_is_read(b.glb()));
    }
  }
}

TEST(BadMeshopt, FlippedBytes) {
  const std::string good = compressed_twin(test::generated_gltf(), "TRIANGLES").builder.glb();
  const std::size_t bin = 28 + test::u32_at(good, 12);
  const unsigned seed = 20261124;
  std::mt19937 random(seed);
  std::size_t read = 0;
  const int rounds = 3000;
  for (int round = 0; round < rounds; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", round " + std::to_string(round));
    std::string bytes = good;
    for (unsigned flips = 1 + random() % 3; flips > 0; --flips)
      bytes[bin + random() % (bytes.size() - bin)] = static_cast<char>(random());
    read += test::content_is_read(bytes);
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_GT(read, 0u);  // a changed delta is another number
  EXPECT_LT(read, static_cast<std::size_t>(rounds));
}

}  // namespace
}  // namespace darboux::meshopt_test
