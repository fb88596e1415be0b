// uv_jet() of many points.
#pragma once

#include <span>

#include <darboux/evaluate.h>
#include <darboux/local_jets.h>

#include "uv_jets.h"

namespace darboux {

// The number of points for which a call is efficient.
inline constexpr std::size_t jets_at_once = 64;

// Bit for bit as uv_jet(); each point needs at least one neighbour. \throws ParameterError as find_kernels
void uv_jets(std::span<const kernels::UvNeighbours> of, int degree, bool u_periodic, bool v_periodic,
             std::span<UvJet> results, InstructionSet set = InstructionSet::automatic);

}  // namespace darboux
