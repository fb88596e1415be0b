#include "fit_primitives.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <darboux/catalogue.h>

#include "base/text.h"
#include "choose.h"
#include "estimate.h"
#include "find.h"
#include "fit/common/kinds.h"
#include "fit/common/scaled.h"

namespace darboux {
namespace {

using namespace fit;
using Eigen::Matrix3Xd;

// The frame with this z whose x is the world axis least parallel to z, projected.
Matrix3d conventional_frame(const Vector3d& z) {
  Eigen::Index least;
  z.cwiseAbs().minCoeff(&least);
  Matrix3d r;
  r.col(2) = z;
  r.col(0) = (Vector3d::Unit(least) - z[least] * z).normalized();
  r.col(1) = z.cross(r.col(0));
  return r;
}

// What the catalogue calls a found surface, in the units of the points. Lengths that only bound the patch
// enclose the inliers.
struct Named {
  PlacedSurface placed;
  Eigen::MatrixXd by;  // derivatives of the parameters by the natural lengths
};

Named named(const Found& found, const Scaled& data, const std::vector<bool>& inlier) {
  const Natural& n = found.surface;
  struct Extent {
    double low = std::numeric_limits<double>::infinity(), high = -low;
  };
  const auto extent = [&](const Vector3d& direction) {
    Extent e;
    for (Eigen::Index i = 0; i < data.cloud.cols(); ++i) {
      if (!inlier[data.index[static_cast<std::size_t>(i)]]) continue;
      const double x = direction.dot(data.cloud.col(i) - n.centre);
      e.low = std::fmin(e.low, x), e.high = std::fmax(e.high, x);
    }
    return e;
  };
  Matrix3d frame = conventional_frame(positive_side(n.axes.col(2)));
  Vector3d origin = n.centre;
  const double scale = data.scale;
  std::optional<AnySurface> surface;
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(2, 3);
  if (found.kind == "plane") {
    const Extent x = extent(frame.col(0)), y = extent(frame.col(1));
    origin += 0.5 * ((x.low + x.high) * frame.col(0) + (y.low + y.high) * frame.col(1));
    surface = Plane{scale * (x.high - x.low), scale * (y.high - y.low)};
  } else if (found.kind == "sphere") {
    frame.setIdentity();
    surface = Sphere{scale * n.lengths[0]};
    by.conservativeResize(1, 3);
    by(0, 0) = scale;
  } else if (found.kind == "cylinder") {
    const Extent z = extent(frame.col(2));
    origin += z.low * frame.col(2);
    surface = Cylinder{scale * n.lengths[0], scale * (z.high - z.low)};
    by(0, 0) = scale;
  } else if (found.kind == "cone") {  // the catalogue's axis leads from the base to the apex
    frame = conventional_frame(-n.axes.col(2));
    const double height = extent(n.axes.col(2)).high, tangent = std::tan(n.lengths[0]);
    origin += height * n.axes.col(2);
    surface = Cone{scale * height * tangent, scale * height};
    by(0, 0) = scale * height * (1 + tangent * tangent);
  } else if (found.kind == "torus") {
    surface = Torus{scale * n.lengths[0], scale * n.lengths[1]};
    by(0, 0) = by(1, 1) = scale;
  } else {  // longest semi-axis first
    std::array<int, 3> order{0, 1, 2};
    const auto length = [&](int k) { return n.lengths[static_cast<std::size_t>(k)]; };
    std::sort(order.begin(), order.end(), [&](int a, int b) { return length(a) > length(b); });
    frame.col(0) = positive_side(n.axes.col(order[0]));
    frame.col(2) = positive_side(n.axes.col(order[2]));
    frame.col(1) = frame.col(2).cross(frame.col(0));
    surface = Ellipsoid{scale * length(order[0]), scale * length(order[1]), scale * length(order[2])};
    by.setZero(3, 3);
    for (int k = 0; k < 3; ++k) by(k, order[static_cast<std::size_t>(k)]) = scale;
  }
  Named result{{*surface}, by};
  result.placed.placement.linear() = frame;
  result.placed.placement.translation() = data.centre + scale * origin;
  return result;
}

Natural natural_of(const PlacedSurface& placed, const Scaled& data) {
  Natural n{(placed.placement.translation() - data.centre) / data.scale, placed.placement.linear(), {}};
  const std::vector<ParameterValue> p = placed.surface.parameters();
  for (std::size_t k = 0; k < std::min<std::size_t>(p.size(), 3); ++k) n.lengths[k] = p[k].value / data.scale;
  if (placed.surface.info().name == "cone") {
    n.centre += n.lengths[1] * n.axes.col(2);
    n.axes = axes_with_z(-n.axes.col(2));
    n.lengths = {std::atan2(n.lengths[0], n.lengths[1])};
  }
  return n;
}

// From the covariance of (rotation vector, movement of `reference`, parameters) in scaled units.
std::vector<StandardError> standard_errors(std::string_view kind, const Named& surface,
                                           const Eigen::MatrixXd& covariance, const Scaled& data,
                                           const Vector3d& reference) {
  std::vector<StandardError> result;
  const auto root = [](double x) { return std::sqrt(std::fmax(x, 0)); };
  const std::vector<ParameterValue> parameters = surface.placed.surface.parameters();
  for (Eigen::Index k = 0; k < surface.by.rows(); ++k)
    if (!surface.by.row(k).isZero(0))
      result.push_back({std::string(parameters[static_cast<std::size_t>(k)].name),
                        data.scale * root(covariance(6 + k, 6 + k))});
  const Vector3d axis = surface.placed.placement.linear().col(2);
  const Matrix3d across = Matrix3d::Identity() - axis * axis.transpose();
  if (kind != "sphere")
    result.push_back({"axis_deg", root((across * covariance.topLeftCorner<3, 3>() * across).trace()) * 180 /
                                      std::numbers::pi});
  const Vector3d arm = (surface.placed.placement.translation() - data.centre) / data.scale - reference;
  Eigen::Matrix<double, 3, 6> moves;  // turn x arm + movement
  moves << 0, arm.z(), -arm.y(), 1, 0, 0, -arm.z(), 0, arm.x(), 0, 1, 0, arm.y(), -arm.x(), 0, 0, 0, 1;
  if (kind == "cylinder") moves = (across * moves).eval();
  result.push_back(
      {"centre", data.scale * root((moves * covariance.topLeftCorner<6, 6>() * moves.transpose()).trace())});
  return result;
}

struct Chosen {
  std::size_t index = 0;
  bool usable = false;
  std::string reason{};
};

// "plane or cylinder of radius > 3"
std::string either(const Found& a, const Found& b, double scale) {
  std::string text = std::string(a.kind) + " or " + std::string(b.kind);
  if (a.kind == "plane" && (b.kind == "sphere" || b.kind == "cylinder")) {
    text += " of radius > " + rounded(scale * least_length(b, 0), 3);
  }
  return text;
}

// The kind with the smallest criterion, where nothing speaks for another.
Chosen choose(const std::vector<Found>& tried, const std::vector<Verdict>& verdicts,
              const std::vector<double>& bic, const std::vector<std::size_t>& best_first, double scale) {
  const auto is = [&](Verdict::Kind kind) {
    return [&verdicts, kind](std::size_t i) { return verdicts[i].kind == kind; };
  };
  const auto found = std::find_if(best_first.begin(), best_first.end(), is(Verdict::Kind::good));
  if (found == best_first.end()) {
    const auto possible = std::find_if(best_first.begin(), best_first.end(), is(Verdict::Kind::unsure));
    const std::size_t i = possible != best_first.end() ? *possible : best_first.front();
    return {i, false, with_article(tried[i].kind) + " " + verdicts[i].why};
  }
  const std::size_t best = *found;
  std::string remark;
  for (const std::size_t i : best_first) {
    if (i == best || verdicts[i].kind == Verdict::Kind::none) continue;
    const auto undetermined = [&](const std::string& why) {
      const bool simpler = tried[best].freedom < tried[i].freedom;
      const Found &a = tried[simpler ? best : i], &b = tried[simpler ? i : best];
      return Chosen{best, false, "undetermined: " + either(a, b, scale) + why};
    };
    // Better, but it is no surface that could be given.
    if (bic[i] < bic[best] - margin)
      return undetermined(": the points speak for " + with_article(tried[i].kind) + ", which " +
                          verdicts[i].why);
    if (tried[i].freedom < tried[best].freedom && bic[i] < bic[best] + margin)
      return undetermined("; points over a larger part of it or less noise help");
    if (tried[best].kind == "plane" && tried[i].kind == "cylinder" && tried[i].converged &&
        bic[i] < bic[best] + 4 * margin)
      remark = "; a cylinder fits as well: " + either(tried[best], tried[i], scale);
  }
  return {best, true, "converged" + remark};
}

}  // namespace

const std::vector<std::string_view>& found_kinds() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> list;
    for_each_shape([&]<class Shape>() { list.push_back(Shape::name); });
    return list;
  }();
  return names;
}

PointFit fit_by_kind(const PointCloud& points, const PointFitOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  const auto& kinds = found_kinds();
  const bool automatic = options.surface == "auto";
  const Scaled data = scaled(points);
  const auto n = static_cast<std::size_t>(data.cloud.cols());
  PointFit fit;
  fit.ignored = points.positions.size() - data.finite;
  fit.outliers = data.finite;
  fit.is_inlier.assign(points.positions.size(), false);
  const auto done = [&](std::string reason) {
    fit.reason = std::move(reason);
    fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    if (options.progress) options.progress(1);
    return fit;
  };
  std::size_t fewest = 0;  // for the first kind that is to be found: one more than would fit exactly
  for_each_shape([&]<class Shape>() {
    if (fewest == 0 && (automatic || options.surface == Shape::name)) fewest = Shape::freedom + 1;
  });
  if (data.finite == 0) return done("no point is finite");
  if (n < fewest)
    return done(n == 1 ? "all points are at one place"
                       : "underdetermined: " + std::to_string(n) + (n < data.finite ? " different" : "") +
                             " points, " +
                             with_article(automatic ? kinds.front() : std::string_view(options.surface)) +
                             " needs at least " + std::to_string(fewest));
  if (const std::string why = unusual_size(data.scale); !why.empty()) return done(why);
  if (on_a_line(data.cloud)) return done("all points lie on one line; points beside it help");

  std::mt19937_64 random(options.seed);
  const Oriented oriented = oriented_points(data.cloud, data.normals, random);
  Search search{data.cloud, oriented, std::nullopt, std::nullopt, options.seed, {}};
  if (options.noise) search.sigma = *options.noise / data.scale;
  if (options.guess) search.guess = natural_of(*options.guess, data);
  std::vector<Found> tried;
  const auto permitted = [&](std::string_view kind, const Natural& surface) {
    return !automatic || !crosses_itself(kind, surface);
  };
  std::vector<Lead> leads;
  double share = 0, span = 0;
  search.progress = [&](double now) {
    if (options.progress) options.progress(share + now * span);
  };
  span = 0.3 / static_cast<double>(automatic ? kinds.size() : 1);
  for_each_shape([&]<class Shape>() {
    if (!automatic && options.surface != Shape::name) return;
    if (n > Shape::freedom)
      if (auto lead = find<Shape>(search); lead && permitted(lead->kind, lead->surface))
        leads.push_back(*lead);
    share += span;
  });
  const auto furthest = std::max_element(leads.begin(), leads.end(),
                                         [](const Lead& a, const Lead& b) { return a.score < b.score; });
  span = 0.7 / std::max(1.0, static_cast<double>(leads.size()));
  for_each_shape([&]<class Shape>() {
    for (const Lead& lead : leads) {
      if (lead.kind != Shape::name) continue;
      // Part of the points is enough to see that a kind is none. Odds of exp(300), and far more when all are
      // counted.
      Found found = refine<Shape>(search, lead, lead.score < furthest->score - 300);
      fit.iterations += found.iterations;
      if (permitted(found.kind, found.surface)) tried.push_back(std::move(found));
      share += span;
    }
  });
  if (tried.empty())
    return done("no " + std::string(automatic ? "surface" : options.surface) + " goes near the points");

  std::vector<Verdict> verdicts;
  std::size_t reference = 0;
  std::pair<bool, double> most{false, -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < tried.size(); ++i) {
    verdicts.push_back(judge(tried[i]));
    const std::pair likely(verdicts[i].kind == Verdict::Kind::good, evidence(tried[i]));
    if (likely > most) most = likely, reference = i;
  }
  const std::vector<double> bic = criteria(tried, reference);
  std::vector<std::size_t> best_first(tried.size());
  std::iota(best_first.begin(), best_first.end(), 0);
  std::stable_sort(best_first.begin(), best_first.end(),
                   [&](std::size_t a, std::size_t b) { return bic[a] < bic[b]; });
  const auto inliers = [&](const Found& f) {
    std::vector<bool> is_inlier(n);
    for (std::size_t i = 0; i < n; ++i) {
      // Beyond the gate inliers are rare: a point is one only where outliers are much rarer still.
      const double outliers = f.outliers * (f.kept[i] ? 1 : 1000);
      is_inlier[i] = inlier_probability(f.error[i], {f.sigma, outliers}) > 0.5;
    }
    return is_inlier;
  };
  const auto rms = [&](const Found& f, const std::vector<bool>& is_inlier) {
    double squares = 0;
    for (std::size_t i = 0; i < n; ++i)
      if (is_inlier[i]) squares += f.error[i] * f.error[i];
    return data.scale * std::sqrt(squares / std::max(1.0, static_cast<double>(std::count(
                                                              is_inlier.begin(), is_inlier.end(), true))));
  };
  Chosen chosen = choose(tried, verdicts, bic, best_first, data.scale);
  const auto place = std::find(best_first.begin(), best_first.end(), chosen.index);
  std::rotate(best_first.begin(), place, place + 1);
  for (const std::size_t i : best_first)
    fit.candidates.push_back({std::string(tried[i].kind), bic[i], rms(tried[i], inliers(tried[i]))});
  const Found& best = tried[chosen.index];
  const std::vector<bool> is_inlier = inliers(best);
  for (std::size_t i = 0; i < n; ++i) fit.is_inlier[data.index[i]] = is_inlier[i];
  for (const auto& [i, column] : data.others) fit.is_inlier[i] = is_inlier[column];
  fit.inliers = static_cast<std::size_t>(std::count(fit.is_inlier.begin(), fit.is_inlier.end(), true));
  fit.outliers = data.finite - fit.inliers;
  fit.rms = rms(best, is_inlier);
  // The distances are smaller by what the parameters took up.
  const auto k = static_cast<double>(std::count(is_inlier.begin(), is_inlier.end(), true));
  const double sigma_squared = options.noise ? 1 : k / std::max(1.0, k - best.freedom);
  fit.sigma = data.scale * best.sigma * std::sqrt(sigma_squared);
  if (!chosen.usable) return done(chosen.reason);
  if (automatic && 5 * k < 2 * static_cast<double>(n))
    return done("undetermined: the nearest is " + with_article(best.kind) + ", with only " +
                std::to_string(fit.inliers) + " of " + std::to_string(data.finite) +
                " points; fewer outliers help, or naming the kind");
  // Significant by six standard deviations, sqrt(2 / k) each, and so much that sigma is not the noise. Exact
  // data have roundings for errors.
  if (best.sigma > 1e-12 &&
      unlikeness_of_neighbours(data.cloud, best, is_inlier) < std::fmin(0.75, 1 - 6 * std::sqrt(2 / k))) {
    const std::string alike = "distances of neighbouring points are alike, not noise";
    if (automatic)
      return done("undetermined: the nearest is " + with_article(best.kind) + ", but " + alike +
                  "; the surface is of another kind, or that was not found: naming it or a guess help");
    chosen.reason += "; " + alike + ": the surface is not quite " + with_article(best.kind);
  }

  const Named surface = named(best, data, fit.is_inlier);
  fit.surface = surface.placed;
  const auto parameters = surface.by.rows();
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(6 + parameters, 9);  // in the scaled units still
  by.topLeftCorner<3, 3>().setIdentity();
  by.block<3, 3>(3, 3).setIdentity();
  by.bottomRightCorner(parameters, 3) = surface.by / data.scale;
  const Eigen::MatrixXd covariance = sigma_squared * by * best.covariance * by.transpose();
  Eigen::VectorXd units = Eigen::VectorXd::Constant(6 + parameters, data.scale);
  units.head<3>().setOnes();
  fit.covariance = units.asDiagonal() * covariance * units.asDiagonal();
  fit.centre = data.centre + data.scale * best.reference;
  fit.standard_errors = standard_errors(best.kind, surface, covariance, data, best.reference);
  fit.usable = true;
  return done(chosen.reason);
}

}  // namespace darboux
