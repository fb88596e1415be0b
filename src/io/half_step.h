// By how much a glTF file rounded the numbers of an accessor.
#pragma once

#include "accessor.h"

namespace darboux::io {

/// Half the quantisation step of the values from numbers(), by the integer type; 0 for floats.
double half_step(const Accessor& accessor);

/// The same for unit vectors. Tools that quantise to 10 bits store these in 16 (gltf-transform quantize): if
/// all numbers are multiples of 1 / (2^bits - 1), as closely as their type can hold these, that is the step.
/// This also covers floats converted from signed bytes or wider integers, from unsigned bytes by 2 x - 1 (odd
/// multiples of 1 / 255), and from half floats. Of many vectors some thousands are examined. Not for
/// positions and uvs: those of a regular grid are such multiples too, and exact.
double half_step_of_directions(const Accessor& accessor);

}  // namespace darboux::io
