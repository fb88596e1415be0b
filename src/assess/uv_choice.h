// Which uvs the stored tangents follow, where the file leaves it open.
#pragma once

#include <optional>

#include <darboux/assess.h>

#include "validate/mesh_under_test.h"

namespace darboux {

struct UvChoice {
  Mesh mesh;                 // with these uvs
  std::optional<int> set;    // another set than the mesh's
  bool transformed = false;  // the mesh's after KHR_texture_transform
};

// Uvs other than the mesh's own that its tangents follow: those after KHR_texture_transform or, where the
// material names no set, another set. They are chosen where the tangents do not follow the mesh's own uvs, or
// follow the others more closely by 3 %. To follow means that at 80 % of the corners or more the tangent lies
// within the cone of its triangles; how closely is measured by the mean angle to the dpdu of each corner's
// triangle. A transform that mirrors v leaves t as it is: there the uvs are chosen by which w has glTF's sign
// at most corners. \param own of prepare()
std::optional<UvChoice> choose_uvs(const MeshUnderTest& own, const AssessOptions& options);

}  // namespace darboux
