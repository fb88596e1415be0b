// Where the search for a surface begins: surfaces through small random samples of oriented points, by linear
// equations.
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "base/evenly_chosen.h"
#include "model.h"

namespace darboux::fit {

// Points with normals of unknown sign, column by column.
struct Oriented {
  Eigen::Matrix3Xd points, normals;
};

// Points of the cloud with a normal each. Their own where there are any (as many columns as the cloud, of any
// length, zero or not finite for none); else from the principal axes of their neighbours, of the two thirds
// whose neighbourhood is flattest, so that few of them are outliers (all where there are no more than 20).
Oriented oriented_points(const Eigen::Matrix3Xd& cloud, const Eigen::Matrix3Xd& normals,
                         std::mt19937_64& random);

// The surface that fits the sample best in the sense of linear equations; nothing where they do not determine
// one.
template <class Shape>
std::optional<Natural> start(const Oriented& sample);
// The size of the smallest sample worth trying.
template <class Shape>
inline constexpr int least_sample = 3;
template <>
inline constexpr int least_sample<PlaneShape> = 1;
template <>
inline constexpr int least_sample<SphereShape> = 4;
template <>
inline constexpr int least_sample<CylinderShape> = 2;
template <>
inline constexpr int least_sample<TorusShape> = 5;
template <>
inline constexpr int least_sample<EllipsoidShape> = 10;

}  // namespace darboux::fit
