#include <algorithm>
#include <string>

#include <darboux/fit_points.h>

#include "base/evenly_chosen.h"
#include "base/text.h"
#include "fit/catalogue/fit_catalogue.h"
#include "fit/common/arguments.h"
#include "fit/common/kinds.h"
#include "fit/primitives/fit_primitives.h"
#include "fit/primitives/list.h"
#include "fit/uv/fit_uv.h"

namespace darboux {
namespace {

PointFit fit_positions(const PointCloud& points, const PointFitOptions& options) {
  if (fit::is_automatic(options)) return fit::fit_primitives(points, options, nullptr);
  const fit::Primitive* primitive = fit::primitive_named(options.surface);
  if (!primitive) return fit_catalogue(points, options.surface, options);
  if (!primitive->only_where_lengths_agree) return fit::fit_primitives(points, options, primitive);
  // The catalogue's surface has more lengths. The primitive, for which they are equal, is found reliably and
  // serves as a start.
  PointFitOptions with_guess = options;
  if (!options.guess) {
    PointFitOptions silent = options;
    silent.progress = {};
    with_guess.guess = fit::fit_primitives(points, silent, primitive).surface;
  }
  return fit_catalogue(points, options.surface, with_guess);
}

// At most this many of the points, evenly chosen.
PointCloud some_of(const PointCloud& points, std::size_t most) {
  PointCloud some;
  for (const std::size_t i : evenly_chosen(points.positions.size(), most)) {
    some.positions.push_back(points.positions[i]);
    if (!points.normals.empty()) some.normals.push_back(points.normals[i]);
  }
  return some;
}

double share_of_inliers(const PointFit& fit) {
  return static_cast<double>(fit.inliers) /
         static_cast<double>(std::max<std::size_t>(fit.inliers + fit.outliers, 1));
}

// A remark if the given noise cannot be that of the points, with the noise that they show. If the fit does
// not show it, the noise of some of the points is estimated.
std::string doubt_of_noise(const PointCloud& points, const PointFitOptions& options, const PointFit& fit) {
  constexpr double nearly_all = 0.9, more_noise = 1.5, far_less = 0.25, more_points = 1.1;
  constexpr std::size_t enough = 20, some = 2000;
  if (!options.noise) return {};
  const std::string given = "; the noise of " + rounded(*options.noise, 3) + " may be too ";
  if (fit.usable && fit.inliers >= enough && fit.rms < far_less * *options.noise)
    return given + "large: the distances are " + rounded(fit.rms, 3) + " rms";
  if (fit.usable && share_of_inliers(fit) >= nearly_all) return {};
  PointFitOptions estimating = options;
  estimating.noise.reset();
  estimating.progress = nullptr;
  const PointFit other = fit_positions(some_of(points, some), estimating);
  if (!other.usable) return {};
  const bool too_small = other.sigma > more_noise * *options.noise &&
                         (!fit.usable || share_of_inliers(other) > more_points * share_of_inliers(fit)),
             too_large = !fit.usable && other.sigma < far_less * *options.noise;
  if (!too_small && !too_large) return {};
  return given + (too_small ? "small" : "large") + ": if it is estimated, " +
         fit::with_article(other.surface->surface.info().name) + " with noise " + rounded(other.sigma, 3) +
         " is found";
}

}  // namespace

PointFit fit_points(const PointCloud& points, const PointFitOptions& options) {
  if (options.with_uv) return fit_points_with_uv(points, options);
  PointFit fit = fit_positions(points, options);
  fit.reason += doubt_of_noise(points, options, fit);
  return fit;
}

}  // namespace darboux
