// Derivatives by other routes: dual numbers and differences.
#include <functional>
#include <numbers>

#include <darboux/differentiate.h>

#include "law.h"

namespace darboux::laws {

void check_dual(const AnySurface& surface, const Points& points, Checks& checks) {
  std::vector<Law> laws;
  for (int is = 1; is < 6; ++is) laws.emplace_back(points.name, "dual", names[is]);
  Law tangent(points.name, "dual", "tangent"), normal(points.name, "dual", "normal"),
      bitangent(points.name, "dual", "bitangent"), handedness(points.name, "dual", "handedness");
  for (const Point& p : points.list) {
    const Jet2<DualUV> d = surface.jet(DualUV::variable(p.u, 0), DualUV::variable(p.v, 1));
    for (const Derivative& dual : derivatives) {
      const Vec3<double> found = derivative(partial(d, dual.of), dual.along);
      // Two roundings of the same value, each within 8u (1 + condition).
      laws[dual.is - 1].compare(norm(found - partial(p.j, dual.is)) / points.scale[dual.is],
                                16 * unit_roundoff * (1 + p.condition[dual.is]), p.u, p.v);
    }
    const Vec3<double> du = derivative(d.position, 0), dv = derivative(d.position, 1);
    const Frame<double> generic = frame_from_partials(du, dv);
    if (has(p.f.status, Status::limit_frame | Status::no_frame) || has(generic.status, Status::no_frame))
      continue;
    const double bound = 16 * unit_roundoff * (1 + frame_condition(points, p, du, dv));
    tangent.compare(norm(p.f.t - generic.t), bound, p.u, p.v);
    normal.compare(norm(p.f.n - p.f.handedness * generic.n), bound, p.u, p.v);
    bitangent.compare(norm(p.f.b - cross(p.f.n, p.f.t)), 16 * unit_roundoff, p.u, p.v);
    const double determinant = dot(cross(unit(du), unit(dv)), p.f.n);
    const bool right =
        (surface.info().own_orientation || p.f.handedness == 1) && determinant * p.f.handedness > 0;
    if (bound < 1) handedness.compare(right ? 0 : 1, 0, p.u, p.v);
  }
  for (const Law& law : laws) checks.push_back(law.result());
  for (const Law* law : {&tangent, &bitangent, &normal}) checks.push_back(law->result());
  checks.push_back(handedness.result("rounding could turn the normal over everywhere"));
}

namespace {

// Numerical differentiation by one method, f: double -> Vec3<double>, with its estimate.
using Differentiate =
    std::function<DerivativeEstimate<>(const std::function<Vec3<double>(double)>&, double x, double length)>;

// The length over which the surface varies like a full period, at most 1: 2π times the ratio of the first to
// the second derivative along u or v, or of the second to the third, rounded to a power of two.
double variation(const Points& points, int along) {
  const std::size_t one = along == 0 ? 1 : 2, two = along == 0 ? 3 : 5;
  const double third = points.third[along];
  double shortest = 1;
  if (!points.vanishes[two]) shortest = std::fmin(shortest, points.scale[one] / points.scale[two]);
  if (third > 0) shortest = std::fmin(shortest, points.scale[two] / third);
  return std::fmin(1, std::exp2(std::floor(std::log2(2 * std::numbers::pi * shortest) + 0.5)));
}

void compare_numeric(const AnySurface& surface, const Points& points, std::string_view route,
                     const Differentiate& differentiate, bool at_edges, Checks& checks) {
  const std::array<double, 2> length{variation(points, 0), variation(points, 1)};
  const std::array<std::vector<double>, 2> breaks{surface.breaks(0), surface.breaks(1)};
  for (int is = 1; is < 6; ++is) {
    Law law(points.name, route, names[is]);
    for (const Point& p : points.list) {
      for (const Derivative& d : derivatives) {
        if (d.is != is) continue;
        double u = p.u, v = p.v;
        Vec3<double> closed = partial(p.j, is);
        double condition = p.condition[is];
        if (at_edges) {
          const Coordinate kind = d.along == 0 ? surface.info().u : surface.info().v;
          if (kind != Coordinate::linear && kind != Coordinate::half_turn) continue;
          double& edge = d.along == 0 ? u : v;
          edge = edge < 0.5 ? 0 : 1;
          closed = partial(surface.jet(u, v), is);
        }
        const auto along = [&](double x) {
          return partial(d.along == 0 ? surface.jet(x, v) : surface.jet(u, x), d.of);
        };
        // No stencil reaches farther than a sixteenth of the length: it stays on one smooth piece.
        double stretch = length[d.along];
        for (const double x : breaks[d.along]) {
          if (x == 0 && at_edges) continue;
          const double away = std::fabs(x - (d.along == 0 ? u : v));
          stretch = std::fmin(stretch, 15 * (x == 0 ? std::fmin(away, 1 - away) : away));
        }
        if (stretch == 0) continue;
        const DerivativeEstimate<> numeric = differentiate(along, d.along == 0 ? u : v, stretch);
        // Four times the estimate, since it is not a bound and does not include repeated rounding in the
        // formula. The closed form's own error is 8u (1 + condition).
        const double bound = 4 * numeric.error / points.scale[is] + 8 * unit_roundoff * (1 + condition);
        if (bound <= worst_estimate)
          law.compare(norm(numeric.value - closed) / points.scale[is], bound, u, v);
      }
    }
    checks.push_back(law.result(at_edges
                                    ? "neither coordinate along which it is differentiated has an edge"
                                    : "the route's own error estimate exceeds 1e-6 of the scale everywhere"));
  }
}

constexpr std::array<std::string_view, 4> central_names{"central2", "central4", "central6", "central8"};

}  // namespace

template <int order>
void check_central(const AnySurface& surface, const Points& points, Checks& checks) {
  compare_numeric(
      surface, points, central_names[order / 2 - 1],
      [](const auto& f, double x, double length) {
        return central_difference<order>(f, x, central_step<order>(length));
      },
      false, checks);
}

template void check_central<2>(const AnySurface&, const Points&, Checks&);
template void check_central<4>(const AnySurface&, const Points&, Checks&);
template void check_central<6>(const AnySurface&, const Points&, Checks&);
template void check_central<8>(const AnySurface&, const Points&, Checks&);

void check_one_sided(const AnySurface& surface, const Points& points, Checks& checks) {
  compare_numeric(
      surface, points, "one_sided8",
      [](const auto& f, double x, double length) {
        const double h = one_sided_step<8>(length);
        return one_sided_difference<8>(f, x, x < 0.5 ? h : -h);
      },
      true, checks);
}

void check_ridders(const AnySurface& surface, const Points& points, Checks& checks) {
  compare_numeric(
      surface, points, "ridders",
      [](const auto& f, double x, double length) { return ridders(f, x, length / 16); }, false, checks);
}

}  // namespace darboux::laws
