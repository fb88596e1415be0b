#include "closed_foot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <darboux/catalogue.h>

namespace darboux {
namespace {

constexpr double tau = 2 * std::numbers::pi;

double turns(double y, double x) {
  const double turn = std::atan2(y, x) / tau;
  return turn < 0 ? turn + 1 : turn;
}

Vec2<double> foot(const Sphere<>&, const Vec3<double>& p) {
  return {turns(p.y, p.x), std::atan2(std::hypot(p.x, p.y), -p.z) / std::numbers::pi};
}

Vec2<double> foot(const Cylinder<>& s, const Vec3<double>& p) {
  return {turns(p.y, p.x), p.z / s.height};
}

Vec2<double> foot(const Cone<>& s, const Vec3<double>& p) {
  const double length = std::hypot(s.radius, s.height), across = s.radius / length, along = s.height / length;
  const double v = ((s.radius - std::hypot(p.x, p.y)) * across + p.z * along) / length;
  return {turns(p.y, p.x), std::fmin(v, 1)};
}

Vec2<double> foot(const Torus<>& s, const Vec3<double>& p) {
  const double rho = std::hypot(p.x, p.y);
  const double near = std::hypot(rho - s.major_radius, p.z) - s.minor_radius,
               far = std::hypot(rho + s.major_radius, p.z) - s.minor_radius;
  // The inner part of a spindle torus, of the tube's far side.
  if (std::fabs(far) < std::fabs(near)) return {turns(-p.y, -p.x), turns(p.z, -rho - s.major_radius)};
  return {turns(p.y, p.x), turns(p.z, rho - s.major_radius)};
}

Vec2<double> foot(const Plane<>& s, const Vec3<double>& p) {
  return {p.x / s.width + 0.5, p.y / s.depth + 0.5};
}

// The foot is x_i = e_i² p_i / (e_i² + t) with t the largest root of F(t) = Σ (e_i p_i / (e_i² + t))² - 1,
// convex and falling there: Newton's steps from the left end of its interval never pass it.
Vec2<double> foot(const Ellipsoid<>& s, const Vec3<double>& p) {
  const double size = std::max({s.semi_axis_x, s.semi_axis_y, s.semi_axis_z});
  const std::array<double, 3> e{s.semi_axis_x / size, s.semi_axis_y / size, s.semi_axis_z / size};
  const std::array<double, 3> y{p.x / size, p.y / size, p.z / size};
  const auto least = static_cast<std::size_t>(std::min_element(e.begin(), e.end()) - e.begin());
  // shift = t + the square of the least semi-axis, which next to the plane of the others is far smaller than
  // t.
  const auto over = [&](std::size_t i, double shift) {
    return (e[i] - e[least]) * (e[i] + e[least]) + shift;
  };
  const auto term = [&](std::size_t i, double shift) { return y[i] == 0 ? 0 : e[i] * y[i] / over(i, shift); };
  std::array<double, 3> q;  // the foot, over the semi-axes
  double beside = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (i != least) beside += term(i, 0) * term(i, 0);
  if (y[least] == 0 && beside <= 1) {
    // In the plane of the two greater axes, within the focal ellipse: either of two feet.
    for (std::size_t i = 0; i < 3; ++i) q[i] = term(i, 0);
    q[least] = std::sqrt(1 - beside);
  } else {
    double root = e[least] * std::fabs(y[least]);
    for (int step = 0; step < 100; ++step) {
      double f = -1, slope = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double x = term(i, root);
        f += x * x;
        if (x != 0) slope -= 2 * x * x / over(i, root);
      }
      const double next = root - f / slope;
      if (!(next > root)) break;
      root = next;
    }
    for (std::size_t i = 0; i < 3; ++i) q[i] = term(i, root);
  }
  return {turns(q[1], q[0]), std::atan2(std::hypot(q[0], q[1]), -q[2]) / std::numbers::pi};
}

}  // namespace

std::optional<Vec2<double>> closed_foot(const AnySurface& surface, const Vec3<double>& p) {
  std::optional<Vec2<double>> result;
  const auto is = [&]<class X>(const X*) {
    if (&surface.info() != &X::info) return false;
    if (const X* held = surface.get<X>()) result = foot(*held, p);
    return true;
  };
  const auto any = [&]<class... Surfaces>(SurfaceList<Surfaces...>) {
    (is(static_cast<const Surfaces*>(nullptr)) || ...);
  };
  any(SurfaceList<Sphere<>, Cylinder<>, Cone<>, Torus<>, Plane<>, Ellipsoid<>>{});
  return result;
}

}  // namespace darboux
