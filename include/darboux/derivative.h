/// \file derivative.h
/// derivative(): f'(x) by the cheapest method of differentiate.h whose error estimate meets a tolerance.
///
///     const auto d = darboux::derivative([](double x) { return std::exp(x); }, 0.5, {.error = 1e-10});
///     d.value, d.error, d.met, name(d.method, d.order)
#pragma once

#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include <darboux/differentiate.h>

namespace darboux {

/// A method of differentiation.
enum class DerivativeMethod { none, dual, one_sided, central, ridders };

/// "central8", "one_sided3", "ridders", "dual".
inline std::string name(DerivativeMethod method, int order = 0) {
  switch (method) {
    case DerivativeMethod::dual:
      return "dual";
    case DerivativeMethod::one_sided:
      return "one_sided" + std::to_string(order);
    case DerivativeMethod::central:
      return "central" + std::to_string(order);
    case DerivativeMethod::ridders:
      return "ridders";
    case DerivativeMethod::none:
      break;
  }
  return "none";
}

/// The request to derivative().
struct DerivativeRequest {
  double error;       ///< the absolute error permitted
  double length = 1;  ///< of f: see differentiate.h
  Interval domain{};  ///< f is evaluated nowhere else
};

/// A derivative, and how it was computed.
template <class V>
struct PlannedDerivative {
  V value;
  double error;  ///< estimated
  DerivativeMethod method = DerivativeMethod::none;
  int order = 0;        ///< of the difference; 0 for the other methods
  int evaluations = 0;  ///< of f, including all attempts and the 20 of behaviour()
  bool met = false;     ///< error <= the request
};

namespace detail::difference {

// Tries methods from cheap to expensive and keeps the best; stops when the request is met.
template <class F>
class Planner {
 public:
  using V = Value<F>;
  Planner(F& f, double x, const DerivativeRequest& request)
      : f_(f), x_(x), request_(request), best_{no_estimate<V>().value, infinity} {}

  PlannedDerivative<V> differences(const Behaviour& b) {
    right_ = request_.domain.hi - x_;
    left_ = x_ - request_.domain.lo;
    if (!(right_ >= 0 && left_ >= 0)) return best_;
    [&]<int... less_one>(std::integer_sequence<int, less_one...>) {
      (attempt<less_one + 1>(b), ...);
    }
    (std::make_integer_sequence<int, 8>{});
    const double h = std::fmin(b.length / 8, 0.999 * std::fmin(left_, right_));
    if (!best_.met && h > b.length / 64) {
      int evaluations = 0;
      const auto estimate = ridders(f_, x_, h, b.rounding, evaluations);
      keep(estimate, DerivativeMethod::ridders, 0, evaluations);
    }
    return best_;
  }

  void keep(const DerivativeEstimate<V>& estimate, DerivativeMethod method, int order, int evaluations) {
    best_.evaluations += evaluations;
    if (!(estimate.error < best_.error)) return;
    best_.value = estimate.value;
    best_.error = estimate.error;
    best_.method = method;
    best_.order = order;
    best_.met = estimate.error <= request_.error;
  }
  const PlannedDerivative<V>& best() const { return best_; }
  void spend(int evaluations) { best_.evaluations += evaluations; }

 private:
  // The difference with order + 2 evaluations: central if that order exists and the domain has room for it,
  // otherwise one-sided.
  template <int order>
  void attempt(const Behaviour& b) {
    if (best_.met) return;
    if constexpr (order % 2 == 0) {
      constexpr int reach = order / 2 + 1;
      const double h = step<order + 1>(central_steps[order], reach, b);
      if (std::fmin(left_, right_) > reach * h) {
        if (order < 8 && hopeless(h, amplification<Quotient::central, order / 2>(), b)) return;
        return keep(central<order>(f_, x_, h, b.rounding), DerivativeMethod::central, order, order + 2);
      }
    }
    constexpr int reach = order + 1;
    const double room = std::fmax(left_, right_);
    const double h = std::fmin(step<order + 1>(one_sided_steps[order], reach, b), 0.999 * room / reach);
    if (order < 8 && hopeless(h, amplification<Quotient::one_sided, order>(), b)) return;
    keep(one_sided<order>(f_, x_, right_ >= left_ ? h : -h, b.rounding, b.length),
         DerivativeMethod::one_sided, order, order + 2);
  }
  // Whether the rounding error alone exceeds the request.
  bool hopeless(double h, double amplification, const Behaviour& b) const {
    return rounding_share * amplification * b.rounding / h > request_.error &&
           best_.method != DerivativeMethod::none;
  }

  F& f_;
  double x_, left_ = 0, right_ = 0;
  DerivativeRequest request_;
  PlannedDerivative<V> best_;
};

}  // namespace detail::difference

/// f'(x) by the cheapest method whose error estimate meets the request. If none does, the result with the
/// smallest estimate is returned, with met = false. Dual numbers are tried first, if f accepts them (to
/// prevent that for a generic f, give its parameter the type double). Then the behaviour of f is measured,
/// and differences with 3 to 10 evaluations are tried: central ones for even orders if the domain has room
/// for the stencil, otherwise one-sided ones. Ridders' method comes last. Once there is an estimate,
/// differences whose rounding error alone would exceed the request are skipped, except those of order 8. f is
/// evaluated in the domain only. There is no derivative if x is NaN or outside the domain, or if the length
/// is not positive and finite.
template <class F>
auto derivative(F&& f, double x, const DerivativeRequest& request) {
  namespace d = detail::difference;
  d::Planner<std::remove_reference_t<F>> planner(f, x, request);
  if (!(request.domain.lo <= x && x <= request.domain.hi) ||
      !(0 < request.length && request.length < d::infinity))
    return planner.best();
  if constexpr (d::RunsOn<F, d::Once>) {
    planner.keep(dual_derivative(f, x, request.length, request.domain), DerivativeMethod::dual, 0,
                 d::RunsWiderOn<F, d::Once> ? 2 : 21);
    if (planner.best().met) return planner.best();
  }
  planner.spend(20);
  return planner.differences(behaviour(f, x, request.length, request.domain));
}
/// The same by differences only, with a behaviour measured beforehand: for many points of one function. The
/// length is that of b, and `evaluations` does not include the 20 of behaviour().
template <class F>
auto derivative(F&& f, double x, const DerivativeRequest& request, const Behaviour& b) {
  namespace d = detail::difference;
  d::Planner<std::remove_reference_t<F>> planner(f, x, request);
  return planner.differences(b);
}

}  // namespace darboux
