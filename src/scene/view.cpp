#include "view.h"

#include <cmath>
#include <limits>

namespace darboux {

View::View(const Camera& camera)
    : perspective_(camera.projection == Camera::Projection::perspective),
      eye_(camera.pose.translation()),
      backward_(camera.pose.linear().col(2)),
      distance_of_eye_(eye_.norm()),
      near_(camera.near_distance) {
  const Eigen::Matrix3d axes = camera.pose.linear();
  const double aspect = double(camera.width_px) / camera.height_px;
  const double half_y =
      perspective_ ? std::tan(camera.vertical_field_of_view_rad / 2) : camera.view_height / 2;
  const double half_x = half_y * aspect;
  // Per unit of distance of a perspective camera.
  per_pixel_ = 2 * half_y / camera.height_px;
  stretch_ = perspective_ ? std::sqrt(1 + half_x * half_x + half_y * half_y) : 1;
  const auto plane = [&](double x, double y, double z, double offset) {
    const Eigen::Vector3d n = (axes * Eigen::Vector3d(x, y, z)).normalized();
    return Plane3{n, n.dot(eye_) + offset};
  };
  const double far = camera.far_distance;
  planes_[0] = plane(0, 0, -1, near_);
  planes_[1] = plane(0, 0, 1, -far);
  if (perspective_) {
    planes_[2] = plane(1, 0, -half_x, 0);
    planes_[3] = plane(-1, 0, -half_x, 0);
    planes_[4] = plane(0, 1, -half_y, 0);
    planes_[5] = plane(0, -1, -half_y, 0);
  } else {
    planes_[2] = plane(1, 0, 0, -half_x);
    planes_[3] = plane(-1, 0, 0, -half_x);
    planes_[4] = plane(0, 1, 0, -half_y);
    planes_[5] = plane(0, -1, 0, -half_y);
  }
}

// At a depth z, on a ray at the angle θ to the axis, a move by e changes the projection onto the image plane
// at unit depth by at most e / (cos θ (z - e)): among moves perpendicular to the ray the radial one appears
// longest, and the move may bring the point nearer. With cos θ >= 1/s and z >= D/s that is e s² / (D - e
// s).
double View::length_of(double pixels, double distance) const {
  if (!std::isfinite(pixels)) return std::numeric_limits<double>::infinity();
  const double c = pixels * per_pixel_;
  if (!perspective_) return c;
  return c * distance / (stretch_ * (stretch_ + c));
}

}  // namespace darboux
