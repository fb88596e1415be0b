#include "facts.h"

#include <algorithm>
#include <cmath>

#include <darboux/frame.h>

namespace darboux {
namespace {

constexpr double unit_tolerance = 0.0005;      // of |t|², as the Khronos glTF validator
constexpr double orthogonal_tolerance = 0.02;  // of t·n

bool is_unit(const Vec3<double>& a) {
  return std::fabs(1 - dot(a, a)) <= unit_tolerance;
}

}  // namespace

VertexFacts stored_facts(const Mesh& mesh, std::uint32_t v) {
  VertexFacts f{.position_finite = detail::finite(mesh.positions[v])};
  if (!mesh.uvs.empty()) f.uv_finite = std::isfinite(mesh.uvs[v].x) && std::isfinite(mesh.uvs[v].y);
  if (!mesh.normals.empty()) {
    f.normal_finite = detail::finite(mesh.normals[v]);
    f.normal_unit = is_unit(mesh.normals[v]);
    f.has_normal = f.normal_finite && mesh.normals[v] != Vec3<double>{};
  }
  if (!mesh.tangents.empty()) {
    const Vec4<double>& t = mesh.tangents[v];
    f.tangent_finite = detail::finite(t.xyz()) && std::isfinite(t.w);
    f.tangent_zero = t.xyz() == Vec3<double>{};
    f.has_tangent = f.tangent_finite && !f.tangent_zero;
    f.tangent_unit = is_unit(t.xyz());
    f.sign_valid = t.w == 1 || t.w == -1;
    if (!mesh.normals.empty() && f.normal_finite && f.tangent_finite)
      f.orthogonal = std::fabs(dot(t.xyz(), mesh.normals[v])) <= orthogonal_tolerance;
  }
  return f;
}

Angles angles(const Mesh& mesh, std::uint32_t v, const VertexFacts& facts, const Truth& truth, bool inward,
              bool raw) {
  Angles result;
  if (!facts.uv_finite || !detail::finite(truth.normal)) return result;
  if (facts.has_normal)
    result.normal =
        degrees_per_radian * angle_between(mesh.normals[v], inward ? -truth.normal : truth.normal);
  if (!facts.has_tangent || !detail::finite(truth.tangent)) return result;
  const Vec4<double>& t = mesh.tangents[v];
  result.tangent = degrees_per_radian * angle_between(t.xyz(), truth.tangent);
  if (facts.has_normal && facts.sign_valid)
    result.bitangent = degrees_per_radian *
                       angle_between((raw ? t.w : -t.w) * cross(mesh.normals[v], t.xyz()), truth.bitangent);
  return result;
}

bool faces_inward(const Mesh& mesh, std::span<const Truth> truth) {
  std::size_t against = 0;
  if (mesh.normals.empty()) return false;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3<double> face =
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (const std::uint32_t v : {a, b, c})
      against += dot(mesh.normals[v], truth[v].normal) < 0 && dot(face, truth[v].normal) < 0;
  }
  return 2 * against > mesh.corners();
}

void ClassSums::add(VertexClass vertex_class, std::uint32_t vertex, std::uint32_t corners,
                    const Angles& angles, const Truth* truth) {
  if (corners == 0) return;
  Sums& s = sums_[static_cast<std::size_t>(vertex_class)];
  s.corners += corners;
  if (angles.normal >= 0) {
    s.normal.push_back({angles.normal, corners});
    if (truth) s.normal_uncertainty.add(truth->normal_deg, corners);
  }
  if (angles.tangent >= 0) {
    s.tangent.push_back({angles.tangent, corners});
    if (truth) s.tangent_uncertainty.add(truth->tangent_deg, corners);
  }
  if (angles.bitangent >= 0) s.bitangent.push_back({angles.bitangent, corners});
  if (const double judged = mesh_.tangents.empty() ? angles.normal : angles.tangent; judged > s.worst) {
    s.worst = judged;
    s.worst_vertex = vertex;
  }
}

std::vector<ClassReport> ClassSums::reports() {
  const auto summary = [](std::vector<Counted>& values) {
    return values.empty() ? std::nullopt : std::optional<Statistics>(summarise(values));
  };
  std::vector<ClassReport> result;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    Sums& s = sums_[k];
    if (s.corners == 0) continue;
    ClassReport entry{.vertex_class = static_cast<VertexClass>(k),
                      .corners = s.corners,
                      .normal_deg = summary(s.normal),
                      .tangent_deg = summary(s.tangent),
                      .bitangent_deg = summary(s.bitangent),
                      .worst = std::nullopt,
                      .normal_uncertainty_deg = s.normal_uncertainty,
                      .tangent_uncertainty_deg = s.tangent_uncertainty};
    if (s.worst >= 0)
      entry.worst =
          WorstCorner{s.worst_vertex, mesh_.uvs.empty() ? Vec2<double>{} : mesh_.uvs[s.worst_vertex]};
    result.push_back(entry);
  }
  return result;
}

}  // namespace darboux
