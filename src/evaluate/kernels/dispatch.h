// The kernels of a surface type for the requested instruction set.
#pragma once

#include <typeinfo>

#include <darboux/instruction_set.h>

#include "work.h"

namespace darboux::kernels {

template <class T>
struct FoundKernels {
  const Kernels* set = nullptr;
  const std::array<Prepare<T>, 4>* prepare = nullptr;  // by Coordinate
  const std::array<Kernel<T>, 3>* kernels = nullptr;   // by Variant; null: point by point
};

// \param type of the surface over T
// \throws ParameterError when this build or machine lacks that instruction set, or DARBOUX_ISA names none
template <class T>
FoundKernels<T> find_kernels(const std::type_info& type, InstructionSet set);

}  // namespace darboux::kernels
