// Surfaces of revolution from positions and normals together: two rings of a cylinder also lie on a sphere,
// but with other normals.
#pragma once

#include <optional>

#include <darboux/fit_mesh.h>

#include "shape.h"
#include "surface_kind.h"

namespace darboux {

// A cylinder, cone or torus that has the stored normals. The axis comes from the normals, in closed form, the
// rest from the positions. The chart is unknown. Nothing is returned if the mesh has no normals, or if they
// are not those of such a surface.
std::optional<MeshFit> fit_by_normals(const Mesh& mesh, const Shape& shape, SurfaceKind kind);

}  // namespace darboux
