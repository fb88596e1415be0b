#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Eigenvalues>

#include <darboux/error.h>
#include <darboux/local_jets.h>

#include "neighbours.h"
#include "pieces.h"

namespace darboux {
namespace {

constexpr double worst_condition = 1e12, infinite = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// [j][i]: the root of j over i.
const auto root_of_binomial = [] {
  std::array<std::array<double, 6>, 6> roots{};
  for (std::size_t j = 0; j < 6; ++j) {
    double binomial = 1;
    for (std::size_t i = 0; i <= j; binomial *= static_cast<double>(j - i) / static_cast<double>(i + 1), ++i)
      roots[j][i] = std::sqrt(std::round(binomial));
  }
  return roots;
}();

// A polynomial of two variables with `dims` components, fitted to n values by least squares, together with that of the next
// degree, from which the error is judged. One QR serves both: the columns are sorted by degree, so that what comes first in R
// and in Qᵀ values is the fit of the lower degree. docs/theory/local-jets.md has the formulas.
template <int degree, int dims>
class Fit {
 public:
  static constexpr int N = static_cast<int>(jet_coefficients(degree)),
                       M = static_cast<int>(jet_coefficients(degree + 1));
  static constexpr int jet = 6;  // coefficients up to degree 2
  using Jet = Eigen::Matrix<double, jet, dims>;
  using Coefficients = Eigen::Matrix<double, 1, jet>;
  using Direction = Eigen::Matrix<double, dims, 1>;
  using Gain = Eigen::Matrix<double, 1, M>;

  // Of n values, to be written to x(), y() and values().
  void resize(std::size_t n) {
    n_ = static_cast<Eigen::Index>(n);
    // Rows of zeros below the points leave every least-squares polynomial as it is.
    rows_ = std::max<Eigen::Index>(n_, columns + 1);
    if (rows_ <= system_.rows()) return;
    given_.resize(rows_, 2 + dims);
    system_.resize(rows_, width);
  }
  auto x() { return given_.col(0).head(n_); }
  auto y() { return given_.col(1).head(n_); }
  auto values() { return given_.template rightCols<dims>().topRows(n_); }

  // False where the points do not determine the polynomial.
  bool solve(std::span<const double> weights) {
    fill();
    double total = static_cast<double>(n_);
    if (!weights.empty()) {
      const Eigen::Map<const Eigen::ArrayXd> w(weights.data(), n_);
      const double largest = w.maxCoeff();
      total = (w / largest).sum();
      system_.topRows(n_).array().colwise() *= (w / largest).sqrt();
    }
    triangulate();
    invert();
    residual_rms_ = std::sqrt((next().squaredNorm() + rest().squaredNorm()) / total);
    condition_ = condition_of<N>();
    if (std::isnan(condition_)) condition_ = infinite;
    judged_ = n_ >= M + 3 && condition_of<M>() < worst_condition;
    return condition_ < worst_condition;
  }

  double condition() const { return condition_; }
  double residual_rms() const { return residual_rms_; }

  // Of x^i y^j up to degree 2, in the order 1, x, y, x², xy, y².
  Jet coefficients() const {
    Jet c = inverse_.template topLeftCorner<N, jet>().transpose() * r_.template block<N, dims>(0, M);
    c.row(4) *= std::sqrt(2.0);
    return c;
  }

  // The fitted f · coefficients() is this times Qᵀ values: what comes of each degree.
  Gain gain(Coefficients f) const {
    f(4) *= std::sqrt(2.0);
    return f * inverse_.template leftCols<jet>().transpose();
  }
  // The expected square of the error of f · coefficients() · s.
  double error(const Gain& gain, const Direction& s) const {
    if (!judged_) return infinite;
    const Eigen::Matrix<double, M - N, 1> next = this->next() * s;
    const double noise = (rest() * s).squaredNorm() / static_cast<double>(n_ - M - 2);
    const double change = gain.template tail<M - N>().dot(next);
    // Neighbours that lie symmetrically hide from the next degree what has the other parity: a term as large as those of the
    // next degree, seen through the highest degree here.
    const double hidden = next.squaredNorm() / (M - N);
    return noise * gain.squaredNorm() + change * change +
           hidden * gain.template segment<degree + 1>(N - degree - 1).squaredNorm();
  }

 private:
  static constexpr int paired(int n) { return n + n % 2; }           // so that numbers go in pairs
  static constexpr int columns = M + dims, width = paired(columns);  // of the polynomial and the values
  // Monomials sqrt(binomial) x^(j-i) y^i: a rotation of (x, y) rotates those of one degree.
  void fill() {
    for (Eigen::Index i = 0; i < n_; ++i) {
      double* const row = &system_(i, 0);
      std::array<double, degree + 2> x, y;  // their powers
      x[0] = y[0] = 1;
      for (std::size_t j = 1; j < x.size(); ++j) {
        x[j] = x[j - 1] * given_(i, 0);
        y[j] = y[j - 1] * given_(i, 1);
      }
      for (std::size_t j = 0, column = 0; j < x.size(); ++j)
        for (std::size_t k = 0; k <= j; ++k) row[column++] = root_of_binomial[j][k] * (x[j - k] * y[k]);
      for (int k = 0; k < dims; ++k) row[M + k] = given_(i, 2 + k);
      if (width > columns) row[columns] = 0;
    }
    system_.middleRows(n_, rows_ - n_).setZero();
  }

  // Calls f(start, k) for k = 0 ... n - 1, start the last multiple of `step` not above k, as a constant: loops from there, or up to the
  // next, have few lengths, each known to the compiler, so that the sums of all columns stay in registers, side by side.
  static constexpr int step = 6;
  template <int n, int start = 0, class F>
  static void for_each_column(F f) {
    for (int k = start; k < std::min(start + step, n); ++k) f(std::integral_constant<int, start>(), k);
    if constexpr (start + step < n) for_each_column<n, start + step>(f);
  }

  // Householder's reflections; R goes to r_. What is left of the k-th column is done with, and may change.
  void triangulate() {
    for_each_column<columns>([this](auto start, int k) {
      constexpr int from = start;
      using Tail = Eigen::Matrix<double, 1, width - from>;
      const auto tail = [this](Eigen::Index i) { return Eigen::Map<Tail>(&system_(i, from)); };
      const double head = system_(k, k);
      Tail sum = system_(k + 1, k) * tail(k + 1);
      for (Eigen::Index i = k + 2; i < rows_; ++i) sum += system_(i, k) * tail(i);
      const double below = sum(k - from);
      if (below > std::numeric_limits<double>::min()) {
        // x - v (v·x) / (size v0), v = (v0, what is below)
        const double size = std::copysign(std::sqrt(head * head + below), head), v0 = head + size;
        sum = 1 / (size * v0) * (sum + v0 * tail(k));
        for (Eigen::Index i = k; i < rows_; ++i) {
          const double v = i == k ? v0 : system_(i, k);
          tail(i) -= v * sum;
        }
        system_(k, k) = -size;
      }
      r_.row(k).tail(columns - k) = system_.row(k).segment(k, columns - k);
    });
  }

  // Column by column. A zero on the diagonal spoils its column and those to the right, no other.
  void invert() {
    inverse_(0, 0) = 1 / r_(0, 0);
    for_each_column<M>([this](auto start, int j) {
      if (j == 0) return;
      constexpr int length = std::min(start + step, paired(M));
      using Head = Eigen::Matrix<double, 1, length>;
      const auto column = [this](int k) { return Eigen::Map<Head>(&inverse_(k, 0)); };
      Head sum = r_(0, j) * column(0);
      for (int k = 1; k < j; ++k) sum += r_(k, j) * column(k);
      const double diagonal = 1 / r_(j, j);
      column(j) = -diagonal * sum;
      inverse_(j, j) = diagonal;
    });
  }

  // Frobenius norms: no rotation of (x, y) changes them.
  template <int size>
  double condition_of() const {
    return std::sqrt(r_.template topLeftCorner<size, size>().squaredNorm() *
                     inverse_.template topLeftCorner<size, size>().squaredNorm());
  }

  // Of Qᵀ values: what belongs to the next degree, and what no polynomial takes.
  auto next() const { return r_.template block<M - N, dims>(N, M); }
  auto rest() const { return r_.template block<dims, dims>(M, M); }

  Eigen::Index n_ = 0, rows_ = 0;
  Eigen::Matrix<double, Eigen::Dynamic, 2 + dims> given_;
  Eigen::Matrix<double, Eigen::Dynamic, width, Eigen::RowMajor> system_;
  Eigen::Matrix<double, columns, columns, Eigen::RowMajor> r_ = decltype(r_)::Zero();
  Eigen::Matrix<double, M, paired(M), Eigen::RowMajor> inverse_ = decltype(inverse_)::Zero();  // transposed
  double condition_ = infinite, residual_rms_ = nan;
  bool judged_ = false;
};

// Where neighbours determine nothing.
LocalJet no_local_jet(Status why, double condition) {
  const Vec3<double> none = detail::nan_vector<double>();
  return {.position = none,
          .n = none,
          .curvature = {nan, nan, {nan, nan}, {none, none}, why},
          .normal_error = nan,
          .principal_error = {nan, nan},
          .direction_error = nan,
          .condition = condition,
          .residual_rms = nan,
          .status = why};
}
UvJet no_uv_jet(Status why, double condition) {
  const Vec3<double> none = detail::nan_vector<double>();
  return {
      {none, none, none, none, none, none}, {none, none, none, 1, why}, nan, nan, nan, nan, condition, nan};
}
constexpr Status non_finite = Status::no_frame | Status::non_finite_input;

// The side of n that the options ask for.
bool on_other_side(const Vec3<double>& n, const Vec3<double>& side) {
  const double d = dot(n, detail::scaled_by_power_of_two(side, -detail::scale_exponent(side)));
  if (d < 0 || d > 0) return d < 0;
  const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  return (x >= y && x >= z ? n.x : y >= z ? n.y : n.z) < 0;
}

template <int degree>
class LocalFit {
 public:
  LocalJet operator()(std::span<const Vec3<double>> neighbours, const Vec3<double>& at,
                      std::span<const double> weights, const Vec3<double>& side) {
    const auto n = static_cast<Eigen::Index>(neighbours.size());
    if (!detail::finite(at)) return no_local_jet(non_finite, infinite);
    double radius = 0;
    for (const Vec3<double>& p : neighbours) {
      const Vec3<double> d = p - at;
      if (!detail::finite(d)) return no_local_jet(non_finite, infinite);
      radius = std::fmax(radius, detail::largest_component(d));
    }
    if (!(radius > 0) || n < Fit<degree, 1>::N) return no_local_jet(Status::no_frame, infinite);
    points_.resize(n, 3);
    for (Eigen::Index i = 0; i < n; ++i)
      points_.row(i) = to_eigen((neighbours[static_cast<std::size_t>(i)] - at) / radius);
    const double size = std::sqrt(points_.rowwise().squaredNorm().maxCoeff());
    points_ /= size;
    radius *= size;

    // The plane of least squares: across it the covariance is smallest.
    weights_.setOnes(n);
    if (!weights.empty()) weights_ = Eigen::Map<const Eigen::VectorXd>(weights.data(), n);
    weights_ /= weights_.maxCoeff();
    const Eigen::RowVector3d mean = weights_.transpose() * points_ / weights_.sum();
    Eigen::Matrix3d covariance;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j)
        covariance(i, j) = covariance(j, i) =
            (weights_.array() * (points_.col(i).array() - mean(i)) * (points_.col(j).array() - mean(j)))
                .sum();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(covariance);
    const Eigen::Vector3d up = eigen.eigenvectors().col(0).normalized();
    Eigen::Index least = 0;
    up.cwiseAbs().minCoeff(&least);
    const Eigen::Vector3d e1 = up.cross(Eigen::Vector3d::Unit(least)).normalized(), e2 = up.cross(e1);

    fit_.resize(neighbours.size());
    fit_.x() = points_ * e1;
    fit_.y() = points_ * e2;
    fit_.values() = points_ * up;
    if (!fit_.solve(weights)) return no_local_jet(Status::no_frame, fit_.condition());

    const Eigen::Matrix<double, 6, 1> c = fit_.coefficients();
    const Vec3<double> z = from_eigen(up), x = from_eigen(e1), y = from_eigen(e2);
    const Jet2<double> jet{at + radius * c(0) * z, x + c(1) * z,      y + c(2) * z,
                           2 * c(3) / radius * z,  c(4) / radius * z, 2 * c(5) / radius * z};
    Frame<double> frame = frame_from_partials(jet.dpdu, jet.dpdv);
    if (on_other_side(frame.n, side)) frame = {frame.t, -frame.b, -frame.n, -1, frame.status};
    LocalJet result{.position = jet.position,
                    .n = frame.n,
                    .curvature = curvature(jet, frame),
                    .condition = fit_.condition(),
                    .residual_rms = radius * fit_.residual_rms()};

    // To first order, with the slope against the plane small: δn = -(δc1, δc2)/w, δκ = δII(d, d), and the principal directions
    // turn by δII(d1, d2)/(κ1 - κ2).
    using Row = Eigen::Matrix<double, 1, 6>;
    const double w = std::sqrt(1 + c(1) * c(1) + c(2) * c(2));
    const auto error = [&](const Row& f) {
      return fit_.error(fit_.gain(f), Eigen::Matrix<double, 1, 1>(1.0));
    };
    result.normal_error = std::sqrt(error(Row::Unit(1)) + error(Row::Unit(2))) / w;
    const auto second_form_error = [&](const Vec3<double>& p, const Vec3<double>& q) {
      const double px = dot(p, x), py = dot(p, y), qx = dot(q, x), qy = dot(q, y);
      Row f;
      f << 0, 0, 0, 2 * px * qx, px * qy + py * qx, 2 * py * qy;
      return std::sqrt(error(f)) / (w * radius);
    };
    const auto& [d1, d2] = result.curvature.directions;
    result.principal_error[0] = second_form_error(d1, d1);
    result.principal_error[1] = second_form_error(d2, d2);
    result.direction_error =
        second_form_error(d1, d2) / (result.curvature.principal[0] - result.curvature.principal[1]);
    if (has(result.curvature.status, Status::umbilic)) result.direction_error = infinite;
    return result;
  }

 private:
  Fit<degree, 1> fit_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> points_;
  Eigen::VectorXd weights_;
};

template <int degree>
class UvFit {
 public:
  UvJet operator()(std::span<const Vec2<double>> uvs, std::span<const Vec3<double>> positions,
                   const Vec2<double>& at, std::span<const double> weights, bool u_periodic,
                   bool v_periodic) {
    const std::size_t n = positions.size();
    if (n < static_cast<std::size_t>(Fit<degree, 3>::N)) return no_uv_jet(Status::no_frame, infinite);
    fit_.resize(n);
    double radius = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3<double> p = positions[i] - positions[0];
      Vec2<double> d = uvs[i] - at;
      if (!detail::finite(p) || !std::isfinite(d.x) || !std::isfinite(d.y))
        return no_uv_jet(non_finite, infinite);
      if (u_periodic) d.x -= std::round(d.x);
      if (v_periodic) d.y -= std::round(d.y);
      radius = std::fmax(radius, detail::largest_component(p));
      const auto row = static_cast<Eigen::Index>(i);
      fit_.x()(row) = d.x;
      fit_.y()(row) = d.y;
      fit_.values().row(row) = to_eigen(p);
    }
    // Coordinates (x, y) = A (u, v) whose columns are orthonormal but for a common factor: a chart that is stretched or
    // sheared gives the same ones.
    const double u_size = fit_.x().cwiseAbs().maxCoeff(), v_size = fit_.y().cwiseAbs().maxCoeff();
    if (!(u_size > 0) || !(v_size > 0) || !(radius > 0)) return no_uv_jet(Status::no_frame, infinite);
    fit_.x() /= u_size;
    fit_.y() /= v_size;
    const double xx = fit_.x().norm(), xy = fit_.x().dot(fit_.y()) / xx, before = fit_.y().norm();
    fit_.y() -= xy / xx * fit_.x();
    const double yy = fit_.y().norm();
    if (!(yy * worst_condition > before)) return no_uv_jet(Status::no_frame, infinite);
    fit_.x() /= xx;
    fit_.y() /= yy;
    const double size = std::sqrt((fit_.x().cwiseAbs2() + fit_.y().cwiseAbs2()).maxCoeff());
    fit_.x() /= size;
    fit_.y() /= size;
    fit_.values() /= radius;
    Eigen::Matrix2d a;
    a << 1 / (xx * size * u_size), 0, -xy / (xx * yy * size * u_size), 1 / (yy * size * v_size);
    if (!fit_.solve(weights)) return no_uv_jet(Status::no_frame, fit_.condition());

    const auto c = fit_.coefficients();
    const auto value = [&](const auto& row) {
      return from_eigen(Eigen::Vector3d(radius * (row * c).transpose()));
    };
    Row first[2] = {Row::Zero(), Row::Zero()};  // dpdu and dpdv from the coefficients
    for (int k = 0; k < 2; ++k) first[k](1) = a(0, k), first[k](2) = a(1, k);
    const auto second = [&](int j, int k) {
      Row row;
      row << 0, 0, 0, 2 * a(0, j) * a(0, k), a(0, j) * a(1, k) + a(1, j) * a(0, k), 2 * a(1, j) * a(1, k);
      return row;
    };
    UvJet result;
    result.jet = {positions[0] + value(Row::Unit(0)),
                  value(first[0]),
                  value(first[1]),
                  value(second(0, 0)),
                  value(second(0, 1)),
                  value(second(1, 1))};
    result.frame = frame_from_partials(result.jet.dpdu, result.jet.dpdv);
    result.condition = fit_.condition();
    result.residual_rms = radius * fit_.residual_rms();

    using Gain = typename Fit<degree, 3>::Gain;
    const auto error = [&](const Gain& gain, const Vec3<double>& s) { return fit_.error(gain, to_eigen(s)); };
    const auto length_error = [&](const Gain& gain) {
      return radius * std::sqrt(error(gain, {1, 0, 0}) + error(gain, {0, 1, 0}) + error(gain, {0, 0, 1}));
    };
    const Gain of_dpdu = fit_.gain(first[0]), of_dpdv = fit_.gain(first[1]);
    result.dpdu_error = length_error(of_dpdu);
    result.dpdv_error = length_error(of_dpdv);
    if (has(result.frame.status, Status::no_frame)) {
      result.tangent_error = result.normal_error = nan;
      return result;
    }
    // δt = (b b·δdpdu + n n·δdpdu)/|dpdu|; δn = -Σ r n·δdp over u and v, with r the gradients of u and v in the surface.
    const auto& [t, b, normal, handedness, status] = result.frame;
    const double e = dot(result.jet.dpdu, t), f = dot(result.jet.dpdv, t), g = dot(result.jet.dpdv, b);
    result.tangent_error = radius / e * std::sqrt(error(of_dpdu, b) + error(of_dpdu, normal));
    const Gain along_t = of_dpdu / e, along_b = of_dpdv / g - f / (e * g) * of_dpdu;
    result.normal_error = radius * std::sqrt(error(along_t, normal) + error(along_b, normal));
    return result;
  }

 private:
  using Row = Eigen::Matrix<double, 1, 6>;
  Fit<degree, 3> fit_;
};

// f(an integral constant of the degree).
template <class F>
auto with_degree(int degree, const F& f) {
  switch (degree) {
    case 2:
      return f(std::integral_constant<int, 2>());
    case 3:
      return f(std::integral_constant<int, 3>());
    case 4:
      return f(std::integral_constant<int, 4>());
    default:
      throw ParameterError("degree", std::to_string(degree) + " is out of range, permitted is 2 to 4");
  }
}

void check_weights(std::span<const double> weights, std::size_t n) {
  if (weights.empty()) return;
  if (weights.size() != n)
    throw ParameterError("weights", std::to_string(weights.size()) + " for " + std::to_string(n) +
                                        " neighbours, permitted is one each or none");
  for (const double w : weights)
    if (!(w > 0 && w < infinite)) throw_out_of_range("weights", "weight", w, Range::positive());
}

void check_length(std::size_t size, const char* attribute, const PointCloud& cloud) {
  if (size != 0 && size != cloud.positions.size())
    throw MeshError("points", std::to_string(size) + " " + attribute + " for " +
                                  std::to_string(cloud.positions.size()) +
                                  " positions, permitted is one each or none");
}

// fit(i, the indices of the points nearest to it) for every point of a cloud; `make()` makes a fit, once a piece.
template <class Result, class Make>
std::vector<Result> at_every_point(const PointCloud& cloud, const CloudJetOptions& options,
                                   const Result& none, const Make& make) {
  check_length(cloud.normals.size(), "normals", cloud);
  check_length(cloud.uvs.size(), "uvs", cloud);
  if (options.threads < 0)
    throw ParameterError("threads",
                         std::to_string(options.threads) + " threads, permitted is 0 (all) or more");
  const std::size_t least = jet_coefficients(options.degree),
                    wanted = options.neighbours == 0 ? 2 * jet_coefficients(options.degree + 1)
                                                     : options.neighbours;
  if (wanted < least)
    throw ParameterError("neighbours", std::to_string(wanted) + " for degree " +
                                           std::to_string(options.degree) + ", permitted is " +
                                           std::to_string(least) + " or more");
  const Neighbours tree(cloud.positions);
  const std::size_t k = std::min(wanted, tree.size());
  std::vector<Result> results(cloud.positions.size(), none);
  in_pieces(
      results.size(), thread_count(options.threads),
      [&](std::size_t begin, std::size_t end) {
        auto fit = make();
        std::vector<std::uint32_t> near(k);
        std::vector<double> squared(k);
        for (std::size_t i = begin; i < end; ++i) {
          if (!detail::finite(cloud.positions[i])) continue;
          tree.nearest(cloud.positions[i], near, squared);
          results[i] = fit(i, near);
        }
      },
      256);
  return results;
}

}  // namespace

LocalJet local_jet(std::span<const Vec3<double>> neighbours, const Vec3<double>& at,
                   const JetOptions& options) {
  check_weights(options.weights, neighbours.size());
  return with_degree(options.degree, [&](auto degree) {
    return LocalFit<degree>()(neighbours, at, options.weights, options.side);
  });
}

UvJet uv_jet(std::span<const Vec2<double>> uvs, std::span<const Vec3<double>> positions,
             const Vec2<double>& at, const JetOptions& options) {
  check_weights(options.weights, positions.size());
  if (uvs.size() != positions.size())
    throw ParameterError("uvs", std::to_string(uvs.size()) + " for " + std::to_string(positions.size()) +
                                    " positions, permitted is one each");
  return with_degree(options.degree, [&](auto degree) {
    return UvFit<degree>()(uvs, positions, at, options.weights, options.u_periodic, options.v_periodic);
  });
}

std::vector<LocalJet> local_jets(const PointCloud& cloud, const CloudJetOptions& options) {
  return with_degree(options.degree, [&](auto degree) {
    return at_every_point(cloud, options, no_local_jet(non_finite, infinite), [&] {
      return [&cloud, fit = LocalFit<degree>(), near = std::vector<Vec3<double>>()](
                 std::size_t i, std::span<const std::uint32_t> indices) mutable {
        near.clear();
        for (const std::uint32_t j : indices) near.push_back(cloud.positions[j]);
        return fit(near, cloud.positions[i], {}, cloud.normals.empty() ? Vec3<double>{} : cloud.normals[i]);
      };
    });
  });
}

std::vector<UvJet> uv_jets(const PointCloud& cloud, const CloudJetOptions& options) {
  if (cloud.uvs.empty() && !cloud.positions.empty())
    throw MeshError("points", "have no uvs, permitted is one each");
  return with_degree(options.degree, [&](auto degree) {
    return at_every_point(cloud, options, no_uv_jet(non_finite, infinite), [&] {
      return
          [&cloud, &options, fit = UvFit<degree>(), near = std::vector<Vec3<double>>(),
           uvs = std::vector<Vec2<double>>()](std::size_t i, std::span<const std::uint32_t> indices) mutable {
            near.clear();
            uvs.clear();
            for (const std::uint32_t j : indices)
              near.push_back(cloud.positions[j]), uvs.push_back(cloud.uvs[j]);
            return fit(uvs, near, cloud.uvs[i], {}, options.u_periodic, options.v_periodic);
          };
    });
  });
}

}  // namespace darboux
