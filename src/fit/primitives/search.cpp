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
constexpr int refined_starts = 4, most_rounds = 8;

// Surfaces of one kind whose log likelihoods over some of the points differ by less than this are all
// refined, up to the following number.
constexpr double alike = 12;
constexpr std::size_t most_alike = 3;

// Penalty that ranks refused surfaces behind all others.
constexpr double refusal = 1e6;

// Scores how well distances match a narrow band of inliers, of unknown width, among outliers of constant
// density: the log likelihood of k of n points spread evenly over |d| < band and the others over
// range_of_outliers(), at the best band. As many points as the surface has unknowns may lie on it because it
// was made to pass through them, so they do not count. Bands are a factor of the square root of two apart.
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
    std::array<double, highest - lowest + 1> sum{};
    primitive_.distance.rough_distances(cloud_, model, distances_);
    for (const double d : distances_) {
      const double square = d * d;
      // Twice the binary logarithm of |d|, rounded down: the exponent of its square.
      const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(square) >> 52) - 1023;
      const auto band = static_cast<std::size_t>(std::clamp(exponent, lowest, highest) - lowest);
      ++count[band], sum[band] += std::fabs(d);
    }
    constexpr double uniform = 0.577;  // a band's root mean square
    double outside = std::accumulate(sum.begin(), sum.end(), 0.0);
    const auto unknowns = static_cast<std::size_t>(primitive_.unknowns);
    Score best;
    std::size_t k = 0;
    for (int e = lowest; e < highest; ++e) {
      k += count[static_cast<std::size_t>(e - lowest)];
      outside -= sum[static_cast<std::size_t>(e - lowest)];
      if (10 * k < n_ || k <= unknowns) continue;
      const double log_band = 0.5 * (e + 1) * std::numbers::ln2;
      const auto n = static_cast<double>(n_), outliers = static_cast<double>(n_ - k);
      double value = k_log_k_[k] + k_log_k_[n_ - k] - static_cast<double>(k - unknowns) * log_band;
      if (k < n_)
        value -= outliers * std::log(range_of_outliers(outside / outliers, uniform * std::exp(log_band),
                                                       1 - outliers / n));
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

bool better(const Candidate& a, const Candidate& b) {
  if (a.refused != b.refused) return b.refused;
  return a.score.log_likelihood_ratio > b.score.log_likelihood_ratio;
}

void keep_best(std::vector<Candidate>& candidates, std::ptrdiff_t most) {
  const auto end = candidates.begin() + std::min(most, std::ssize(candidates));
  std::partial_sort(candidates.begin(), end, candidates.end(), better);
  candidates.erase(end, candidates.end());
}

// The inlier nearest to the middle of all, if there is one.
std::optional<Vector3d> middle_inlier(const Matrix3Xd& part, const std::vector<double>& weights) {
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), part.cols());
  if (!(w.sum() > 0)) return std::nullopt;
  const Vector3d mean = part * w / w.sum();
  std::optional<Vector3d> at;
  for (Eigen::Index i = 0; i < part.cols(); ++i)
    if (w[i] > 0.5 && (!at || (part.col(i) - mean).squaredNorm() < (*at - mean).squaredNorm()))
      at = part.col(i);
  return at;
}

// The robust phase: the mixture by the distances, then weighted least squares by Ceres, until the surface
// stays about where it is.
int descend(const Primitive& primitive, const Matrix3Xd& part, Candidate& candidate,
            std::optional<double> sigma, double least_sigma) {
  Mixture& mixture = candidate.mixture;
  mixture = {std::max(0.7 * candidate.score.band, least_sigma), 0.05};
  mixture.least_sigma = least_sigma;
  PointStates states(static_cast<std::size_t>(part.cols()));
  std::vector<double> weights;
  int iterations = 0;
  // Kept from round to round: in a curved valley, a round may only show that its steps are too long.
  double trust = wide_trust;
  for (int round = 0; round < 25; ++round) {
    primitive.distance.measure(part, candidate.model, states);
    states.in_support = states.regular;
    update_bias(mixture, states);
    update(mixture, states, true);
    if (sigma) mixture.sigma = std::max(mixture.sigma, *sigma);
    weights = inlier_probabilities(states, mixture);
    BatchedCost cost(primitive, Phase::robust, part, candidate.model.origin, mixture, states, weights);
    const Solved solved = solve(cost, candidate.model, 2, 1e-9, 1e-7, trust);
    iterations += solved.iterations;
    trust = std::min(solved.trust, wide_trust);
    const double inliers = std::accumulate(weights.begin(), weights.end(), 0.0);
    // The remaining movement is small compared with the uncertainty from so few points.
    if (cost.first_step() <= 0.3 * mixture.sigma * std::sqrt(primitive.unknowns) + 1e-14 * std::sqrt(inliers))
      break;
  }
  if (const auto at = middle_inlier(part, weights))
    candidate.model = primitive.localise(primitive.geometric(candidate.model), *at);
  double inliers = 0, of_outliers = 0;
  for (std::size_t i = 0; i < weights.size(); ++i)
    inliers += weights[i], of_outliers += (1 - weights[i]) * std::fabs(states.error(i));
  const auto n = static_cast<double>(weights.size());
  candidate.share_of_inliers = inliers / n;
  candidate.score.log_likelihood_ratio = log_likelihood_ratio(
      inliers, n, mixture.sigma, primitive.unknowns,
      range_of_outliers(of_outliers / std::fmax(n - inliers, 1e-300), mixture.sigma, inliers / n));
  return iterations;
}

bool crosses_itself_unasked(const SearchProblem& problem, const Primitive& primitive,
                            const GeometricParameters& surface) {
  return !problem.may_cross_itself && primitive.crosses_itself && primitive.crosses_itself(surface);
}

// The best of surfaces through random samples, with their scores. The first time also those not due to
// chance: the guess and the starts by equations.
std::vector<Candidate> starts(const SearchProblem& problem, const Primitive& primitive, bool is_first,
                              const Matrix3Xd& scored, int repeat, std::ptrdiff_t most,
                              std::mt19937_64& random) {
  Scorer scorer(scored, primitive);
  std::vector<Candidate> candidates;
  const auto consider = [&](const GeometricParameters& n, const Vector3d& at) {
    const LocalModel model = primitive.localise(n, at);
    if (!model.origin.allFinite() || !model.rotation.coeffs().allFinite()) return;
    candidates.push_back({model, scorer(model), {}, crosses_itself_unasked(problem, primitive, n)});
  };
  if (is_first && problem.guess) consider(*problem.guess, scored.col(0));
  if (primitive.starts_by_equation && is_first)
    for (const GeometricParameters& n : primitive.starts_by_equation(scored)) consider(n, scored.col(0));
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
  keep_best(candidates, most);
  return candidates;
}

bool is_refused(const SearchProblem& problem, const Primitive& primitive, const Candidate& c,
                const Matrix3Xd& cloud) {
  const GeometricParameters surface = primitive.geometric(c.model);
  return !(c.mixture.sigma <= largest_sigma) ||
         least_radius(primitive, surface, c.model.origin) < least_radius_over_sigma * c.mixture.sigma ||
         doubles_itself(primitive, surface, cloud, c.mixture.sigma) ||
         crosses_itself_unasked(problem, primitive, surface);
}

// Whether lengths, or axes, differ by a tenth: more than a standard error of what is usable. Semi-axes may
// come in any order.
bool differ(const Primitive& primitive, GeometricParameters a, GeometricParameters b) {
  constexpr double tenth = 0.1;
  if (primitive.orientation == Orientation::axis && a.axes.col(2).cross(b.axes.col(2)).norm() > tenth)
    return true;
  if (primitive.orientation == Orientation::frame) {
    std::sort(a.lengths.begin(), a.lengths.end());
    std::sort(b.lengths.begin(), b.lengths.end());
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (std::fabs(a.lengths[k] - b.lengths[k]) > tenth * std::fmax(a.lengths[k], b.lengths[k])) return true;
  return false;
}

}  // namespace

bool covers_little(const OrientedPoints& points) {
  const Matrix3d moments = points.normals * points.normals.transpose();
  const Vector3d shares =
      closed_form_symmetric_eigen(moments).values / static_cast<double>(points.normals.cols());
  return shares[0] < 0.12 && shares[1] < 0.3;
}

Search::Search(const SearchProblem& problem, const Primitive& primitive)
    : problem_(problem), primitive_(primitive), random_(problem.seed) {
  const auto some = [&](Eigen::Index count) {
    return Matrix3Xd(problem.cloud(Eigen::all, evenly_chosen(problem.cloud.cols(), count, random_)));
  };
  scored_ = some(scored_points);
  part_ = some(refined_points);
}

void Search::look() {
  // With few points, tries are cheap, and the likelihood has many maxima: try more often.
  const auto repeat = static_cast<int>(std::min<Eigen::Index>(scored_points / scored_.cols(), 10));
  const bool thorough = problem_.effort == Effort::full;
  const int followed = (thorough && repeat > 1 ? 5 * repeat : repeat) * refined_starts;
  enough_ = repeat == 1 ? 3 : thorough ? 10 : std::numeric_limits<int>::max();
  rounds_ = thorough && repeat == 1 ? most_rounds : 1;
  const bool is_first = round_++ == 0;
  for (Candidate& c : starts(problem_, primitive_, is_first, scored_, repeat, followed, random_)) {
    follow(std::move(c));
    if (is_settled()) break;
  }
}

void Search::look_among_outliers() {
  if (primitive_.starts_among_outliers && !is_settled())
    follow_best(primitive_.starts_among_outliers(scored_, random_), scored_.col(0), 1);
}

void Search::follow_best(const std::vector<GeometricParameters>& surfaces, const Vector3d& near,
                         std::ptrdiff_t most) {
  Scorer scorer(scored_, primitive_);
  std::vector<Candidate> candidates;
  for (const GeometricParameters& n : surfaces) {
    const LocalModel model = primitive_.localise(n, near);
    if (model.origin.allFinite() && model.rotation.coeffs().allFinite())
      candidates.push_back({model, scorer(model), {}, crosses_itself_unasked(problem_, primitive_, n)});
  }
  keep_best(candidates, most);
  for (Candidate& c : candidates) follow(std::move(c));
}

void Search::follow(Candidate c) {
  iterations_ += descend(primitive_, part_, c, problem_.sigma, problem_.least_sigma);
  c.refused = is_refused(problem_, primitive_, c, part_);
  if (!c.refused && problem_.effort == Effort::full) likely_.push_back(c);
  const bool agrees = best_ && !best_->refused && !c.refused &&
                      std::fabs(c.score.log_likelihood_ratio - best_->score.log_likelihood_ratio) < 1 &&
                      !differ(primitive_, primitive_.geometric(c.model), primitive_.geometric(best_->model));
  if (!best_ || better(c, *best_)) {
    agreeing_ = c.refused ? 0 : agrees ? agreeing_ + 1 : 1;
    best_ = std::move(c);
  } else if (agrees) {
    ++agreeing_;
  }
}

double Search::log_likelihood_ratio() const {
  return best_ ? best_->score.log_likelihood_ratio : -std::numeric_limits<double>::infinity();
}

bool Search::has_surface() const {
  return best_ && !best_->refused;
}

double Search::share_of_inliers() const {
  return has_surface() ? best_->share_of_inliers : 0;
}

std::optional<Osculation> Search::osculation() const {
  if (!best_) return std::nullopt;
  PointStates states(static_cast<std::size_t>(part_.cols()));
  primitive_.distance.measure(part_, best_->model, states);
  update_bias(best_->mixture, states);
  const std::vector<double> weights = inlier_probabilities(states, best_->mixture);
  const auto at = middle_inlier(part_, weights);
  if (!at) return std::nullopt;
  return fit::osculation(primitive_, best_->model, *at, algebraic_circle(part_, weights));
}

void Search::look_like(const Osculation& o) {
  follow_best(primitive_.osculating(o), o.at, 4 * refined_starts);
}

std::vector<Hypothesis> Search::hypotheses() const {
  if (!best_) return {};
  std::vector<Hypothesis> result;
  const auto add = [&](const Candidate& c) {
    const double llr = c.score.log_likelihood_ratio - (c.refused ? refusal : 0);
    result.push_back({&primitive_, llr, primitive_.geometric(c.model), c.model.origin, c.mixture});
  };
  add(*best_);
  result.front().iterations = iterations_;
  std::vector<Candidate> likely = likely_;
  std::stable_sort(likely.begin(), likely.end(), better);
  for (const Candidate& c : likely) {
    if (result.size() == most_alike ||
        c.score.log_likelihood_ratio < best_->score.log_likelihood_ratio - alike)
      break;
    const GeometricParameters surface = primitive_.geometric(c.model);
    if (std::all_of(result.begin(), result.end(),
                    [&](const Hypothesis& h) { return differ(primitive_, h.surface, surface); }))
      add(c);
  }
  return result;
}

}  // namespace darboux::fit
