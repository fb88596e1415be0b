/// \file map_cost.h
/// What a normal map of a surface would leave of the error of a coarse mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <darboux/mesh_classes.h>
#include <darboux/normal_map.h>
#include <darboux/placed_surface.h>
#include <darboux/statistics.h>

namespace darboux {

struct MapCostOptions {
  int width = 1024, height = 1024;
  int samples = 16;        ///< per triangle; 0 to 10000
  std::uint64_t seed = 1;  ///< of their places
  int threads = 1;         ///< 0: all; the results do not depend on it
};

/// Angles to the surface's normal, in degrees, at points inside triangles. Each stage has all before it.
struct MapCostStages {
  std::size_t samples = 0;
  Statistics triangle_deg;  ///< the geometry's error: the triangle's own normal
  Statistics normal_deg;    ///< the interpolated normal's error: what is seen without a map
  /// The error of an ideal map, without texels and codes, made for MikkTSpace's tangents and read in the
  /// frame of the stored ones; near 0 where these are MikkTSpace's, or where none are stored.
  Statistics frame_deg;
  Statistics texel_deg;    ///< the error of a map of that size in floats, read bilinearly
  Statistics codes16_deg;  ///< the error of the same map in 16 bits
  Statistics codes8_deg;   ///< the same in 8 bits
};

struct MapCost {
  MapCostStages all;
  std::array<MapCostStages, vertex_class_names.size()> classes;  ///< by the lowest of a triangle's corners
  /// Texels to which triangles give different values, so that no single map exists: the last three stages are
  /// empty.
  std::size_t conflicts = 0;
};

/// Bakes the surface's normals for the mesh three times, as bake_normal_map() does with
/// MapDecode::mikktspace, and looks at them as a renderer would. \param piece with normals and uvs; its
/// tangents are the stored ones \throws what bake_normal_map() throws
MapCost normal_map_cost(const PlacedSurface& surface, const MapPiece& piece,
                        const MapCostOptions& options = {});

}  // namespace darboux
