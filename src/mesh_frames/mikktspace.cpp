// MikkTSpace as one of the methods.
#include <darboux/mikktspace.h>

#include "triangle.h"

namespace darboux {
namespace {

MeshFrames compute(const Mesh& mesh, int threads, bool own_bitangent) {
  MeshFrames result;
  std::vector<float> positions, normals, uvs;
  positions.reserve(3 * mesh.positions.size());
  normals.reserve(3 * mesh.positions.size());
  uvs.reserve(2 * mesh.positions.size());
  std::vector<std::uint32_t> corners;
  corners.reserve(mesh.corners());
  const auto append = [](std::vector<float>& to, std::initializer_list<double> values) {
    for (const double x : values) to.push_back(static_cast<float>(x));
  };
  for (const Vec3<double>& p : mesh.positions) append(positions, {p.x, p.y, p.z});
  for (const Vec3<double>& n : mesh.normals) append(normals, {n.x, n.y, n.z});
  for (const Vec2<double>& uv : mesh.uvs) append(uvs, {uv.x, uv.y});
  for (const Triangle& triangle : mesh.triangles) {
    count_degenerate(Face(mesh, triangle), result);
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  }
  if (corners.empty()) return result;
  const std::vector<MikkTangent> tangents =
      mikktspace(MikkMesh{positions, normals, uvs, corners, {}}, {.threads = threads});
  result.frames.reserve(corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const MikkTangent& x = tangents[c];
    const Vec3<double> n = unit(mesh.normals[corners[c]]), t{x.t[0], x.t[1], x.t[2]};
    const Vec3<double> b =
        own_bitangent ? Vec3<double>{x.b[0], x.b[1], x.b[2]} : double{x.sign} * cross(n, t);
    result.of_corner.push_back(static_cast<std::uint32_t>(c));
    result.frames.push_back(frame_or_fallback(t, b, n, x.sign));
    result.frames.back().fallback |= !x.served;
  }
  count_fallbacks(result);
  return result;
}

}  // namespace

MeshFrames compute_mikktspace(const Mesh& mesh, int threads) {
  return compute(mesh, threads, false);
}
MeshFrames compute_mikktspace_bitangent(const Mesh& mesh, int threads) {
  return compute(mesh, threads, true);
}

}  // namespace darboux
