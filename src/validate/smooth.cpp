#include "smooth.h"

namespace darboux {

Angles local_angles(const Subject& subject, std::uint32_t v, const VertexChecks& checks, bool raw) {
  return angles(subject.mesh, v, checks, subject.local[v], subject.normals.all_oppose, raw);
}

Smooth check_smooth(const Subject& subject, const Accurate& accurate, std::span<const VertexChecks> checks,
                    bool raw, double max_angle_deg) {
  Smooth result;
  const std::size_t n = subject.local.size();
  result.normals.assign(n, Claim::none), result.tangents.assign(n, Claim::none);
  const std::vector<bool>& faceted = subject.normals.faceted_vertices;
  for (std::uint32_t v = 0; v < n; ++v) {
    const VertexClass vertex_class = subject.classes.of_vertex[v];
    if (vertex_class == VertexClass::pole || (!faceted.empty() && faceted[v])) continue;
    if (!subject.between_parts.empty() && subject.between_parts[v]) continue;
    if (accurate.known() && accurate.normal(v) != Claim::none &&
        (subject.mesh.tangents.empty() || accurate.tangent(v) != Claim::none))
      continue;
    const Angles a = local_angles(subject, v, checks[v], raw);
    const double limit = 3 * limit_of(vertex_class, max_angle_deg);
    result.normals[v] = claim_of(a.normal, subject.local[v].normal_deg, limit);
    result.tangents[v] = claim_of(a.projected_tangent, subject.local[v].tangent_deg, limit);
  }
  return result;
}

}  // namespace darboux
