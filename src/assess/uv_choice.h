// Which uvs the stored tangents follow, if the file does not say.
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
// material names no set, another set. They are chosen if the tangents do not follow the mesh's own uvs, or
// follow the others more closely by 3 %. Tangents follow uvs if at 80 % of the corners or more the tangent
// lies within the cone of its triangles; how closely is the mean angle to the dpdu of each corner's triangle.
// A transform that mirrors v does not change t: then the uvs are chosen for which w has glTF's sign at most
// corners. \param own from prepare()
std::optional<UvChoice> choose_uvs(const MeshUnderTest& own, const AssessOptions& options);

}  // namespace darboux
