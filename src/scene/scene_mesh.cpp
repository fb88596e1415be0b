#include <cmath>
#include <vector>

#include <darboux/scene_mesh.h>
#include <darboux/vector.h>

namespace darboux {
namespace {

// The cone of the triangles' normals: its axis and half-angle.
void bound_normals(const Mesh& mesh, SceneMeshPart& part) {
  std::vector<Eigen::Vector3d> normals;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) { return to_eigen(mesh.positions[t[i]]); };
    const Eigen::Vector3d n = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    if (!n.allFinite()) return;
    if (n.norm() == 0) continue;  // it covers nothing
    normals.push_back(n.normalized());
    sum += normals.back();
  }
  if (!(sum.norm() > 0)) return;
  const Eigen::Vector3d axis = sum.normalized();
  double half_angle = 0;
  for (const Eigen::Vector3d& n : normals)
    half_angle = std::fmax(half_angle, std::atan2(axis.cross(n).norm(), axis.dot(n)));
  part.axis = axis;
  part.half_angle_rad = half_angle;
}

}  // namespace

SceneMeshPart SceneMeshPart::of(const Mesh& mesh, std::uint32_t material) {
  check_consistent(mesh, "mesh");
  SceneMeshPart part;
  part.material = material;
  part.vertices = mesh.positions.size();
  for (const Vec3<double>& position : mesh.positions) {
    part.box.extend(to_eigen(position));
    part.moves = part.moves || !to_eigen(position).allFinite();
  }
  bound_normals(mesh, part);
  return part;
}

}  // namespace darboux
