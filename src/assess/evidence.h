// How strongly the data over-determine a fitted surface compared with its rivals: docs/theory/recognition.md.
#pragma once

#include <darboux/assess.h>

#include "shape.h"

namespace darboux {

// The evidence for a fit that fits.
Evidence evidence_for(const Mesh& mesh, const Shape& shape, const MeshFit& fit);

}  // namespace darboux
