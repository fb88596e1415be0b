// The view frustum of a camera, as inequalities.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include <darboux/scene.h>

namespace darboux {

// Inside where normal · P >= offset; |normal| = 1.
struct Plane3 {
  Eigen::Vector3d normal;
  double offset;
};

class View {
 public:
  explicit View(const Camera& camera);

  bool perspective() const { return perspective_; }
  const Eigen::Vector3d& eye() const { return eye_; }
  double distance_of_eye() const { return distance_of_eye_; }  // from the origin
  Eigen::Vector3d backward() const { return backward_; }       // towards an orthographic camera
  double near_distance() const { return near_; }
  // A visible point is at most this many times its depth away from the eye.
  double stretch() const { return stretch_; }
  const std::array<Plane3, 6>& planes() const { return planes_; }

  // The length by which a visible point at this distance from the eye or farther may move so that its
  // projection moves by at most `pixels`.
  double length_of(double pixels, double distance) const;

 private:
  bool perspective_;
  Eigen::Vector3d eye_, backward_;
  double distance_of_eye_, near_, per_pixel_, stretch_;
  std::array<Plane3, 6> planes_;
};

}  // namespace darboux
