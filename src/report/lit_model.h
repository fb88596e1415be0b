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

/// Draws the pieces from the front right and slightly above, y up, double-sided. The map is sampled
/// bilinearly; a tangent-space map is decoded as by MapDecode::gltf_viewer.
/// \throws MeshError for pieces without uvs, normals or what the basis needs; as Rasteriser does
Picture lit_model(const Image& map, std::span<const MapPiece> pieces, const LitModelOptions& options);

}  // namespace darboux
