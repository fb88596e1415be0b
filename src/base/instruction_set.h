// The instruction set on which a request runs.
#pragma once

#include <darboux/instruction_set.h>

namespace darboux::kernels {

// The set itself, or the chosen one for `automatic`.
// \throws ParameterError when this build or machine lacks it, or DARBOUX_ISA names none
InstructionSet resolve(InstructionSet set);

}  // namespace darboux::kernels
