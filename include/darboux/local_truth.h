/// \file local_truth.h
/// Estimates normals and tangents of a mesh from its positions and uvs, for meshes whose surface is unknown.
#pragma once

#include <vector>

#include <darboux/mesh.h>
#include <darboux/placed_surface.h>

namespace darboux {

/// Estimates the truth at each vertex, with standard deviations, from a polynomial P(u, v) fitted to the
/// vertices around it (uv_jet() of local_jets.h). The polynomial has degree 3 and uses the vertices up to two
/// edges away. If the deviation exceeds a thousandth of a degree, degree 4 is used, with the vertices up to
/// three edges away, or up to five if fewer do not determine the error. The deviations tend to be too large
/// rather than too small: on smooth surfaces twice the deviation covers 99 % of the vertices, and the median
/// deviation is 1 to 2.5 times the median error. Vertices are welded if they agree in position, uv and
/// normal, so the other side of a seam or crease is not used. Triangles whose uvs wind differently are
/// separated. So are triangles on the two sides of an edge where faces meet at more than 50 degrees, even if
/// its vertices agree; at such an edge there is no result. n is on the side from which triangles wind
/// counter-clockwise. A deviation of a third of a radian or more is infinite. If the neighbours do not
/// determine the frame, it is NaN, with no_frame and infinite deviations. Poles of the chart are not
/// detected.
///
/// Without uvs, or if no triangle has uv area, the polynomial is a height field over the plane perpendicular
/// to the mean normal of the triangles at the vertex. It gives only a normal: tangents are NaN with infinite
/// deviations, and the status is no_frame. On symmetric patches the deviations are up to 15 times the errors.
/// There is no result if a neighbour's triangles lean by more than 72 degrees from that plane, or the
/// polynomial by more than 36. Cost: linear, about 1 us per vertex, 3 to 7 where degree 4 is needed. \throws
/// MeshError when the mesh is inconsistent, ParameterError where DARBOUX_ISA names no instruction set
std::vector<Truth> local_truth(const Mesh& mesh);

}  // namespace darboux
