// Whether the points determine the primitive fitted to them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "refine.h"

namespace darboux::fit {

struct Determinacy {
  enum class Kind {
    good,
    unsure,    // the points may still be of this kind: not converged, or not all identifiable
    unproven,  // too few points, or too much noise, to exclude chance
    none       // the surface found explains nothing
  };
  Kind kind = Kind::good;
  std::string why{};  // text to follow the name of the kind: "an ellipsoid " + why
};

Determinacy determinacy(const PrimitiveFit& fit);

// Limits of a fit: the largest noise, over the points' size, and the least radius of curvature, over the
// noise.
inline constexpr double largest_sigma = 0.2, least_radius_over_sigma = 5;

// The least share of the points that are inliers of the answer, if no kind was named.
inline constexpr double enough_inliers = 0.4;

// A fit within this share of the points' size counts as exact: roundings are not compared.
inline constexpr double exact = 1e-12;

// Log likelihood ratio of two models: k inliers in a Gaussian band of distances and the others spread evenly
// over distances up to `range`; and all points spread evenly up to 1, the points' size.
double log_likelihood_ratio(double inliers, double points, double sigma, int unknowns, double range = 1);
double log_likelihood_ratio(const PrimitiveFit& fit);

// The range of outliers whose distances have this mean. Outliers may lie near the surface, as a cluster or
// all within a thin box. If the range assumed that they are far, they would be taken for inliers, and their
// distances for noise. The range is never so short that it explains noise better than a Gaussian, and with
// few inliers it is not taken from the distances.
double range_of_outliers(double mean_distance, double sigma, double share_of_inliers);

// Which columns of the points are inliers.
std::vector<bool> inliers_of(const PrimitiveFit& fit);
std::ptrdiff_t count_inliers(const PrimitiveFit& fit);

// The noise together with rounding. Without noise, rounding may be the same at all points, so its effect does
// not fall with the number of points.
double noise_and_rounding(const PrimitiveFit& fit);

// Whether it explains enough to be the answer if no kind was named.
bool explains_enough(const PrimitiveFit& fit);

// Whether two fits of one primitive are one surface: lengths and axes agree within six standard errors. Equal
// surfaces at different places count as one hypothesis, of which the likelier is taken.
bool are_same(const PrimitiveFit& a, const PrimitiveFit& b);

// "(0.6, 0, 0.8)", the same for a direction and its opposite.
std::string direction_text(const Vector3d& direction);

// Standard deviation of length k.
double deviation(const PrimitiveFit& fit, std::size_t k);

// How many standard errors a number may be off: three, or, with few points, which determine the noise badly,
// the 99 % quantile of Student's t.
double most_deviations(const PrimitiveFit& fit);

// The least length k that the points allow: that of its curvature plus most_deviations() standard errors.
double least_length(const PrimitiveFit& fit, std::size_t k);

}  // namespace darboux::fit
