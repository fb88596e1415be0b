#include "tangent_space.h"

#include <algorithm>
#include <cmath>

namespace darboux::io {
namespace {

// A property of a material that reads the tangent frame: its texture in the extension, or in the material
// itself if `extension` is null.
struct Rule {
  std::string_view name;
  const char *extension, *texture;
  bool without_texture;  // the extension reads it, with the texture or not
  bool is_normal_map;
  const char* factor;  // of the extension, 0 by default: switches the property off
};
constexpr std::string_view packed = "packed_normal_texture";  // x and y in two channels
constexpr Rule rules[] = {
    {"normal_texture", nullptr, "normalTexture", false, true, nullptr},
    {"clearcoat_normal_texture", "KHR_materials_clearcoat", "clearcoatNormalTexture", false, true,
     "clearcoatFactor"},
    {"anisotropy", "KHR_materials_anisotropy", "anisotropyTexture", true, false, "anisotropyStrength"},
    {packed, "MSFT_packing_normalRoughnessMetallic", "normalRoughnessMetallicTexture", false, true, nullptr},
    {packed, "MSFT_packing_occlusionRoughnessMetallic", "normalTexture", false, true, nullptr},
};

std::uint64_t texcoord(const JsonCursor& texture) {
  constexpr std::uint64_t most_sets = 1000;
  if (const auto transform = texture.extension("KHR_texture_transform");
      transform && transform->has("texCoord"))
    return transform->at("texCoord").integer(0, most_sets);
  return texture.has("texCoord") ? texture.at("texCoord").integer(0, most_sets) : 0;
}

// uv' = translation rotation scale uv, the rotation counter-clockwise with v running down, as in the
// extension.
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

// Whether a factor of a property is 0 and not animated.
bool is_zero(const JsonCursor& owner, const char* key, double fallback, const std::string& pointer,
             const SwitchedOff& off) {
  const double value = owner.has(key) ? owner.at(key).number() : fallback;
  return value == 0 && !off.animated.contains(pointer + "/" + key);
}

}  // namespace

std::set<std::string> animated_pointers(const GltfFile& file) {
  std::set<std::string> result;
  if (!file.root().has("animations")) return result;
  const JsonCursor animations = file.root().at("animations");
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const JsonCursor channels = animations.at(a).at("channels");
    for (std::size_t c = 0; c < channels.size(); ++c)
      if (const auto target = channels.at(c).at("target").extension("KHR_animation_pointer"))
        result.insert(target->at("pointer").text());
  }
  return result;
}

std::vector<FrameReader> frame_readers(const GltfFile& file, std::size_t index, const SwitchedOff& off) {
  std::vector<FrameReader> result;
  const JsonCursor material = file.root().at("materials").at(index);
  if (material.extension("KHR_materials_unlit")) return result;
  const std::string of_material = "/materials/" + std::to_string(index);
  for (const Rule& rule : rules) {
    const auto owner =
        rule.extension == nullptr ? std::optional(material) : material.extension(rule.extension);
    if (!owner) continue;
    const std::string of_owner =
        rule.extension == nullptr ? of_material : of_material + "/extensions/" + rule.extension;
    FrameReader reader{.rule = rule.name,
                       .pointer = of_owner,
                       .has_texture = owner->has(rule.texture),
                       .is_normal_map = rule.is_normal_map,
                       .two_channels = rule.name == packed};
    if (!reader.has_texture && !rule.without_texture) continue;
    if (off.by_factors && rule.factor != nullptr && is_zero(*owner, rule.factor, 0, of_owner, off)) continue;
    if (reader.has_texture) {
      const JsonCursor texture = owner->at(rule.texture);
      reader.pointer += std::string("/") + rule.texture;
      if (off.by_factors && rule.is_normal_map && is_zero(texture, "scale", 1, reader.pointer, off)) continue;
      if (rule.is_normal_map && texture.has("scale")) reader.scale = texture.at("scale").number();
      reader.scale_animated = off.animated.contains(reader.pointer + "/scale");
      if (texture.has("index")) reader.texture = texture.at("index").integer();
      reader.texcoord = texcoord(texture);
      reader.transform = transform_of(texture);
    }
    result.push_back(std::move(reader));
  }
  return result;
}

std::vector<std::size_t> materials_of(const GltfFile& file, const JsonCursor& primitive) {
  std::vector<std::size_t> result;
  const auto take = [&](const JsonCursor& owner) {
    if (!owner.has("material")) return;
    file.element("materials", owner.at("material"));
    const std::size_t index = owner.at("material").integer();
    if (std::find(result.begin(), result.end(), index) == result.end()) result.push_back(index);
  };
  take(primitive);
  if (const auto variants = primitive.extension("KHR_materials_variants")) {
    const JsonCursor mappings = variants->at("mappings");
    for (std::size_t i = 0; i < mappings.size(); ++i) take(mappings.at(i));
  }
  return result;
}

TangentSpace tangent_space(const GltfFile& file, const JsonCursor& primitive) {
  TangentSpace result;
  for (const std::size_t material : materials_of(file, primitive))
    for (const FrameReader& reader : frame_readers(file, material)) {
      result.needed = true;
      if (!reader.has_texture || result.names) continue;
      result.names = true;
      result.texcoord = reader.texcoord;
      result.transform = reader.transform;
    }
  return result;
}

}  // namespace darboux::io
