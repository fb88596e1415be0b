/// \file instruction_set.h
/// Which instructions batches run on.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace darboux {

/// Which instructions a batch runs on. All give the same bits.
enum class InstructionSet : std::uint8_t {
  automatic,  ///< the best this machine has, or what the environment variable DARBOUX_ISA names
  points,     ///< none: point by point, through the single-point functions
  baseline,   ///< what every CPU of the architecture has
  avx2,
  avx512,
};
/// Those that this build and this machine can run, best last.
std::span<const InstructionSet> instruction_sets();
/// What `automatic` means at this moment.
/// \throws ParameterError when DARBOUX_ISA names none of instruction_sets(). Everything that runs on the
/// chosen set throws it too: evaluate() of many points, local_truth(), uv_jets(), mikktspace(), and their
/// callers
InstructionSet chosen_instruction_set();
/// "avx2", as in DARBOUX_ISA; "unknown" for what is no instruction set.
std::string_view name_of(InstructionSet set);

}  // namespace darboux
