/// \file placed_surface.h
/// A surface placed in the space of a mesh, with the relation between its (u, v) and the stored uvs.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include <Eigen/Geometry>

#include <darboux/any_surface.h>

namespace darboux {

/// The relation between stored uvs and (u, v): (u, v) of the surface = M (stored u, stored v) + offset.
struct UvConvention {
  std::string_view name;                           ///< "as stored", "flip v", ...
  std::array<double, 6> affine{1, 0, 0, 1, 0, 0};  ///< M row by row, then the offset

  Vec2<double> surface_uv(const Vec2<double>& stored) const {
    return {affine[0] * stored.x + affine[1] * stored.y + affine[4],
            affine[2] * stored.x + affine[3] * stored.y + affine[5]};
  }
};

/// The eight swaps and flips, in the order in which they are tried: "as stored", "flip v", "flip u", "flip
/// both", "swap", "swap flip v", "swap flip u", "swap flip both". A flip applies to the stored coordinate
/// that it names, before the swap.
std::span<const UvConvention> uv_conventions();

/// The reference frame at one stored uv, in the space of the mesh, with its uncertainty.
struct Truth {
  Vec3<double> position;
  Vec3<double> normal;     ///< the surface's n
  Vec3<double> tangent;    ///< unit, along the derivative by the stored u; at a pole, its limit for this uv
  Vec3<double> bitangent;  ///< unit, along the derivative by the stored v
  Status status;           ///< the surface's
  /// The chart is singular here, up to rounding of the uvs: at (u, v) itself; or after rounding coordinates
  /// within 1e-6 of a multiple of 1/4 to that multiple; or because dpdu vanishes within a distance in v of
  /// 1e-6, or of four roundings of uvs stored as floats.
  bool pole;
  double normal_deg = 0;   ///< standard deviation of the angle of `normal`; zero: surface known exactly
  double tangent_deg = 0;  ///< the same for `tangent`
};

/// A surface with its placement and uv convention.
struct PlacedSurface {
  AnySurface surface;
  /// From the surface's space to mesh space, proper.
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  UvConvention uv{"as stored"};

  Vec3<double> position(const Vec2<double>& stored) const;
  Truth truth(const Vec2<double>& stored) const;  ///< the exact truth, with zero deviations
  /// The same, given the sample of the surface at uv.surface_uv(stored).
  Truth truth(const Vec2<double>& stored, const Sample<double>& at) const;
};

}  // namespace darboux
