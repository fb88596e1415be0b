// The batch loop over one surface. Everything has internal linkage: no function of one instruction set may be
// linked into another.
#pragma once

#include <algorithm>
#include <optional>
#include <type_traits>

#include <darboux/curvature.h>
#include <darboux/shape_operator.h>

#include "batch_width.h"
#include "lanes.h"
#include "layout.h"
#include "spline_lanes.h"
#include "work.h"

namespace darboux::kernels {
namespace {

// A coordinate of a group's points from `at` on, as the formula receives it.
template <Coordinate kind, class S, class T>
Prepared<kind, S> prepared(const Source<T>& x, std::size_t at) {
  if constexpr (kind == Coordinate::linear)
    return S::load(x.values + at);
  else
    return {S::load(x.sine + at), S::load(x.cosine + at)};
}

// Lanes that are prepared together.
template <class T>
using Together = Lanes<T, std::min<std::size_t>(4, group_size<T> / Register<T>::size)>;

// Prepares a group; whether all of it may go through the formula.
template <Coordinate kind, class T>
DARBOUX_FLATTEN [[gnu::noinline]] bool prepare_group(const T* x, T* sine, T* cosine) {
  using S = Together<T>;
  bool good = true;
#pragma GCC unroll 4
  for (std::size_t i = 0; i < group_size<T>; i += S::lanes) {
    const S value = S::load(x + i);
    if constexpr (kind == Coordinate::linear) {
      good = good && (S(T(0)) <= value && value <= S(T(1))).all();
    } else {
      if constexpr (kind == Coordinate::half_turn)
        good = good && (S(T(0)) <= value && value <= S(T(1))).all();
      else
        good = good && (abs(value) < S(detail::Format<T>::most_turns)).all();
      const Turn<S> angle = prepare<kind>(value);
      angle.sin.store(sine + i);
      angle.cos.store(cosine + i);
    }
  }
  return good;
}

// For a group whose sines are not needed: the ends of a half turn, the poles, must be excluded too.
template <Coordinate kind, class T>
DARBOUX_FLATTEN [[gnu::noinline]] bool in_domain_without_sines(const T* x) {
  using S = Lanes<T, group_size<T> / Register<T>::size>;
  const S value = S::load(x);
  if constexpr (kind == Coordinate::linear || kind == Coordinate::half_turn)
    return (S(T(0)) < value && value < S(T(1))).all();
  else
    return (abs(value) < S(detail::Format<T>::most_turns)).all();
}

template <class T, class S>
void put(const Target<T>& p, Attribute a, const Vec3<S>& x) {
  put(p, a, x.x, x.y, x.z);
}

template <class S>
S components_sum(const Vec3<S>& a) {
  return a.x + a.y + a.z;
}

// Where terms of the curvatures have cancelled, takes those that the surface states; what it does not state
// is left to the single-point functions.
template <class X, class Here, class S, class PU, class PV>
void take_stated(const Here& surface, const PU& u, const PV& v, const ShapeOperator<S>& shape,
                 Curvature<S>& c) {
  const auto lost = detail::lost_digits<X>(shape, c);
  if (lost.principal.any()) S::diverge();
  if (lost.gaussian.any()) {
    if constexpr (StatesGaussianCurvature<X> && detail::curvature_in_lanes<X>)
      c.gaussian = select(lost.gaussian, S(surface.gaussian_curvature(u, v)), c.gaussian);
    else
      S::diverge();
  }
  if (lost.mean.any()) {
    if constexpr (StatesMeanCurvature<X> && detail::curvature_in_lanes<X>)
      c.mean = select(lost.mean, S(surface.mean_curvature(u, v)), c.mean);
    else
      S::diverge();
  }
}

template <Variant variant>
constexpr int order_of = variant == Variant::everything ? 2 : 1;

// One batch of points; its status. \param surface as it is there
template <class X, class T, Variant variant, class Here, class PU, class PV>
Status batch(const Target<T>& p, const Here& surface, const PU& u, const PV& v) {
  const Work<T>& w = p.work;
  using S = Batch<X, T, variant>;
  Status status = Status::regular;
  if constexpr (DeclaresSingularPoints<X>) status = surface.singular(u, v);
  Jet2<S> j;
  if constexpr (variant != Variant::frames || !HasClosedFrame<X>)
    j = detail::jet_to<order_of<variant>>(surface, u, v);
  // A partial that is not finite has its status from the single-point functions.
  if constexpr (variant != Variant::frames) {
    S sum = components_sum(j.position) + components_sum(j.dpdu) + components_sum(j.dpdv);
    if constexpr (variant == Variant::everything)
      sum = sum + (components_sum(j.d2pdu2) + components_sum(j.d2pduv) + components_sum(j.d2pdv2));
    if (!(sum - sum == S(T(0)))) S::diverge();
    put(p, Attribute::position, j.position);
    put(p, Attribute::dpdu, j.dpdu);
    put(p, Attribute::dpdv, j.dpdv);
  }
  Frame<S> frame;
  if constexpr (HasClosedFrame<X>) {
    frame = surface.frame(u, v);
    status |= frame.status;
    if (has(status, detail::degenerate) && !has(status, Status::no_frame)) status |= Status::limit_frame;
    if (has(status, Status::no_frame | Status::overflow)) S::diverge();
  } else {
    if (has(status, detail::degenerate)) S::diverge();
    frame = frame_from_partials(j.dpdu, j.dpdv);
    S condition(T(1));
    if constexpr (requires { surface.partials_condition(u, v); })
      condition = surface.partials_condition(u, v);
    if (detail::is_ill_conditioned(j, frame, condition)) S::diverge();
  }
  put(p, Attribute::tangent, frame.t);
  put(p, Attribute::bitangent, frame.b);
  put(p, Attribute::normal, frame.n);
  put(p, Attribute::handedness, frame.handedness);
  put(p, Attribute::tangent4, frame.t.x, frame.t.y, frame.t.z,
      w.raw_sign ? frame.handedness : -frame.handedness);
  if constexpr (variant == Variant::everything) {
    put(p, Attribute::d2pdu2, j.d2pdu2);
    put(p, Attribute::d2pduv, j.d2pduv);
    put(p, Attribute::d2pdv2, j.d2pdv2);
    const auto& slots = w.slots;
    const auto asked = [&](Attribute a) {
      return slots[static_cast<std::size_t>(a)].arrangement != Arrangement::absent;
    };
    const bool directions = asked(Attribute::principal_directions);
    if (asked(Attribute::gaussian_curvature) || asked(Attribute::mean_curvature) ||
        asked(Attribute::principal_curvatures) || directions) {
      if (has(status, Status::limit_frame)) S::diverge();
      frame.status = status;
      const ShapeOperator<S> shape = shape_operator(j, frame);
      Curvature<S> c = curvature(shape, frame);
      take_stated<X>(surface, u, v, shape, c);
      // Next to a pole terms may leave the range: single points then take the limit.
      if (!(c.gaussian - c.gaussian == S(0))) S::diverge();
      put(p, Attribute::gaussian_curvature, c.gaussian);
      put(p, Attribute::mean_curvature, c.mean);
      put(p, Attribute::principal_curvatures, c.principal[0], c.principal[1]);
      put(p, Attribute::principal_directions, c.directions[0].x, c.directions[0].y, c.directions[0].z,
          c.directions[1].x, c.directions[1].y, c.directions[1].z);
      if (directions) status = c.status;
    }
  }
  if (w.run_count > 0) scatter<S::lanes>(p);
  return status;
}

// One group at a time. If the last of several is incomplete, it is moved back to be complete, and so is the
// last batch of an incomplete group: some points are computed twice, with the same bits.
template <class X, class T, Variant variant>
DARBOUX_FLATTEN bool kernel(const Work<T>& w) {
  using S = Batch<X, T, variant>;
  constexpr std::size_t W = S::lanes, G = group_size<T>;
  const X& surface = *static_cast<const X*>(w.surface);
  alignas(64) T sine_u[G], cosine_u[G], sine_v[G], cosine_v[G];
  if (!w.v_is_needed)  // any value except a pole
    for (std::size_t i = 0; i < G; ++i) sine_v[i] = T(1), cosine_v[i] = T(0);
  const auto& in_rows = surface_in_rows<order_of<variant>, S>(surface, w.v.step == 0 ? w.v.values : nullptr);
  // Of a curve along v: the surface where it is, the same for all of a row.
  using AtPlace = decltype(detail::at_place<order_of<variant>>(
      in_rows, std::declval<Prepared<X::info.u, S>>(), std::declval<Prepared<X::info.v, S>>()));
  [[maybe_unused]] std::optional<
      std::conditional_t<detail::HasCurveAlong<X, 1>, std::remove_cvref_t<AtPlace>, bool>>
      row;
  [[maybe_unused]] bool row_diverged = false;
  bool any_status = false;
  for (std::size_t first = 0; first < w.count; first += G) {
    const bool whole = first + G <= w.count;
    const std::size_t begin = whole || w.count < G ? first : w.count - G;
    const std::size_t n = w.count < G ? w.count : G;
    Source<T> u = w.u.from(begin), v = w.v.from(begin);
    bool good = true;
    if (!w.in_domain) {
      good = prepare_group<X::info.u>(u.values, sine_u, cosine_u);
      u.sine = sine_u, u.cosine = cosine_u;
      if (w.v_is_needed)
        good = prepare_group<X::info.v>(v.values, sine_v, cosine_v) && good;
      else
        good = in_domain_without_sines<X::info.v>(v.values) && good;
      v.sine = sine_v, v.cosine = cosine_v;
    }
    if (!good) {
      w.scalar_fallback(w.context, begin, n);
      any_status = true;
    } else {
      for (std::size_t i = 0; i < n; i += W) {
        const std::size_t at = i + W <= n ? i : n - W;
        diverged = false;
        const auto at_u = prepared<X::info.u, S>(u, at);
        const auto at_v = prepared<X::info.v, S>(v, at);
        const Target<T> target{w, begin + at, w.past_caches && whole};
        const auto here = [&]() -> decltype(auto) {
          return detail::at_place<order_of<variant>>(in_rows, at_u, at_v);
        };
        Status status;
        if constexpr (detail::HasCurveAlong<X, 1>) {
          if (!row || w.v.step != 0) row.emplace(here()), row_diverged = diverged;
          diverged = row_diverged;
          status = batch<X, T, variant>(target, *row, at_u, at_v);
        } else {
          status = batch<X, T, variant>(target, here(), at_u, at_v);
        }
        if (diverged) {
          w.scalar_fallback(w.context, begin + at, W);
          any_status = true;
        } else if (status != Status::regular) {
          for (std::size_t k = 0; k < W; ++k) w.status[begin + at + k] = static_cast<std::uint32_t>(status);
          any_status = true;
        }
      }
    }
  }
  return any_status;
}

}  // namespace
}  // namespace darboux::kernels
