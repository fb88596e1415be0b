#include "corner_counts.h"

#include <cmath>

#include <darboux/frame.h>

#include "base/text.h"

namespace darboux {

void Lengths::add(double length) {
  least_ = std::fmin(least_, length), most_ = std::fmax(most_, length);
}

std::string Lengths::text() const {
  const std::string from = rounded(least_, 4), to = rounded(most_, 4);
  return from == to ? " (length " + to + ")" : " (lengths " + from + " to " + to + ")";
}

std::vector<Vec3<double>> planes_of_vertices(const Mesh& mesh) {
  std::vector<Vec3<double>> sums(mesh.positions.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3<double> plane =
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (const std::uint32_t v : {a, b, c}) sums[v] = sums[v] + plane;
  }
  for (Vec3<double>& sum : sums) sum = unit(sum);
  return sums;
}

}  // namespace darboux
