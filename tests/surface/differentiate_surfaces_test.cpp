// Derivatives of the catalogue's surfaces: how honest the estimates are, and how accurate the default steps.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iomanip>
#include <iostream>
#include <string_view>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/differentiate.h>
#include <darboux/evaluate.h>

#include "estimate_quality.h"
#include "every_surface.h"
#include "random.h"

namespace darboux::test::differentiate_surfaces_test {
namespace {

template <class T>
class CentralOnSurfaces : public ::testing::Test {};
TYPED_TEST_SUITE(CentralOnSurfaces, EvenOrders, OrderNames);

double distance(const Vec3<double>& a, const Vec3<Wide>& b) {
  return static_cast<double>(norm(Vec3<Wide>{a.x - b.x, a.y - b.y, a.z - b.z}));
}

// How far from x the position varies as over a length: to its own period, or to the nearest place where it is
// not smooth.
template <class X>
double length_at(const X& surface, int along, double x) {
  double length = 1;
  if (X::info.name == "graph") length = 0.4;                                            // a steep hill
  if (X::info.name == "klein-bottle" || X::info.name == "moebius-strip") length = 0.5;  // higher harmonics
  if (X::info.name == "pseudosphere") length = 0.11;  // its tips are not far beyond the ends
  if (X::info.name == "bezier-patch" || X::info.name == "bspline-patch")
    length = 0.4;  // poles of rational functions
  if constexpr (requires { surface.breaks(along); })
    for (const double b : surface.breaks(along))
      for (const double place : {b - 1, b, b + 1})
        if (b == 0 || place == b) length = std::fmin(length, 1.5 * std::fabs(x - place));
  return length;
}

// A surface of the catalogue behind one type: methods are compiled once, not once per surface.
struct Case {
  template <class S>
  using Position = std::function<Vec3<S>(const S& u, const S& v)>;
  std::string_view name;
  std::function<double(int along, double x)> length;
  std::tuple<Position<double>, Position<Wide>, Position<Dual<double, 1>>, Position<Dual<Wide, 1>>> position;
  std::function<Jet2<Wide>(double u, double v)> truth;
};
const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> list;
    Catalogue::for_each([&](const auto& surface) {
      const auto position = [surface]<class S>(const S& u, const S& v) {
        return jet(surface, u, v).position;
      };
      list.push_back({std::remove_cvref_t<decltype(surface)>::info.name,
                      [surface](int along, double x) { return length_at(surface, along, x); },
                      {position, position, position, position},
                      [surface](double u, double v) { return jet(surface, Wide(u), Wide(v)); }});
    });
    return list;
  }();
  return all;
}

// The position as a function of u or v alone, in the numbers of a Case.
class Line {
 public:
  Line(const Case& surface, double u, double v, int along) : surface_(surface), u_(u), v_(v), along_(along) {}
  Vec3<double> operator()(double x) const { return at(x); }
  Vec3<Wide> operator()(Wide x) const { return at(x); }
  Vec3<Dual<double, 1>> operator()(const Dual<double, 1>& x) const { return at(x); }
  Vec3<Dual<Wide, 1>> operator()(const Dual<Wide, 1>& x) const { return at(x); }
  Vec3<Wide> truth() const {
    const Jet2<Wide> j = surface_.truth(u_, v_);
    return along_ == 0 ? j.dpdu : j.dpdv;
  }

 private:
  template <class S>
  Vec3<S> at(const S& x) const {
    const auto& position = std::get<Case::Position<S>>(surface_.position);
    return along_ == 0 ? position(x, S(v_)) : position(S(u_), x);
  }
  const Case& surface_;
  double u_, v_;
  int along_;
};

// Whether a coordinate line is a straight line or a parabola or a cubic: its fourth differences vanish.
bool is_polynomial(const Line& line) {
  Vec3<Wide> difference{};
  for (int k = 0; k <= 4; ++k)
    difference = difference + std::array<Wide, 5>{1, -4, 6, -4, 1}[static_cast<std::size_t>(k)] *
                                  line(Wide(0.3) + Wide(k) / 20);
  return norm(difference) < 1e-15;
}

auto in_double(const Line& line) {
  return [&line](double x) { return line(x); };
}

// `method(f, x, behaviour)` at many_points random points of the whole catalogue, or a part of them
// (thinning.h): those of which the stencil, up to `reach` lengths long, stays in the domain.
struct OnCatalogue {
  Quality all, curved;
};
using Method = std::function<DerivativeEstimate<>(const Line&, double x, const Behaviour&)>;
OnCatalogue on_catalogue(std::uint64_t seed, double reach, const Method& method) {
  Random random(seed);
  OnCatalogue result;
  for (const Case& surface : cases()) {
    const std::array polynomial{is_polynomial({surface, 0.3, 0.4, 0}), is_polynomial({surface, 0.3, 0.4, 1})};
    const int points = many_points / static_cast<int>(cases().size()) / thinning(3);
    for (int i = 0; i < points; ++i) {
      const int along = i % 2;
      const double u = random.uniform(reach, 1 - reach), v = random.uniform(reach, 1 - reach),
                   x = along == 0 ? u : v;
      const Line line{surface, u, v, along};
      const Behaviour b = behaviour(in_double(line), x, surface.length(along, x), Interval{0, 1});
      const Vec3<Wide> truth = line.truth();
      const auto d = method(line, x, b);
      const double error = distance(d.value, truth), size = static_cast<double>(norm(truth));
      if (!(d.error >= error / 2))
        std::cout << "below half: " << surface.name << " at u = " << u << ", v = " << v << " along " << along
                  << std::scientific << ", error " << error << ", estimate " << d.error << '\n';
      result.all.add(error, d.error, size);
      if (!polynomial[static_cast<std::size_t>(along)]) result.curved.add(error, d.error, size);
    }
  }
  result.all.print("catalogue");
  result.curved.print("curved lines");
  return result;
}

// The 99th percentile is that of curved lines: along a straight line or a parabola values are often exact, so
// that the error is zero, whatever the estimate.
void expect_honest(OnCatalogue q) {
  EXPECT_LE(q.all.below_half_per_million(), 10);
  EXPECT_LE(q.all.percentile(50), 10);
  EXPECT_LE(q.curved.percentile(99), 100);
}

TYPED_TEST(CentralOnSurfaces, IsEstimatedHonestlyOnSurfaces) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  expect_honest(on_catalogue(8, 0, [](const Line& line, double x, const Behaviour& b) {
    return central_difference<order>(in_double(line), x, b);
  }));
}
TEST(OneSidedOrder8, IsEstimatedHonestlyOnSurfaces) {
  expect_honest(on_catalogue(9, 0, [](const Line& line, double x, const Behaviour& b) {
    return one_sided_difference<8>(in_double(line), x, b, x < 0.5 ? 1 : -1);
  }));
}
TEST(DualNumbers, AreEstimatedHonestlyOnSurfaces) {
  expect_honest(on_catalogue(10, 0, [](const Line& line, double x, const Behaviour& b) {
    return dual_derivative(line, x, b.length);
  }));
}
TEST(Ridders, IsEstimatedHonestlyOnSurfaces) {
  OnCatalogue q = on_catalogue(11, 0.125, [](const Line& line, double x, const Behaviour& b) {
    return ridders(in_double(line), x, b);
  });
  EXPECT_LE(q.all.below_half_per_million(), 10);
  EXPECT_LE(q.all.percentile(50), 20);
  EXPECT_LE(q.curved.percentile(99), 200);
}

// Order 8 at its default step for the length, relative to 2π size / length: 1e-13 in the interior, one-sided
// 1e-12. Left out is what lies within a fifteenth of a place that is not smooth.
TEST(Order8, ReachesItsAccuracyOnTheWholeCatalogue) {
  Random random(12);
  for (const Case& surface : cases()) {
    double central = 0, one_sided = 0;
    for (int i = 0; i < 20'000; ++i) {
      const int along = i % 2;
      const double u = random.uniform(), v = random.uniform(), x = along == 0 ? u : v,
                   length = surface.length(along, x);
      if (length < 0.1) continue;
      const Line line{surface, u, v, along};
      const Jet2<Wide> j = surface.truth(u, v);
      const Vec3<Wide>& truth = along == 0 ? j.dpdu : j.dpdv;
      const double size =
          std::fmax(tau / length * static_cast<double>(norm(j.position)), static_cast<double>(norm(truth)));
      const double step = one_sided_step<8>(length);
      const DerivativeEstimate c = central_difference<8>(in_double(line), x, central_step<8>(length)),
                               o = one_sided_difference<8>(in_double(line), x, x < 0.5 ? step : -step);
      central = std::fmax(central, distance(c.value, truth) / size);
      one_sided = std::fmax(one_sided, distance(o.value, truth) / size);
    }
    std::cout << std::setw(24) << surface.name << std::scientific << std::setprecision(1) << "  central "
              << central << ", one-sided " << one_sided << '\n';
    EXPECT_LE(central, 1e-13) << surface.name;
    EXPECT_LE(one_sided, 1e-12) << surface.name;
  }
}

// What headers and docs state of the default steps, of 2π|f| and 4π²|f|: the maximum over 20 000 points of
// sphere and torus, v in [0.05, 0.95]. Twice for other points than those measured.
template <class Method>
double worst_on_round_surfaces(Method method, bool second = false) {
  Random random(9);
  double worst = 0;
  const auto on = [&](const auto& surface) {
    for (int i = 0; i < 10'000; ++i) {
      const double u = random.uniform(), v = random.uniform(0.05, 0.95);
      const Jet2<Wide> j = jet(surface, Wide(u), Wide(v));
      const double scale = (second ? tau * tau : tau) * static_cast<double>(norm(j.position));
      const DerivativeEstimate du = method([&](double x) { return jet(surface, x, v).position; }, u);
      const DerivativeEstimate dv = method([&](double x) { return jet(surface, u, x).position; }, v);
      worst = std::max({worst, distance(du.value, second ? j.d2pdu2 : j.dpdu) / scale,
                        distance(dv.value, second ? j.d2pdv2 : j.dpdv) / scale});
    }
  };
  on(Sphere{1.0});
  on(Torus{1.0, 0.25});
  std::cout << std::scientific << std::setprecision(1) << "worst relative error " << worst << '\n';
  return worst;
}
TYPED_TEST(CentralOnSurfaces, ReachesItsAccuracy) {
  [[maybe_unused]] constexpr int order = TypeParam::value;
  constexpr double first = order == 2 ? 4e-11 : order == 4 ? 4e-13 : order == 6 ? 5e-14 : 2e-14;
  constexpr double second = order == 2 ? 1e-8 : order == 4 ? 4e-11 : order == 6 ? 2e-12 : 5e-13;
  EXPECT_LE(worst_on_round_surfaces([](const auto& f, double x) { return central_difference<order>(f, x); }),
            2 * first);
  EXPECT_LE(
      worst_on_round_surfaces([](const auto& f, double x) { return second_difference<order>(f, x); }, true),
      2 * second);
}
// The requirement: 1e-13 in the interior, 1e-12 at edges.
TEST(Accuracy, OfOrderEight) {
  EXPECT_LE(worst_on_round_surfaces([](const auto& f, double x) { return central_difference<8>(f, x); }),
            1e-13);
  for (const int side : {1, -1})
    EXPECT_LE(worst_on_round_surfaces([&](const auto& f, double x) {
                return one_sided_difference<8>(f, x, side * one_sided_step<8>());
              }),
              1e-12);
}

// A length that follows the function keeps the accuracy: a helix of 10^6 turns, its argument rounded by u
// 10^6 turns.
TEST(Accuracy, StepsFollowTheLength) {
  const double turns = 1e6;
  const auto helix = [&](double x) {
    const Turn<double> angle = sincos_turns(turns * x);
    return Vec3<double>{angle.cos, angle.sin, x};
  };
  Random random(10);
  for (int i = 0; i < 1000; ++i) {
    // On a grid on which turns · x and the steps are exact: only f's own rounding is left.
    const double x = std::ldexp(std::floor(std::ldexp(random.uniform(), 20)), -20);
    const Turn<Wide> angle = sincos_turns(Wide(turns) * x);
    const Vec3<Wide> truth{-wide_tau * turns * angle.sin, wide_tau * turns * angle.cos, 1};
    const DerivativeEstimate d = central_difference<8>(helix, x, central_step<8>(1 / turns));
    // The nodes' phases err by u 10^6 / 2 turns, 2π that in radians, times A / (2π steps) = 1.2 / 0.04.
    EXPECT_LE(distance(d.value, truth), 40 * tau * turns * roundoff * tau * turns);
    EXPECT_LE(distance(d.value, truth), 2 * d.error);
    // With the step of a slow function the derivative is lost.
    EXPECT_GT(distance(central_difference<8>(helix, x).value, truth), 0.5 * tau * turns);
  }
}

}  // namespace
}  // namespace darboux::test::differentiate_surfaces_test
