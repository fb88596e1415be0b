// EXT_meshopt_compression: bufferViews whose data are streams of meshoptimizer.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <meshoptimizer.h>

#include "budget.h"
#include "gltf_file.h"

namespace darboux::io {
namespace {

constexpr const char* meshopt_extension = "EXT_meshopt_compression";

// The most bytes that one byte of a stream expands to. Attributes have 2 header bits per 16 bytes; triangles
// one byte per three indices, 12 bytes; other indices one byte each, 4 bytes. (Appendix A of the extension)
constexpr std::uint64_t most_expansion = 64;

const unsigned char* data(std::string_view bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

struct Mode {
  const char* name;
  bool indices;
  std::uint64_t group;  // elements come in such numbers
  int (*decode)(void* to, std::size_t count, std::size_t stride, const unsigned char* stream,
                std::size_t length);
};
constexpr std::array modes{Mode{"ATTRIBUTES", false, 1, meshopt_decodeVertexBuffer},
                           Mode{"TRIANGLES", true, 3, meshopt_decodeIndexBuffer},
                           Mode{"INDICES", true, 1, meshopt_decodeIndexSequence}};

struct Filter {
  const char* name;
  std::array<std::uint64_t, 2> strides;  // those that it takes; none: all
  void (*decode)(void* buffer, std::size_t count, std::size_t stride);
};
constexpr std::array filters{Filter{"NONE", {}, nullptr},
                             Filter{"OCTAHEDRAL", {4, 8}, meshopt_decodeFilterOct},
                             Filter{"QUATERNION", {8, 8}, meshopt_decodeFilterQuat},
                             Filter{"EXPONENTIAL", {}, meshopt_decodeFilterExp}};

template <class Kinds>
const auto& find_kind(const Kinds& kinds, const JsonCursor& name) {
  std::string list;
  for (const auto& kind : kinds) {
    if (name.text() == kind.name) return kind;
    list += (list.empty() ? "" : ", ") + std::string(kind.name);
  }
  name.fail("one of " + list);
}

/// \param left number of bytes that may still be decoded; reduced by those decoded here
std::string decode(const GltfFile& file, const JsonCursor& view, const JsonCursor& compressed,
                   std::uint64_t& left, Budget& budget) {
  const Mode& mode = find_kind(modes, compressed.at("mode"));
  const Filter& filter =
      compressed.has("filter") ? find_kind(filters, compressed.at("filter")) : filters.front();
  if (mode.indices && filter.decode != nullptr)
    compressed.at("filter").fail(std::string("NONE with mode ") + mode.name);

  const JsonCursor stride_place = compressed.at("byteStride");
  const std::uint64_t stride = stride_place.integer(1, 256);
  if (mode.indices ? stride != 2 && stride != 4 : stride % 4 != 0)
    stride_place.fail(std::string(mode.indices ? "2 or 4" : "a multiple of 4") + " with mode " + mode.name);
  const auto& strides = filter.strides;
  if (strides[0] != 0 && std::find(strides.begin(), strides.end(), stride) == strides.end())
    stride_place.fail(std::string(strides[0] == strides[1] ? "8" : "4 or 8") + " with filter " + filter.name);
  if (view.has("byteStride") && view.at("byteStride").integer() != stride)
    view.at("byteStride").fail(std::to_string(stride) + ", that of its " + meshopt_extension);

  const std::string_view stream = file.view_bytes(compressed);
  const JsonCursor count_place = compressed.at("count");
  const std::uint64_t count = count_place.integer(1);
  if (count % mode.group != 0)
    count_place.fail("a multiple of " + std::to_string(mode.group) + " with mode " + mode.name);
  const std::uint64_t most = std::min(left, most_expansion * stream.size());
  if (count > most / stride)
    count_place.fail("at most " + std::to_string(most) + " bytes for its stream of " +
                         std::to_string(stream.size()) + " bytes",
                     count_place.shown() + " elements of " + std::to_string(stride) + " bytes");
  left -= count * stride;
  if (view.at("byteLength").integer() != count * stride)
    view.at("byteLength")
        .fail("the bytes of the " + std::to_string(count) + " elements of " + std::to_string(stride) +
              " bytes of its " + meshopt_extension);
  budget.take(count * stride, compressed, "its decoded bytes");

  std::string bytes(count * stride, '\0');
  if (mode.decode(bytes.data(), count, stride, data(stream), stream.size()) != 0)
    compressed.fail("a whole stream of mode " + std::string(mode.name) + " with " + std::to_string(count) +
                        " elements of " + std::to_string(stride) + " bytes",
                    "one that cannot be decoded");
  if (filter.decode != nullptr) filter.decode(bytes.data(), count, stride);
  return bytes;
}

/// Removes buffers without data that no bufferView reads, and renumbers the others.
void remove_placeholders(GltfFile& file) {
  std::vector<bool> read(file.buffers.size(), false);
  std::vector<Json*> numbers;
  const JsonCursor views = file.root().at("bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto compressed = views.at(i).extension(meshopt_extension);
    const JsonCursor buffer = (compressed ? *compressed : views.at(i)).at("buffer");
    file.element("buffers", buffer);
    read[buffer.integer()] = true;
    Json& view = file.json["bufferViews"][i];
    numbers.push_back(&(compressed ? view["extensions"][meshopt_extension] : view)["buffer"]);
  }
  std::vector<std::size_t> renumbered;
  std::size_t kept = 0;
  Json& buffers = file.json["buffers"];
  for (std::size_t i = 0; i < read.size(); ++i) {
    renumbered.push_back(kept);
    if (!file.buffers[i] && !read[i]) continue;
    if (kept != i) {
      buffers[kept] = std::move(buffers[i]);
      file.buffers[kept] = std::move(file.buffers[i]);
    }
    ++kept;
  }
  buffers.erase(buffers.begin() + static_cast<std::ptrdiff_t>(kept), buffers.end());
  file.buffers.resize(kept);
  for (Json* number : numbers) *number = renumbered[number->get<std::size_t>()];
}

}  // namespace

void decompress_meshopt(GltfFile& file) {
  const std::size_t count = file.json.contains("bufferViews") ? file.json["bufferViews"].size() : 0;
  std::vector<std::size_t> compressed;
  for (std::size_t i = 0; i < count; ++i)
    if (file.root().at("bufferViews").at(i).extension(meshopt_extension)) compressed.push_back(i);
  if (!compressed.empty()) remove_placeholders(file);

  Budget budget(file);
  std::uint64_t left = 0;
  for (const auto& buffer : file.buffers) left += buffer ? most_expansion * buffer->size() : 0;
  for (const std::size_t i : compressed) {
    const JsonCursor view = file.root().at("bufferViews").at(i);
    const std::size_t offset =
        file.append_bytes(Piece::of(decode(file, view, *view.extension(meshopt_extension), left, budget)));
    Json& json = file.json["bufferViews"][i];
    json["buffer"] = 0u;
    json["byteOffset"] = offset;
    remove_extension(json, meshopt_extension);
  }
  if (file.json.contains("buffers"))
    for (Json& buffer : file.json["buffers"]) remove_extension(buffer, meshopt_extension);
  retire_extension(file, meshopt_extension);
}

}  // namespace darboux::io
