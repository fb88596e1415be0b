// KHR_draco_mesh_compression: a compressed file is read as its plain twin, is rewritten as a plain file, and
// broken streams are refused. The streams are made by Draco's encoder; the twins of those that reorder come
// from its own decoder.
#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <gtest/gtest.h>

#include <darboux/file_tangents.h>
#include <darboux/io.h>

#include "refused_files.h"
#include "same_asset.h"

namespace darboux::draco_test {
namespace {

using test::Builder;
using test::Json;
using test::TempFolder;

constexpr const char* extension = "KHR_draco_mesh_compression";

/// An attribute to be compressed.
struct Attribute {
  std::string name, type;
  int component_type = 5126;
  bool normalized = false;
  std::uint32_t unique_id = 0;
  std::string bytes;     // tightly packed
  int quantisation = 0;  // bits, 0: none
};

std::size_t components(const std::string& type) {
  return type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
}
std::size_t component_size(int type) {
  return type == 5126 || type == 5125 ? 4 : type < 5122 ? 1 : 2;
}
draco::DataType draco_type(int type) {
  switch (type) {
    case 5120:
      return draco::DT_INT8;
    case 5121:
      return draco::DT_UINT8;
    case 5122:
      return draco::DT_INT16;
    case 5123:
      return draco::DT_UINT16;
    default:
      return draco::DT_FLOAT32;
  }
}

struct Source {
  std::vector<Attribute> attributes;
  std::vector<std::uint32_t> indices;
  std::size_t vertices = 0;
};

std::string floats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), 4 * values.size()};
}

/// A bump over n x n squares with everything a vertex may have.
Source bump(std::size_t n) {
  Source s;
  std::vector<float> p, normal, uv, tangent;
  std::string joints, weights;
  for (std::size_t j = 0; j <= n; ++j)
    for (std::size_t i = 0; i <= n; ++i) {
      const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1, l = std::sqrt(1 + x * x + y * y);
      for (const double a : {x, y, -(x * x + y * y) / 2}) p.push_back(static_cast<float>(a));
      for (const double a : {x / l, y / l, 1 / l}) normal.push_back(static_cast<float>(a));
      for (const double a : {1.0 * i / n, 1.0 * j / n}) uv.push_back(static_cast<float>(a));
      for (const double a : {1 / std::hypot(1, x), 0.0, -x / std::hypot(1, x), -1.0})
        tangent.push_back(static_cast<float>(a));
      joints += test::pack<std::uint8_t>({0, static_cast<std::uint8_t>(i % 7), 2, 255});
      weights += test::pack<std::uint16_t>({65535, static_cast<std::uint16_t>(j), 0, 0});
      if (i == n || j == n) continue;
      const auto k = static_cast<std::uint32_t>(j * (n + 1) + i), m = static_cast<std::uint32_t>(n + 1);
      s.indices.insert(s.indices.end(), {k, k + 1, k + m + 1, k, k + m + 1, k + m});
    }
  s.vertices = p.size() / 3;
  // Ids that are not the order, as the extension permits.
  s.attributes = {{"POSITION", "VEC3", 5126, false, 7, floats(p)},
                  {"NORMAL", "VEC3", 5126, false, 3, floats(normal)},
                  {"TEXCOORD_0", "VEC2", 5126, false, 5, floats(uv)},
                  {"TANGENT", "VEC4", 5126, false, 4, floats(tangent)},
                  {"JOINTS_0", "VEC4", 5121, false, 9, joints},
                  {"WEIGHTS_0", "VEC4", 5123, true, 1000000, weights}};
  return s;
}

draco::GeometryAttribute::Type kind(const std::string& name) {
  return name == "POSITION"     ? draco::GeometryAttribute::POSITION
         : name == "NORMAL"     ? draco::GeometryAttribute::NORMAL
         : name == "TEXCOORD_0" ? draco::GeometryAttribute::TEX_COORD
                                : draco::GeometryAttribute::GENERIC;
}

std::string encode(const Source& s, int method, int speed = 5) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(s.vertices));
  mesh.SetNumFaces(s.indices.size() / 3);
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
    mesh.SetFace(draco::FaceIndex(f),
                 {draco::PointIndex(s.indices[3 * f]), draco::PointIndex(s.indices[3 * f + 1]),
                  draco::PointIndex(s.indices[3 * f + 2])});
  for (const Attribute& a : s.attributes) {
    const std::size_t size = components(a.type) * component_size(a.component_type);
    draco::GeometryAttribute geometry;
    geometry.Init(kind(a.name), nullptr, static_cast<std::uint8_t>(components(a.type)),
                  draco_type(a.component_type), a.normalized, static_cast<std::int64_t>(size), 0);
    const int id = mesh.AddAttribute(geometry, true, static_cast<std::uint32_t>(s.vertices));
    mesh.attribute(id)->set_unique_id(a.unique_id);
    for (std::uint32_t i = 0; i < s.vertices; ++i)
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), a.bytes.data() + i * size);
  }
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(method);
  encoder.SetSpeedOptions(speed, speed);
  for (int i = 0; i < mesh.num_attributes(); ++i)
    encoder.SetAttributeQuantization(i, s.attributes[static_cast<std::size_t>(i)].quantisation);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  EXPECT_TRUE(status.ok()) << status.error_msg();
  return {buffer.data(), buffer.size()};
}

/// What Draco's own decoder makes of a stream.
Source decoded(const Source& s, const std::string& stream) {
  draco::DecoderBuffer buffer;
  buffer.Init(stream.data(), stream.size());
  draco::Decoder decoder;
  const auto mesh = decoder.DecodeMeshFromBuffer(&buffer).value();
  Source result = s;
  result.vertices = mesh->num_points();
  result.indices.clear();
  for (std::uint32_t f = 0; f < mesh->num_faces(); ++f)
    for (const auto& corner : mesh->face(draco::FaceIndex(f))) result.indices.push_back(corner.value());
  for (Attribute& a : result.attributes) {
    const auto* attribute = mesh->GetAttributeByUniqueId(a.unique_id);
    const std::size_t size = components(a.type) * component_size(a.component_type);
    a.bytes.assign(result.vertices * size, '\0');
    for (std::uint32_t i = 0; i < result.vertices; ++i)
      attribute->GetMappedValue(draco::PointIndex(i), a.bytes.data() + i * size);
  }
  return result;
}

Json accessor_of(const Attribute& a) {
  Json json = Json::object();
  if (a.normalized) json["normalized"] = true;
  return json;
}

/// The plain file.
Builder plain_file(const Source& s) {
  Builder b;
  Json attributes;
  for (const Attribute& a : s.attributes) {
    Json json = accessor_of(a);
    json["bufferView"] = b.view(a.bytes);
    attributes[a.name] = b.accessor(a.type, a.component_type, s.vertices, json);
  }
  const std::string bytes(reinterpret_cast<const char*>(s.indices.data()), 4 * s.indices.size());
  const auto indices = b.accessor("SCALAR", 5125, s.indices.size(), {{"bufferView", b.view(bytes)}});
  b.primitive(attributes, {{"indices", indices}});
  return b;
}

/// The compressed file of the same counts. \param s what the stream decodes to
Builder compressed_file(const Source& s, const std::string& stream) {
  Builder b;
  b.json["extensionsUsed"] = b.json["extensionsRequired"] = {extension};
  Json attributes, ids;
  for (const Attribute& a : s.attributes) {
    attributes[a.name] = b.accessor(a.type, a.component_type, s.vertices, accessor_of(a));
    ids[a.name] = a.unique_id;
  }
  b.json["accessors"][0]["min"] = b.json["accessors"][0]["max"] = {0, 0, 0};
  const auto indices = b.accessor("SCALAR", 5123, s.indices.size(), Json::object());
  const auto view = b.view(stream);
  b.primitive(attributes, {{"indices", indices},
                           {"mode", 4},
                           {"extensions", {{extension, {{"bufferView", view}, {"attributes", ids}}}}}});
  return b;
}

Asset read(const Builder& builder) {
  const TempFolder folder;
  return read_asset(test::write_bytes(folder / "made.glb", builder.glb()));
}

Source quantised(Source s) {
  for (Attribute& a : s.attributes)
    a.quantisation = a.name == "NORMAL" ? 10 : a.component_type == 5126 ? 12 : 0;
  return s;
}

// ---- reading

TEST(ReadDraco, LosslessInOrder) {
  const Source s = bump(9);
  const Asset asset = read(compressed_file(s, encode(s, draco::MESH_SEQUENTIAL_ENCODING)));
  test::expect_same_asset(asset, read(plain_file(s)));
  ASSERT_EQ(asset.primitives.at(0).data.tangents.size(), 100u);
}

TEST(ReadDraco, AsDracosOwnDecoder) {
  // Speed 10 is the standard traversal, 0 the one by valences, with constrained predictions.
  for (const bool lossy : {false, true})
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING})
      for (const int speed : {0, 5, 10}) {
        SCOPED_TRACE("lossy " + std::to_string(lossy) + ", method " + std::to_string(method) + ", speed " +
                     std::to_string(speed));
        const Source s = lossy ? quantised(bump(9)) : bump(9);
        const std::string stream = encode(s, method, speed);
        const Source own = decoded(s, stream);
        ASSERT_EQ(own.indices.size(), s.indices.size());
        test::expect_same_asset(read(compressed_file(own, stream)), read(plain_file(own)));
      }
}

TEST(ReadDraco, WithinTheQuantisation) {
  const Source s = quantised(bump(9));
  const std::string stream = encode(s, draco::MESH_EDGEBREAKER_ENCODING, 3);
  const Mesh mesh = read(compressed_file(decoded(s, stream), stream)).primitives.at(0).data;
  const Mesh exact = read(plain_file(s)).primitives.at(0).data;
  // 12 bits of the largest extent: of positions 2, of uvs 1. Half a step each, and float's rounding.
  const double position = 0.5 * 2 / 4095 + 1e-6, uv = 0.5 / 4095 + 1e-6;
  std::vector<bool> found(exact.positions.size(), false);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const std::size_t k =
        static_cast<std::size_t>(std::lround(mesh.uvs[i].y * 9) * 10 + std::lround(mesh.uvs[i].x * 9));
    ASSERT_LT(k, found.size());
    found[k] = true;
    EXPECT_NEAR(mesh.uvs[i].x, exact.uvs[k].x, uv);
    EXPECT_NEAR(mesh.uvs[i].y, exact.uvs[k].y, uv);
    EXPECT_NEAR(mesh.positions[i].x, exact.positions[k].x, position);
    EXPECT_NEAR(mesh.positions[i].y, exact.positions[k].y, position);
    EXPECT_NEAR(mesh.positions[i].z, exact.positions[k].z, position);
    // A cell of the octahedron of 10 bits has sides of 2 sqrt(2) / 1022 at most; half its diagonal.
    EXPECT_LT(norm(mesh.normals[i] - exact.normals[k]), 4.0 / 1022);
  }
  EXPECT_EQ(std::count(found.begin(), found.end(), true), 100);
}

TEST(ReadDraco, TheStreamCountsNotTheFallback) {
  const Source s = bump(4);
  Builder b = compressed_file(s, encode(s, draco::MESH_SEQUENTIAL_ENCODING));
  b.json.erase("extensionsRequired");
  const auto other = b.view(std::string(12 * s.vertices, '\0'));
  b.json["accessors"][0]["bufferView"] = other;
  b.json["accessors"][0]["byteOffset"] = 0;
  b.json["accessors"].back()["bufferView"] = b.view(std::string(2 * s.indices.size(), '\0'));
  test::expect_same_asset(read(b), read(plain_file(s)));
}

TEST(ReadDraco, AttributesBesideTheStream) {
  // Morph targets and attributes that the stream lacks are read as usual; accessors may be shared with plain
  // primitives.
  Source s = bump(3);
  Source few = s;
  few.attributes.resize(1);
  Builder b = compressed_file(few, encode(few, draco::MESH_SEQUENTIAL_ENCODING));
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  const auto uv = b.view(s.attributes[2].bytes), moved = b.view(s.attributes[1].bytes);
  primitive["attributes"]["TEXCOORD_0"] = b.accessor("VEC2", 5126, s.vertices, {{"bufferView", uv}});
  primitive["targets"] = {{{"POSITION", b.accessor("VEC3", 5126, s.vertices, {{"bufferView", moved}})}}};
  const TempFolder folder;
  const GltfDocument document = GltfDocument::load(test::write_bytes(folder / "in.glb", b.glb()));
  const Asset asset = document.asset();
  const Mesh expected = read(plain_file(s)).primitives.at(0).data;
  EXPECT_EQ(asset.primitives.at(0).data.positions, expected.positions);
  EXPECT_EQ(asset.primitives.at(0).data.uvs, expected.uvs);
  EXPECT_EQ(asset.primitives.at(0).data.triangles, expected.triangles);
  EXPECT_EQ(document.morph_targets(asset.primitives[0]).at(0).positions, expected.normals);
}

TEST(ReadDraco, StripsAndNoIndices) {
  const Source s = bump(3);
  Builder b = compressed_file(s, encode(s, draco::MESH_SEQUENTIAL_ENCODING));
  b.json["meshes"][0]["primitives"][0]["mode"] = 5;
  test::expect_same_asset(read(b), read(plain_file(s)));
  b.json["meshes"][0]["primitives"][0].erase("indices");
  test::expect_same_asset(read(b), read(plain_file(s)));
}

// ---- rewriting

TEST(RewriteDraco, APlainFileIsWritten) {
  const TempFolder folder;
  const Source s = bump(9);
  const std::string plain = test::write_bytes(folder / "plain.glb", plain_file(s).glb()),
                    path = test::write_bytes(
                        folder / "in.glb",
                        compressed_file(s, encode(s, draco::MESH_SEQUENTIAL_ENCODING)).glb());
  const auto rewritten = [&](const std::string& from, const std::function<void(GltfDocument&)>& edit) {
    GltfDocument document = GltfDocument::load(from);
    edit(document);
    document.save_glb(folder / "out.glb");
    const Json json = test::split_glb(test::read_bytes(folder / "out.glb")).json;
    EXPECT_EQ(json.dump().find("draco"), std::string::npos);
    EXPECT_FALSE(json.contains("extensionsRequired"));
    return read_asset(folder / "out.glb");
  };
  const auto nothing = [](GltfDocument&) {};
  test::expect_same_asset(rewritten(path, nothing), read_asset(plain));
  const Json json = test::split_glb(test::read_bytes(folder / "out.glb")).json;
  const auto accessor = [&](const char* name) {
    return json["accessors"][json["meshes"][0]["primitives"][0]["attributes"][name].get<std::size_t>()];
  };
  EXPECT_EQ(accessor("POSITION")["min"], Json({-1, -1, -1}));
  EXPECT_EQ(accessor("POSITION")["max"][0], 1);
  EXPECT_FALSE(accessor("NORMAL").contains("min"));
  EXPECT_EQ(accessor("WEIGHTS_0")["componentType"], 5123);
  EXPECT_EQ(accessor("WEIGHTS_0")["normalized"], true);
  const auto tangents = [](GltfDocument& document) { add_tangents(document, {}); };
  test::expect_same_asset(rewritten(path, tangents), rewritten(plain, tangents));
  const auto remap = [](GltfDocument& document) {
    const std::vector<std::uint32_t> source = {4, 1, 99, 4}, indices = {0, 1, 2, 3, 2, 1};
    document.remap_vertices(0, 0, source, indices);
  };
  test::expect_same_asset(rewritten(path, remap), rewritten(plain, remap));
}

// ---- broken files

TEST(BadDraco, ValuesThatAreNotWhatTheyShouldBe) {
  const Source s = bump(9);
  const Builder good = compressed_file(s, encode(s, draco::MESH_SEQUENTIAL_ENCODING));
  ASSERT_TRUE(test::content_is_read(good.glb()));
  const std::string primitive = "/meshes/0/primitives/0", ext = primitive + "/extensions/" + extension;
  struct Patch {
    std::string pointer, value, message;
  };
  for (const auto& [pointer, value, message] : std::initializer_list<Patch>{
           {ext + "/attributes/POSITION", "8",
            "POSITION: expected one of those of the stream: \"7, 3, 5, 4, 9, 1000000\", got 8"},
           {ext + "/attributes/POSITION", "4294967296", "expected an integer from 0 to 4294967295"},
           {ext + "/attributes/POSITION", "-1", "POSITION: expected an integer from 0 to 4294967295, got -1"},
           {ext + "/attributes/POSITION", "5",
            "POSITION: expected an accessor of the 2 components of its KHR_draco_mesh_compression, got VEC3"},
           {ext + "/attributes", "[]", "attributes: expected an object, got array"},
           {ext + "/bufferView", "9", "bufferView: expected 0 to 0, the bufferViews there are, got 9"},
           {ext, "3", "KHR_draco_mesh_compression: expected an object, got 3"},
           {primitive + "/mode", "6", "mode: expected 4 or 5 with KHR_draco_mesh_compression, got 6"},
           {"/accessors/0/count", "99",
            "POSITION: expected an accessor of the 100 elements of its KHR_draco_mesh_compression, got 99"},
           {"/accessors/0/count", "4294967396", "elements of its KHR_draco_mesh_compression, got 4294967396"},
           {"/accessors/0/count", "18446744073709551615",
            "elements of its KHR_draco_mesh_compression, got 18446744073709551615"},
           {"/accessors/0/componentType", "5121", "got one of vertex 0 that is missing or beyond it"},
           {"/accessors/6/count", "483",
            "indices: expected an accessor of the 486 elements of its KHR_draco_mesh_compression, got 483"},
           {"/bufferViews/0/byteLength", "5",
            "got a stream that cannot be decoded (it has no header of Draco)"},
           {"/bufferViews/0/byteOffset", "4", "expected bytes within the"},
       }) {
    SCOPED_TRACE(pointer + " = " + value);
    Builder b = good;
    b.json[Json::json_pointer(pointer)] = Json::parse(value);
    test::expect_bytes_refused(b.glb(), message);
  }
  // The header: "DRACO", version, kind, method.
  for (const auto& [at, value, message] :
       std::initializer_list<std::tuple<int, char, const char*>>{{0, 'd', "it has no header"},
                                                                 {5, 1, "it is of version 1.2"},
                                                                 {6, 1, "it is of version 2.1"},
                                                                 {7, 0, "it is no mesh"},
                                                                 {8, 2, "its method is 2"}}) {
    Builder b = good;
    b.bin[static_cast<std::size_t>(at)] = value;
    test::expect_bytes_refused(b.glb(), message);
  }
}

std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 128; value >>= 7) bytes += static_cast<char>(value | 128);
  return bytes + static_cast<char>(value);
}

TEST(BadDraco, CountsThatLie) {
  const std::string start("DRACO\2\2\1\1\0\0", 11);  // a mesh by edgebreaker
  const auto file = [&](const std::string& stream) { return compressed_file(bump(2), stream).glb(); };
  for (const std::uint64_t faces :
       {(std::uint64_t{1} << 23) + 10000, std::uint64_t{1} << 28, (std::uint64_t{1} << 32) - 1})
    test::expect_bytes_refused(file(start + std::string(1, '\0') + varint(4) + varint(faces) + varint(0) +
                                    varint(faces) + varint(0)),
                               " for " + std::to_string(faces) + " triangles");
  test::expect_bytes_refused(file(start + std::string(1, '\0') + varint(4) + std::string(9, '\xFF')),
                             "got a stream that cannot be decoded");

  // Many primitives that name one good stream: decoded again and again, until the budget is spent.
  Source s = quantised(bump(200));
  s.attributes.resize(1);
  const std::string stream = encode(s, draco::MESH_EDGEBREAKER_ENCODING, 10);
  Builder b = compressed_file(decoded(s, stream), stream);
  ASSERT_TRUE(test::content_is_read(b.glb()));
  const Json one = b.json["meshes"][0]["primitives"][0];
  for (int i = 0; i < 200; ++i) b.json["meshes"][0]["primitives"].push_back(one);
  test::expect_bytes_refused(b.glb(), "of content (--max-memory raises it), got");
}

// What a small file may ask for does not grow by what its streams decode to.
TEST(BadDraco, DecodedBytesGiveNoBudget) {
  Source s = quantised(bump(600));
  s.attributes.resize(1);
  const std::string stream = encode(s, draco::MESH_EDGEBREAKER_ENCODING, 10);
  Builder b = compressed_file(decoded(s, stream), stream);
  const Json one = b.json["meshes"][0]["primitives"][0];
  for (int i = 1; i < 5; ++i) b.json["meshes"][0]["primitives"].push_back(one);
  ASSERT_LT(b.glb().size(), 10000000u);
  test::expect_bytes_refused(b.glb(), "meshes[0].primitives[4]: expected at most 512 MiB of content");
}

TEST(BadDraco, NotANumber) {
  // As they are: the verdict names them.
  Source s = bump(2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(s.attributes[0].bytes.data() + 4, &nan, 4);
  test::expect_same_asset(read(compressed_file(s, encode(s, draco::MESH_SEQUENTIAL_ENCODING))),
                          read(plain_file(s)));
}

TEST(BadDraco, StreamsCutShortAndFlipped) {
  const unsigned seed = 20261125;
  std::mt19937 random(seed);
  std::size_t read = 0, tried = 0;
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING})
    for (const int speed : {0, 7, 10}) {
      const Source s = quantised(bump(4));
      const std::string stream = encode(s, method, speed);
      const Builder good = compressed_file(decoded(s, stream), stream);
      ASSERT_TRUE(test::content_is_read(good.glb()));
      for (std::size_t cut = 1; cut < stream.size(); ++cut) {
        SCOPED_TRACE("cut to " + std::to_string(cut));
        Builder b = good;
        b.json["bufferViews"][0]["byteLength"] = cut;
        test::content_is_read(b.glb());
        ASSERT_FALSE(testing::Test::HasFailure());
      }
      for (int round = 0; round < 500; ++round) {
        SCOPED_TRACE("seed " + std::to_string(seed) + ", method " + std::to_string(method) + ", speed " +
                     std::to_string(speed) + ", round " + std::to_string(round));
        Builder b = good;
        for (unsigned flips = 1 + random() % 3; flips > 0; --flips)
          b.bin[random() % stream.size()] = static_cast<char>(random());
        read += test::content_is_read(b.glb());
        ++tried;
        ASSERT_FALSE(testing::Test::HasFailure());
      }
    }
  EXPECT_GT(read, 0u);
  EXPECT_LT(read, tried);
}

}  // namespace
}  // namespace darboux::draco_test
