/// \file lit_model.h
/// A model lit through a normal map.
#pragma once

#include <span>

#include <darboux/image.h>
#include <darboux/normal_map.h>

#include "rasterise.h"

namespace darboux {

struct LitModelOptions {
  MapSpace space = MapSpace::tangent;  ///< of the map: object or tangent
  MapBasis basis = MapBasis::stored;   ///< stored or mikktspace
  MapGreen green = MapGreen::opengl;
  bool signed_floats = false;
  int width = 800, height = 600;
  int threads = 1;
};

/// The pieces seen from the front, from the right and a little above, y up, both sides. The map is read
/// bilinearly, and of a tangent-space map decoded as MapDecode::gltf_viewer has it.
/// \throws MeshError for pieces without uvs, normals or what the basis needs; as Rasteriser does
Picture lit_model(const Image& map, std::span<const MapPiece> pieces, const LitModelOptions& options);

}  // namespace darboux
