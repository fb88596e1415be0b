// P(u, v) as a polynomial through the neighbours of a point, over a number type as in least_squares.h.
#pragma once

#include <limits>

#include <darboux/frame.h>
#include <darboux/surface.h>

#include "least_squares.h"

namespace darboux {

template <class S>
struct UvFitResult {
  S sized;  // 1 where the neighbours have an extent, not subnormal, in space and in both coordinates; else
            // there is nothing
  S condition, residual_rms;
  Jet2<S> jet;  // its position relative to the origin of the given ones
  Frame<S> frame;
  S dpdu_error, dpdv_error, tangent_error, normal_error;
};

template <int degree, class S>
class UvFit {
 public:
  using Fit = LeastSquares<degree, 3, S>;

  // Of n neighbours, to be filled in by the caller: the square roots of their weights, uvs relative to the
  // query, and positions relative to any point near it. One that is all zero has no effect.
  auto* resize(std::size_t n) {
    n_ = n;
    return given_ = fit_.resize(n);
  }

  // \param count of the neighbours \param total the sum of their weights
  UvFitResult<S> solve(const S& count, const S& total) {
    const S two(2);
    const Scaling scaling = normalise();
    UvFitResult<S> result;
    result.sized = scaling.sized;
    fit_.solve(count, total);
    result.condition = fit_.condition();
    result.residual_rms = scaling.radius * fit_.residual_rms();

    const S a00 = scaling.per_u * scaling.b00, a10 = scaling.per_u * scaling.b10,
            a11 = scaling.per_v * scaling.b11;
    Vec3<S> c[Fit::jet];
    for (int k = 0; k < Fit::jet; ++k)
      c[k] = {scaling.radius * fit_.coefficient(k, 0), scaling.radius * fit_.coefficient(k, 1),
              scaling.radius * fit_.coefficient(k, 2)};
    const Vec3<S> dpdu = a00 * c[1] + a10 * c[2], dpdv = a11 * c[2];
    result.jet = {c[0],
                  dpdu,
                  dpdv,
                  two * a00 * a00 * c[3] + two * a00 * a10 * c[4] + two * a10 * a10 * c[5],
                  a00 * a11 * c[4] + two * a10 * a11 * c[5],
                  two * a11 * a11 * c[5]};
    result.frame = frame_from_partials(dpdu, dpdv);

    set_errors(scaling, result);
    return result;
  }

 private:
  // Coordinates (x, y) = A (u, v) whose columns are orthonormal but for a common factor: a chart that is
  // stretched or sheared gives the same ones. A = [[b00, 0], [b10, b11]] diag(per_u, per_v); positions are
  // divided by radius.
  struct Scaling {
    S sized, per_u, per_v, radius, b00, b10, b11;
  };

  // Transforms the neighbours to these coordinates.
  Scaling normalise() {
    using std::sqrt;
    const S one(1);
    S u_size(0), v_size(0), radius(0);
    for (std::size_t i = 0; i < n_; ++i) {
      u_size = larger(u_size, given_[i].x);
      v_size = larger(v_size, given_[i].y);
      for (const S& value : given_[i].values) radius = larger(radius, value);
    }
    S xx(0), xy(0), before(0), yy(0), size(0);
    const S per_u = one / u_size, per_v = one / v_size;
    for (std::size_t i = 0; i < n_; ++i) {
      S &x = given_[i].x, &y = given_[i].y;
      x = x * per_u;
      y = y * per_v;
      xx = xx + x * x;
      xy = xy + x * y;
      before = before + y * y;
    }
    const S slope = xy / xx;
    xx = sqrt(xx);
    for (std::size_t i = 0; i < n_; ++i) {
      S& y = given_[i].y;
      y = y - slope * given_[i].x;
      yy = yy + y * y;
    }
    yy = sqrt(yy);
    const S per_xx = one / xx, per_yy = one / yy;
    for (std::size_t i = 0; i < n_; ++i) {
      S &x = given_[i].x, &y = given_[i].y;
      x = x * per_xx;
      y = y * per_yy;
      size = larger(size, x * x + y * y);
    }
    size = sqrt(size);
    const S per_size = one / size, per_radius = one / radius;
    for (std::size_t i = 0; i < n_; ++i) {
      given_[i].x = given_[i].x * per_size;
      given_[i].y = given_[i].y * per_size;
      for (S& value : given_[i].values) value = value * per_radius;
    }
    const S infinite(std::numeric_limits<double>::infinity());
    const S sized = select(per_u < infinite && per_v < infinite && per_radius < infinite &&
                               yy * S(Fit::worst_condition) > sqrt(before),
                           one, S(0));
    // Without the units of u and v, whose squares may overflow.
    const S b00 = per_xx * per_size, b11 = per_yy * per_size;
    return {sized, per_u, per_v, radius, b00, -slope * b11, b11};
  }

  void set_errors(const Scaling& scaling, UvFitResult<S>& result) const {
    using std::sqrt;
    const S zero(0), one(1);
    using Gain = typename Fit::Gain;
    const auto error = [this](const Gain& gain, const Vec3<S>& s) {
      const S components[] = {s.x, s.y, s.z};
      return fit_.error(gain, components);
    };
    const auto length_error = [&](const Gain& gain) {
      return sqrt(S(error(gain, {one, zero, zero}) + error(gain, {zero, one, zero}) +
                    error(gain, {zero, zero, one})));
    };
    const Gain of_dpdu = fit_.gain({{zero, scaling.b00, scaling.b10, zero, zero, zero}}),
               of_dpdv = fit_.gain({{zero, zero, scaling.b11, zero, zero, zero}});
    const S u_unit = scaling.radius * scaling.per_u, v_unit = scaling.radius * scaling.per_v;
    result.dpdu_error = u_unit * length_error(of_dpdu);
    result.dpdv_error = v_unit * length_error(of_dpdv);
    // δt = (b b·δdpdu + n n·δdpdu)/|dpdu|; δn = -Σ r n·δdp over u and v, with r the gradients
    // of u and v in the surface.
    const Vec3<S>&t = result.frame.t, &b = result.frame.b, &n = result.frame.n;
    const S e = dot(result.jet.dpdu, t), f = dot(result.jet.dpdv, t), g = dot(result.jet.dpdv, b);
    const S per_e = u_unit / e, per_g = v_unit / g, shear = f / g;
    Gain along_t, along_b;
    for (int k = 0; k < Fit::M; ++k) {
      along_t.of[k] = per_e * of_dpdu.of[k];
      along_b.of[k] = per_g * of_dpdv.of[k] - shear * along_t.of[k];
    }
    result.tangent_error = sqrt(S(error(along_t, b) + error(along_t, n)));
    result.normal_error = sqrt(S(error(along_t, n) + error(along_b, n)));
  }

  static S larger(const S& most, const S& x) {
    using std::abs;
    const S size = abs(x);
    return select(size > most, size, most);
  }

  std::size_t n_ = 0;
  typename Fit::Given* given_ = nullptr;
  Fit fit_;
};

}  // namespace darboux
