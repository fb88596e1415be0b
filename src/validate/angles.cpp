#include "angles.h"

#include <algorithm>
#include <cmath>

#include <darboux/frame.h>

#include "base/degrees.h"
#include "base/flatten.h"
#include "mesh/area_vector.h"

namespace darboux {

// Flattened, as it is called for every vertex and its callees mostly return early.
DARBOUX_FLATTEN Angles angles(const Mesh& mesh, std::uint32_t v, const VertexChecks& checks,
                              const Truth& truth, bool inward, bool raw) {
  Angles result;
  const auto angle = [](const Vec3<double>& stored, const Vec3<double>& of_truth) {
    return degrees_per_radian * angle_between_units(unit(stored), of_truth);
  };
  if (!checks.uv_finite || !detail::finite(truth.normal)) return result;
  if (checks.has_normal) result.normal = angle(mesh.normals[v], inward ? -truth.normal : truth.normal);
  if (!checks.has_tangent || !detail::finite(truth.tangent)) return result;
  const Vec4<double>& t = mesh.tangents[v];
  result.tangent = result.projected_tangent = angle(t.xyz(), truth.tangent);
  constexpr double orthogonal = 1e-4;  // turns a projection by less than a hundredth of a degree
  if (const Vec3<double> n = checks.has_normal ? mesh.normals[v] : Vec3<double>{};
      std::fabs(dot(t.xyz(), n)) > orthogonal)
    result.projected_tangent = angle(square_to(t.xyz(), n), truth.tangent);
  if (checks.has_normal && checks.sign_valid)
    result.bitangent = angle((raw ? t.w : -t.w) * cross(mesh.normals[v], t.xyz()), truth.bitangent);
  return result;
}

std::vector<bool> inward_vertices(const Mesh& mesh, std::span<const Truth> truth) {
  std::vector<bool> inward = opposed_vertices(mesh, truth);
  if (std::find(inward.begin(), inward.end(), true) == inward.end()) return inward;
  std::vector<std::int32_t> against(mesh.positions.size(), 0);  // minus those that agree
  for (const Triangle& t : mesh.triangles) {
    const Vec3<double> face = area_vector(mesh, t);
    for (const std::uint32_t v : t)
      if (inward[v]) against[v] += dot(face, truth[v].normal) < 0 ? 1 : -1;
  }
  for (std::size_t v = 0; v < inward.size(); ++v) inward[v] = against[v] > 0;
  return inward;
}

std::vector<bool> opposed_vertices(const Mesh& mesh, std::span<const Truth> truth) {
  std::vector<bool> opposed(mesh.positions.size(), false);
  for (std::size_t v = 0; v < mesh.normals.size(); ++v)
    opposed[v] = dot(mesh.normals[v], truth[v].normal) < 0;
  return opposed;
}

ClassSums::ClassSums(const Mesh& mesh, std::span<const VertexClass> of_vertex) : mesh_(mesh) {
  for (const VertexClass c : of_vertex) ++sums_[static_cast<std::size_t>(c)].vertices;
}

void ClassSums::add(VertexClass vertex_class, std::uint32_t vertex, std::uint32_t corners,
                    const Angles& angles, const Truth* truth) {
  if (corners == 0) return;
  Sums& s = sums_[static_cast<std::size_t>(vertex_class)];
  s.corners += corners;
  const auto store = [&](std::vector<Counted>& values, double angle) {
    if (values.empty()) values.reserve(s.vertices);
    values.push_back({angle, corners});
  };
  if (angles.normal >= 0) {
    store(s.normal, angles.normal);
    if (truth) s.normal_uncertainty.add(truth->normal_deg, corners);
  }
  if (angles.tangent >= 0) {
    store(s.tangent, angles.tangent);
    if (truth) s.tangent_uncertainty.add(truth->tangent_deg, corners);
  }
  if (angles.bitangent >= 0) store(s.bitangent, angles.bitangent);
  if (const double assessed = mesh_.tangents.empty() ? angles.normal : angles.tangent; assessed > s.worst) {
    s.worst = assessed;
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
