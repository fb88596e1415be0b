#include "mikktspace_comparison.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include <darboux/frame.h>

#include "accurate.h"
#include "base/degrees.h"
#include "base/flatten.h"
#include "rounding.h"

namespace darboux {
namespace {

constexpr double same_rounding_deg = 2e-5;  // a few units in the last place of floats

// Whether two tangents are equal bit for bit, except for w.
bool same_direction_bits(const Vec4<double>& stored, const Vec4<float>& m) {
  const auto bits = [](double x) { return std::bit_cast<std::uint32_t>(static_cast<float>(x)); };
  return bits(stored.x) == bits(m.x) && bits(stored.y) == bits(m.y) && bits(stored.z) == bits(m.z);
}

// Calls f once for all corners of a vertex to which MikkTSpace gives the same tangent. \param f (vertex,
// tangent, number of these corners)
template <class F>
void for_each_tangent(const MikktspaceReference& reference, std::span<const std::uint32_t> corners_of, F f) {
  std::vector<std::uint32_t> alike(corners_of.begin(), corners_of.end());
  for (const auto& other : reference.others()) --alike[other.vertex];
  for (std::uint32_t v = 0; v < alike.size(); ++v)
    if (alike[v] > 0) f(v, reference.of_vertex(v), alike[v]);
  for (const auto& other : reference.others()) f(other.vertex, other.tangent, 1U);
}

// Corners whose tangent has MikkTSpace's bits, w under either sign convention.
struct EqualBits {
  std::size_t raw = 0, gltf = 0;

  void add(const Vec4<double>& stored, const Vec4<float>& m, std::uint32_t corners) {
    if (m.w == 0 || !same_direction_bits(stored, m)) return;
    raw += stored.w == m.w ? corners : 0;
    gltf += stored.w == -m.w ? corners : 0;
  }
  std::size_t more() const { return std::max(raw, gltf); }
};

// Which variant of MikkTSpace made the tangents. The one that sorts all edges is run only if the original
// nearly gives the stored tangents. \param near corners within a few roundings
MikkVariant variant(const Mesh& mesh, MikktspaceFaces faces, std::span<const std::uint32_t> corners_of,
                    std::size_t equal, std::size_t near, int threads) {
  const std::size_t corners = mesh.corners();
  const auto share = [&](std::size_t n) { return static_cast<double>(n) / static_cast<double>(corners); };
  if (corners == 0) return MikkVariant::none;
  if (equal == corners) return MikkVariant::original;
  if (share(equal) >= 0.9) {
    const MikktspaceReference sorted = mikktspace_reference(mesh, mesh.uvs, threads, faces, true);
    EqualBits bits;
    for_each_tangent(sorted, corners_of, [&](std::uint32_t v, const Vec4<float>& m, std::uint32_t alike) {
      bits.add(mesh.tangents[v], m, alike);
    });
    if (bits.more() > equal && share(bits.more()) >= 0.99) return MikkVariant::sorted_edges;
  }
  return share(equal) >= 0.99  ? MikkVariant::original
         : share(near) >= 0.99 ? MikkVariant::reordered_sums
                               : MikkVariant::none;
}

// Degrees from a tangent of MikkTSpace's, less the effect of rounding; negative if MikkTSpace gives none.
double from_mikktspaces_deg(const Mesh& mesh, std::uint32_t v, const Vec4<float>& m) {
  if (m.w == 0) return -1;
  const Vec3<double>& n = mesh.normals[v];
  const double apart = angle_between(square_to(mesh.tangents[v].xyz(), n), square_to(direction_of(m), n));
  return degrees_per_radian * std::fmax(apart - tangent_rounding(mesh, v), 0);
}

}  // namespace

DARBOUX_FLATTEN Angles angles_to_mikktspace(const Mesh& mesh, std::uint32_t v, const VertexChecks& checks,
                                            const Vec4<float>& m, bool raw) {
  const Vec4<double>& t = mesh.tangents[v];
  const Vec3<double> direction = direction_of(m);
  Angles a;
  a.tangent = a.projected_tangent = degrees_per_radian * angle_between(t.xyz(), direction);
  if (checks.has_normal && checks.sign_valid)
    a.bitangent = degrees_per_radian * angle_between((raw ? t.w : -t.w) * cross(mesh.normals[v], t.xyz()),
                                                     m.w * cross(mesh.normals[v], direction));
  if (checks.has_normal && !checks.orthogonal)
    a.projected_tangent = degrees_per_radian * angle_between(square_to(t.xyz(), mesh.normals[v]), direction);
  return a;
}

MikktspaceComparison compare_with_mikktspace(const MeshUnderTest& under_test,
                                             std::span<const VertexChecks> checks,
                                             std::span<const std::uint32_t> corners_of, bool raw,
                                             const ValidateOptions& options) {
  const Mesh& mesh = under_test.mesh;
  const std::span<const VertexClass> classes = under_test.classes.of_vertex;
  MikktspaceComparison result;
  ClassSums sums(mesh, classes);
  EqualBits bits;
  std::size_t near = 0;
  for_each_tangent(under_test.mikktspace, corners_of,
                   [&](std::uint32_t v, const Vec4<float>& m, std::uint32_t corners) {
                     Angles a;
                     if (m.w != 0 && checks[v].has_tangent) {
                       a = angles_to_mikktspace(mesh, v, checks[v], m, raw);
                       bits.add(mesh.tangents[v], m, corners);
                       // Far from perpendicular, projection would turn even MikkTSpace's own tangent.
                       a.projected_tangent = std::fmin(a.projected_tangent, a.tangent);
                       if (a.tangent <= same_rounding_deg) near += corners;
                       if (classes[v] != VertexClass::pole &&
                           a.projected_tangent > limit_of(classes[v], options.max_angle_deg)) {
                         result.beyond += corners;
                         result.worst_deg = std::fmax(result.worst_deg, a.projected_tangent);
                       }
                     }
                     sums.add(classes[v], v, corners, a, nullptr);
                   });
  result.report.classes = sums.reports();
  if (mesh.corners() > 0)
    result.report.equal_bits = static_cast<double>(bits.more()) / static_cast<double>(mesh.corners());
  result.report.variant =
      variant(mesh, under_test.mikktspace.faces(), corners_of, bits.more(), near, options.threads);
  return result;
}

std::vector<bool> are_mikktspaces(const Mesh& mesh, std::span<const signed char> raw_sign,
                                  const MikktspaceReference& mikktspace, const std::vector<bool>& asked,
                                  std::span<const double> limit_deg) {
  std::vector<bool> result(asked.size(), false), served(asked.size(), false);
  if (mikktspace.empty()) return result;
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const std::uint32_t v = mesh.triangles[c / 3][c % 3];
    const std::size_t place = signed_index(v, raw_sign[c / 3]);
    if (raw_sign[c / 3] == 0 || !asked[place]) continue;
    const double deg = from_mikktspaces_deg(mesh, v, mikktspace.at(c, v));
    if (deg < 0) continue;
    served[place] = true;
    if (deg <= limit_deg[v]) result[place] = true;
  }
  for (std::size_t place = 0; place < asked.size(); ++place)
    if (asked[place] && !served[place]) result[place] = true;
  return result;
}

double share_unmoved(const Mesh& mesh, std::span<const signed char> raw_sign,
                     const MikktspaceReference& mikktspace) {
  if (mikktspace.empty()) return 0;
  constexpr double same_deg = 0.02;  // beyond rounding
  std::size_t leaning = 0, same = 0;
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const Triangle& triangle = mesh.triangles[c / 3];
    const std::uint32_t v = triangle[c % 3];
    if (raw_sign[c / 3] == 0) continue;
    if (!leans(direction_of_dpdu(mesh, triangle, raw_sign[c / 3]), mesh.normals[v])) continue;
    const double deg = from_mikktspaces_deg(mesh, v, mikktspace.at(c, v));
    leaning += deg >= 0, same += deg >= 0 && deg <= same_deg;
  }
  return leaning == 0 ? 1 : static_cast<double>(same) / static_cast<double>(leaning);
}

}  // namespace darboux
