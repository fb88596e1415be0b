/// \file spline.h
/// Common code of Bézier and B-spline curves and patches: knot vectors, the de Casteljau and de Boor
/// recurrences with their hodographs, and rational derivatives. Degrees 1 to max_spline_degree, any ordered
/// scalar.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <darboux/binary.h>
#include <darboux/error.h>
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

// Equality, using only the order relation.
template <class S>
bool equal(const S& a, const S& b) {
  return !(a < b) && !(b < a);
}
// Whether x is zero, using only the order relation; false for NaN. If any lane is zero, the batch diverges.
template <class S>
bool is_zero(const S& x) {
  if constexpr (Lanewise<S>) {
    if ((x == S(0)).any()) S::diverge();
    return false;
  } else {
    return equal(x, lift<S>(0.0)) && x < lift<S>(1.0);
  }
}
template <class S>
bool vanishes(const Vec3<S>& a) {
  if constexpr (Lanewise<S>)
    return is_zero(S(abs(a.x) + abs(a.y) + abs(a.z)));
  else
    return is_zero(a.x) && is_zero(a.y) && is_zero(a.z);
}

// A number as text for messages.
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

// The number that determines the span of t: t itself. SIMD scalars provide their own.
template <class S>
const S& span_place(const S& t) {
  return t;
}

template <class Condition, class S>
Vec3<S> choose(const Condition& condition, const Vec3<S>& a, const Vec3<S>& b) {
  return {select(condition, a.x, b.x), select(condition, a.y, b.y), select(condition, a.z, b.z)};
}

// Numerator and denominator of a rational position.
template <class S>
struct Homogeneous {
  Vec3<S> a;
  S w;
  friend Homogeneous operator+(const Homogeneous& x, const Homogeneous& y) { return {x.a + y.a, x.w + y.w}; }
  friend Homogeneous operator-(const Homogeneous& x, const Homogeneous& y) { return {x.a - y.a, x.w - y.w}; }
  friend Homogeneous operator*(const S& k, const Homogeneous& x) { return {k * x.a, k * x.w}; }
};

// The index in a list where a span begins: one per lane of the scalar.
template <class S>
struct SpanPlace {
  int at = 0;

  /// KnotVector::find()
  template <class Knots>
  static SpanPlace find(const Knots& knots, const S& t) {
    return {knots.find(t)};
  }
  SpanPlace operator+(int n) const { return {at + n}; }
  SpanPlace operator+(const SpanPlace& other) const { return {at + other.at}; }
  SpanPlace operator*(int n) const { return {at * n}; }
  template <class T>
  S number(const std::vector<T>& list, int offset = 0) const {
    return lift<S>(list[static_cast<std::size_t>(at + offset)]);
  }
  template <class T>
  Vec3<S> point(const std::vector<Vec3<T>>& list, int offset = 0) const {
    return lift_vector<S>(list[static_cast<std::size_t>(at + offset)]);
  }
  /// `count` of them one after the other.
  template <class T, class To>
  void points(const std::vector<Vec3<T>>& list, int offset, int count, To&& to) const {
    for (int k = 0; k < count; ++k) to[k] = point(list, offset + k);
  }
  template <class T, class To>
  void numbers(const std::vector<T>& list, int offset, int count, To&& to) const {
    for (int k = 0; k < count; ++k) to[k] = number(list, offset + k);
  }
};

// A compile-time degree for built-in numbers and common degrees, otherwise an int.
template <int n>
using Known = std::integral_constant<int, n>;
template <class Degree>
inline constexpr int most_of = max_spline_degree;
template <int p>
inline constexpr int most_of<Known<p>> = p;
template <int a, int b>
constexpr Known<a - b> minus(Known<a>, Known<b>) {
  return {};
}
constexpr int minus(int a, int b) {
  return a - b;
}
// Calls f(0) ... f(n - 1); unrolled if n is a compile-time constant.
template <int n, class F>
constexpr void repeat(Known<n>, const F& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) {
    (f(Known<i>{}), ...);
  }
  (std::make_integer_sequence<int, n>{});
}
template <class F>
constexpr void repeat(int n, const F& f) {
  for (int i = 0; i < n; ++i) f(i);
}

// n values of a type, uninitialised if the type permits it.
template <class Value, int n>
struct Room {
  Room() {}  // NOLINT: without a value
  Value& operator[](int i) { return at[i]; }
  const Value& operator[](int i) const { return at[i]; }
  union {
    Value at[n];
  };
};
// The control points that affect one span of a spline (its window).
template <class Point, class Degree>
using ControlWindow =
    std::conditional_t<std::is_trivially_copyable_v<Point>, Room<Point, most_of<Degree> + 1>,
                       std::array<Point, most_of<Degree> + 1>>;

// f(degree)
template <class S, class F>
auto with_degree(int p, const F& f) {
  if constexpr (Binary<S>)
    if (p == 3) return f(Known<3>{});
  return f(p);
}
// The weights of de Boor's recurrence at a parameter in a span, computed once for all points of a window: at
// level l = 1 ... degree
//   x_j = below(l, j) x_j + above(l, j) x_{j+1},  j = 0 ... degree - l.
// The derivative of order o uses the levels from o + 1 on; the points of the next derivative are slope(o, j)
// (x_{j+1} - x_j).

// [0, 1] with all knots at its ends: the de Casteljau recurrence.
template <class S>
struct BezierWeights {
  int degree;
  S t, rest;  // rest = 1 - t
  BezierWeights(int p, const S& x) : degree(p), t(x), rest(lift<S>(1.0) - x) {}
  const S& below(int, int) const { return rest; }
  const S& above(int, int) const { return t; }
  S slope(int order, int) const { return lift<S>(static_cast<double>(degree - order)); }
  // Whether t lies in the upper half.
  auto upper() const { return span_place(S(lift<S>(0.5))) < span_place(t); }
};

template <class S>
struct BezierSpan {
  S t;
  SpanPlace<S> first{};
  template <class Degree, int orders>
  BezierWeights<S> weights(Degree p, Known<orders>) const {
    return {p, t};
  }
};

// A parameter t in one span of a B-spline.
template <class S, class T>
struct KnotSpan {
  S t;
  const std::vector<T>* list;
  SpanPlace<S> first;  // start of its control points, and of 2p + 2 knots with knot p <= t < knot p + 1

  template <class Degree, int orders>
  auto weights(Degree p, Known<orders> to) const;
};
template <class S, class Degree, int orders>
struct KnotWeights {
  static constexpr int most = most_of<Degree>;
  Degree degree;
  S t, begin, end;  // of the span
  std::array<S, most*(most + 1) / 2> below_, above_;
  std::array<std::array<S, most>, orders> slope_;

  /// \param orders highest order of derivatives required
  template <class T>
  KnotWeights(Degree p, Known<orders>, const KnotSpan<S, T>& span) : degree(p), t(span.t) {
    std::array<S, 2 * most + 2> knots{};
    span.first.numbers(*span.list, 0, 2 * p + 2, knots);
    begin = knots[p], end = knots[p + 1];
    repeat(p, [&](auto before) {
      repeat(minus(p, before), [&](auto j) {
        const S &lo = knots[1 + j + before], &hi = knots[1 + j + p], length = hi - lo;
        below_[place(before + 1, j)] = (hi - t) / length;
        above_[place(before + 1, j)] = (t - lo) / length;
        if constexpr (orders > 0)
          if (before < orders) slope_[before][j] = lift<S>(static_cast<double>(p - before)) / length;
      });
    });
  }
  auto upper() const { return span_place(S(begin + end)) < span_place(S(lift<S>(2.0) * t)); }
  const S& below(int level, int j) const { return below_[place(level, j)]; }
  const S& above(int level, int j) const { return above_[place(level, j)]; }
  const S& slope(int order, int j) const { return slope_[order][j]; }
  // Level 1 has `degree` pairs, each further one fewer.
  int place(int level, int j) const { return (level - 1) * (2 * degree + 2 - level) / 2 + j; }
};

template <class S, class T>
template <class Degree, int orders>
auto KnotSpan<S, T>::weights(Degree p, Known<orders> to) const {
  return KnotWeights<S, Degree, orders>(p, to, *this);
}

// The derivative of an order <= the degree at t, from its degree + 1 - order points. At a Bézier end or a
// knot of full multiplicity, it is exactly the control point there.
template <class Point, class Degree, class Order, class Weights>
Point de_boor(ControlWindow<Point, Degree> x, Degree degree, Order order, const Weights& weights) {
  const auto levels = minus(degree, order);
  repeat(levels, [&](auto done) {
    const int level = order + done + 1;
    repeat(minus(levels, done),
           [&](auto j) { x[j] = weights.below(level, j) * x[j] + weights.above(level, j) * x[j + 1]; });
  });
  return x[0];
}

// A spline and its derivatives up to order `count` - 1.
template <int count, class Point, class Degree, class Weights>
std::array<Point, count> spline_derivatives(ControlWindow<Point, Degree>& x, Degree degree,
                                            const Weights& weights) {
  const auto next = [&](auto order) {
    if (degree < order) return Point{};
    const Point value = de_boor<Point>(x, degree, order, weights);
    if constexpr (order + 1 < count)  // the control points of the derivative (the hodograph)
      repeat(minus(degree, order), [&](auto j) { x[j] = weights.slope(order, j) * (x[j + 1] - x[j]); });
    return value;
  };
  return [&]<int... order>(std::integer_sequence<int, order...>) {
    return std::array<Point, count>{next(Known<order>{})...};
  }
  (std::make_integer_sequence<int, count>{});
}

// Normalises weights, which matter only up to a common factor: a power of two brings the largest near 1.
// Empty if all are equal.
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

// Why control points or weights are invalid; empty if they are valid.
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
  // KnotVector divides by half the length of the interval, which must not underflow to 0.
  if (!(knots[degree] / T(2) < knots[knots.size() - 1 - degree] / T(2)))
    return "expected knots that enclose an interval, got none that do";
  return {};
}

}  // namespace detail

/// Knots 0 (degree + 1 times), equally spaced ones, 1 (degree + 1 times), for `count` control points. The
/// curve begins and ends at its first and last control point. \throws ParameterError unless degree >= 0 and
/// count > degree
template <class T = double>
std::vector<T> clamped_knots(int degree, int count) {
  static_assert(!std::is_integral_v<T>, "knots between 0 and 1 are no integers");
  if (degree < 0 || count <= degree)
    throw ParameterError("clamped knots",
                         "expected degree >= 0 and more control points than that, got degree " +
                             std::to_string(degree) + " and " + std::to_string(count));
  std::vector<T> knots;
  for (int i = -degree; i <= count; ++i) {
    const int spans = count - degree, k = i < 0 ? 0 : i > spans ? spans : i;
    knots.push_back(T(k) / T(spans));
  }
  return knots;
}

/// The knots of a univariate B-spline, mapped to the domain [0, 1]: (knot - k_p)/(k_n - k_p), p the degree
/// and n the number of control points. The owner must have checked the knots with refusal().
template <class T = double>
class KnotVector {
 public:
  KnotVector() = default;
  /// \param knots accepted by refusal()
  KnotVector(int degree, std::vector<T> knots) : degree_(degree), knots_(std::move(knots)) {
    const T start = knots_[degree_], end = knots_[count()];
    // Use halves, so that the length is representable for any ends.
    const T length = end / T(2) - start / T(2);
    if (!(start == T(0) && end == T(1)))
      for (T& k : knots_) k = k == end ? T(1) : (k / T(2) - start / T(2)) / length;
    creases_ = has_creases();
  }
  /// Why degree and knots are invalid; empty if they are valid. Checks for a degree out of range, too few
  /// knots, a decreasing or non-finite one, a multiplicity above degree + 1, an empty domain.
  static std::string refusal(int degree, const std::vector<T>& knots) {
    return detail::refuse_knots(degree, knots);
  }

  int degree() const { return degree_; }
  /// The number of control points for these knots.
  int count() const { return static_cast<int>(knots_.size()) - degree_ - 1; }
  const std::vector<T>& knots() const { return knots_; }

  /// The distinct knots strictly between 0 and 1, where the spline is only piecewise smooth.
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
    result.creases_ = result.has_creases();
    return result;
  }

  /// The index m with knot m <= t < knot m + 1, found from the value of t. Outside [0, 1) it is the first or
  /// last span. At a knot it is the span above.
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
    return not_empty(below);
  }
  /// The nearest non-empty span at or below span m; if there is none, the first one above.
  int not_empty(int m) const {
    while (m > degree_ && !(knots_[m] < knots_[m + 1])) --m;
    while (!(knots_[m] < knots_[m + 1])) ++m;
    return m;
  }

  template <class S>
  detail::KnotSpan<S, T> span(const S& t) const {
    return {t, &knots_, detail::SpanPlace<S>::find(*this, t) + -degree_};
  }

  /// Status::crease at an interior knot with multiplicity equal to the degree or more: first derivatives may
  /// be discontinuous there, and those from above are returned.
  template <class S>
  Status singular(const S& t) const {
    if constexpr (requires {
                    S::diverge();
                  }) {  // any lane at an interior knot, where one of them is a crease: the batch diverges
      if (!creases_) return Status::regular;
      const S knot = detail::SpanPlace<S>::find(*this, t).number(knots_);
      if ((t == knot && S(knots_[degree_]) < knot).any()) S::diverge();
      return Status::regular;
    } else {
      return singular_at(t, find(t));
    }
  }

  /// The degree + 1 basis functions that do not vanish at t, by the recurrence of their definition
  ///   N_{i,0} = 1 on its span, N_{i,q} = (t - k_i)/(k_{i+q} - k_i) N_{i,q-1}
  ///     + (k_{i+q+1} - t)/(k_{i+q+1} - k_{i+1}) N_{i+1,q-1},
  /// where a fraction with a zero denominator counts as zero. [Cox1972], [deBoor1972]
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
  template <class S>
  Status singular_at(const S& t, int m) const {
    const T& knot = knots_[m];
    return detail::equal(t, lift<S>(knot)) && is_crease(m) ? Status::crease : Status::regular;
  }
  // Of an interior knot, the last of its value.
  bool is_crease(int m) const {
    const T& knot = knots_[m];
    if (!(knots_[degree_] < knot) || !(knot < knots_[m + 1])) return false;
    int multiplicity = 1;
    while (multiplicity <= m && knots_[m - multiplicity] == knot) ++multiplicity;
    return multiplicity >= degree_;
  }
  bool has_creases() const {
    for (int m = degree_ + 1; m < count(); ++m)
      if (is_crease(m)) return true;
    return false;
  }
  int degree_ = 0;
  std::vector<T> knots_;
  bool creases_ = false;  // at some interior knot
};

}  // namespace darboux
