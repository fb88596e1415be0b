#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/fit_points.h>

#include "estimate.h"
#include "find.h"

namespace darboux {
namespace {

using namespace fit;
using Eigen::Matrix3Xd;

// The finite points, centred by their medians and scaled by a power of two to a median distance of about 1: no outlier, however
// far, decides what the digits are spent on.
struct Scaled {
  Matrix3Xd cloud;
  std::vector<std::size_t> index;  // in the input
  Vector3d centre;
  double scale;
};

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Scaled scaled(const PointCloud& points) {
  Scaled result;
  for (std::size_t i = 0; i < points.positions.size(); ++i)
    if (detail::finite(points.positions[i])) result.index.push_back(i);
  const std::size_t n = result.index.size();
  result.cloud.resize(3, static_cast<Eigen::Index>(n));
  if (n == 0) return result;
  std::vector<double> values(n);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < n; ++i) values[i] = to_eigen(points.positions[result.index[i]])[axis];
    result.centre[axis] = median(values);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3d q = to_eigen(points.positions[result.index[i]]) - result.centre;
    values[i] = q.stableNorm();
    result.cloud.col(static_cast<Eigen::Index>(i)) = q;
  }
  const double size = median(values);
  result.scale = size > 0 ? std::exp2(std::rint(std::log2(size))) : 0;
  if (result.scale > 0) result.cloud /= result.scale;
  return result;
}

std::string listed(const std::vector<std::string_view>& names) {
  std::string list;
  for (const std::string_view name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

// The side of a direction whose largest component is positive.
Vector3d positive_side(const Vector3d& a) {
  Eigen::Index largest;
  a.cwiseAbs().maxCoeff(&largest);
  return a[largest] < 0 ? Vector3d(-a) : a;
}

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

// What the catalogue calls a found surface, in the units of the points. Lengths that only bound the patch enclose the inliers.
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

void check(const PointCloud& points, const PointFitOptions& options) {
  const auto same = [&](std::size_t count, const char* what) {
    if (count != 0 && count != points.positions.size())
      throw MeshError("points", std::to_string(count) + " " + what + " for " + std::to_string(points.positions.size()) +
                                    " positions, permitted are as many or none");
  };
  same(points.normals.size(), "normals");
  same(points.uvs.size(), "uvs");
  const auto& kinds = found_kinds();
  if (options.surface != "auto" && std::find(kinds.begin(), kinds.end(), options.surface) == kinds.end())
    throw ParameterError(options.surface, "cannot be found in points, permitted are auto, " + listed(kinds));
  if (options.noise && !(*options.noise > 0 && std::isfinite(*options.noise)))
    throw ParameterError("noise", "must be a positive length, permitted is noise > 0");
  if (options.guess && options.guess->surface.info().name != options.surface)
    throw ParameterError("guess", "is a " + std::string(options.guess->surface.info().name) +
                                      ", permitted is a surface of the kind to be found, " + options.surface);
  if (options.guess && !options.guess->placement.matrix().allFinite())
    throw ParameterError("guess", "its placement is not finite, permitted is a rigid placement");
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

PointFit fit_points(const PointCloud& points, const PointFitOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  check(points, options);
  const Scaled data = scaled(points);
  const auto n = static_cast<std::size_t>(data.cloud.cols());
  PointFit fit;
  fit.ignored = points.positions.size() - n;
  fit.is_inlier.assign(points.positions.size(), false);
  const auto done = [&](std::string reason) {
    fit.reason = std::move(reason);
    fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return fit;
  };
  if (n < 3 || data.scale == 0) return done("too few points");

  std::mt19937_64 random(options.seed);
  const Oriented oriented = oriented_points(data.cloud, random);
  Search search{data.cloud, oriented, std::nullopt, std::nullopt, options.seed};
  if (options.noise) search.sigma = *options.noise / data.scale;
  if (options.guess) search.guess = natural_of(*options.guess, data);
  std::vector<Found> tried;
  for_each_shape([&]<class Shape>() {
    if (options.surface != "auto" && options.surface != Shape::name) return;
    if (auto found = find<Shape>(search)) tried.push_back(std::move(*found));
    fit.iterations += tried.empty() ? 0 : tried.back().iterations;
  });
  if (tried.empty()) return done("no surface goes through the points");
  const Found& best = tried.front();

  const Noise noise{best.sigma, best.outliers};
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const bool inlier = best.kept[i] && inlier_probability(best.error[i], noise) > 0.5;
    fit.is_inlier[data.index[i]] = inlier;
    fit.inliers += inlier;
    if (inlier) squares += best.error[i] * best.error[i];
  }
  fit.outliers = n - fit.inliers;
  fit.sigma = data.scale * best.sigma;
  fit.rms = data.scale * std::sqrt(squares / static_cast<double>(std::max<std::size_t>(fit.inliers, 1)));
  const Named surface = named(best, data, fit.is_inlier);
  fit.surface = surface.placed;
  const auto parameters = surface.by.rows();
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(6 + parameters, 9);
  by.topLeftCorner<3, 3>().setIdentity();
  by.block<3, 3>(3, 3) = data.scale * Matrix3d::Identity();
  by.bottomRightCorner(parameters, 3) = surface.by;
  fit.covariance = by * best.covariance * by.transpose();
  fit.centre = data.centre + data.scale * best.reference;
  fit.usable = best.converged;
  return done(best.converged ? "converged" : "Ceres did not converge");
}

}  // namespace darboux
