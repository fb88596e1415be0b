// Quads in meshes that were cut into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <darboux/mesh.h>

namespace darboux {

// The quad a b c d whose halves are two successive triangles: a b c and a c d, or a b d and b c d, as Blender
// and others cut it. Any triangles with such vertex numbers look like a quad.
std::optional<std::array<std::uint32_t, 4>> quad_of(const Triangle& x, const Triangle& y);

}  // namespace darboux
