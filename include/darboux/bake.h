/// \file bake.h
/// Bakes the exact normals of a surface into a tangent-space map for a coarse mesh of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include <darboux/any_surface.h>
#include <darboux/mesh_classes.h>
#include <darboux/normal_map.h>
#include <darboux/placed_surface.h>
#include <darboux/statistics.h>

namespace darboux {

struct BakeOptions {
  int width = 1024, height = 1024;    ///< texels
  MapBasis basis = MapBasis::stored;  ///< stored or mikktspace
  MapDecode decode = MapDecode::mikktspace;
  MapGreen green = MapGreen::opengl;
  SampleType type = SampleType::u8;
  bool signed_floats = false;              ///< SampleType::f32 holds -1 to 1, not 0 to 1
  std::optional<std::uint64_t> dither{};   ///< as NormalMapOptions has it
  int dilate = 4;                          ///< texels by which islands grow into the gutter; at most 1024
  int samples = 16;                        ///< per triangle, at which the error is looked for; 0 to 10000
  std::uint64_t seed = 1;                  ///< of their places
  int threads = 1;                         ///< 0: all; the results do not depend on it
  std::function<void(double)> progress{};  ///< called with the share that is done, from any thread
};

/// The error that is left at points inside triangles, in degrees. A triangle counts in the lowest class of
/// its corners.
struct BakeError {
  std::size_t samples = 0;
  Statistics without_map_deg;  ///< the angle between the interpolated normal and the surface's
  Statistics with_map_deg;     ///< the same of the map, read bilinearly, in the shader's frame
};

struct BakeResult {
  NormalMapResult map;
  std::array<BakeError, vertex_class_names.size()> errors;  ///< by VertexClass
  BakeError all;
  /// No decoded texel is farther than this from the surface's normal (docs/theory/normal-maps.md): asin(c
  /// √3 / most), c the largest condition of a frame, most the largest code. With dither, which is off by up
  /// to a whole code: asin(2 c √3 / most). 90 if the argument exceeds 1. For f32 a few roundings of single
  /// precision.
  double bound_deg = 0;
};

/// Bakes the map of a mesh of a surface. `surface` tells where the mesh lies and what its texture coordinates
/// mean, as fit_surface() finds it. The normals are those of the surface at each texel's (u, v), rounded to
/// single precision and converted by convert_normal_map().
///
/// The error is measured at random points of every triangle, as a renderer shades them: the map is
/// interpolated between four texels at the point's uv, decoded in the frame inside the triangle, and compared
/// with the surface's normal at that (u, v).
/// \throws what convert_normal_map() throws; ParameterError for an option out of its range; MeshError for uvs
/// outside of [0, 1] where the surface has another normal than at the texel that they repeat
BakeResult bake_normal_map(const PlacedSurface& surface, std::span<const MapPiece> pieces,
                           const BakeOptions& options = {});

/// The same for a mesh in the surface's own space whose texture coordinates are the surface's (u, v), such as
/// a mesh of sample_mesh().
BakeResult bake_normal_map(const AnySurface& surface, std::span<const MapPiece> pieces,
                           const BakeOptions& options = {});

}  // namespace darboux
