#include "mesh_parts.h"

#include <cmath>

namespace darboux {
namespace {

constexpr double rounding = 0x1p-40;

}  // namespace

bool is_outside(const SceneMeshPart& part, const Eigen::Affine3d& placement, double displacement,
                const View& view) {
  for (const Plane3& plane : view.planes()) {
    if (!std::isfinite(plane.offset)) continue;
    const Eigen::Vector3d n = placement.linear().transpose() * plane.normal;
    const Eigen::Vector3d farthest =
        (n.array() < 0).select(part.box.min().array(), part.box.max().array()).matrix();
    const double along = plane.normal.dot(placement.translation());
    const double size = n.cwiseAbs().dot(farthest.cwiseAbs()) + std::fabs(along) + std::fabs(plane.offset);
    if (n.dot(farthest) + along - plane.offset + displacement < -rounding * size) return true;
  }
  return false;
}

// n · (eye - p) is at most |eye - c| cos(φ - θ) + r: φ the angle to the axis of the cone of θ, c and r the
// centre and radius of the box. A mirror turns the winding and the side that it shows: in the mesh's own
// space nothing changes.
bool faces_away(const SceneMeshPart& part, const Eigen::Affine3d& placement, const View& view) {
  const Eigen::Matrix3d m = placement.linear();
  if (!(std::fabs(m.determinant()) > 1e-3 * m.colwise().norm().prod())) return false;
  const Eigen::Matrix3d inverse = m.inverse();
  const bool perspective = view.perspective();
  const Eigen::Vector3d towards =
      perspective ? Eigen::Vector3d(inverse * (view.eye() - placement.translation()) - part.box.center())
                  : Eigen::Vector3d(inverse * view.backward());
  const double angle = std::atan2(part.axis.cross(towards).norm(), part.axis.dot(towards));
  const double radius = perspective ? part.box.diagonal().norm() / 2 : 0;
  const double size = towards.norm() + radius + part.box.center().norm();
  return towards.norm() * std::cos(std::fmax(0, angle - part.half_angle_rad)) + radius < -rounding * size;
}

}  // namespace darboux
