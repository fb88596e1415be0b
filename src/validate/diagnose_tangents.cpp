#include "diagnose_tangents.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <darboux/frame.h>

#include "accurate.h"
#include "findings.h"
#include "linear_maps.h"

namespace darboux {
namespace {

using namespace diagnosis;

std::vector<Pair> samples_of(const MeshUnderTest& under_test,
                             const std::function<Directions(std::size_t)>& reference, double max_angle_deg) {
  const Mesh& mesh = under_test.mesh;
  const std::size_t step = (mesh.corners() + most_samples - 1) / most_samples;
  std::vector<Pair> samples;
  for (std::size_t c = 0; c < mesh.corners(); c += step) {
    const std::uint32_t v = mesh.triangles[c / 3][c % 3];
    const Vec4<double>& t = mesh.tangents[v];
    const Directions d = reference(c);
    if (!detail::finite(t.xyz()) || t.xyz() == Vec3<double>{} || !detail::finite(d.t) ||
        !detail::finite(d.b) || under_test.classes.of_vertex[v] == VertexClass::pole)
      continue;
    const Vec3<double> along = unit(d.t), across = unit(d.b - dot(d.b, along) * along);
    samples.push_back({c, unit(t.xyz()), along, across, unit(d.b), t.w,
                       static_cast<double>(under_test.raw_sign[c / 3]),
                       limit_of(under_test.classes.of_vertex[v], max_angle_deg)});
  }
  return samples;
}

// How the stored tangent lies relative to the reference's t and b, and which uvs would make it right: with
// `keeps` their triangles have the sign of the stored uvs' triangles, with `turns` the opposite one.
struct Axes {
  std::string_view what;
  double t, b;
  std::string_view keeps, turns;
};
constexpr Axes other_axes[] = {{"-t", -1, 0, "flip both", "flip u"},
                               {"b", 0, 1, "swap flip u", "swap"},
                               {"-b", 0, -1, "swap flip v", "swap flip both"}};

// Three directions count as along v: the one perpendicular to t, if tangents were turned or bitangents stored
// in their place; the reference's own direction of v, if u and v were swapped; and MikkTSpace's tangent of
// swapped uvs, for coarse meshes.
bool follow_other_axes(const MeshUnderTest& under_test, const std::vector<Pair>& samples,
                       const ValidateOptions& options, MeshReport& report) {
  const Mesh& mesh = under_test.mesh;
  const std::size_t corners = mesh.corners();
  std::optional<MikktspaceReference> swapped;
  const auto along_v = [&](const Pair& s) {
    return direction_of(swapped->at(s.corner, mesh.triangles[s.corner / 3][s.corner % 3]));
  };
  for (const Axes& axes : other_axes) {
    double share = share_within(samples, [&](const Pair& s) { return axes.t * s.t + axes.b * s.b; });
    if (share < explains_most && axes.b != 0)
      share = share_within(samples, [&](const Pair& s) { return axes.b * s.v; });
    if (share < explains_most && axes.b != 0 && !mesh.normals.empty() && !mesh.uvs.empty()) {
      if (!swapped) {
        std::vector<Vec2<double>> uvs;
        for (const Vec2<double>& uv : mesh.uvs) uvs.push_back({uv.y, uv.x});
        swapped = mikktspace_reference(mesh, uvs, options.threads);
      }
      share = share_within(samples, [&](const Pair& s) { return axes.b * along_v(s); });
    }
    if (share < explains_most) continue;
    double raw = 0;
    for (const Pair& s : samples) raw += s.w * s.raw;
    const std::string_view gltf_uvs = raw > 0 ? axes.turns : axes.keeps,
                           raw_uvs = raw > 0 ? axes.keeps : axes.turns;
    add(report, finding(Code::tangent_axes, corners,
                        ": they lie along " + std::string(axes.what) +
                            " (t of u, b of v), as those of uvs '" + std::string(gltf_uvs) +
                            "' with glTF's sign, or '" + std::string(raw_uvs) + "' with the raw one"));
    return true;
  }
  return false;
}

bool follow_other_uv_set(const MeshUnderTest& under_test, const std::vector<Pair>& samples,
                         const ValidateOptions& options, MeshReport& report) {
  if (under_test.mesh.normals.empty()) return false;
  const auto share_of = [&](const MikktspaceReference& mikktspace) {
    return share_within(samples, [&](const Pair& s) {
      return direction_of(mikktspace.at(s.corner, under_test.mesh.triangles[s.corner / 3][s.corner % 3]));
    });
  };
  // The other set may be a copy of the mesh's own.
  const double own = under_test.mikktspace.empty() ? 0 : share_of(under_test.mikktspace);
  for (const auto& [set, uvs] : options.other_uvs) {
    const double share = share_of(mikktspace_reference(under_test.mesh, uvs, options.threads));
    if (share < explains_most || share <= own) continue;
    add(report, finding(Code::tangent_uv_set, under_test.mesh.corners(),
                        ": MikkTSpace's of TEXCOORD_" + std::to_string(set)));
    return true;
  }
  return false;
}

// The one angle, in degrees, by which nearly all tangents are turned from the reference about their normals.
std::optional<double> turn_deg_of(const Mesh& mesh, const std::vector<Pair>& samples, double limit) {
  if (mesh.normals.empty() || samples.size() < least_samples) return std::nullopt;
  double x = 0, y = 0;
  const auto normal = [&](const Pair& s) { return mesh.normals[mesh.triangles[s.corner / 3][s.corner % 3]]; };
  for (const Pair& s : samples) {
    const Vec3<double> n = normal(s);
    if (!detail::finite(n) || n == Vec3<double>{}) continue;
    const double along = dot(s.stored, s.t), across = dot(s.stored, cross(unit(n), s.t));
    x += along, y += across;
  }
  const double turn = std::atan2(y, x), cosine = std::cos(turn), sine = std::sin(turn);
  if (std::fabs(turn) * 180 / std::numbers::pi < 3 * limit) return std::nullopt;
  const double share =
      share_within(samples, [&](const Pair& s) { return cosine * s.t + sine * cross(unit(normal(s)), s.t); });
  if (share < explains_most) return std::nullopt;
  return turn * 180 / std::numbers::pi;
}

// Whether all are turned by one angle about their normals, relative to the reference or as Cones found.
bool are_turned(const MeshUnderTest& under_test, const std::vector<Pair>& samples, double limit,
                MeshReport& report) {
  std::optional<Cones::Turn> turn;
  if (const auto deg = turn_deg_of(under_test.mesh, samples, limit))
    turn = {*deg, false};
  else
    turn = under_test.cones.turn();
  if (!turn) return false;
  const bool quarters = std::fabs(std::remainder(turn->deg, 90)) <= limit;
  // Turned uvs turn the tangents of mirrored charts the other way.
  const auto has = [&](signed char sign) {
    return std::find(under_test.raw_sign.begin(), under_test.raw_sign.end(), sign) !=
           under_test.raw_sign.end();
  };
  const bool both = has(-1) && has(1);
  const double signed_deg = turn->by_sign && both ? std::fabs(turn->deg) : turn->deg;
  const std::string deg = std::to_string(std::lround(signed_deg));
  add(report, finding(quarters ? Code::tangent_axes : Code::tangent_uv_set, under_test.mesh.corners(),
                      ": all are turned about their normals by about " + deg + " deg" +
                          (turn->by_sign && both ? ", in mirrored charts the other way" : "") +
                          (turn->by_sign || !both ? ", as those of uvs that are turned" : "")));
  return true;
}

}  // namespace

bool diagnose_tangents(const MeshUnderTest& under_test,
                       const std::function<Directions(std::size_t)>& reference,
                       const ValidateOptions& options, bool held, MeshReport& report) {
  const double limit = options.max_angle_deg;
  const std::size_t corners = under_test.mesh.corners();
  const std::vector<Pair> samples = samples_of(under_test, reference, limit);
  if (samples.size() < least_samples) return !held && are_turned(under_test, samples, limit, report);
  if (share_within(samples, [](const Pair& s) { return s.t; }) >= Accurate::enough) return false;
  if (follow_other_uv_set(under_test, samples, options, report)) return true;
  if (held) return false;
  if (follow_other_axes(under_test, samples, options, report)) return true;
  if (are_turned(under_test, samples, limit, report)) return true;
  const std::optional<std::string> map = linear_map_of(samples, limit, false);
  if (map) add(report, finding(Code::tangent_stale, corners, *map));
  return map.has_value();
}

}  // namespace darboux
