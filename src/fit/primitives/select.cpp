#include "select.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string_view>
#include <utility>

#include "base/degrees.h"
#include "base/text.h"
#include "fit/common/kinds.h"

namespace darboux::fit {
namespace {

// Twice the negative log likelihood of one candidate with the noise, outliers' density and support of another
// (the footing), so that only the distances differ.
double deviance(const PrimitiveFit& f, const PrimitiveFit& footing) {
  const double sigma = std::max(noise_and_rounding(footing), exact);
  // The outliers' density over that of the inliers at their middle.
  const double outliers = footing.outliers * sigma / std::max(footing.sigma, exact);
  double likelihood = 0;
  for (std::size_t i = 0; i < f.error.size(); ++i) {
    if (!footing.in_support[i]) continue;
    const double r = f.error[i] / sigma;
    likelihood += Mixture{sigma, outliers}.log_likelihood_ratio(0.5 * r * r);
  }
  return -2 * likelihood;
}

// The penalty per unknown in the Bayesian information criterion [Schwarz1978].
double price(const PrimitiveFit& footing) {
  return std::log(std::max(
      1.0, static_cast<double>(std::count(footing.in_support.begin(), footing.in_support.end(), 1))));
}

// By how much `a` is better than `b`, at least and at most: with the footing of either. Each chose its own
// support, and fits the outliers in it.
std::pair<double, double> advantage(const PrimitiveFit& a, const PrimitiveFit& b) {
  return std::minmax(deviance(b, a) - deviance(a, a), deviance(b, b) - deviance(a, b));
}

// Whether the points that both take for inliers support `a`, or it has a tenth more inliers. A surface that
// bends towards outliers next to a strip of points gains a few of them as inliers. That makes it likelier,
// but not nearer to the other points.
bool is_told_by_inliers(const PrimitiveFit& a, const PrimitiveFit& b) {
  constexpr double many_more = 0.1;
  const std::vector<bool> in_a = inliers_of(a), in_b = inliers_of(b);
  const double sigma = std::max(noise_and_rounding(a), exact);
  double nearer = 0;
  std::ptrdiff_t more = 0, of_b = 0;
  for (std::size_t i = 0; i < in_a.size(); ++i) {
    if (in_a[i] && in_b[i]) nearer += (b.error[i] - a.error[i]) * (b.error[i] + a.error[i]) / (sigma * sigma);
    more += in_a[i] - in_b[i];
    of_b += in_b[i];
  }
  return nearer > std::max(margin, price(a) * (a.primitive->unknowns - b.primitive->unknowns)) ||
         static_cast<double>(more) > many_more * static_cast<double>(of_b);
}

// The evidence of a fit with its own noise and outliers. Points count whole: the small outlier probabilities
// of a thousand almost certain inliers would add up to outliers.
double evidence(const PrimitiveFit& f) {
  return log_likelihood_ratio(static_cast<double>(count_inliers(f)), static_cast<double>(f.error.size()),
                              f.sigma, f.primitive->unknowns);
}

// A kind that is the limit of another (the outer kind). The outer kind always fits at least as well; what
// decides is how far from the limit it may be.
struct Nesting {
  std::string_view inner, outer;
  double most;  // beyond, the outer kind is clearly different
  // How far from the limit the outer kind may be, according to the points.
  double (*departure)(const PrimitiveFit& outer);
};

double upper(const PrimitiveFit& f, std::size_t k) {
  return f.surface.lengths[k] + most_deviations(f) * deviation(f, k);
}

// The least semi-axis over the greatest.
double flattening(const PrimitiveFit& f) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return f.surface.lengths[a] < f.surface.lengths[b]; });
  return upper(f, order[2]) / least_length(f, order[0]) - 1;
}

// The curvature of the long axis's ends along it over that across, (b / c)^2: normal in its errors near zero.
double curvature_along(const PrimitiveFit& f) {
  std::array<double, 3> sorted = f.surface.lengths;
  std::sort(sorted.begin(), sorted.end());
  const auto longest = static_cast<std::size_t>(
      std::max_element(f.surface.lengths.begin(), f.surface.lengths.end()) - f.surface.lengths.begin());
  const double ratio = sorted[1] / sorted[2];
  return ratio * ratio * (1 + 2 * most_deviations(f) * deviation(f, longest) / sorted[2]);
}

// How fast an ellipsoid closes: 1 over the longest semi-axis, whose ends look like paraboloids.
double closing(const PrimitiveFit& f) {
  const auto longest = static_cast<std::size_t>(
      std::max_element(f.surface.lengths.begin(), f.surface.lengths.end()) - f.surface.lengths.begin());
  return 1 / least_length(f, longest);
}

// The smaller of its curvatures over the greater, on the side where the points may be: the tube's outside,
// elongated about the ring, or the inside of the hole, elongated about the tube.
double curvature_across(const PrimitiveFit& f) {
  const double ring = f.surface.lengths[0], tube = f.surface.lengths[1];
  const auto& c = f.covariance;
  const double spread = std::sqrt(std::fmax(c(6, 6) + c(7, 7) - 2 * c(6, 7), 0));
  return std::min(upper(f, 1) / least_length(f, 0),
                  (std::fabs(ring - tube) + most_deviations(f) * spread) / least_length(f, 1));
}

// The angle of the meridian with the axis in the middle of the points, the origin: the radius of curvature at
// the vertex over the distance from the axis, which is known far better.
double opening(const PrimitiveFit& f) {
  const double height = -f.surface.axes.col(2).dot(f.surface.centre);
  return height > 0 ? std::atan(upper(f, 0) / std::sqrt(2 * f.surface.lengths[0] * height))
                    : std::numbers::pi / 2;
}

constexpr std::array<Nesting, 8> nestings{{
    {"plane", "sphere", 0.2, [](const PrimitiveFit& f) { return 1 / least_length(f, 0); }},
    {"plane", "cylinder", 0.2, [](const PrimitiveFit& f) { return 1 / least_length(f, 0); }},
    {"sphere", "ellipsoid", 0.3, flattening},
    {"cylinder", "cone", 8 / degrees_per_radian, [](const PrimitiveFit& f) { return upper(f, 0); }},
    {"cylinder", "elliptic-paraboloid", 8 / degrees_per_radian, opening},
    {"cylinder", "torus", 0.1, curvature_across},
    {"cylinder", "ellipsoid", 0.15, curvature_along},
    {"elliptic-paraboloid", "ellipsoid", 0.2, closing},
}};

const Nesting* nesting(const PrimitiveFit& inner, const PrimitiveFit& outer) {
  for (const Nesting& n : nestings)
    if (n.inner == inner.primitive->name && n.outer == outer.primitive->name) return &n;
  return nullptr;
}

// By how much a kind must be better than its limit. Outliers may lie on a surface that joins smoothly, such
// as the ends of a capsule: those nearest to the edge bend the fitted surface towards them.
double clear_of_limit(const PrimitiveFit& f) {
  constexpr double part = 0.1;  // of the squared noise, per outlier: five times what capsules showed
  return std::max(margin,
                  part * (static_cast<double>(f.error.size()) - static_cast<double>(count_inliers(f))));
}

// Whether the other explains nearly all points to a hundredth of their size, and this one far fewer: then
// this one's outliers lie on the other. For example, one of two circles lies on a plane.
bool holds_the_outliers(const PrimitiveFit& other, const PrimitiveFit& f) {
  constexpr double few = 0.7, nearly_all = 0.95, small = 0.01;
  const auto all = static_cast<double>(f.error.size());
  return static_cast<double>(count_inliers(f)) < few * all && other.sigma < small &&
         static_cast<double>(count_inliers(other)) >= nearly_all * all;
}

struct Choice {
  std::size_t index = 0;
  bool usable = false, has_rival = false;
  std::string reason{};
};

// "radius 2", "half-angle 30 degrees", in the points' units.
std::string numbers_text(const PrimitiveFit& f, double scale) {
  std::string text;
  for (std::size_t k = 0; k < 3 && !f.primitive->length_names[k].empty(); ++k) {
    const bool is_length = k < static_cast<std::size_t>(f.primitive->lengths);
    text += (k == 0 ? "" : ", ") + std::string(f.primitive->length_names[k]) + " " +
            rounded((is_length ? scale : degrees_per_radian) * f.surface.lengths[k], 3) +
            (is_length ? "" : " degrees");
  }
  return text;
}

// "torus of major radius 2, minor radius 1 or of ..."; the axes where these numbers are alike.
std::string either_of_a_kind(const PrimitiveFit& a, const PrimitiveFit& b, double scale) {
  const std::string name(a.primitive->name);
  const std::string of_a = numbers_text(a, scale), of_b = numbers_text(b, scale);
  if (of_a != of_b) return name + " of " + of_a + " or of " + of_b;
  const std::string along_a = direction_text(a.surface.axes.col(2)),
                    along_b = direction_text(b.surface.axes.col(2));
  if (a.primitive->orientation != Orientation::axis || along_a == along_b)
    return name + " or another " + name;
  return name + (of_a.empty() ? "" : " of " + of_a) + (a.primitive->is_plane ? " across " : " about ") +
         along_a + " or " + along_b;
}

// "plane or cylinder of radius > 3"
std::string either(const PrimitiveFit& a, const PrimitiveFit& b, double scale) {
  if (a.primitive == b.primitive) return either_of_a_kind(a, b, scale);
  std::string text = std::string(a.primitive->name) + " or " + std::string(b.primitive->name);
  if (a.primitive->is_plane && nesting(a, b))
    text +=
        " of " + std::string(b.primitive->length_names[0]) + " > " + rounded(scale * least_length(b, 0), 3);
  return text;
}

// The kind with the smallest criterion, unless something supports another.
Choice choose(const std::vector<PrimitiveFit>& tried, const std::vector<Determinacy>& determinacies,
              const std::vector<std::size_t>& best_first, double scale) {
  const auto is = [&](Determinacy::Kind kind) {
    return [&determinacies, kind](std::size_t i) { return determinacies[i].kind == kind; };
  };
  const auto found = std::find_if(best_first.begin(), best_first.end(), is(Determinacy::Kind::good));
  if (found == best_first.end()) {
    const auto possible = std::find_if(best_first.begin(), best_first.end(), is(Determinacy::Kind::unsure));
    const std::size_t i = possible != best_first.end() ? *possible : best_first.front();
    return {i, false, false, with_article(tried[i].primitive->name) + " " + determinacies[i].why};
  }
  const std::size_t best = *found;
  std::string remark;
  for (const std::size_t i : best_first) {
    if (i == best) continue;
    const bool holds_outliers = holds_the_outliers(tried[i], tried[best]);
    if (determinacies[i].kind == Determinacy::Kind::none && !holds_outliers) continue;
    const auto undetermined = [&](bool has_rival, const std::string& why) {
      const bool first = tried[best].primitive->unknowns <= tried[i].primitive->unknowns;
      const PrimitiveFit &a = tried[first ? best : i], &b = tried[first ? i : best];
      return Choice{best, false, has_rival, "undetermined: " + either(a, b, scale) + why};
    };
    const PrimitiveFit &chosen = tried[best], &other = tried[i];
    const std::string help = std::string("; points over a larger part of it or less noise help") +
                             (chosen.primitive == other.primitive ? "" : ", or naming the kind");
    if (holds_outliers) return undetermined(true, help);
    const Nesting* nested = nesting(chosen, other);
    const bool is_unproven = determinacies[i].kind == Determinacy::Kind::unproven;
    // A surface that explains few of the points is no rival, nor is one with so many unknowns that it fits
    // any points: more than half of the chosen one's points plus one. The noise of others is unproven too, so
    // the chosen one's is used.
    if (is_unproven && (!explains_enough(other) || count_inliers(chosen) + 2 < 2 * other.primitive->unknowns))
      continue;
    auto [least, most] = advantage(chosen, other);
    if (is_unproven) least = deviance(other, chosen) - deviance(chosen, chosen);
    // It is better, but is not a surface that could be returned.
    if (!is_unproven &&
        most + price(chosen) * (other.primitive->unknowns - chosen.primitive->unknowns) < -margin)
      return undetermined(false, ": the points speak for " + with_article(tried[i].primitive->name) +
                                     ", which " + determinacies[i].why);
    const double departure = nested ? nested->departure(other) : 0;
    if (nested && departure < nested->most) {
      if (remark.empty() && departure > 0.05 * nested->most)
        remark = "; " + with_article(other.primitive->name) + " cannot be excluded";
      continue;
    }
    if (chosen.primitive->is_plane) {
      if (nested) return undetermined(true, help);
      continue;
    }
    // Every kind has the plane as a limit; sphere and cylinder show how far from it the points allow them to
    // be. A kind is no rival if it explains too few of the points to be the answer, or if it has far more
    // noise and is still far less likely: on its footing the chosen one's lead hardly counts.
    constexpr double far_less_likely = 100;
    const bool is_none = other.primitive != chosen.primitive &&
                         (!explains_enough(other) || (other.sigma > 10 * chosen.sigma &&
                                                      evidence(other) < evidence(chosen) - far_less_likely));
    const double clear = nesting(other, chosen) ? clear_of_limit(chosen) : margin;
    if (!is_none && (least < clear || !is_told_by_inliers(chosen, other))) return undetermined(true, help);
  }
  return {best, true, false, "converged" + remark};
}

}  // namespace

Selection select(const std::vector<PrimitiveFit>& tried, double scale) {
  std::vector<Determinacy> determinacies;
  std::size_t reference = 0;
  std::pair<bool, double> most{false, -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < tried.size(); ++i) {
    determinacies.push_back(determinacy(tried[i]));
    const std::pair likely(determinacies[i].kind == Determinacy::Kind::good, log_likelihood_ratio(tried[i]));
    if (likely > most) most = likely, reference = i;
  }
  Selection result;
  for (const PrimitiveFit& f : tried)
    result.bic.push_back(deviance(f, tried[reference]) + f.primitive->unknowns * price(tried[reference]));
  result.order.resize(tried.size());
  std::iota(result.order.begin(), result.order.end(), 0);
  std::stable_sort(result.order.begin(), result.order.end(),
                   [&](std::size_t a, std::size_t b) { return result.bic[a] < result.bic[b]; });
  Choice choice = choose(tried, determinacies, result.order, scale);
  const auto place = std::find(result.order.begin(), result.order.end(), choice.index);
  std::rotate(result.order.begin(), place, place + 1);
  result.usable = choice.usable;
  result.has_rival = choice.has_rival;
  result.reason = std::move(choice.reason);
  return result;
}

}  // namespace darboux::fit
