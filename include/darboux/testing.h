/// \file testing.h
/// The laws a surface must obey, run on any surface type: closed form against dual numbers, central
/// differences and the independent facts the surface states. `darboux check` and the tests run these on the
/// catalogue; run them on a surface of your own with
///     for (const darboux::Check& c : darboux::check_surface(MySurface{})) ...
/// A consistently wrong formula passes the derivative routes (they differentiate the formula itself); only
/// the facts `implicit` and `gaussian_curvature` can see it. A fact the surface does not state is returned as
/// skipped.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/differentiate.h>
#include <darboux/evaluate.h>
#include <darboux/forms.h>

namespace darboux {

/// How a surface is checked.
struct CheckOptions {
  int points = 1000;       ///< random (u, v), uniform in the unit square
  std::uint64_t seed = 1;  ///< of std::mt19937_64
};

/// The outcome of one law. Errors and bounds are relative to the quantity's scale: its largest magnitude over
/// the points (of the position where it vanishes identically).
struct Check {
  std::string_view surface, route, quantity;
  int points = 0;        ///< how many values were really compared
  double max_error = 0;  ///< at the point where error/bound is largest
  double bound = 0;      ///< there
  bool passed = false;
  double worst_u = 0, worst_v = 0;
  std::string skipped;  ///< why the law does not apply; empty where it was checked
};

namespace detail {

constexpr double unit_roundoff = 0x1p-53;

// Keeps the point with the worst error / bound of one law.
class Law {
 public:
  Law(std::string_view surface, std::string_view route, std::string_view quantity)
      : check_{surface, route, quantity, 0, 0, 0, true, 0, 0, {}} {}

  void compare(double error, double bound, double u, double v) {
    ++check_.points;
    // Written so that a NaN fails.
    const bool within = error <= bound;
    const double ratio = bound > 0 ? error / bound : (within ? 0 : std::numeric_limits<double>::infinity());
    if (check_.points == 1 || !(ratio <= worst_ratio_)) {
      if (!std::isnan(worst_ratio_)) {
        worst_ratio_ = ratio;
        check_.max_error = error;
        check_.bound = bound;
        check_.worst_u = u;
        check_.worst_v = v;
      }
    }
    check_.passed = check_.passed && within;
  }

  // \param nothing_compared why, where no point could be compared; empty: that is a failure
  Check result(std::string_view nothing_compared = {}) const {
    Check c = check_;
    if (c.points == 0) {
      c.passed = !nothing_compared.empty();
      c.skipped = c.passed ? nothing_compared : "no point could be compared";
    }
    return c;
  }

 private:
  Check check_;
  double worst_ratio_ = 0;
};

inline Check skipped_check(std::string_view surface, std::string_view route, std::string_view quantity,
                           std::string why) {
  return {surface, route, quantity, 0, 0, 0, true, 0, 0, std::move(why)};
}

// The partials in the order of Jet2, with the names of eval's keys.
struct NamedPartial {
  std::string_view name;
  Vec3<double> Jet2<double>::*member;
};
inline constexpr std::array<NamedPartial, 6> partials{{{"position", &Jet2<double>::position},
                                                       {"dpdu", &Jet2<double>::dpdu},
                                                       {"dpdv", &Jet2<double>::dpdv},
                                                       {"d2pdu2", &Jet2<double>::d2pdu2},
                                                       {"d2pduv", &Jet2<double>::d2pduv},
                                                       {"d2pdv2", &Jet2<double>::d2pdv2}}};

// Each first derivative the routes look at: partial `of` differentiated along `along` (0: u, 1: v) is `is`.
struct Derivative {
  int of, along, is;
};
inline constexpr std::array<Derivative, 6> derivatives{
    {{0, 0, 1}, {0, 1, 2}, {1, 0, 3}, {1, 1, 4}, {2, 0, 4}, {2, 1, 5}}};

struct Points {
  std::vector<Vec2<double>> uv;
  std::array<double, 6> scale{};  // largest magnitude of each partial over the points
  template <class X>
  Points(const X& surface, const CheckOptions& options) {
    std::mt19937_64 random(options.seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int i = 0; i < options.points; ++i) {
      const double u = uniform(random), v = uniform(random);
      uv.push_back({u, v});
      const Jet2<double> j = jet(surface, u, v);
      for (std::size_t k = 0; k < 6; ++k) scale[k] = std::fmax(scale[k], norm(j.*partials[k].member));
    }
    for (double& s : scale)
      if (s == 0) s = scale[0];
  }
};

template <class X>
void check_dual(const X& surface, const Points& points, std::vector<Check>& checks) {
  using D = Dual<double, 2>;
  // Both sides evaluate the same few products in another order: 32 roundings of the largest are ample.
  constexpr double bound = 32 * unit_roundoff;
  for (int is = 1; is < 6; ++is) {
    Law law(X::info.name, "dual", partials[is].name);
    for (const auto& [u, v] : points.uv) {
      const Jet2<D> d = jet(surface, D::variable(u, 0), D::variable(v, 1));
      const Jet2<double> j = jet(surface, u, v);
      const std::array<const Vec3<D>*, 3> of{&d.position, &d.dpdu, &d.dpdv};
      for (const Derivative& derivative : derivatives) {
        if (derivative.is != is) continue;
        const Vec3<D>& p = *of[derivative.of];
        const std::size_t k = derivative.along;
        const Vec3<double> dual{p.x.derivative[k], p.y.derivative[k], p.z.derivative[k]};
        law.compare(norm(dual - j.*partials[is].member) / points.scale[is], bound, u, v);
      }
    }
    checks.push_back(law.result());
  }
  if constexpr (HasClosedFrame<X>) {
    Law tangent(X::info.name, "dual", "tangent"), normal(X::info.name, "dual", "normal"),
        bitangent(X::info.name, "dual", "bitangent"), handedness(X::info.name, "dual", "handedness");
    for (const auto& [u, v] : points.uv) {
      const auto d = jet(surface, D::variable(u, 0), D::variable(v, 1)).position;
      const Vec3<double> du{d.x.derivative[0], d.y.derivative[0], d.z.derivative[0]};
      const Vec3<double> dv{d.x.derivative[1], d.y.derivative[1], d.z.derivative[1]};
      const Frame<double> closed = frame(surface, u, v), from_partials = frame_from_partials(du, dv);
      if (has(closed.status, Status::limit_frame) || has(from_partials.status, Status::no_frame)) continue;
      // A partial that is small against its scale has lost the same share of its digits.
      const double condition = points.scale[1] / norm(du) + points.scale[2] / norm(dv);
      const double frame_bound = 16 * unit_roundoff * (1 + condition);
      // The surface may state its own orientation: then n and b are the opposite, and handedness says so.
      tangent.compare(norm(closed.t - from_partials.t), frame_bound, u, v);
      normal.compare(norm(closed.n - closed.handedness * from_partials.n), frame_bound, u, v);
      bitangent.compare(norm(closed.b - cross(closed.n, closed.t)), 16 * unit_roundoff, u, v);
      const double determinant = dot(cross(du, dv), closed.n);
      handedness.compare(determinant * closed.handedness > 0 ? 0 : 1, 0, u, v);
    }
    for (const Law* law : {&tangent, &bitangent, &normal, &handedness}) checks.push_back(law->result());
  } else {
    checks.push_back(
        skipped_check(X::info.name, "dual", "tangent", "the surface states no closed-form frame"));
  }
}

template <int order, class X>
void check_central(const X& surface, const Points& points, std::string_view route,
                   std::vector<Check>& checks) {
  // An estimate above this share of the scale would hide a wrong formula: such a point is not compared.
  constexpr double worst_estimate = 1e-6;
  for (int is = 1; is < 6; ++is) {
    Law law(X::info.name, route, partials[is].name);
    for (const auto& [u, v] : points.uv) {
      const Vec3<double> closed = jet(surface, u, v).*partials[is].member;
      for (const Derivative& derivative : derivatives) {
        if (derivative.is != is) continue;
        const auto of = partials[derivative.of].member;
        const auto along = [&, u = u, v = v](double x) {
          return derivative.along == 0 ? jet(surface, x, v).*of : jet(surface, u, x).*of;
        };
        const DerivativeEstimate numeric = central_difference<order>(along, derivative.along == 0 ? u : v);
        // Twice the estimate: it is an estimate, not a bound. The closed form's own error is 8u of its scale.
        const double bound = 2 * numeric.error / points.scale[is] + 8 * unit_roundoff;
        if (bound <= worst_estimate)
          law.compare(norm(numeric.value - closed) / points.scale[is], bound, u, v);
      }
    }
    checks.push_back(law.result("the route's own error estimate exceeds 1e-6 of the scale everywhere"));
  }
}

template <class X>
void check_facts(const X& surface, const Points& points, std::vector<Check>& checks) {
  if constexpr (StatesImplicit<X>) {
    Law law(X::info.name, "implicit", "position");
    for (const auto& [u, v] : points.uv) {
      // implicit() is a length: position and equation each err by a few roundings of the largest length.
      const double residual = std::fabs(surface.implicit(jet(surface, u, v).position));
      law.compare(residual / points.scale[0], 16 * unit_roundoff, u, v);
    }
    checks.push_back(law.result());
  } else {
    checks.push_back(
        skipped_check(X::info.name, "implicit", "position", "the surface states no implicit equation"));
  }
  if constexpr (StatesGaussianCurvature<X>) {
    Law law(X::info.name, "curvature", "gaussian_curvature");
    struct Pair {
      double stated, computed, condition;
    };
    std::vector<Pair> pairs;
    double scale = 0;
    for (const auto& [u, v] : points.uv) {
      const Jet2<double> j = jet(surface, u, v);
      const Curvature<double> c = curvature(j, frame(surface, u, v));
      const double stated = surface.gaussian_curvature(prepare<X::info.u>(u), prepare<X::info.v>(v));
      // Dividing by dpdu and dpdv twice amplifies their relative errors where they are small.
      const double condition = points.scale[1] / norm(j.dpdu) + points.scale[2] / norm(j.dpdv);
      pairs.push_back({stated, c.gaussian, condition});
      scale = std::fmax(scale, std::fabs(stated));
    }
    if (!std::isfinite(scale)) {
      checks.push_back(
          skipped_check(X::info.name, "curvature", "gaussian_curvature", "it overflows at this size"));
      return;
    }
    if (scale == 0) scale = 1 / (points.scale[0] * points.scale[0]);
    for (std::size_t i = 0; i < pairs.size(); ++i)
      law.compare(std::fabs(pairs[i].stated - pairs[i].computed) / scale,
                  64 * unit_roundoff * (1 + pairs[i].condition), points.uv[i].x, points.uv[i].y);
    checks.push_back(law.result());
  } else {
    checks.push_back(skipped_check(X::info.name, "curvature", "gaussian_curvature",
                                   "the surface states no Gaussian curvature"));
  }
}

// P(u + k, v) = P(u, v), bit for bit where u + k is exact.
template <class X>
void check_periodicity(const X& surface, const Points& points, std::vector<Check>& checks) {
  const bool periodic_u = X::info.u == Coordinate::turn, periodic_v = X::info.v == Coordinate::turn;
  if (!periodic_u && !periodic_v) {
    checks.push_back(
        skipped_check(X::info.name, "periodicity", "position", "neither coordinate is periodic"));
    return;
  }
  Law law(X::info.name, "periodicity", "position");
  for (const auto& [u0, v0] : points.uv) {
    const double u = std::ldexp(std::floor(std::ldexp(u0, 30)), -30),
                 v = std::ldexp(std::floor(std::ldexp(v0, 30)), -30);
    const Vec3<double> p = jet(surface, u, v).position;
    for (const double k : {1.0, -3.0, 0x1p20 - 1})
      law.compare(p == jet(surface, periodic_u ? u + k : u, periodic_v ? v - k : v).position ? 0 : 1, 0, u,
                  v);
  }
  checks.push_back(law.result());
}

}  // namespace detail

/// Runs every law on a surface. Deterministic for given options.
template <ParametricSurface X>
std::vector<Check> check_surface(const X& surface, const CheckOptions& options = {}) {
  checked(surface);
  const detail::Points points(surface, options);
  std::vector<Check> checks;
  for (const double scale : points.scale)
    if (!(scale < 1e300 && scale > 1e-290)) {
      checks.push_back(
          detail::skipped_check(X::info.name, "dual", "position",
                                "positions or partials leave the range of double at these parameters"));
      return checks;
    }
  detail::check_dual(surface, points, checks);
  detail::check_central<2>(surface, points, "central2", checks);
  detail::check_central<4>(surface, points, "central4", checks);
  detail::check_central<6>(surface, points, "central6", checks);
  detail::check_central<8>(surface, points, "central8", checks);
  detail::check_facts(surface, points, checks);
  detail::check_periodicity(surface, points, checks);
  return checks;
}

}  // namespace darboux
