/// \file tile_bounds.h
/// Bounds for a whole tile of a surface, without sampling it: its extent, whether it is entirely back-facing,
/// how finely it must be sampled. All bounds are conservative, rounding included, so nothing visible is
/// culled.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <variant>

#include <darboux/any_surface.h>

namespace darboux {

/// The part u0 <= u <= u1, v0 <= v <= v1 of a chart. A periodic u may have any u0, and u1 <= u0 + 1.
struct Tile {
  double u0 = 0, u1 = 1, v0 = 0, v1 = 1;
};

/// Upper bounds, over a tile, of the second derivatives of the position and of the rates of the frame;
/// infinite if unknown.
struct TileRates {
  static constexpr double unknown = std::numeric_limits<double>::infinity();
  double position_uu = unknown, position_uv = unknown, position_vv = unknown;  ///< |d²P|
  double frame_u = unknown, frame_v = unknown;    ///< angular velocity of the frame (t, b, n)
  double normal_u = unknown, normal_v = unknown;  ///< |dn|
  /// The part of d²n that is perpendicular to n, and the largest such part of t, b and n: a part along n
  /// changes only the length of the interpolated vector.
  double normal_uu = unknown, normal_uv = unknown, normal_vv = unknown;
  double frame_uu = unknown, frame_uv = unknown, frame_vv = unknown;

  /// An upper bound of the distance from the surface to its points interpolated linearly in any triangle
  /// within a cell of size |du| × |dv|: (M_uu du² + 2 M_uv |du dv| + M_vv dv²)/8, M the largest |d²P|
  /// [Filip1986].
  double chord(double du, double dv) const;
  /// Upper bounds, in radians, of the angle between n, or whichever of t, b and n, and the same vector
  /// interpolated linearly in such a triangle and normalised; infinite where the interpolated one may
  /// vanish. With L = L_u |du| + L_v |dv|, the turning within the cell, and e by chord's formula from the
  /// second derivatives, it is the smaller of
  ///   (e + L³/48)/(1 - L²/8)   and   asin L/2.
  /// Across n, the vertices are off by d²n/2 of the way to them and, as n itself turns on the way, by L³/6;
  /// barycentric weights give u a variance of at most du²/4 and a third absolute moment of du³/8.
  double normal_interpolation_angle(double du, double dv) const;
  double frame_interpolation_angle(double du, double dv) const;
};

/// Up to which order derivatives of the frame are bounded: none, if only positions are needed; the first; or
/// also the second, which require third partials.
enum class TileOrder : std::uint8_t { position, first, second };

namespace tiles {

// The range of angles x, with what sines of it are made of.
struct Arc {
  double from, to;  // radians
  double sin_from, cos_from, sin_to, cos_to;

  // An upper bound of a cos x + b sin x over the arc.
  double most(double a, double b) const;
};

// ρ(x) (cos φ, sin φ), z(x) over x and φ: ρ = R + r cos x, z = r sin x. A sphere has R = 0.
struct RoundProfile {
  double major_radius, radius;
  Arc round, profile;
};
// ρ and z linear between two ends, n = (n_rho cos φ, n_rho sin φ, n_z): cylinder, cone, disk.
struct StraightProfile {
  double rho[2], z[2], n_rho, n_z;
  double height_over_normal;  // n·P, the same everywhere
  Arc round;
  double rate_v, rate_uv;  // |dP/dv|, |d²P/du dv|
};
struct Rectangle {
  double x[2], y[2];
};
// Position and partials on intervals.
struct Enclosed;
// A unit sphere's tile, stretched along the axes. The rates of its frame are those on intervals.
struct ScaledSphere {
  Vec3<double> axes;
  Arc round, profile;
  std::shared_ptr<const Enclosed> enclosed;

  double shortest() const { return std::fmin(axes.x, std::fmin(axes.y, axes.z)); }
  double longest() const { return std::fmax(axes.x, std::fmax(axes.y, axes.z)); }
};

}  // namespace tiles

/// The bounds of one tile, in the space of the surface: transform the eye point into it, not the tile.
/// Sphere, torus (a ring), cylinder, cone, disk and plane have closed forms. The tile attains these bounds,
/// so no tighter ones exist; for an ellipsoid this holds for support and the sign of facing. Construction
/// takes 30 to 70 ns, each bound 4 to 35 ns. The rest of the catalogue uses intervals with linear forms. The
/// tile attains these bounds up to terms of second order in its size, so they are good for small tiles,
/// unless a tile touches a pole or contains a knot. Construction takes 1 to 7 us, for splines and what is
/// made of them 20 to 50 us; support and facing 0.1 to 0.25 us, rates 2 to 4 us. (One core of a virtual
/// machine; tests/benchmark/tile_bounds.cpp.) Extrusions, surfaces of revolution, ruled surfaces and tubes
/// have bounds if their curves are among those that enclose() in src/scene/enclosed.cpp lists: b-splines,
/// circles, lines, helices. Surfaces from files and user-defined types have no bounds, and must not be
/// culled.
class TileBounds {
 public:
  /// \param tile within the domain of the surface; otherwise, or if something is not finite, there are no
  /// bounds
  /// \param order second for rates() with second derivatives of the frame: on intervals construction takes 20
  /// to 60 us, of splines 80 to 170 us. Closed forms have them anyway. They are infinite where the tile holds
  /// a knot across which fewer than two derivatives of the position are continuous.
  TileBounds(const AnySurface& surface, const Tile& tile, TileOrder order = TileOrder::first);

  /// Whether there are bounds. If not, the functions below return infinity.
  bool known() const { return !std::holds_alternative<std::monostate>(shape_); }
  /// Whether support() and facing() come from closed forms and are sharp (attained by the tile).
  bool attained() const;
  /// Lipschitz constant of facing() with respect to the eye point, and of facing_along() with respect to the
  /// direction. Infinite if unknown.
  double facing_rate() const;

  /// An upper bound of direction · P over the tile: the tile lies wholly where direction · P <= support.
  /// With the outer normal of a plane of the frustum, a tile is outside where -support(-normal) exceeds its
  /// offset; with the axes it is the tile's box. For closed forms it exceeds the maximum by at most
  /// 32u |direction| size, size a length about that of the tile's farthest point from the origin.
  double support(const Vec3<double>& direction) const;

  /// An upper bound, a length, of n · (eye - P), n unit: where it is negative, all of the tile faces away
  /// from the eye. The back side of a surface that is open, or seen from inside, can still be visible: cull
  /// only surfaces that are single-sided and not displaced. For closed forms it exceeds the maximum by at
  /// most 32u (|eye| + size); for ellipsoids it tells the sign alone, within that times the ratio of the
  /// longest to the shortest semi-axis.
  double facing(const Vec3<double>& eye) const;
  /// The same for parallel rays: of n · towards_eye.
  double facing_along(const Vec3<double>& towards_eye) const;

  /// All rates that determine the sampling of the tile. Infinite for tiles with a crease inside or at their
  /// upper end, where the frame is that from above.
  TileRates rates() const;
  /// An upper bound of the distance from the surface to the triangles of cells of size du × dv in the tile:
  /// rates().chord(du, dv).
  double chord(double du, double dv) const;
  /// Upper bounds, in radians, of the angle between the normals, and of the rotation between the frames (t,
  /// b, n), of the centre of a cell of size du × dv and of any of its points.
  double normal_angle(double du, double dv) const;
  double frame_angle(double du, double dv) const;

 private:
  std::variant<std::monostate, tiles::RoundProfile, tiles::ScaledSphere, tiles::StraightProfile,
               tiles::Rectangle, std::shared_ptr<const tiles::Enclosed>>
      shape_;
};

}  // namespace darboux
