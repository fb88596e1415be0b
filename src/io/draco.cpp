// KHR_draco_mesh_compression: primitives whose triangles and attributes are a stream of Draco.
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <string>
#include <type_traits>

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>

#include "accessor.h"
#include "budget.h"

namespace darboux::io {
namespace {

constexpr const char* draco_extension = "KHR_draco_mesh_compression";

/// One of Draco's decoders, which checks the counts in the stream before memory is allocated by them. The
/// size of a stream does not bound its content: a plane grid of two million triangles takes 2330 bytes.
template <class Decoder>
class BoundedDecoder final : public Decoder {
 public:
  BoundedDecoder(const JsonCursor& compressed, Budget& budget) : compressed_(compressed), budget_(budget) {}

 protected:
  bool DecodeConnectivity() override {
    // Edgebreaker states vertices and faces; the other method faces and points. Vertices and points are at
    // most three per face, which Draco checks.
    draco::DecoderBuffer ahead = *this->buffer();
    std::uint32_t first = 0, second = 0;
    if (!DecodeVarint(&first, &ahead) || !DecodeVarint(&second, &ahead)) return false;
    constexpr bool vertices_first = std::is_same_v<Decoder, draco::MeshEdgebreakerDecoder>;
    constexpr std::uint64_t face_bytes = 64;  // for indices, neighbours and the tables to find them
    const std::uint64_t faces = vertices_first ? second : first;
    budget_.take(faces * face_bytes, compressed_, std::to_string(faces) + " triangles of 64 bytes");
    return Decoder::DecodeConnectivity();
  }
  bool DecodeAllAttributes() override {
    std::uint64_t bytes = 1;
    for (int i = 0; i < this->mesh()->num_attributes(); ++i) {
      const draco::PointAttribute& attribute = *this->mesh()->attribute(i);
      const int size = std::max(draco::DataTypeLength(attribute.data_type()), 4);  // Draco works in 32 bits
      bytes += attribute.num_components() * static_cast<std::uint64_t>(size);
    }
    const std::uint64_t points = this->mesh()->num_points();
    budget_.take(points * bytes, compressed_,
                 std::to_string(points) + " vertices of " + std::to_string(bytes) + " bytes");
    return Decoder::DecodeAllAttributes();
  }

 private:
  const JsonCursor& compressed_;
  Budget& budget_;
};

/// \param compressed the extension object
void decode(std::string_view stream, const JsonCursor& compressed, Budget& budget, draco::Mesh& mesh) {
  const auto refuse = [&](const std::string& why) {
    compressed.fail("a mesh of Draco 2.2", "a stream that cannot be decoded (" + why + ")");
  };
  draco::DecoderBuffer buffer, header_buffer;
  buffer.Init(stream.data(), stream.size());
  header_buffer.Init(stream.data(), stream.size());
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&header_buffer, &header).ok())
    refuse("it has no header of Draco");
  if (header.version_major != 2 || header.version_minor != 2)
    refuse("it is of version " + std::to_string(header.version_major) + "." +
           std::to_string(header.version_minor));
  if (header.encoder_type != draco::TRIANGULAR_MESH) refuse("it is no mesh");
  const draco::DecoderOptions options;
  const auto run = [&](auto&& decoder) {
    if (const draco::Status status = decoder.Decode(options, &buffer, &mesh); !status.ok())
      refuse(in_quotes(status.error_msg()));
  };
  try {
    if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
      run(BoundedDecoder<draco::MeshEdgebreakerDecoder>(compressed, budget));
    else if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
      run(BoundedDecoder<draco::MeshSequentialDecoder>(compressed, budget));
    else
      refuse("its method is " + std::to_string(header.encoder_method));
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {  // one of Draco's containers failed to allocate
    refuse(in_quotes(error.what()));
  }
}

/// The values of an attribute in the type of the accessor, one per point.
void read_values(const draco::Mesh& mesh, const draco::PointAttribute& attribute, const JsonCursor& index,
                 Accessor& values) {
  if (attribute.num_components() != values.components)
    index.fail("an accessor of the " + std::to_string(attribute.num_components()) + " components of its " +
                   draco_extension,
               values.type);
  values.bytes.resize(values.count * values.element_bytes);
  with_component(values.component_type, [&](auto zero) {
    using T = decltype(zero);
    std::array<T, 16> element{};
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
      const draco::AttributeValueIndex at = attribute.mapped_index(draco::PointIndex(i));
      if (at.value() >= attribute.size() ||
          !attribute.ConvertValue(at, static_cast<std::int8_t>(values.components), element.data()))
        index.fail(std::string("values in its ") + draco_extension + " within the accessor's componentType",
                   "one of vertex " + std::to_string(i) + " that is missing or beyond it");
      std::memcpy(values.bytes.data() + i * values.element_bytes, element.data(),
                  values.components * sizeof(T));
    }
  });
}

/// Half the step of floats that Draco quantised, which is not available after decoding: from the fewest bits
/// for which all values are minimum + k range / (2^bits - 1), with the minimum of the component and the
/// largest range of all. 0 if there are none.
double half_step_of(const Accessor& values) {
  if (values.component_type != component_f32 || values.count < 2) return 0;
  const std::size_t n = values.components, step = std::max<std::size_t>(1, values.count / 1000);
  std::vector<double> low(n, std::numeric_limits<double>::infinity());
  double range = 0, largest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    double high = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < values.count; ++i) {
      const double x = raw_component<float>(values, i, k);
      if (!std::isfinite(x)) return 0;
      low[k] = std::min(low[k], x), high = std::max(high, x);
    }
    range = std::max(range, high - low[k]);
    largest = std::max({largest, std::fabs(low[k]), std::fabs(high)});
  }
  if (!(range > 0)) return 0;
  constexpr int most_bits = 20;  // beyond it the steps are those of floats
  for (int bits = 1; bits <= most_bits; ++bits) {
    const double steps = static_cast<double>((1 << bits) - 1);
    const double rounding = 4 * 0x1p-24 * largest / range * steps;
    if (rounding > 0.1) return 0;
    bool all = true;
    for (std::size_t i = 0; all && i < values.count; i += step)
      for (std::size_t k = 0; all && k < n; ++k) {
        const double place = (raw_component<float>(values, i, k) - low[k]) / range * steps;
        all = std::fabs(place - std::round(place)) <= rounding + 1e-3;
      }
    if (all) return 0.5 * range / steps;
  }
  return 0;
}

std::vector<std::uint32_t> corners_of(const draco::Mesh& mesh, const JsonCursor& compressed) {
  std::vector<std::uint32_t> corners;
  corners.reserve(std::size_t{3} * mesh.num_faces());
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i))) {
      if (corner.value() >= mesh.num_points())
        compressed.fail("triangles of vertices below " + std::to_string(mesh.num_points()),
                        std::to_string(corner.value()));
      corners.push_back(corner.value());
    }
  if (corners.empty()) compressed.fail("at least one triangle", "none");
  return corners;
}

void expect_count(const JsonCursor& index, std::uint64_t stated, std::uint64_t decoded) {
  if (stated != decoded)
    index.fail("an accessor of the " + std::to_string(decoded) + " elements of its " + draco_extension,
               std::to_string(stated));
}

void decompress(GltfFile& file, std::size_t mesh_index, std::size_t primitive_index, Budget& budget) {
  struct Renewed {
    std::string name;
    std::size_t old_accessor;
    Accessor values;
  };
  std::vector<Renewed> attributes;
  std::vector<std::uint32_t> corners;
  {  // places refer to the document, and end before it is changed
    const JsonCursor primitive = file.root().at("meshes").at(mesh_index).at("primitives").at(primitive_index);
    const auto found = primitive.extension(draco_extension);
    if (!found) return;
    const std::uint64_t mode = primitive.has("mode") ? primitive.at("mode").integer() : triangles;
    if (mode != triangles && mode != triangle_strip)
      primitive.at("mode").fail(std::string("4 or 5 with ") + draco_extension);

    draco::Mesh mesh;
    decode(file.view_bytes(file.element("bufferViews", found->at("bufferView"))), *found, budget, mesh);
    corners = corners_of(mesh, *found);
    // In the stream, the triangles of a strip are a list.
    if (primitive.has("indices") && mode == triangles)
      expect_count(primitive.at("indices"),
                   accessor_layout(file.element("accessors", primitive.at("indices"))).count, corners.size());

    const JsonCursor ids = found->at("attributes");
    const JsonCursor all = primitive.at("attributes");
    for (const auto& [name, number] : all.json().items()) {
      if (!ids.has(name.c_str())) continue;
      const JsonCursor id = ids.at(name.c_str()), index = all.at(name.c_str());
      const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(
          static_cast<std::uint32_t>(id.integer(0, std::numeric_limits<std::uint32_t>::max())));
      if (attribute == nullptr) {
        std::string list;
        for (int i = 0; i < mesh.num_attributes(); ++i)
          list += (i == 0 ? "" : ", ") + std::to_string(mesh.attribute(i)->unique_id());
        id.fail("one of those of the stream: " + in_quotes(list));
      }
      Accessor values = accessor_layout(file.element("accessors", index));
      expect_count(index, values.count, mesh.num_points());
      read_values(mesh, *attribute, index, values);
      attributes.push_back({name, index.integer(), std::move(values)});
    }
  }
  Json& primitive = file.json["meshes"][mesh_index]["primitives"][primitive_index];
  for (Renewed& a : attributes) {
    const double step = half_step_of(a.values);
    const std::size_t index = file.append_attribute(file.json["accessors"][a.old_accessor],
                                                    std::move(a.values), a.name == "POSITION");
    file.json["meshes"][mesh_index]["primitives"][primitive_index]["attributes"][a.name] = index;
    if (step > 0) file.half_steps[index] = step;
  }
  primitive["indices"] = file.append_indices(corners);
  if (primitive.contains("mode")) primitive["mode"] = triangles;
  remove_extension(primitive, draco_extension);
}

}  // namespace

void decompress_draco(GltfFile& file) {
  Budget budget(file);
  const std::size_t meshes = file.root().has("meshes") ? file.root().at("meshes").size() : 0;
  for (std::size_t m = 0; m < meshes; ++m) {
    const JsonCursor mesh = file.root().at("meshes").at(m);
    const std::size_t primitives = mesh.has("primitives") ? mesh.at("primitives").size() : 0;
    for (std::size_t p = 0; p < primitives; ++p) decompress(file, m, p, budget);
  }
  retire_extension(file, draco_extension);
}

}  // namespace darboux::io
