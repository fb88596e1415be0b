// Surfaces that adaptors make of others, and how they come from them.
#pragma once

#include <array>
#include <ostream>
#include <string>
#include <vector>

#include <darboux/catalogue.h>
#include <darboux/offset.h>
#include <darboux/placed.h>
#include <darboux/reparametrised.h>
#include <darboux/testing.h>

#include "compare_frames.h"
#include "every_surface.h"
#include "thinning.h"

namespace darboux::test {

// The sign of det(dpdu, dpdv, n).
inline double det_sign(const Jet2<double>& j, const Vec3<double>& n) {
  return dot(cross(unit(j.dpdu), unit(j.dpdv)), n) < 0 ? -1 : 1;
}

using Linear = std::array<double, 9>;
// A rotation by 36.87 degrees about z after one by 90 about x, to the last bit; a non-uniform map; a mirror.
inline constexpr Linear rotation{0.6, 0, 0.8, 0.8, 0, -0.6, 0, 1, 0};
inline constexpr Linear uneven{2, 0.5, 0, -0.25, 1, 0.75, 0, 0.5, 0.5};
inline constexpr Linear mirror{-1, 0, 0, 0, 1, 0, 0, 0, 1};

// An adapted surface, and how it comes from its base: base (u, v) = map (u, v), P = A P_base + d A^-T n_base.
struct Adapted {
  std::string name;
  AnySurface surface, base;
  std::array<double, 6> map{1, 0, 0, 1, 0, 0};  // row by row, then the offset
  Linear A{1, 0, 0, 0, 1, 0, 0, 0, 1};
  double handedness = 1;  // times the base's
  double distance = 0;

  Vec2<double> at(double u, double v) const {
    return {map[0] * u + map[1] * v + map[4], map[2] * u + map[3] * v + map[5]};
  }
  Eigen::Matrix3d linear() const {
    Eigen::Matrix3d m;
    for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = A[static_cast<std::size_t>(k)];
    return m;
  }
};

inline void PrintTo(const Adapted& x, std::ostream* out) {
  *out << x.name;
}

inline BezierPatch<double>
cap() {  // both edges along u collapsed, with horizontal tangent planes there; rational
  const Vec3<double> south{0, 0, -1}, north{0, 0, 1};
  return BezierPatch<double>(2, 3,
                             {south,
                              {1, 0, -1},
                              {1, 0, 1},
                              north,
                              south,
                              {0.75, 0.75, -1},
                              {0.75, 0.75, 1},
                              north,
                              south,
                              {0, 1, -1},
                              {0, 1, 1},
                              north},
                             {1, 0.75, 1, 1, 0.75, 0.5, 0.75, 0.75, 1, 0.75, 1, 1});
}
inline BezierPatch<double> fan() {  // its edge u = 0 collapsed, obliquely: dpdv vanishes there
  const Vec3<double> tip{0, 0, 0};
  return BezierPatch<double>(
      2, 2, {tip, tip, tip, {1, -0.5, 0}, {1, 0.25, 0}, {1, 0.75, 0}, {2, -1, 0.5}, {2, 0, 0}, {2, 1, 0.25}});
}

// Of every kind of adaptor, over several bases each; compiled once, in adapted.cpp.
std::vector<Adapted> every_adapted();

inline const int law_points = 50 / thinning();

}  // namespace darboux::test
