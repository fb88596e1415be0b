// Which of several primitives the points speak for.
#pragma once

#include <string>
#include <vector>

#include "determinacy.h"

namespace darboux::fit {

struct Selection {
  std::vector<double> bic;         // one per fit
  std::vector<std::size_t> order;  // of the fits: the chosen one, then best first
  bool usable = false;
  std::string reason{};
};

// The fit with the smallest criterion, where nothing speaks for another.
Selection select(const std::vector<PrimitiveFit>& tried, double scale);

// Von Neumann's ratio of the inliers' errors: mean squared difference of neighbours over twice the variance.
// 1 for noise, less where neighbours are alike, as where the points lie on another surface.
double von_neumann_ratio(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& fit,
                         const std::vector<bool>& is_inlier);

}  // namespace darboux::fit
