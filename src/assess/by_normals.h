// Surfaces of revolution from positions and normals together: two rings of a cylinder lie on a sphere too,
// their normals do not.
#pragma once

#include <optional>

#include <darboux/fit_mesh.h>

#include "shape.h"
#include "surface_kind.h"

namespace darboux {

// A cylinder, cone or torus whose normals the stored ones are; the axis comes from the normals, in closed
// form, the rest from the positions. Its chart is unknown. Nothing where the mesh has no normals or they are
// no such surface's.
std::optional<MeshFit> fit_by_normals(const Mesh& mesh, const Shape& shape, SurfaceKind kind);

}  // namespace darboux
