#include "find.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "estimate.h"
#include "gate.h"

namespace darboux::fit {
namespace {

using Eigen::Matrix3Xd;

constexpr Eigen::Index scored_points = 600, refined_points = 700;
constexpr int refined_starts = 4;

// How well distances look like a narrow band of inliers among outliers of constant density, without knowing
// how narrow: the log likelihood of k of n points spread evenly over |d| < band and the others over the size
// of the cloud, at the best band. As many points as the surface has unknowns may lie on it because it was
// laid through them: they count for nothing. Bands are a factor of the square root of two apart.
struct Score {
  double value = -std::numeric_limits<double>::infinity(), band = 0;
};
class Scorer {
 public:
  explicit Scorer(std::size_t n) : n_(n), k_log_k_(n + 1, 0) {
    for (std::size_t k = 1; k <= n; ++k)
      k_log_k_[k] = static_cast<double>(k) * std::log(static_cast<double>(k));
  }
  template <class Shape>
  Score operator()(const Matrix3Xd& cloud, const Model<Shape>& model) {
    constexpr int lowest = -100, highest = 4;  // halves of powers of two
    std::array<std::size_t, highest - lowest + 1> count{};
    const Matrix3d to_local = model.rotation.conjugate().toRotationMatrix();
    const Shape shape(model.s.data());
    for (Eigen::Index i = 0; i < cloud.cols(); ++i) {
      const Vector3d p = to_local * (cloud.col(i) - model.origin);
      double d;
      if constexpr (requires { shape.rough_distance(p); })
        d = shape.rough_distance(p);
      else
        d = shape.distance(p);
      const double square = d * d;
      // Twice the binary logarithm of |d|, rounded down: the exponent of its square.
      const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(square) >> 52) - 1023;
      ++count[static_cast<std::size_t>(std::clamp(exponent, lowest, highest) - lowest)];
    }
    Score best;
    std::size_t k = 0;
    for (int e = lowest; e < highest; ++e) {
      k += count[static_cast<std::size_t>(e - lowest)];
      if (10 * k < n_ || k <= Shape::freedom) continue;
      const double log_band = 0.5 * (e + 1) * std::numbers::ln2;
      const double value =
          k_log_k_[k] + k_log_k_[n_ - k] - static_cast<double>(k - Shape::freedom) * log_band;
      if (value > best.value) best = {value, std::exp(log_band)};
    }
    return best;
  }

 private:
  std::size_t n_;
  std::vector<double> k_log_k_;
};

template <class Shape>
struct Candidate {
  Model<Shape> model;
  Score score;
  Noise noise{};
};

// Distances and curvatures of all points.
template <class Shape>
void measure(const Matrix3Xd& cloud, const Model<Shape>& model, PointStates& states) {
  const Matrix3d to_local = model.rotation.conjugate().toRotationMatrix();
  const Shape shape(model.s.data());
  Local<Shape::size> local;
  for (std::size_t i = 0; i < states.d.size(); ++i) {
    shape.at(to_local * (cloud.col(static_cast<Eigen::Index>(i)) - model.origin), local);
    states.set(i, local);
  }
}

std::vector<double> inlier_probabilities(const PointStates& states, const Noise& noise) {
  std::vector<double> w(states.d.size());
  for (std::size_t i = 0; i < w.size(); ++i)
    w[i] = states.kept[i] ? inlier_probability(states.error(i), noise) : 0;
  return w;
}

// From afar: noise by the distances, then weighted least squares by Ceres, until the surface stays about
// where it is. Leaves it in the local coordinates at an inlier near the middle.
template <class Shape>
int descend(const Matrix3Xd& part, Candidate<Shape>& candidate, std::optional<double> sigma) {
  Noise& noise = candidate.noise;
  noise = {std::max(0.7 * candidate.score.band, least_sigma), 0.05};
  PointStates states(static_cast<std::size_t>(part.cols()));
  std::vector<double> weights;
  int iterations = 0;
  for (int round = 0; round < 25; ++round) {
    measure(part, candidate.model, states);
    states.kept = states.regular;
    update_bias(noise, states);
    update(noise, states, true);
    if (sigma) noise.sigma = std::max(noise.sigma, *sigma);
    weights = inlier_probabilities(states, noise);
    BatchedCost<Shape> cost(Phase::descend, part, candidate.model.origin, noise, states, weights);
    const Solved solved = solve(cost, candidate.model, 2, 1e-9, 1e-7);
    iterations += solved.iterations;
    const double inliers = std::accumulate(weights.begin(), weights.end(), 0.0);
    // What is left is small beside what so few points leave open.
    if (cost.first_step() <= 0.3 * noise.sigma * std::sqrt(Shape::freedom) + 1e-14 * std::sqrt(inliers))
      break;
  }
  const Eigen::Map<const Eigen::VectorXd> w(weights.data(), part.cols());
  if (!(w.sum() > 0)) return iterations;
  const Vector3d mean = part * w / w.sum();
  double nearest = std::numeric_limits<double>::infinity();
  Vector3d at = mean;
  for (Eigen::Index i = 0; i < part.cols(); ++i) {
    const double square = (part.col(i) - mean).squaredNorm();
    if (w[i] > 0.5 && square < nearest) nearest = square, at = part.col(i);
  }
  candidate.model = localise<Shape>(natural(candidate.model), at);
  return iterations;
}

// Numerical derivatives of the natural description by the local tangent, and so its covariance.
template <class Shape>
Covariance natural_covariance(const Model<Shape>& model, const Eigen::MatrixXd& covariance,
                              const Vector3d& reference) {
  constexpr int n = 3 + Shape::size;
  Eigen::Matrix<double, 9, n> by;
  const Natural centre = natural(model);
  Eigen::Matrix<double, n, 1> steps = Eigen::Matrix<double, n, 1>::Constant(1e-5);
  if constexpr (Shape::curved) steps[4] *= std::min(1.0, std::fabs(model.s[1]));
  for (int k = 0; k < n; ++k) {
    std::array<Natural, 2> moved;
    for (int side = 0; side < 2; ++side) {
      Model<Shape> m = model;
      // A curvature is stepped by a part of itself: radii may be large.
      const double step = (side == 0 ? -1 : 1) * steps[k];
      if (k < 3)
        m.rotation = m.rotation * Eigen::Quaterniond(Eigen::AngleAxisd(step, Vector3d::Unit(k)));
      else
        m.s[static_cast<std::size_t>(k - 3)] += step;
      moved[static_cast<std::size_t>(side)] = natural(m);
    }
    Vector3d turn;
    if constexpr (std::is_same_v<Shape, EllipsoidShape>) {
      const Eigen::AngleAxisd rotation(Matrix3d(moved[1].axes * moved[0].axes.transpose()));
      turn = rotation.angle() * rotation.axis();
    } else {  // a turn about the axis means nothing
      turn = centre.axes.col(2).cross(moved[1].axes.col(2) - moved[0].axes.col(2));
      if (std::is_same_v<Shape, SphereShape>) turn.setZero();
    }
    turn /= 2 * steps[k];
    const Vector3d shift = (moved[1].centre - moved[0].centre) / (2 * steps[k]);
    by.col(k).template head<3>() = turn;
    by.col(k).template segment<3>(3) = shift - turn.cross(centre.centre - reference);
    for (int l = 0; l < 3; ++l)
      by(6 + l, k) =
          (moved[1].lengths[static_cast<std::size_t>(l)] - moved[0].lengths[static_cast<std::size_t>(l)]) /
          (2 * steps[k]);
  }
  return by * covariance * by.transpose();
}

// How far weighted points are from one circle, root mean square, of each of the two directions across it. The
// circle lies in the plane of the points' largest moments and is the algebraic one there, x^2 + y^2 = 2 a x +
// 2 b y + c.
double off_a_circle(const Matrix3Xd& cloud, const Eigen::VectorXd& weights) {
  const double sum = weights.sum();
  const Vector3d mean = cloud * weights / sum;
  const Matrix3Xd centred = cloud.colwise() - mean;
  const Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(centred * weights.asDiagonal() * centred.transpose())
          .eigenvectors();
  const Matrix3Xd p = axes.transpose() * centred;  // the plane's normal first
  const Eigen::Matrix3Xd rows =
      (Matrix3Xd(3, p.cols()) << 2 * p.bottomRows<2>(), Eigen::RowVectorXd::Ones(p.cols())).finished();
  const Eigen::VectorXd squares = p.bottomRows<2>().colwise().squaredNorm();
  const Matrix3d normal_matrix = rows * weights.asDiagonal() * rows.transpose();
  const Vector3d circle = normal_matrix.ldlt().solve(rows * weights.cwiseProduct(squares));
  const double radius = std::sqrt(circle.z() + circle.head<2>().squaredNorm());
  const Eigen::ArrayXd radial =
      (p.bottomRows<2>().colwise() - circle.head<2>()).colwise().norm().transpose().array() - radius;
  return std::sqrt(((radial.square() + p.row(0).transpose().array().square()) * weights.array()).sum() /
                   (2 * sum));
}

}  // namespace

template <class Shape>
std::optional<Lead> find(const Search& search) {
  std::mt19937_64 random(search.seed);
  const auto some = [&](Eigen::Index count) {
    return Matrix3Xd(search.cloud(Eigen::all, evenly_chosen(search.cloud.cols(), count, random)));
  };
  const Matrix3Xd scored = some(scored_points);
  const Matrix3Xd part = some(refined_points);
  Scorer scorer(static_cast<std::size_t>(scored.cols()));

  std::vector<Candidate<Shape>> candidates;
  const auto consider = [&](const Natural& n, const Vector3d& at) {
    const Model<Shape> model = localise<Shape>(n, at);
    if (!model.origin.allFinite() || !model.rotation.coeffs().allFinite()) return;
    candidates.push_back({model, scorer(scored, model)});
  };
  if (search.guess) consider(*search.guess, scored.col(0));
  const auto m = search.oriented.points.cols();
  constexpr int least = least_sample<Shape>;
  // Few points are cheap to try more often, and may be all there is.
  const auto more = static_cast<int>(std::min<Eigen::Index>(scored_points / scored.cols(), 10));
  for (const auto& [size, share] : {std::pair{least, 100}, {least + 8, 60}, {3 * least + 20, 30}}) {
    if (m < size) continue;
    const int tries = more * share;
    Oriented sample{Matrix3Xd(3, size), Matrix3Xd(3, size)};
    for (int k = 0; k < tries; ++k) {
      for (int j = 0; j < size; ++j) {
        const auto i = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(m));
        sample.points.col(j) = search.oriented.points.col(i);
        sample.normals.col(j) = search.oriented.normals.col(i);
      }
      if (const auto n = start<Shape>(sample)) consider(*n, sample.points.col(0));
    }
  }
  if (candidates.empty()) return std::nullopt;
  const auto better = [](const Candidate<Shape>& a, const Candidate<Shape>& b) {
    return a.score.value > b.score.value;
  };
  const auto end =
      candidates.begin() + std::min<std::ptrdiff_t>(more * refined_starts, std::ssize(candidates));
  std::partial_sort(candidates.begin(), end, candidates.end(), better);
  candidates.erase(end, candidates.end());

  Scorer part_scorer(static_cast<std::size_t>(part.cols()));
  // Three that lead to the same surface are enough.
  const Candidate<Shape>* best = nullptr;
  double share = 0.3;  // of the work, about
  int same = 0, iterations = 0;
  for (Candidate<Shape>& c : candidates) {
    search.progress(share += 0.7 / static_cast<double>(candidates.size()));
    iterations += descend(part, c, search.sigma);
    c.score = part_scorer(part, c.model);
    if (best == nullptr || better(c, *best))
      best = &c, same = 1;
    else if (c.score.value == best->score.value && ++same == 3 && more == 1)
      break;
  }
  return Lead{Shape::name,        best->score.value, natural(best->model),
              best->model.origin, best->noise,       iterations};
}

template <class Shape>
Found refine(const Search& search, const Lead& lead, bool give_up) {
  Found found;
  found.kind = Shape::name;
  found.freedom = Shape::freedom;
  found.given_up = give_up;
  found.iterations = lead.iterations;
  // All points: noise, bias and gate by what the last estimate says, then a step or two, until nothing moves.
  const auto n = static_cast<std::size_t>(search.cloud.cols());
  PointStates states(n);
  Noise noise = lead.noise;
  if (search.sigma) noise = {*search.sigma, noise.outliers, true};
  Model<Shape> model = localise<Shape>(lead.surface, lead.at);
  typename BatchedCost<Shape>::Matrix hessian = BatchedCost<Shape>::Matrix::Zero();
  Phase phase = Phase::descend;
  std::vector<double> weights;
  int gates = 0;
  double since_gate =
      std::numeric_limits<double>::infinity();  // movements since the last gate, in standard errors
  // In standard errors: how near the root is sought. A root that cannot be stepped to is left to the descent.
  double near = 1;
  measure(search.cloud, model, states);
  double share = 0;
  for (int round = 0; round < (give_up ? 0 : 100); ++round) {
    search.progress(share += 0.1 * (1 - share));
    if (gates == 0) states.kept = states.regular;
    update_bias(noise, states);
    update(noise, states, phase == Phase::descend);
    // The biases are those of the sigma before; they go with it, and the distances by as much.
    if (!noise.sigma_known) noise.sigma = std::max(noise.sigma, root_mean_square_of_bias(states));
    if (phase == Phase::descend) weights = inlier_probabilities(states, noise);
    BatchedCost<Shape> cost(phase, search.cloud, model.origin, noise, states, weights);
    const Model<Shape> before = model;
    const Solved solved = solve(cost, model, phase == Phase::score ? 1 : 12, 1e-15,
                                phase == Phase::descend && near == 1 ? 1e-7 : 1e-20);
    found.iterations += solved.iterations;
    if (!solved.usable) break;
    hessian = cost.hessian();
    // Rounding of the distances moves the surface by 1e-14 at most.
    const double standard_error = noise.sigma * std::sqrt(Shape::freedom / noise.inliers);
    const double movement = cost.first_step() / std::sqrt(noise.inliers);
    const bool small = movement <= 3 * standard_error + 1e-14;
    since_gate += movement / (standard_error + 1e-14);
    if (phase == Phase::score && !small) {  // too far for a root to be trusted
      model = before;
      measure(search.cloud, model, states);
      phase = Phase::descend;
      near *= 0.1;
    } else if (small && since_gate > 0.1 && gates < 8) {
      gate<Shape>(search.cloud, natural(model), noise, states);
      ++gates;
      since_gate = 0;
    } else if (movement <= 1e-15 + (phase == Phase::score ? 1e-9 : 1e-6) * standard_error) {
      found.converged = true;
      break;
    } else if (phase == Phase::score && !solved.moved) {
      phase = Phase::descend;
      near *= 1e-3;
    }
    if (phase == Phase::descend && movement <= near * standard_error + 1e-14) phase = Phase::score;
  }

  found.surface = natural(model);
  found.sigma = noise.sigma;
  found.outliers = noise.outliers;
  weights = inlier_probabilities(states, noise);
  found.off_a_circle = off_a_circle(
      search.cloud, Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(n)));
  found.error.resize(n);
  for (std::size_t i = 0; i < n; ++i) found.error[i] = states.error(i);
  found.kept = std::move(states.kept);
  found.reference = model.origin;
  if (give_up) return found;
  // Without the turn about the normal where that changes nothing.
  constexpr int all = 3 + Shape::size, freedom = Shape::freedom;
  std::vector<int> free;
  for (int k = 0; k < all; ++k)
    if (freedom == all || k != 2) free.push_back(k);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian(free, free));
  // Below that is rounding: the turn of an ellipsoid of revolution would spoil what else is known.
  const double rounding = std::max(0x1p-52 * eigen.eigenvalues().maxCoeff(), 1e-300);
  const Eigen::VectorXd inverse = eigen.eigenvalues().cwiseMax(rounding).cwiseInverse();
  found.least_known = std::sqrt(inverse[0]);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(all, all);
  covariance(free, free) = noise.sigma * noise.sigma * eigen.eigenvectors() * inverse.asDiagonal() *
                           eigen.eigenvectors().transpose();
  found.covariance = natural_covariance<Shape>(model, covariance, found.reference);
  return found;
}

#define DARBOUX_FIND(Shape)                                \
  template std::optional<Lead> find<Shape>(const Search&); \
  template Found refine<Shape>(const Search&, const Lead&, bool);
DARBOUX_FIND(PlaneShape)
DARBOUX_FIND(SphereShape)
DARBOUX_FIND(CylinderShape)
DARBOUX_FIND(ConeShape)
DARBOUX_FIND(TorusShape)
DARBOUX_FIND(EllipsoidShape)
#undef DARBOUX_FIND

}  // namespace darboux::fit
