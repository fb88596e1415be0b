#include "fit_catalogue.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>

#include <darboux/error.h>

#include "base/text.h"
#include "determinacy.h"
#include "fit/common/arguments.h"
#include "fit/common/kinds.h"
#include "fit/common/normalised_points.h"
#include "principal.h"
#include "starts.h"

namespace darboux {
namespace {

using namespace fit::catalogue;
using fit::ReducedNormalEquations;

bool is_flat(const AnySurface& surface) {
  Positions nodes;
  for (const double u : {0.0, 0.2, 0.45, 0.7, 0.9})
    for (const double v : {0.1, 0.3, 0.55, 0.8, 1.0}) nodes.push_back(to_eigen(surface.jet(u, v).position));
  const Principal of_nodes = principal(nodes);
  return !(of_nodes.thickness > 1e-9 * of_nodes.size);
}

void check_kind(const std::string& kind, const AnySurface& standard) {
  if (address(standard)) return;
  std::vector<std::string> names;
  for (const AnySurface& surface : all_surfaces())
    if (address(surface)) names.emplace_back(surface.info().name);
  throw ParameterError(kind, "cannot be fitted to points, expected one of " + joined(names));
}

// The typical size of each parameter: of the defaults, except lengths, which are those of a start.
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

constexpr double far = 20;  // points beyond so many times the size are not used for starts
constexpr std::size_t draft_points = 200, trial_points = 2000, most_starts = 40, most_finalists = 3;

// One fit.
class CatalogueFit {
 public:
  CatalogueFit(const PointCloud& cloud, const std::string& kind, const PointFitOptions& options,
               const AnySurface& standard)
      : options_(options),
        standard_(standard),
        kind_(kind),
        a_kind_(fit::with_article(kind)),
        unknowns_(6 + standard.parameters().size()),
        flat_(is_flat(standard)),
        lengths_(lengths_of(standard)),
        normalised_(fit::normalised(cloud)),
        size_(normalised_.scale) {
    fit_.is_inlier.assign(cloud.positions.size(), false);
    fit_.ignored = cloud.positions.size() - normalised_.finite;
    fit_.outliers = normalised_.finite;
  }

  PointFit run() && {
    fit_.reason = reason();
    if (!fit_.usable) fit_.surface.reset();
    if (options_.progress) options_.progress(1);
    fit_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    return std::move(fit_);
  }

 private:
  std::string reason() {
    if (std::string why = prepare(); !why.empty()) return why;
    const std::vector<Start> starts = all_starts();
    if (starts.empty()) return "no start of " + a_kind_ + " is near the points";
    std::optional<Estimate> best = best_of(starts);
    if (!best) return "no start of " + a_kind_ + " converges";
    return report(*best);
  }

  // Why the points cannot be fitted by any surface; empty if they can.
  std::string prepare() {
    if (std::string why = fit::against_points(normalised_, unknowns_ + 3, kind_); !why.empty()) return why;
    fit_.centre = normalised_.centre;
    // Shuffled, so that the first ones are a fair sample.
    std::mt19937_64 random(options_.seed);
    order_.resize(normalised_.index.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::shuffle(order_.begin(), order_.end(), random);
    // In the input's units: some surfaces of the catalogue have a size of their own.
    for (const std::size_t i : order_) {
      const Eigen::Vector3d x = normalised_.cloud.col(static_cast<Eigen::Index>(i));
      points_.emplace_back(size_ * x);
      if (x.norm() < far) near_.push_back(points_.back());
    }
    if (fit::on_a_line(
            Eigen::Matrix3Xd::Map(near_.front().data(), 3, static_cast<Eigen::Index>(near_.size()))))
      return "all points lie on one line; points beside it help";
    if (!flat_ && principal(near_).thickness <= 1e-12 * size_)
      return "all points lie in one plane, " + a_kind_ + " needs points beside it";
    return {};
  }

  Positions first(std::size_t n) const {
    return Positions(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(std::min(near_.size(), n)));
  }

  std::vector<Start> all_starts() const {
    std::vector<Start> starts = starts_of(standard_, lengths_, first(10000));
    if (starts.size() > most_starts) starts.erase(starts.begin() + most_starts, starts.end());
    if (options_.guess) {
      Shape guess{options_.guess->surface, options_.guess->placement};
      guess.placement.pretranslate(-fit_.centre);
      starts.insert(starts.begin(), {std::move(guess), 0});
    }
    return starts;
  }

  // Progress of a stage that runs from one share of the whole to another.
  Progress between(double from, double to) const {
    return [this, from, to](double share) {
      if (options_.progress) options_.progress(from + share * (to - from));
    };
  }

  // An estimate from this shape, using all of these points.
  Estimate refined(const Shape& shape, const Positions& points, const Progress& progress) {
    Estimate e{shape};
    if (options_.noise) {
      e.mixture.sigma = *options_.noise;
      e.mixture.sigma_known = true;
    }
    refine(e, points, typical_, size_, false, progress);
    fit_.iterations += e.iterations;
    return e;
  }

  // Drafts from every start use few points, the likeliest ones more, the best one all.
  std::optional<Estimate> best_of(const std::vector<Start>& starts) {
    typical_ = typical_values(standard_, lengths_, starts.front().shape);
    const Positions few = first(draft_points);
    std::vector<Estimate> drafts;
    for (std::size_t k = 0; k < starts.size(); ++k) {
      Estimate e{starts[k].shape};  // far from the optimum; there a known noise does not apply
      refine(e, few, typical_, size_, true, {});
      fit_.iterations += e.iterations;
      if (std::isfinite(e.log_likelihood)) drafts.push_back(std::move(e));
      between(0, 0.3)(static_cast<double>(k + 1) / static_cast<double>(starts.size()));
    }
    std::stable_sort(drafts.begin(), drafts.end(), [](const Estimate& a, const Estimate& b) {
      return a.log_likelihood > b.log_likelihood;
    });
    const Positions trial = first(trial_points);
    std::optional<Estimate> best;
    for (std::size_t k = 0; k < std::min(drafts.size(), most_finalists); ++k) {
      const double from = 0.3 + 0.1 * static_cast<double>(k);
      Estimate e = refined(drafts[k].shape, trial, between(from, from + 0.1));
      if (!best ||
          std::pair(e.converged, e.log_likelihood) > std::pair(best->converged, best->log_likelihood))
        best = std::move(e);
      if (best->converged && best->mixture.sigma < 1e-3 * size_) break;
    }
    if (best && trial.size() < points_.size()) best = refined(best->shape, points_, between(0.6, 1));
    return best;
  }

  std::string report(Estimate& best) {
    double squares = 0;
    Positions inliers;
    std::vector<Vec2<double>> feet;
    std::vector<bool> is_inlier(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (best.weighted.weight[i] > 0.5) {
        is_inlier[order_[i]] = true;
        inliers.push_back(points_[i]);
        feet.push_back(best.feet.uv[i]);
        squares += best.feet.distance[i] * best.feet.distance[i];
      }
    normalised_.spread(is_inlier, fit_.is_inlier);
    fit_.inliers = static_cast<std::size_t>(std::count(fit_.is_inlier.begin(), fit_.is_inlier.end(), true));
    fit_.outliers = normalised_.finite - fit_.inliers;
    fit_.rms = inliers.empty() ? 0 : std::sqrt(squares / static_cast<double>(inliers.size()));
    const std::string found = "the best " + kind_ + " found ";
    if (!flat_ && plane_is_as_good(inliers, fit_.rms, static_cast<double>(unknowns_), size_))
      return found + "cannot be told from a plane; points over a larger part of it or less noise help";
    if (!best.converged) return "the fit of " + a_kind_ + " did not converge";
    if (inliers.size() < unknowns_ || 2 * inliers.size() < points_.size())
      return "only " + std::to_string(inliers.size()) + " of " + std::to_string(points_.size()) +
             " points lie on " + found.substr(0, found.size() - 1);
    if (const double share = fit_.rms / principal(inliers).size; !(share <= 0.05))
      return found + "leaves distances of " + rounded(share, 2) + " of the points' size";
    return report_surface(best, inliers, feet, found);
  }

  std::string report_surface(Estimate& best, const Positions& inliers, const std::vector<Vec2<double>>& feet,
                             const std::string& found) {
    Eigen::VectorXd units = units_of(best.shape, typical_, size_);
    ReducedNormalEquations known = information(best, points_, units, size_);
    if (enclose(best, known, inliers, feet, size_)) {
      best.feet = feet_of(best.shape, points_, {});
      units = units_of(best.shape, typical_, size_);
      known = information(best, points_, units, size_);
    }
    double numbers = 0;
    for (Eigen::Index k = 0; k < units.size(); ++k) numbers += known.is_identifiable(k);
    // The inliers' residuals are smaller than the noise, as the unknowns absorb part of it.
    const auto n = static_cast<double>(inliers.size());
    fit_.sigma =
        options_.noise ? *options_.noise : best.mixture.sigma * std::sqrt(n / std::fmax(1, n - numbers));
    fit_.candidates.push_back({kind_,
                               -2 * best.log_likelihood + (numbers + (options_.noise ? 1 : 2)) *
                                                              std::log(static_cast<double>(points_.size())),
                               fit_.rms});
    const std::string held =
        add_covariance(best, known, units, fit_.sigma / size_,
                       options_.noise ? std::numeric_limits<double>::infinity() : n - numbers, fit_);
    if (const std::string why = against(best, fit_, known, units, lengths_, size_); !why.empty())
      return found + why;
    fit_.surface = PlacedSurface{best.shape.surface, best.shape.placement};
    fit_.surface->placement.pretranslate(fit_.centre);
    fit_.usable = true;
    return a_kind_ + " within the noise" + held;
  }

  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  const PointFitOptions& options_;
  const AnySurface& standard_;
  const std::string& kind_;
  const std::string a_kind_;
  std::size_t unknowns_;
  bool flat_;
  std::vector<bool> lengths_;
  fit::NormalisedPoints normalised_;
  double size_;
  std::vector<std::size_t> order_;  // of the columns, shuffled
  Positions points_, near_;         // in that order
  std::vector<double> typical_;
  PointFit fit_;
};

}  // namespace

PointFit fit_catalogue(const PointCloud& cloud, const std::string& kind, const PointFitOptions& options) {
  const AnySurface standard = make_surface(SurfaceSpecification{kind, {}});
  check_kind(kind, standard);
  PointFitOptions named = options;
  named.surface = kind;
  fit::check_arguments(cloud, named);
  return CatalogueFit(cloud, kind, options, standard).run();
}

}  // namespace darboux
