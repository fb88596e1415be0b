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
  if (const fit::Primitive* primitive = fit::primitive_named(options.surface);
      primitive && !primitive->only_where_lengths_agree)
    return fit::fit_primitives(points, options, primitive);
  return fit_catalogue(points, options.surface, options);
}

}  // namespace darboux
