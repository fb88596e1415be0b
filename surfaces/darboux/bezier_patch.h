/// \file bezier_patch.h
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <darboux/spline_patch.h>
#include <darboux/surface.h>

namespace darboux {

/// Rational Bézier patch of degrees p × q (1 to 15 each).
///   P(u, v) = Σ_ij w_ij P_ij B_i,p(u) B_j,q(v) / Σ_ij w_ij B_i,p(u) B_j,q(v),
///     B_i,p(u) = binomial(p, i) u^i (1 - u)^(p-i)
/// by de Casteljau's recurrence on homogeneous points, derivatives from the hodographs. u runs along the
/// first index of the control points, v along the second. n = dpdu × dpdv / |.|. Where an edge v = 0 or v =
/// 1 collapses to a point, dpdu is exactly zero (dpdu_zero) and the frame is the limit along v; if several
/// rows lie in one point, dpdv is zero too. The same holds for u. Where dpdu and dpdv are parallel the status
/// is parallel and the frame is the limit. Partials err by at most 8u (1 + condition) of their scale, u the
/// unit roundoff; the condition is of the size 2 (p + q). A net far from the origin adds no error but its own
/// rounding. The scalar needs an order. [PieglTiller1997, ch. 1 and 4]
template <class T = double>
class BezierPatch {
 public:
  using scalar = T;
  static constexpr SurfaceInfo info{"bezier-patch",
                                    "rational Bezier patch",
                                    Coordinate::linear,
                                    Coordinate::linear,
                                    {"collapsed edges", "dpdu parallel to dpdv"}};

  /// A bicubic rational patch over the unit square.
  BezierPatch() : BezierPatch(3, 3, example_points(), example_weights()) {}

  /// \param control_points (degree_u + 1)(degree_v + 1) of them, P_ij at i (degree_v + 1) + j
  /// \param weights as many, positive; or none: all 1
  /// \throws ParameterError naming what is wrong
  BezierPatch(int degree_u, int degree_v, std::vector<Vec3<T>> control_points, std::vector<T> weights = {})
      : degree_u_(degree_u),
        degree_v_(degree_v),
        control_points_(std::move(control_points)),
        weights_(std::move(weights)) {
    if (const std::string why = refusal(); !why.empty()) throw_refused(info.name, why);
    detail::normalise_weights(weights_);
    far_apart_ = detail::are_far_apart(weights_);
  }

  int degree_u() const { return degree_u_; }
  int degree_v() const { return degree_v_; }
  const std::vector<Vec3<T>>& control_points() const { return control_points_; }
  /// The weights given, times a common power of two; empty if they are all equal.
  const std::vector<T>& weights() const { return weights_; }

  std::string refusal() const {
    for (const int degree : {degree_u_, degree_v_})
      if (std::string why = detail::refuse_degree(degree); !why.empty()) return why;
    return detail::refuse_net(static_cast<std::size_t>(degree_u_ + 1) * (degree_v_ + 1), control_points_,
                              weights_);
  }

  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    return jet_to<2>(u, v);
  }
  /// jet() with its partials up to `order` only, to the same bits; zero beyond.
  template <int order, class S>
  Jet2<S> jet_to(const S& u, const S& v) const {
    return detail::patch_jet<order>(*this, span_u(u), span_v(v));
  }

  template <class S>
  Status singular(const S& u, const S& v) const {
    return detail::collapsed_edges(*this, u, v);
  }

  template <class S>
  S partials_condition(const S& u, const S& v) const {
    return far_apart_ ? detail::partials_condition(*this, span_u(u), span_v(v)) : lift<S>(1.0);
  }

  /// The sums over Bernstein polynomials themselves.
  template <class S>
  Vec3<S> second_formula(const S& u, const S& v) const {
    return detail::patch_position(net(span_u(u), span_v(v)), bernstein(degree_u_, u),
                                  bernstein(degree_v_, v));
  }

  /// The same patch over another scalar.
  template <class To>
  auto rebind() const {
    BezierPatch<To> result;
    result.degree_u_ = degree_u_;
    result.degree_v_ = degree_v_;
    result.control_points_ = detail::lift_points<To>(control_points_);
    result.weights_ = detail::lift_numbers<To>(weights_);
    result.far_apart_ = far_apart_;
    return result;
  }

  /// The inputs of jet(): the spans of u and v, and the window of the net there.
  template <class S>
  static detail::BezierSpan<S> span_u(const S& u) {
    return {u};
  }
  template <class S>
  static detail::BezierSpan<S> span_v(const S& v) {
    return {v};
  }
  template <class S>
  detail::NetWindow<S, T> net(const detail::BezierSpan<S>& u, const detail::BezierSpan<S>& v) const {
    return {control_points_, weights_, degree_u_, degree_v_, u.first * (degree_v_ + 1) + v.first,
            degree_v_ + 1};
  }

 private:
  template <class>
  friend class BezierPatch;

  static std::vector<Vec3<T>> example_points() {
    constexpr double height[4][4] = {
        {0, 0.25, 0.25, 0}, {0.25, 0.75, 0.5, -0.25}, {0, 0.5, 1, 0.25}, {0.125, -0.25, 0.25, 0.5}};
    std::vector<Vec3<T>> points;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) points.push_back({T(i) / T(3), T(j) / T(3), T(height[i][j])});
    return points;
  }
  static std::vector<T> example_weights() {
    std::vector<T> weights(16, T(1));
    weights[5] = T(2);
    weights[10] = T(0.5);
    return weights;
  }

  // The Bernstein polynomials of degree n as binomial(n, i) t^i (1 - t)^(n-i).
  template <class S>
  static std::array<S, max_spline_degree + 1> bernstein(int n, const S& t) {
    std::array<S, max_spline_degree + 1> result{};
    const S rest = lift<S>(1.0) - t;
    double binomial = 1;
    for (int i = 0; i <= n; ++i) {
      S b = lift<S>(binomial);
      for (int k = 0; k < i; ++k) b = b * t;
      for (int k = i; k < n; ++k) b = b * rest;
      result[i] = b;
      binomial = binomial * (n - i) / (i + 1);
    }
    return result;
  }

  int degree_u_, degree_v_;
  std::vector<Vec3<T>> control_points_;
  std::vector<T> weights_;
  bool far_apart_ = false;  // the weights
};

}  // namespace darboux
