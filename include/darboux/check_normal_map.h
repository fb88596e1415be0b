/// \file check_normal_map.h
/// Checks a tangent-space normal map from its texels alone, and measures the difference between two maps.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <darboux/image.h>
#include <darboux/normal_map.h>
#include <darboux/statistics.h>

namespace darboux {

/// The result of check_normal_map().
struct NormalMapCheck {
  std::size_t texels = 0;
  std::size_t not_finite = 0;     ///< NaN, infinite or zero
  std::size_t below_surface = 0;  ///< z <= 0
  /// Texels whose length differs from 1 by more than rounding or truncation to codes can cause: 2 √3 /
  /// most; for f32, 1e-6.
  std::size_t not_unit = 0;
  double least_length = 0, greatest_length = 0;
  std::array<double, 3> mean{};  ///< of x, y and z
  /// Every texel is (0, 0, 1) as far as 8 bits can tell: the material needs no tangents (`plan --level
  /// pixels`).
  bool flat = false;
  std::optional<int> z_channel;  ///< 0, 1 or 2: the channel with the largest mean, if that is above 1/4
  /// The direction of green; empty if the map does not determine it (see below).
  std::optional<MapGreen> green;
  std::optional<bool> swapped;   ///< red and green are swapped
  std::size_t voting_cells = 0;  ///< cells on which `green` is based
  double agreeing = 0;           ///< the share of them that agree
};

/// Checks a map without a mesh or a surface.
///
/// The map of a height field h over the image has (-x/z, -y/z) = (h_u, h_w), w up the image. If green points
/// up, the mixed derivatives agree: h_uw = h_wu. If green points down, they are opposite. Both are computed
/// by central differences of means over s x s texels, s = 1, 2, 4, .... A cell votes if each of the two
/// exceeds what rounding to 8 bits can cause: |δ(x/z)| <= (1 + |x/z|) / (255 z - 1), whatever the depth of
/// the map. A map of f(u) + g(w) has no such cell, so its green is not guessed. The map is a height field at
/// a scale s if its residual there is small: the smaller of Σ (h_uw ∓ h_wu)² / Σ (h_uw² + h_wu²),
/// which is 0 for a gradient and 1 for unrelated slopes. `green` is decided if at some scale at least 16
/// cells vote, 4/5 of them agree, and the residual is at most 0.2. A baked map that corrects coarse triangles
/// is not a height field and remains undecided. A flipped red channel cannot be told from a flipped green
/// channel.
///
/// `swapped` compares the residuals of both orders of red and green. It is decided where one is below 0.1 and
/// the other above 0.3.
/// \param signed_floats as in NormalMapOptions Cost: some 0.1 µs and 40 bytes per texel. \throws
/// ParameterError as convert_normal_map()
NormalMapCheck check_normal_map(const Image& map, bool signed_floats = false);

struct MapDifference {
  struct Texel {
    int x = 0, y = 0;
    double angle_deg = 0;
    std::int32_t island = -1;
  };
  /// An island of uvs (mesh_classes.h). If maps are compared without a mesh, the whole map is one island.
  struct Island {
    std::size_t piece = 0;
    std::int32_t island = 0;
    std::size_t texels = 0;
    Statistics angle_deg;
  };
  std::size_t compared = 0;    ///< texels: covered, and a direction in both maps
  std::size_t not_finite = 0;  ///< texels covered, without a direction in one of them
  Statistics angle_deg;
  std::vector<Island> islands;    ///< those with texels, in the order of the mesh
  std::vector<Texel> worst;       ///< largest angles first; at most as many as requested
  std::vector<float> angles_deg;  ///< of each texel; NaN where none was compared
};

struct CompareMapsOptions {
  bool signed_floats = false;
  MapGreen green_a = MapGreen::opengl, green_b = MapGreen::opengl;
  int worst = 10;
};

/// The angles between the vectors of two maps of the same size; lengths and bit depths may differ. \param
/// pieces the triangles whose texels are compared; empty: all texels
/// \throws ParameterError for maps of different sizes, MeshError for pieces without uvs
MapDifference compare_normal_maps(const Image& a, const Image& b, std::span<const MapPiece> pieces,
                                  const CompareMapsOptions& options = {});

/// A heat map of the angles: black for texels not compared; otherwise from dark blue through green to yellow
/// at `full_deg` and above.
Image heat_map(const MapDifference& difference, int width, int height, double full_deg);

}  // namespace darboux
