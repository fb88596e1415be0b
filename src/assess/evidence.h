// How far the data over-determine a fitted surface against what else they may be: docs/theory/recognition.md.
#pragma once

#include <darboux/assess.h>

#include "shape.h"

namespace darboux {

// Of a fit that fits.
Evidence evidence_for(const Mesh& mesh, const Shape& shape, const MeshFit& fit);

}  // namespace darboux
