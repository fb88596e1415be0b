// Building blocks of the laws of testing.h: points, conditions, and the worst comparison.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/testing.h>

namespace darboux::laws {

constexpr double unit_roundoff = 0x1p-53;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The partials in the order of Jet2, with the names of eval's keys.
constexpr std::array<std::string_view, 6> names{"position", "dpdu", "dpdv", "d2pdu2", "d2pduv", "d2pdv2"};
template <class S>
const Vec3<S>& partial(const Jet2<S>& j, int k) {
  const std::array<const Vec3<S>*, 6> all{&j.position, &j.dpdu, &j.dpdv, &j.d2pdu2, &j.d2pduv, &j.d2pdv2};
  return *all[static_cast<std::size_t>(k)];
}

// Each first derivative that the routes check: partial `of` differentiated along `along` (0: u, 1: v) is
// `is`.
struct Derivative {
  int of, along, is;
};
constexpr std::array<Derivative, 6> derivatives{
    {{0, 0, 1}, {0, 1, 2}, {1, 0, 3}, {1, 1, 4}, {2, 0, 4}, {2, 1, 5}}};

template <class S>
Vec3<double> rounded(const Vec3<S>& a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}
template <class T>
Vec3<T> derivative(const Vec3<Dual<T, 2>>& a, std::size_t k) {
  return {a.x.derivative[k], a.y.derivative[k], a.z.derivative[k]};
}
template <class T>
Vec3<T> value(const Vec3<Dual<T, 2>>& a) {
  return {a.x.value, a.y.value, a.z.value};
}

// Keeps the point of one law at which error / bound is largest.
class Law {
 public:
  Law(std::string_view surface, std::string_view route, std::string_view quantity) {
    check_.surface = surface;
    check_.route = route;
    check_.quantity = quantity;
    check_.passed = true;
  }

  void compare(double error, double bound, double u, double v, const std::string& of = {}) {
    ++check_.points;
    // Written so that a NaN fails.
    const bool within = error <= bound;
    const double ratio = bound > 0 ? error / bound : (within ? 0 : infinity);
    if (check_.points == 1 || (!(ratio <= worst_ratio_) && !std::isnan(worst_ratio_))) {
      worst_ratio_ = ratio;
      check_.max_error = error;
      check_.bound = bound;
      check_.worst_u = u;
      check_.worst_v = v;
      check_.worst_surface = of;
    }
    check_.passed = check_.passed && within;
  }

  // \param nothing_compared the reason if no point could be compared; empty: that is a failure
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

// ---- conditions -------------------------------------------------------------------------------------------

// The inputs of a surface's formula in 40 digits: u, v and the parameters.
struct Inputs {
  Multiprecision u, v;
  std::vector<Multiprecision> parameters;

  Inputs(double u_, double v_, const std::vector<ParameterValue>& values) : u(u_), v(v_) {
    for (const ParameterValue& p : values) parameters.emplace_back(p.value);
  }
  Multiprecision& at(std::size_t k) { return k == 0 ? u : k == 1 ? v : parameters[k - 2]; }
  std::size_t size() const { return 2 + parameters.size(); }
};

inline Jet2<Multiprecision> multiprecision_jet(const AnySurface& surface, const Inputs& x) {
  return surface.jet(x.u, x.v, x.parameters);
}

inline bool is_number(const Jet2<Multiprecision>& j) {
  for (int k = 0; k < 6; ++k)
    if (const Vec3<double> x = rounded(partial(j, k)); std::isnan(x.x) || std::isnan(x.y) || std::isnan(x.z))
      return false;
  return true;
}

// Calls f(jet) for the jet with each input moved by a relative 1e-20 in turn, inward if outward is not
// permitted. The change, times 1e20, is the sum over the inputs of |x ∂/∂x|: the condition, which no
// formula in these inputs can undercut.
constexpr double relative_change = 1e-20;
template <class F>
void for_each_neighbour(const AnySurface& surface, Inputs x, F f) {
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Multiprecision kept = x.at(k);
    if (kept == Multiprecision(0.0)) continue;
    for (const double change : {relative_change, -relative_change}) {
      x.at(k) = kept + kept * Multiprecision(change);
      const Jet2<Multiprecision> moved = multiprecision_jet(surface, x);
      if (!is_number(moved)) continue;
      f(moved);
      break;
    }
    x.at(k) = kept;
  }
}

// ---- points -----------------------------------------------------------------------------------------------

struct Point {
  double u, v;
  Jet2<double> j;
  Frame<double> f;
  std::array<double, 6> condition{};  // of each partial, relative to its scale
};

struct Points {
  std::string_view name;
  std::vector<Point> list;
  std::array<double, 6> scale{};   // largest magnitude of each partial over the points
  std::array<double, 2> third{};   // the same of d3pdu3, d3pdv3
  std::array<bool, 6> vanishes{};  // everywhere: then its scale is that of the position
  bool representable = true;
  std::optional<Vec2<double>> not_a_number;  // where a partial is NaN

  Points(const AnySurface& surface, const CheckOptions& options);
};

// A partial that is small relative to its scale has lost that share of its digits, and nearly parallel
// partials leave fewer digits of the normal: the factor by which the error of frames made of these partials
// exceeds the rounding of the partials.
double frame_condition(const Points& points, const Point& p, const Vec3<double>& dpdu,
                       const Vec3<double>& dpdv);

// An estimate above this share of the scale would hide a wrong formula: such a point is not compared.
constexpr double worst_estimate = 1e-6;

// ---- routes -----------------------------------------------------------------------------------------------

using Checks = std::vector<Check>;
void check_dual(const AnySurface& surface, const Points& points, Checks& checks);
template <int order>  // 2, 4, 6 or 8
void check_central(const AnySurface& surface, const Points& points, Checks& checks);
void check_one_sided(const AnySurface& surface, const Points& points, Checks& checks);
void check_ridders(const AnySurface& surface, const Points& points, Checks& checks);
void check_continuity(const AnySurface& surface, const Points& points, Checks& checks);
void check_implicit(const AnySurface& surface, const Points& points, Checks& checks);
void check_second_formula(const AnySurface& surface, const Points& points, Checks& checks);
void check_curvature(const AnySurface& surface, const Points& points, Checks& checks);
void check_gauss(const AnySurface& surface, const Points& points, Checks& checks);
void check_codazzi(const AnySurface& surface, const Points& points, Checks& checks);
void check_gauss_bonnet(const AnySurface& surface, const Points& points, Checks& checks);
void check_periodicity(const AnySurface& surface, const Points& points, Checks& checks);
template <class S>  // double or float
void check_high_precision(const AnySurface& surface, const CheckOptions& options, Checks& checks);
void check_high_precision_forms(const AnySurface& surface, const CheckOptions& options, Checks& checks);

}  // namespace darboux::laws
