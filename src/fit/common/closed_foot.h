// The foot of a point in closed form.
#pragma once

#include <optional>

#include <darboux/any_surface.h>

namespace darboux {

// The (u, v) of the point nearest to p on a sphere, cylinder, cone, torus, plane or ellipsoid; nothing for
// other kinds. Cylinder, cone and plane do not end, but for the cone at its apex.
std::optional<Vec2<double>> closed_foot(const AnySurface& surface, const Vec3<double>& p);

}  // namespace darboux
