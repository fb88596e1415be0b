// Which uvs the stored tangents follow, where the file leaves it open.
#pragma once

#include <optional>
#include <vector>

#include <darboux/assess.h>

namespace darboux {

struct UvChoice {
  std::vector<Vec2<double>> uvs;
  std::optional<int> set;    // another set than the mesh's
  bool transformed = false;  // the mesh's after KHR_texture_transform
};

// Other uvs than the mesh's own that its tangents follow where they do not follow those: after
// KHR_texture_transform, or of another set where the material names none. Nothing where the mesh's own serve
// as well. Follow means: at 80 % of the corners or more the tangent lies within the cone of its triangles.
std::optional<UvChoice> choose_uvs(const Mesh& mesh, const AssessOptions& options);

}  // namespace darboux
