// What a found surface is worth: whether the points determine it, and which of several kinds they speak for.
#pragma once

#include <string>
#include <vector>

#include "find.h"

namespace darboux::fit {

// The side of a direction whose largest component is positive.
Vector3d positive_side(const Vector3d& a);

struct Verdict {
  enum class Kind {
    good,
    unsure,  // of this kind the points may still be: not converged, or some of it is not told
    none     // what was found explains nothing
  };
  Kind kind = Kind::good;
  std::string why{};  // goes on after the name of the kind: "an ellipsoid " + why
};

// Whether the points determine the surface.
Verdict judge(const Found& found);

// A torus that crosses itself has two sheets near almost any point; it is found only where it is asked for.
bool crosses_itself(std::string_view kind, const Natural& surface);

// Bayesian information criterion of every candidate, smaller is better [Schwarz1978]. On one footing: the
// noise, the outliers' density and the gate are those of candidate `reference`, so that only the distances
// differ.
std::vector<double> criteria(const std::vector<Found>& candidates, std::size_t reference);

// Log likelihood of k inliers in a Gaussian band of distances, the others spread evenly over distances up to
// the points' size, over that of all spread evenly.
double evidence(const Found& found);

// Whether the inliers' errors are noise, or neighbours' errors are alike, as where the points lie on another
// surface: mean squared difference of neighbours over twice the variance. 1 for noise.
double unlikeness_of_neighbours(const Eigen::Matrix3Xd& cloud, const Found& found,
                                const std::vector<bool>& is_inlier);

// The least length k of the surface that the points permit: its curvature, three standard errors more.
double least_length(const Found& found, std::size_t k);

}  // namespace darboux::fit
