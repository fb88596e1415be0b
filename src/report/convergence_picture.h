/// \file convergence_picture.h
/// An overview picture of convergence: a mesh coloured by tangent error, next to a plot of error against mesh
/// width.
#pragma once

#include <string>
#include <vector>

#include <darboux/converge.h>

namespace darboux {

/// An SVG of 1000 x 420 pixels. Left: the mesh of 16 rows over the first surface and family, in the view of
/// surface_picture(), each triangle in the colour of the mean error of its corners' tangents by the first
/// method (viridis, from 0 to the largest), with its scale in degrees. Right: rms error of the tangents at
/// interior corners against the mesh width, both logarithmic, one line per method, with reference slopes 1
/// and 2. The same studies give the same bytes. \param studies of converge(options)
std::string convergence_picture(const ConvergeOptions& options, const std::vector<Study>& studies);

}  // namespace darboux
