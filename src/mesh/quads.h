// Quads, of meshes that were cut into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <darboux/mesh.h>

namespace darboux {

// The quad a b c d that two successive triangles are the halves of: a b c and a c d, or a b d and b c d, as
// Blender and others cut it. Any triangles so numbered look like one.
std::optional<std::array<std::uint32_t, 4>> quad_of(const Triangle& x, const Triangle& y);

}  // namespace darboux
