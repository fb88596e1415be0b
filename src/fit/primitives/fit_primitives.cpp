#include "fit_primitives.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include <darboux/plane.h>

#include "base/degrees.h"
#include "base/quantile.h"
#include "base/text.h"
#include "clump.h"
#include "correlation.h"
#include "determinacy.h"
#include "fit/common/arguments.h"
#include "fit/common/intervals.h"
#include "fit/common/kinds.h"
#include "fit/common/normalised_points.h"
#include "geometry.h"
#include "list.h"
#include "report.h"
#include "select.h"

namespace darboux {
namespace fit {
namespace {

GeometricParameters guess_of(const PlacedSurface& placed, const Primitive& primitive,
                             const NormalisedPoints& points) {
  GeometricParameters n{
      (placed.placement.translation() - points.centre) / points.scale, placed.placement.linear(), {}};
  const std::vector<ParameterValue> p = placed.surface.parameters();
  for (std::size_t k = 0; k < std::min<std::size_t>(p.size(), 3); ++k)
    n.lengths[k] = p[k].value / points.scale;
  return primitive.from_catalogue(n);
}

// Differences of log likelihoods over part of the points. far_likelier: a kind this far behind the likeliest
// is not refined (odds of exp(300), far more with all points). evident: a surface this much likelier than
// none counts as found. hopeless: a kind this far behind such a surface is not searched again.
constexpr double far_likelier = 300, evident = 300, hopeless = 100;
// Distance, over the points' size, at which a search may end whose surface meets the points exactly.
constexpr double nearly_exact = 1e-9;
// For a kind with at least hard_to_find unknowns, the best start may take enough_rounds rounds.
constexpr int hard_to_find = 7, enough_rounds = 4;

// One fit of some primitives.
class PrimitivesFit {
 public:
  PrimitivesFit(const PointCloud& cloud, NormalisedPoints points, const PointFitOptions& options,
                const Primitive* only, Effort effort)
      : options_(options), only_(only), effort_(effort), points_(std::move(points)) {
    if (only)
      list_ = std::span(&only_, 1);
    else
      list_ = primitives();
    fit_.ignored = cloud.positions.size() - points_.finite;
    fit_.outliers = points_.finite;
    fit_.is_inlier.assign(cloud.positions.size(), false);
  }

  PointFit run() {
    fit_.reason = reason();
    return std::move(fit_);
  }
  // Whether the inliers' distances are noise, as far as it shows. \pre run
  bool are_noise() const { return are_noise_; }

 private:
  bool automatic() const { return only_ == nullptr; }

  std::string reason() {
    if (std::string why = against_points(points_, static_cast<std::size_t>(list_.front()->unknowns) + 1,
                                         list_.front()->name);
        !why.empty())
      return why;
    const std::vector<PrimitiveFit> tried = all_fits();
    if (tried.empty())
      return "no " + std::string(automatic() ? "surface" : only_->name) + " goes near the points";
    return report(tried);
  }

  // A torus that crosses itself is found only if requested.
  bool is_wanted(const Primitive& primitive, const GeometricParameters& surface) const {
    return !automatic() || !primitive.crosses_itself || !primitive.crosses_itself(surface);
  }

  // On a small patch or a thin strip, other surfaces look alike. Searches that can construct lookalikes try
  // those of their own best surface and of the best of all.
  static void try_lookalikes(const OrientedPoints& points, std::vector<Search>& searches) {
    const auto worse = [](const Search& a, const Search& b) {
      return std::pair(a.has_surface(), a.log_likelihood_ratio()) <
             std::pair(b.has_surface(), b.log_likelihood_ratio());
    };
    for (Search& search : searches) {
      if (!search.primitive().osculating) continue;
      const Search& best = *std::max_element(searches.begin(), searches.end(), worse);
      const auto others = best.osculation();
      if (!others || !(covers_little(points) || others->is_strip())) continue;
      const auto own = &best != &search ? search.osculation() : std::nullopt;
      search.look_like(*others);
      if (own) search.look_like(*own);
    }
  }

  std::vector<Hypothesis> searched(const SearchProblem& problem) const {
    std::vector<Search> searches;
    for (const Primitive* primitive : list_)
      if (points_.cloud.cols() > primitive->unknowns) searches.emplace_back(problem, *primitive);
    // Progress: a tenth of the work is for the first rounds, two tenths for the others.
    double done = 0;
    const auto work = [&](double tenths) {
      done += 0.1 * tenths / static_cast<double>(searches.size());
      if (options_.progress) options_.progress(done);
    };
    for (Search& search : searches) search.look(), work(1);
    constexpr double nearly_all = 0.9;
    if (problem.effort == Effort::full &&
        std::none_of(searches.begin(), searches.end(),
                     [](const Search& search) { return search.share_of_inliers() > nearly_all; }))
      for (Search& search : searches) search.look_among_outliers();
    // No more rounds if a likely surface of another kind is found: far likelier, or simpler and equally
    // likely. A kind with more unknowns may be likelier only because this one is not found yet. That can be
    // so for a torus and kinds with as many unknowns; others are found at once.
    const auto is_hopeless = [&](const Search& search) {
      const double own = search.log_likelihood_ratio();
      const bool is_looked_for =
          search.primitive().unknowns < hard_to_find || search.rounds() >= enough_rounds;
      return std::any_of(searches.begin(), searches.end(), [&](const Search& other) {
        const double others = other.log_likelihood_ratio();
        if (!other.is_settled() || !(others > evident)) return false;
        const int more = other.primitive().unknowns - search.primitive().unknowns;
        const bool far = others > own + hopeless,
                   alike = others > own - 0.5 * margin && others - own < 0.05 * others;
        return (far && (more <= 0 || is_looked_for)) || (alike && more < 0);
      });
    };
    for (Search& search : searches) {
      double left = 2;
      for (; search.is_open() && !is_hopeless(search); left *= 0.75) search.look(), work(0.25 * left);
      work(left);
    }
    if (problem.effort == Effort::full) try_lookalikes(problem.oriented, searches);
    std::vector<Hypothesis> result;
    for (const Search& search : searches) {
      for (Hypothesis& found : search.hypotheses())
        if (is_wanted(*found.primitive, found.surface)) result.push_back(std::move(found));
    }
    return result;
  }

  // Adds a fit. If hypotheses of one kind led to the same surface, the likelier is kept.
  static void keep(PrimitiveFit found, std::vector<PrimitiveFit>& tried) {
    const auto same = std::find_if(tried.begin(), tried.end(), [&](const PrimitiveFit& other) {
      return other.primitive == found.primitive && are_same(other, found);
    });
    if (same == tried.end())
      tried.push_back(std::move(found));
    else if (log_likelihood_ratio(found) > log_likelihood_ratio(*same))
      *same = std::move(found);
  }

  std::vector<PrimitiveFit> all_fits() {
    std::mt19937_64 random(options_.seed);
    const OrientedPoints oriented =
        oriented_points(points_.cloud, points_.normals, effort_ == Effort::full, random);
    SearchProblem problem{points_.cloud,
                          oriented,
                          std::nullopt,
                          std::nullopt,
                          options_.seed,
                          effort_,
                          {},
                          !automatic(),
                          std::fmax(points_.rounding, points_.half_step),
                          points_.rounding};
    if (options_.noise) problem.sigma = *options_.noise / points_.scale;
    if (options_.guess && only_) problem.guess = guess_of(*options_.guess, *only_, points_);
    double share = 0.3, span = 0;
    problem.progress = [&](double now) {
      if (options_.progress) options_.progress(share + now * span);
    };
    std::vector<Hypothesis> hypotheses = searched(problem);
    double furthest = -std::numeric_limits<double>::infinity();
    for (const Hypothesis& hypothesis : hypotheses)
      furthest = std::max(furthest, hypothesis.log_likelihood_ratio);
    span = 0.7 / std::max(1.0, static_cast<double>(hypotheses.size()));
    std::vector<PrimitiveFit> tried;
    for (const Hypothesis& hypothesis : hypotheses) {
      // Part of the points suffices to exclude a kind. With exact points, searches end at different distances
      // from them.
      const bool is_none = hypothesis.log_likelihood_ratio < furthest - far_likelier &&
                           !(hypothesis.mixture.sigma < nearly_exact);
      PrimitiveFit found = refine(problem, hypothesis, is_none);
      fit_.iterations += found.iterations;
      if (is_wanted(*found.primitive, found.surface)) keep(std::move(found), tried);
      share += span;
    }
    return tried;
  }

  std::string edge_text(const Primitive& primitive, const EdgeEffect& effect) const {
    const bool is_length = effect.length < static_cast<std::size_t>(primitive.lengths);
    const double unit = is_length ? points_.scale : degrees_per_radian;
    return "without the points at its edge the " + std::string(primitive.length_names[effect.length]) +
           " is " + rounded(unit * effect.without_edge, 5) + (is_length ? "" : " degrees") + " instead of " +
           rounded(unit * effect.with_edge, 5) +
           ": they may belong to a surface that joins it; leave them out";
  }

  std::string report(const std::vector<PrimitiveFit>& tried) {
    Selection selection = select(tried, points_.scale);
    const PrimitiveFit& best = tried[selection.order.front()];
    for (const std::size_t i : selection.order) {
      // Of each kind except the first, only the best fit is listed.
      const std::string name(tried[i].primitive->name);
      if (tried[i].primitive != best.primitive &&
          std::any_of(fit_.candidates.begin(), fit_.candidates.end(),
                      [&](const FitCandidate& listed) { return listed.name == name; }))
        continue;
      fit_.candidates.push_back(
          {name, selection.bic[i], points_.scale * rms_of(tried[i], inliers_of(tried[i]))});
    }
    const std::vector<bool> is_inlier = inliers_of(best);
    const NoiseKnowledge noise = report_points(best, points_, is_inlier, options_.noise.has_value(), fit_);
    // If two surfaces are equally likely but neither fits the points, the latter is reported.
    const bool are_alike = (selection.usable || selection.has_rival) &&
                           best.sigma > points_.stored_rounding() &&
                           neighbours_are_alike(points_.cloud, best, is_inlier);
    if (!selection.usable && !(are_alike && automatic())) return selection.reason;
    const auto apart = best.sigma > points_.stored_rounding() ? distance_of_groups(best, is_inlier)
                                                              : std::optional<double>();
    const std::string name = with_article(best.primitive->name);
    if (automatic() && !explains_enough(best))
      return "undetermined: the nearest is " + name + ", with only " + std::to_string(fit_.inliers) + " of " +
             std::to_string(points_.finite) + " points; fewer outliers help, or naming the kind";
    if (apart) {
      const std::string walls = "distances fall into two groups " + rounded(points_.scale * *apart, 3) +
                                " apart, as of the two sides of a wall";
      if (automatic()) return "undetermined: the nearest is " + name + ", but " + walls + ": cut them apart";
      selection.reason += "; " + walls;
      are_noise_ = false;
    }
    if (are_alike) {
      const std::string alike = "distances of neighbouring points are correlated, so they are not noise";
      if (automatic())
        return "undetermined: the nearest is " + name + ", but " + alike +
               ": the points are of no known kind, or of several surfaces; cut those apart, or name the kind";
      selection.reason +=
          "; " + alike + ": the surface departs from " + name + ", and errors are understated";
      are_noise_ = false;
    }
    if (best.sigma > points_.stored_rounding())
      if (const auto effect = edge_effect(points_.cloud, best, is_inlier))
        selection.reason += "; " + edge_text(*best.primitive, *effect);
    report_surface(best, points_, noise, fit_);
    fit_.usable = true;
    return selection.reason;
  }

  const PointFitOptions& options_;
  const Primitive* only_;
  Effort effort_;
  std::span<const Primitive* const> list_;
  NormalisedPoints points_;
  PointFit fit_;
  bool are_noise_ = true;
};

// The fit of the points that were kept, its unit of length, and whether their distances are noise.
struct FitOfOthers {
  PointFit fit;
  double scale;
  bool are_noise;
};
FitOfOthers fit_of_others(const PointCloud& points, const std::vector<bool>& left_out,
                          const PointFitOptions& options, const Primitive* only) {
  PointCloud others;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    if (left_out[i]) continue;
    index.push_back(i);
    others.positions.push_back(points.positions[i]);
    if (!points.normals.empty()) others.normals.push_back(points.normals[i]);
  }
  NormalisedPoints normal = normalised(others);
  const double scale = normal.scale;
  PrimitivesFit fits(others, std::move(normal), options, only, Effort::full);
  PointFit fit = fits.run();
  std::vector<bool> is_inlier(left_out.size(), false);
  for (std::size_t k = 0; k < index.size(); ++k) is_inlier[index[k]] = fit.is_inlier[k];
  const auto left = static_cast<std::size_t>(std::count(left_out.begin(), left_out.end(), true));
  fit.is_inlier = std::move(is_inlier);
  fit.outliers += left;
  return {std::move(fit), scale, fits.are_noise()};
}

// Whether about half of the inliers lie within the noise of one plane: a bound that costs little, before a
// plane is fitted.
bool may_be_a_plane(const PointCloud& points, const PointFit& fit) {
  constexpr double sigmas = 4, share = 0.5;
  Eigen::Matrix3Xd inliers(3, static_cast<Eigen::Index>(fit.inliers));
  Eigen::Index n = 0;
  for (std::size_t i = 0; i < fit.is_inlier.size(); ++i)
    if (fit.is_inlier[i] && n < inliers.cols()) inliers.col(n++) = to_eigen(points.positions[i]);
  Eigen::Matrix3Xd near = inliers.leftCols(n);
  // Each time, the plane of the half that is nearest to the last one.
  for (int repeat = 0; repeat < 5 && near.cols() > 3; ++repeat) {
    const Vector3d mean = near.rowwise().mean();
    const Eigen::Matrix3Xd q = near.colwise() - mean;
    const Vector3d direction = least_direction(q * q.transpose());
    const Eigen::VectorXd distances = ((inliers.colwise() - mean).transpose() * direction).cwiseAbs();
    if (static_cast<double>((distances.array() < sigmas * fit.sigma).count()) >=
        share * static_cast<double>(inliers.cols()))
      return true;
    std::vector<double> sorted(distances.data(), distances.data() + distances.size());
    const double middle = median(sorted);
    near.resize(3, inliers.cols());
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < inliers.cols(); ++i)
      if (distances[i] <= middle) near.col(kept++) = inliers.col(i);
    near.conservativeResize(3, kept);
  }
  return false;
}

// If a kind is named and half of the points belong to the ground, a nearly plane surface of that kind is
// likelier than the intended one, and its parameters are hardly determined. Then the points of the plane are
// left out: docs/theory/fit.md. \param all the fit of all points
std::optional<PointFit> fit_beside_plane(const PointCloud& points, const NormalisedPoints& normal,
                                         const PointFitOptions& options, const Primitive* only,
                                         const PointFit& all) {
  constexpr double most = 0.6, enough = 0.5, as_noisy = 1.1;
  const Primitive* plane_primitive = primitive_named("plane");
  if (!only || only == plane_primitive || options.guess || (all.usable && !may_be_a_plane(points, all)))
    return std::nullopt;
  PointFitOptions quiet = options;
  quiet.progress = nullptr;
  const PointFit plane = PrimitivesFit(points, normal, quiet, plane_primitive, Effort::full).run();
  if (!plane.usable || (all.usable && plane.sigma > as_noisy * all.sigma)) return std::nullopt;
  std::size_t common = 0;
  for (std::size_t i = 0; i < plane.is_inlier.size(); ++i) common += plane.is_inlier[i] && all.is_inlier[i];
  if (static_cast<double>(common) < most * static_cast<double>(all.inliers)) return std::nullopt;
  auto [beside, scale, are_noise] = fit_of_others(points, plane.is_inlier, quiet, only);
  // A few points off a plane are its outliers.
  constexpr double few = 0.05;
  const auto others = static_cast<double>(normal.finite - plane.inliers);
  if (!beside.usable || others < few * static_cast<double>(normal.finite) ||
      static_cast<double>(beside.inliers) < enough * others)
    return std::nullopt;
  // An object on the ground was measured in the same way. If its noise is larger, it is of another kind.
  constexpr double noisier = 1.5;
  const bool is_exact = plane.sigma <= normal.scale * normal.stored_rounding();
  if (!are_noise || (!is_exact && beside.sigma > noisier * plane.sigma)) return std::nullopt;
  beside.iterations += all.iterations + plane.iterations;
  beside.reason += "; excluded: a plane of " + std::to_string(plane.inliers) + " points";
  return beside;
}

// Whether the plane that was found holds, without noise, one layer of coarsely rounded points, and a quarter
// as many are outliers within two steps of it: these belong to the plane that was measured.
bool is_layer_of_steps(const PointCloud& points, const NormalisedPoints& normal, const PointFit& fit) {
  constexpr double levels = 2, fewest = 0.25;
  if (!(normal.common_step > 0) || normal.half_step > 0 || !fit.usable ||
      !fit.surface->surface.get<Plane<double>>() || fit.sigma > normal.scale * normal.stored_rounding())
    return false;
  const Eigen::Isometry3d to_local = fit.surface->placement.inverse();
  const double within = levels * normal.common_step * normal.scale;
  std::size_t near = 0;
  for (std::size_t i = 0; i < fit.is_inlier.size(); ++i)
    near += !fit.is_inlier[i] && std::fabs((to_local * to_eigen(points.positions[i])).z()) < within;
  return static_cast<double>(near) >= fewest * static_cast<double>(fit.inliers);
}

// The fit of all points, or of those outside a clump that is not on their surface: docs/theory/fit.md.
class ClumpedFit {
 public:
  ClumpedFit(const PointCloud& points, NormalisedPoints normal, std::vector<bool> clump,
             const PointFitOptions& options, const Primitive* only)
      : points_(points),
        options_(options),
        only_(only),
        normal_(std::move(normal)),
        clump_(std::move(clump)) {}

  PointFit run() const {
    std::vector<bool> in_clump(points_.positions.size(), false);
    normal_.spread(clump_, in_clump);
    auto [beside, scale, are_noise] = fit_of_others(points_, in_clump, options_of_half(0), only_);
    const std::string clump =
        "a clump of " + std::to_string(std::count(in_clump.begin(), in_clump.end(), true)) + " points";
    if (beside.usable && is_clutter(beside, scale)) return left_out(std::move(beside), clump);
    PointFit all = PrimitivesFit(points_, normal_, options_of_half(0.5), only_, Effort::full).run();
    const int iterations = beside.iterations + all.iterations;
    PointFit fit = chosen(std::move(beside), std::move(all), scale, clump);
    fit.iterations = iterations;
    return fit;
  }

 private:
  // How likely the other points are under a fit, and which shares of them and of the clump are within its
  // noise.
  struct Told {
    double log_likelihood_ratio = 0, share_of_others = 0, share_of_clump = 0;
  };
  // \param scale the unit of length, about the size of the others
  Told told(const PointFit& fit, double scale) const {
    const Primitive& primitive = *primitive_named(fit.surface->surface.info().name);
    Eigen::Index near_it = 0;
    while (near_it + 1 < normal_.cloud.cols() &&
           !fit.is_inlier[normal_.index[static_cast<std::size_t>(near_it)]])
      ++near_it;
    const LocalModel model =
        primitive.localise(guess_of(*fit.surface, primitive, normal_), normal_.cloud.col(near_it));
    if (!model.origin.allFinite() || !model.rotation.coeffs().allFinite()) return {};
    std::vector<double> distances;
    primitive.distance.rough_distances(normal_.cloud, model, distances);
    const double sigma = std::fmax(fit.sigma / normal_.scale, normal_.stored_rounding());
    double near[2]{}, all[2]{};
    for (std::size_t i = 0; i < distances.size(); ++i) {
      near[clump_[i]] += std::fabs(distances[i]) <= 3 * sigma;
      ++all[clump_[i]];
    }
    return {fit::log_likelihood_ratio(near[0], all[0], sigma * normal_.scale / scale, primitive.unknowns),
            near[0] / all[0], near[1] / all[1]};
  }

  bool enough(const PointFit& beside) const {
    return only_ ||
           static_cast<double>(beside.inliers) >= enough_inliers * static_cast<double>(normal_.finite);
  }

  // Whether the clump is clutter, decided without a fit of all points: nearly all others are near a surface
  // that the clump does not lie on, and it fills a ball far wider than the noise. A small surface would be
  // hollow.
  bool is_clutter(const PointFit& beside, double scale) const {
    constexpr double nearly_all = 0.8, far_wider = 2.5;
    if (options_.guess || !enough(beside)) return false;
    const auto shape = shape_of_clump(normal_.cloud, clump_);
    if (!shape.fills_a_ball || normal_.scale * shape.deviation < far_wider * beside.sigma) return false;
    const Told t = told(beside, scale);
    return t.share_of_clump <= off_it && t.share_of_others >= nearly_all;
  }

  static PointFit left_out(PointFit beside, const std::string& clump) {
    beside.reason += "; excluded: " + clump;
    return beside;
  }

  PointFit chosen(PointFit beside, PointFit all, double scale, const std::string& clump) const {
    constexpr double sharp = 0.25, wider = 1.5, by_chance = 1e-3;
    if (beside.usable && enough(beside)) {
      const Told of_beside = told(beside, scale);
      if (of_beside.share_of_clump > off_it) return all;
      if (all.usable) {
        const Told of_all = told(all, scale);
        const bool is_sharp =
            all.inliers > beside.inliers &&
            all.sigma <= sharp * normal_.scale * shape_of_clump(normal_.cloud, clump_).deviation;
        if (of_all.share_of_clump > off_it &&
            (is_sharp || of_all.log_likelihood_ratio + margin >= of_beside.log_likelihood_ratio))
          return all;
      }
      return left_out(std::move(beside), clump);
    }
    // A surface that includes the clump has more noise than the others alone.
    constexpr std::string_view undetermined = "undetermined: ";
    if (only_ || beside.usable || !all.usable || !enough(beside) || !beside.reason.starts_with(undetermined))
      return all;
    const auto freedom = [&](const PointFit& fit) {
      const int unknowns = primitive_named(all.surface->surface.info().name)->unknowns;
      return std::fmax(1, static_cast<double>(fit.inliers) - unknowns);
    };
    const double ratio = all.sigma * all.sigma / (beside.sigma * beside.sigma);
    if (!(ratio > wider && chance_of_ratio(ratio, freedom(all), freedom(beside)) < by_chance)) return all;
    beside.reason = std::string(undetermined) + "beside " + clump +
                    " that may or may not belong to the surface, " +
                    beside.reason.substr(undetermined.size());
    return beside;
  }

  PointFitOptions options_of_half(double begin) const {
    PointFitOptions options = options_;
    if (options_.progress)
      options.progress = [this, begin](double share) { options_.progress(begin + 0.5 * share); };
    return options;
  }

  // The largest share of a clump within the noise of a surface that it does not lie on.
  static constexpr double off_it = 0.5;

  const PointCloud& points_;
  const PointFitOptions& options_;
  const Primitive* only_;
  NormalisedPoints normal_;
  std::vector<bool> clump_;
};

}  // namespace

PointFit fit_primitives(const PointCloud& points, const PointFitOptions& options, const Primitive* only,
                        Effort effort) {
  check_arguments(points, options);
  const auto started = std::chrono::steady_clock::now();
  NormalisedPoints normal = normalised(points);
  std::vector<bool> clump;
  if (effort == Effort::full && normal.scale > 1e-152 && normal.scale < 1e152)
    clump = dense_clump(normal.cloud);
  PointFit fit = clump.empty() ? PrimitivesFit(points, normal, options, only, effort).run()
                               : ClumpedFit(points, normal, std::move(clump), options, only).run();
  if (clump.empty() && is_layer_of_steps(points, normal, fit)) {
    normal.half_step = 0.5 * normal.common_step;
    normal.rounding = std::fmax(normal.rounding, 0.5 * normal.half_step);
    fit = PrimitivesFit(points, normal, options, only, effort).run();
  }
  if (effort == Effort::full)
    if (auto beside = fit_beside_plane(points, normal, options, only, fit)) fit = *std::move(beside);
  fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  if (options.progress) options.progress(1);
  return fit;
}

}  // namespace fit

const std::vector<std::string_view>& found_kinds() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> list;
    for (const fit::Primitive* primitive : fit::primitives()) list.push_back(primitive->name);
    return list;
  }();
  return names;
}

}  // namespace darboux
