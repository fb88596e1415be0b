/// \file surface_picture.h
/// A surface as a picture.
#pragma once

#include <string>

#include <darboux/any_surface.h>

namespace darboux {

/// An SVG of the surface in orthographic view, z up, from a fixed direction: blue where n points to the
/// viewer, orange where it points away, thin lines of constant u and v, thick ones at 0 and 1, three tangent
/// frames (t red, b green, n blue) at visible points. Cells that are not finite are omitted. Hidden parts are
/// painted over cell by cell, so self-intersections look as ragged as the cells. The same surface gives the
/// same bytes.
std::string surface_picture(const AnySurface& surface);

}  // namespace darboux
