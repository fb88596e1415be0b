#include "fit_catalogue.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>

#include <darboux/error.h>

#include "base/text.h"
#include "fit/common/kinds.h"
#include "fit/common/scaled.h"
#include "judgement.h"
#include "principal.h"
#include "starts.h"

namespace darboux {
namespace {

using namespace fit::any;

bool is_flat(const AnySurface& surface) {
  Positions nodes;
  for (const double u : {0.0, 0.2, 0.45, 0.7, 0.9})
    for (const double v : {0.1, 0.3, 0.55, 0.8, 1.0}) nodes.push_back(to_eigen(surface.jet(u, v).position));
  const Principal of_nodes = principal(nodes);
  return !(of_nodes.thickness > 1e-9 * of_nodes.size);
}

void check(const PointCloud& points, const std::string& kind, const PointFitOptions& options,
           const AnySurface& standard) {
  if (!address(standard)) {
    std::vector<std::string> names;
    for (const AnySurface& surface : all_surfaces())
      if (address(surface)) names.emplace_back(surface.info().name);
    throw ParameterError(kind, "cannot be fitted to points, permitted are " + joined(names));
  }
  if (options.noise && !(*options.noise > 0 && *options.noise < infinity))
    throw ParameterError("noise", "is not positive and finite, permitted is 0 < noise < inf");
  if (options.guess && options.guess->surface.info().name != standard.info().name)
    throw ParameterError("guess", "is " + fit::with_article(options.guess->surface.info().name) +
                                      ", permitted is " + fit::with_article(kind));
  if (options.guess && !options.guess->placement.matrix().allFinite())
    throw ParameterError("guess", "has a placement that is not finite, permitted are finite ones");
  const auto fits = [&](std::size_t n) { return n == 0 || n == points.positions.size(); };
  if (!fits(points.normals.size()))
    throw MeshError("points", "have another number of normals than positions");
  if (!fits(points.uvs.size())) throw MeshError("points", "have another number of uvs than positions");
}

// About how large each parameter is: that of the defaults, lengths as they are at a start.
std::vector<double> typical_values(const AnySurface& standard, const std::vector<bool>& lengths,
                                   const Shape& start) {
  const std::vector<double> defaults = values_of(standard);
  double scale = 1;
  if (!lengths.empty()) {
    const auto k =
        static_cast<std::size_t>(std::find(lengths.begin(), lengths.end(), true) - lengths.begin());
    scale = std::fabs(values_of(start.surface)[k] / defaults[k]);
  }
  std::vector<double> result;
  for (std::size_t k = 0; k < defaults.size(); ++k)
    result.push_back((!lengths.empty() && lengths[k] ? scale : 1) *
                     (defaults[k] == 0 ? 1 : std::fabs(defaults[k])));
  return result;
}

}  // namespace

PointFit fit_any_kind(const PointCloud& cloud, const std::string& kind, const PointFitOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const AnySurface standard = make_surface(SurfaceSpecification{kind, {}});
  check(cloud, kind, options, standard);
  PointFit fit;
  fit.is_inlier.assign(cloud.positions.size(), false);
  const fit::Scaled scaled = fit::scaled(cloud);
  const std::size_t count = scaled.index.size(), unknown_count = 6 + standard.parameters().size();
  const std::string a_kind = fit::with_article(kind);
  fit.ignored = cloud.positions.size() - scaled.finite;
  fit.outliers = scaled.finite;
  const auto done = [&](bool usable, std::string reason) {
    fit.usable = usable;
    fit.reason = std::move(reason);
    if (!usable) fit.surface.reset();
    if (options.progress) options.progress(1);
    fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return fit;
  };
  if (count < unknown_count + 3)
    return done(false, count == 1 ? "all points are at one place"
                                  : std::to_string(count) + (count < scaled.finite ? " different" : "") +
                                        " points, " + a_kind + " needs at least " +
                                        std::to_string(unknown_count + 3));
  const double size = scaled.scale;
  if (const std::string why = fit::unusual_size(size); !why.empty()) return done(false, why);
  fit.centre = scaled.centre;
  // Shuffled, so that the first ones are a fair sample. Those beyond so many times the size start nothing.
  constexpr double far = 20;
  std::mt19937_64 random(options.seed);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  Positions points, near;
  for (const std::size_t i : order) {
    const Eigen::Vector3d x = scaled.cloud.col(static_cast<Eigen::Index>(i));
    points.emplace_back(size * x);
    if (x.norm() < far) near.push_back(points.back());
  }
  const bool flat = is_flat(standard);
  if (fit::on_a_line(Eigen::Matrix3Xd::Map(near.front().data(), 3, static_cast<Eigen::Index>(near.size()))))
    return done(false, "all points lie on one line; points beside it help");
  if (!flat && principal(near).thickness <= 1e-12 * size)
    return done(false, "all points lie in one plane, " + a_kind + " needs points beside it");
  const auto first = [&](std::size_t n) {
    return Positions(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(std::min(near.size(), n)));
  };

  const std::vector<bool> lengths = lengths_of(standard);
  constexpr std::size_t draft_points = 200, trial_points = 2000, most_starts = 40, most_finalists = 3;
  std::vector<Start> starts = starts_of(standard, lengths, first(10000));
  if (starts.size() > most_starts) starts.erase(starts.begin() + most_starts, starts.end());
  if (options.guess) {
    Shape guess{options.guess->surface, options.guess->placement};
    guess.placement.pretranslate(-fit.centre);
    starts.insert(starts.begin(), {std::move(guess), 0});
  }
  if (starts.empty()) return done(false, "no start of " + a_kind + " is near the points");
  const auto begin = [&](const Shape& shape) {
    Estimate e{shape};
    if (options.noise) {
      e.mixture.sigma = *options.noise;
      e.mixture.sigma_known = true;
    }
    return e;
  };
  const std::vector<double> typical = typical_values(standard, lengths, starts.front().shape);
  // Of the whole, from one share to another.
  const auto between = [&](double from, double to) {
    return [&options, from, to](double share) {
      if (options.progress) options.progress(from + share * (to - from));
    };
  };
  const Positions few = first(draft_points);
  std::vector<Estimate> estimates;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    Estimate e{starts[k].shape};  // from afar, where a noise that is known does not hold
    refine(e, few, typical, size, true, {});
    fit.iterations += e.iterations;
    if (std::isfinite(e.log_likelihood)) estimates.push_back(std::move(e));
    between(0, 0.3)(static_cast<double>(k + 1) / static_cast<double>(starts.size()));
  }
  std::stable_sort(estimates.begin(), estimates.end(),
                   [](const Estimate& a, const Estimate& b) { return a.log_likelihood > b.log_likelihood; });
  const Positions trial = first(trial_points);
  std::optional<Estimate> best;
  for (std::size_t k = 0; k < std::min(estimates.size(), most_finalists); ++k) {
    Estimate e = begin(estimates[k].shape);
    const double from = 0.3 + 0.1 * static_cast<double>(k);
    refine(e, trial, typical, size, false, between(from, from + 0.1));
    fit.iterations += e.iterations;
    if (!best || std::pair(e.converged, e.log_likelihood) > std::pair(best->converged, best->log_likelihood))
      best = std::move(e);
    if (best->converged && best->mixture.sigma < 1e-3 * size) break;
  }
  if (!best) return done(false, "no start of " + a_kind + " leads anywhere");
  if (trial.size() < points.size()) {
    Estimate e = begin(best->shape);
    refine(e, points, typical, size, false, between(0.6, 1));
    fit.iterations += e.iterations;
    best = std::move(e);
  }

  double squares = 0;
  Positions inliers;
  std::vector<Vec2<double>> feet;
  for (std::size_t i = 0; i < count; ++i)
    if (best->weighted.weight[i] > 0.5) {
      fit.is_inlier[scaled.index[order[i]]] = true;
      inliers.push_back(points[i]);
      feet.push_back(best->feet.uv[i]);
      squares += best->feet.distance[i] * best->feet.distance[i];
    }
  for (const auto& [i, column] : scaled.others) fit.is_inlier[i] = fit.is_inlier[scaled.index[column]];
  fit.inliers = static_cast<std::size_t>(std::count(fit.is_inlier.begin(), fit.is_inlier.end(), true));
  fit.outliers = scaled.finite - fit.inliers;
  const auto n = static_cast<double>(inliers.size());
  fit.rms = inliers.empty() ? 0 : std::sqrt(squares / n);
  const std::string found = "the best " + kind + " found ";
  if (!flat && plane_is_as_good(inliers, fit.rms, static_cast<double>(unknown_count), size))
    return done(false,
                found + "is not told from a plane; points over a larger part of it or less noise help");
  if (!best->converged) return done(false, "the fit of " + a_kind + " did not converge");
  if (inliers.size() < unknown_count || 2 * inliers.size() < count)
    return done(false, "only " + std::to_string(inliers.size()) + " of " + std::to_string(count) +
                           " points lie on " + found.substr(0, found.size() - 1));
  if (const double share = fit.rms / principal(inliers).size; !(share <= 0.05))
    return done(false, found + "leaves distances of " + rounded(share, 2) + " of the points' size");

  Eigen::VectorXd units = units_of(best->shape, typical, size);
  Compressed told = information(*best, points, units, size);
  if (enclose(*best, told, inliers, feet, size)) {
    best->feet = feet_of(best->shape, points, {});
    units = units_of(best->shape, typical, size);
    told = information(*best, points, units, size);
  }
  double numbers = 0;
  for (Eigen::Index k = 0; k < units.size(); ++k) numbers += told.is_known(k);
  // The inliers' residuals are smaller by what the unknowns took up.
  fit.sigma = options.noise ? *options.noise : best->mixture.sigma * std::sqrt(n / std::fmax(1, n - numbers));
  fit.candidates.push_back(
      {kind,
       -2 * best->log_likelihood + (numbers + (options.noise ? 1 : 2)) * std::log(static_cast<double>(count)),
       fit.rms});
  const std::string held = add_covariance(*best, told, units, fit.sigma / size, fit);
  if (const std::string why = against(*best, fit, told, units, lengths, size); !why.empty())
    return done(false, found + why);
  fit.surface = PlacedSurface{best->shape.surface, best->shape.placement};
  fit.surface->placement.pretranslate(fit.centre);
  return done(true, a_kind + " within the noise" + held);
}

}  // namespace darboux
