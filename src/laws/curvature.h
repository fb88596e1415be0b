// Common code of the laws of curvature: the facts that a surface states about it, and the theorems.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <darboux/curvature.h>
#include <darboux/shape_operator.h>

#include "law.h"

namespace darboux::laws {

// The data of a point for the laws of curvature, and the sizes of the terms to which rounding is relative.
struct Curved {
  Curvature<double> c;
  ShapeOperator<double> s;
  double a, m, cc;  // bounds of the sizes of the terms in the shape operator's entries
  double condition;

  explicit Curved(const Point& p) : c(curvature(p.j, p.f)), s(shape_operator(p.j, p.f)) {
    const double e = std::fabs(s.e), g = std::fabs(s.g), slant = 1 + std::fabs(s.f / s.g);
    a = norm(p.j.d2pdu2) / e / e;
    m = (norm(p.j.d2pduv) / e + std::fabs(s.f) * a) / g;
    cc = (norm(p.j.d2pdv2) / g + std::fabs(s.f) * (a * std::fabs(s.f / s.g) + 2 * m)) / g;
    condition = slant * (1 + *std::max_element(p.condition.begin(), p.condition.end()));
  }
  // Each entry is a quotient of dot products of partials, within 8u (1 + condition) each; the frame adds as
  // much.
  double gaussian_error() const { return 64 * unit_roundoff * condition * (a * cc + m * m); }
  double mean_error() const { return 64 * unit_roundoff * condition * (a + cc); }
};

// A fact or theorem as one number per point: the values of both sides, and the error that rounding explains.
struct Pair {
  double u, v, one, other, error;
};
// The scale is the largest value, or the given one where that is larger.
inline Check compared(const Points& points, std::string_view route, std::string_view quantity,
                      const std::vector<Pair>& pairs, double scale, std::string_view not_stated = {}) {
  Law law(points.name, route, quantity);
  for (const Pair& p : pairs)
    if (std::isfinite(p.one)) scale = std::fmax(scale, std::fabs(p.one));
  for (const Pair& p : pairs) {
    const double bound = p.error / scale + 8 * unit_roundoff;
    if (bound <= worst_estimate) law.compare(std::fabs(p.one - p.other) / scale, bound, p.u, p.v);
  }
  return law.result(not_stated.empty() ? "rounding would explain an error above 1e-6 everywhere"
                                       : not_stated);
}

inline bool curvable(const Point& p) {
  return !has(p.f.status, Status::limit_frame | Status::no_frame | Status::overflow);
}

}  // namespace darboux::laws
