/// \file local_truth.h
/// Normals and tangents of a mesh from its own positions and uvs, for meshes whose surface is not known.
#pragma once

#include <vector>

#include <darboux/mesh.h>
#include <darboux/placed_surface.h>

namespace darboux {

/// The truth at each vertex, with its standard deviations, from a polynomial P(u, v) through the vertices
/// around it (uv_jet() of local_jets.h). It has degree 3 and uses the vertices up to two edges away. If that
/// leaves more than a thousandth of a degree, it has degree 4 and uses those up to three edges away, or up to
/// five if fewer do not tell the error. The deviations tend to be too large rather than too small: on smooth
/// surfaces twice the deviation covers 99 % of the vertices, and the median deviation is 1 to 2.5 times the
/// median error. Vertices are joined if they agree in position, uv and normal, so the other side of a seam or
/// a crease does not count. Triangles whose uvs wind differently are kept apart. So are triangles on the two
/// sides of an edge where faces meet at more than 50 degrees, even if its vertices agree; at such an edge
/// there is no truth. n is on the side from which triangles wind counter-clockwise. A deviation of a third of
/// a radian or more is infinite. If the neighbours do not determine the truth, it is NaN, with no_frame and
/// infinite deviations. Poles of the chart are not known here.
///
/// Without uvs, or if none has area, the polynomial is a height over the plane perpendicular to the mean
/// normal of the vertex's triangles. It gives a normal only: tangents are NaN, their deviations infinite, the
/// status is no_frame. On symmetric patches the deviations are up to 15 times the errors. There is no result
/// if a neighbour's triangles lean by more than 72 degrees from that plane, or the polynomial by more than
/// 36.
/// Cost: linear, about 1 us per vertex, 3 to 7 where degree 4 is needed. \throws MeshError when the mesh is
/// inconsistent, ParameterError where DARBOUX_ISA names no instruction set
std::vector<Truth> local_truth(const Mesh& mesh);

}  // namespace darboux
