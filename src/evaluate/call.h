// A call of evaluate(): its kernel, and how results are written.
#pragma once

#include <algorithm>

#include <darboux/evaluate.h>

#include "evaluate/kernels/dispatch.h"
#include "layout.h"

namespace darboux::evaluation {

// Results of at least this many bytes are written past the caches: about the size that no longer fits into
// them (docs/reports/evaluation.md).
constexpr std::size_t past_caches_from = std::size_t{10} << 20;

// The data shared by all threads of a call.
template <class T>
class Call {
 public:
  Call(const detail::ErasedSurface<T>& erased, const Points<T>& all_points, const Outputs<T>& all_outputs,
       const EvaluateOptions& options)
      : surface(erased),
        points(all_points),
        outputs(all_outputs),
        sign(options.sign),
        layout(plan(all_outputs)) {
    const auto found = kernels::find_kernels<T>(*erased.type, options.instruction_set);
    if (erased.proven && found.kernels != nullptr) {
      set = found.set;
      prepare = found.prepare;
      const Attributes asked = all_outputs.attributes();
      const auto only = [&](Attributes allowed) { return (asked | allowed) == allowed; };
      const Variant variant = only(frame_attributes)   ? Variant::frames
                              : only(first_attributes) ? Variant::first
                                                       : Variant::everything;
      kernel = (*found.kernels)[static_cast<std::size_t>(variant)];
      v_is_needed = !erased.tangent_depends_on_u_alone ||
                    !only(Attribute::tangent | Attribute::tangent4 | Attribute::handedness);
    }
    past_caches = layout.without_gaps && kernel.run != nullptr && set->pass_caches &&
                  (options.stores == Stores::past_caches ||
                   (options.stores == Stores::automatic &&
                    all_points.size() >= past_caches_from / std::max<std::size_t>(layout.bytes_a_point, 1)));
    direct = past_caches && layout.run_count == 0 && kernel.writes_lines && can_be_aligned();
  }

  const detail::ErasedSurface<T>& surface;
  const Points<T>& points;
  const Outputs<T>& outputs;
  SignConvention sign;
  Layout<T> layout;
  const kernels::Kernels* set = nullptr;
  const std::array<kernels::Prepare<T>, 4>* prepare = nullptr;
  kernels::Kernel<T> kernel;  // none: point by point
  bool v_is_needed = true;
  bool past_caches = false;
  bool direct = false;  // past the caches directly from registers; otherwise through the stages

  bool on_stages() const { return past_caches && !direct; }
  // The number of points from `at` to the next one whose values all begin cache lines.
  std::size_t to_line(std::size_t at) const { return direct ? (aligned_at_ - at) % batch_size<T> : 0; }

 private:
  // Whether there is a point whose values all begin cache lines; if so, determines their position in a batch.
  bool can_be_aligned() {
    for (aligned_at_ = 0; aligned_at_ < batch_size<T>; ++aligned_at_)
      if (std::all_of(layout.destinations.begin(), layout.destinations.begin() + layout.count,
                      [&](const Destination& d) {
                        return (reinterpret_cast<std::uintptr_t>(d.to) +
                                aligned_at_ * static_cast<std::size_t>(d.stride)) %
                                   line ==
                               0;
                      }))
        return true;
    return false;
  }

  std::size_t aligned_at_ = 0;
};

}  // namespace darboux::evaluation
