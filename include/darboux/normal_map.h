/// \file normal_map.h
/// Converts normal maps between spaces, over the triangles of a mesh or over a surface.
///
/// A texel c of an object-space map encodes the direction n = 2 c / most - 1 in the local space of the mesh;
/// a texel of a tangent-space map, the direction x t + y b + z n in the local frame. Texel (i, j) of a map of
/// W x H lies at uv = ((i + 1/2)/W, (j + 1/2)/H), row 0 at the top; there v runs down, as in glTF.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <darboux/any_surface.h>
#include <darboux/image.h>
#include <darboux/mesh.h>

namespace darboux {

enum class MapSpace : std::uint8_t {
  object,   ///< the mesh's own space
  tangent,  ///< of the frame at each texel
  world     ///< of the node that references the mesh
};

/// The source of tangents.
enum class MapBasis : std::uint8_t {
  stored,      ///< the mesh's own tangents
  mikktspace,  ///< made anew by MikkTSpace, to the bit
  analytic     ///< the surface's frame at the texel's (u, v): t, w n × t and n, orthonormal
};

/// How a shader computes the frame inside a triangle from t, n and the sign w of the corners. Neither frame
/// is orthogonal. A direction d is encoded as unit(M⁻¹ d), M = (t b n): the inverse, not the transpose.
enum class MapDecode : std::uint8_t {
  /// t and n interpolated, not normalised, b = w n × t at each texel: what the author of MikkTSpace requires
  /// of shaders. [Mikkelsen2008]
  mikktspace,
  /// t, n and b = w n × t of the corners interpolated, each of the three then made unit: the Khronos glTF
  /// sample viewer.
  gltf_viewer
};

/// Which way the green channel of a tangent-space map points.
enum class MapGreen : std::uint8_t {
  opengl,  ///< up the image, against v: glTF
  directx  ///< down the image
};

/// How a texture continues outside [0, 1].
enum class MapWrap : std::uint8_t { repeat, mirror, clamp };

/// Triangles covered by a map.
struct MapPiece {
  /// With normals and uvs; for MapBasis::stored with tangents, whose bitangent w n × t points up the image
  /// (glTF's sign; that of other formats where v runs up). The uvs are those of the texture, with its
  /// KHR_texture_transform applied.
  Mesh mesh;
  bool v_up = false;                                              ///< v runs up the image: row 0 is at v = 1
  std::array<MapWrap, 2> wrap{MapWrap::repeat, MapWrap::repeat};  ///< along u and v
  /// normalTexture.scale: x and y of a tangent-space map are multiplied by it before the frame is applied, so
  /// M = (scale t, scale b, n).
  double scale = 1;
  Eigen::Matrix3d to_world = Eigen::Matrix3d::Identity();  ///< its linear part, for MapSpace::world
  std::size_t mesh_index = 0, primitive = 0;               ///< for messages
};

struct NormalMapOptions {
  MapSpace from = MapSpace::tangent;
  MapSpace to = MapSpace::object;  ///< not world, and another than `from`
  MapBasis basis = MapBasis::stored;
  MapDecode decode = MapDecode::mikktspace;
  MapGreen green = MapGreen::opengl;
  const AnySurface* surface = nullptr;  ///< for MapBasis::analytic
  /// z of a tangent-space map is computed from x and y: sqrt(max(0, 1 - x² - y²)); blue is not read.
  bool two_channels = false;
  /// Whether vectors keep their length. If false, they are normalised.
  bool keep_length = false;
  bool signed_floats = false;  ///< SampleType::f32 holds -1 to 1, not 0 to 1
  /// If set, noise that is uniform over one code is added to each channel before rounding down, so that codes
  /// are unbiased. The value is the seed.
  std::optional<std::uint64_t> dither;
  int dilate = 0;                          ///< texels by which islands grow into the gutter; at most 1024
  std::optional<SampleType> type;          ///< of the samples written; empty: the input's
  int threads = 1;                         ///< 0: all; the bits do not depend on it
  std::function<void(double)> progress{};  ///< called with the fraction done, from any thread
};

/// A texel to which two triangles give different colours.
struct MapConflict {
  int x = 0, y = 0;
  struct Owner {
    std::size_t piece = 0, triangle = 0;
    std::array<double, 3> codes{};  ///< requested codes, without alpha; for f32 the numbers
  };
  std::array<Owner, 2> owners;
};

/// The state of a texel of the result.
enum class TexelState : std::uint8_t { empty, covered, dilated, conflict };

struct NormalMapResult {
  /// The map; empty if there are conflicts. Texels that no triangle covers are (1/2, 1/2, 1) in tangent space
  /// and (1/2, 1/2, 1/2) in object space. Alpha is that of the input, clamped when written as codes, and 0
  /// for NaN.
  Image image;
  std::vector<TexelState> states;  ///< of each texel
  std::size_t covered = 0, dilated = 0;
  std::size_t conflicts = 0;                  ///< texels
  std::optional<MapConflict> first_conflict;  ///< in the order of texels
  std::size_t below_surface = 0;              ///< covered texels with z <= 0 in tangent space
  /// Covered texels that are NaN, infinite or zero in the input: filled by dilation, else empty.
  std::size_t not_finite = 0;
  /// Covered texels without a frame: filled by dilation, else empty.
  std::size_t no_frame = 0;
  std::size_t too_long = 0;                 ///< with two_channels: x² + y² > 1
  std::size_t outside_map = 0;              ///< texels of triangles beyond a map that clamps
  std::size_t degenerate_uv_triangles = 0;  ///< no area in uv: they cover nothing
  /// Triangles whose corners have different w: MapDecode::mikktspace uses that of the first corner.
  std::size_t mixed_sign_triangles = 0;
  double condition = 0;                ///< largest condition of a frame (ratio of singular values); 0: none
  std::size_t condition_above_10 = 0;  ///< texels
  double quantisation_max_deg = 0;     ///< angle between the written and the exact direction
  double quantisation_rms_deg = 0;
};

/// Converts a normal map.
///
/// Coverage: a texel belongs to the triangle that contains its centre; if the centre lies on an edge of two
/// triangles, to one of them. uvs, in texels, are rounded to multiples of 2^-32; then the test is exact.
/// If triangles overlap, the value of the first is used if the others differ from it by at most one code
/// (f32: 2/65535) in every channel. Otherwise the texel is a conflict, and no image is returned.
///
/// Codes: number = (x + 1)/2 · most in double, rounded to the nearest code (upward within 2^-40 of a tie).
/// Uncovered texels within `dilate` steps get the codes of the nearest covered texel. A step goes to one of
/// the eight neighbours, also across the edge of maps that repeat.
///
/// Round trip: with keep_length, and a map of codes of unit vectors, each channel comes back within 1 code if
/// frames are orthonormal, and within ceil(0.87 c + 1/2) - 1 codes if a frame's condition is c:
/// docs/theory/normal-maps.md.
///
/// \param pieces may be empty with MapBasis::analytic: then all texels are covered, and their (u, v) are
/// those of the surface Cost: linear in texels and triangles, some 0.1 µs per texel. Memory beyond input and
/// output: 5 bytes per texel and 300 per triangle.
/// \throws ParameterError for incompatible options, an image without 3 or 4 channels or with a wrong number
/// of samples, or as chosen_instruction_set() \throws MeshError for pieces without attributes that the basis
/// needs, with numbers that are not finite, with uvs beyond 2^22 texels, or that cover the map more than 64
/// times
NormalMapResult convert_normal_map(const Image& map, std::span<const MapPiece> pieces,
                                   const NormalMapOptions& options);

/// A picture of the texel states: empty black, covered grey, dilated dark, conflicts red.
Image picture_of(const NormalMapResult& result, int width, int height);

}  // namespace darboux
