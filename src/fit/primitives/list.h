// The primitives.
#pragma once

#include <span>

#include "primitive.h"

namespace darboux::fit {

// In order of preference. Each is defined in the file of its name.
// clang-format off
#define DARBOUX_PRIMITIVES(each) \
  each(plane) \
  each(sphere) \
  each(cylinder) \
  each(cone) \
  each(paraboloid) \
  each(torus) \
  each(ellipsoid)
// clang-format on

#define DARBOUX_DECLARE_PRIMITIVE(name) extern const Primitive name##_primitive;
DARBOUX_PRIMITIVES(DARBOUX_DECLARE_PRIMITIVE)
#undef DARBOUX_DECLARE_PRIMITIVE

std::span<const Primitive* const> primitives();

// The primitive with that name in the catalogue; null if there is none.
const Primitive* primitive_named(std::string_view name);

// The (u, v) of the point nearest to p on a primitive; none for other surfaces. Primitives are unbounded,
// except a cone at its apex.
std::optional<Vec2<double>> closed_form_foot(const AnySurface& surface, const Vec3<double>& p);

}  // namespace darboux::fit
