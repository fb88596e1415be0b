/// \file uv_jets.h
/// The interface between uv_jets() of local_jets.cpp and uv_jets.cpp, which is compiled once per instruction
/// set. Plain data only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <darboux/instruction_set.h>
#include <darboux/local_jets.h>

namespace darboux::kernels {

/// A point, and those near it: some of many.
struct UvNeighbours {
  const Vec2<double>* uvs = nullptr;
  const Vec3<double>* positions = nullptr;
  const std::uint32_t* near = nullptr;  ///< which of them
  std::size_t count = 0;                ///< how many; at least one
  Vec2<double> at{};
};

struct UvJetWork {
  const UvNeighbours* of = nullptr;
  std::size_t count = 0;
  bool u_periodic = false, v_periodic = false;
  UvJet* results = nullptr;
  bool* done = nullptr;  ///< false: to be done by itself
};

struct UvJetTable {
  std::array<void (*)(const UvJetWork&), 3> of_degree{};  ///< 2, 3, 4
};

/// Null: point by point.
/// \throws ParameterError when this build or machine lacks that instruction set, or DARBOUX_ISA names none
const UvJetTable* find_uv_jets(InstructionSet set);

}  // namespace darboux::kernels
