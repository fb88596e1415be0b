// One kind of surface found in a cloud of points that is centred and scaled to size 1, without a guess.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "noise.h"
#include "starts.h"

namespace darboux::fit {

using Covariance = Eigen::Matrix<double, 9, 9>;

// Where some of the points lead, from starts.
struct Lead {
  std::string_view kind;
  double score;  // log likelihood of the refined points, see find.cpp
  Natural surface;
  Vector3d at;  // a point of it, next to inliers
  Noise noise;
  int iterations = 0;  // of Ceres
};

// A surface with its uncertainty and what it says of every point.
struct Found {
  std::string_view kind;
  int freedom = 0;
  bool given_up = false;  // as another kind leads much further; then only measured
  bool converged = false;
  Natural surface;
  double sigma = 0, outliers = 0;  // see estimate.h
  Covariance covariance;           // of (rotation vector, movement of the point `reference`, lengths)
  Vector3d reference;
  double least_known = 0;  // standard deviation of the least known movement of the surface at the points
  double off_a_circle =
      0;  // distance of the inliers from one circle, root mean square, of each of its two directions
  std::vector<double> error;        // signed distance less its bias
  std::vector<unsigned char> kept;  // by the gate
  int iterations = 0;
};

struct Search {
  const Eigen::Matrix3Xd& cloud;
  const Oriented& oriented;
  std::optional<double> sigma;  // where it is known
  std::optional<Natural> guess;
  std::uint64_t seed;
  std::function<void(double)> progress;  // with the share of the work that is done, 0 to 1
};

// Calls f<Shape>() for each kind, in the order of preference.
template <class F>
void for_each_shape(F f) {
  f.template operator()<PlaneShape>();
  f.template operator()<SphereShape>();
  f.template operator()<CylinderShape>();
  f.template operator()<ConeShape>();
  f.template operator()<TorusShape>();
  f.template operator()<EllipsoidShape>();
}

// Nothing where no start leads to a surface.
template <class Shape>
std::optional<Lead> find(const Search& search);

// From there to the maximum of the likelihood over all points, unless it is given up.
template <class Shape>
Found refine(const Search& search, const Lead& lead, bool give_up);

}  // namespace darboux::fit
