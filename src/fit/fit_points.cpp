#include <darboux/fit_points.h>

#include "fit/catalogue/fit_catalogue.h"
#include "fit/common/arguments.h"
#include "fit/primitives/fit_primitives.h"
#include "fit/primitives/list.h"
#include "fit/uv/fit_uv.h"

namespace darboux {

PointFit fit_points(const PointCloud& points, const PointFitOptions& options) {
  if (options.with_uv) return fit_points_with_uv(points, options);
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

}  // namespace darboux
