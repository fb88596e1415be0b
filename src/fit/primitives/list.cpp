#include "list.h"

#include <algorithm>

namespace darboux::fit {

std::span<const Primitive* const> primitives() {
#define DARBOUX_ADDRESS(name) &name##_primitive,
  static constexpr std::array list{DARBOUX_PRIMITIVES(DARBOUX_ADDRESS)};
#undef DARBOUX_ADDRESS
  return list;
}

const Primitive* primitive_named(std::string_view name) {
  const auto list = primitives();
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Primitive* p) { return p->name == name; });
  return found == list.end() ? nullptr : *found;
}

std::optional<Vec2<double>> closed_form_foot(const AnySurface& surface, const Vec3<double>& p) {
  for (const Primitive* primitive : primitives())
    if (const auto uv = primitive->foot(surface, p)) return uv;
  return std::nullopt;
}

}  // namespace darboux::fit
