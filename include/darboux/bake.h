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
  std::optional<std::uint64_t> dither{};   ///< as in NormalMapOptions
  int dilate = 4;                          ///< texels by which islands grow into the gutter; at most 1024
  int samples = 16;                        ///< points per triangle at which the error is measured; 0 to 10000
  std::uint64_t seed = 1;                  ///< of the random points
  int threads = 1;                         ///< 0: all; the results do not depend on it
  std::function<void(double)> progress{};  ///< called with the fraction done, from any thread
};

/// The error at points inside triangles, in degrees. A triangle belongs to the lowest class of its corners.
struct BakeError {
  std::size_t samples = 0;
  Statistics without_map_deg;  ///< angle between the interpolated normal and that of the surface
  Statistics with_map_deg;     ///< the same with the map, sampled bilinearly, in the frame of the shader
};

struct BakeResult {
  NormalMapResult map;
  std::array<BakeError, vertex_class_names.size()> errors;  ///< by VertexClass
  BakeError all;
  /// Upper bound of the angle between a decoded texel and the normal of the surface
  /// (docs/theory/normal-maps.md): asin(c √3 / most), c the largest condition of a frame, most the largest
  /// code. With dither, which errs by up to one code: asin(2 c √3 / most). 90 if the argument exceeds 1.
  /// For f32, a few roundings of single precision.
  double bound_deg = 0;
};

/// Bakes a tangent-space normal map for a mesh of a surface. `surface` has the placement of the mesh and its
/// uv convention, as fit_surface() determines them. The normals are those of the surface at the (u, v) of
/// each texel, rounded to single precision and converted by convert_normal_map().
///
/// The error is measured at random points of every triangle, as a renderer shades them: the map is
/// interpolated between four texels at the uv of the point, decoded in the interpolated frame, and compared
/// with the normal of the surface at that (u, v).
/// \throws what convert_normal_map() throws; ParameterError for an option out of range; MeshError for uvs
/// outside [0, 1] where the normal of the surface differs from that at the texel they wrap to
BakeResult bake_normal_map(const PlacedSurface& surface, std::span<const MapPiece> pieces,
                           const BakeOptions& options = {});

/// The same for a mesh in the space of the surface whose texture coordinates are its (u, v), such as one from
/// sample_mesh().
BakeResult bake_normal_map(const AnySurface& surface, std::span<const MapPiece> pieces,
                           const BakeOptions& options = {});

}  // namespace darboux
