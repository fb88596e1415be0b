#include "dispatch.h"

#include <concepts>
#include <map>
#include <typeindex>

#include <darboux/catalogue.h>

#include "base/instruction_set.h"

namespace darboux::kernels {

#if defined(DARBOUX_WITH_BASELINE)
extern const Kernels table_baseline;
#endif
#if defined(DARBOUX_WITH_AVX2)
extern const Kernels table_avx2;
#endif
#if defined(DARBOUX_WITH_AVX512)
extern const Kernels table_avx512;
#endif

namespace {

// Null: point by point.
const Kernels* kernels_of(InstructionSet set) {
  switch (set) {
#if defined(DARBOUX_WITH_BASELINE)
    case InstructionSet::baseline:
      return &table_baseline;
#endif
#if defined(DARBOUX_WITH_AVX2)
    case InstructionSet::avx2:
      return &table_avx2;
#endif
#if defined(DARBOUX_WITH_AVX512)
    case InstructionSet::avx512:
      return &table_avx512;
#endif
    default:
      return nullptr;
  }
}

// Maps the catalogue's types over T to their indices in it.
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

}  // namespace

template <class T>
FoundKernels<T> find_kernels(const std::type_info& type, InstructionSet set) {
  const Kernels* kernels = kernels_of(resolve(set));
  const auto place = places<T>().find(type);
  if (kernels == nullptr || place == places<T>().end()) return {};
  const SurfaceKernels& of_surface = *kernels->surface[place->second];
  FoundKernels<T> found{kernels};
  if constexpr (std::same_as<T, double>)
    found.prepare = &kernels->prepare_double, found.kernels = &of_surface.in_double;
  else
    found.prepare = &kernels->prepare_float, found.kernels = &of_surface.in_float;
  if ((*found.kernels)[0].run == nullptr) found.kernels = nullptr;
  return found;
}
template FoundKernels<double> find_kernels(const std::type_info&, InstructionSet);
template FoundKernels<float> find_kernels(const std::type_info&, InstructionSet);

}  // namespace darboux::kernels
