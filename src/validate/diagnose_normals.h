// Diagnoses normals of which many are wrong: which single mistake explains them all?
#pragma once

#include <cstdint>

#include "accurate.h"
#include "mesh_under_test.h"

namespace darboux {

// What explains nearly all normals that differ from the surface's: they are negated, or those from before a
// linear map (adds NORMAL_STALE).
enum class NormalMistake : std::uint8_t { none, negated, mapped };
// Where no surface is known, a map is found by the planes of facets, else by the neighbours, else by averages
// of triangles. One that averages of coarse triangles tell is added, too, but is none to decide by.
NormalMistake diagnose_normals(const MeshUnderTest& under_test, const Accurate& accurate,
                               const ValidateOptions& options, MeshReport& report);

}  // namespace darboux
