#include "base/instruction_set.h"
#include "uv_jets.h"

namespace darboux::kernels {

#if defined(DARBOUX_WITH_BASELINE)
extern const UvJetTable uv_jet_table_baseline;
#endif
#if defined(DARBOUX_WITH_AVX2)
extern const UvJetTable uv_jet_table_avx2;
#endif
#if defined(DARBOUX_WITH_AVX512)
extern const UvJetTable uv_jet_table_avx512;
#endif

const UvJetTable* find_uv_jets(InstructionSet set) {
  switch (resolve(set)) {
#if defined(DARBOUX_WITH_BASELINE)
    case InstructionSet::baseline:
      return &uv_jet_table_baseline;
#endif
#if defined(DARBOUX_WITH_AVX2)
    case InstructionSet::avx2:
      return &uv_jet_table_avx2;
#endif
#if defined(DARBOUX_WITH_AVX512)
    case InstructionSet::avx512:
      return &uv_jet_table_avx512;
#endif
    default:
      return nullptr;
  }
}

}  // namespace darboux::kernels
