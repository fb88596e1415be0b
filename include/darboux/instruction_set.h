/// \file instruction_set.h
/// The instruction sets for batches.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace darboux {

/// The instruction set on which a batch runs. All give the same bits.
enum class InstructionSet : std::uint8_t {
  automatic,  ///< the best this machine has, or what the environment variable DARBOUX_ISA names
  points,     ///< none: point by point, through the single-point functions
  baseline,   ///< the instructions of every CPU of the architecture
  avx2,
  avx512,
};
/// The instruction sets supported by this build and this machine, best last.
std::span<const InstructionSet> instruction_sets();
/// The instruction set that `automatic` currently selects.
/// \throws ParameterError if DARBOUX_ISA names none of instruction_sets(). So does everything that uses this
/// selection: evaluate() of many points, local_truth(), uv_jets(), mikktspace(), and their callers
InstructionSet chosen_instruction_set();
/// "avx2", as in DARBOUX_ISA; "unknown" for any other value.
std::string_view name_of(InstructionSet set);

}  // namespace darboux
