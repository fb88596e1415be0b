/// \file spline_patch.h
/// Common code of Bézier and B-spline patches: the window of a control net at (u, v), its columns, and the
/// jet of the tensor product, rational or not.
#pragma once

#include <array>
#include <type_traits>
#include <utility>
#include <vector>

#include <darboux/spline.h>

namespace darboux::detail {

// f(degree_u, degree_v)
// Not for second derivatives: they are rarely requested, and each pair of degrees is slow to compile.
template <int order, class S, class F>
auto with_degrees(int p, int q, const F& f) {
  if constexpr (Binary<S> && order < 2) {
    constexpr Known<2> two;
    constexpr Known<3> three;
    if (p == 3 && q == 3) return f(three, three);
    if (p == 3 && q == 2) return f(three, two);
    if (p == 2 && q == 2) return f(two, two);
  }
  return f(p, q);
}

// The columns of a window of a net at a given v, with their derivatives up to `order`: f, f_v, f_vv. Each is
// relative to one of its own control points, the upper or lower one of the window: its anchor.
template <int order, class S, class Point, class Degree>
struct Columns {
  ControlWindow<Vec3<S>, Degree> anchor;
  std::array<ControlWindow<Point, Degree>, order + 1> f;
};

template <class S>
void shift(Vec3<S>& f, const Vec3<S>& by, bool is_value) {
  if (is_value) f = f + by;
}
template <class S>
void shift(Homogeneous<S>& f, const Vec3<S>& by, bool) {
  f.a = f.a + f.w * by;
}
// Makes the columns relative to one control point, which is returned: the corner of the window nearest to (u,
// v).
template <int order, class S, class Point, class Degree, class UpperU>
Vec3<S> share_anchor(Columns<order, S, Point, Degree>& columns, Degree p, const UpperU& upper_u) {
  const Vec3<S> shared = choose(upper_u, columns.anchor[p], columns.anchor[0]);
  for (int i = 0; i <= p; ++i) {
    const Vec3<S> by = columns.anchor[i] - shared;
    for (int k = 0; k <= order; ++k) shift(columns.f[k][i], by, k == 0);
  }
  return shared;
}

// The partials (f, f_u, f_v, f_uu, f_uv, f_vv) of a tensor product to an order, zero beyond it, from its
// columns.
template <int order, class Point, class Degree, class Weights>
std::array<Point, 6> tensor_partials(std::array<ControlWindow<Point, Degree>, order + 1>& f, Degree p,
                                     const Weights& u) {
  if constexpr (order >= 2) {
    const auto along_u = spline_derivatives<3, Point>(f[0], p, u);
    const auto f_v = spline_derivatives<2, Point>(f[1], p, u);
    return {along_u[0], along_u[1], f_v[0], along_u[2], f_v[1], de_boor<Point>(f[2], p, Known<0>{}, u)};
  } else if constexpr (order == 1) {
    const auto along_u = spline_derivatives<2, Point>(f[0], p, u);
    return {along_u[0], along_u[1], de_boor<Point>(f[1], p, Known<0>{}, u), Point{}, Point{}, Point{}};
  } else {
    return {de_boor<Point>(f[0], p, Known<0>{}, u), Point{}, Point{}, Point{}, Point{}, Point{}};
  }
}

// The surface jet up to `order` from partials of the net relative to `anchor`; higher partials are zero.
template <int order, class S>
Jet2<S> jet_of(const Vec3<S>& anchor, const std::array<Vec3<S>, 6>& f) {
  return {anchor + f[0], f[1], f[2], f[3], f[4], f[5]};
}
template <int order, class S>
Jet2<S> jet_of(const Vec3<S>& anchor, const std::array<Homogeneous<S>, 6>& f) {
  const auto& [h, hu, hv, huu, huv, hvv] = f;
  const S two = lift<S>(2.0);
  const Vec3<S> p = h.a / h.w;
  Jet2<S> j{};
  j.position = anchor + p;
  if constexpr (order >= 1) {
    j.dpdu = (hu.a - hu.w * p) / h.w;
    j.dpdv = (hv.a - hv.w * p) / h.w;
  }
  if constexpr (order >= 2) {
    j.d2pdu2 = (huu.a - (two * hu.w) * j.dpdu - huu.w * p) / h.w;
    j.d2pduv = (huv.a - hu.w * j.dpdv - hv.w * j.dpdu - huv.w * p) / h.w;
    j.d2pdv2 = (hvv.a - (two * hv.w) * j.dpdv - hvv.w * p) / h.w;
  }
  return j;
}

// The ratio of weights above which partials may have errors of more than a few roundings.
inline constexpr double weights_far_apart = 0x1p12;
template <class T>
bool are_far_apart(const std::vector<T>& weights) {
  if (weights.empty()) return false;
  T least = weights.front(), most = least;
  for (const T& w : weights) {
    if (w < least) least = w;
    if (most < w) most = w;
  }
  return !(most < T(weights_far_apart) * least);
}

// The part of a control net that affects the patch at (u, v), over the scalar of (u, v). Its point (i, j),
// with i up to degree_u and j up to degree_v, is the point first + i row + j of the net.
template <class S, class T>
struct NetWindow {
  const std::vector<Vec3<T>>& net_points;
  const std::vector<T>& weights;  // empty: all 1
  int degree_u, degree_v;
  SpanPlace<S> first;
  int row;

  Vec3<S> point(int i, int j) const { return first.point(net_points, i * row + j); }
  S weight(int i, int j) const { return first.number(weights, i * row + j); }
  bool rational() const { return !weights.empty(); }
  // The points (i, 0), (i, 1), ... relative to the last of them or the first, which is returned; times their
  // weights where the net is rational.
  template <class Degree, class UpperV>
  Vec3<S> column(int i, Degree q, const UpperV& upper_v, ControlWindow<Vec3<S>, Degree>& x) const {
    x[0] = x[q] = Vec3<S>{};  // compilers do not see that they are set
    first.points(net_points, i * row, q + 1, x);
    const Vec3<S> anchor = choose(upper_v, x[q], x[0]);
    for (int j = 0; j <= q; ++j) x[j] = x[j] - anchor;
    return anchor;
  }
  template <class Degree, class UpperV>
  Vec3<S> column(int i, Degree q, const UpperV& upper_v, ControlWindow<Homogeneous<S>, Degree>& x) const {
    ControlWindow<Vec3<S>, Degree> p;
    ControlWindow<S, Degree> w;
    const Vec3<S> anchor = column(i, q, upper_v, p);
    first.numbers(weights, i * row, q + 1, w);
    for (int j = 0; j <= q; ++j) x[j] = {w[j] * p[j], w[j]};
    return anchor;
  }
  // Columns 0 to p.
  template <int order, class Point, class DegreeU, class DegreeV, class Weights>
  Columns<order, S, Point, DegreeU> columns(DegreeU p, DegreeV q, const Weights& v) const {
    Columns<order, S, Point, DegreeU> result;
    const auto upper_v = v.upper();
    for (int i = 0; i <= p; ++i) {
      ControlWindow<Point, DegreeV> x;
      result.anchor[i] = column(i, q, upper_v, x);
      const auto along_v = spline_derivatives<order + 1, Point>(x, q, v);
      for (int k = 0; k <= order; ++k) result.f[k][i] = along_v[k];
    }
    return result;
  }
};

// The partials of a (rational) tensor product patch up to `order`, from the columns of its net. Positions are
// relative to control points, so patches far from the origin lose no accuracy, corners are interpolated
// exactly, and along a collapsed edge the partial is exactly zero, whatever the weights.
template <int order, class S, class Point, class Degree, class Weights>
Jet2<S> jet_of_columns(Columns<order, S, Point, Degree>& columns, Degree p, const Weights& u) {
  const Vec3<S> anchor = share_anchor(columns, p, u.upper());
  return jet_of<order>(anchor, tensor_partials<order, Point>(columns.f, p, u));
}
// At the spans u and v.
template <int order, class Patch, class U, class V>
auto patch_jet(const Patch& patch, const U& u, const V& v) {
  using S = std::remove_cvref_t<decltype(u.t)>;
  const auto net = patch.net(u, v);
  return with_degrees<order, S>(net.degree_u, net.degree_v, [&](auto p, auto q) {
    const auto of = [&]<class Point>(const Point&) {
      const auto along_u = u.weights(p, Known<order>{});
      auto columns = net.template columns<order, Point>(p, q, v.weights(q, Known<order>{}));
      return jet_of_columns(columns, p, along_u);
    };
    return net.rational() ? of(Homogeneous<S>{}) : of(Vec3<S>{});
  });
}

// Whether a surface type is a patch: span_u(u), span_v(v), and the window of its net there, net(span, span).
template <class X>
concept HasNet = requires(const X& x, const typename X::scalar& t) {
  x.net(x.span_u(t), x.span_v(t));
};

// The order of magnitude, in roundings, of the error of the first partials of a rational patch due to
// cancellation of hu.a and hu.w p. 1 unless the ratio of weights is so large that this may matter.
template <class Patch, class U, class V>
auto partials_condition(const Patch& patch, const U& u, const V& v) {
  using S = std::remove_cvref_t<decltype(u.t)>;
  const S one = lift<S>(1.0), far = lift<S>(weights_far_apart);
  if constexpr (requires { S::diverge(); }) {  // lanes go by themselves
    S::diverge();
    return one;
  }
  const auto net = patch.net(u, v);
  const int p = net.degree_u, q = net.degree_v;
  S least = net.weight(0, 0), most = least;
  for (int i = 0; i <= p; ++i)
    for (int j = 0; j <= q; ++j) {
      const S w = net.weight(i, j);
      least = w < least ? w : least;
      most = most < w ? w : most;
    }
  if (most < far * least) return one;
  const auto along_u = u.weights(p, Known<1>{});
  auto columns = net.template columns<1, Homogeneous<S>>(p, q, v.weights(q, Known<1>{}));
  share_anchor(columns, p, along_u.upper());
  const auto [h, hu, hv, huu, huv, hvv] = tensor_partials<1, Homogeneous<S>>(columns.f, p, along_u);
  const auto condition = [position = h.a / h.w](const Homogeneous<S>& along) {
    const Vec3<S> taken = along.w * position;
    return (norm(along.a) + norm(taken)) / norm(along.a - taken);
  };
  const S of_u = condition(hu), of_v = condition(hv);
  return of_u < of_v ? of_v : of_u;
}

// The position by its definition, Σ a_i b_j w_ij P_ij / Σ a_i b_j w_ij, from the values a and b of the
// basis functions.
template <class S, class T, class Basis>
Vec3<S> patch_position(const NetWindow<S, T>& net, const Basis& a, const Basis& b) {
  const S zero = lift<S>(0.0);
  Vec3<S> sum{zero, zero, zero};
  S total = zero;
  for (int i = 0; i <= net.degree_u; ++i)
    for (int j = 0; j <= net.degree_v; ++j) {
      const S w = net.rational() ? a[i] * b[j] * net.weight(i, j) : a[i] * b[j];
      sum += w * net.point(i, j);
      total = total + w;
    }
  return sum / total;
}

// dpdu_zero and dpdv_zero of a patch if (u, v) lies on a collapsed edge: the partial is exactly zero where
// all contributing control points coincide.
template <class Patch, class S>
Status collapsed_edges(const Patch& patch, const S& u, const S& v) {
  Status result = Status::regular;
  if constexpr (!requires {
                  S::diverge();
                }) {  // batches with vanishing partials diverge when the frame is computed
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    if (!equal(u, zero) && !equal(u, one) && !equal(v, zero) && !equal(v, one)) return result;
    const Jet2<S> j = patch.template jet_to<1>(u, v);
    if (vanishes(j.dpdu)) result |= Status::dpdu_zero;
    if (vanishes(j.dpdv)) result |= Status::dpdv_zero;
  }
  return result;
}

}  // namespace darboux::detail
