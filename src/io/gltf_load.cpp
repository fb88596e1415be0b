// The container (chunks of a GLB, or plain JSON), the document's version and extensions, and its buffers.
#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <darboux/error.h>

#include "base/text.h"
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

/// The length stated in the header of a GLB. \throws FileError if it exceeds the file
std::size_t stated_length(const std::string& path, std::string_view header, std::uintmax_t there) {
  const std::size_t stated = read_u32(header, 8);
  if (stated > there)
    throw FileError(path, expected_got("the " + std::to_string(stated) + " bytes that its header states",
                                       std::to_string(there) + ": the file is cut off"));
  return stated;
}

Chunks split_chunks(const std::string& path, std::string_view bytes) {
  if (bytes.size() < header_bytes + chunk_header_bytes)
    throw FileError(path,
                    expected_got("the header of a GLB, of at least 20 bytes", std::to_string(bytes.size())));
  if (const std::uint32_t version = read_u32(bytes, 4); version != 2)
    throw FileError(path, expected_got("GLB version 2", "version " + std::to_string(version)));
  const std::size_t stated = stated_length(path, bytes, bytes.size());
  if (stated < header_bytes + chunk_header_bytes)
    throw FileError(path, expected_got("a stated length of at least 20 bytes", std::to_string(stated)));
  bytes = bytes.substr(0, stated);  // those after it are ignored
  Chunks chunks;
  std::size_t at = header_bytes;
  for (std::size_t number = 0; at < bytes.size(); ++number) {
    const std::string name = "chunk " + std::to_string(number);
    if (bytes.size() - at < chunk_header_bytes) break;  // padding that some tools count in
    const std::size_t length = read_u32(bytes, at), left = bytes.size() - at - chunk_header_bytes;
    const std::uint32_t type = read_u32(bytes, at + 4);
    if (length > left)
      throw FileError(path, name + ": " +
                                expected_got("at most the " + std::to_string(left) + " bytes that follow",
                                             std::to_string(length)));
    if (number == 0 && type != json_chunk)
      throw FileError(path, expected_got("the JSON chunk first", "another"));
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

// Known extensions that change triangles or are attached to them.
constexpr std::string_view known_extensions[] = {"KHR_mesh_quantization",   "KHR_draco_mesh_compression",
                                                 "EXT_meshopt_compression", "KHR_materials_variants",
                                                 "EXT_mesh_features",       "EXT_structural_metadata",
                                                 "EXT_mesh_manifold",       "CESIUM_primitive_outline"};

void check_version(const JsonCursor& document) {
  const JsonCursor asset = document.at("asset");
  const JsonCursor version = asset.at("version");
  if (!version.text().starts_with("2.")) version.fail("glTF \"2.0\" or one of its minor versions");
  if (asset.has("minVersion") && asset.at("minVersion").text() != "2.0")
    asset.at("minVersion").fail("\"2.0\"");
}

// Whether some object with triangles has the extension.
bool hangs_on_triangles(const JsonCursor& document, const char* name) {
  const auto any = [&](const JsonCursor& owner, const char* key, auto&& also) {
    if (!owner.has(key)) return false;
    const JsonCursor list = owner.at(key);
    for (std::size_t i = 0; i < list.size(); ++i)
      if (list.at(i).extension(name) || also(list.at(i))) return true;
    return false;
  };
  const auto nothing = [](const JsonCursor&) { return false; };
  for (const char* key : {"buffers", "bufferViews", "accessors"})
    if (any(document, key, nothing)) return true;
  return any(document, "meshes", [&](const JsonCursor& mesh) { return any(mesh, "primitives", nothing); });
}

// An unknown required extension is refused if it may change triangles. Materials, textures, lights,
// animations and nodes do not affect a mesh in its own space.
void check_extensions(const JsonCursor& document) {
  if (!document.has("extensionsRequired")) return;
  const JsonCursor required = document.at("extensionsRequired");
  for (std::size_t i = 0; i < required.size(); ++i) {
    const std::string& name = required.at(i).text();
    if (std::find(std::begin(known_extensions), std::end(known_extensions), name) !=
            std::end(known_extensions) ||
        !hangs_on_triangles(document, name.c_str()))
      continue;
    std::string list;
    for (const std::string_view known : known_extensions)
      list += (list.empty() ? "" : ", ") + std::string(known);
    required.at(i).fail("one of " + list + " where triangles may be changed");
  }
}

void check_arrays(const JsonCursor& document) {
  for (const char* key :
       {"accessors", "buffers", "bufferViews", "images", "materials", "meshes", "nodes", "scenes"})
    if (document.has(key)) document.at(key).size();
}

/// The bytes of one buffer; none if none are to be read. \param chunk the binary chunk, if any; a first
/// buffer without a uri takes it
std::optional<BufferBytes> load_buffer(const GltfFile& file, const JsonCursor& buffer, bool is_first,
                                       const std::optional<Piece>& chunk) {
  const std::uint64_t length = buffer.at("byteLength").integer(1);
  std::optional<BufferBytes> bytes;
  // A fallback buffer is for readers that do not support the extension.
  const auto meshopt = buffer.extension("EXT_meshopt_compression");
  const bool fallback = meshopt && meshopt->has("fallback") && meshopt->at("fallback").boolean();
  if (buffer.has("uri")) {
    const JsonCursor uri = buffer.at("uri");
    if (!fallback) bytes = load_uri(file.path, uri.name(), uri.text(), file.options);
  } else if (is_first && chunk) {
    bytes = *chunk;
  }
  if (bytes && bytes->size() < length)
    buffer.at("byteLength").fail("at most the " + std::to_string(bytes->size()) + " bytes there are");
  return bytes;
}

/// \param chunk the binary chunk, if any
void load_buffers(GltfFile& file, const std::optional<Piece>& chunk) {
  if (!file.root().has("buffers")) return;
  const JsonCursor buffers = file.root().at("buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i)
    file.buffers.push_back(load_buffer(file, buffers.at(i), i == 0, chunk));
}

/// Refuses documents that would exhaust the parser's stack or take long: deep nesting, and objects with very
/// many keys, each of which is searched for among the previous ones.
void check_nesting(const std::string& file, std::string_view text) {
  constexpr std::size_t most_levels = 256, most_keys = 10000;
  struct Level {
    std::size_t begin = 0, keys = 0;
  };
  std::array<Level, most_levels + 1> levels{};
  std::size_t level = 0;
  bool in_text = false;
  const auto leave = [&] {
    const Level& left = levels[level];
    if (left.keys > most_keys)
      throw FileError(file, "the object at byte " + std::to_string(left.begin) + " of the document: " +
                                expected_got("at most " + std::to_string(most_keys) + " keys",
                                             std::to_string(left.keys)));
    if (level > 0) --level;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') in_text = !in_text;
    if (in_text) {
      if (c == '\\') ++i;  // an escaped character does not end the string
      continue;
    }
    if (c == '{' || c == '[') {
      if (++level > most_levels)
        throw FileError(
            file, "byte " + std::to_string(i) + " of the document: " +
                      expected_got("JSON of at most " + std::to_string(most_levels) + " levels", "one more"));
      levels[level] = {i, 0};
    }
    if (c == '}' || c == ']') leave();
    if (c == ':') ++levels[level].keys;
  }
  while (level > 0) leave();  // of a truncated document
}

}  // namespace

void refuse_json(const std::string& file, const nlohmann::detail::exception& error) {
  if (const auto* parse = dynamic_cast<const Json::parse_error*>(&error))
    throw FileError(
        file, expected_got("JSON in UTF-8",
                           "something else at byte " + std::to_string(parse->byte) + " of the document"));
  const std::string_view text = error.what();  // which ends with the number, in quotes
  throw FileError(file, expected_got("JSON with numbers in the range of double",
                                     text.substr(std::min(text.find('\''), text.size()))));
}

Json parse_json(const std::string& file, std::string_view text) {
  check_nesting(file, text);
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::exception& error) {
    refuse_json(file, error);
  }
}

namespace {

// The JSON of a document that is not a GLB; refuses anything else.
std::string_view json_text(const std::string& path, std::string_view bytes) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  const std::size_t skip = bytes.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n", skip);
  if (first != std::string_view::npos && bytes[first] == '{') return bytes;
  const std::string extension = lower(std::filesystem::path(path).extension().string());
  const auto known = asset_extensions();
  const bool other = extension != ".glb" && extension != ".gltf" &&
                     std::find(known.begin(), known.end(), extension) != known.end();
  throw FileError(
      path, expected_got("a GLB, which begins \"glTF\", or a JSON object",
                         bytes.empty() ? "an empty file" : "neither") +
                (other ? ". Only glTF is read here: convert " + extension +
                             " to .glb first, with Blender or `assimp export IN" + extension + " OUT.glb`"
                       : ""));
}

void check_document(const GltfFile& file) {
  if (!file.json.is_object())
    throw FileError(file.path, expected_got("glTF 2.0, a JSON object", "another JSON value"));
  // Arrays are looked up again for each of their elements.
  constexpr std::size_t most_keys = 1000;
  if (file.json.size() > most_keys)
    file.root().fail("an object of at most " + std::to_string(most_keys) + " keys, of which glTF defines 19",
                     std::to_string(file.json.size()));
  check_version(file.root());
}

}  // namespace

GltfFile load_gltf(const std::string& path, Piece all, const ReadOptions& options) {
  GltfFile file;
  file.options = options;
  file.path = path;
  const std::string_view bytes = all.bytes;
  std::optional<Piece> chunk;
  if (bytes.starts_with("glTF")) {
    const Chunks chunks = split_chunks(path, bytes);
    file.json = parse_json(path, chunks.json);
    file.json_bytes = chunks.json.size();
    file.other_chunks = chunks.others;
    if (chunks.has_bin) chunk = all.part(chunks.bin_begin, chunks.bin_size);
  } else {
    file.json = parse_json(path, json_text(path, bytes));
    file.json_bytes = bytes.size();
  }
  check_document(file);
  check_extensions(file.root());
  check_arrays(file.root());
  load_buffers(file, chunk);
  file.stored_bytes = file.bytes();
  decompress_meshopt(file);
  decompress_draco(file);
  return file;
}

GltfFile load_gltf_json(const std::string& path, const ReadOptions& options) {
  expect_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(header_bytes + chunk_header_bytes, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  GltfFile file;
  file.options = options;
  file.path = path;
  if (bytes.starts_with("glTF") && bytes.size() == header_bytes + chunk_header_bytes) {
    const std::size_t length = read_u32(bytes, header_bytes);
    const std::uintmax_t there = std::filesystem::file_size(path);
    stated_length(path, bytes, there);
    if (length > there - bytes.size())
      throw FileError(path,
                      expected_got("a JSON chunk of at most the " + std::to_string(there - bytes.size()) +
                                       " bytes that follow its header",
                                   std::to_string(length)));
    std::string rest(length, '\0');
    stream.read(rest.data(), static_cast<std::streamsize>(rest.size()));
    // A GLB whose document is its last chunk.
    bytes += rest;
    const auto total = static_cast<std::uint32_t>(bytes.size());
    std::memcpy(bytes.data() + 8, &total, sizeof total);
    file.json = parse_json(path, split_chunks(path, bytes).json);
  } else if (bytes.starts_with("glTF")) {
    split_chunks(path, bytes);  // rejects files that are too short
  } else {
    file.json = parse_json(path, json_text(path, read_file(path)));
  }
  check_document(file);
  check_arrays(file.root());
  return file;
}

std::string image_bytes(const GltfFile& file, const JsonCursor& image, ReadBuffers& read) {
  if (image.has("uri"))
    return load_uri(file.path, image.at("uri").name(), image.at("uri").text(), file.options);
  const JsonCursor view = file.element("bufferViews", image.at("bufferView"));
  if (!file.buffers.empty()) return std::string(file.view_bytes(view));
  const JsonCursor index = view.at("buffer"), buffer = file.element("buffers", index);
  const std::size_t number = index.integer();
  if (!read.contains(number)) {
    std::optional<Piece> chunk;
    if (const Piece all = buffer.has("uri") ? Piece{} : map_file(file.path); all.bytes.starts_with("glTF"))
      if (const Chunks chunks = split_chunks(file.path, all.bytes); chunks.has_bin)
        chunk = all.part(chunks.bin_begin, chunks.bin_size);
    read.emplace(number, load_buffer(file, buffer, number == 0, chunk));
  }
  return std::string(file.view_bytes(view, read.at(number)));
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

std::uint64_t GltfFile::bytes() const {
  std::uint64_t sum = json_bytes;
  for (const auto& buffer : buffers) sum += buffer ? buffer->size() : 0;
  return sum;
}

io::JsonCursor GltfFile::element(const char* array, const io::JsonCursor& index) const {
  const std::size_t size = root().has(array) ? root().at(array).size() : 0;
  const std::uint64_t number = index.integer();
  if (number >= size)
    index.fail(size == 0 ? "none: there are no " + std::string(array)
                         : "0 to " + std::to_string(size - 1) + ", the " + array + " there are");
  return root().at(array).at(number);
}

std::string_view GltfFile::view_bytes(const io::JsonCursor& view) const {
  element("buffers", view.at("buffer"));
  return view_bytes(view, buffers[view.at("buffer").integer()]);
}

std::string_view GltfFile::view_bytes(const io::JsonCursor& view,
                                      const std::optional<io::BufferBytes>& bytes) const {
  const io::JsonCursor buffer = element("buffers", view.at("buffer"));
  if (!bytes) buffer.fail("a uri or, for buffer 0, the binary chunk of a GLB", "no data");
  const std::uint64_t available = buffer.at("byteLength").integer();
  const std::uint64_t offset = view.integer_or("byteOffset", 0);
  const std::uint64_t length = view.at("byteLength").integer(1);
  const bool there = offset <= available && length <= available - offset;
  const std::optional<std::string_view> result = there ? bytes->within(offset, length) : std::nullopt;
  if (!result)  // appended bytes have their own views
    view.fail("bytes within the " + std::to_string(available) + " of " + buffer.name(),
              std::to_string(length) + " bytes from byte " + std::to_string(offset));
  return *result;
}

}  // namespace darboux
