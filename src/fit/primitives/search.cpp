#include "search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"
#include "cost.h"
#include "determinacy.h"

namespace darboux::fit {
namespace {

using Eigen::Matrix3Xd;

constexpr Eigen::Index scored_points = 600, refined_points = 700;
constexpr int refined_starts = 4;

struct Score {
  double log_likelihood_ratio = -std::numeric_limits<double>::infinity(), band = 0;
};

// How well distances look like a narrow band of inliers among outliers of constant density, without knowing
// how narrow: the log likelihood of k of n points spread evenly over |d| < band and the others over the size
// of the cloud, at the best band. As many points as the surface has unknowns may lie on it because it was
// laid through them: they count for nothing. Bands are a factor of the square root of two apart.
class Scorer {
 public:
  Scorer(const Matrix3Xd& cloud, const Primitive& primitive)
      : cloud_(cloud),
        primitive_(primitive),
        n_(static_cast<std::size_t>(cloud.cols())),
        k_log_k_(n_ + 1, 0) {
    for (std::size_t k = 1; k <= n_; ++k)
      k_log_k_[k] = static_cast<double>(k) * std::log(static_cast<double>(k));
  }
  Score operator()(const LocalModel& model) {
    constexpr int lowest = -100, highest = 4;  // halves of powers of two
    std::array<std::size_t, highest - lowest + 1> count{};
    primitive_.distance.rough_distances(cloud_, model, distances_);
    for (const double d : distances_) {
      const double square = d * d;
      // Twice the binary logarithm of |d|, rounded down: the exponent of its square.
      const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(square) >> 52) - 1023;
      ++count[static_cast<std::size_t>(std::clamp(exponent, lowest, highest) - lowest)];
    }
    const auto unknowns = static_cast<std::size_t>(primitive_.unknowns);
    Score best;
    std::size_t k = 0;
    for (int e = lowest; e < highest; ++e) {
      k += count[static_cast<std::size_t>(e - lowest)];
      if (10 * k < n_ || k <= unknowns) continue;
      const double log_band = 0.5 * (e + 1) * std::numbers::ln2;
      const double value = k_log_k_[k] + k_log_k_[n_ - k] - static_cast<double>(k - unknowns) * log_band;
      if (value > best.log_likelihood_ratio) best = {value, std::exp(log_band)};
    }
    return best;
  }

 private:
  const Matrix3Xd& cloud_;
  const Primitive& primitive_;
  std::size_t n_;
  std::vector<double> k_log_k_, distances_;
};

struct Candidate {
  LocalModel model;
  Score score;
  Mixture mixture{};
};

bool better(const Candidate& a, const Candidate& b) {
  return a.score.log_likelihood_ratio > b.score.log_likelihood_ratio;
}

// Moves the model to the local coordinates at an inlier near the middle.
void localise_in_the_middle(const Primitive& primitive, const Matrix3Xd& part,
                            const std::vector<double>& weights, LocalModel& model) {
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), part.cols());
  if (!(w.sum() > 0)) return;
  const Vector3d mean = part * w / w.sum();
  double nearest = std::numeric_limits<double>::infinity();
  Vector3d at = mean;
  for (Eigen::Index i = 0; i < part.cols(); ++i) {
    const double square = (part.col(i) - mean).squaredNorm();
    if (w[i] > 0.5 && square < nearest) nearest = square, at = part.col(i);
  }
  model = primitive.localise(primitive.geometric(model), at);
}

// Whether the normals are near one plane or one direction: a small patch, or a thin strip.
bool covers_little(const Matrix3Xd& normals) {
  const Matrix3d moments = normals * normals.transpose() / static_cast<double>(normals.cols());
  return closed_form_symmetric_eigen(moments).values[0] < 0.06;
}

// The robust phase: the mixture by the distances, then weighted least squares by Ceres, until the surface
// stays about where it is.
int descend(const Primitive& primitive, const Matrix3Xd& part, Candidate& candidate,
            std::optional<double> sigma) {
  Mixture& mixture = candidate.mixture;
  mixture = {std::max(0.7 * candidate.score.band, least_sigma), 0.05};
  PointStates states(static_cast<std::size_t>(part.cols()));
  std::vector<double> weights;
  int iterations = 0;
  for (int round = 0; round < 25; ++round) {
    primitive.distance.measure(part, candidate.model, states);
    states.in_support = states.regular;
    update_bias(mixture, states);
    update(mixture, states, true);
    if (sigma) mixture.sigma = std::max(mixture.sigma, *sigma);
    weights = inlier_probabilities(states, mixture);
    BatchedCost cost(primitive, Phase::robust, part, candidate.model.origin, mixture, states, weights);
    const Solved solved = solve(cost, candidate.model, 2, 1e-9, 1e-7);
    iterations += solved.iterations;
    const double inliers = std::accumulate(weights.begin(), weights.end(), 0.0);
    // What is left is small beside what so few points leave open.
    if (cost.first_step() <= 0.3 * mixture.sigma * std::sqrt(primitive.unknowns) + 1e-14 * std::sqrt(inliers))
      break;
  }
  localise_in_the_middle(primitive, part, weights, candidate.model);
  candidate.score.log_likelihood_ratio =
      log_likelihood_ratio(std::accumulate(weights.begin(), weights.end(), 0.0),
                           static_cast<double>(weights.size()), mixture.sigma, primitive.unknowns);
  return iterations;
}

// The guess, and surfaces through random samples; each with its score.
std::vector<Candidate> starts(const SearchProblem& problem, const Primitive& primitive,
                              const Matrix3Xd& scored, int repeat, std::mt19937_64& random) {
  Scorer scorer(scored, primitive);
  std::vector<Candidate> candidates;
  const auto consider = [&](const GeometricParameters& n, const Vector3d& at) {
    const LocalModel model = primitive.localise(n, at);
    if (!model.origin.allFinite() || !model.rotation.coeffs().allFinite()) return;
    candidates.push_back({model, scorer(model)});
  };
  if (problem.guess) consider(*problem.guess, scored.col(0));
  const auto m = problem.oriented.points.cols();
  const int least = primitive.sample_size;
  for (const auto& [size, share] : {std::pair{least, 100}, {least + 8, 60}, {3 * least + 20, 30}}) {
    if (m < size) continue;
    const int tries = repeat * share;
    OrientedPoints sample{Matrix3Xd(3, size), Matrix3Xd(3, size)};
    for (int k = 0; k < tries; ++k) {
      for (int j = 0; j < size; ++j) {
        const auto i = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(m));
        sample.points.col(j) = problem.oriented.points.col(i);
        sample.normals.col(j) = problem.oriented.normals.col(i);
      }
      if (const auto n = primitive.start(sample)) consider(*n, sample.points.col(0));
    }
  }
  return candidates;
}

}  // namespace

std::optional<Hypothesis> search(const SearchProblem& problem, const Primitive& primitive) {
  std::mt19937_64 random(problem.seed);
  const auto some = [&](Eigen::Index count) {
    return Matrix3Xd(problem.cloud(Eigen::all, evenly_chosen(problem.cloud.cols(), count, random)));
  };
  const Matrix3Xd scored = some(scored_points);
  const Matrix3Xd part = some(refined_points);
  // Few points are cheap to try more often, and may be all there is.
  const auto repeat = static_cast<int>(std::min<Eigen::Index>(scored_points / scored.cols(), 10));
  const bool thorough = problem.effort == Effort::full;
  std::vector<Candidate> candidates = starts(problem, primitive, scored, repeat, random);
  if (candidates.empty()) return std::nullopt;
  const auto end = candidates.begin() +
                   std::min<std::ptrdiff_t>((thorough && repeat > 1 ? 5 * repeat : repeat) * refined_starts,
                                            std::ssize(candidates));
  std::partial_sort(candidates.begin(), end, candidates.end(), better);
  candidates.erase(end, candidates.end());

  const Candidate* best = nullptr;
  double share = 0.3;  // of the work, about
  int same = 0, iterations = 0;
  const auto follow = [&](Candidate& c) {
    iterations += descend(primitive, part, c, problem.sigma);
    // A surface whose curvature and noise are of one size is refused in the end: another may be likely as
    // well.
    const GeometricParameters found = primitive.geometric(c.model);
    if (least_radius(primitive, found, c.model.origin) < 5 * c.mixture.sigma)
      c.score.log_likelihood_ratio -= 1e6;
    if (best == nullptr || better(c, *best))
      same = best && c.score.log_likelihood_ratio < best->score.log_likelihood_ratio + 1 ? same + 1 : 1,
      best = &c;
    else if (c.score.log_likelihood_ratio > best->score.log_likelihood_ratio - 1)
      ++same;
  };
  // So many that lead to the same surface are enough. Few points have many maxima.
  const int enough = repeat == 1 ? 3 : thorough ? 10 : std::numeric_limits<int>::max();
  for (Candidate& c : candidates) {
    problem.progress(share += 0.7 / static_cast<double>(candidates.size()));
    follow(c);
    if (same == enough) break;
  }
  std::vector<Candidate> others;
  if (thorough && primitive.alternatives && covers_little(problem.oriented.normals)) {
    for (const GeometricParameters& n :
         primitive.alternatives(primitive.geometric(best->model), best->model.origin)) {
      const LocalModel model = primitive.localise(n, best->model.origin);
      if (model.origin.allFinite() && model.rotation.coeffs().allFinite())
        others.push_back({model, {0, best->score.band}});
    }
    for (Candidate& c : others) follow(c);
  }
  return Hypothesis{&primitive,
                    best->score.log_likelihood_ratio,
                    primitive.geometric(best->model),
                    best->model.origin,
                    best->mixture,
                    iterations};
}

}  // namespace darboux::fit
