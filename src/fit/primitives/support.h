// Which part of an unbounded surface the points cover: outliers on its continuation have high leverage, and
// nothing else reveals them.
#pragma once

#include <Eigen/Core>

#include "primitive.h"

namespace darboux::fit {

// Sets states.in_support. The surface is cut into cells; a cell keeps its points where their density is at
// least 0.3 of the median one, over the points. Few points: fewer cells, or none.
void find_support(const Primitive& primitive, const Eigen::Matrix3Xd& cloud,
                  const GeometricParameters& surface, const Mixture& mixture, PointStates& states);

}  // namespace darboux::fit
