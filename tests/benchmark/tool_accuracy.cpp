#include "tool_accuracy.h"

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include <darboux/cone.h>
#include <darboux/cylinder.h>
#include <darboux/ellipsoid.h>
#include <darboux/placed_surface.h>
#include <darboux/plane.h>
#include <darboux/sphere.h>
#include <darboux/torus.h>

#include "assimp_mesh.h"
#include "torus_file.h"

namespace darboux::bench {
namespace {

constexpr std::array<std::string_view, 9> all_shapes{
    "sphere", "plainsphere", "torus", "ellipsoid", "sheartorus", "jittertorus", "cone", "cylinder", "capped"};
constexpr std::array<std::string_view, 7> all_tools{
    "three",  "mikktspace",    "gltf-transform", "meshoptimizer", "meshoptimizer-compatible",
    "assimp", "assimp-indexed"};

// Where the axes of a surface's own space lie.
Eigen::Isometry3d placed(const Eigen::Vector3d& x, const Eigen::Vector3d& y, const Eigen::Vector3d& z,
                         const Eigen::Vector3d& origin) {
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  placement.linear() << x, y, z;
  placement.translation() = origin;
  return placement;
}

const Eigen::Vector3d ex{1, 0, 0}, ey{0, 1, 0}, ez{0, 0, 1}, zero{0, 0, 0};

// The surfaces of a shape, as three.js lays them: u of its sphere runs from -x to +z, that of its cylinder
// from +z to +x, both about y. More than one: sides, top, bottom.
std::vector<PlacedSurface> surfaces_of(std::string_view shape) {
  const Eigen::Isometry3d round_sphere = placed(-ex, ez, ey, zero), upright = placed(ez, ex, ey, -ey);
  constexpr double radius = 1, height = 2;
  const PlacedSurface torus{Torus{1.0, 0.4}}, side{Cylinder{radius, height}, upright};
  if (shape == "sphere" || shape == "plainsphere") return {{Sphere{1.0}, round_sphere}};
  if (shape == "ellipsoid") return {{Ellipsoid{1.0, 0.5, 0.7}, round_sphere}};
  if (shape == "torus" || shape == "jittertorus") return {torus};
  if (shape == "sheartorus") return {{torus.surface, torus.placement, {"u - v/2", {1, -0.5, 0, 1, 0, 0}}}};
  // From radius 1 to 1/2: half of a cone of twice the height.
  if (shape == "cone") return {{Cone{radius, 2 * height}, upright, {"v/2", {1, 0, 0, 0.5, 0, 0}}}};
  if (shape == "cylinder") return {side};
  const Plane cap{2 * radius, 2 * radius};
  return {side, {cap, placed(ez, ex, ey, ey)}, {cap, placed(ez, -ex, -ey, -ey)}};
}

std::vector<Truth> truth_of(std::string_view shape, const Mesh& mesh) {
  const std::vector<PlacedSurface> surfaces = surfaces_of(shape);
  std::vector<Truth> truth;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double up = surfaces.size() > 1 ? mesh.normals[v].y : 0;
    truth.push_back(surfaces[up > 0.5 ? 1 : up < -0.5 ? 2 : 0].truth(mesh.uvs[v]));
    // A unit in the last place of a float of a uv near 1, times the steepest partial, 2π(R + r), and of the
    // position.
    if (!(norm(mesh.positions[v] - truth.back().position) < 1e-6))
      throw std::runtime_error(std::string(shape) + ": a vertex is not on the surface");
  }
  return truth;
}

// Tangents of corners, so each corner is a vertex.
Mesh mesh_of(const MeshArrays& soup) {
  Mesh mesh;
  for (std::size_t v = 0; v < soup.vertex_count(); ++v) {
    const float *p = &soup.positions[3 * v], *n = &soup.normals[3 * v], *uv = &soup.uvs[2 * v];
    mesh.positions.push_back({p[0], p[1], p[2]});
    mesh.normals.push_back({n[0], n[1], n[2]});
    mesh.uvs.push_back({uv[0], uv[1]});
  }
  for (std::uint32_t v = 0; v < mesh.positions.size(); v += 3) mesh.triangles.push_back({v, v + 1, v + 2});
  return mesh;
}

}  // namespace

std::span<const std::string_view> shapes() {
  return all_shapes;
}
std::span<const std::string_view> tools() {
  return all_tools;
}

std::size_t without_direction(const ClassReport& report) {
  return report.corners -
         report.tangent_uncertainty_deg.finite();  // the truth is exact: no deviation is infinite
}

std::vector<float> tangents_by(std::string_view tool, const std::filesystem::path& folder,
                               std::string_view shape) {
  if (!tool.starts_with("assimp")) return read_floats(folder / shape / tool);
  const MeshArrays indexed = read_mesh_arrays(folder / shape / "mesh");
  const MeshArrays mesh = tool == "assimp" ? unindexed(indexed) : indexed;
  AssimpMesh assimp(mesh);
  assimp.make_tangents();
  return assimp.tangents();
}

std::vector<ToolReport> assess_tools(const std::filesystem::path& folder, int n) {
  std::vector<ToolReport> reports;
  for (const std::string_view shape : all_shapes) {
    Mesh mesh = mesh_of(unindexed(read_mesh_arrays(folder / shape / "mesh")));
    const std::vector<Truth> truth = truth_of(shape, mesh);
    for (const std::string_view tool : all_tools) {
      const std::vector<float> tangents = tangents_by(tool, folder, shape);
      if (tangents.size() != 4 * mesh.corners())
        throw std::runtime_error(std::string(shape) + ", " + std::string(tool) +
                                 ": tangents of another number of corners");
      mesh.tangents.clear();
      for (std::size_t k = 0; k < tangents.size(); k += 4)
        mesh.tangents.push_back({tangents[k], tangents[k + 1], tangents[k + 2], tangents[k + 3]});
      reports.push_back({shape, tool, n, validate(mesh, truth)});
    }
  }
  return reports;
}

}  // namespace darboux::bench
