#include "uv_choice.h"

#include "mesh/triangle_signs.h"
#include "validate/mesh_under_test.h"

namespace darboux {
namespace {

constexpr double follows = 0.8;

// The share of corners within the cone, of those that it assesses.
double share_within(const Mesh& mesh, const AssessOptions& options) {
  const std::vector<signed char> sign = triangle_signs(mesh);
  VertexJoins joins;
  classify(mesh, {}, sign, joins);
  const Cones cones(mesh, sign, joins, std::vector<double>(mesh.positions.size(), options.max_angle_deg),
                    options.max_angle_deg);
  std::size_t within = 0, assessed = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      const Claim claim = cones.claim(v, sign[t]);
      assessed += claim != Claim::none;
      within += claim == Claim::within;
    }
  return assessed == 0 ? 0 : static_cast<double>(within) / static_cast<double>(assessed);
}

}  // namespace

std::optional<UvChoice> choose_uvs(const Mesh& mesh, const AssessOptions& options) {
  std::vector<UvChoice> choices;
  if (mesh.tangents.empty() || mesh.normals.empty() || mesh.uvs.empty()) return std::nullopt;
  if (options.texture_transform) {
    const UvConvention transform{"", *options.texture_transform};
    UvChoice& choice = choices.emplace_back();
    choice.transformed = true;
    for (const Vec2<double>& uv : mesh.uvs) choice.uvs.push_back(transform.surface_uv(uv));
  }
  if (!options.names_uv_set)
    for (const auto& [set, uvs] : options.other_uvs)
      if (uvs.size() == mesh.positions.size()) choices.push_back({uvs, set, false});
  if (choices.empty() || share_within(mesh, options) >= follows) return std::nullopt;
  for (UvChoice& choice : choices) {
    Mesh other = mesh;
    other.uvs = choice.uvs;
    if (share_within(other, options) >= follows) return std::move(choice);
  }
  return std::nullopt;
}

}  // namespace darboux
