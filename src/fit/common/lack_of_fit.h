// Whether the residuals of a fit are noise.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

namespace darboux::fit {

// The inliers of a fit.
struct Leftovers {
  Eigen::MatrixXd errors;  // a column per point: its distance, or a vector to its place on the surface
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd places;  // on the surface: the noise across it must not decide which points are neighbours
  // The derivatives of the errors with respect to the unknowns, at some points: a row per error, those of a
  // point together.
  std::function<Eigen::MatrixXd(const std::vector<Eigen::Index>&)> derivatives;
};

// Whether errors of neighbours are correlated, as when the points lie on another surface. There are two
// tests. In both, the correlated share must exceed a quarter of the errors' variance, so that sigma is
// clearly not the noise:
// - groups of 2, 4, 8 and 16 neighbours on the surface have different means: analysis of variance
//   [Fisher1925, sec. 38 to 40]. Noise fails with a probability of 1e-6 for each size.
// - polynomials in the places, of some degree up to 6, of vectors up to 4, explain the errors beyond what the
//   surface's own parameters do: the F test for lack of fit [DraperSmith1998, ch. 6]. This also works for few
//   points, which have no near neighbours. Noise fails with a probability of 1e-5 for each degree. At most
//   256 points are used. Points of a grid are not tested, as their roundings repeat.
bool neighbours_are_alike(const Leftovers& leftovers);

}  // namespace darboux::fit
