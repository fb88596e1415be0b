/// \file map_cost.h
/// Measures the shading error of a coarse mesh of a surface, without and with a normal map.
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

/// Angles to the normal of the surface, in degrees, at points inside triangles. Each stage includes the
/// errors of the previous ones.
struct MapCostStages {
  std::size_t samples = 0;
  Statistics triangle_deg;  ///< error of the geometry: the normal of the triangle
  Statistics normal_deg;    ///< error of the interpolated normal: the shading without a map
  /// The error of an ideal map, without texels and codes, baked for MikkTSpace's tangents and decoded with
  /// the stored ones; near 0 if these are MikkTSpace's, or if none are stored.
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

/// Bakes the normals of the surface for the mesh at three depths, as bake_normal_map() does with
/// MapDecode::mikktspace, and evaluates them as a renderer would. \param piece with normals and uvs; its
/// tangents are the stored ones \throws what bake_normal_map() throws
MapCost normal_map_cost(const PlacedSurface& surface, const MapPiece& piece,
                        const MapCostOptions& options = {});

}  // namespace darboux
