/// \file placed_surface.h
/// A surface as a mesh has it: placed in space, with the meaning of the mesh's stored uvs.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include <Eigen/Geometry>

#include <darboux/any_surface.h>

namespace darboux {

/// What a stored uv means: (u, v) of the surface = M (stored u, stored v) + offset.
struct UvConvention {
  std::string_view name;                           ///< "as stored", "flip v", ...
  std::array<double, 6> affine{1, 0, 0, 1, 0, 0};  ///< M row by row, then the offset

  Vec2<double> surface_uv(const Vec2<double>& stored) const {
    return {affine[0] * stored.x + affine[1] * stored.y + affine[4],
            affine[2] * stored.x + affine[3] * stored.y + affine[5]};
  }
};

/// The eight swaps and flips, in the order in which they are tried: "as stored", "flip v", "flip u", "flip
/// both", "swap", "swap flip v", "swap flip u", "swap flip both". A flip is of the stored coordinate it
/// names, before the swap.
std::span<const UvConvention> uv_conventions();

/// The truth at one stored uv, in the mesh's space, as well as it is known.
struct Truth {
  Vec3<double> position;
  Vec3<double> normal;     ///< the surface's n
  Vec3<double> tangent;    ///< unit, along the derivative by the stored u; at a pole its limit for this uv
  Vec3<double> bitangent;  ///< unit, along the derivative by the stored v
  Status status;           ///< the surface's
  /// The chart is singular here, up to rounding of the uvs: at (u, v) itself; or after coordinates within
  /// 1e-6 of a multiple of 1/4 are rounded to it; or dpdu vanishes within 1e-6 in v, or within four roundings
  /// of uvs stored as floats.
  bool pole;
  double normal_deg = 0;  ///< standard deviation of the angle of `normal`; zero: the surface is known exactly
  double tangent_deg = 0;  ///< of `tangent`
};

/// A surface with its placement and uv convention.
struct PlacedSurface {
  AnySurface surface;
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();  ///< local frame to mesh, proper
  UvConvention uv{"as stored"};

  Vec3<double> position(const Vec2<double>& stored) const;
  Truth truth(const Vec2<double>& stored) const;  ///< of the surface as it is, without deviations
  /// The same from the surface's sample at uv.surface_uv(stored).
  Truth truth(const Vec2<double>& stored, const Sample<double>& at) const;
};

}  // namespace darboux
