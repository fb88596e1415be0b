#include "uv_choice.h"

#include "mesh/triangle_signs.h"

namespace darboux {
namespace {

constexpr double follows = 0.8;

// The share of corners within the cone, of those about which it claims something.
// \param own what is known of the mesh but for its uvs
double share_within(const Mesh& mesh, std::span<const signed char> raw_sign, const MeshUnderTest& own,
                    double max_angle_deg) {
  const Cones cones(mesh, raw_sign, own.has_area, own.joins,
                    std::vector<double>(mesh.positions.size(), max_angle_deg), max_angle_deg);
  std::size_t within = 0, compared = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      const Claim claim = cones.claim(v, raw_sign[t]);
      compared += claim != Claim::none;
      within += claim == Claim::within;
    }
  return compared == 0 ? 0 : static_cast<double>(within) / static_cast<double>(compared);
}

}  // namespace

std::optional<UvChoice> choose_uvs(const MeshUnderTest& own, const AssessOptions& options) {
  const Mesh& mesh = own.mesh;
  const bool other_sets = !options.names_uv_set && !options.other_uvs.empty();
  if (mesh.tangents.empty() || mesh.normals.empty() || mesh.uvs.empty()) return std::nullopt;
  if (!options.texture_transform && !other_sets) return std::nullopt;
  const double limit = options.max_angle_deg;
  if (share_within(mesh, own.raw_sign, own, limit) >= follows) return std::nullopt;
  // The one copy of the mesh, for all that are tried.
  UvChoice choice{mesh, std::nullopt, false};
  const auto is_followed = [&] {
    return share_within(choice.mesh, triangle_signs(choice.mesh), own, limit) >= follows;
  };
  if (options.texture_transform) {
    const UvConvention transform{"", *options.texture_transform};
    for (Vec2<double>& uv : choice.mesh.uvs) uv = transform.surface_uv(uv);
    choice.transformed = true;
    if (is_followed()) return choice;
  }
  choice.transformed = false;
  if (!other_sets) return std::nullopt;
  for (const auto& [set, uvs] : options.other_uvs) {
    choice.mesh.uvs = uvs;
    choice.set = set;
    if (is_followed()) return choice;
  }
  return std::nullopt;
}

}  // namespace darboux
