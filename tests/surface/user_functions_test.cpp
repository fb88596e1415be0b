// Curves and graphs of functions by users: their derivatives, and functions that fail.
#include <cmath>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include <darboux/evaluate.h>
#include <darboux/extrusion.h>
#include <darboux/framed_curve.h>
#include <darboux/graph.h>
#include <darboux/ruled_surface.h>
#include <darboux/surface_of_revolution.h>
#include <darboux/tube.h>

#include "compare_frames.h"
#include "every_surface.h"

namespace darboux::test::user_functions_test {
namespace {

using Vec = Vec3<double>;

constexpr auto helix_position = []<class S>(const S& t) {
  const Turn<S> a = sincos_turns(S(lift<S>(2.0) * t));
  return Vec3<S>{lift<S>(1.5) * a.cos, lift<S>(1.5) * a.sin,
                 lift<S>(0.25) * (two_pi<S>() * (lift<S>(2.0) * t))};
};
constexpr auto circle_position = []<class S>(const Turn<S>& t) {
  return Vec3<S>{lift<S>(3.0) * t.cos, lift<S>(3.0) * t.sin, lift<S>(0.0)};
};

void expect_jet(const CurveJet<double>& a, const CurveJet<double>& b) {
  for (const auto& [x, y] :
       {std::pair{a.position, b.position}, {a.first, b.first}, {a.second, b.second}, {a.third, b.third}})
    EXPECT_LE(norm(x - y), 32 * roundoff * (1 + norm(y)));
}

TEST(PositionOnly, CurvesHaveTheDerivativesOfTheirClosedForm) {
  const PositionCurve helix{helix_position};
  const PositionCurve<decltype(circle_position), Coordinate::turn> circle;
  for (int i = 0; i <= 64; ++i) {
    const double t = i / 64.0;
    expect_jet(helix.jet(t), HelixCurve{1.5, 0.25, 2.0}.jet(t));
    expect_jet(circle.jet(sincos_turns(t)), CircleCurve{3.0}.jet(sincos_turns(t)));
  }
  const Tube by_hand{UprightCurve{HelixCurve{1.5, 0.25, 2.0}}, 0.1};
  const Tube by_position{UprightCurve{helix}, 0.1};
  for (int i = 0; i <= 16; ++i)
    EXPECT_LE(distance(frame(by_hand, i / 16.0, 0.3), frame(by_position, i / 16.0, 0.3)), 1e-14);
}

// Numbers of the machine stand beside any scalar, nested dual numbers too: on either side, in comparisons,
// and int as well as float. They are the same bits as lift<S>() of them.
TEST(PositionOnly, NumbersNeedNoLift) {
  const auto plain = []<class S>(const S& t) {
    using std::exp;
    return Vec3<S>{2 * t - 1, 0.5 * exp(-t) / 3.0F, t < 0.25 ? 1 - t * t : 1 / (t + 1)};
  };
  const auto lifted = []<class S>(const S& t) {
    using std::exp;
    const S one = lift<S>(1.0);
    return Vec3<S>{lift<S>(2.0) * t - one, lift<S>(0.5) * exp(-t) / lift<S>(3.0),
                   t < lift<S>(0.25) ? one - t * t : one / (t + one)};
  };
  const PositionCurve a{plain};
  const PositionCurve b{lifted};
  for (const double t : {0.0, 0.125, 0.25, 0.7}) {
    const CurveJet<double> x = a.jet(t), y = b.jet(t);
    for (const auto& [p, q] :
         {std::pair{x.position, y.position}, {x.first, y.first}, {x.second, y.second}, {x.third, y.third}}) {
      EXPECT_EQ(p.x, q.x);
      EXPECT_EQ(p.y, q.y);
      EXPECT_EQ(p.z, q.z);
    }
  }
}

// They do not go by way of double.
TEST(PositionOnly, NumbersAreAsExactAsTheScalar) {
  constexpr std::int64_t odd = (std::int64_t{1} << 53) + 1;  // no double
  using Wide = Dual<long double, 1>;
  EXPECT_EQ(Wide(odd).value, static_cast<long double>(odd));
  EXPECT_EQ((Dual<Wide, 1>(odd).value.value), static_cast<long double>(odd));
  EXPECT_EQ((Dual<Wide, 1>(0.1L).value.value), 0.1L);
}

// Of curves without another formula the second formula of the surface takes the first; and lines that cross
// each other half way make dpdu vanish there.
TEST(PositionOnly, RuledSurfaceOfSuchCurves) {
  const auto parabola = []<class S>(const S& t) { return Vec3<S>{t, t * t, lift<S>(0.5)}; };
  const auto arc = []<class S>(const S& t) { return Vec3<S>{lift<S>(2.0) + t * t, lift<S>(1.0) - t, t}; };
  const RuledSurface surface{PositionCurve{parabola}, PositionCurve{arc}};
  for (int i = 0; i <= 8; ++i)
    for (int k = 0; k <= 8; ++k) {
      const double u = i / 8.0, v = k / 8.0;
      EXPECT_LE(norm(surface.second_formula(u, v) - jet(surface, u, v).position), 16 * roundoff);
    }
  const RuledSurface crossing{LineSegment{Vec{0, 0, 0}, Vec{1, 0, 0}},
                              LineSegment{Vec{1, 1, 0}, Vec{0, 1, 0}}};
  EXPECT_EQ(status(crossing, 0.25, 0.5), Status::dpdu_zero);
  EXPECT_EQ(status(crossing, 0.25, 0.25), Status::regular);
}

TEST(PositionOnly, GraphHasTheDerivativesOfItsClosedForm) {
  const RoundHill<double> hill{0.75, 0.4};
  const Graph closed{hill, -1.0, 2.0, -1.5, 1.0};
  const Graph only{[hill](const auto& x, const auto& y) { return hill(x, y); }, -1.0, 2.0, -1.5, 1.0};
  for (int i = 0; i <= 16; ++i)
    for (int k = 0; k <= 16; ++k) {
      const double u = i / 16.0, v = k / 16.0;
      const Jet2<double> a = jet(closed, u, v), b = jet(only, u, v);
      for (const auto& [x, y] : {std::pair{a.position, b.position},
                                 {a.dpdu, b.dpdu},
                                 {a.dpdv, b.dpdv},
                                 {a.d2pdu2, b.d2pdu2},
                                 {a.d2pduv, b.d2pduv},
                                 {a.d2pdv2, b.d2pdv2}})
        EXPECT_LE(norm(x - y), 64 * roundoff * (1 + norm(y))) << u << " " << v;
      EXPECT_LE(distance(frame(closed, u, v), frame(only, u, v)), 64 * roundoff) << u << " " << v;
      EXPECT_EQ(frame(only, u, v).status, Status::regular);
      EXPECT_NEAR(only.implicit(b.position), 0, 8 * roundoff);
      EXPECT_NEAR(closed.gaussian_curvature(u, v), only.gaussian_curvature(u, v), 1e-12);
      EXPECT_NEAR(closed.mean_curvature(u, v), only.mean_curvature(u, v), 1e-12);
    }
  const Graph saddle{[](const auto& x, const auto& y) { return x * x - y * y; }, -1.0, 1.0, -1.0, 1.0};
  EXPECT_EQ(jet(saddle, 0.75, 0.5).dpdu, (Vec{2, 0, 2}));
  EXPECT_EQ(saddle.gaussian_curvature(0.5, 0.5), -4);
}

// Not a number beyond t = 1/2, its slope infinite there.
constexpr auto root = []<class S>(const S& t) {
  using std::sqrt;
  return S(sqrt(S(lift<S>(0.5) - t)));
};
constexpr auto ending = []<class S>(const S& t) { return Vec3<S>{t, root(t), lift<S>(0.0)}; };
constexpr auto ending_profile = []<class S>(const S& t) {
  return Vec3<S>{lift<S>(1.0) + t, lift<S>(0.0), root(t)};
};

struct EndingSurface {
  static constexpr SurfaceInfo info{"ending", "not a number beyond u = 1/2", Coordinate::linear,
                                    Coordinate::linear};
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0), f = root(u);
    return {{u, v, f}, {one, zero, -(lift<S>(0.5) / f)}, {zero, one, zero}, {}, {}, {}};
  }
};

template <class X>
void expect_flagged(const X& surface, double u, double v) {
  SCOPED_TRACE(::testing::Message() << X::info.name << " at " << u << ", " << v);
  const Frame<double> f = frame(surface, u, v);
  EXPECT_EQ(f.status, Status::no_frame | Status::overflow);
  EXPECT_TRUE(all_nan(f));
  const Sample<double> s = sample(surface, u, v);
  EXPECT_EQ(s.frame.status, f.status);
  EXPECT_TRUE(all_nan(s.frame));
  const ParametricFrame<double> p = parametric_frame(surface, u, v);
  EXPECT_EQ(p.status, f.status);
  EXPECT_TRUE(all_nan(p.t) && all_nan(p.b) && all_nan(p.n));
}

TEST(UserFunctions, ThatReturnNaNAreFlagged) {
  const PositionCurve curve{ending};
  const Graph graph{[](const auto& x, const auto&) { return root(x); }, 0.0, 1.0, 0.0, 1.0};
  for (const double t : {0.5, 0.75, 1.0}) {
    expect_flagged(EndingSurface{}, t, 0.3);
    expect_flagged(graph, t, 0.3);
    expect_flagged(RuledSurface{curve, LineSegment{Vec{0, 0, 1}, Vec{1, 0, 1}}}, t, 0.3);
    expect_flagged(Extrusion{curve, Vec{0, 0, 1}}, t, 0.3);
    expect_flagged(SurfaceOfRevolution{PositionCurve{ending_profile}}, 0.3, t);
    expect_flagged(Tube{PlanarCurve{curve}, 0.1}, t, 0.3);
    expect_flagged(Tube{UprightCurve{curve}, 0.1}, t, 0.3);
  }
  EXPECT_EQ(frame(Extrusion{curve, Vec{0, 0, 1}}, 0.25, 0.3).status, Status::regular);
  EXPECT_EQ(frame(graph, 0.25, 0.3).status, Status::regular);
  EXPECT_EQ(frame(EndingSurface{}, 0.25, 0.3).status, Status::regular);
}

struct Refused {
  int code;
};
constexpr auto refusing = []<class S>(const S& t) {
  if (!(t < lift<S>(0.5))) throw Refused{42};
  return Vec3<S>{t, t * t, lift<S>(0.0)};
};
template <class F>
void expect_refused(F&& f) {
  try {
    f();
    ADD_FAILURE() << "nothing thrown";
  } catch (const Refused& refused) {
    EXPECT_EQ(refused.code, 42);
  }
}
TEST(UserFunctions, ThatThrowAreNotCaught) {
  const auto everywhere = [](const auto& surface) {
    expect_refused([&] { frame(surface, 0.75, 0.3); });
    expect_refused([&] { sample(surface, 0.75, 0.3); });
    expect_refused([&] { jet(surface, 0.75, 0.3); });
    expect_refused([&] { parametric_frame(surface, 0.75, 0.3); });
    EXPECT_NO_THROW(sample(surface, 0.25, 0.3));
  };
  const PositionCurve curve{refusing};
  everywhere(Extrusion{curve, Vec{0, 0, 1}});
  everywhere(RuledSurface{curve, LineSegment{Vec{0, 0, 1}, Vec{1, 0, 1}}});
  everywhere(Tube{PlanarCurve{curve}, 0.1});
  everywhere(Graph{[]<class S>(const S& x, const S&) { return S(refusing(x).y); }, 0.0, 1.0, 0.0, 1.0});
}

}  // namespace
}  // namespace darboux::test::user_functions_test
