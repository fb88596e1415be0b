#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <darboux/error.h>
#include <darboux/scene.h>

#include "base/linear_algebra.h"

namespace darboux {
namespace {

std::string text(double x) {
  std::string s = std::to_string(x);
  return std::isfinite(x) ? s.substr(0, s.find_last_not_of('0') + (s.back() == '0' ? 2 : 1)) : s;
}

void expect(bool holds, const char* what, const std::string& expected, const std::string& got) {
  if (!holds) throw ParameterError(what, "expected " + expected + ", got " + got);
}

}  // namespace

Eigen::Isometry3d Camera::look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                                  const Eigen::Vector3d& up) {
  const Eigen::Vector3d backward = (eye - target).normalized();
  const Eigen::Vector3d right = up.cross(backward);
  expect((eye - target).norm() > 0 && backward.allFinite(), "camera target", "a point other than the eye",
         "the eye");
  expect(right.norm() > 1e-12 * up.norm(), "camera up", "a direction that is not along the view",
         "one along it");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = right.normalized();
  pose.linear().col(1) = backward.cross(right.normalized());
  pose.linear().col(2) = backward;
  pose.translation() = eye;
  return pose;
}

Camera between(const Camera& from, const Camera& to, double t) {
  expect(from.projection == to.projection, "camera path", "cameras of one projection", "both");
  expect(from.width_px == to.width_px && from.height_px == to.height_px, "camera path",
         "images of one size, " + std::to_string(from.width_px) + " x " + std::to_string(from.height_px),
         std::to_string(to.width_px) + " x " + std::to_string(to.height_px));
  const auto mix = [&](double a, double b) { return a == b ? a : (1 - t) * a + t * b; };
  Camera result = from;
  const Eigen::Quaterniond a(from.pose.linear()), b(to.pose.linear());
  result.pose.linear() = a.normalized().slerp(t, b.normalized()).toRotationMatrix();
  result.pose.translation() = (1 - t) * from.pose.translation() + t * to.pose.translation();
  result.vertical_field_of_view_rad = mix(from.vertical_field_of_view_rad, to.vertical_field_of_view_rad);
  result.view_height = mix(from.view_height, to.view_height);
  result.near_distance = mix(from.near_distance, to.near_distance);
  const bool finite = std::isfinite(from.far_distance) && std::isfinite(to.far_distance);
  result.far_distance = t == 0   ? from.far_distance
                        : t == 1 ? to.far_distance
                        : finite ? mix(from.far_distance, to.far_distance)
                                 : std::numeric_limits<double>::infinity();
  return result;
}

void Camera::check() const {
  expect(pose.matrix().allFinite(), "camera pose", "finite numbers", "others");
  expect(is_rigid(pose, 1e-5), "camera pose", "a rotation and a translation", "another matrix");
  expect(width_px >= 1 && height_px >= 1, "image size", "at least 1 x 1 pixel",
         std::to_string(width_px) + " x " + std::to_string(height_px));
  expect(std::isfinite(near_distance) && far_distance > near_distance, "camera", "near < far",
         "near " + text(near_distance) + ", far " + text(far_distance));
  if (projection == Projection::perspective) {
    expect(vertical_field_of_view_rad > 0 && vertical_field_of_view_rad < std::numbers::pi, "field of view",
           "more than 0 and less than 180 degrees",
           text(vertical_field_of_view_rad * 180 / std::numbers::pi) + " degrees");
    expect(near_distance > 0, "camera", "near > 0", "near " + text(near_distance));
  } else {
    expect(view_height > 0 && std::isfinite(view_height), "view height", "a length > 0", text(view_height));
  }
}

}  // namespace darboux
