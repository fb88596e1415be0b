#include "instruction_set.h"

#include <cstdlib>
#include <string>
#include <vector>

#include <darboux/error.h>
#include <darboux/instruction_set.h>

namespace darboux {
namespace {

struct Known {
  InstructionSet set;
  bool (*runs)();
};

constexpr Known all_known[] = {
    {InstructionSet::points, [] { return true; }},
#if defined(DARBOUX_WITH_BASELINE)
    {InstructionSet::baseline, [] { return true; }},
#endif
#if defined(DARBOUX_WITH_AVX2)
    {InstructionSet::avx2,
     [] { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; }},
#endif
#if defined(DARBOUX_WITH_AVX512)
    {InstructionSet::avx512,
     [] {
       return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
              __builtin_cpu_supports("avx512cd") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
              __builtin_cpu_supports("avx512vl") != 0;
     }},
#endif
};

[[noreturn]] void refuse(std::string_view subject, std::string_view name) {
  std::string sets;
  for (const InstructionSet set : instruction_sets()) (sets += sets.empty() ? "" : ", ") += name_of(set);
  throw ParameterError(std::string(subject), "expected one that this machine and build have (" + sets +
                                                 "), got '" + std::string(name) + "'");
}

}  // namespace

std::span<const InstructionSet> instruction_sets() {
  static const std::vector<InstructionSet> list = [] {
    std::vector<InstructionSet> result;
    for (const Known& known : all_known)
      if (known.runs()) result.push_back(known.set);
    return result;
  }();
  return list;
}

InstructionSet chosen_instruction_set() {
  const char* wanted = std::getenv("DARBOUX_ISA");
  if (wanted == nullptr || *wanted == '\0') return instruction_sets().back();
  for (const InstructionSet set : instruction_sets())
    if (name_of(set) == wanted) return set;
  refuse("DARBOUX_ISA", wanted);
}

InstructionSet kernels::resolve(InstructionSet set) {
  if (set == InstructionSet::automatic) return chosen_instruction_set();
  for (const InstructionSet known : instruction_sets())
    if (known == set) return set;
  refuse("instruction set", name_of(set));
}

std::string_view name_of(InstructionSet set) {
  switch (set) {
    case InstructionSet::automatic:
      return "automatic";
    case InstructionSet::points:
      return "points";
    case InstructionSet::baseline:
      return "baseline";
    case InstructionSet::avx2:
      return "avx2";
    case InstructionSet::avx512:
      return "avx512";
  }
  return "unknown";
}

}  // namespace darboux
