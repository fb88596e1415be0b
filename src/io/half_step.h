// By how much a glTF file rounded the numbers of an accessor.
#pragma once

#include "accessor.h"

namespace darboux::io {

/// Half the step of the numbers that numbers() gives: that of their integer type, or that of fewer bits,
/// where all numbers are multiples of 1 / (2^bits - 1) as near as their type holds these, which tools that
/// quantise to 10 bits store in 16 (gltf-transform quantize). 0 for floats, but for directions of which all
/// numbers are such multiples: they were quantised once. \param directions vectors of length 1
double half_step(const Accessor& accessor, bool directions);

}  // namespace darboux::io
