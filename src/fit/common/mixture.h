// The distribution of the residuals of points from a surface: inliers with Gaussian noise among outliers of
// constant density.
//
// A residual e, with as many components as the fit compares, is N(0, sigma^2 I) for an inlier. With E =
// exp(-|e|^2 / 2 sigma^2) and the density `outliers` of outliers over that of inliers at e = 0, a point is an
// inlier with probability E / (E + outliers).
//
// The fits differ in how they estimate `outliers`: primitives, which are unbounded, count residuals on either
// side of the inliers' (primitives/point_states.h); the other fits assume a volume over which the outliers
// are spread, and estimate their share of the points (MixtureInVolume).
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

namespace darboux::fit {

struct Mixture {
  double sigma = 1;
  double outliers = 0;         // 0: there are none, and the likelihood is that of least squares
  bool sigma_known = false;    // then it is not estimated
  double inliers = 1;          // the sum of their probabilities, if it was computed
  double least_sigma = 1e-15;  // no estimate is less

  // \param exponent |e|^2 / 2 sigma^2
  double inlier_probability(double exponent) const {
    if (outliers == 0) return 1;
    const double likelihood = std::exp(-exponent);
    return likelihood > 0 ? likelihood / (likelihood + outliers) : 0;
  }
  // log((E + outliers) / (1 + outliers)): the log likelihood of a residual over that of none.
  double log_likelihood_ratio(double exponent) const {
    if (outliers == 0) return -exponent;
    const double likelihood = std::exp(-exponent);
    const double sum = likelihood > outliers ? std::log1p(outliers / likelihood) - exponent
                                             : std::log1p(likelihood / outliers) + std::log(outliers);
    return sum - std::log1p(outliers);
  }
};

// The sums of the expectation step over the points, and the likeliest noise given these.
struct ExpectedInliers {
  double count = 0, squares = 0;

  void add(double probability, double weighted_square) {
    count += probability;
    squares += weighted_square;
  }
  // \param dimensions components of a residual
  void estimate_sigma(Mixture& mixture, int dimensions, double least) const {
    mixture.inliers = count;
    if (!mixture.sigma_known && count > 0)
      mixture.sigma = std::fmax(std::sqrt(squares / (dimensions * count)), least);
  }
};

// A mixture whose outliers are a share of all points, spread evenly over a volume about the surface.
struct MixtureInVolume : Mixture {
  static constexpr double root_two_pi = 2.506628274631001;

  int dimensions = 1;  // of residuals, and of the volume
  double share = 0, volume = 1;

  // Sets `outliers` from the other members.
  void compare_densities() {
    outliers =
        std::fmax(share / (1 - share) * std::pow(root_two_pi * sigma, dimensions) / volume,
                  std::numeric_limits<double>::min());  // never 0, however narrow the band of inliers is
  }
  // The log density of a residual, of the right scale.
  double log_likelihood(double exponent) const {
    return log_likelihood_ratio(exponent) + std::log1p(outliers) + std::log1p(-share) -
           dimensions * std::log(root_two_pi * sigma);
  }
};

// The standard deviation of noise and rounding of the input together, as if all inliers had the same rounding
// error, which does not average out: rows of a grid share theirs. Noise dithers it: the mean of a number's
// rounding is a wave over a step, 4 rounding, that noise damps by exp(-2 (pi noise / step)^2) [Widrow1996].
// sigma is that of noise and of rounding, whose square is at most 2 rounding^2; rounding is half of the
// greatest error.
inline double noise_and_rounding(double sigma, double rounding, double inliers) {
  constexpr double pi = std::numbers::pi;
  const double ratio = sigma / rounding, noise = std::fmax(0, ratio * ratio - 2) / 16;
  return std::hypot(sigma, std::sqrt(inliers) * rounding * std::exp(-2 * pi * pi * noise));
}

}  // namespace darboux::fit
