/// \file convergence_picture.h
/// Convergence at a glance: a mesh coloured by its tangents' error beside the error's fall with the mesh
/// width.
#pragma once

#include <string>
#include <vector>

#include <darboux/converge.h>

namespace darboux {

/// An SVG of 1000 x 420 pixels. Left: the mesh of 16 rows over the first surface and family, in the
/// view of surface_picture(), each triangle in the colour of the mean error of its corners' tangents by the
/// first method (viridis, from 0 to the largest), with its scale in degrees. Right: rms error of the tangents
/// at interior corners against the mesh width, both logarithmic, a line per method, beside the slopes 1
/// and 2. The same studies give the same bytes. \param studies of converge(options)
std::string convergence_picture(const ConvergeOptions& options, const std::vector<Study>& studies);

}  // namespace darboux
