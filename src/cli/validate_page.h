/// \file validate_page.h
/// What validate found, as a page for people.
#pragma once

#include <string>
#include <vector>

#include "validate_files.h"

namespace darboux {

/// A self-contained HTML page: a row for each mesh, failures first and open. In it the errors on the mesh,
/// which turns, and over the uv square; the findings and errors by class of each part; a histogram. Rows are
/// filtered by verdict and code, and sorted. It needs no network; without scripts the pictures and controls
/// are missing. Where meshes have more than 300 000 triangles in total, only every n-th is drawn, and the
/// page says so. \param files whose assessments keep errors and whose primitives have their data
std::string validate_page(const std::vector<AssessedFile>& files, double max_angle_deg);

}  // namespace darboux
