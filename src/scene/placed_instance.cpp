#include "placed_instance.h"

#include <cmath>
#include <string>

#include <darboux/error.h>

#include "base/linear_algebra.h"

namespace darboux {
namespace {

ParameterError wrong_placement(std::uint32_t instance, const char* what) {
  return {"instance " + std::to_string(instance),
          std::string("expected a placement that is finite and invertible, got ") + what};
}

struct Inverse {
  Eigen::Matrix3d matrix;
  double rounding;  // of its products, times the condition
};

// The inverse of M, and the factors by which M scales lengths.
Inverse inverse_of(const Eigen::Matrix3d& m, std::uint32_t instance, Placed& placed) {
  const Eigen::Vector3d squares(m.col(0).dot(m.col(0)), m.col(1).dot(m.col(1)), m.col(2).dot(m.col(2))),
      products(m.col(0).dot(m.col(1)), m.col(1).dot(m.col(2)), m.col(2).dot(m.col(0)));
  const double scale = squares.sum() / 3;
  // Mᵀ M / scale is 1 up to 3e-14 < 2^-44, and so are products. Squares neither underflow nor overflow.
  if (scale > 1e-280 && scale < 1e280 && (squares.array() - scale).abs().maxCoeff() <= 1e-14 * scale &&
      products.cwiseAbs().maxCoeff() <= 1e-14 * scale) {
    const double length = std::sqrt(scale);
    placed.smallest = length * (1 - 1e-13);
    placed.largest = length * (1 + 1e-13);
    placed.condition = 1;
    return {m.transpose() * (1 / scale), 0x1p-44 + 0x1p-48};
  }
  const SingularValues svd = singular_value_decomposition(m);
  const Eigen::Vector3d& s = svd.values;
  if (!(s[2] > 1e-12 * s[0])) throw wrong_placement(instance, "a singular one");
  placed.smallest = s[2] * (1 - 1e-13);
  placed.largest = s[0] * (1 + 1e-13);
  placed.condition = placed.largest / placed.smallest;
  // Cofactors would lose the square of the condition.
  return {svd.v * s.cwiseInverse().asDiagonal() * svd.u.transpose(), 0x1p-48};
}

}  // namespace

void place(const Scene& scene, std::uint32_t index, const SurfaceTiles& tiles, const View& view,
           Placed& result) {
  const SceneInstance& instance = scene.instances[index];
  const Eigen::Matrix3d m = instance.placement.linear();
  const Eigen::Vector3d t = instance.placement.translation();
  if (!((0 * m).sum() + (0 * t).sum() == 0)) throw wrong_placement(index, "one that is not finite");
  const Inverse inverse = inverse_of(m, index, result);
  constexpr double rounding = 0x1p-48;
  const double lengths = view.distance_of_eye() + t.norm();
  result.eye =
      from_eigen(inverse.matrix * (view.perspective() ? Eigen::Vector3d(view.eye() - t) : view.backward()));
  // Includes the loss by inverting an ill-conditioned placement.
  result.eye_rounding =
      inverse.rounding * result.condition * (view.perspective() ? lengths : 1) / result.smallest;
  result.plane_rounding = rounding * (lengths + result.largest * tiles.reach());
  result.displacement = scene.materials[instance.material].displacement;

  result.centre = m * Eigen::Vector3d(tiles.centre().x, tiles.centre().y, tiles.centre().z) + t;
  const Eigen::Vector3d& centre = result.centre;
  const double surrounds = result.displacement + result.plane_rounding,
               reach = result.largest * tiles.radius() + surrounds;
  double inside = std::numeric_limits<double>::infinity();
  result.within = inside;
  result.planes = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    const Plane3& plane = view.planes()[k];
    const double beyond = plane.normal.dot(centre) - plane.offset;
    inside = beyond < inside ? beyond : inside;
    if (beyond > reach)
      result.within = beyond - reach < result.within ? beyond - reach : result.within;
    else
      result.planes |= static_cast<std::uint8_t>(1u << k);
  }
  result.away = -inside - reach;
  const Eigen::Vector3d forward = -view.backward();
  const double depth_of_eye = forward.dot(view.eye());
  result.least_depth = forward.dot(centre) - depth_of_eye - reach;
  result.depth_normal = from_eigen(m.transpose() * forward);
  result.depth_offset = depth_of_eye - forward.dot(t);
  result.farthest = (view.eye() - centre).norm() + result.largest * tiles.radius() + surrounds;
  if (result.away > 0) return;
  for (std::size_t k = 0; k < 6; ++k) {
    if (!(result.planes >> k & 1)) continue;
    const Plane3& plane = view.planes()[k];
    result.normals[k] = from_eigen(m.transpose() * plane.normal);
    result.offsets[k] = plane.offset - plane.normal.dot(t);
  }
}

}  // namespace darboux
