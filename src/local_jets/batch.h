// uv_jet() of many points.
#pragma once

#include <span>

#include <darboux/evaluate.h>
#include <darboux/local_jets.h>

#include "uv_jets.h"

namespace darboux {

// How many points are worth asking for at once.
inline constexpr std::size_t jets_at_once = 64;

// To the bits of uv_jet(); each has a neighbour or more. \throws ParameterError as find_kernels
void uv_jets(std::span<const kernels::UvNeighbours> of, int degree, bool u_periodic, bool v_periodic,
             std::span<UvJet> results, InstructionSet set = InstructionSet::automatic);

}  // namespace darboux
