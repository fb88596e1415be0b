// The forms of the whole catalogue in 40 digits, and how far those in double may be from them.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/differentiate.h>
#include <darboux/forms.h>

#include "every_surface.h"
#include "random.h"
#include "roundoff.h"

namespace darboux::test {

// The forms take any scalar. In 40 digits an identity holds to 1e-20 of its terms or it is wrong: rounding
// and truncation of the differences are below that at every point whose conditions are below 1e10.
using M = Multiprecision;
inline constexpr double identity = 1e-20;

inline double size(const Vec3<M>& a) {
  return norm(Vec3<double>{static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)});
}
inline double size(const M& a) {
  return std::fabs(static_cast<double>(a));
}

inline Frame<M> frame_of(const Jet2<M>& j) {
  const Vec3<M> t = unit(j.dpdu), n = unit(cross(j.dpdu, j.dpdv));
  return {t, cross(n, t), n};
}

// f'(x) and f''(x) by central differences of order 8, steps of 1e-6: truncated at (2π 1e-6)^8, rounded at
// 1e-33 and 1e-27.
inline constexpr double step = 1e-6;
template <class F>
auto first_derivative(F f, const M& x) {
  const M h(step);
  const auto pair = [&](double k) { return f(x + M(k) * h) - f(x - M(k) * h); };
  return (M(4.0) / M(5.0) * pair(1) - M(1.0) / M(5.0) * pair(2) + M(4.0) / M(105.0) * pair(3) -
          M(1.0) / M(280.0) * pair(4)) /
         h;
}
template <class F>
auto second_derivative(F f, const M& x) {
  const M h(step);
  const auto pair = [&](double k) { return f(x + M(k) * h) + f(x - M(k) * h); };
  return (M(8.0) / M(5.0) * pair(1) - M(1.0) / M(5.0) * pair(2) + M(8.0) / M(315.0) * pair(3) -
          M(1.0) / M(560.0) * pair(4) - M(205.0) / M(72.0) * f(x)) /
         (h * h);
}

// The sizes of the terms in the shape operator's entries, from the lengths of the partials.
struct TermSizes {
  double a, m, c;
  explicit TermSizes(const Jet2<double>& j, const Frame<double>& f) {
    const double e = std::fabs(dot(j.dpdu, f.t)), g = std::fabs(dot(j.dpdv, f.b)), along = norm(j.dpdv);
    a = norm(j.d2pdu2) / e / e;
    m = (norm(j.d2pduv) / e + along * a) / g;
    c = (norm(j.d2pdv2) + 2 * along * m + along * along / g * a) / g;
  }
  double largest() const { return std::fmax(a, std::fmax(m, c)); }
};

// The largest relative error of what the forms are given in double: the partials (those that vanish
// identically are exact) and the frame.
inline double input_error(const Jet2<double>& j, const Frame<double>& f, const Jet2<M>& exact) {
  const auto wide = [](const Vec3<double>& a) { return Vec3<M>{a.x, a.y, a.z}; };
  double worst = 0;
  for (const auto& [is, should] : {std::pair{j.dpdu, exact.dpdu},
                                   {j.dpdv, exact.dpdv},
                                   {j.d2pdu2, exact.d2pdu2},
                                   {j.d2pduv, exact.d2pduv},
                                   {j.d2pdv2, exact.d2pdv2}})
    if (size(should) > 0) worst = std::fmax(worst, size(wide(is) - should) / size(should));
  const Frame<M> e = frame_of(exact);
  return std::fmax(worst, size(wide(f.t) - e.t) + size(wide(f.n) - e.n));
}

class Forms : public ::testing::TestWithParam<AnySurface> {
 protected:
  const AnySurface& surface() const { return GetParam(); }
  Jet2<M> jet(const M& u, const M& v) const { return surface().jet(u, v); }
  // Points within the chart: what singular points do is tested by themselves.
  template <class F>
  void for_points(std::uint64_t seed, int n, F f) const {
    Random random(seed);
    for (int i = 0; i < n; ++i) {
      const double u = random.uniform(0.02, 0.98), v = random.uniform(0.05, 0.95);
      f(u, v, random);
      if (HasFailure()) {
        ADD_FAILURE() << surface().info().name << " at u = " << u << ", v = " << v;
        return;
      }
    }
  }
};
inline std::string test_name(const ::testing::TestParamInfo<AnySurface>& info) {
  std::string name(info.param.info().name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace darboux::test
