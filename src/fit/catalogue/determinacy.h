// How well the points determine a fitted surface, and whether the result is a surface of the kind at all.
#pragma once

#include <string>
#include <vector>

#include <darboux/fit_points.h>

#include "estimate.h"

namespace darboux::fit::catalogue {

// The information that the points give on the unknowns at the estimate.
ReducedNormalEquations information(const Estimate& e, const Positions& points, const Eigen::VectorXd& units,
                                   double size);

// Sets covariance, standard errors and intervals of the fit, for this noise over the size with its degrees of
// freedom. Returns a text of what was held, each as "; ...".
std::string add_covariance(const Estimate& e, const ReducedNormalEquations& known,
                           const Eigen::VectorXd& units, double noise, double degrees_of_freedom,
                           PointFit& fit);

// Sets lengths of the patch that the points do not determine, and lengths that may grow together without
// changing the surface, so that the patch just encloses the inliers in its bounded coordinates. Returns
// whether anything changed.
bool enclose(Estimate& e, const ReducedNormalEquations& known, const Positions& inliers,
             const std::vector<Vec2<double>>& feet, double size);

// Why the points do not determine the surface that was found, as a text to follow "the best ... found"; empty
// if they do.
std::string against(const Estimate& e, const PointFit& fit, const ReducedNormalEquations& known,
                    const Eigen::VectorXd& units, const std::vector<bool>& lengths, double size);

// Whether a plane explains the inliers equally well, by the criterion that decides between kinds.
bool plane_is_as_good(const Positions& inliers, double rms, double unknowns, double size);

}  // namespace darboux::fit::catalogue
