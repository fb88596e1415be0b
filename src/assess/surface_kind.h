// The kinds of surface that recognition treats specially, made from the names that the fits give.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include <darboux/fit_mesh.h>

namespace darboux {

enum class SurfaceKind : std::uint8_t {
  plane,
  disk,
  sphere,
  cylinder,
  cone,
  torus,
  ellipsoid,
  elliptic_paraboloid,
  helicoid,
  catenoid,
  moebius_strip,
  klein_bottle,
  enneper,
  other
};
inline constexpr std::array<std::string_view, 13> surface_kind_names{
    "plane",    "disk",     "sphere",        "cylinder",
    "cone",     "torus",    "ellipsoid",     "elliptic-paraboloid",
    "helicoid", "catenoid", "moebius-strip", "klein-bottle",
    "enneper"};

inline SurfaceKind kind_of(std::string_view name) {
  const auto found = std::find(surface_kind_names.begin(), surface_kind_names.end(), name);
  return static_cast<SurfaceKind>(found - surface_kind_names.begin());
}
inline SurfaceKind kind_of(const MeshFit& fit) {
  return kind_of(fit.surface.surface.info().name);
}

// Kinds whose n may be on either side.
inline bool is_planar(SurfaceKind kind) {
  return kind == SurfaceKind::plane || kind == SurfaceKind::disk;
}

// Whether its uvs are the surface's own after an affine map other than uv_conventions() plus whole tiles.
inline bool has_affine_uvs(const MeshFit& fit) {
  const auto known = uv_conventions();
  return fit.chart == UvChart::own && std::none_of(known.begin(), known.end(), [&](const UvConvention& c) {
           return c.name == fit.surface.uv.name;
         });
}

}  // namespace darboux
