/// \file bspline_patch.h
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <darboux/spline_patch.h>
#include <darboux/surface.h>

namespace darboux {

/// Rational B-spline patch (NURBS) of degrees p × q (1 to 15 each).
///   P(u, v) = Σ_ij w_ij P_ij N_i,p(u) N_j,q(v) / Σ_ij w_ij N_i,p(u) N_j,q(v)
/// by de Boor's recurrence on homogeneous points, derivatives from the hodographs. u runs along the first
/// index of the control points, v along the second; the knots are mapped to [0, 1]. n = dpdu × dpdv / |.|.
/// At an interior knot of multiplicity p or more (degree 1: at each) the frame may jump. The status is crease
/// then, and the frame is that from above (right of the knot). Where an edge v = 0 or v = 1 with a knot of
/// multiplicity q + 1 collapses to a point, dpdu is exactly zero (dpdu_zero) and the frame is the limit along
/// v; the same for u and dpdv. Where dpdu and dpdv are parallel the status is parallel and the frame is the
/// limit. Beyond [0, 1] the end spans continue. Partials err by at most 8u (1 + condition) of their scale on
/// the span, u the unit roundoff; the condition is of the size 4 (p + q). The scalar needs an order: the span
/// is found from the value of u and v.
/// [PieglTiller1997, ch. 4]
template <class T = double>
class BSplinePatch {
 public:
  using scalar = T;
  static constexpr SurfaceInfo info{
      "bspline-patch",
      "rational B-spline patch (NURBS)",
      Coordinate::linear,
      Coordinate::linear,
      {"collapsed edges", "knots of multiplicity >= degree", "dpdu parallel to dpdv"}};

  /// A rational patch of degrees 3 × 2 in one span, so that it is smooth everywhere; it does not begin and
  /// end in its control points along u.
  BSplinePatch()
      : BSplinePatch(3, 2, {T(-1), T(-0.5), T(-0.5), T(0), T(1), T(1.5), T(1.75), T(2)},
                     clamped_knots<T>(2, 3), example_points(), example_weights()) {}

  /// \param knots_u as many as control points along u + degree_u + 1, not decreasing; knots_v likewise
  /// \param control_points P_ij at i n_v + j, n_v = knots_v.size() - degree_v - 1
  /// \param weights as many, positive; or none: all 1
  /// \throws ParameterError naming what is wrong
  BSplinePatch(int degree_u, int degree_v, std::vector<T> knots_u, std::vector<T> knots_v,
               std::vector<Vec3<T>> control_points, std::vector<T> weights = {})
      : control_points_(std::move(control_points)), weights_(std::move(weights)) {
    if (const std::string why = refusal(degree_u, degree_v, knots_u, knots_v, control_points_, weights_);
        !why.empty())
      throw_refused(info.name, why);
    detail::normalise_weights(weights_);
    far_apart_ = detail::are_far_apart(weights_);
    u_ = KnotVector<T>(degree_u, std::move(knots_u));
    v_ = KnotVector<T>(degree_v, std::move(knots_v));
  }

  const KnotVector<T>& knots_u() const { return u_; }
  const KnotVector<T>& knots_v() const { return v_; }
  int degree_u() const { return u_.degree(); }
  int degree_v() const { return v_.degree(); }
  const std::vector<Vec3<T>>& control_points() const { return control_points_; }
  /// The weights given, times a common power of two; empty if they are all equal.
  const std::vector<T>& weights() const { return weights_; }

  /// The interior knots along u (0) or v (1).
  std::vector<double> breaks(int along) const { return (along == 0 ? u_ : v_).breaks(); }

  /// What is wrong with the data; empty if nothing is.
  static std::string refusal(int degree_u, int degree_v, const std::vector<T>& knots_u,
                             const std::vector<T>& knots_v, const std::vector<Vec3<T>>& control_points,
                             const std::vector<T>& weights) {
    if (const std::string why = KnotVector<T>::refusal(degree_u, knots_u); !why.empty())
      return "along u: " + why;
    if (const std::string why = KnotVector<T>::refusal(degree_v, knots_v); !why.empty())
      return "along v: " + why;
    return detail::refuse_net((knots_u.size() - degree_u - 1) * (knots_v.size() - degree_v - 1),
                              control_points, weights);
  }
  std::string refusal() const {
    return refusal(u_.degree(), v_.degree(), u_.knots(), v_.knots(), control_points_, weights_);
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
    return u_.singular(u) | v_.singular(v) | detail::collapsed_edges(*this, u, v);
  }

  template <class S>
  S partials_condition(const S& u, const S& v) const {
    return far_apart_ ? detail::partials_condition(*this, span_u(u), span_v(v)) : lift<S>(1.0);
  }

  /// The sum over the basis functions of Cox and de Boor.
  template <class S>
  Vec3<S> second_formula(const S& u, const S& v) const {
    int i = 0, j = 0;
    const auto a = u_.basis(u, i), b = v_.basis(v, j);
    return detail::patch_position(window(detail::SpanPlace<S>{i}, detail::SpanPlace<S>{j}), a, b);
  }

  /// The same patch over another scalar.
  template <class To>
  auto rebind() const {
    BSplinePatch<To> result;
    result.u_ = u_.template rebind<To>();
    result.v_ = v_.template rebind<To>();
    result.control_points_ = detail::lift_points<To>(control_points_);
    result.weights_ = detail::lift_numbers<To>(weights_);
    result.far_apart_ = far_apart_;
    return result;
  }

  /// The inputs of jet(): the spans of u and v, and the window of the net there.
  template <class S>
  detail::KnotSpan<S, T> span_u(const S& u) const {
    return u_.span(u);
  }
  template <class S>
  detail::KnotSpan<S, T> span_v(const S& v) const {
    return v_.span(v);
  }
  template <class S>
  detail::NetWindow<S, T> net(const detail::KnotSpan<S, T>& u, const detail::KnotSpan<S, T>& v) const {
    return window(u.first, v.first);
  }

 private:
  template <class>
  friend class BSplinePatch;

  // The window of the net from point (i, j) on.
  template <class S>
  detail::NetWindow<S, T> window(const detail::SpanPlace<S>& i, const detail::SpanPlace<S>& j) const {
    return {control_points_, weights_, u_.degree(), v_.degree(), i * v_.count() + j, v_.count()};
  }

  static std::vector<Vec3<T>> example_points() {
    constexpr double height[4][3] = {{0, 0.5, -0.25}, {0.25, 1, 0.25}, {-0.25, 0.5, 0.75}, {0, -0.5, 0.25}};
    std::vector<Vec3<T>> points;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 3; ++j) points.push_back({T(i) / T(2), T(j) / T(2), T(height[i][j])});
    return points;
  }
  static std::vector<T> example_weights() {
    std::vector<T> weights(12, T(1));
    weights[4] = T(2);
    weights[8] = T(0.5);
    return weights;
  }

  KnotVector<T> u_, v_;
  std::vector<Vec3<T>> control_points_;
  std::vector<T> weights_;
  bool far_apart_ = false;  // the weights
};

}  // namespace darboux
