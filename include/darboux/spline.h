/// \file spline.h
/// What Bézier and B-spline curves and patches share: knot vectors, the de Casteljau and de Boor recurrences
/// with their hodographs, and rational derivatives. Every degree from 1 to max_spline_degree, any scalar with
/// an order.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <darboux/surface.h>

namespace darboux {

/// The highest degree of Bézier and B-spline curves and patches.
inline constexpr int max_spline_degree = 15;

namespace detail {

template <class S, class T>
Vec3<S> lift_vector(const Vec3<T>& a) {
  return {lift<S>(a.x), lift<S>(a.y), lift<S>(a.z)};
}
template <class To, class From>
std::vector<To> lift_numbers(const std::vector<From>& list) {
  std::vector<To> result;
  result.reserve(list.size());
  for (const From& x : list) result.push_back(lift<To>(x));
  return result;
}
template <class To, class From>
std::vector<Vec3<To>> lift_points(const std::vector<Vec3<From>>& list) {
  std::vector<Vec3<To>> result;
  result.reserve(list.size());
  for (const Vec3<From>& p : list) result.push_back(lift_vector<To>(p));
  return result;
}

// Equality by order alone.
template <class S>
bool equal(const S& a, const S& b) {
  return !(a < b) && !(b < a);
}
// Zero by order alone. NaN is not.
template <class S>
bool is_zero(const S& x) {
  return equal(x, lift<S>(0.0)) && x < lift<S>(1.0);
}
template <class S>
bool vanishes(const Vec3<S>& a) {
  return is_zero(a.x) && is_zero(a.y) && is_zero(a.z);
}

// A number for messages.
template <class T>
std::string text_of(const T& x) {
  if constexpr (requires { Scalar<T>::value(x); }) {
    return text_of(Scalar<T>::value(x));
  } else {
    char text[32];
    std::snprintf(text, sizeof text, "%g", static_cast<double>(x));
    return text;
  }
}

// The number by which the span of t is found: t itself. A scalar that stands for many numbers brings its own.
template <class S>
const S& span_place(const S& t) {
  return t;
}

// Numerator and denominator of a rational position.
template <class S>
struct Homogeneous {
  Vec3<S> a;
  S w{};
  friend Homogeneous operator+(const Homogeneous& x, const Homogeneous& y) { return {x.a + y.a, x.w + y.w}; }
  friend Homogeneous operator-(const Homogeneous& x, const Homogeneous& y) { return {x.a - y.a, x.w - y.w}; }
  friend Homogeneous operator*(const S& k, const Homogeneous& x) { return {k * x.a, k * x.w}; }
};

template <class Point>
using ControlWindow = std::array<Point, max_spline_degree + 1>;

// [0, 1] with all knots at its ends: de Casteljau's weights. Between lo and hi of any level the knots are 0
// and 1.
template <class S>
struct BezierSpan {
  S t, rest;  // rest = 1 - t
  explicit BezierSpan(const S& x) : t(x), rest(lift<S>(1.0) - x) {}
  template <class Point>
  Point mix(const Point& x, const Point& y, int, int) const {
    return rest * x + t * y;
  }
  S slope(int degree, int, int) const { return lift<S>(static_cast<double>(degree)); }
};

// One span of a B-spline: its 2p local knots, knots[p-1] <= t < knots[p].
template <class S>
struct KnotSpan {
  S t;
  int first = 0;  // the first control point that counts here
  std::array<S, 2 * max_spline_degree> knots{};
  template <class Point>
  Point mix(const Point& x, const Point& y, int lo, int hi) const {
    const S length = knots[hi] - knots[lo];
    return S((knots[hi] - t) / length) * x + S((t - knots[lo]) / length) * y;
  }
  S slope(int degree, int lo, int hi) const {
    return lift<S>(static_cast<double>(degree)) / (knots[hi] - knots[lo]);
  }
};

// De Boor's recurrence for degree + 1 points of the `order`-th derivative of a spline of degree `degree +
// order`. At t at a Bézier end or a knot of full multiplicity it returns the control point there, exactly.
template <class Point, class Span>
Point de_boor(ControlWindow<Point> x, int degree, int order, const Span& span) {
  for (int level = 1; level <= degree; ++level)
    for (int j = 0; j <= degree - level; ++j)
      x[j] = span.mix(x[j], x[j + 1], order + j + level - 1, order + j + degree);
  return x[0];
}

// The control points of the derivative (the hodograph) of the same.
template <class Point, class Span>
void hodograph(ControlWindow<Point>& x, int degree, int order, const Span& span) {
  for (int j = 0; j < degree; ++j)
    x[j] = span.slope(degree, order + j, order + j + degree) * (x[j + 1] - x[j]);
}

// A spline of the given degree and its derivatives up to `count` - 1.
template <int count, class Point, class Span>
std::array<Point, count> spline_derivatives(ControlWindow<Point> x, int degree, const Span& span) {
  std::array<Point, count> result{};
  for (int order = 0; order < count && order <= degree; ++order) {
    result[order] = de_boor(x, degree - order, order, span);
    if (order < degree) hodograph(x, degree - order, order, span);
  }
  return result;
}

// The partials (f, f_u, f_v, f_uu, f_uv, f_vv) of a tensor product: along v for each column, then along u.
// \param at control point (i, j) of the window
template <class Point, class SpanU, class SpanV, class At>
std::array<Point, 6> tensor_partials(int degree_u, int degree_v, const SpanU& u, const SpanV& v, At&& at) {
  ControlWindow<Point> f{}, f_v{}, f_vv{};
  for (int i = 0; i <= degree_u; ++i) {
    ControlWindow<Point> column{};
    for (int j = 0; j <= degree_v; ++j) column[j] = at(i, j);
    const auto along_v = spline_derivatives<3>(column, degree_v, v);
    f[i] = along_v[0];
    f_v[i] = along_v[1];
    f_vv[i] = along_v[2];
  }
  const auto a = spline_derivatives<3>(f, degree_u, u);
  const auto b = spline_derivatives<2>(f_v, degree_u, u);
  return {a[0], a[1], b[0], a[2], b[1], de_boor(f_vv, degree_u, 0, u)};
}

// A surface from partials of the net relative to `anchor`.
template <class S>
Jet2<S> jet_of(const Vec3<S>& anchor, const std::array<Vec3<S>, 6>& f) {
  return {anchor + f[0], f[1], f[2], f[3], f[4], f[5]};
}
template <class S>
Jet2<S> jet_of(const Vec3<S>& anchor, const std::array<Homogeneous<S>, 6>& f) {
  const auto& [h, hu, hv, huu, huv, hvv] = f;
  const S two = lift<S>(2.0);
  const Vec3<S> p = h.a / h.w;
  const Vec3<S> pu = (hu.a - hu.w * p) / h.w, pv = (hv.a - hv.w * p) / h.w;
  return {anchor + p,
          pu,
          pv,
          (huu.a - (two * hu.w) * pu - huu.w * p) / h.w,
          (huv.a - hu.w * pv - hv.w * pu - huv.w * p) / h.w,
          (hvv.a - (two * hv.w) * pv - hvv.w * p) / h.w};
}

// The part of a patch's control net that counts at a place, over the scalar of the place: its point (i, j), i
// up to degree_u and j up to degree_v, is the net's at first + i row + j.
template <class S, class T>
struct NetWindow {
  const std::vector<Vec3<T>>& points;
  const std::vector<T>& weights;  // empty: all 1
  int degree_u, degree_v;
  std::size_t first, row;

  std::size_t index(int i, int j) const { return first + static_cast<std::size_t>(i) * row + j; }
  Vec3<S> point(int i, int j) const { return lift_vector<S>(points[index(i, j)]); }
  S weight(int i, int j) const { return lift<S>(weights[index(i, j)]); }
  bool rational() const { return !weights.empty(); }
};

// The partials of a (rational) tensor product patch. The net is shifted by the window's corner nearest to (u,
// v): what is far from the origin loses nothing, a corner is met exactly, and along a collapsed edge the
// partial is exactly zero, whatever the weights.
template <class S, class T, class SpanU, class SpanV>
Jet2<S> patch_jet(const NetWindow<S, T>& net, const SpanU& u, const SpanV& v, bool upper_u, bool upper_v) {
  const int p = net.degree_u, q = net.degree_v;
  const Vec3<S> anchor = net.point(upper_u ? p : 0, upper_v ? q : 0);
  if (!net.rational())
    return jet_of(
        anchor, tensor_partials<Vec3<S>>(p, q, u, v, [&](int i, int j) { return net.point(i, j) - anchor; }));
  return jet_of(anchor, tensor_partials<Homogeneous<S>>(p, q, u, v, [&](int i, int j) {
                  const S w = net.weight(i, j);
                  return Homogeneous<S>{w * (net.point(i, j) - anchor), w};
                }));
}

// How many roundings, to the order, the first partials of a patch may err for that hu.a and hu.w p cancel in
// them: 1 unless weights are so far apart that it may matter.
template <class S, class T, class SpanU, class SpanV>
S partials_condition(const NetWindow<S, T>& net, const SpanU& u, const SpanV& v, bool upper_u, bool upper_v) {
  const S one = lift<S>(1.0), far = lift<S>(0x1p12);
  if (!net.rational()) return one;
  const int p = net.degree_u, q = net.degree_v;
  S least = net.weight(0, 0), most = least;
  for (int i = 0; i <= p; ++i)
    for (int j = 0; j <= q; ++j) {
      const S w = net.weight(i, j);
      least = w < least ? w : least;
      most = most < w ? w : most;
    }
  if (most < far * least) return one;
  const Vec3<S> anchor = net.point(upper_u ? p : 0, upper_v ? q : 0);
  const auto [h, hu, hv, huu, huv, hvv] = tensor_partials<Homogeneous<S>>(p, q, u, v, [&](int i, int j) {
    const S w = net.weight(i, j);
    return Homogeneous<S>{w * (net.point(i, j) - anchor), w};
  });
  const auto condition = [position = h.a / h.w](const Homogeneous<S>& along) {
    const Vec3<S> taken = along.w * position;
    return (norm(along.a) + norm(taken)) / norm(along.a - taken);
  };
  const S of_u = condition(hu), of_v = condition(hv);
  return of_u < of_v ? of_v : of_u;
}

// The position by its definition, Σ a_i b_j w_ij P_ij / Σ a_i b_j w_ij, from the values a and b of the basis
// functions.
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

// dpdu_zero and dpdv_zero of a patch where (u, v) lies on a collapsed edge: the partial is exactly zero
// there, where the control points that count are one point.
template <class Patch, class S>
Status collapsed_edges(const Patch& patch, const S& u, const S& v) {
  const S zero = lift<S>(0.0), one = lift<S>(1.0);
  Status result = Status::regular;
  if (!equal(u, zero) && !equal(u, one) && !equal(v, zero) && !equal(v, one)) return result;
  const Jet2<S> j = patch.jet(u, v);
  if (vanishes(j.dpdu)) result |= Status::dpdu_zero;
  if (vanishes(j.dpdv)) result |= Status::dpdv_zero;
  return result;
}

// Weights count up to a common factor: their largest is brought near 1 by a power of two; none where all are
// equal.
template <class T>
void normalise_weights(std::vector<T>& weights) {
  double largest = 0;
  bool all_equal = true;
  for (const T& w : weights) {
    largest = std::fmax(largest, size_of(w));
    all_equal = all_equal && w == weights.front();
  }
  if (all_equal) {
    weights.clear();
    return;
  }
  const int e = std::ilogb(largest);
  for (T& w : weights) w = scaled_by_power_of_two(w, -e);
}

// What is wrong with control points and weights, empty when nothing is.
template <class T>
std::string refuse_net(std::size_t expected, const std::vector<Vec3<T>>& points,
                       const std::vector<T>& weights) {
  using std::isfinite;
  if (points.size() != expected)
    return "expected " + std::to_string(expected) + " control points, got " + std::to_string(points.size());
  if (!weights.empty() && weights.size() != expected)
    return "expected " + std::to_string(expected) + " weights or none, got " + std::to_string(weights.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!isfinite(points[i].x) || !isfinite(points[i].y) || !isfinite(points[i].z))
      return "control point " + std::to_string(i) + ": expected finite coordinates, got NaN or infinity";
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (!isfinite(weights[i]) || !(T(0) < weights[i]))
      return "weight " + std::to_string(i) + ": expected a positive finite number" +
             (weights[i] == T(0) ? ", not negligible beside the largest" : "") + ", got " +
             text_of(weights[i]);
  return {};
}

inline std::string refuse_degree(int degree) {
  if (degree < 1 || degree > max_spline_degree)
    return "degree: expected 1 to " + std::to_string(max_spline_degree) + ", got " + std::to_string(degree);
  return {};
}

template <class T>
std::string refuse_knots(int degree, const std::vector<T>& knots) {
  using std::isfinite;
  if (std::string why = refuse_degree(degree); !why.empty()) return why;
  if (knots.size() < 2 * static_cast<std::size_t>(degree) + 2)
    return "expected at least " + std::to_string(2 * degree + 2) + " knots, for " +
           std::to_string(degree + 1) + " control points of degree " + std::to_string(degree) + ", got " +
           std::to_string(knots.size());
  int multiplicity = 1;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (!isfinite(knots[i]))
      return "knot " + std::to_string(i) + ": expected a finite number, got NaN or infinity";
    if (i == 0) continue;
    if (knots[i] < knots[i - 1])
      return "knot " + std::to_string(i) + ": expected at least knot " + std::to_string(i - 1) + ", " +
             text_of(knots[i - 1]) + ", got " + text_of(knots[i]);
    multiplicity = knots[i] == knots[i - 1] ? multiplicity + 1 : 1;
    if (multiplicity > degree + 1)
      return "knot " + text_of(knots[i]) +
             ": expected a multiplicity of at most degree + 1 = " + std::to_string(degree + 1) + ", got more";
  }
  if (!(knots[degree] < knots[knots.size() - 1 - degree]))
    return "expected knots that enclose an interval, got none that do";
  return {};
}

}  // namespace detail

/// Knots 0 (degree + 1 times), equally spaced ones, 1 (degree + 1 times), for `count` control points: the
/// curve begins and ends in its first and last one.
template <class T = double>
std::vector<T> clamped_knots(int degree, int count) {
  std::vector<T> knots;
  for (int i = -degree; i <= count; ++i) {
    const int spans = count - degree, k = i < 0 ? 0 : i > spans ? spans : i;
    knots.push_back(T(k) / T(spans));
  }
  return knots;
}

/// The knots of a B-spline of one variable, mapped to the domain [0, 1] of its coordinate: (knot - k_p)/(k_n
/// - k_p), p the degree and n the number of control points. Its owner has checked the knots by refusal().
template <class T = double>
class KnotVector {
 public:
  KnotVector() = default;
  /// \param knots accepted by refusal()
  KnotVector(int degree, std::vector<T> knots) : degree_(degree), knots_(std::move(knots)) {
    const T start = knots_[degree_], end = knots_[count()];
    // Halves, so that the length is representable whatever the ends.
    const T length = end / T(2) - start / T(2);
    if (!(start == T(0) && end == T(1)))
      for (T& k : knots_) k = k == end ? T(1) : (k / T(2) - start / T(2)) / length;
  }
  /// What is wrong with degree and knots; empty when nothing is: a degree out of range, too few knots, a
  /// decreasing or non-finite one, a multiplicity above degree + 1, an empty domain.
  static std::string refusal(int degree, const std::vector<T>& knots) {
    return detail::refuse_knots(degree, knots);
  }

  int degree() const { return degree_; }
  /// The number of control points that belong to the knots.
  int count() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  const std::vector<T>& knots() const { return knots_; }

  /// The knots between 0 and 1, each once: where the spline is only piecewise smooth.
  std::vector<double> breaks() const {
    std::vector<double> result;
    for (const T& k : knots_)
      if (const double x = static_cast<double>(k); 0 < x && x < 1 && (result.empty() || result.back() < x))
        result.push_back(x);
    return result;
  }

  template <class To>
  KnotVector<To> rebind() const {
    KnotVector<To> result;
    result.degree_ = degree_;
    result.knots_ = detail::lift_numbers<To>(knots_);
    return result;
  }

  /// The index m with knot m <= t < knot m + 1, found from the value of t; the first or last span outside [0,
  /// 1) and for t = 1. At a knot it is the span above.
  template <class S>
  int find(const S& at) const {
    using detail::span_place;
    const auto& t = span_place(at);
    using Place = std::remove_cvref_t<decltype(t)>;
    int below = degree_, above = count();  // knot(below) <= t < knot(above), or t is outside
    while (above - below > 1) {
      const int middle = (below + above) / 2;
      if (t < lift<Place>(knots_[middle]))
        above = middle;
      else
        below = middle;
    }
    while (below > degree_ && !(knots_[below] < knots_[below + 1])) --below;
    while (!(knots_[below] < knots_[below + 1])) ++below;
    return below;
  }

  template <class S>
  detail::KnotSpan<S> span(const S& t) const {
    const int m = find(t);
    detail::KnotSpan<S> result{t, m - degree_, {}};
    for (int i = 0; i < 2 * degree_; ++i) result.knots[i] = lift<S>(knots_[m - degree_ + 1 + i]);
    return result;
  }

  /// Whether t lies in the upper half of the span.
  template <class S>
  bool upper(const detail::KnotSpan<S>& span) const {
    using detail::span_place;
    return span_place(S(span.knots[degree_ - 1] + span.knots[degree_])) <
           span_place(S(lift<S>(2.0) * span.t));
  }

  /// Status::crease at an interior knot whose multiplicity is the degree or more: there first derivatives may
  /// jump, and those from above are given.
  template <class S>
  Status singular(const S& t) const {
    const int m = find(t);
    const T& knot = knots_[m];
    if (!detail::equal(t, lift<S>(knot)) || !(knots_[degree_] < knot)) return Status::regular;
    int multiplicity = 1;
    while (multiplicity <= m && knots_[m - multiplicity] == knot) ++multiplicity;
    return multiplicity >= degree_ ? Status::crease : Status::regular;
  }

  /// The degree + 1 basis functions that do not vanish at t, by the recurrence of their definition
  ///   N_{i,0} = 1 on its span, N_{i,q} = (t - k_i)/(k_{i+q} - k_i) N_{i,q-1}
  ///     + (k_{i+q+1} - t)/(k_{i+q+1} - k_{i+1}) N_{i+1,q-1},
  /// a fraction with a zero denominator counting as zero. [Cox1972], [deBoor1972]
  /// \param first the index of the first of them
  template <class S>
  std::array<S, max_spline_degree + 1> basis(const S& t, int& first) const {
    int m = degree_;
    for (int i = degree_; i < count(); ++i)
      if (knots_[i] < knots_[i + 1] && (!(knots_[m] < knots_[m + 1]) || !(t < lift<S>(knots_[i])))) m = i;
    first = m - degree_;
    const S zero = lift<S>(0.0);
    std::array<S, max_spline_degree + 2> n{};
    for (S& x : n) x = zero;
    n[degree_] = lift<S>(1.0);
    for (int q = 1; q <= degree_; ++q)
      for (int j = 0; j <= degree_; ++j) {
        const int i = first + j;
        S sum = zero;
        if (knots_[i] < knots_[i + q]) {
          const S k = lift<S>(knots_[i]);
          sum = sum + (t - k) / (lift<S>(knots_[i + q]) - k) * n[j];
        }
        if (knots_[i + 1] < knots_[i + q + 1]) {
          const S k = lift<S>(knots_[i + q + 1]);
          sum = sum + (k - t) / (k - lift<S>(knots_[i + 1])) * n[j + 1];
        }
        n[j] = sum;
      }
    std::array<S, max_spline_degree + 1> result{};
    for (int j = 0; j <= degree_; ++j) result[j] = n[j];
    return result;
  }

 private:
  template <class>
  friend class KnotVector;
  int degree_ = 0;
  std::vector<T> knots_;
};

}  // namespace darboux
