/// \file expect_limit.h
/// The law of singular points: the frame there is the limit of those near, with the bits that say why, or
/// there is none.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/evaluate.h>

#include "compare_frames.h"

namespace darboux::test {

constexpr Status regular = Status::regular, dpdu_zero = Status::dpdu_zero, dpdv_zero = Status::dpdv_zero,
                 parallel = Status::parallel, limit_frame = Status::limit_frame, no_frame = Status::no_frame,
                 self_intersecting = Status::self_intersecting, crease = Status::crease,
                 overflow = Status::overflow;
constexpr Vec2<double> along_u{1, 0}, against_u{-1, 0}, along_v{0, 1}, against_v{0, -1};

using detail::without;

// The same bits from every way of asking. A frame made from partials finds `parallel` itself, and that its
// limit jumps; where a surface declares nothing, it finds every bit.
template <class X>
void expect_status(const X& surface, double u, double v, Status expected) {
  EXPECT_EQ(frame(surface, u, v).status, expected);
  EXPECT_EQ(parametric_frame(surface, u, v).status, expected);
  const Sample<double> all = sample(surface, u, v);
  const auto& [p, pu, pv, puu, puv, pvv] = all.jet;
  const bool representable =
      finite(p) && finite(pu) && finite(pv) && finite(puu) && finite(puv) && finite(pvv);
  EXPECT_EQ(all.frame.status, representable ? expected : expected | overflow);
  Status of_the_engine = limit_frame | no_frame;
  if (!HasClosedFrame<X>) of_the_engine |= has(expected, limit_frame) ? parallel | crease : parallel;
  EXPECT_EQ(status(surface, u, v), DeclaresSingularPoints<X> ? without(expected, of_the_engine) : regular);
}

struct Law {
  double rate = 1;  // |frame(near) - frame(at)| <= factor step^rate
  double factor = 20;
  Status near = regular;  // the bits of the points near
  int decades = 12;       // the nearest is 10^-decades away
};

template <class X>
void expect_limit(const X& surface, const Vec2<double>& point, const Vec2<double>& inward, Status expected,
                  const Law& law = {}) {
  const auto [u, v] = point;
  SCOPED_TRACE(::testing::Message() << X::info.name << " at u = " << u << ", v = " << v << " from "
                                    << inward.x << ", " << inward.y);
  expect_status(surface, u, v, expected);
  const Frame<double> at = frame(surface, u, v);
  ASSERT_TRUE(finite(at));
  EXPECT_NEAR(norm(at.t), 1, 8 * roundoff);
  EXPECT_NEAR(norm(at.n), 1, 8 * roundoff);
  EXPECT_NEAR(dot(at.t, at.n), 0, 8 * roundoff);
  EXPECT_LE(norm(cross(at.n, at.t) - at.b), 8 * roundoff);
  // b along dpdv, at its own rate; where dpdv vanishes or is infinite a closed frame may only know the side.
  const ParametricFrame<double> along = parametric_frame(surface, u, v),
                                beside = parametric_frame(surface, u + inward.x * 1e-9, v + inward.y * 1e-9);
  EXPECT_EQ(along.t, at.t);
  if (detail::limits_by_series<X> || !has(expected, dpdv_zero | overflow)) {
    EXPECT_LE(norm(along.b - beside.b), 2e-3);
  }
  for (int k = 1; k <= law.decades; ++k) {
    const double step = std::pow(10.0, -k);
    const Frame<double> near = frame(surface, u + inward.x * step, v + inward.y * step);
    // Next to where the partials are parallel, and there alone, they may know the frame to few digits.
    const Status permitted = has(expected, Status::parallel) ? Status::ill_conditioned : Status::regular;
    EXPECT_EQ(detail::without(near.status, permitted), law.near) << k;
    ASSERT_TRUE(finite(near)) << k;
    EXPECT_LE(distance(near, at), law.factor * (std::pow(step, law.rate) + 8 * roundoff)) << k;
    EXPECT_EQ(near.handedness, at.handedness) << k;
  }
}

// No frame, and rightly: about the point, within the square, frames differ by a finite angle however near
// they are, or (none_near) there are none, as of a surface that is a line.
template <class X>
void expect_no_limit(const X& surface, const Vec2<double>& point, Status expected, bool none_near = false) {
  const auto [u, v] = point;
  SCOPED_TRACE(::testing::Message() << X::info.name << " at u = " << u << ", v = " << v);
  expect_status(surface, u, v, expected | no_frame);
  const ParametricFrame<double> p = parametric_frame(surface, u, v);
  EXPECT_TRUE(all_nan(frame(surface, u, v)));
  EXPECT_TRUE(all_nan(sample(surface, u, v).frame));
  EXPECT_TRUE(all_nan(p.t) && all_nan(p.b) && all_nan(p.n));
  for (const double radius : {1e-3, 1e-6, 1e-9}) {
    std::vector<Frame<double>> near;
    for (int i = 0; i < 32; ++i) {
      const auto [s, c] = sincos_turns(i / 32.0);
      const double x = u + radius * c, y = v + radius * s;
      if (x < 0 || x > 1 || y < 0 || y > 1) continue;
      if (const Frame<double> f = frame(surface, x, y); finite(f)) near.push_back(f);
    }
    double spread = 0;
    for (const auto& a : near)
      for (const auto& b : near) spread = std::max(spread, distance(a, b));
    if (none_near)
      EXPECT_TRUE(near.empty()) << radius;
    else
      EXPECT_GT(spread, 0.2) << radius;
  }
}

}  // namespace darboux::test
