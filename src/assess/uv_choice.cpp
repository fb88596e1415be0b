#include "uv_choice.h"

#include <cmath>
#include <limits>

#include <darboux/frame.h>

#include "mesh/triangle_signs.h"
#include "validate/angles.h"

namespace darboux {
namespace {

// Other uvs are chosen if the mean angle of the tangents to them is smaller by the factor `closer`.
constexpr double follows = 0.8, closer = 0.97;

// How tangents follow the uvs: the share of judged corners within the cone; the mean angle to the dpdu of
// each corner's triangle, both made perpendicular to the normal; and the corners where w has glTF's sign,
// minus those with the raw sign.
struct Following {
  double share_within = 0, mean_rad = 0;
  std::ptrdiff_t gltf_signs = 0;
  bool is_enough() const { return share_within >= follows; }
};

// \param own what is known of the mesh, apart from its uvs
Following following(const Mesh& mesh, std::span<const signed char> raw_sign, const MeshUnderTest& own,
                    double max_angle_deg) {
  const Cones cones(mesh, raw_sign, own.has_area, own.joins, {},
                    std::vector<double>(mesh.positions.size(), max_angle_deg), max_angle_deg);
  std::size_t within = 0, compared = 0, with_angle = 0;
  std::ptrdiff_t gltf_signs = 0;
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3<double> dpdu = direction_of_dpdu(mesh, mesh.triangles[t], raw_sign[t]);
    for (const std::uint32_t v : mesh.triangles[t]) {
      const Claim claim = cones.claim(v, raw_sign[t]);
      compared += claim != Claim::none;
      within += claim == Claim::within;
      const double sign = mesh.tangents[v].w * raw_sign[t];
      gltf_signs += sign < 0 ? 1 : sign > 0 ? -1 : 0;
      const double angle =
          angle_between(square_to(mesh.tangents[v].xyz(), mesh.normals[v]), square_to(dpdu, mesh.normals[v]));
      if (raw_sign[t] == 0 || !std::isfinite(angle)) continue;
      ++with_angle;
      sum += angle;
    }
  }
  const auto share = [](double part, std::size_t of) { return of == 0 ? 0 : part / static_cast<double>(of); };
  return {share(static_cast<double>(within), compared), share(sum, with_angle), gltf_signs};
}

}  // namespace

std::optional<UvChoice> choose_uvs(const MeshUnderTest& own, const AssessOptions& options) {
  const Mesh& mesh = own.mesh;
  const bool other_sets = !options.names_uv_set && !options.other_uvs.empty();
  if (mesh.tangents.empty() || mesh.normals.empty() || mesh.uvs.empty()) return std::nullopt;
  if (!options.texture_transform && !other_sets) return std::nullopt;
  const double limit = options.max_angle_deg;
  const Following by_own = following(mesh, own.raw_sign, own, limit);
  double best_rad = by_own.is_enough() ? closer * by_own.mean_rad : std::numeric_limits<double>::infinity();
  UvChoice tried{mesh, std::nullopt, false};
  std::optional<UvChoice> choice;
  // If the tangents follow both equally, as when a transform mirrors v, the convention of w decides.
  const auto tells_by_sign = [&](const Following& by_these) {
    constexpr double rounding_rad = 1e-6;
    return by_own.is_enough() && by_own.gltf_signs < 0 && by_these.gltf_signs > 0 &&
           closer * by_these.mean_rad <= by_own.mean_rad + rounding_rad;
  };
  const auto try_it = [&] {
    const Following by_these = following(tried.mesh, triangle_signs(tried.mesh), own, limit);
    if (!by_these.is_enough()) return;
    if (!(by_these.mean_rad < best_rad) && !(tried.transformed && tells_by_sign(by_these))) return;
    best_rad = std::fmin(best_rad, by_these.mean_rad);
    choice = tried;
  };
  if (options.texture_transform) {
    const UvConvention transform{"", *options.texture_transform};
    for (Vec2<double>& uv : tried.mesh.uvs) uv = transform.surface_uv(uv);
    tried.transformed = true;
    try_it();
  }
  tried.transformed = false;
  if (!other_sets) return choice;
  for (const auto& [set, uvs] : options.other_uvs) {
    tried.mesh.uvs = uvs;
    tried.set = set;
    try_it();
  }
  return choice;
}

}  // namespace darboux
