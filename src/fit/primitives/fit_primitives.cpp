#include "fit_primitives.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "clump.h"
#include "correlation.h"
#include "determinacy.h"
#include "fit/common/arguments.h"
#include "fit/common/intervals.h"
#include "fit/common/kinds.h"
#include "fit/common/normalised_points.h"
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

// In log likelihood, over part of the points: a kind so far behind is not refined, odds of exp(300), and far
// more when all are counted; a surface with so much more than none is one; a kind so far behind that is not
// looked for again.
constexpr double far_likelier = 300, evident = 300, hopeless = 100;
// Of a kind with so many unknowns the best start is not found at once, but in so many rounds.
constexpr int hard_to_find = 7, enough_rounds = 4;

// One fit of some primitives.
class PrimitivesFit {
 public:
  PrimitivesFit(const PointCloud& cloud, const PointFitOptions& options, const Primitive* only, Effort effort)
      : options_(options), only_(only), effort_(effort), points_(normalised(cloud)) {
    if (only)
      list_ = std::span(&only_, 1);
    else
      list_ = primitives();
    fit_.ignored = cloud.positions.size() - points_.finite;
    fit_.outliers = points_.finite;
    fit_.is_inlier.assign(cloud.positions.size(), false);
  }

  PointFit run() && {
    fit_.reason = reason();
    fit_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
    if (options_.progress) options_.progress(1);
    return std::move(fit_);
  }

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

  // A torus that crosses itself is found only where it is asked for.
  bool is_wanted(const Primitive& primitive, const GeometricParameters& surface) const {
    return !automatic() || !primitive.crosses_itself || !primitive.crosses_itself(surface);
  }

  // On a small patch or a thin strip searches that know surfaces which are like others look for those like
  // their own best one, and like the best of all.
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
    // A tenth of the work for the first rounds, two for the others.
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
    // No more rounds where a likely surface of another kind is found: far likelier, or simpler and as likely.
    // One with more unknowns may be likelier only because this one is not found yet, if it is a torus or has
    // as many unknowns: others are found at once.
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

  // Adds a fit; where hypotheses of one kind led to the same surface, the likelier of them stays.
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
    SearchProblem problem{points_.cloud, oriented, std::nullopt, std::nullopt,    options_.seed,
                          effort_,       {},       !automatic(), points_.rounding};
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
      // Part of the points is enough to see that a kind is none.
      PrimitiveFit found =
          refine(problem, hypothesis, hypothesis.log_likelihood_ratio < furthest - far_likelier);
      fit_.iterations += found.iterations;
      if (is_wanted(*found.primitive, found.surface)) keep(std::move(found), tried);
      share += span;
    }
    return tried;
  }

  std::string report(const std::vector<PrimitiveFit>& tried) {
    Selection selection = select(tried, points_.scale);
    const PrimitiveFit& best = tried[selection.order.front()];
    for (const std::size_t i : selection.order) {
      // Of another kind than the first the best one.
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
    // Where two surfaces are as likely, but neither is the points', that they are not comes first.
    const bool are_alike = (selection.usable || selection.has_rival) &&
                           best.sigma > points_.stored_rounding() &&
                           neighbours_are_alike(points_.cloud, best, is_inlier);
    if (!selection.usable && !(are_alike && automatic())) return selection.reason;
    const std::string name = with_article(best.primitive->name);
    if (automatic() && !explains_enough(best))
      return "undetermined: the nearest is " + name + ", with only " + std::to_string(fit_.inliers) + " of " +
             std::to_string(points_.finite) + " points; fewer outliers help, or naming the kind";
    if (are_alike) {
      const std::string alike = "distances of neighbouring points are alike, not noise";
      if (automatic())
        return "undetermined: the nearest is " + name + ", but " + alike +
               "; the surface is of another kind, or that was not found: naming it or a guess help";
      selection.reason += "; " + alike + ": the surface is not quite " + name;
    }
    report_surface(best, points_, noise, fit_);
    fit_.usable = true;
    return selection.reason;
  }

  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  const PointFitOptions& options_;
  const Primitive* only_;
  Effort effort_;
  std::span<const Primitive* const> list_;
  NormalisedPoints points_;
  PointFit fit_;
};

}  // namespace

namespace {

// The fit of all points, or of those beside a clump, where there is one that they tell not to be of the
// surface.
class ClumpedFit {
 public:
  ClumpedFit(const PointCloud& points, const PointFitOptions& options, const Primitive* only)
      : points_(points), options_(options), only_(only), normal_(normalised(points)) {
    if (normal_.scale > 0) clump_ = dense_clump(normal_.cloud);
  }

  PointFit run() {
    if (clump_.empty()) return PrimitivesFit(points_, options_, only_, Effort::full).run();
    const auto started = std::chrono::steady_clock::now();
    PointFit fit = chosen();
    fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    if (options_.progress) options_.progress(1);
    return fit;
  }

 private:
  // How likely the others are beside a fit, and what shares of them and of the clump are within its noise.
  struct Told {
    double log_likelihood_ratio, share_of_others, share_of_clump;
  };
  Told told(const PointFit& fit) const {
    const Primitive& primitive = *primitive_named(fit.surface->surface.info().name);
    const GeometricParameters surface = guess_of(*fit.surface, primitive, normal_);
    std::vector<double> distances;
    primitive.distance.rough_distances(normal_.cloud, primitive.localise(surface, normal_.cloud.col(0)),
                                       distances);
    const double sigma = std::fmax(fit.sigma / normal_.scale, normal_.stored_rounding());
    double near[2]{}, all[2]{};
    for (std::size_t i = 0; i < distances.size(); ++i) {
      near[clump_[i]] += std::fabs(distances[i]) <= 3 * sigma;
      ++all[clump_[i]];
    }
    return {fit::log_likelihood_ratio(near[0], all[0], sigma, primitive.unknowns), near[0] / all[0],
            near[1] / all[1]};
  }

  PointFit of(const PointCloud& cloud, double begin) const {
    PointFitOptions options = options_;
    if (options_.progress)
      options.progress = [this, begin](double share) { options_.progress(begin + 0.5 * share); };
    return PrimitivesFit(cloud, options, only_, Effort::full).run();
  }

  PointFit chosen() const {
    constexpr double nearly_all = 0.8, few = 0.5, wider = 1.5, by_chance = 1e-3;
    std::vector<bool> in_clump(points_.positions.size(), false);
    normal_.spread(clump_, in_clump);
    PointCloud others;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < in_clump.size(); ++i) {
      if (in_clump[i]) continue;
      index.push_back(i);
      others.positions.push_back(points_.positions[i]);
      if (!points_.normals.empty()) others.normals.push_back(points_.normals[i]);
    }
    PointFit beside = of(others, 0);
    std::vector<bool> is_inlier(points_.positions.size(), false);
    for (std::size_t k = 0; k < index.size(); ++k) is_inlier[index[k]] = beside.is_inlier[k];
    beside.is_inlier = std::move(is_inlier);
    beside.ignored = points_.positions.size() - normal_.finite;
    beside.outliers = normal_.finite - beside.inliers;
    const std::string size =
        "a clump of " + std::to_string(std::count(in_clump.begin(), in_clump.end(), true)) + " points";
    const bool enough =
        static_cast<double>(beside.inliers) >= enough_inliers * static_cast<double>(normal_.finite);
    if (beside.usable && (only_ || enough)) {
      const Told told_beside = told(beside);
      if (told_beside.share_of_clump <= few) {
        beside.reason += "; " + size + " beside it is left out";
        if (told_beside.share_of_others >= nearly_all) return beside;
        PointFit all = of(points_, 0.5);
        return all.usable && told(all).log_likelihood_ratio + margin >= told_beside.log_likelihood_ratio
                   ? all
                   : beside;
      }
    }
    PointFit all = of(points_, 0.5);
    // A surface that takes the clump for its own has more noise than the others alone.
    const double ratio = all.sigma * all.sigma / (beside.sigma * beside.sigma);
    if (!beside.usable && all.usable && enough && ratio > wider &&
        chance_of_ratio(ratio, static_cast<double>(all.inliers), static_cast<double>(beside.inliers)) <
            by_chance) {
      beside.reason =
          "undetermined: " + size + " may be of the surface or not, and without it " + beside.reason;
      return beside;
    }
    return all;
  }

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
  return effort == Effort::full ? ClumpedFit(points, options, only).run()
                                : PrimitivesFit(points, options, only, effort).run();
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
