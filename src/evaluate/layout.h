// The layout of the results of a call: separate arrays, packed vectors, members of structs.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <darboux/evaluate.h>

#include "evaluate/kernels/work.h"

namespace darboux::evaluation {

using kernels::Arrangement;
using kernels::batch_size;
using kernels::group_size;
using kernels::line;
using kernels::Variant;

// The number of points staged before they are written past the caches.
template <class T>
constexpr std::size_t staged_points = group_size<T>;
// An array of numbers, vectors or structs to which results are written.
struct Destination {
  char* to;               // of the call's first point
  std::ptrdiff_t stride;  // in bytes
  std::size_t stage_at;   // its stage, past the caches: bytes from the stages' begin
  std::size_t skip;       // bytes of the stage's first line that are not ours
  std::size_t filled;     // bytes of the stage, these included
  char* line_to;          // where the stage's first line goes
};

// The plan of a call's results.
template <class T>
struct Layout {
  std::array<kernels::Slot<T>, attribute_count> slots{};
  std::array<kernels::Run<T>, all_components> runs;
  std::size_t run_count = 0;
  std::array<Destination, all_components> destinations;
  // For each destination: the slot's component, or the run, whose first address it gives.
  struct Use {
    bool run;
    std::uint8_t slot_or_run, component;
  };
  std::array<Use, all_components> uses;
  std::size_t count = 0;  // of destinations
  std::size_t stage_bytes = 0;
  std::size_t bytes_a_point = 0;
  bool without_gaps = true;  // all of it may be written in whole cache lines

  void add(T* to, std::ptrdiff_t stride, std::size_t bytes, Use use) {
    destinations[count] = {reinterpret_cast<char*>(to), stride, stage_bytes, 0, 0, nullptr};
    uses[count++] = use;
    bytes_a_point += bytes;
    without_gaps = without_gaps && stride == static_cast<std::ptrdiff_t>(bytes);
    // The rest of the previous block, the points of one block, and the excess of the last block.
    stage_bytes += (line + bytes * (staged_points<T> + batch_size<T>)+line - 1) / line * line + line;
  }
};
template <class T>
constexpr std::size_t most_stage_bytes = all_components*(3 * line +
                                                         sizeof(T) * (staged_points<T> + batch_size<T>));

// Rows of structs: components with one stride become runs of consecutive numbers.
template <class T>
void add_structs(Layout<T>& layout, const Outputs<T>& outputs) {
  struct Row {
    T* to;
    std::ptrdiff_t stride;
    std::uint8_t attribute, component;
  };
  std::array<Row, all_components> rows{};
  std::size_t count = 0;
  for (std::size_t a = 0; a < attribute_count; ++a) {
    if (layout.slots[a].arrangement != Arrangement::tiled) continue;
    const OutputPlace<T>& place = outputs.place(static_cast<Attribute>(a));
    for (std::size_t c = 0; c < attribute_infos[a].components; ++c)
      rows[count++] = {place.component[c], place.stride, static_cast<std::uint8_t>(a),
                       static_cast<std::uint8_t>(c)};
  }
  std::sort(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count), [](const Row& x, const Row& y) {
    return std::pair(x.stride, reinterpret_cast<std::uintptr_t>(x.to)) <
           std::pair(y.stride, reinterpret_cast<std::uintptr_t>(y.to));
  });
  // The rows of the tile are in the order of the numbers, so that each run is contiguous. The components of
  // an attribute are consecutive numbers, hence consecutive rows.
  for (std::size_t r = 0; r < count; ++r) {
    if (rows[r].component == 0) layout.slots[rows[r].attribute].row = r;
    kernels::Run<T>* run = layout.run_count > 0 ? &layout.runs[layout.run_count - 1] : nullptr;
    if (run != nullptr && run->stride == rows[r].stride && run->first + run->count == rows[r].to)
      ++run->count;
    else
      layout.runs[layout.run_count++] = {r, 1, rows[r].to, rows[r].stride};
  }
  for (std::size_t r = 0; r < layout.run_count; ++r) {
    const kernels::Run<T>& run = layout.runs[r];
    layout.add(run.first, run.stride, run.count * sizeof(T), {true, static_cast<std::uint8_t>(r), 0});
  }
}

template <class T>
Layout<T> plan(const Outputs<T>& outputs) {
  Layout<T> layout;
  for (std::size_t a = 0; a < attribute_count; ++a) {
    const auto attribute = static_cast<Attribute>(a);
    if (!outputs.attributes().has(attribute)) continue;
    const std::size_t n = info_of(attribute).components;
    const OutputPlace<T>& place = outputs.place(attribute);
    const auto bytes = static_cast<std::ptrdiff_t>(n * sizeof(T));
    bool consecutive = true;
    for (std::size_t c = 1; c < n; ++c)
      consecutive = consecutive && place.component[c] == place.component[0] + c;
    kernels::Slot<T>& slot = layout.slots[a];
    const auto slot_index = static_cast<std::uint8_t>(a);
    if (place.stride == sizeof(T)) {
      slot.arrangement = Arrangement::separate;
      for (std::size_t c = 0; c < n; ++c)
        layout.add(place.component[c], sizeof(T), sizeof(T),
                   {false, slot_index, static_cast<std::uint8_t>(c)});
    } else if (consecutive && n <= 4 && place.stride == bytes) {
      slot.arrangement = Arrangement::packed;
      layout.add(place.component[0], bytes, n * sizeof(T), {false, slot_index, 0});
    } else {
      slot.arrangement = Arrangement::tiled;
    }
  }
  add_structs(layout, outputs);
  return layout;
}

}  // namespace darboux::evaluation
