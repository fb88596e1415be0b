/// \file dispatch.h
/// The kernels of a surface type on the instruction set asked for.
#pragma once

#include <typeinfo>

#include <darboux/evaluate.h>

#include "kernels.h"
#include "uv_jets.h"

namespace darboux::kernels {

template <class T>
struct Found {
  const Kernels* set = nullptr;
  const KernelTable<T>* table = nullptr;
  const std::array<Kernel<T>, 3>* kernels = nullptr;  ///< by Variant; null: point by point
};

/// \param type of the surface over T
/// \throws ParameterError when this build or machine has not that instruction set, or DARBOUX_ISA names none
template <class T>
Found<T> find_kernels(const std::type_info& type, InstructionSet set);

/// Null: point by point. \throws as find_kernels
const UvJetTable* find_uv_jets(InstructionSet set);

}  // namespace darboux::kernels
