// Appending to a glTF file and writing it as a GLB.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include <darboux/error.h>
#include <darboux/io.h>

#include "accessor.h"
#include "base/text.h"

namespace darboux {
namespace {

using io::Json;
using io::JsonCursor;

constexpr std::size_t round_up_4(std::size_t n) {
  return (n + 3) / 4 * 4;
}
constexpr std::string_view zeros("\0\0\0", 3);

template <class T>
std::string_view as_bytes(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

void append_u32(std::string& bytes, std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  bytes.append(reinterpret_cast<const char*>(&word), sizeof word);
}

/// The header of a GLB chunk, whose content is padded to a multiple of 4 bytes.
void append_chunk_header(std::string& glb, std::uint32_t type, std::size_t size) {
  append_u32(glb, round_up_4(size));
  append_u32(glb, type);
}

/// A copy of values as bytes.
template <class T>
io::Piece copied(std::span<const T> values) {
  return io::Piece::of(std::string(as_bytes(values)));
}

/// The media type of an image by its first bytes, whatever the document states; empty if unknown.
std::string image_type(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return "image/png";
  if (bytes.starts_with("\xFF\xD8\xFF")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "image/webp";
  if (bytes.starts_with("\xABKTX 20\xBB")) return "image/ktx2";
  return {};
}

/// Turns the URI of an image beside the file into a data URI. If that is impossible, leaves the image as it
/// is and returns the reason.
std::optional<std::string> embed_image(const GltfFile& file, Json& image) {
  if (!image.is_object() || !image.contains("uri") || !image["uri"].is_string()) return std::nullopt;
  const std::string uri = image["uri"];
  if (io::is_data_uri(uri)) return std::nullopt;
  try {
    const std::string bytes = io::load_uri(file.path, "an image", uri, file.options);
    const std::string type = image_type(bytes);
    if (type.empty()) return expected_got("PNG, JPEG, WebP or KTX2", "another kind of image");
    image["uri"] = io::make_data_uri(type, bytes);
  } catch (const io::OutsideError&) {
    throw;
  } catch (const FileError& error) {
    // Tangents do not depend on images, so a missing one is no reason to fail.
    const std::string why = error.what(), of_file = file.path + ": ";
    return why.starts_with(of_file) ? why.substr(of_file.size()) : why;
  }
  return std::nullopt;
}

/// The minimum and maximum of each component, as glTF's min and max; none if some component has no finite
/// value.
std::optional<std::pair<Json, Json>> bounds(const io::Accessor& accessor) {
  Json least = Json::array(), greatest = Json::array();
  bool complete = true;
  io::with_component(accessor.component_type, [&](auto zero) {
    using T = decltype(zero);
    for (std::size_t c = 0; c < accessor.components; ++c) {
      std::optional<T> low, high;
      for (std::size_t i = 0; i < accessor.count; ++i) {
        const T value = io::raw_component<T>(accessor, i, c);
        if (!std::isfinite(static_cast<double>(value))) continue;
        low = low ? std::min(*low, value) : value;
        high = high ? std::max(*high, value) : value;
      }
      complete = complete && low;
      least.push_back(low.value_or(T{}));
      greatest.push_back(high.value_or(T{}));
    }
  });
  return complete ? std::optional(std::pair(least, greatest)) : std::nullopt;
}

/// A new accessor over the old one's elements source[0], source[1], ... Its other properties are kept.
std::size_t append_remapped(GltfFile& file, std::size_t old_index, const io::Accessor& old, bool need_bounds,
                            std::span<const std::uint32_t> source) {
  const std::size_t size = old.element_bytes;
  io::Accessor remapped = old;
  remapped.count = source.size();
  remapped.bytes.assign(source.size() * size, '\0');
  for (std::size_t i = 0; i < source.size(); ++i)
    std::memcpy(remapped.bytes.data() + i * size, old.bytes.data() + source[i] * size, size);
  return file.append_attribute(file.json["accessors"][old_index], std::move(remapped), need_bounds);
}

std::string primitive_name(std::size_t mesh, std::size_t primitive) {
  return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
}

JsonCursor find_primitive(const GltfFile& file, std::size_t mesh, std::size_t primitive) {
  const JsonCursor root = file.root();
  const std::size_t meshes = root.has("meshes") ? root.at("meshes").size() : 0;
  const std::size_t primitives = mesh < meshes ? root.at("meshes").at(mesh).at("primitives").size() : 0;
  if (primitive >= primitives)
    throw MeshError(
        file.path,
        expected_got(mesh < meshes ? "one of the " + std::to_string(primitives) + " primitives of that mesh"
                                   : "one of the " + std::to_string(meshes) + " meshes there are",
                     primitive_name(mesh, primitive)));
  return root.at("meshes").at(mesh).at("primitives").at(primitive);
}

}  // namespace

std::size_t GltfFile::append_bytes(io::Piece bytes) {
  if (buffers.empty()) {
    json["buffers"] = Json::array({Json{{"byteLength", 0u}}});
    buffers.emplace_back(std::string());
  }
  if (!buffers[0])
    root().at("buffers").at(std::size_t{0}).fail("a buffer with data, to append to", "one without");
  io::BufferBytes& chunk = *buffers[0];
  const std::size_t offset = round_up_4(chunk.size());
  if (offset != chunk.size()) chunk.append({zeros.substr(0, offset - chunk.size()), nullptr});
  chunk.append(std::move(bytes));
  json["buffers"][0]["byteLength"] = chunk.size();
  return offset;
}

std::size_t GltfFile::append_view(io::Piece bytes, std::size_t stride, int target) {
  const std::size_t length = bytes.bytes.size(), offset = append_bytes(std::move(bytes));
  Json view = {{"buffer", 0u}, {"byteOffset", offset}, {"byteLength", length}};
  if (stride != 0) view["byteStride"] = stride;
  view["target"] = target;
  json["bufferViews"].push_back(std::move(view));
  return json["bufferViews"].size() - 1;
}

std::size_t GltfFile::append_accessor(Json accessor) {
  json["accessors"].push_back(std::move(accessor));
  return json["accessors"].size() - 1;
}

std::size_t GltfFile::append_attribute(Json accessor, io::Accessor elements, bool need_bounds) {
  const std::size_t size = elements.element_bytes, stride = round_up_4(size);
  need_bounds = need_bounds || accessor.contains("min") || accessor.contains("max");
  for (const char* key : {"byteOffset", "sparse", "min", "max"}) accessor.erase(key);
  std::optional<std::pair<Json, Json>> range;
  if (need_bounds && !elements.type.starts_with("MAT")) range = bounds(elements);
  if (stride != size) {
    std::string strided(elements.count * stride, '\0');
    for (std::size_t i = 0; i < elements.count; ++i)
      std::memcpy(strided.data() + i * stride, elements.bytes.data() + i * size, size);
    elements.bytes = std::move(strided);
  }
  accessor["bufferView"] =
      append_view(io::Piece::of(std::move(elements.bytes)), stride == size ? 0 : stride, io::vertex_target);
  accessor["count"] = elements.count;
  if (range) {
    accessor["min"] = range->first;
    accessor["max"] = range->second;
  }
  return append_accessor(std::move(accessor));
}

std::size_t GltfFile::append_indices(std::span<const std::uint32_t> indices) {
  // 65535 is the restart value of 16-bit indices, which glTF forbids.
  const bool narrow = *std::max_element(indices.begin(), indices.end()) < 65535;
  const std::vector<std::uint16_t> narrowed(indices.begin(), narrow ? indices.end() : indices.begin());
  const std::size_t view = append_view(
      narrow ? copied(std::span<const std::uint16_t>(narrowed)) : copied(indices), 0, io::index_target);
  return append_accessor({{"bufferView", view},
                          {"componentType", narrow ? io::component_u16 : io::component_u32},
                          {"count", indices.size()},
                          {"type", "SCALAR"}});
}

std::vector<io::Piece> GltfFile::glb_pieces(std::vector<std::string>* kept) const {
  Json document = json;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    Json& buffer = document["buffers"][i];
    if (i == 0 && buffers[0])
      buffer.erase("uri");
    else if (buffers[i] && !io::is_data_uri(buffer["uri"].get_ref<const std::string&>()))
      buffer["uri"] = io::make_data_uri("application/octet-stream", buffers[i]->joined());
  }
  if (const auto images = document.find("images"); images != document.end() && images->is_array())
    for (std::size_t i = 0; i < images->size(); ++i)
      if (const auto why = embed_image(*this, (*images)[i]); why && kept)
        kept->push_back("images[" + std::to_string(i) + "] keeps its URI '" +
                        (*images)[i]["uri"].get<std::string>() + "' and is not in the GLB: " + *why);

  // All strings of the document were validated as UTF-8 when read; those from a caller may be invalid.
  std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::size_t size = text.size();
  text.resize(round_up_4(size), ' ');
  std::string head = "glTF";
  append_u32(head, 2);
  append_u32(head, 0);  // the length, known at the end
  append_chunk_header(head, io::json_chunk, size);
  head += text;
  std::vector<io::Piece> pieces(1);
  std::size_t length = other_chunks.size();
  if (!buffers.empty() && buffers[0]) {
    const io::BufferBytes& bin = *buffers[0];
    append_chunk_header(head, io::bin_chunk, bin.size());
    pieces.insert(pieces.end(), bin.pieces().begin(), bin.pieces().end());
    pieces.push_back({zeros.substr(0, round_up_4(bin.size()) - bin.size()), nullptr});
    length += round_up_4(bin.size());
  }
  length += head.size();
  pieces.push_back({other_chunks, nullptr});
  if (length > std::numeric_limits<std::uint32_t>::max())
    throw FileError(path, expected_got("a GLB of less than 4 GiB", std::to_string(length) + " bytes"));
  const auto stated = static_cast<std::uint32_t>(length);
  std::memcpy(head.data() + 8, &stated, sizeof stated);
  pieces[0] = io::Piece::of(std::move(head));
  return pieces;
}

std::string GltfFile::to_glb(std::vector<std::string>* kept) const {
  std::string glb;
  for (const io::Piece& piece : glb_pieces(kept)) glb += piece.bytes;
  return glb;
}

GltfDocument::GltfDocument(std::unique_ptr<GltfFile> file) : file_(std::move(file)) {}
GltfDocument::GltfDocument(GltfDocument&&) noexcept = default;
GltfDocument& GltfDocument::operator=(GltfDocument&&) noexcept = default;
GltfDocument::~GltfDocument() = default;

GltfDocument GltfDocument::load(const std::string& path, const ReadOptions& options) {
  return GltfDocument(std::make_unique<GltfFile>(io::load_gltf(path, io::map_file(path), options)));
}

const std::string& GltfDocument::path() const {
  return file_->path;
}

Asset GltfDocument::asset() const {
  return io::read_gltf(*file_);
}

std::vector<MorphTarget> GltfDocument::morph_targets(const Primitive& primitive) const {
  return io::read_targets(*file_, find_primitive(*file_, primitive.mesh, primitive.primitive),
                          primitive.texcoord, primitive.data.positions.size());
}

void GltfDocument::set_colours(std::size_t mesh, std::size_t primitive, std::span<const Vec3<float>> colours,
                               const std::string& extras_json) {
  static_assert(sizeof(Vec3<float>) == 12);
  constexpr const char* unlit = "KHR_materials_unlit";
  const JsonCursor position = find_primitive(*file_, mesh, primitive).at("attributes").at("POSITION");
  const std::uint64_t vertices = file_->element("accessors", position).at("count").integer(1);
  if (colours.size() != vertices)
    throw MeshError(file_->path, primitive_name(mesh, primitive) + ": " +
                                     expected_got("one colour per vertex, " + std::to_string(vertices),
                                                  std::to_string(colours.size())));
  const Json extras = io::parse_extras("set_colours", extras_json);
  const JsonCursor root = file_->root();
  for (const char* list : {"materials", "extensionsUsed"})
    if (root.has(list)) root.at(list).size();  // rejects anything but an array

  const auto place_in = [](Json& list, const Json& item) {
    const auto at = std::find(list.begin(), list.end(), item);
    const auto index = static_cast<std::size_t>(at - list.begin());
    if (at == list.end()) list.push_back(item);
    return index;
  };
  const Json white = {{"name", "Darboux: the vertices' own colours"},
                      {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
                      {"doubleSided", true},
                      {"extensions", {{unlit, Json::object()}}}};
  const std::size_t view = file_->append_view(copied(colours), 0, io::vertex_target);
  const std::size_t accessor = file_->append_accessor(
      {{"bufferView", view}, {"componentType", io::component_f32}, {"count", vertices}, {"type", "VEC3"}});
  place_in(file_->json["extensionsUsed"], unlit);
  const std::size_t material = place_in(file_->json["materials"], white);
  Json& json = file_->json["meshes"][mesh];
  Json& painted = json["primitives"][primitive];
  painted["attributes"]["COLOR_0"] = accessor;
  painted["material"] = material;
  // A variant's material would hide the colours.
  if (painted.contains("extensions") && painted["extensions"].is_object())
    painted["extensions"].erase("KHR_materials_variants");
  if (!json.contains("extras") || json["extras"].is_object()) json["extras"].update(extras);
}

void GltfFile::set_tangents(std::size_t mesh, std::size_t primitive, io::Piece tangents,
                            const std::vector<io::Piece>& deltas) {
  const JsonCursor place = find_primitive(*this, mesh, primitive);
  const JsonCursor position = place.at("attributes").at("POSITION");
  const std::uint64_t vertices = element("accessors", position).at("count").integer(1);
  const auto check_count = [&](std::size_t given, std::uint64_t wanted, const char* what) {
    if (given != wanted)
      throw MeshError(path, primitive_name(mesh, primitive) + ": " +
                                expected_got(what + (", " + std::to_string(wanted)), std::to_string(given)));
  };
  check_count(tangents.bytes.size() / sizeof(Vec4<float>), vertices, "one tangent per vertex");
  const std::size_t targets = place.has("targets") ? place.at("targets").size() : 0;
  if (!deltas.empty()) check_count(deltas.size(), targets, "one list of deltas per morph target");
  for (const io::Piece& list : deltas)
    check_count(list.bytes.size() / sizeof(Vec3<float>), vertices, "one delta per vertex");

  const auto append = [&](io::Piece bytes, const char* type) {
    const std::size_t view = append_view(std::move(bytes), 0, io::vertex_target);
    return append_accessor(
        {{"bufferView", view}, {"componentType", io::component_f32}, {"count", vertices}, {"type", type}});
  };
  const std::size_t base = append(std::move(tangents), "VEC4");
  std::vector<std::size_t> of_targets;
  for (const io::Piece& list : deltas) of_targets.push_back(append(list, "VEC3"));
  Json& changed = json["meshes"][mesh]["primitives"][primitive];
  changed["attributes"]["TANGENT"] = base;
  for (std::size_t i = 0; i < of_targets.size(); ++i) changed["targets"][i]["TANGENT"] = of_targets[i];
}

void GltfDocument::set_tangents(std::size_t mesh, std::size_t primitive,
                                std::span<const Vec4<float>> tangents,
                                std::span<const std::vector<Vec3<float>>> deltas) {
  static_assert(sizeof(Vec4<float>) == 16 && sizeof(Vec3<float>) == 12);
  std::vector<io::Piece> of_targets;
  for (const auto& list : deltas) of_targets.push_back(copied(std::span(list)));
  file_->set_tangents(mesh, primitive, copied(tangents), of_targets);
}

void GltfDocument::remap_vertices(std::size_t mesh, std::size_t primitive,
                                  std::span<const std::uint32_t> source,
                                  std::span<const std::uint32_t> indices, bool without_tangents) {
  const JsonCursor place = find_primitive(*file_, mesh, primitive);
  const std::string name = primitive_name(mesh, primitive);
  const JsonCursor position = place.at("attributes").at("POSITION");
  const std::uint64_t vertices = file_->element("accessors", position).at("count").integer(1);
  const auto check_range = [&](std::span<const std::uint32_t> list, const char* what, std::uint64_t end) {
    for (const std::uint32_t index : list)
      if (index >= end)
        throw MeshError(
            file_->path,
            name + ": " + expected_got(what + (" below " + std::to_string(end)), std::to_string(index)));
  };
  if (source.empty() || indices.empty() || indices.size() % 3 != 0)
    throw MeshError(file_->path, name + ": " +
                                     expected_got("at least one triangle and a multiple of 3 indices",
                                                  std::to_string(source.size()) + " vertices and " +
                                                      std::to_string(indices.size()) + " indices"));
  check_range(source, "old vertex", vertices);
  check_range(indices, "index", source.size());

  // Everything is read before anything is changed. A shared accessor is copied once.
  std::map<std::uint64_t, io::Accessor> old;
  const auto copied = [&](const std::string& key) { return !without_tangents || key != "TANGENT"; };
  const auto collect = [&](const JsonCursor& attributes) {
    for (const auto& [key, index] : attributes.json().items()) {
      if (!copied(key)) continue;
      const JsonCursor attribute = attributes.at(key.c_str());
      const io::Accessor accessor = io::read_accessor(*file_, attribute);
      if (accessor.count != vertices)
        attribute.fail("an accessor of as many elements as POSITION's, " + std::to_string(vertices),
                       std::to_string(accessor.count));
      old.emplace(attribute.integer(), accessor);
    }
  };
  collect(place.at("attributes"));
  const std::size_t targets = place.has("targets") ? place.at("targets").size() : 0;
  for (std::size_t i = 0; i < targets; ++i) collect(place.at("targets").at(i));

  std::map<std::uint64_t, std::size_t> renewed;
  for (const auto& [index, accessor] : old)
    renewed[index] = append_remapped(*file_, index, accessor, index == position.integer(), source);
  const auto renew = [&](Json& attributes) {
    for (auto& [key, index] : attributes.items())
      if (copied(key)) index = renewed.at(index.get<std::uint64_t>());
  };
  const std::size_t new_indices = file_->append_indices(indices);
  Json& json = file_->json["meshes"][mesh]["primitives"][primitive];
  renew(json["attributes"]);
  for (std::size_t i = 0; i < targets; ++i) renew(json["targets"][i]);
  json["indices"] = new_indices;
  if (json.contains("mode")) json["mode"] = io::triangles;
}

std::vector<std::string> GltfDocument::save_glb(const std::string& path) const {
  std::vector<std::string> kept;
  OutputFile file(path);
  if (file.is_written_in_place())  // it may be the file that is mapped
    file.write(file_->to_glb(&kept));
  else
    for (const io::Piece& piece : file_->glb_pieces(&kept)) file.write(piece.bytes);
  file.commit();
  return kept;
}

}  // namespace darboux
