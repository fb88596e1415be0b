// A scale baked into a mesh together with its tangents: the mesh before it.
//
// Tools that apply a node's matrix M to its mesh write M p, M t and the normal M^-T n. Where triangles lean
// from the plane of the normal, M t is no average of the new triangles' dpdu, d' = M d. The old average
// t ~ d - (n.d) n becomes
//   t' ~ d' - (n'.d') G n' / (n'.G n'),   G = M M^T.
// The cross product of both sides, times n'.G n', is linear in G: least squares over the vertices give G up
// to its size. G^(-1/2) p, G^(-1/2) t' and G^(1/2) n' then are the mesh before the scale, up to a rotation.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <darboux/mesh.h>

namespace darboux {

// The mesh before a scale, if one explains nine tenths of the tangents that it changes within the limit,
// and these have a dozen different directions and normals. \param raw_sign of each triangle, 0 without uv
// area \param has_area triangles with area in space
std::optional<Mesh> before_baked_scale(const Mesh& mesh, std::span<const signed char> raw_sign,
                                       const std::vector<bool>& has_area, double max_angle_deg);

}  // namespace darboux
