// glTF and GLB: read as an asset, and written again. DARBOUX_FUZZ_DECODERS: whether with Draco and meshopt
// streams. The mutator knows the container: it changes a value of the JSON, or bytes of the chunk, and keeps
// the lengths true.
#include <random>

#include <nlohmann/json.hpp>

#include <darboux/mesh.h>

#include "io/gltf_file.h"
#include "support.h"

namespace {

using namespace darboux;
using Json = nlohmann::ordered_json;

constexpr std::size_t header = 12, chunk_header = 8;

std::uint32_t u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
void append_u32(std::string& bytes, std::size_t value) {
  const auto v = static_cast<std::uint32_t>(value);
  bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
}

struct Parts {
  Json json;
  std::string chunk;
};

bool split(std::string_view bytes, Parts& parts) {
  if (!bytes.starts_with("glTF") || bytes.size() < header + chunk_header) return false;
  const std::size_t n = u32(bytes, header);
  if (n > bytes.size() - header - chunk_header) return false;
  parts.json = Json::parse(bytes.substr(header + chunk_header, n), nullptr, false);
  if (parts.json.is_discarded()) return false;
  const std::size_t at = header + chunk_header + n;
  if (bytes.size() >= at + chunk_header) parts.chunk = bytes.substr(at + chunk_header);
  return true;
}

std::string joined(const Parts& parts) {
  std::string json = parts.json.dump(-1, ' ', false, Json::error_handler_t::replace), chunk = parts.chunk;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  append_u32(bytes, 2);
  append_u32(bytes, header + 2 * chunk_header + json.size() + chunk.size());
  append_u32(bytes, json.size());
  bytes += "JSON" + json;
  append_u32(bytes, chunk.size());
  return bytes + std::string("BIN\0", 4) + chunk;
}

// All values of the document, so that one can be picked.
void collect(Json& value, std::vector<Json*>& all) {
  all.push_back(&value);
  if (value.is_structured())
    for (Json& child : value) collect(child, all);
}

void change(Json& document, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  std::vector<Json*> all;
  collect(document, all);
  Json& value = *all[below(all.size())];
  const Json other = *all[below(all.size())];
  const std::vector<Json> odd{0,
                              1,
                              2,
                              3,
                              4,
                              5,
                              6,
                              -1,
                              255,
                              256,
                              65535,
                              4294967295u,
                              1e300,
                              -0.5,
                              5120,
                              5121,
                              5123,
                              5125,
                              5126,
                              "SCALAR",
                              "VEC2",
                              "VEC3",
                              "VEC4",
                              "MAT4",
                              "",
                              true,
                              nullptr,
                              Json::array(),
                              Json::object()};
  switch (below(6)) {
    case 0:
      value = odd[below(odd.size())];
      break;
    case 1:
      value = other;
      break;
    case 2:
      if (value.is_number_integer()) value = value.get<std::int64_t>() + static_cast<int>(below(9)) - 4;
      break;
    case 3:
      if (value.is_array() && !value.empty()) value.erase(below(value.size()));
      break;
    case 4:
      if (value.is_array() && !value.empty() && value.size() < 50)
        value.push_back(Json(value[below(value.size())]));
      break;
    default:
      if (value.is_object() && !value.empty()) {
        auto it = value.begin();
        std::advance(it, below(value.size()));
        if (below(2) == 0)
          value.erase(it);
        else
          value[it.key()] = other;
      }
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  std::mt19937 random(seed);
  Parts parts;
  if (random() % 8 == 0 || !split(fuzz::text_of(data, size), parts))
    return LLVMFuzzerMutate(data, size, most);
  if (random() % 3 == 0 && !parts.chunk.empty()) {
    const std::size_t before = parts.chunk.size();
    parts.chunk.resize(before + 64);
    parts.chunk.resize(
        LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(parts.chunk.data()), before, parts.chunk.size()));
  } else {
    for (unsigned i = 0; i <= random() % 3; ++i) change(parts.json, random);
  }
  const std::string bytes = joined(parts);
  if (bytes.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, bytes.data(), bytes.size());
  return bytes.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(fuzz::text_of(data, size));
  const bool compressed =
      bytes.find("KHR_draco") != std::string::npos || bytes.find("EXT_meshopt") != std::string::npos;
  if (compressed != static_cast<bool>(DARBOUX_FUZZ_DECODERS)) return 0;
  ReadOptions options;
  options.max_memory = std::uint64_t{64} << 20;
  fuzz::may_refuse([&] {
    const GltfFile file = io::load_gltf("memory.glb", io::Piece::of(bytes), options);
    const Asset asset = io::read_gltf(file);
    for (const Primitive& p : asset.primitives) check_consistent(p.data, "memory.glb");
    const std::string again = file.to_glb();
    const Asset same = io::read_gltf(io::load_gltf("memory.glb", io::Piece::of(again), options));
    fuzz::expect(same.primitives.size() == asset.primitives.size(), "what is written is read again");
    for (std::size_t i = 0; i < asset.primitives.size(); ++i)
      fuzz::expect(same.primitives[i].data.triangles == asset.primitives[i].data.triangles,
                   "with its triangles");
  });
  return 0;
}
