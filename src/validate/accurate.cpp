#include "accurate.h"

namespace darboux {

Claim claim_of(double angle, double deviation, double limit) {
  if (!(angle >= 0)) return Claim::none;
  if (angle - certain * deviation > limit) return Claim::beyond;
  return angle + certain * deviation <= limit ? Claim::within : Claim::none;
}

double limit_of(VertexClass vertex_class, double max_angle_deg) {
  return (vertex_class == VertexClass::interior ? 1 : 3) * max_angle_deg;
}

Accurate::Accurate(const MeshUnderTest& under_test, std::span<const VertexChecks> checks,
                   std::span<const std::uint32_t> corners_of, std::span<const Truth> truth, Basis basis,
                   bool raw, double max_angle_deg)
    : truth_(truth), basis_(basis) {
  const Mesh& mesh = under_test.mesh;
  const std::size_t n = mesh.positions.size();
  if (truth.empty()) return;
  inward_ = basis == Basis::recognised_unsided ? opposed_vertices(mesh, truth) : inward_vertices(mesh, truth);
  if (has_sides() && !under_test.normals.all_oppose && !under_test.normals.side.empty())
    find_sides(mesh, under_test.normals.side, corners_of);
  angles_.resize(n);
  normals_.assign(n, Claim::none), tangents_.assign(n, Claim::none);
  struct {
    std::size_t compared = 0, beyond = 0;
    void add(Claim claim, std::size_t corners) {
      if (claim != Claim::none) compared += corners;
      if (claim == Claim::beyond) beyond += corners;
    }
    double agree() const {
      return compared == 0 ? 1 : static_cast<double>(compared - beyond) / static_cast<double>(compared);
    }
  } all_normals, all_tangents;
  // Flat shading is deliberate; on a plane it is the same as smooth shading.
  const std::vector<bool>& faceted = under_test.normals.faceted_vertices;
  const bool leave_out_faceted = basis == Basis::recognised && !faceted.empty();
  for (std::uint32_t v = 0; v < n; ++v) {
    if (corners_of[v] == 0 || (leave_out_faceted && faceted[v])) continue;
    const Angles& a = angles_[v] = darboux::angles(mesh, v, checks[v], truth[v], inward_[v], raw);
    const VertexClass vertex_class = under_test.classes.of_vertex[v];
    if (vertex_class == VertexClass::pole) continue;
    const double limit = limit_of(vertex_class, max_angle_deg);
    // Nobody sees the normal of a vertex whose triangles have no area, nor the tangent where they have none
    // in uv.
    const bool seen = basis == Basis::declared || mesh.normals.empty() || under_test.normals.drawn[v];
    if (seen) normals_[v] = claim_of(a.normal, truth[v].normal_deg, limit);
    if (basis == Basis::declared || (seen && under_test.has_uv_area[v]))
      tangents_[v] = claim_of(a.projected_tangent, truth[v].tangent_deg, limit);
    all_normals.add(normals_[v], corners_of[v]);
    all_tangents.add(tangents_[v], corners_of[v]);
  }
  normals_agree_ = all_normals.agree();
  tangents_agree_ = all_tangents.agree();
}

// The side is that of the triangles that share the normal: the other side of a sheet may lie in another part.
void Accurate::find_sides(const Mesh& mesh, std::span<const signed char> side,
                          std::span<const std::uint32_t> corners_of) {
  std::size_t corners = 0, inward = 0;
  const auto is_opposed = [&](std::size_t v) { return dot(mesh.normals[v], truth_[v].normal) < 0; };
  for (std::size_t v = 0; v < inward_.size(); ++v) {
    if (side[v] > 0 && is_opposed(v)) inward_[v] = true;
    corners += corners_of[v], inward += inward_[v] ? corners_of[v] : 0;
  }
  // If the mesh's outside is the surface's inside, normals that only their own triangles oppose are compared
  // with the inward normal, too.
  if (2 * inward <= corners) return;
  for (std::size_t v = 0; v < inward_.size(); ++v)
    if (side[v] < 0 && !is_opposed(v)) inward_[v] = true;
}

}  // namespace darboux
