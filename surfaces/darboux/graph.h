/// \file graph.h
#pragma once

#include <array>
#include <concepts>
#include <string>
#include <string_view>
#include <utility>

#include <darboux/curve.h>
#include <darboux/surface.h>

namespace darboux {

/// The value of a function of x and y with its partial derivatives.
template <class S>
struct FunctionJet {
  S f, fx, fy, fxx, fxy, fyy;
};

/// The round hill h / (1 + (x² + y²)/w²): height h, half of it at the distance w.
template <class T = double>
struct RoundHill {
  T height{0.5}, width{0.5};

  template <class S>
  S operator()(const S& x, const S& y) const {
    const S w = lift<S>(width), X = x / w, Y = y / w;
    return lift<S>(height) / (lift<S>(1.0) + (X * X + Y * Y));
  }
  template <class S>
  FunctionJet<S> jet(const S& x, const S& y) const {
    const S h = lift<S>(height), w = lift<S>(width), two = lift<S>(2.0), four = lift<S>(4.0);
    const S X = x / w, Y = y / w, q = lift<S>(1.0) + (X * X + Y * Y);
    const S a = X / q, b = Y / q, f = h / q, slope = two * (f / w), bend = slope / w;
    return {f,
            -(slope * a),
            -(slope * b),
            bend * ((four * (X * a) - lift<S>(1.0)) / q),
            bend * (four * (a * b)),
            bend * ((four * (Y * b) - lift<S>(1.0)) / q)};
  }
  template <class To>
  auto rebind() const {
    return RoundHill<To>{lift<To>(height), lift<To>(width)};
  }
};

/// Graph of a function over a rectangle.
///   P(u, v) = (x, y, f(x, y)),  x = (1 - u) x0 + u x1,  y = (1 - v) y0 + v y1
/// u runs along x, v along y. n = (-f_x, -f_y, 1)/sqrt(1 + f_x² + f_y²) points up. Regular everywhere. The
/// function is an object f(x, y) for any scalar. Its derivatives come from a member jet(x, y) that returns a
/// FunctionJet, if it has one, else from nested dual numbers, exact to rounding:
///   Graph surface{[](const auto& x, const auto& y) { return x * x - y * y; }, -1.0, 1.0, -1.0, 1.0};
/// Exceptions of the function propagate; where a derivative is NaN or infinite there is no frame
/// (no_frame, overflow). Frame components err by at most 4u (1 + condition), u the unit roundoff, the
/// condition that of f_x and f_y in u and v. [doCarmo2016, sec. 3-3]
template <class F = RoundHill<double>, class T = double>
struct Graph {
  using scalar = T;
  F f{};
  T x0{-1}, x1{1}, y0{-1}, y1{1};

  static constexpr SurfaceInfo info{"graph", "graph of a function over a rectangle", Coordinate::linear,
                                    Coordinate::linear};
  static constexpr auto parameters() {
    constexpr Magnitudes m{1e-3, 1e3};
    constexpr auto x0_ = parameter<&Graph::x0>("x0", Range{}, "x at u = 0; length", m),
                   x1_ = parameter<&Graph::x1>("x1", Range{}, "x at u = 1, above x0; length", m),
                   y0_ = parameter<&Graph::y0>("y0", Range{}, "y at v = 0; length", m),
                   y1_ = parameter<&Graph::y1>("y1", Range{}, "y at v = 1, above y0; length", m);
    if constexpr (std::same_as<F, RoundHill<T>>)
      return std::array{
          x0_,
          x1_,
          y0_,
          y1_,
          parameter<&Graph::f, &F::height>("height", Range{}, "height of the hill; length"),
          parameter<&Graph::f, &F::width>("width", Range::positive(),
                                          "distance at which half the height is left; length", m)};
    else
      return std::array{x0_, x1_, y0_, y1_};
  }
  std::string refusal() const {
    const auto wrong = [](std::string_view name, const T& a, const T& b) {
      return std::string(name) + "0: expected less than " + std::string(name) + "1 = " + detail::text_of(b) +
             ", got " + detail::text_of(a);
    };
    if (!(x0 < x1)) return wrong("x", x0, x1);
    if (!(y0 < y1)) return wrong("y", y0, y1);
    return {};
  }

  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), dx = lift<S>(x1) - lift<S>(x0), dy = lift<S>(y1) - lift<S>(y0);
    const auto [x, y] = place(u, v);
    const FunctionJet<S> g = function_jet(x, y);
    return {.position = {x, y, g.f},
            .dpdu = {dx, zero, dx * g.fx},
            .dpdv = {zero, dy, dy * g.fy},
            .d2pdu2 = {zero, zero, dx * (dx * g.fxx)},
            .d2pduv = {zero, zero, dx * (dy * g.fxy)},
            .d2pdv2 = {zero, zero, dy * (dy * g.fyy)}};
  }

  template <class S>
  Frame<S> frame(const S& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0);
    const auto [x, y] = place(u, v);
    const FunctionJet<S> g = function_jet(x, y);
    const Vec2<S> along = unit(Vec2<S>{one, g.fx});
    const S length = norm(Vec2<S>{one, g.fx});
    Frame<S> frame{.t = {along.x, zero, along.y},
                   .b = unit(Vec3<S>{-(along.y * g.fy), length, along.x * g.fy}),
                   .n = unit(Vec3<S>{-g.fx, -g.fy, one})};
    if (!finite(g.fx) || !finite(g.fy)) {
      frame = detail::no_frame<S>();
      frame.status |= Status::overflow;
    }
    return frame;
  }

  /// (z - f(x, y)) / sqrt(1 + f_x² + f_y²)
  template <class S>
  S implicit(const Vec3<S>& p) const {
    const FunctionJet<S> g = function_jet(p.x, p.y);
    return (p.z - f(p.x, p.y)) / norm(Vec3<S>{g.fx, g.fy, lift<S>(1.0)});
  }
  /// K = (f_xx f_yy - f_xy²)/(1 + f_x² + f_y²)² [doCarmo2016, sec. 3-3]
  template <class S>
  S gaussian_curvature(const S& u, const S& v) const {
    const auto [x, y] = place(u, v);
    const FunctionJet<S> g = function_jet(x, y);
    const S w = lift<S>(1.0) + (g.fx * g.fx + g.fy * g.fy), m = g.fxy / w;
    return (g.fxx / w) * (g.fyy / w) - m * m;
  }
  /// H = ((1 + f_y²) f_xx - 2 f_x f_y f_xy + (1 + f_x²) f_yy)/(2 (1 + f_x² + f_y²)^(3/2))
  /// [doCarmo2016, sec. 3-3]
  template <class S>
  S mean_curvature(const S& u, const S& v) const {
    using std::sqrt;
    const auto [x, y] = place(u, v);
    const FunctionJet<S> g = function_jet(x, y);
    const S one = lift<S>(1.0), two = lift<S>(2.0), a = g.fx * g.fx, b = g.fy * g.fy, w = one + (a + b);
    return ((one + b) * g.fxx - two * (g.fx * g.fy) * g.fxy + (one + a) * g.fyy) / (two * w * sqrt(w));
  }
  /// From the middle of the rectangle, (u - 1/2) and (v - 1/2) of its sides away.
  template <class S>
  Vec3<S> second_formula(const S& u, const S& v) const {
    const S half = lift<S>(0.5), a = lift<S>(x0), b = lift<S>(x1), c = lift<S>(y0), d = lift<S>(y1);
    const S x = half * (a + b) + (u - half) * (b - a), y = half * (c + d) + (v - half) * (d - c);
    return {x, y, f(x, y)};
  }

  /// The same graph over another scalar; a function without data of its own stays as it is.
  template <class To>
  auto rebind() const {
    auto rebound = detail::rebound<To>(f);
    return Graph<decltype(rebound), To>{std::move(rebound), lift<To>(x0), lift<To>(x1), lift<To>(y0),
                                        lift<To>(y1)};
  }

 private:
  template <class S>
  Vec2<S> place(const S& u, const S& v) const {
    const S one = lift<S>(1.0);
    return {(one - u) * lift<S>(x0) + u * lift<S>(x1), (one - v) * lift<S>(y0) + v * lift<S>(y1)};
  }
  template <class S>
  FunctionJet<S> function_jet(const S& x, const S& y) const {
    if constexpr (requires { f.jet(x, y); }) {
      return f.jet(x, y);
    } else {
      using D = Dual<S, 2>;
      using D2 = Dual<D, 2>;
      const D2 g = f(D2::variable(D::variable(x, 0), 0), D2::variable(D::variable(y, 1), 1));
      return {g.value.value,
              g.derivative[0].value,
              g.derivative[1].value,
              g.derivative[0].derivative[0],
              g.derivative[0].derivative[1],
              g.derivative[1].derivative[1]};
    }
  }
  // x - x is zero for a finite x only
  template <class S>
  static bool finite(const S& x) {
    return detail::equal(S(x - x), lift<S>(0.0)) && x - x == x - x;
  }
};
template <class F>
Graph(F) -> Graph<F>;
template <class F, class T>
Graph(F, T, T, T, T) -> Graph<F, T>;

}  // namespace darboux
