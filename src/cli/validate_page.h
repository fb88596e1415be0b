/// \file validate_page.h
/// The results of validate as an HTML page.
#pragma once

#include <string>
#include <vector>

#include "validate_files.h"

namespace darboux {

/// A self-contained HTML page that works offline: one row per mesh, failures first and expanded. A row shows
/// the errors on the mesh, which can be rotated, and over the uv square; the findings and errors per class of
/// each part; and a histogram. Rows can be filtered by verdict and code, and sorted. Without scripts the
/// pictures and controls are missing. If the meshes have more than 300 000 triangles in total, only every
/// n-th is drawn, and the page says so. \param files with assessments that keep errors and primitives that
/// have their data
std::string validate_page(const std::vector<AssessedFile>& files, double max_angle_deg);

}  // namespace darboux
