/// \file local_truth.h
/// What a mesh's own positions, and uvs, say of its normals and tangents, where no surface is known.
#pragma once

#include <vector>

#include <darboux/mesh.h>
#include <darboux/placed_surface.h>

namespace darboux {

/// The truth at each vertex from the polynomial P(u, v) through the vertices about it (uv_jet() of
/// local_jets.h), with its standard deviations: of degree 3 through those up to two edges away; where that
/// leaves more than a thousandth of a degree, of degree 4 through those up to three; or up to five where
/// fewer do not tell the error. Deviations are rather too large than too small: on smooth surfaces twice that
/// covers 99 % of vertices, and their median is 1 to 2.5 times that of the errors. Vertices are joined where
/// they agree in position, uv and normal, so that the other side of a seam or of a crease does not count;
/// triangles whose uvs wind differently are kept apart, and so are those on the two sides of an edge where
/// faces meet at more than 50 degrees, though its vertices agree; at such an edge there is no truth. n is on
/// the side from which triangles wind counter-clockwise. A deviation whose triple is a radian is infinite.
/// NaN, with no_frame and infinite deviations, where the neighbours do not tell. Poles of the chart are not
/// known here.
/// Without uvs, or where none has area, the polynomial is one over the plane that is square to the vertex's
/// triangles on average, and there is a normal alone: tangents are NaN, their deviations infinite, the status
/// is no_frame; deviations of symmetric patches are up to 15 times the errors. Nothing is told where a
/// neighbour's triangles lean by more than 72 degrees from that plane, or the polynomial by more than 36.
/// Cost: linear, about 1 us per vertex, 3 to 7 where degree 4 is needed. \throws MeshError when the mesh is
/// inconsistent, ParameterError where DARBOUX_ISA names no instruction set
std::vector<Truth> local_truth(const Mesh& mesh);

}  // namespace darboux
