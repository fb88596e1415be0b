#include "arguments.h"

#include <cmath>

#include <darboux/error.h>

#include "base/linear_algebra.h"
#include "base/text.h"
#include "kinds.h"

namespace darboux::fit {

void check_placement(const std::optional<Eigen::Isometry3d>& placement) {
  if (placement && !is_rigid(*placement))
    throw ParameterError("placement", "expected a rotation and a translation, got another matrix");
}

void check_arguments(const PointCloud& points, const PointFitOptions& options) {
  const std::size_t positions = points.positions.size();
  const auto one_each = [&](std::size_t count, const std::string& what, bool needed) {
    if (count == positions || (count == 0 && !needed)) return;
    throw MeshError("points", "expected " + std::to_string(positions) + " " + what + ", one per position" +
                                  (needed ? "" : ", or none") + ", got " + std::to_string(count));
  };
  one_each(points.normals.size(), "normals", false);
  one_each(points.uvs.size(), "uvs", options.with_uv);
  if (options.noise && !(*options.noise > 0 && std::isfinite(*options.noise)))
    throw ParameterError("noise", "expected a positive, finite length, got " + shortest(*options.noise));
  if (!options.guess) return;
  const std::string_view kind = options.guess->surface.info().name;
  if (kind != options.surface && !(options.with_uv && is_automatic(options)))
    throw ParameterError("guess", "expected a surface of the kind to be found, " + options.surface +
                                      ", got " + with_article(kind));
  if (!options.guess->placement.matrix().allFinite())
    throw ParameterError("guess", "expected a finite placement, got one that is not");
}

}  // namespace darboux::fit
