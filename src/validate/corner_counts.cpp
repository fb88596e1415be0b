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

std::vector<Vec3<double>> planes_of_vertices(const MeshUnderTest& under_test) {
  const Mesh& mesh = under_test.mesh;
  VertexJoins of_part;
  const std::vector<std::uint32_t>& group = joins_of(under_test, of_part).position_and_normal;
  std::vector<Vec3<double>> sums(mesh.positions.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3<double> plane =
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (const std::uint32_t v : {a, b, c}) sums[group[v]] = sums[group[v]] + plane;
  }
  std::vector<Vec3<double>> result;
  for (std::uint32_t v = 0; v < sums.size(); ++v) result.push_back(sums[group[v]]);
  return result;
}

}  // namespace darboux
