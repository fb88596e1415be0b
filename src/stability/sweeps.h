// The cases of a sweep: points at which evaluation is difficult, from a surface and x.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <darboux/stability.h>

namespace darboux::sweeps {

using Random = std::mt19937_64;

// One case of a sweep.
struct Case {
  AnySurface surface;
  double u, v;
  std::string description;  // of the surface as it is here
  bool closed_frame;        // of the surface below its adaptors
  double data_condition;    // of data that are not parameters: control points
  // The coordinate (0: u, 1: v) that lies x from `centre`, in sweeps over a distance.
  struct Distance {
    int along;
    double centre;
  };
  std::optional<Distance> distance{};
  // (u, v) of the surface below its adaptors = M (u, v) + offset.
  std::array<double, 4> M{1, 0, 0, 1};
  std::array<double, 2> offset{0, 0};
  bool mapped = false;
  // Where the base surface is not smooth (AnySurface::breaks), along its u and its v.
  std::array<std::vector<double>, 2> breaks{};

  // The coordinates of a point of the base surface.
  Vec2<double> coordinates(const Vec2<double>& below) const {
    const double determinant = M[0] * M[3] - M[1] * M[2], x = below.x - offset[0], y = below.y - offset[1];
    return {(M[3] * x - M[1] * y) / determinant, (M[0] * y - M[2] * x) / determinant};
  }
  // The distance in u (along: 0) or v to the nearest break, as if both coordinates were periodic.
  double to_a_break(std::size_t along) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::size_t k : {0u, 1u}) {
      const double per_unit = std::fabs(M[2 * k + along]);
      const double x = std::fma(M[2 * k], u, std::fma(M[2 * k + 1], v, offset[k]));
      for (const double b : breaks[k])
        if (const double away = std::fabs(std::remainder(x - b, 1.0)); away > 0 && per_unit > 0)
          nearest = std::fmin(nearest, away / per_unit);
    }
    return nearest;
  }
  // Whether coordinates rounded to `roundoff` still mean a point within the base surface: linear conditions
  // are valid only there.
  bool within(double roundoff) const {
    const auto good = [&](double a, double b, double c) {
      const double x = std::fma(a, u, std::fma(b, v, c));
      return 0 <= x && x <= 1 && roundoff * (std::fabs(a * u) + std::fabs(b * v) + std::fabs(c)) < 1e-3;
    };
    return !mapped || (good(M[0], M[1], offset[0]) && good(M[2], M[3], offset[1]));
  }
};

// The cases of a sweep at x: one or more for each place where the surface has the swept property; none if it
// has none.
std::vector<Case> cases(std::string_view sweep, const AnySurface& surface, double x, Random& random);

}  // namespace darboux::sweeps
