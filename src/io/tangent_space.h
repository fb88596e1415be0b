/// \file tangent_space.h
/// Determines which properties of a glTF material read the tangent frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "gltf_file.h"

namespace darboux::io {

/// A property of a material that reads the tangent frame.
struct FrameReader {
  std::string_view rule;       ///< "normal_texture"
  std::string pointer;         ///< JSON pointer to the property, "/materials/0/normalTexture"
  bool has_texture = false;    ///< it reads the frame through a texture
  bool is_normal_map = false;  ///< that texture is a normal map: viewers derive the frame from its uvs
  bool two_channels = false;   ///< a normal map of x and y alone
  std::optional<std::uint64_t> texture{};            ///< its index, if given
  double scale = 1;                                  ///< of a normal map: its x and y are multiplied by it
  bool scale_animated = false;                       ///< as far as SwitchedOff::animated says
  std::uint64_t texcoord = 0;                        ///< TEXCOORD set of the texture, 0 when there is none
  std::optional<std::array<double, 6>> transform{};  ///< its KHR_texture_transform, as Primitive has it
};

/// Conditions that disable a property that reads the frame.
struct SwitchedOff {
  bool by_factors = false;           ///< a factor of 0 disables it, unless it is animated
  std::set<std::string> animated{};  ///< JSON pointers that animations write to
};

/// The pointers of KHR_animation_pointer. \throws FileError
std::set<std::string> animated_pointers(const GltfFile& file);

/// The properties of one material that read the frame: normalTexture, the clearcoatNormalTexture of
/// KHR_materials_clearcoat, KHR_materials_anisotropy with or without a texture, the normal maps of
/// MSFT_packing_normalRoughnessMetallic and MSFT_packing_occlusionRoughnessMetallic. Empty for a material
/// with KHR_materials_unlit. \param index a material of the document \throws FileError
std::vector<FrameReader> frame_readers(const GltfFile& file, std::size_t index, const SwitchedOff& off = {});

/// The materials of a primitive, its own first, then those of its KHR_materials_variants, each once.
/// \throws FileError
std::vector<std::size_t> materials_of(const GltfFile& file, const JsonCursor& primitive);

/// The requirements of a primitive's materials on its tangents.
struct TangentSpace {
  bool needed = false;         ///< something reads them
  bool names = false;          ///< a texture that reads them names its uv set
  std::uint64_t texcoord = 0;  ///< TEXCOORD set of the first texture that reads them, 0 if there is none
  std::optional<std::array<double, 6>> transform;  ///< its KHR_texture_transform, as Primitive has it
};

/// frame_readers() of materials_of(). \throws FileError
TangentSpace tangent_space(const GltfFile& file, const JsonCursor& primitive);

}  // namespace darboux::io
