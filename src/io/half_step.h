// By how much a glTF file rounded the numbers of an accessor.
#pragma once

#include "accessor.h"

namespace darboux::io {

/// Half the step of the numbers that numbers() gives, by their integer type; 0 for floats.
double half_step(const Accessor& accessor);

/// The same of vectors of length 1. Tools that quantise to 10 bits store these in 16 (gltf-transform
/// quantize): where all numbers are multiples of 1 / (2^bits - 1), as near as their type holds these, that is
/// the step; also in floats, of signed bytes or more bits, of bytes without a sign that 2 x - 1 spread (odd
/// multiples of 1 / 255), and of half floats. Of many vectors some thousands are looked at. Not for positions
/// and uvs: those of a regular grid are such multiples too, and exact.
double half_step_of_directions(const Accessor& accessor);

}  // namespace darboux::io
