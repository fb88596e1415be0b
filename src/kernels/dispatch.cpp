#include "dispatch.h"

#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <typeindex>
#include <vector>

#include <darboux/catalogue.h>
#include <darboux/error.h>

namespace darboux {
namespace kernels {

#if defined(DARBOUX_WITH_BASELINE)
extern const Kernels table_baseline;
extern const UvJetTable uv_jet_table_baseline;
#endif
#if defined(DARBOUX_WITH_AVX2)
extern const Kernels table_avx2;
extern const UvJetTable uv_jet_table_avx2;
#endif
#if defined(DARBOUX_WITH_AVX512)
extern const Kernels table_avx512;
extern const UvJetTable uv_jet_table_avx512;
#endif

namespace {

struct Known {
  InstructionSet set;
  std::string_view name;
  const Kernels* kernels;
  const UvJetTable* uv_jets;
  bool (*runs)();
};

constexpr auto always = [] { return true; };

const std::vector<Known>& all_known() {
  static const std::vector<Known> list {
    {InstructionSet::points, "points", nullptr, nullptr, always},
#if defined(DARBOUX_WITH_BASELINE)
        {InstructionSet::baseline, "baseline", &table_baseline, &uv_jet_table_baseline, always},
#endif
#if defined(DARBOUX_WITH_AVX2)
        {InstructionSet::avx2, "avx2", &table_avx2, &uv_jet_table_avx2,
         [] { return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0; }},
#endif
#if defined(DARBOUX_WITH_AVX512)
        {InstructionSet::avx512, "avx512", &table_avx512, &uv_jet_table_avx512, [] {
           return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                  __builtin_cpu_supports("avx512cd") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
                  __builtin_cpu_supports("avx512vl") != 0;
         }},
#endif
  };
  return list;
}

std::string permitted_names() {
  std::string text;
  for (const InstructionSet set : instruction_sets())
    text += (text.empty() ? "" : ", ") + std::string(name_of(set));
  return text;
}

const Known& find(InstructionSet set) {
  if (set == InstructionSet::automatic) set = chosen_instruction_set();
  for (const Known& known : all_known())
    if (known.set == set && known.runs()) return known;
  throw ParameterError("instruction set", "'" + std::string(name_of(set)) +
                                              "' is none of this machine and build, permitted are " +
                                              permitted_names());
}

// The catalogue's types over T, to their place in it.
template <class T>
const std::map<std::type_index, std::size_t>& places() {
  static const auto map = [] {
    std::map<std::type_index, std::size_t> result;
    std::size_t k = 0;
    Catalogue::for_each([&](const auto& surface) { result.emplace(typeid(rebind<T>(surface)), k++); });
    return result;
  }();
  return map;
}

template <class T>
const KernelTable<T>& table_over(const Kernels& kernels) {
  if constexpr (std::same_as<T, double>)
    return kernels.in_double;
  else
    return kernels.in_float;
}

}  // namespace

template <class T>
Found<T> find_kernels(const std::type_info& type, InstructionSet set) {
  const Known& known = find(set);
  const auto place = places<T>().find(type);
  if (known.kernels == nullptr || place == places<T>().end()) return {};
  const KernelTable<T>& table = table_over<T>(*known.kernels);
  const auto& kernels = table.surface.at(place->second);
  return {known.kernels, &table, kernels[0] == nullptr ? nullptr : &kernels};
}
template Found<double> find_kernels(const std::type_info&, InstructionSet);
template Found<float> find_kernels(const std::type_info&, InstructionSet);

const UvJetTable* find_uv_jets(InstructionSet set) {
  return find(set).uv_jets;
}

}  // namespace kernels

std::span<const InstructionSet> instruction_sets() {
  static const std::vector<InstructionSet> list = [] {
    std::vector<InstructionSet> result;
    for (const kernels::Known& known : kernels::all_known())
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
  throw ParameterError("DARBOUX_ISA",
                       "'" + std::string(wanted) +
                           "' is no instruction set of this machine and build, permitted are " +
                           kernels::permitted_names());
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
