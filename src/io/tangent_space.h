/// \file tangent_space.h
/// What of a glTF material reads the tangent frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "gltf_file.h"

namespace darboux::io {

/// What the materials of a primitive ask of its tangents.
struct TangentSpace {
  bool needed = false;         ///< something reads them
  bool names = false;          ///< a texture that does names its uv set
  std::uint64_t texcoord = 0;  ///< TEXCOORD set of the first texture that does, 0 when there is none
  std::optional<std::array<double, 6>> transform;  ///< its KHR_texture_transform, as Primitive has it
};

/// The primitive's material first, then those of its KHR_materials_variants. In each: normalTexture, the
/// clearcoatNormalTexture of KHR_materials_clearcoat, KHR_materials_anisotropy with or without a texture (a
/// strength of 0 may be animated), the normal maps of MSFT_packing_normalRoughnessMetallic and
/// MSFT_packing_occlusionRoughnessMetallic. \throws FileError
TangentSpace tangent_space(const GltfFile& file, const JsonCursor& primitive);

}  // namespace darboux::io
