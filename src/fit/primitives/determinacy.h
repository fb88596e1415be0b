// Whether the points determine a primitive that was fitted to them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "refine.h"

namespace darboux::fit {

struct Determinacy {
  enum class Kind {
    good,
    unsure,    // of this kind the points may still be: not converged, or some of it is not identifiable
    unproven,  // too few points, or too much noise, to tell it from chance
    none       // what was found explains nothing
  };
  Kind kind = Kind::good;
  std::string why{};  // goes on after the name of the kind: "an ellipsoid " + why
};

Determinacy determinacy(const PrimitiveFit& fit);

// Limits of a fit: the largest noise, over the points' size, and the least radius of curvature, over the
// noise.
inline constexpr double largest_sigma = 0.2, least_radius_over_sigma = 5;

// The share of the points that the answer has at least, where no kind was named.
inline constexpr double enough_inliers = 0.4;

// A fit to within this share of the points' size is exact: roundings are not compared.
inline constexpr double exact = 1e-12;

// Log likelihood of k inliers in a Gaussian band of distances, the others spread evenly over distances up to
// `range`, over that of all spread evenly up to 1, the points' size.
double log_likelihood_ratio(double inliers, double points, double sigma, int unknowns, double range = 1);
double log_likelihood_ratio(const PrimitiveFit& fit);

// The range of outliers whose distances have this mean. Where they lie near the surface, as a cluster or all
// that is in a thin box, taking them for far ones would make inliers of them, and noise of their distances.
// No range is so short that it would explain noise better than a Gaussian does; nor, beside few inliers, is
// the range that of outliers.
double range_of_outliers(double mean_distance, double sigma, double share_of_inliers);

// Which columns of the points are inliers.
std::vector<bool> inliers_of(const PrimitiveFit& fit);
std::ptrdiff_t count_inliers(const PrimitiveFit& fit);

// The noise, and beside it roundings, which without noise may be alike at all points: what they add up to
// does not go down with the number of points.
double noise_and_rounding(const PrimitiveFit& fit);

// Whether it may be the answer where no kind was named.
bool explains_enough(const PrimitiveFit& fit);

// Whether two fits of one primitive are one surface: lengths and axes within six standard errors. Equal ones
// at different places are one hypothesis: the likelier one is taken.
bool are_same(const PrimitiveFit& a, const PrimitiveFit& b);

// "(0.6, 0, 0.8)", the same for a direction and its opposite.
std::string direction_text(const Vector3d& direction);

// Standard deviation of length k.
double deviation(const PrimitiveFit& fit, std::size_t k);

// How many standard errors off a number may be: three, and with few points, which know the noise badly, as
// many as Student's t has at 99 %.
double most_deviations(const PrimitiveFit& fit);

// The least length k of the surface that the points allow: its curvature, most_deviations() more.
double least_length(const PrimitiveFit& fit, std::size_t k);

}  // namespace darboux::fit
