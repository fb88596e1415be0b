/// \file project.h
/// The point of a parametric surface nearest to a point in space.
#pragma once

#include <vector>

#include <darboux/any_surface.h>
#include <darboux/placed_surface.h>

namespace darboux {

/// The foot point: the point of a surface nearest to a given point.
struct Projection {
  Vec2<double> uv;        ///< coordinates of the surface; periodic ones in [0, 1)
  Vec3<double> position;  ///< the foot point
  Vec3<double> normal;    ///< the surface's n there; NaN where it has none
  double distance = 0;    ///< |p - position|, negative if p lies on the side opposite to n
  Status status{};        ///< of the surface at the foot point
  int iterations = 0;     ///< of Newton's method, over all starts
  bool converged =
      false;  ///< the distance is stationary: up to rounding, no admissible direction leads nearer
};

/// Whether the surface continues beyond [0, 1] of a linear coordinate.
enum class Extent {
  patch,     ///< it does not: the foot may lie on the border
  extended,  ///< its analytic extension: cylinder, cone and plane do not end. At an end of the domain that is
             ///< a single point (a cone's apex, the middle of a disk) the surface ends all the same
};

/// Projects points onto one surface by Newton's method on half the squared distance in (u, v). The Hessian is
/// made positive definite, and the step is halved until the distance falls. [NocedalWright2006, sec. 3.4]
/// Searches start at the local minima of the distance on a grid of 33 by 33 points of the patch, nearest
/// first. Starts that cannot lead to a nearer foot than the one found are skipped. Feet that the grid does
/// not resolve can be confused. At a point where the chart collapses (a pole), the search continues in the
/// best of 16 directions. The foot is accurate to a few roundings of the size of the surface and |p|, divided
/// by the smaller of the two 1 - d κ, κ the principal curvatures. Where that is zero (p is a focal point),
/// convergence is slower; `converged` tells whether it was reached. Creases and points with infinite partials
/// may also prevent convergence. An extended linear coordinate is searched from the patch outward. Immutable,
/// so threads may share one. Cost: about 10 us per search on a sphere, 1 us from a start near the foot.
class Projector {
 public:
  explicit Projector(const AnySurface& surface, Extent extent = Extent::extended);

  /// The nearest foot point of p. NaN, and not converged, if p is not finite.
  Projection operator()(const Vec3<double>& p) const;

  /// The foot point that Newton's method reaches from a given start.
  Projection operator()(const Vec3<double>& p, const Vec2<double>& start) const;

 private:
  struct Node {
    Vec2<double> uv;
    Vec3<double> position;
    double reach;  // distance of its farthest neighbour
  };
  struct Limits {
    double minimum, maximum;
  };

  Projection newton(const Vec3<double>& p, Vec2<double> uv) const;
  Projection at(const Vec3<double>& p, const Vec2<double>& uv) const;
  Vec2<double> limited(const Vec2<double>& uv) const;
  bool nearer_beside_collapse(const Vec3<double>& p, const Jet2<double>& j, Vec2<double>& uv) const;

  AnySurface surface_;
  Limits u_, v_;
  std::vector<Node> nodes_;  // row by row, u fastest
  double size_;              // the largest coordinate of the patch
};

/// Projects one point. Constructs a Projector on each call (about 100 us).
Projection project(const AnySurface& surface, const Vec3<double>& p, Extent extent = Extent::extended);

/// The same for a placed surface: p is in placed space, uv are coordinates of the surface.
Projection project(const PlacedSurface& surface, const Vec3<double>& p, Extent extent = Extent::extended);

}  // namespace darboux
