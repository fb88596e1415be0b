/// \file limit.h
/// The limit of a frame at points where the partials give none: poles, collapsed edges, cusps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

#include <darboux/frame.h>
#include <darboux/surface.h>

namespace darboux {

namespace detail {

// The Taylor series of a partial along one coordinate: the sum of the k-th vector times h^k. Unknown
// coefficients are zero.
template <class S>
using Taylor = std::array<Vec3<S>, 4>;

// Whether a sum exceeds the rounding error of terms of this size.
template <std::floating_point S>
bool above_rounding(const Vec3<S>& sum, S size) {
  return norm(sum) > S(32) * std::numeric_limits<S>::epsilon() * size;
}

// A frame in the one-sided limit h -> 0, with the series of the partials from which it is computed.
template <std::floating_point S>
struct Limit {
  Taylor<S> dpdu{}, dpdv{};
  S side = 1;  // the sign of h
  Frame<S> frame = no_frame<S>();

  bool found() const { return !has(frame.status, Status::no_frame); }
  // The unit vector to which the direction of x dpdu + y dpdv tends; zero if the series do not determine it.
  Vec3<S> direction(S x, S y) const {
    for (std::size_t k = 0; k < dpdu.size(); ++k) {
      const Vec3<S> sum = x * dpdu[k] + y * dpdv[k];
      if (above_rounding(sum, std::fabs(x) * norm(dpdu[k]) + std::fabs(y) * norm(dpdv[k])))
        return (k % 2 == 1 ? side : S(1)) * unit(sum);
    }
    return {};
  }
};

template <class S>
std::size_t first_that_is_not_zero(const Taylor<S>& a) {
  std::size_t k = 0;
  while (k < a.size() && a[k] == Vec3<S>{}) ++k;
  return k;
}

// The limit of series of which the first `terms` are known. Let a_k and b_l be the first non-zero
// coefficients of dpdu and dpdv. t is along a_k, and n along the first non-zero coefficient of dpdu × dpdv:
// a_k × b_l; if these are parallel, the sum of the two cross products of the next order; and so on as far as
// the series reach. Odd powers change sign with h. If that flips the frame, an interior point has the bit
// `crease`. \param why which partials are known to vanish at h = 0, whatever rounding left of them \param
// inner whether h may have both signs
template <std::floating_point S>
void take_limit(Limit<S>& limit, std::size_t terms, Status why, bool inner) {
  if (has(why, Status::dpdu_zero)) limit.dpdu[0] = {};
  if (has(why, Status::dpdv_zero)) limit.dpdv[0] = {};
  const std::size_t k = first_that_is_not_zero(limit.dpdu), l = first_that_is_not_zero(limit.dpdv);
  if (k >= terms || l >= terms) return;
  Taylor<S> a = limit.dpdu, b = limit.dpdv;
  for (std::size_t i = 0; i < terms; ++i) {
    a[i] = scaled_by_power_of_two(a[i], -exponent(limit.dpdu[k]));
    b[i] = scaled_by_power_of_two(b[i], -exponent(limit.dpdv[l]));
  }
  const bool parallel = has(why, Status::parallel) && k + l == 0;
  for (std::size_t m = parallel ? 1 : 0; m + std::max(k, l) < terms; ++m) {
    Vec3<S> normal{};
    S size = 0;
    for (std::size_t i = 0; i <= m; ++i) {
      const Vec3<S>&x = a[k + i], &y = b[l + m - i];
      normal += accurate_cross(x, y);
      size += norm(x) * norm(y);
    }
    if (!above_rounding(normal, size)) continue;
    const bool t_turns = k % 2 == 1, n_turns = (k + l + m) % 2 == 1;
    const Vec3<S> t = (t_turns ? limit.side : S(1)) * unit(a[k]),
                  n = (n_turns ? limit.side : S(1)) * unit(normal);
    if (!finite(t) || !finite(n)) return;
    limit.frame = {t, accurate_cross(n, t), n, S(1), Status::limit_frame};
    if (inner && (t_turns || n_turns)) limit.frame.status |= Status::crease;
    return;
  }
}

// The Taylor series of the partials along u (along = 0) or v (1), from triply nested dual numbers in that
// coordinate.
template <int along, class S, class X, class PU, class PV>
std::pair<Taylor<S>, Taylor<S>> series_of_partials(const X& surface, const PU& u, const PV& v) {
  using D3 = ThreeTimesDual<S>;
  const Jet2<D3> j = [&] {
    if constexpr (along == 0)
      return surface.jet(three_times_variable(u, X::info.u), as_constant<D3>(v));
    else
      return surface.jet(as_constant<D3>(u), three_times_variable(v, X::info.v));
  }();
  const auto coefficients = [](const Vec3<D3>& a) {
    const auto each = [&](auto of) { return Vec3<S>{of(a.x), of(a.y), of(a.z)}; };
    return Taylor<S>{each([](const D3& x) { return x.value.value.value; }),
                     each([](const D3& x) { return x.derivative[0].value.value; }),
                     each([](const D3& x) { return x.derivative[0].derivative[0].value / S(2); }),
                     each([](const D3& x) { return x.derivative[0].derivative[0].derivative[0] / S(6); })};
  };
  return {coefficients(j.dpdu), coefficients(j.dpdv)};
}

// The limit along one coordinate, from above; from below at the upper end. Uses the second partials of the
// jet and, if they do not determine it, third-order series.
template <int along, std::floating_point S, class X, class PU, class PV>
Limit<S> limit_along(const X& surface, const Jet2<S>& j, Status why, const PU& u, const PV& v) {
  const bool inner = along == 0 ? within<X::info.u>(u) : within<X::info.v>(v);
  const bool from_below = along == 0 ? at_upper_end<X::info.u>(u) : at_upper_end<X::info.v>(v);
  Limit<S> result{{j.dpdu, along == 0 ? j.d2pdu2 : j.d2pduv},
                  {j.dpdv, along == 0 ? j.d2pduv : j.d2pdv2},
                  from_below ? S(-1) : S(1)};
  take_limit(result, 2, why, inner);
  using D = ThreeTimesDual<S>;
  if constexpr (requires(const Prepared<X::info.u, D>& du, const Prepared<X::info.v, D>& dv) {
                  surface.jet(du, dv);
                })
    if (!result.found()) {
      std::tie(result.dpdu, result.dpdv) = series_of_partials<along, S>(surface, u, v);
      take_limit(result, 4, why, inner);
    }
  return result;
}

// The limit at a point where the partials give no frame: along v at the given u; if only dpdv vanishes, along
// u at the given v. If that limit does not exist (a whole line of singular points passes through this one, or
// the series are too short), it is the limit along the other coordinate. If both partials vanish and the two
// limits differ, there is none. If the partials are parallel and the limits differ, the status is `crease`.
template <std::floating_point S, class X, class PU, class PV>
Limit<S> limit_at(const X& surface, const Jet2<S>& j, Status why, const PU& u, const PV& v) {
  const bool both = has(why, Status::dpdu_zero) && has(why, Status::dpdv_zero);
  const bool one = !both && has(why, Status::dpdu_zero | Status::dpdv_zero);
  const bool u_first = one && has(why, Status::dpdv_zero);
  const auto along = [&](bool with_u) {
    return with_u ? limit_along<0>(surface, j, why, u, v) : limit_along<1>(surface, j, why, u, v);
  };
  Limit<S> first = along(u_first);
  if (first.found() && one) return first;
  const Limit<S> second = along(!u_first);
  if (!first.found() || !second.found()) return first.found() ? first : second;
  first.frame.status |= second.frame.status & Status::crease;
  const S difference = norm(first.frame.t - second.frame.t) + norm(first.frame.n - second.frame.n);
  if (difference * difference <= std::numeric_limits<S>::epsilon()) return first;
  if (both)
    first.frame = no_frame<S>();
  else
    first.frame.status |= Status::crease;
  return first;
}

}  // namespace detail

}  // namespace darboux
