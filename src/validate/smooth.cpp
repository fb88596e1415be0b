#include "smooth.h"

#include <algorithm>

#include "normal_cones.h"

namespace darboux {
namespace {

// The largest standard deviation of a direction that may excuse a tangent; three of them make 45 degrees.
constexpr double most_deviation_deg = 15;

}  // namespace

Smooth check_smooth(const MeshUnderTest& under_test, const Accurate& accurate,
                    std::span<const VertexChecks> checks, bool raw, double max_angle_deg) {
  Smooth result;
  const std::size_t n = under_test.local.size();
  result.angles.reserve(n);
  for (std::uint32_t v = 0; v < n; ++v)
    result.angles.push_back(
        angles(under_test.mesh, v, checks[v], under_test.local[v], under_test.normals.all_oppose, raw));
  result.normals.assign(n, Claim::none), result.tangents.assign(n, Claim::none);
  result.may_be_exact.assign(n, false);
  std::vector<bool> beyond(n, false);
  const std::vector<bool>& faceted = under_test.normals.faceted_vertices;
  for (std::uint32_t v = 0; v < n; ++v) {
    const VertexClass vertex_class = under_test.classes.of_vertex[v];
    if (vertex_class == VertexClass::pole || (!faceted.empty() && faceted[v])) continue;
    if (!under_test.between_parts.empty() && under_test.between_parts[v]) continue;
    if (accurate.known() && accurate.normal(v) != Claim::none &&
        (under_test.mesh.tangents.empty() || accurate.tangent(v) != Claim::none))
      continue;
    const Angles& a = result.angles[v];
    const double limit = limit_of(vertex_class, max_angle_deg), deviation = under_test.local[v].tangent_deg;
    result.normals[v] = claim_of(a.normal, under_test.local[v].normal_deg, 3 * limit);
    beyond[v] = result.normals[v] == Claim::beyond;
    result.tangents[v] = claim_of(a.projected_tangent, deviation, 3 * limit);
    result.may_be_exact[v] = !accurate.known() && deviation <= most_deviation_deg &&
                             a.projected_tangent >= 0 &&
                             claim_of(a.projected_tangent, deviation, limit) != Claim::beyond;
  }
  if (std::find(beyond.begin(), beyond.end(), true) == beyond.end()) return result;
  // Next to slivers and poles the polynomials are unreliable.
  std::vector<double> within_deg(n, 1);
  for (std::uint32_t v = 0; v < n; ++v)
    if (beyond[v]) within_deg[v] = followed_deg(result.angles[v].normal);
  VertexJoins of_part;
  const std::vector<bool> average =
      are_average_normals(under_test.mesh, joins_of(under_test, of_part), beyond, within_deg);
  for (std::uint32_t v = 0; v < n; ++v)
    if (average[v]) result.normals[v] = Claim::none;
  return result;
}

}  // namespace darboux
