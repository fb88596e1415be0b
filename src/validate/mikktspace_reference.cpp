#include "mikktspace_reference.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include <darboux/mikktspace.h>

#include "mesh/quads.h"
#include "rounding.h"

namespace darboux {
namespace {

bool same_bits(const Vec4<float>& a, const Vec4<float>& b) {
  using Bits = std::array<std::uint32_t, 4>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

bool has_quads(const Mesh& mesh) {
  for (std::size_t t = 1; t < mesh.triangles.size(); ++t)
    if (quad_of(mesh.triangles[t - 1], mesh.triangles[t])) return true;
  return false;
}

}  // namespace

MikktspaceReference::MikktspaceReference(const Mesh& mesh, std::span<const Vec4<float>> of_corner,
                                         MikktspaceFaces faces)
    : faces_(faces),
      of_vertex_(mesh.positions.size(), Vec4<float>{0, 0, 0, 0}),
      has_others_(mesh.positions.size(), false) {
  std::vector<bool> seen(mesh.positions.size(), false);
  for (std::size_t c = 0; c < of_corner.size(); ++c) {
    const std::uint32_t v = mesh.triangles[c / 3][c % 3];
    if (!seen[v]) {
      seen[v] = true;
      of_vertex_[v] = of_corner[c];
    } else if (!same_bits(of_corner[c], of_vertex_[v])) {
      has_others_[v] = true;
      others_.push_back({c, v, of_corner[c]});
    }
  }
}

const Vec4<float>& MikktspaceReference::at(std::size_t corner, std::uint32_t vertex) const {
  if (has_others_[vertex]) {
    const auto found = std::lower_bound(others_.begin(), others_.end(), corner,
                                        [](const Other& other, std::size_t c) { return other.corner < c; });
    if (found != others_.end() && found->corner == corner) return found->tangent;
  }
  return of_vertex_[vertex];
}

MikktspaceReference MikktspaceReference::restricted_to(const Mesh& part,
                                                       std::span<const std::uint32_t> vertices,
                                                       std::span<const std::uint32_t> triangles) const {
  MikktspaceReference result;
  if (empty()) return result;
  result.faces_ = faces_;
  for (const std::uint32_t v : vertices) result.of_vertex_.push_back(of_vertex_[v]);
  result.has_others_.assign(vertices.size(), false);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = part.triangles[t][k];
      const Vec4<float>& tangent = at(3 * std::size_t{triangles[t]} + k, vertices[v]);
      if (same_bits(tangent, of_vertex_[vertices[v]])) continue;
      result.has_others_[v] = true;
      result.others_.push_back({3 * t + k, v, tangent});
    }
  return result;
}

MikktspaceReference mikktspace_reference(const Mesh& mesh, std::span<const Vec2<double>> uvs, int threads,
                                         MikktspaceFaces faces, bool sort_all_edges) {
  const std::size_t n = mesh.positions.size();
  std::vector<float> positions(3 * n), normals(3 * n), texcoords(2 * n);
  std::vector<bool> finite(n);
  for (std::size_t v = 0; v < n; ++v) {
    const Vec3<double>&p = mesh.positions[v], &m = mesh.normals[v];
    bool good = true;
    const auto store = [&good](double x, float& to, float largest) {
      to = static_cast<float>(x);
      good = good && std::fabs(to) <= largest;
    };
    constexpr float any = std::numeric_limits<float>::max(), largest_normal = 0x1p28f;
    const double position[] = {p.x, p.y, p.z}, normal[] = {m.x, m.y, m.z}, uv[] = {uvs[v].x, uvs[v].y};
    for (std::size_t k = 0; k < 3; ++k) {
      store(position[k], positions[3 * v + k], any);
      store(normal[k], normals[3 * v + k], largest_normal);
    }
    for (std::size_t k = 0; k < 2; ++k) store(uv[k], texcoords[2 * v + k], any);
    finite[v] = good;
    if (good) continue;
    std::fill_n(&positions[3 * v], 3, 0.0f);
    std::fill_n(&normals[3 * v], 3, 0.0f);
    std::fill_n(&texcoords[2 * v], 2, 0.0f);
  }
  const auto whole = [&](const Triangle& t) { return finite[t[0]] && finite[t[1]] && finite[t[2]]; };
  std::vector<std::uint32_t> corners, place(mesh.corners(), none);  // place: index into corners
  std::vector<std::uint8_t> sizes;                                  // empty: all are triangles
  corners.reserve(mesh.corners());
  const auto add_face = [&](const auto& face, std::size_t first, std::size_t triangles) {
    for (std::size_t t = first; t < first + triangles; ++t)
      for (std::size_t k = 0; k < 3; ++k)
        place[3 * t + k] = static_cast<std::uint32_t>(
            corners.size() + static_cast<std::size_t>(
                                 std::find(face.begin(), face.end(), mesh.triangles[t][k]) - face.begin()));
    corners.insert(corners.end(), face.begin(), face.end());
    if (faces == MikktspaceFaces::quads) sizes.push_back(static_cast<std::uint8_t>(face.size()));
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!whole(mesh.triangles[t])) continue;
    std::optional<std::array<std::uint32_t, 4>> quad;
    if (faces == MikktspaceFaces::quads && t + 1 < mesh.triangles.size() && whole(mesh.triangles[t + 1]))
      quad = quad_of(mesh.triangles[t], mesh.triangles[t + 1]);
    if (quad)
      add_face(*quad, t++, 2);
    else
      add_face(mesh.triangles[t], t, 1);
  }
  std::vector<Vec4<float>> result(mesh.corners(), Vec4<float>{0, 0, 0, 0});
  if (corners.empty()) return {mesh, result, faces};
  std::vector<Vec4<float>> of_faces(corners.size());
  mikktspace(MikkMesh{positions, normals, texcoords, corners, sizes},
             std::span<float>(&of_faces[0].x, 4 * corners.size()),
             {.sort_all_edges = sort_all_edges, .unserved_sign = 0, .threads = threads});
  // A result along the normal, or of components whose squares underflow, is no direction.
  for (Vec4<float>& t : of_faces)
    if (const float square = dot(t.xyz(), t.xyz()); !(square > 0.25f && square < 4)) t = {0, 0, 0, 0};
  for (std::size_t c = 0; c < result.size(); ++c)
    if (place[c] != none) result[c] = of_faces[place[c]];
  return {mesh, result, faces};
}

std::size_t stored_corners(const Mesh& mesh, const MikktspaceReference& reference) {
  constexpr double same = 1e-5;  // tolerance for other orders of the same sums, in floats
  std::size_t result = 0;
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const std::uint32_t v = mesh.triangles[c / 3][c % 3];
    const Vec4<float>& m = reference.at(c, v);
    result +=
        m.w != 0 && norm(unit(mesh.tangents[v].xyz()) - direction_of(m)) <= same + tangent_rounding(mesh, v);
  }
  return result;
}

MikktspaceReference mikktspace_reference(const Mesh& mesh, std::span<const Vec2<double>> uvs, int threads) {
  MikktspaceReference of_triangles = mikktspace_reference(mesh, uvs, threads, MikktspaceFaces::triangles);
  const std::size_t given = stored_corners(mesh, of_triangles);
  if (given == mesh.corners() || !has_quads(mesh)) return of_triangles;
  MikktspaceReference of_quads = mikktspace_reference(mesh, uvs, threads, MikktspaceFaces::quads);
  const std::size_t by_quads = stored_corners(mesh, of_quads);
  return by_quads > given && 2 * by_quads >= mesh.corners() ? of_quads : of_triangles;
}

}  // namespace darboux
