#include "fit_uv.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>

#include <darboux/error.h>

#include "base/degrees.h"
#include "base/linear_algebra.h"
#include "base/quantile.h"
#include "base/text.h"
#include "fit/common/arguments.h"
#include "fit/common/intervals.h"
#include "fit/common/kinds.h"
#include "fit/common/lack_of_fit.h"
#include "starts.h"

namespace darboux {
namespace {

// Whether every surface of the kind is also one of `other`, which is then at least as likely, and no rival.
bool is_case_of(const UvKind& kind, const UvKind& other) {
  return kind.name == "sphere" && other.name == "ellipsoid";
}

// Numbers of points used to choose the start, and to choose kind and convention.
constexpr std::size_t start_points = 256, trial_points = 1024;

// Points farther from the middle than this many times the typical distance, of positions or of uvs, are not
// used for starts.
constexpr double far = 20;

// Differences of log likelihood, and of the information criterion, that decide. 5 means odds of 148 to 1.
constexpr double decisive = 5, least_bic_margin = 2 * decisive;

struct Data {
  fit::NormalisedPoints all, trial, few;
  std::optional<double> noise;  // in units of the points
  Vec2<double> values{1, 1};    // number of different values of u, of v
};

// One kind with the best of its conventions, fitted to the trial points, later to all.
struct Trial {
  UvModel model;
  UvState state;
  fit::MixtureInVolume mixture;
  double log_likelihood;
  bool converged;
  int iterations;
  double compared = log_likelihood;  // log likelihood for comparisons: see compare_as_rounded

  int parameters() const { return model.columns() + 2; }
  double bic(double points) const {
    return -2 * compared * points / static_cast<double>(model.points->count()) +
           parameters() * std::log(points);
  }
};

void check(const PointCloud& cloud, const PointFitOptions& options) {
  PointFitOptions with_uv = options;
  with_uv.with_uv = true;
  if (!fit::is_automatic(options) && !find_uv_kind(options.surface))
    throw ParameterError(options.surface,
                         "cannot be fitted with uvs, expected one of auto, " + uv_kind_names());
  fit::check_arguments(cloud, with_uv);
  if (options.guess && !find_uv_kind(options.guess->surface.info().name))
    throw ParameterError("guess", "expected one of " + uv_kind_names() + ", got " +
                                      fit::with_article(options.guess->surface.info().name));
}

// Which uvs are not far from the middle of all.
std::vector<bool> near_the_middle(const std::vector<Vec2<double>>& uvs) {
  std::vector<double> x, y, distances;
  for (const auto& uv : uvs) x.push_back(uv.x), y.push_back(uv.y);
  const Vec2<double> middle{median(std::move(x)), median(std::move(y))};
  for (const auto& uv : uvs) distances.push_back(std::hypot(uv.x - middle.x, uv.y - middle.y));
  const double typical = median(distances);
  std::vector<bool> result;
  for (const double d : distances) result.push_back(typical == 0 || d <= far * typical);
  return result;
}

// Whether all of them are collinear up to rounding.
bool on_a_line(const fit::NormalisedPoints& points) {
  const auto n = static_cast<double>(points.count());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto p : points.cloud.colwise()) mean += p / n;
  for (const auto p : points.cloud.colwise()) spread += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d along = symmetric_eigenvalues(spread);
  const double rounding = points.least_sigma();
  return along[1] <= rounding * rounding * n + 1e-30 * along[2];
}

// How many different values of u and of v there are.
Vec2<double> count_values(const std::vector<Vec2<double>>& uvs) {
  const auto count = [&](double Vec2<double>::*axis) {
    std::vector<double> values;
    for (const Vec2<double>& uv : uvs) values.push_back(uv.*axis);
    std::sort(values.begin(), values.end());
    return static_cast<double>(std::unique(values.begin(), values.end()) - values.begin());
  };
  return {count(&Vec2<double>::x), count(&Vec2<double>::y)};
}

// Why the points cannot be fitted by any surface; empty if they can.
std::string prepare(const PointCloud& cloud, const PointFitOptions& options, Data& data) {
  data.all = fit::normalised(cloud, true);
  const fit::NormalisedPoints& all = data.all;
  if (all.count() < 4) return std::to_string(all.count()) + " finite points, a fit with uvs needs at least 4";
  if (all.scale == 0) return "all points are equal";
  if (!std::isfinite(all.scale)) return "the points are too far apart for double precision";
  const std::vector<bool> near_by_uv = near_the_middle(all.uvs);
  std::vector<Eigen::Index> near;
  bool uvs_differ = false;
  for (std::size_t i = 0; i < all.count(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    uvs_differ = uvs_differ || !(all.uvs[i] == all.uvs.front());
    if (all.cloud.col(column).norm() <= far && near_by_uv[i]) near.push_back(column);
  }
  if (!uvs_differ) return "the uvs are all equal";
  data.trial = all.part(near).chosen(trial_points, options.seed);
  data.few = data.trial.chosen(start_points, options.seed);
  data.values = count_values(all.uvs);
  if (options.noise) data.noise = *options.noise / all.scale;
  return on_a_line(data.trial) ? "all points are on one line" : "";
}

Trial maximised(UvStart start, const Data& data, const fit::NormalisedPoints& points) {
  start.model.points = &points;
  fit::MixtureInVolume mixture;
  mixture.dimensions = 3;
  // The median of inliers' distances is 1.54 sigma.
  std::vector<double> squares = start.model.squares(start.state);
  mixture.sigma =
      data.noise ? *data.noise : std::fmax(std::sqrt(median(squares)) / 1.54, points.least_sigma());
  mixture.sigma_known = data.noise.has_value();
  mixture.share = 0.2;
  mixture.compare_densities();
  if (!data.noise) update(mixture, squares, points);
  const Solved solved = start.model.maximise(start.state, mixture);
  if (solved.converged) start.model.polish(start.state, mixture, 3);
  squares = start.model.squares(start.state);
  return {start.model,      start.state,      mixture, log_likelihood(mixture, squares),
          solved.converged, solved.iterations};
}

bool degenerate(const Trial& trial) {
  for (int k = 0; k < trial.model.kind->parameter_count(); ++k)
    if (trial.model.kind->vanishes(k, trial.state.parameters[static_cast<std::size_t>(k)])) return true;
  return false;
}

std::optional<AnySurface> surface_of(const Trial& trial, double size) {
  std::vector<double> values = trial.state.parameters;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (trial.model.kind->length[k]) values[k] *= size;
  try {
    return make_surface(trial.model.kind->name).with(values);
  } catch (const ParameterError&) {
    return std::nullopt;  // out of range, or values that contradict each other
  }
}

// In units of the inliers' extent: with more noise than most_noise, a fit has found nothing; with more than
// much_noise, perhaps too little.
constexpr double most_noise = 0.2, much_noise = 0.06;

// Whether the fit explains the points' extent.
bool explains(const Trial& trial, double noise = most_noise) {
  const double extent = 0.5 * std::cbrt(trial.mixture.volume / (4.0 / 3 * std::numbers::pi));
  return trial.mixture.sigma < noise * extent && trial.mixture.share < 0.7;
}

bool sound(const Trial& trial) {
  return trial.converged && !degenerate(trial) && explains(trial) && surface_of(trial, 1).has_value();
}

struct KindTrials {
  std::optional<Trial> proper, mirrored;
  int iterations = 0;
};

// The first convention that is as likely as the best.
std::optional<Trial> first_of_best(std::vector<Trial> trials) {
  double best = -std::numeric_limits<double>::infinity();
  for (const Trial& t : trials)
    if (sound(t)) best = std::fmax(best, t.log_likelihood);
  for (Trial& t : trials)
    if (sound(t) && t.log_likelihood >= best - decisive) return std::move(t);
  return std::nullopt;
}

double least_median(const std::vector<UvStart>& starts) {
  double least = std::numeric_limits<double>::infinity();
  for (const UvStart& s : starts) least = std::fmin(least, s.median);
  return least;
}

// A start several times worse than the best belongs to another convention or kind; for a kind with shape
// parameters, starts are only approximate.
KindTrials try_conventions(const Data& data, const fit::NormalisedPoints& image, ConventionStarts starts,
                           double best) {
  KindTrials result;
  const bool perhaps_mirrored = least_median(starts.mirrored) < 0.7 * least_median(starts.proper) - 1e-9;
  const auto fitted = [&](std::vector<UvStart>& list, const fit::NormalisedPoints& points) {
    std::vector<Trial> trials;
    for (UvStart& s : list) {
      const bool near = s.model.kind->starts.size() > 1;
      if (s.median > 4 * best + (near ? 0.05 : 1e-9)) continue;
      trials.push_back(maximised(std::move(s), data, points));
      result.iterations += trials.back().iterations;
    }
    return first_of_best(std::move(trials));
  };
  result.proper = fitted(starts.proper, data.trial);
  if (perhaps_mirrored) result.mirrored = fitted(starts.mirrored, image);
  return result;
}

UvStart guessed(const Data& data, const UvKind& kind, const PlacedSurface& guess) {
  UvModel model(kind, data.trial, guess.uv);
  UvState state;
  state.rotation = Eigen::Quaterniond(guess.placement.linear()).normalized();
  state.translation = (guess.placement.translation() - data.all.centre) / data.all.scale;
  for (std::size_t k = 0; k < kind.parameters.size(); ++k)
    state.parameters.push_back(guess.surface.parameters()[k].value / (kind.length[k] ? data.all.scale : 1));
  return {model, state, std::sqrt(median(model.squares(state)))};
}

// The surface in its place, in the units of the input.
std::optional<PlacedSurface> placed(const Trial& trial, const Data& data) {
  const double size = data.all.scale;
  const std::optional<AnySurface> surface = surface_of(trial, size);
  if (!surface) return std::nullopt;
  PlacedSurface result{*surface, Eigen::Isometry3d::Identity(), trial.model.whole_convention(trial.state)};
  result.placement.linear() = trial.state.rotation.toRotationMatrix();
  result.placement.translation() = size * trial.state.translation + data.all.centre;
  return result;
}

// How far half of the greatest roundings of u and of v move the points, root mean square over points and
// coordinates, in the points' units.
Vec2<double> moved_by_uvs(const PlacedSurface& surface, const Data& data, double rounding) {
  Vec2<double> squares{0, 0};
  for (const Vec2<double>& uv : data.few.uvs) {
    const Vec3<double> p = surface.position(uv), du = surface.position({uv.x + rounding, uv.y}) - p,
                       dv = surface.position({uv.x, uv.y + rounding}) - p;
    if (const double u = dot(du, du); std::isfinite(u)) squares.x += u;
    if (const double v = dot(dv, dv); std::isfinite(v)) squares.y += v;
  }
  const double values = 3 * static_cast<double>(data.few.uvs.size());
  return {std::sqrt(squares.x / values) / data.all.scale, std::sqrt(squares.y / values) / data.all.scale};
}

// The noise together with rounding that points share. Uvs have no noise that could dither their rounding, but
// as many errors as there are values. Numbers with few digits may be exact, such as 0.05 in a grid: then the
// points are much nearer to the surface than rounding to so many digits would leave them. Rounding is at most
// the estimated noise: the greatest error may be that of few numbers.
double noise_and_rounding(const Trial& trial, const Data& data) {
  if (data.noise) return *data.noise;
  const fit::NormalisedPoints& all = data.all;
  const double sigma = trial.mixture.sigma, most = 12 * sigma,
               inliers = (1 - trial.mixture.share) * static_cast<double>(trial.model.points->count());
  double result = sigma;
  for (const double rounding : all.roundings)
    if (rounding > 0 && rounding <= most) {
      result = fit::noise_and_rounding(sigma, std::fmin(rounding, sigma), inliers);
      break;
    }
  const std::optional<PlacedSurface> surface = placed(trial, data);
  if (!surface) return result;
  for (const double rounding : all.uv_roundings)
    if (const auto [u, v] = moved_by_uvs(*surface, data, rounding); rounding > 0 && u <= most && v <= most) {
      const auto shared = [&](double moved, double values) {
        return std::fmax(0, inliers / values - 1) * std::pow(std::fmin(moved, sigma), 2);
      };
      return std::sqrt(result * result + shared(u, data.values.x) + shared(v, data.values.y));
    }
  return result;
}

// If the best trial is as near to the points as rounding permits, likelihoods are for rounded points: its
// mixture is used for all, as a trial with a worse fit would count its misfit as noise.
void compare_as_rounded(std::span<Trial* const> trials, const Data& data) {
  for (Trial* t : trials) t->compared = t->log_likelihood;
  // Trials with a surface come before those without, trials of all points before trials of some.
  const auto rank = [](const Trial* t) {
    return std::tuple(sound(*t), t->model.points->count(), t->log_likelihood);
  };
  const Trial& best = **std::max_element(trials.begin(), trials.end(),
                                         [&](const Trial* a, const Trial* b) { return rank(a) < rank(b); });
  fit::MixtureInVolume mixture = best.mixture;
  mixture.sigma = noise_and_rounding(best, data);
  if (!(mixture.sigma > 1.1 * best.mixture.sigma)) return;
  mixture.compare_densities();
  for (Trial* t : trials) t->compared = log_likelihood(mixture, t->model.squares(t->state));
}

// Whether to search affine maps: this convention explains little, or an affine map much more.
bool wants_affine(const Data& data, Trial trial) {
  if (!explains(trial, much_noise)) return true;
  UvStart start{trial.model, trial.state, 0};
  start.model.free_affine = observable_affine(start.model);
  Trial freed = maximised(start, data, data.trial);
  compare_as_rounded(std::array{&trial, &freed}, data);
  return freed.compared > trial.compared + decisive + 3 * std::log(static_cast<double>(data.trial.count()));
}

std::optional<Trial> try_affine(const Data& data, const UvKind& kind, int& iterations) {
  std::vector<Trial> trials;
  for (UvStart& start : affine_starts(kind, data.few, {}, true)) {
    trials.push_back(maximised(std::move(start), data, data.trial));
    iterations += trials.back().iterations;
  }
  return first_of_best(std::move(trials));
}

std::string described(const Trial& trial) {
  return std::string(trial.model.kind->name) + ", uvs " +
         std::string(trial.model.whole_convention(trial.state).name);
}

// Whether the inliers' residuals are similar between neighbours. Residuals due to rounding, which rows of a
// grid share, are not tested.
bool residuals_are_alike(const Trial& trial, const Data& data, const std::vector<bool>& is_inlier) {
  if (trial.mixture.sigma <= data.all.stored_rounding() ||
      noise_and_rounding(trial, data) > 1.1 * trial.mixture.sigma)
    return false;
  std::vector<Eigen::Index> inliers;
  for (std::size_t i = 0; i < data.all.count(); ++i)
    if (is_inlier[data.all.index[i]]) inliers.push_back(static_cast<Eigen::Index>(i));
  const fit::NormalisedPoints points = data.all.part(inliers);
  UvModel model = trial.model;
  model.points = &points;
  UvModel::Residuals left = model.residuals(trial.state);
  const auto derivatives = [&](const std::vector<Eigen::Index>& some) {
    const fit::NormalisedPoints part = points.part(some);
    UvModel of_part = model;
    of_part.points = &part;
    return of_part.jacobian(trial.state, part.count());
  };
  return fit::neighbours_are_alike(
      {std::move(left.errors), points.cloud, std::move(left.places), derivatives});
}

double inliers_rms(const fit::Mixture& mixture, const std::vector<double>& squares) {
  double inliers = 0, sum = 0;
  for (const double s : squares)
    if (inlier_probability(mixture, s) > 0.5) inliers += 1, sum += s;
  return std::sqrt(sum / std::fmax(inliers, 1));
}

// Computes everything that the header promises for a usable fit, from all points. Returns why it is not
// usable, or an empty text.
std::string report(const Trial& trial, const Data& data, PointFit& fit) {
  const UvKind& kind = *trial.model.kind;
  const double size = data.all.scale;
  std::vector<double> squares;
  const UvSums sums = trial.model.sums(trial.state, trial.mixture, &squares);
  double weights = 0, weighted = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const double w = inlier_probability(trial.mixture, squares[i]);
    if (w > 0.5) {
      fit.is_inlier[data.all.index[i]] = true;
      ++fit.inliers;
    }
    if (!(w > 1e-30)) continue;
    weights += w;
    weighted += w * squares[i];
    centre += w * data.all.cloud.col(static_cast<Eigen::Index>(i));
  }
  centre /= weights;
  fit.outliers = data.all.finite - fit.inliers;
  const int m = trial.model.columns(), parameters = kind.parameter_count();
  if (!(3 * weights > m))
    return std::to_string(fit.inliers) + " points on the surface, " + fit::with_article(kind.name) + " has " +
           std::to_string(m) + " unknowns";
  fit.rms = size * inliers_rms(trial.mixture, squares);
  const double sigma = data.noise ? *data.noise : std::sqrt(weighted / (3 * weights - m));
  fit.sigma = size * sigma;

  const UvSpread spread = trial.model.spread(trial.state, sums);
  if (!spread.undetermined.empty())
    return "the points and their uvs do not determine the " + spread.undetermined + " of the " +
           std::string(kind.name);
  const double with_rounding = noise_and_rounding(trial, data) / trial.mixture.sigma;
  const double factor =
      with_rounding * with_rounding * (sigma / trial.mixture.sigma) * (sigma / trial.mixture.sigma);
  const int dimension = 6 + parameters;  // (ω, τ, δp), whatever the uv map is
  const SurfaceUncertainty uncertainty =
      trial.model.uncertainty(trial.state, factor * spread.covariance, centre);
  fit.covariance = uncertainty.covariance.topLeftCorner(dimension, dimension);
  fit.centre = uncertainty.centre;
  const fit::Intervals intervals(fit, data.noise ? std::numeric_limits<double>::infinity() : 3 * weights - m);
  const auto value = [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    return trial.state.parameters[i] * (kind.length[i] ? size : 1);
  };
  for (int k = 0; k < parameters; ++k)
    intervals.add_number(std::string(kind.parameters[static_cast<std::size_t>(k)].name), value(k),
                         fit.covariance(6 + k, 6 + k));
  const Eigen::Vector3d axis = trial.state.rotation.toRotationMatrix().col(2);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
  intervals.add_length("axis_deg", across * fit.covariance.topLeftCorner<3, 3>() * across,
                       degrees_per_radian);
  intervals.add_length("centre", factor * spread.covariance.block<3, 3>(3, 3), size);
  fit.covariance *= intervals.widening();
  for (int k = 0; k < parameters; ++k) {
    const ParameterValue& p = kind.parameters[static_cast<std::size_t>(k)];
    if (kind.may_be_zero[static_cast<std::size_t>(k)]) continue;
    if (std::fabs(value(k)) < 3 * fit.standard_errors[static_cast<std::size_t>(k)].value)
      return "the points do not distinguish the " + std::string(p.name) + " of the " +
             std::string(kind.name) + " from zero";
    if (const double times = std::fabs(value(k)) / fit.sigma;
        kind.length[static_cast<std::size_t>(k)] && times < 5)
      return "the " + std::string(p.name) + " of the best " + std::string(kind.name) + " is only " +
             rounded(times, 2) + " times the noise: no fit; another kind or less noise helps";
  }
  fit.surface = placed(trial, data);
  return "";
}

// One fit.
class UvFit {
 public:
  UvFit(const PointCloud& cloud, const PointFitOptions& options) : cloud_(cloud), options_(options) {
    fit_.is_inlier.assign(cloud.positions.size(), false);
    for (const UvKind& kind : uv_kinds())
      if (automatic() || options.surface == kind.name) kinds_.push_back(&kind);
  }

  PointFit run() && {
    fit_.reason = reason();
    if (!fit_.usable) fit_.surface.reset();
    if (!fit_.inliers) fit_.outliers = cloud_.positions.size() - fit_.ignored;
    if (options_.progress) options_.progress(1);
    fit_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    return std::move(fit_);
  }

 private:
  bool automatic() const { return fit::is_automatic(options_); }

  void progress(double share) {
    done_ += share;
    if (options_.progress) options_.progress(done_);
  }

  std::string reason() {
    std::string against = prepare(cloud_, options_, data_);
    fit_.ignored = cloud_.positions.size() - data_.all.finite;
    if (!against.empty()) return against;
    count_ = static_cast<double>(data_.all.count());
    if (kinds_.size() == 1 && 3 * count_ <= 6 + kinds_.front()->parameter_count())
      return std::to_string(data_.all.finite) + " finite points, " + fit::with_article(options_.surface) +
             " needs at least " + std::to_string((6 + kinds_.front()->parameter_count()) / 3 + 1);
    search();
    if (mirrored_ && std::none_of(trials_.begin(), trials_.end(), [&](const Trial& t) {
          return t.log_likelihood >= mirrored_->log_likelihood - 2 * decisive;
        })) {
      fit_.mirrored = true;
      return "the uvs follow the mirror image of " + fit::with_article(mirrored_->model.kind->name);
    }
    if (trials_.empty() || wants_affine(data_, trials_.front())) search_affine();
    if (trials_.empty())
      return "the points do not follow the uvs on " + (automatic()
                                                           ? "any surface that is fitted: " + uv_kind_names()
                                                           : fit::with_article(options_.surface));
    refine();
    return select();
  }

  void sort_by_bic() {
    if (trials_.empty()) return;
    std::vector<Trial*> all;
    for (Trial& t : trials_) all.push_back(&t);
    compare_as_rounded(all, data_);
    std::sort(trials_.begin(), trials_.end(),
              [&](const Trial& a, const Trial& b) { return a.bic(count_) < b.bic(count_); });
  }

  // Tries every kind under the conventions, on the trial points.
  void search() {
    fit::NormalisedPoints image = data_.trial;
    image.cloud = -image.cloud;
    const double share = 0.2 / static_cast<double>(kinds_.size());
    std::vector<ConventionStarts> starts;
    double nearest = std::numeric_limits<double>::infinity();
    for (const UvKind* kind : kinds_) {
      starts.push_back(convention_starts(*kind, data_.few, {}, true));
      if (options_.guess && options_.guess->surface.info().name == kind->name)
        starts.back().proper.push_back(guessed(data_, *kind, *options_.guess));
      nearest = std::min({nearest, least_median(starts.back().proper), least_median(starts.back().mirrored)});
      progress(share);
    }
    for (ConventionStarts& of_kind : starts) {
      KindTrials found = try_conventions(data_, image, std::move(of_kind), nearest);
      fit_.iterations += found.iterations;
      if (found.proper) trials_.push_back(std::move(*found.proper));
      if (found.mirrored && (!mirrored_ || found.mirrored->bic(1e3) < mirrored_->bic(1e3)))
        mirrored_ = std::move(found.mirrored);
      progress(share);
    }
    sort_by_bic();
  }

  // Tries every kind under affine maps.
  void search_affine() {
    for (const UvKind* kind : kinds_) {
      std::optional<Trial> affine = try_affine(data_, *kind, fit_.iterations);
      progress(0.2 / static_cast<double>(kinds_.size()));
      if (!affine) continue;
      const auto same =
          std::find_if(trials_.begin(), trials_.end(), [&](const Trial& t) { return t.model.kind == kind; });
      if (same == trials_.end()) {
        trials_.push_back(*affine);
        continue;
      }
      compare_as_rounded(std::array{&*affine, &*same}, data_);
      if (affine->bic(count_) < same->bic(count_) - 2 * decisive) *same = *affine;
    }
    sort_by_bic();
  }

  // Fits to all points the trials that the trial points could not decide between, and the best of the others.
  // If one of the others comes first by all points, it is fitted to all too.
  void refine() {
    const auto of_trial = static_cast<double>(data_.trial.count());
    const double best = trials_.front().bic(of_trial);
    for (Trial& t : trials_)
      if (t.bic(of_trial) <= best + 30) refine(t);
    sort_by_bic();
    while (!is_refined(trials_.front())) {
      refine(trials_.front());
      sort_by_bic();
    }
  }

  bool is_refined(const Trial& t) const { return t.model.points == &data_.all; }

  void refine(Trial& t) {
    t.model.points = &data_.all;
    update(t.mixture, t.model.squares(t.state), data_.all);
    const Solved solved = t.model.solve(t.state, t.mixture, 1e-6);
    fit_.iterations += solved.iterations;
    t.converged = solved.converged;
    if (solved.converged) t.model.polish(t.state, t.mixture, 20);
    t.log_likelihood = log_likelihood(t.mixture, t.model.squares(t.state));
  }

  // Selects the best fit whose unknowns are all determined; a cone without height is a disk.
  std::string select() {
    fit_.candidates.clear();
    for (const Trial& t : trials_)
      fit_.candidates.push_back({std::string(t.model.kind->name), t.bic(count_),
                                 data_.all.scale * inliers_rms(t.mixture, t.model.squares(t.state))});
    std::optional<PointFit> chosen;
    std::string against_first, described_as, remark;
    const UvKind* chosen_kind = nullptr;
    double best_bic = 0;
    for (std::size_t i = 0; i < trials_.size(); ++i) {
      const Trial& t = trials_[i];
      if (chosen && t.bic(count_) > best_bic + least_bic_margin) break;
      if (chosen && is_case_of(*chosen_kind, *t.model.kind)) continue;
      if (!is_refined(t)) {  // which may change the order
        refine(trials_[i]);
        sort_by_bic();
        return select();
      }
      PointFit attempt = fit_;
      std::string why = !t.converged ? "Ceres did not converge on " + fit::with_article(described(t))
                        : !sound(t)
                            ? "the points do not follow the uvs on " + fit::with_article(t.model.kind->name)
                            : report(t, data_, attempt);
      if (i == 0) against_first = why;
      if (!why.empty()) continue;
      if (chosen)
        return "undetermined: " + described_as + " and " + described(t) + " explain the points equally well";
      chosen = std::move(attempt);
      described_as = described(t);
      chosen_kind = t.model.kind;
      best_bic = t.bic(count_);
      if (residuals_are_alike(t, data_, chosen->is_inlier)) {
        const std::string alike = "residuals of neighbouring points are correlated, so they are not noise";
        if (automatic())
          return "undetermined: the nearest is " + fit::with_article(described_as) + ", but " + alike +
                 ": the surface is of another kind, or its uvs are stretched";
        remark = "; " + alike + ": the points depart from that, and errors are understated";
      }
      chosen->candidates.erase(chosen->candidates.begin(),
                               chosen->candidates.begin() + static_cast<std::ptrdiff_t>(i));
    }
    if (!chosen) return against_first;
    fit_ = std::move(*chosen);
    fit_.usable = true;
    return described_as + ", " + std::to_string(fit_.inliers) + " of " + std::to_string(data_.all.finite) +
           " points" + remark;
  }

  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  const PointCloud& cloud_;
  const PointFitOptions& options_;
  std::vector<const UvKind*> kinds_;
  Data data_;
  double count_ = 0, done_ = 0;  // points; the share of the work that is done
  std::vector<Trial> trials_;
  std::optional<Trial> mirrored_;
  PointFit fit_;
};

}  // namespace

PointFit fit_points_with_uv(const PointCloud& cloud, const PointFitOptions& options) {
  check(cloud, options);
  return UvFit(cloud, options).run();
}

}  // namespace darboux
