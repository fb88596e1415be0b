#include <algorithm>
#include <cmath>

#include <darboux/error.h>
#include <darboux/fit_points.h>

#include "fit/catalogue/fit_catalogue.h"
#include "fit/primitives/fit_primitives.h"
#include "fit/uv/fit_uv.h"

namespace darboux {
namespace {

void check(const PointCloud& points, const PointFitOptions& options) {
  const auto same = [&](std::size_t count, const char* what) {
    if (count != 0 && count != points.positions.size())
      throw MeshError("points", std::to_string(count) + " " + what + " for " +
                                    std::to_string(points.positions.size()) +
                                    " positions, permitted are as many or none");
  };
  same(points.normals.size(), "normals");
  same(points.uvs.size(), "uvs");
  if (options.noise && !(*options.noise > 0 && std::isfinite(*options.noise)))
    throw ParameterError("noise", "must be a positive length, permitted is noise > 0");
  if (options.guess && options.guess->surface.info().name != options.surface)
    throw ParameterError("guess", "is a " + std::string(options.guess->surface.info().name) +
                                      ", permitted is a surface of the kind to be found, " + options.surface);
  if (options.guess && !options.guess->placement.matrix().allFinite())
    throw ParameterError("guess", "its placement is not finite, permitted is a rigid placement");
}

}  // namespace

PointFit fit_points(const PointCloud& points, const PointFitOptions& options) {
  check(points, options);
  if (options.with_uv) return fit_points_with_uv(points, options);
  const auto& kinds = found_kinds();
  if (options.surface == "auto" || std::find(kinds.begin(), kinds.end(), options.surface) != kinds.end())
    return fit_by_kind(points, options);
  return fit_any_kind(points, options.surface, options);
}

}  // namespace darboux
