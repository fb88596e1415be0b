// How well a fitted surface is determined: what the points tell about it, how well, and whether that makes a
// surface of the kind at all.
#pragma once

#include <string>
#include <vector>

#include <darboux/fit_points.h>

#include "estimate.h"

namespace darboux::fit::catalogue {

// What the points tell of the unknowns at the estimate.
ReducedNormalEquations information(const Estimate& e, const Positions& points, const Eigen::VectorXd& units,
                                   double size);

// Gives the fit the covariance at this noise over the size, known to some degrees of freedom, and standard
// errors and intervals. Returns what was held, each as "; ...".
std::string add_covariance(const Estimate& e, const ReducedNormalEquations& known,
                           const Eigen::VectorXd& units, double noise, double degrees_of_freedom,
                           PointFit& fit);

// Sets the patch's lengths that the points do not determine, and those that may grow together without
// changing the surface, so that the patch just encloses the inliers in the coordinates that end. Returns
// whether anything changed.
bool enclose(Estimate& e, const ReducedNormalEquations& known, const Positions& inliers,
             const std::vector<Vec2<double>>& feet, double size);

// Why the points do not determine the surface that was found, to follow "the best ... found"; empty where
// they do.
std::string against(const Estimate& e, const PointFit& fit, const ReducedNormalEquations& known,
                    const Eigen::VectorXd& units, const std::vector<bool>& lengths, double size);

// Whether a plane explains the inliers as well, by the criterion that decides between kinds.
bool plane_is_as_good(const Positions& inliers, double rms, double unknowns, double size);

}  // namespace darboux::fit::catalogue
