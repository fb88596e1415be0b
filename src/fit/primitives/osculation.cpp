#include "osculation.h"

#include "base/linear_algebra.h"

namespace darboux::fit {

std::optional<Osculation> osculation(const Primitive& primitive, const LocalModel& model,
                                     const Vector3d& near, const Circle3& circle) {
  constexpr double step = 1e-4;
  const Matrix3d rotation = model.rotation.toRotationMatrix();
  const auto feet = [&](const Eigen::Matrix3Xd& points) {
    Eigen::Matrix3Xd local;
    primitive.distance.foot_points(points, model, local);
    return Eigen::Matrix3Xd((rotation * local).colwise() + model.origin);
  };
  const Vector3d at = feet(near).col(0);
  // At least one of three nearby points is well off the surface; the normal leads there from its foot.
  const Eigen::Matrix3Xd beside = (step * Matrix3d::Identity()).colwise() + at;
  const Eigen::Matrix3Xd from_feet = beside - feet(beside);
  Eigen::Index best = 0;
  from_feet.colwise().norm().maxCoeff(&best);
  const Vector3d normal = from_feet.col(best).normalized();
  const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  const Eigen::Matrix3Xd off =
      (step * (Matrix3d() << Vector3d::Zero(), u, v).finished()).colwise() + (at + step * normal);
  const Eigen::Matrix3Xd normals = (off - feet(off)).colwise().normalized();
  Eigen::Matrix2d shape;  // positive where the normal turns back: the centre lies along it
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Vector3d turned = (normals.col(0) - normals.col(k + 1)) / step;
    shape.col(k) << turned.dot(u), turned.dot(v);
  }
  if (!shape.allFinite() || !at.allFinite()) return std::nullopt;
  const auto [values, vectors] = symmetric_eigen(Eigen::MatrixXd(0.5 * (shape + shape.transpose())));
  Osculation result{at, {}, {values[0], values[1]}, circle};
  for (Eigen::Index k = 0; k < 2; ++k) result.frame.col(k) = vectors(0, k) * u + vectors(1, k) * v;
  result.frame.col(2) = normal;
  return result;
}

}  // namespace darboux::fit
