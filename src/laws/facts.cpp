// The facts that a surface states.
#include <algorithm>

#include "curvature.h"
#include "law.h"

namespace darboux::laws {
namespace {

bool states(const AnySurface& surface, std::string_view fact) {
  const auto all = surface.facts();
  return std::find(all.begin(), all.end(), fact) != all.end();
}

}  // namespace

// Zero on the surface, with the gradient along the normal: positive on the side of n, ±n if the surface is
// one-sided.
void check_implicit(const AnySurface& surface, const Points& points, Checks& checks) {
  constexpr std::string_view none = "the surface states no implicit equation";
  Law position(points.name, "implicit", "position"), normal(points.name, "implicit", "normal");
  if (states(surface, "implicit"))
    for (const Point& p : points.list) {
      // implicit() is a length: position and equation each err by a few roundings of the largest length.
      const double roundings = 16 * unit_roundoff * (1 + p.condition[0]);
      position.compare(std::fabs(*surface.implicit(p.j.position)) / points.scale[0], roundings, p.u, p.v);
      if (!curvable(p)) continue;
      const Vec3<double> gradient = *surface.implicit_gradient(p.j.position);
      // The gradient at a rounded position, by how it changes over a millionth of the size and by the
      // curvature, where the surface bends within less; the normal of rounded partials.
      const double step = 1e-6 * points.scale[0];
      const Curvature<double> c = curvature(p.j, p.f);
      double change = points.scale[0] * (std::fabs(c.principal[0]) + std::fabs(c.principal[1]));
      for (const Vec3<double>& way : {p.f.t, p.f.b, p.f.n})
        change += norm(*surface.implicit_gradient(p.j.position + step * way) - gradient) / 1e-6;
      const double bound =
          roundings * (1 + change) + 16 * unit_roundoff * frame_condition(points, p, p.j.dpdu, p.j.dpdv);
      const double off = norm(gradient - p.f.n);
      const bool two_values = !surface.info().orientable || has(p.f.status, Status::self_intersecting);
      if (bound <= worst_estimate)
        normal.compare(two_values ? std::fmin(off, norm(gradient + p.f.n)) : off, bound, p.u, p.v);
    }
  checks.push_back(position.result(none));
  const bool taken_at_its_word = surface.info().own_orientation && !states(surface, "mean_curvature");
  checks.push_back(normal.result(
      states(surface, "implicit") ? "rounding would explain an error above 1e-6 everywhere"
      : taken_at_its_word
          ? "the surface states no implicit equation and no mean curvature: nothing tells the side of n"
          : none));
}

void check_second_formula(const AnySurface& surface, const Points& points, Checks& checks) {
  Law law(points.name, "second_formula", "position");
  if (states(surface, "second_formula"))
    for (const Point& p : points.list)
      law.compare(norm(*surface.second_formula(p.u, p.v) - p.j.position) / points.scale[0],
                  16 * unit_roundoff * (1 + p.condition[0]), p.u, p.v);
  checks.push_back(law.result("the surface states no second formula of its position"));
}

void check_curvature(const AnySurface& surface, const Points& points, Checks& checks) {
  const double size = points.scale[0];
  std::vector<Pair> gaussian, mean;
  const bool states_gaussian = states(surface, "gaussian_curvature"),
             states_mean = states(surface, "mean_curvature");
  for (const Point& p : points.list) {
    if (!curvable(p)) continue;
    const Curved k(p);
    if (states_gaussian)
      gaussian.push_back({p.u, p.v, *surface.gaussian_curvature(p.u, p.v), k.c.gaussian, k.gaussian_error()});
    if (states_mean) mean.push_back({p.u, p.v, *surface.mean_curvature(p.u, p.v), k.c.mean, k.mean_error()});
  }
  checks.push_back(compared(points, "curvature", "gaussian_curvature", gaussian, 1e-6 / size / size,
                            states_gaussian ? "" : "the surface states no Gaussian curvature"));
  checks.push_back(compared(points, "curvature", "mean_curvature", mean, 1e-6 / size,
                            states_mean ? "" : "the surface states no mean curvature"));
}

// P(u + k, v) = P(u, v) for a turn, P(u + 1, v) = P(u, 1 - v) and n(u + 1, v) = -n(u, 1 - v) for a twisted
// one, bit for bit where u + k is exact.
void check_periodicity(const AnySurface& surface, const Points& points, Checks& checks) {
  const SurfaceInfo& info = surface.info();
  // A point on one side of a one-sided surface (its offset) returns after two turns, without a twist.
  const bool one_sided = info.u == Coordinate::twisted_turn, twisted = one_sided && !info.own_orientation;
  const double turns = one_sided && !twisted ? 2 : 1;
  const bool periodic_u = info.u == Coordinate::turn || one_sided, periodic_v = info.v == Coordinate::turn;
  if (!periodic_u && !periodic_v) {
    checks.push_back(Law(points.name, "periodicity", "position").result("neither coordinate is periodic"));
    return;
  }
  Law position(points.name, "periodicity", "position"), normal(points.name, "periodicity", "normal");
  for (const Point& p : points.list) {
    const double u = std::ldexp(std::floor(std::ldexp(p.u, 30)), -30),
                 v = std::ldexp(std::floor(std::ldexp(p.v, 30)), -30);
    const Vec3<double> at = surface.jet(u, v).position, n = surface.frame(u, v).n;
    for (const double k : {1.0, -3.0, 0x1p20 - 1}) {  // odd, to show the twist
      const double there_u = periodic_u ? u + turns * k : u, moved_v = periodic_v && !twisted ? v - k : v,
                   there_v = twisted ? 1 - moved_v : moved_v;
      const Vec3<double> m = surface.frame(there_u, there_v).n;
      position.compare(at == surface.jet(there_u, there_v).position ? 0 : 1, 0, u, v);
      normal.compare(n == (twisted ? -m : m) || has(surface.frame(u, v).status, Status::no_frame) ? 0 : 1, 0,
                     u, v);
    }
  }
  checks.push_back(position.result());
  checks.push_back(normal.result());
}

}  // namespace darboux::laws
