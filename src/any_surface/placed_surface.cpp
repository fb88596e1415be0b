#include <cmath>
#include <optional>

#include <darboux/frame.h>
#include <darboux/placed_surface.h>

#include "base/flatten.h"

namespace darboux {
namespace {

// M row by row, then the offset: a flip replaces the stored coordinate x by 1 - x; a swap exchanges the two
// afterwards.
constexpr UvConvention conventions[] = {
    {"as stored", {1, 0, 0, 1, 0, 0}},    {"flip v", {1, 0, 0, -1, 0, 1}},
    {"flip u", {-1, 0, 0, 1, 1, 0}},      {"flip both", {-1, 0, 0, -1, 1, 1}},
    {"swap", {0, 1, 1, 0, 0, 0}},         {"swap flip v", {0, -1, 1, 0, 1, 0}},
    {"swap flip u", {0, 1, -1, 0, 0, 1}}, {"swap flip both", {0, -1, -1, 0, 1, 1}},
};

constexpr Status singular = Status::dpdu_zero | Status::dpdv_zero | Status::parallel;

double rounded_to_quarter(double x) {
  const double rounded = std::rint(4 * x) / 4;
  return std::fabs(x - rounded) < 1e-6 ? rounded : x;
}

// How far in v a uv may be from a pole and still mean it: four roundings of uvs stored as floats, or a
// millionth.
double pole_tolerance(const UvConvention& uv, const Vec2<double>& stored) {
  const auto& m = uv.affine;
  return std::fmax(1e-6,
                   0x1p-22 * (std::fabs(m[2] * stored.x) + std::fabs(m[3] * stored.y) + std::fabs(m[5])));
}

}  // namespace

std::span<const UvConvention> uv_conventions() {
  return conventions;
}

Vec3<double> PlacedSurface::position(const Vec2<double>& stored) const {
  const Vec2<double> p = uv.surface_uv(stored);
  return from_eigen(placement * to_eigen(surface.jet(p.x, p.y).position));
}

Truth PlacedSurface::truth(const Vec2<double>& stored) const {
  const Vec2<double> p = uv.surface_uv(stored);
  return truth(stored, surface.sample(p.x, p.y));
}

DARBOUX_FLATTEN Truth PlacedSurface::truth(const Vec2<double>& stored, const Sample<double>& at) const {
  const Vec2<double> p = uv.surface_uv(stored);
  // A uv that misses a pole by rounding means the pole, since next to it dpdu may point either way.
  const Vec2<double> rounded{rounded_to_quarter(p.x), rounded_to_quarter(p.y)};
  std::optional<Sample<double>> other;
  if (rounded != p) other = surface.sample(rounded.x, rounded.y);
  if (other && !has(other->frame.status, singular)) other.reset();
  Vec3<double> n = other ? other->frame.n : at.frame.n;
  const double tolerance = pole_tolerance(uv, stored);
  const bool rounded_off =
      !other && !has(at.frame.status, singular) && norm(at.jet.dpdu) < tolerance * norm(at.jet.d2pduv);
  if (rounded_off) {
    // Within its rounding a disk's inner radius, and so dpdu, may have either sign; next to the pole its sign
    // is definite.
    const double step = 2 * tolerance;
    other = surface.sample(p.x, p.y + (p.y < 0.5 ? step : -step));
    if (dot(n, other->frame.n) < 0) n = other->frame.n;
  }
  const Sample<double>& s = other ? *other : at;
  const Frame<double>& frame = s.frame;
  // The derivative along (a, b) in (u, v). If one partial vanishes, the other decides; if only the vanishing
  // one is requested, its limit direction does.
  const auto along = [&](double a, double b) {
    if (rounded_off || has(frame.status, Status::dpdu_zero))
      return b == 0 ? std::copysign(1.0, a) * frame.t : b * s.jet.dpdv;
    if (has(frame.status, Status::dpdv_zero))
      return a == 0 ? std::copysign(1.0, b) * frame.handedness * frame.b : a * s.jet.dpdu;
    return a * s.jet.dpdu + b * s.jet.dpdv;
  };
  const auto& m = uv.affine;
  const auto rotation = placement.linear();
  const auto placed = [&](const Vec3<double>& a) { return from_eigen(rotation * to_eigen(a)); };
  return {from_eigen(placement * to_eigen(at.jet.position)),
          placed(n),
          placed(unit(along(m[0], m[2]))),
          placed(unit(along(m[1], m[3]))),
          frame.status,
          rounded_off || has(frame.status, singular)};
}

}  // namespace darboux
