// Writes results to memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "call.h"

namespace darboux::evaluation {

// The outputs of a thread: directly to memory, or past the caches through stages, one per destination, which
// are written line by line.
template <class T>
class Stages {
 public:
  // Addresses of the slots of `work` and of `runs` are set by place().
  Stages(const Call<T>& call, kernels::Work<T>& work, std::array<kernels::Run<T>, all_components>& runs)
      : call_(call) {
    std::copy_n(call.layout.destinations.begin(), call.layout.count, destinations_.begin());
    for (std::size_t k = 0; k < call.layout.count; ++k) {
      const auto& use = call.layout.uses[k];
      addresses_[k] =
          use.run ? &runs[use.slot_or_run].first : &work.slots[use.slot_or_run].component[use.component];
    }
  }

  // Sets the addresses for the point `work_first`: in memory, or on the stage.
  void place(std::size_t work_first) {
    for (std::size_t k = 0; k < call_.layout.count; ++k) {
      const Destination& d = destinations_[k];
      char* to = call_.on_stages() ? memory_.data() + d.stage_at + d.filled
                                   : d.to + d.stride * static_cast<std::ptrdiff_t>(work_first);
      *addresses_[k] = reinterpret_cast<T*>(to);
    }
  }

  void begin(std::size_t first) {
    if (!call_.on_stages()) return;
    for (std::size_t k = 0; k < call_.layout.count; ++k) {
      Destination& d = destinations_[k];
      char* to = d.to + d.stride * static_cast<std::ptrdiff_t>(first);
      d.skip = d.filled = reinterpret_cast<std::uintptr_t>(to) % line;
      d.line_to = to - d.skip;
    }
  }
  // Writes the whole cache lines that `count` more points have filled.
  void pass_on(std::size_t count) {
    for (std::size_t k = 0; k < call_.layout.count; ++k) {
      Destination& d = destinations_[k];
      d.filled += count * static_cast<std::size_t>(d.stride);
      std::size_t lines = d.filled / line;
      if (lines == 0) continue;
      char* const stage = memory_.data() + d.stage_at;
      char* from = stage;
      d.filled -= lines * line;
      if (d.skip > 0) {
        std::memcpy(d.line_to + d.skip, from + d.skip, line - d.skip);
        d.skip = 0;
        d.line_to += line;
        from += line;
        --lines;
      }
      call_.set->stream_lines(d.line_to, from, lines);
      d.line_to += lines * line;
      if (d.filled > 0) std::memcpy(stage, from + lines * line, line);  // that is its room
    }
  }
  void end() {
    if (!call_.past_caches) return;
    for (std::size_t k = 0; call_.on_stages() && k < call_.layout.count; ++k) {
      const Destination& d = destinations_[k];
      std::memcpy(d.line_to + d.skip, memory_.data() + d.stage_at + d.skip, d.filled - d.skip);
    }
    call_.set->fence();
  }

 private:
  const Call<T>& call_;
  std::array<Destination, all_components> destinations_;
  std::array<T**, all_components> addresses_;
  alignas(line) std::array<char, most_stage_bytes<T>> memory_;
};

}  // namespace darboux::evaluation
