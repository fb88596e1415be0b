/// \file validate_page.h
/// What validate found, as a page for people.
#pragma once

#include <string>
#include <vector>

#include "validate_files.h"

namespace darboux {

/// A self-contained HTML page: the verdicts, and of each judgement its findings, its errors by class, as a histogram, over the
/// uv square and on the mesh, which turns. It needs no network; without scripts all but the last two remain. Of meshes with
/// more than 300 000 triangles in all every so manieth is drawn, and the page says so.
/// \param files whose judgements keep errors and whose primitives have their data
std::string validate_page(const std::vector<JudgedFile>& files, double max_angle_deg);

}  // namespace darboux
