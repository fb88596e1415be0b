#include <algorithm>
#include <cmath>

#include "chart_mesh.h"

namespace darboux {
namespace {

std::uint32_t append_copy(Mesh& mesh, std::uint32_t v) {
  mesh.positions.push_back(Vec3<double>(mesh.positions[v]));
  mesh.normals.push_back(Vec3<double>(mesh.normals[v]));
  mesh.uvs.push_back(Vec2<double>(mesh.uvs[v]));
  mesh.tangents.push_back(Vec4<double>(mesh.tangents[v]));
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

// The k-th of `count` triangles spread over `of`.
std::size_t spread(int k, int count, std::size_t of) {
  return static_cast<std::size_t>(k) * of / static_cast<std::size_t>(count);
}

std::pair<std::uint32_t, std::uint32_t> shortest_edge(const Mesh& mesh, const Triangle& triangle) {
  const auto length = [&](int k) {
    return norm(mesh.positions[triangle[(k + 1) % 3]] - mesh.positions[triangle[k]]);
  };
  int shortest = 0;
  for (const int k : {1, 2})
    if (length(k) < length(shortest)) shortest = k;
  return {triangle[shortest], triangle[(shortest + 1) % 3]};
}

// Rounds to multiples of a step so large that a float holds the midpoint of any two.
void round_positions(Mesh& mesh) {
  double largest = 0;
  for (const Vec3<double>& p : mesh.positions)
    largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  if (!(largest > 0)) return;
  const int e = std::ilogb(largest) - 22;
  const auto rounded = [e](double x) { return std::scalbn(std::nearbyint(std::scalbn(x, -e)), e); };
  for (Vec3<double>& p : mesh.positions) p = {rounded(p.x), rounded(p.y), rounded(p.z)};
}

}  // namespace

void round_uvs(ChartMesh& chart) {
  const auto rounded = [](double x) { return std::nearbyint(x * 0x1p20) * 0x1p-20; };
  for (ChartVertex& vertex : chart.vertices) vertex.uv = {rounded(vertex.uv.x), rounded(vertex.uv.y)};
}

void add_degenerate_triangles(Mesh& mesh, const std::vector<ChartVertex>& chart, const VertexMaker& make,
                              int count) {
  round_positions(mesh);
  const std::size_t sound = mesh.triangles.size();
  for (int k = 0; k < count; ++k) {
    const auto [a, b] = shortest_edge(mesh, mesh.triangles[spread(k, count, sound)]);
    switch (k % 3) {
      case 0: {
        const ChartVertex &from = chart[a], &to = chart[b];
        const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
        make.append(mesh, {(from.uv + to.uv) / 2.0, from.second_half});
        mesh.positions[middle] = (mesh.positions[a] + mesh.positions[b]) / 2.0;
        mesh.triangles.push_back({a, middle, b});
        break;
      }
      case 1:
        mesh.triangles.push_back({a, b, append_copy(mesh, a)});
        break;
      default:
        mesh.triangles.push_back({a, b, b});
    }
  }
}

void collapse_uvs(Mesh& mesh, std::size_t of, int count) {
  std::vector<std::uint32_t> uses(mesh.positions.size(), 0);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) ++uses[v];
  for (int k = 0; k < count; ++k) {
    Triangle& triangle = mesh.triangles[spread(k, count, of)];
    for (std::uint32_t& v : triangle) {
      if (uses[v] == 1) continue;  // its own already
      --uses[v];
      v = append_copy(mesh, v);
    }
    const Vec2<double> first = mesh.uvs[triangle[0]];
    mesh.uvs[triangle[2]] = first;
    if (k % 2 == 0) mesh.uvs[triangle[1]] = first;
  }
}

}  // namespace darboux
