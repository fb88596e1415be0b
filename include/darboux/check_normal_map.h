/// \file check_normal_map.h
/// Checks a tangent-space normal map by its texels alone, and measures how far two maps differ.
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

/// What check_normal_map() found.
struct NormalMapCheck {
  std::size_t texels = 0;
  std::size_t not_finite = 0;     ///< NaN, infinite or zero
  std::size_t below_surface = 0;  ///< z <= 0
  /// Texels whose length differs from 1 by more than rounding or truncation to codes explains: 2 √3 / most;
  /// for f32 1e-6.
  std::size_t not_unit = 0;
  double least_length = 0, greatest_length = 0;
  std::array<double, 3> mean{};  ///< of x, y and z
  /// Every texel is (0, 0, 1) as far as 8 bits can tell: the material needs no tangents (`plan --level
  /// pixels`).
  bool flat = false;
  std::optional<int> z_channel;  ///< 0, 1 or 2: the channel that is above 1/4 on average and the largest
  /// Which way green points; nothing where the map does not tell: see below.
  std::optional<MapGreen> green;
  std::optional<bool> swapped;   ///< red and green are swapped
  std::size_t voting_cells = 0;  ///< on which `green` rests
  double agreeing = 0;           ///< the share of them that say so
};

/// Checks a map without a mesh or a surface.
///
/// The map of a height field h over the image has (-x/z, -y/z) = (h_u, h_w), w up the image. If green points
/// up, the mixed derivatives agree: h_uw = h_wu. If green points down, they are opposite. Both are taken from
/// central differences between means of s x s texels, s = 1, 2, 4, .... A cell votes if each of the two
/// exceeds what rounding to 8 bits can cause: |δ(x/z)| <= (1 + |x/z|) / (255 z - 1), whatever the depth of
/// the map. A map of f(u) + g(w) has no such cell, so its green is not guessed. The map is a relief at a
/// scale if its residual there, Σ (h_uw ∓ h_wu)² over Σ (h_uw² + h_wu²), the smaller, is small: it is
/// 0 for a gradient, 1 for unrelated slopes. `green` is decided if at some scale at least 16 cells vote, 4/5
/// of them agree, and the residual is at most 0.2. A baked map of what the triangles leave out is no relief
/// and stays undecided. A flipped red looks the same as a flipped green.
///
/// `swapped` compares the residuals of both orders of red and green. It is decided where one is below 0.1 and
/// the other above 0.3.
///
/// \param signed_floats as NormalMapOptions has it
/// Cost: some 0.1 µs and 40 bytes per texel. \throws ParameterError as convert_normal_map()
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
  std::size_t not_finite = 0;  ///< covered, and no direction in one of them
  Statistics angle_deg;
  std::vector<Island> islands;    ///< those with texels, in the order of the mesh
  std::vector<Texel> worst;       ///< the largest angles first; at most as many as asked for
  std::vector<float> angles_deg;  ///< of each texel; NaN where none was compared
};

struct CompareMapsOptions {
  bool signed_floats = false;
  MapGreen green_a = MapGreen::opengl, green_b = MapGreen::opengl;
  int worst = 10;
};

/// The angles between the vectors of two maps of one size, whatever their lengths and depths.
/// \param pieces which texels count; none: all
/// \throws ParameterError for maps of different sizes, MeshError for pieces without uvs
MapDifference compare_normal_maps(const Image& a, const Image& b, std::span<const MapPiece> pieces,
                                  const CompareMapsOptions& options = {});

/// A picture of the angles: black where none was compared, else from dark blue over green to yellow at
/// `full_deg` and beyond.
Image heat_map(const MapDifference& difference, int width, int height, double full_deg);

}  // namespace darboux
