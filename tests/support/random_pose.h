// Random rigid placements.
#pragma once

#include <random>

#include <Eigen/Geometry>

#include <darboux/mesh.h>

namespace darboux {

inline Eigen::Isometry3d random_pose(std::mt19937_64& random, double offset) {
  std::normal_distribution<double> normal;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                      .normalized()
                      .matrix();
  pose.translation() = offset * Eigen::Vector3d(normal(random), normal(random), normal(random));
  return pose;
}

inline void place(Mesh& mesh, const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d rotation = pose.linear();
  for (auto& p : mesh.positions) p = from_eigen(pose * to_eigen(p));
  for (auto& n : mesh.normals) n = from_eigen(rotation * to_eigen(n));
  for (auto& t : mesh.tangents) {
    const auto r = from_eigen(rotation * to_eigen(t.xyz()));
    t = {r.x, r.y, r.z, t.w};
  }
}

}  // namespace darboux
