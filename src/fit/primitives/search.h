// Searches for a primitive: surfaces through small random samples, of which the best descend to a maximum of
// the likelihood over part of the points.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "osculation.h"
#include "primitive.h"

namespace darboux::fit {

// The problem of a search: points that are centred and scaled to size 1.
enum class Effort {
  full,
  plain  // for points that lie on the surface to rounding, or on none: such a surface is found at once
};

struct SearchProblem {
  const Eigen::Matrix3Xd& cloud;
  const OrientedPoints& oriented;
  std::optional<double> sigma;  // where it is known
  std::optional<GeometricParameters> guess;
  std::uint64_t seed;
  Effort effort;
  std::function<void(double)> progress;  // with the share of the work that is done, 0 to 1
  bool may_cross_itself = true;          // whether surfaces that cross themselves are searched for
  double least_sigma = Mixture{}.least_sigma;
  double rounding = 0;  // see NormalisedPoints
};

// A surface that some of the points suggest.
struct Hypothesis {
  const Primitive* primitive;
  double log_likelihood_ratio;  // over points spread evenly; see search.cpp
  GeometricParameters surface;
  Vector3d at;  // a point of it, near inliers
  Mixture mixture;
  int iterations = 0;  // of Ceres
};

struct Score {
  double log_likelihood_ratio = -std::numeric_limits<double>::infinity(), band = 0;
};

struct Candidate {
  LocalModel model;
  Score score;
  Mixture mixture{};
  bool refused = false;  // will be refused in the end, however likely: see determinacy()
  double share_of_inliers = 0;
};

// Whether the normals are near one direction: on a small patch, surfaces of several kinds look alike.
bool covers_little(const OrientedPoints& points);

// The search for one primitive, in rounds.
class Search {
 public:
  Search(const SearchProblem& problem, const Primitive& primitive);

  const Primitive& primitive() const { return primitive_; }
  // Descends from the best of some new starts.
  void look();
  // Also, if not settled, from one that the primitive can find among many outliers.
  void look_among_outliers();
  // Whether the best surface was reached so often, from different starts, that the search can end.
  bool is_settled() const { return agreeing_ >= enough_; }
  int rounds() const { return round_; }
  // Whether another round may help.
  bool is_open() const { return !is_settled() && round_ < rounds_; }
  // The log likelihood ratio of the best surface over points spread evenly; of a refused one if there is no
  // other.
  double log_likelihood_ratio() const;
  // Whether there is one that will not be refused.
  bool has_surface() const;
  // The share of inliers of the best surface, 0 if that will be refused.
  double share_of_inliers() const;
  // The local shape of the best surface in the middle of its points.
  std::optional<Osculation> osculation() const;
  // Descends from surfaces with that local shape, if the primitive can construct them.
  void look_like(const Osculation& o);
  // The best surface, and others that part of the points cannot distinguish from it, such as surfaces that
  // are alike on a small patch. Empty if no start led to a surface.
  std::vector<Hypothesis> hypotheses() const;

 private:
  void follow(Candidate c);
  // Descends from the best of these. \param near a point next to them
  void follow_best(const std::vector<GeometricParameters>& surfaces, const Vector3d& near,
                   std::ptrdiff_t most);

  const SearchProblem& problem_;
  const Primitive& primitive_;
  std::mt19937_64 random_;
  Eigen::Matrix3Xd scored_, part_;
  std::optional<Candidate> best_;
  std::vector<Candidate> likely_;  // surfaces reached, without those that will be refused
  // How many starts led to the best surface (0 if that will be refused), and how many are enough.
  int agreeing_ = 0, enough_ = 1;
  int round_ = 0, rounds_ = 1, iterations_ = 0;
};

}  // namespace darboux::fit
