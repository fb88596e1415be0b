// The container (chunks of a GLB, or plain JSON), the document's version and extensions, and its buffers.
#include <algorithm>
#include <array>
#include <cstring>

#include <darboux/error.h>

#include "gltf_file.h"

namespace darboux {
namespace io {
namespace {

constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;

std::uint32_t read_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The parts of a GLB, each a range of its bytes.
struct Chunks {
  std::string_view json, others;
  std::size_t bin_begin = 0, bin_size = 0;
  bool has_bin = false;
};

Chunks split_chunks(const std::string& path, std::string_view bytes) {
  if (bytes.size() < header_bytes + chunk_header_bytes)
    throw FileError(path, "ends within the header of a GLB, permitted are at least 20 bytes");
  if (const std::uint32_t version = read_u32(bytes, 4); version != 2)
    throw FileError(path, "is GLB version " + std::to_string(version) + ", permitted is version 2");
  // Bytes after the stated length are nobody's.
  if (const std::uint32_t length = read_u32(bytes, 8);
      length > bytes.size() || length < header_bytes + chunk_header_bytes)
    throw FileError(path, "states a length of " + std::to_string(length) + " bytes, expected at most the " +
                              std::to_string(bytes.size()) + " there are and at least 20");
  else
    bytes = bytes.substr(0, length);
  Chunks chunks;
  std::size_t at = header_bytes;
  for (std::size_t number = 0; at < bytes.size(); ++number) {
    const std::string name = "chunk " + std::to_string(number);
    if (bytes.size() - at < chunk_header_bytes) break;  // padding that some tools count in
    const std::size_t length = read_u32(bytes, at), left = bytes.size() - at - chunk_header_bytes;
    const std::uint32_t type = read_u32(bytes, at + 4);
    if (length > left)
      throw FileError(path, "states " + std::to_string(length) + " bytes for " + name +
                                ", permitted are the " + std::to_string(left) + " that follow");
    if (number == 0 && type != json_chunk)
      throw FileError(path, "has a first chunk that is not JSON, permitted is the JSON chunk first");
    if (number == 0) {
      chunks.json = bytes.substr(at + chunk_header_bytes, length);
    } else if (number == 1 && type == bin_chunk) {
      chunks.has_bin = true;
      chunks.bin_begin = at + chunk_header_bytes;
      chunks.bin_size = length;
    } else if (chunks.others.empty()) {
      chunks.others = bytes.substr(at);
    }
    at += chunk_header_bytes + length;
  }
  return chunks;
}

// Extensions that change triangles or hang on them, and are known.
constexpr std::string_view known_extensions[] = {"KHR_mesh_quantization",   "KHR_draco_mesh_compression",
                                                 "EXT_meshopt_compression", "KHR_materials_variants",
                                                 "EXT_mesh_features",       "EXT_structural_metadata",
                                                 "EXT_mesh_manifold",       "CESIUM_primitive_outline"};

void check_version(const Place& document) {
  const Place asset = document.at("asset");
  const Place version = asset.at("version");
  if (!version.text().starts_with("2."))
    version.fail("is " + version.shown() + ", permitted is glTF \"2.0\" and its minor versions");
  if (asset.has("minVersion") && asset.at("minVersion").text() != "2.0")
    asset.at("minVersion").fail("is " + asset.at("minVersion").shown() + ", permitted is \"2.0\"");
}

// Whether some object that holds triangles has the extension.
bool hangs_on_triangles(const Place& document, const char* name) {
  const auto any = [&](const Place& owner, const char* key, auto&& also) {
    if (!owner.has(key)) return false;
    const Place list = owner.at(key);
    for (std::size_t i = 0; i < list.size(); ++i)
      if (list.at(i).extension(name) || also(list.at(i))) return true;
    return false;
  };
  const auto nothing = [](const Place&) { return false; };
  for (const char* key : {"buffers", "bufferViews", "accessors"})
    if (any(document, key, nothing)) return true;
  return any(document, "meshes", [&](const Place& mesh) { return any(mesh, "primitives", nothing); });
}

// A required extension that is unknown is refused where it may change triangles. Materials, textures, lights,
// animations and nodes have no part in a mesh in its own space.
void check_extensions(const Place& document) {
  if (!document.has("extensionsRequired")) return;
  const Place required = document.at("extensionsRequired");
  for (std::size_t i = 0; i < required.size(); ++i) {
    const std::string& name = required.at(i).text();
    if (std::find(std::begin(known_extensions), std::end(known_extensions), name) !=
            std::end(known_extensions) ||
        !hangs_on_triangles(document, name.c_str()))
      continue;
    std::string list;
    for (const std::string_view known : known_extensions)
      list += (list.empty() ? "" : ", ") + std::string(known);
    required.at(i).fail("may change triangles, expected one of " + list + " there, got " + in_quotes(name));
  }
}

void check_arrays(const Place& document) {
  for (const char* key :
       {"accessors", "buffers", "bufferViews", "images", "materials", "meshes", "nodes", "scenes"})
    if (document.has(key)) document.at(key).size();
}

/// \param chunk the binary chunk where there is one
void load_buffers(GltfFile& file, std::optional<std::string> chunk) {
  if (!file.root().has("buffers")) return;
  const Place buffers = file.root().at("buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const Place buffer = buffers.at(i);
    const std::uint64_t length = buffer.at("byteLength").integer(1);
    std::optional<std::string> bytes;
    // A fallback is for readers that do not know the extension.
    const auto meshopt = buffer.extension("EXT_meshopt_compression");
    const bool fallback = meshopt && meshopt->has("fallback") && meshopt->at("fallback").boolean();
    if (buffer.has("uri")) {
      const Place uri = buffer.at("uri");
      if (!fallback) bytes = load_uri(file.path, uri.name(), uri.text());
    } else if (i == 0) {
      bytes = std::move(chunk);
    }
    if (bytes && bytes->size() < length)
      buffer.at("byteLength")
          .fail("is " + std::to_string(length) + ", permitted are at most the " +
                std::to_string(bytes->size()) + " bytes there are");
    file.buffers.push_back(std::move(bytes));
  }
}

/// Refuses what would take the parser's stack or its time: deep nesting, and objects of very many keys, each
/// of which is looked for among the ones before it.
void check_nesting(const std::string& file, std::string_view text) {
  constexpr std::size_t most_levels = 256, most_keys = 10000;
  std::array<std::size_t, most_levels + 1> keys{};
  std::size_t level = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_text = !in_text;
    if (in_text) {
      if (c == '\\') ++i;  // what follows does not end the text
      continue;
    }
    if (c == '{' || c == '[') {
      if (++level > most_levels)
        throw FileError(
            file, "nests JSON deeper than " + std::to_string(most_levels) + " levels, permitted are fewer");
      keys[level] = 0;
    }
    if ((c == '}' || c == ']') && level > 0) --level;
    if (c == ':' && ++keys[level] > most_keys)
      throw FileError(
          file, "has a JSON object of more than " + std::to_string(most_keys) + " keys, permitted are fewer");
  }
}

}  // namespace

Json parse_json(const std::string& file, std::string_view text) {
  check_nesting(file, text);
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& error) {
    throw FileError(file, "is not JSON at byte " + std::to_string(error.byte) +
                              " of the document, permitted is JSON in UTF-8");
  } catch (const Json::exception& error) {  // a number beyond the range of double
    throw FileError(file, "holds JSON that cannot be read (" + in_quotes(error.what()) +
                              "), permitted are numbers in the range of double");
  }
}

GltfFile load_gltf(const std::string& path, std::string bytes) {
  GltfFile file;
  file.path = path;
  std::optional<std::string> chunk;
  if (bytes.starts_with("glTF")) {
    const Chunks chunks = split_chunks(path, bytes);
    file.json = parse_json(path, chunks.json);
    file.other_chunks = chunks.others;
    if (chunks.has_bin) {
      bytes.resize(chunks.bin_begin + chunks.bin_size);
      bytes.erase(0, chunks.bin_begin);
      chunk = std::move(bytes);
    }
  } else {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    const std::size_t skip = bytes.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
    const std::size_t first = bytes.find_first_not_of(" \t\r\n", skip);
    if (first == std::string::npos || bytes[first] != '{')
      throw FileError(path, bytes.empty()
                                ? "is empty, permitted is glTF 2.0"
                                : "is not glTF, permitted is a GLB, which begins \"glTF\", or a JSON object");
    file.json = parse_json(path, bytes);
  }
  if (!file.json.is_object()) throw FileError(path, "is not a JSON object, permitted is glTF 2.0");
  check_version(file.root());
  check_extensions(file.root());
  check_arrays(file.root());
  load_buffers(file, std::move(chunk));
  decompress_meshopt(file);
  decompress_draco(file);
  return file;
}

void remove_extension(Json& owner, const char* name) {
  if (const auto extensions = owner.find("extensions"); extensions != owner.end()) {
    extensions->erase(name);
    if (extensions->empty()) owner.erase("extensions");
  }
}

void retire_extension(GltfFile& file, const char* name) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    if (const auto found = file.json.find(list); found != file.json.end() && found->is_array()) {
      found->erase(std::remove(found->begin(), found->end(), name), found->end());
      if (found->empty()) file.json.erase(list);
    }
}

}  // namespace io

io::Place GltfFile::element(const char* array, const io::Place& index) const {
  const std::size_t size = root().has(array) ? root().at(array).size() : 0;
  const std::uint64_t number = index.integer();
  if (number >= size)
    index.fail("is " + std::to_string(number) + ", permitted are " +
               (size == 0 ? "none: there are no " + std::string(array)
                          : "0 to " + std::to_string(size - 1) + ", the " + array + " there are"));
  return root().at(array).at(number);
}

std::string_view GltfFile::view_bytes(const io::Place& view) const {
  const io::Place buffer_index = view.at("buffer");
  const io::Place buffer = element("buffers", buffer_index);
  const auto& bytes = buffers[buffer_index.integer()];
  if (!bytes) buffer.fail("has no data, permitted are a uri or, for buffer 0, the binary chunk of a GLB");
  const std::uint64_t available = buffer.at("byteLength").integer();
  const std::uint64_t offset = view.integer_or("byteOffset", 0);
  const std::uint64_t length = view.at("byteLength").integer(1);
  if (offset > available || length > available - offset)
    view.fail("asks for " + std::to_string(length) + " bytes from byte " + std::to_string(offset) +
              ", permitted are the " + std::to_string(available) + " bytes of " + buffer.name());
  return std::string_view(*bytes).substr(offset, length);
}

}  // namespace darboux
