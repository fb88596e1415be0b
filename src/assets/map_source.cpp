#include "map_source.h"

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include <darboux/error.h>

#include "base/text.h"
#include "io/budget.h"
#include "io/files.h"
#include "io/gltf_file.h"

namespace darboux {
namespace {

bool counts(const NormalTexture& texture, const ChosenPrimitives& only) {
  return only.empty() || std::any_of(only.begin(), only.end(), [&](const auto& chosen) {
           return chosen.first == texture.mesh && (!chosen.second || *chosen.second == texture.primitive);
         });
}

}  // namespace

MapSource map_source(const std::string& path, const std::optional<ChosenPrimitives>& only,
                     const ReadOptions& options) {
  if (!io::is_gltf(path)) {
    io::expect_regular_file(path);
    return {path, io::read_file(path)};
  }
  MapSource source;
  std::set<std::size_t> images;
  for (const NormalTexture& texture : normal_textures(path, options)) {
    if (only && !counts(texture, *only)) continue;
    source.file = texture.file;
    images.insert(texture.image);
    source.primitives.emplace_back(texture.mesh, texture.primitive);
  }
  if (images.size() != 1) {
    std::vector<std::string> names;
    for (const std::size_t image : images) names.push_back(std::to_string(image));
    const bool choice = only && !(images.empty() && only->empty());
    throw FileError(path, expected_got(std::string("normal textures of one image") +
                                           (choice ? ", or --primitive to say whose" : ""),
                                       images.empty() ? "none" : "images " + joined(names)));
  }
  source.name = path + ": images[" + std::to_string(*images.begin()) + "]";
  source.bytes = gltf_image_bytes(path, *images.begin(), options);
  return source;
}

void check_map_memory(const std::string& file, std::uint64_t there, std::uint64_t texels, int channels,
                      SampleType type, const ReadOptions& options) {
  constexpr std::array<std::uint64_t, 3> sample_bytes{1, 2, 4};
  constexpr std::uint64_t state_bytes = 5;
  const std::uint64_t texel_bytes =
      static_cast<std::uint64_t>(channels) * sample_bytes[static_cast<std::size_t>(type)] + state_bytes;
  // The user asks for this memory, so the smaller limit for small files does not apply.
  io::Budget(options, io::small_file, there)
      .take(texels * texel_bytes, io::FilePlace{file}, "a map of " + std::to_string(texels) + " texels");
}

}  // namespace darboux
