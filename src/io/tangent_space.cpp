#include "tangent_space.h"

#include <cmath>

namespace darboux::io {
namespace {

/// A property of a material that reads the tangent frame: the texture, in the extension or, where that is
/// null, in the material itself.
struct Reader {
  const char *extension, *texture;
  bool without_texture;  ///< the extension reads it, with the texture or not
};
constexpr Reader readers[] = {
    {nullptr, "normalTexture", false},
    {"KHR_materials_clearcoat", "clearcoatNormalTexture", false},
    {"KHR_materials_anisotropy", "anisotropyTexture", true},
    {"MSFT_packing_normalRoughnessMetallic", "normalRoughnessMetallicTexture", false},
    {"MSFT_packing_occlusionRoughnessMetallic", "normalTexture", false},
};

std::uint64_t texcoord(const JsonCursor& texture) {
  constexpr std::uint64_t most_sets = 1000;
  if (const auto transform = texture.extension("KHR_texture_transform");
      transform && transform->has("texCoord"))
    return transform->at("texCoord").integer(0, most_sets);
  return texture.has("texCoord") ? texture.at("texCoord").integer(0, most_sets) : 0;
}

// uv' = translation rotation scale uv, the rotation counter-clockwise in a space whose v runs down, as the
// extension has it.
std::optional<std::array<double, 6>> transform_of(const JsonCursor& texture) {
  const auto transform = texture.extension("KHR_texture_transform");
  if (!transform) return std::nullopt;
  const auto pair = [&](const char* key, double fallback) {
    std::array<double, 2> values{fallback, fallback};
    if (!transform->has(key)) return values;
    const JsonCursor list = transform->at(key);
    if (list.size() != 2) list.fail("2 numbers", std::to_string(list.size()));
    return std::array<double, 2>{list.at(std::size_t{0}).number(), list.at(1).number()};
  };
  const auto offset = pair("offset", 0), scale = pair("scale", 1);
  const double angle = transform->has("rotation") ? transform->at("rotation").number() : 0;
  const double c = std::cos(angle), s = std::sin(angle);
  return std::array<double, 6>{c * scale[0], s * scale[1], -s * scale[0], c * scale[1], offset[0], offset[1]};
}

TangentSpace of_material(const JsonCursor& material) {
  TangentSpace result;
  for (const Reader& reader : readers) {
    const auto owner =
        reader.extension == nullptr ? std::optional(material) : material.extension(reader.extension);
    if (!owner) continue;
    const bool has_texture = owner->has(reader.texture);
    result.needed = result.needed || has_texture || reader.without_texture;
    if (!has_texture || result.names) continue;
    result.names = true;
    result.texcoord = texcoord(owner->at(reader.texture));
    result.transform = transform_of(owner->at(reader.texture));
  }
  return result;
}

}  // namespace

TangentSpace tangent_space(const GltfFile& file, const JsonCursor& primitive) {
  TangentSpace result;
  const auto look_at = [&](const JsonCursor& owner) {
    if (!result.needed && owner.has("material"))
      result = of_material(file.element("materials", owner.at("material")));
  };
  look_at(primitive);
  if (const auto variants = primitive.extension("KHR_materials_variants")) {
    const JsonCursor mappings = variants->at("mappings");
    for (std::size_t i = 0; i < mappings.size(); ++i) look_at(mappings.at(i));
  }
  return result;
}

}  // namespace darboux::io
