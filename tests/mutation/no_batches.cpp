// Batches are not among what a mutant is judged by: the kernels stay out of its program.
#include <cstdlib>

#include <darboux/evaluate.h>

namespace darboux::detail {

StatusSummary evaluate(const ErasedSurface<double>&, const Points<double>&, const Outputs<double>&,
                       const EvaluateOptions&) {
  std::abort();
}
StatusSummary evaluate(const ErasedSurface<float>&, const Points<float>&, const Outputs<float>&,
                       const EvaluateOptions&) {
  std::abort();
}

}  // namespace darboux::detail
