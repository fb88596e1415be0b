// Stored vectors beside those of a reference, and the linear maps that take one to the other.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <darboux/vector.h>

namespace darboux {

// The share of corners that a cause must explain to be named.
inline constexpr double explains_most = 0.9;

}  // namespace darboux

namespace darboux::diagnosis {

inline constexpr std::size_t most_samples = 4096, least_samples = 10;

struct Pair {
  std::size_t corner;            // or, for normals, vertex
  Vec3<double> stored, t, b, v;  // unit; b perpendicular to t, on the side of v
  double w, raw;                 // raw: of the triangle, 0 without uv area
  double limit;                  // degrees
  double rounding = 0;           // degrees by which rounding may have turned the reference
  bool within(double deg) const { return deg <= limit + rounding; }
};

double angle_deg(const Vec3<double>& a, const Vec3<double>& b);

// The share of samples that are within their limits of the direction.
template <class F>
double share_within(const std::vector<Pair>& samples, F direction) {
  std::size_t within = 0;
  for (const Pair& s : samples) within += s.within(angle_deg(s.stored, direction(s)));
  return static_cast<double>(within) / static_cast<double>(samples.size());
}

// Unit vectors that span the stored ones, a column each: two where these lie in one plane, as the normals of
// a cylinder do.
Eigen::MatrixXd span_of(const std::vector<Pair>& samples);

// How many stored vectors beyond the limit differ by a degree and more, up to least_different.
inline constexpr std::size_t least_different = 8;
std::size_t different_off(const std::vector<Pair>& samples);

// The linear map M of their span that takes the stored vectors to the reference's t, up to their length: the
// least of sum |T x M t|² at |M| = 1. \param least_ratio maps that scale by less are not told \returns what
// it does, where it explains nearly all
std::optional<std::string> linear_map_of(const std::vector<Pair>& samples, double limit, bool of_normals,
                                         double least_ratio = 1);

// The rotation that takes the stored vectors nearest to the reference's, if it explains nearly all and they
// span space. [Kabsch1976]
std::optional<std::string> rotation_of(const std::vector<Pair>& samples);

}  // namespace darboux::diagnosis
