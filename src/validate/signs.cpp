#include "signs.h"

#include <algorithm>
#include <cmath>

#include <darboux/frame.h>

#include "angles.h"
#include "base/degrees.h"
#include "mesh/area_vector.h"
#include "rounding.h"

namespace darboux {

Signs::Signs(const MeshUnderTest& under_test, std::span<const VertexChecks> checks)
    : under_test_(under_test), checks_(checks) {
  const Mesh& mesh = under_test.mesh;
  islands_.resize(static_cast<std::size_t>(under_test.classes.islands));
  if (mesh.tangents.empty()) return;
  count();
  if (all_.raw == 0 || all_.gltf == 0 || mesh.normals.empty()) return;
  std::vector<bool> asked(mesh.positions.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (wrong(t, v)) asked[v] = true;
  VertexJoins of_part;
  all_round_ = own_directions(mesh, under_test.raw_sign, joins_of(under_test, of_part), asked).all_round;
  count();
  open_few();
}

void Signs::open_few() {
  constexpr std::size_t in = 100;
  const Mesh& mesh = under_test_.mesh;
  std::vector<bool> open(mesh.positions.size(), false);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!under_test_.has_area[t]) continue;
    const bool none = certain_sign(mesh, mesh.triangles[t], 0) == 0;
    for (const std::uint32_t v : mesh.triangles[t])
      if (none || !faces(t, v)) open[v] = true;
  }
  std::size_t those = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) those += open[v] && wrong(t, v);
  if (in * those <= all_.raw + all_.gltf) open_ = std::move(open);
}

void Signs::count() {
  all_ = {};
  islands_.assign(islands_.size(), {});
  const Mesh& mesh = under_test_.mesh;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!counts(t)) continue;
    SignCount& island = islands_[static_cast<std::size_t>(under_test_.classes.island_of_triangle[t])];
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (!counts(t, v)) continue;
      const bool raw = mesh.tangents[v].w * raw_sign(t, v) > 0;
      ++(raw ? all_.raw : all_.gltf);
      ++(raw ? island.raw : island.gltf);
    }
  }
}

bool Signs::counts(std::uint32_t t) const {
  return under_test_.raw_sign[t] != 0 && under_test_.has_area[t] &&
         certain_sign(under_test_.mesh, under_test_.mesh.triangles[t], 0) != 0;
}

int Signs::raw_sign(std::uint32_t t, std::uint32_t v) const {
  const int own = under_test_.raw_sign[t];
  const MikktspaceReference& mikktspace = under_test_.mikktspace;
  if (mikktspace.faces() != MikktspaceFaces::quads) return own;
  const Triangle& triangle = under_test_.mesh.triangles[t];
  const auto k = static_cast<std::size_t>(std::find(triangle.begin(), triangle.end(), v) - triangle.begin());
  const float of_quad = mikktspace.at(3 * std::size_t{t} + k, v).w;
  return of_quad > 0 ? 1 : of_quad < 0 ? -1 : own;
}

bool Signs::counts(std::uint32_t t, std::uint32_t v) const {
  if (!checks_[v].sign_valid || !checks_[v].has_tangent) return false;
  if (!all_round_.empty() && all_round_[signed_index(v, under_test_.raw_sign[t])]) return false;
  return faces(t, v);
}

bool Signs::faces(std::uint32_t t, std::uint32_t v) const {
  if (!checks_[v].has_normal || under_test_.normals.all_oppose) return true;
  const Mesh& mesh = under_test_.mesh;
  const Vec3<double> plane = area_vector(mesh, mesh.triangles[t]);
  const Vec3<double>& n = mesh.normals[v];
  const double along = dot(n, plane), least = std::cos(supported_deg / degrees_per_radian);
  return along > 0 && along * along >= least * least * dot(n, n) * dot(plane, plane);
}

bool Signs::wrong(std::uint32_t t, std::uint32_t v) const {
  if (all_.raw == 0 || all_.gltf == 0 || !counts(t) || (!open_.empty() && open_[v])) return false;
  const SignCount& island = islands_[static_cast<std::size_t>(under_test_.classes.island_of_triangle[t])];
  return (under_test_.mesh.tangents[v].w * raw_sign(t, v) > 0) != raw_in(island) && counts(t, v);
}

Handedness Signs::handedness() const {
  Handedness result;
  const std::size_t total = all_.raw + all_.gltf, larger = std::max(all_.raw, all_.gltf);
  if (total == 0) return result;
  result.consistent = static_cast<double>(larger) / static_cast<double>(total);
  result.wrong = total - larger;
  result.convention = result.consistent < 0.99 ? HandednessConvention::mixed
                      : raw()                  ? HandednessConvention::raw
                                               : HandednessConvention::gltf;
  return result;
}

std::size_t Signs::in_opposite_islands() const {
  constexpr std::size_t fewest = 12;  // two quads; a smaller island may be one sliver
  std::size_t result = 0;
  for (const SignCount& island : islands_) {
    const std::size_t with = raw() ? island.raw : island.gltf, against = raw() ? island.gltf : island.raw;
    if (with == 0 && against >= fewest) result += against;
  }
  return result;
}

std::string Signs::islands_text() const {
  std::size_t raw = 0, gltf = 0, both = 0;
  for (const SignCount& island : islands_)
    if (island.raw + island.gltf > 0) ++(island.gltf == 0 ? raw : island.raw == 0 ? gltf : both);
  return "; of the uv islands " + std::to_string(raw) + " are raw, " + std::to_string(gltf) + " glTF's, " +
         std::to_string(both) + " both";
}

}  // namespace darboux
