#include "select.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "base/text.h"
#include "fit/common/kinds.h"

namespace darboux::fit {
namespace {

// Bayesian information criterion of every candidate, smaller is better [Schwarz1978]. On one footing: the
// noise, the outliers' density and the support are those of candidate `reference`, so that only the distances
// differ.
std::vector<double> criteria(const std::vector<PrimitiveFit>& candidates, std::size_t reference) {
  const PrimitiveFit& common = candidates[reference];
  const double sigma = std::max(common.sigma, exact),
               kept = static_cast<double>(std::count(common.in_support.begin(), common.in_support.end(), 1));
  std::vector<double> result;
  for (const PrimitiveFit& f : candidates) {
    double likelihood = 0;
    for (std::size_t i = 0; i < f.error.size(); ++i) {
      if (!common.in_support[i]) continue;
      const double r = f.error[i] / sigma;
      likelihood += Mixture{sigma, common.outliers}.log_likelihood_ratio(0.5 * r * r);
    }
    result.push_back(-2 * likelihood + f.primitive->unknowns * std::log(std::max(kept, 1.0)));
  }
  return result;
}

bool is_plane(const PrimitiveFit& fit) {
  return fit.primitive->flat_limit == FlatLimit::is_plane;
}

struct Choice {
  std::size_t index = 0;
  bool usable = false;
  std::string reason{};
};

// "plane or cylinder of radius > 3"
std::string either(const PrimitiveFit& a, const PrimitiveFit& b, double scale) {
  std::string text = std::string(a.primitive->name) + " or " + std::string(b.primitive->name);
  if (is_plane(a) && (b.primitive->flat_limit == FlatLimit::first_length ||
                      b.primitive->flat_limit == FlatLimit::first_length_remarked))
    text +=
        " of " + std::string(b.primitive->length_names[0]) + " > " + rounded(scale * least_length(b, 0), 3);
  return text;
}

// The kind with the smallest criterion, where nothing speaks for another.
Choice choose(const std::vector<PrimitiveFit>& tried, const std::vector<Determinacy>& determinacies,
              const std::vector<double>& bic, const std::vector<std::size_t>& best_first, double scale) {
  const auto is = [&](Determinacy::Kind kind) {
    return [&determinacies, kind](std::size_t i) { return determinacies[i].kind == kind; };
  };
  const auto found = std::find_if(best_first.begin(), best_first.end(), is(Determinacy::Kind::good));
  if (found == best_first.end()) {
    const auto possible = std::find_if(best_first.begin(), best_first.end(), is(Determinacy::Kind::unsure));
    const std::size_t i = possible != best_first.end() ? *possible : best_first.front();
    return {i, false, with_article(tried[i].primitive->name) + " " + determinacies[i].why};
  }
  const std::size_t best = *found;
  std::string remark;
  for (const std::size_t i : best_first) {
    if (i == best || determinacies[i].kind == Determinacy::Kind::none) continue;
    const auto undetermined = [&](const std::string& why) {
      const bool simpler = tried[best].primitive->unknowns < tried[i].primitive->unknowns;
      const PrimitiveFit &a = tried[simpler ? best : i], &b = tried[simpler ? i : best];
      return Choice{best, false, "undetermined: " + either(a, b, scale) + why};
    };
    // Better, but it is no surface that could be given.
    if (bic[i] < bic[best] - margin)
      return undetermined(": the points speak for " + with_article(tried[i].primitive->name) + ", which " +
                          determinacies[i].why);
    // As many unknowns are no simpler, and no less likely beforehand.
    if (tried[i].primitive->unknowns <= tried[best].primitive->unknowns && bic[i] < bic[best] + margin)
      return undetermined("; points over a larger part of it or less noise help");
    if (is_plane(tried[best]) && tried[i].primitive->flat_limit == FlatLimit::first_length_remarked &&
        tried[i].converged && bic[i] < bic[best] + 4 * margin)
      remark = "; " + with_article(tried[i].primitive->name) +
               " fits as well: " + either(tried[best], tried[i], scale);
  }
  return {best, true, "converged" + remark};
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
  result.bic = criteria(tried, reference);
  result.order.resize(tried.size());
  std::iota(result.order.begin(), result.order.end(), 0);
  std::stable_sort(result.order.begin(), result.order.end(),
                   [&](std::size_t a, std::size_t b) { return result.bic[a] < result.bic[b]; });
  Choice choice = choose(tried, determinacies, result.bic, result.order, scale);
  const auto place = std::find(result.order.begin(), result.order.end(), choice.index);
  std::rotate(result.order.begin(), place, place + 1);
  result.usable = choice.usable;
  result.reason = std::move(choice.reason);
  return result;
}

double von_neumann_ratio(const Eigen::Matrix3Xd& cloud, const PrimitiveFit& f,
                         const std::vector<bool>& is_inlier) {
  std::vector<std::size_t> order;
  double mean = 0;
  for (std::size_t i = 0; i < is_inlier.size(); ++i)
    if (is_inlier[i]) order.push_back(i), mean += f.error[i];
  mean /= static_cast<double>(order.size());
  double differences = 0, variances = 0;
  const auto at = [&](std::size_t i) { return cloud.col(static_cast<Eigen::Index>(i)); };
  // Halves across the longest side, down to pairs; not where the noise is what parts the points, or it would
  // choose who is alike.
  const auto halve = [&](const auto& self, auto begin, auto end) -> void {
    Eigen::AlignedBox3d box;
    for (auto i = begin; i != end; ++i) box.extend(at(*i));
    Eigen::Index axis = 0;
    if (end - begin < 4 || box.sizes().maxCoeff(&axis) < 30 * f.sigma) {
      for (; end - begin > 1; begin += 2) {
        const double a = f.error[begin[0]] - mean, b = f.error[begin[1]] - mean;
        differences += (a - b) * (a - b);
        variances += a * a + b * b;
      }
      return;
    }
    const auto middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end,
                     [&](std::size_t a, std::size_t b) { return at(a)[axis] < at(b)[axis]; });
    self(self, begin, middle);
    self(self, middle, end);
  };
  halve(halve, order.begin(), order.end());
  return variances > 0 ? differences / variances : 1;
}

}  // namespace darboux::fit
