#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <darboux/error.h>
#include <darboux/evaluate.h>

#include "evaluate/kernels/dispatch.h"
#include "evaluate/kernels/kernels.h"

namespace darboux {
namespace {

using kernels::Arrangement;
using kernels::batch_size;
using kernels::group_size;
using kernels::line;
using kernels::Variant;

// The most points a kernel is called with, but for less than batch_size<T>, so that none gets fewer.
constexpr std::size_t block_points = 1024;
template <class T>
constexpr std::size_t block_room = block_points + batch_size<T> + group_size<T>;
// Columns of a grid whose sines are taken at once.
template <class T>
constexpr std::size_t most_columns = 4096 / sizeof(T);
// From so many bytes of results on they are written past the caches: about where these no longer hold them
// (docs/reports/evaluation.md).
constexpr std::size_t past_caches_from = std::size_t{10} << 20;
// Points staged before they are written past the caches.
template <class T>
constexpr std::size_t staged_points = group_size<T>;
// A thread gets this many points at least.
constexpr std::size_t least_per_thread = 2048;

// ---- layouts ----------------------------------------------------------------------------------------------

// An array of numbers, vectors or structs that results go to.
struct Destination {
  char* to;               // of the call's first point
  std::ptrdiff_t stride;  // in bytes
  std::size_t stage_at;   // its stage, past the caches: bytes from the stages' begin
  std::size_t skip;       // bytes of the stage's first line that are not ours
  std::size_t filled;     // bytes of the stage, these included
  char* line_to;          // where the stage's first line goes
};

// The plan of a call.
template <class T>
struct Layout {
  std::array<kernels::Slot<T>, attribute_count> slots{};
  std::array<kernels::Run<T>, all_components> runs;
  std::size_t run_count = 0;
  std::array<Destination, all_components> destinations;
  // Of each destination: the slot's component, or the run, whose first address it gives.
  struct Use {
    bool run;
    std::uint8_t slot_or_run, component;
  };
  std::array<Use, all_components> uses;
  std::size_t count = 0;  // of destinations
  std::size_t stage_bytes = 0;
  std::size_t bytes_a_point = 0;
  bool without_gaps = true;  // all of it may be written in whole lines

  void add(T* to, std::ptrdiff_t stride, std::size_t bytes, Use use) {
    destinations[count] = {reinterpret_cast<char*>(to), stride, stage_bytes, 0, 0, nullptr};
    uses[count++] = use;
    bytes_a_point += bytes;
    without_gaps = without_gaps && stride == static_cast<std::ptrdiff_t>(bytes);
    // What is left of the turn before, the points of one turn, and the last turn's excess.
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
  // The tile's rows are in the order of the numbers, so that each run is one piece of it. An attribute's own
  // components are consecutive numbers, and so consecutive rows.
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

// ---- evaluation -------------------------------------------------------------------------------------------

template <class T>
class Batch {
 public:
  Batch(const detail::ErasedSurface<T>& surface, const Points<T>& points, const Outputs<T>& outputs,
        const EvaluateOptions& options)
      : surface_(surface), points_(points), outputs_(outputs), sign_(options.sign), layout_(plan(outputs)) {
    const auto found = kernels::find_kernels<T>(*surface.type, options.instruction_set);
    if (surface.proven && found.kernels != nullptr) {
      set_ = found.set;
      prepare_ = found.prepare;
      const Attributes asked = outputs.attributes();
      const auto only = [&](Attributes permitted) { return (asked | permitted) == permitted; };
      variant_ = only(frame_attributes)   ? Variant::frames
                 : only(first_attributes) ? Variant::first
                                          : Variant::everything;
      kernel_ = (*found.kernels)[static_cast<std::size_t>(variant_)];
      v_is_needed_ = !surface.tangent_depends_on_u_alone ||
                     !only(Attribute::tangent | Attribute::tangent4 | Attribute::handedness);
    }
    past_caches_ = layout_.without_gaps && kernel_ != nullptr && set_->pass_caches &&
                   (options.stores == Stores::past_caches ||
                    (options.stores == Stores::automatic &&
                     points.size() >= past_caches_from / std::max<std::size_t>(layout_.bytes_a_point, 1)));
    direct_ = past_caches_ && layout_.run_count == 0 &&
              set_->writes_lines[static_cast<std::size_t>(variant_)] && can_be_aligned();
  }

  // Points `first` to `last` of the call.
  StatusSummary run(std::size_t first, std::size_t last) const {
    Turn_ turn(*this, last - first);
    if (kernel_ == nullptr)
      turn.singly(first, last);
    else if (points_.is_grid() && first < last)
      turn.grid(first, last);
    else
      turn.arrays(first, last);
    return turn.summary;
  }

 private:
  // The state of one thread.
  struct Turn_ {
    Turn_(const Batch& b, std::size_t points) : batch(b) {
      std::copy_n(b.layout_.runs.begin(), b.layout_.run_count, runs.begin());
      std::copy_n(b.layout_.destinations.begin(), b.layout_.count, destinations.begin());
      std::fill_n(status.begin(), std::min(points, block_room<T>), 0u);
      work.surface = b.surface_.surface;
      work.raw_sign = b.sign_ == SignConvention::raw;
      work.status = status.data();
      work.tile = tile.data();
      work.runs = runs.data();
      work.run_count = b.layout_.run_count;
      work.redo = [](void* self, std::size_t begin, std::size_t count) {
        static_cast<Turn_*>(self)->redo(begin, count);
      };
      work.context = this;
      work.slots = b.layout_.slots;
      for (std::size_t k = 0; k < b.layout_.count; ++k) {
        const auto& use = b.layout_.uses[k];
        uses[k] =
            use.run ? &runs[use.slot_or_run].first : &work.slots[use.slot_or_run].component[use.component];
      }
    }

    const Batch& batch;
    StatusSummary summary;
    kernels::Work<T> work;
    std::array<kernels::Run<T>, all_components> runs;
    std::array<Destination, all_components> destinations;
    std::array<T**, all_components> uses;
    std::array<std::uint32_t, block_room<T>> status;  // zero between the blocks
    std::size_t work_first = 0;                       // the point that is the work's first
    alignas(line) std::array<T, all_components * batch_size<T>> tile;
    alignas(line) std::array<T, block_room<T>> raw_u, raw_v;
    alignas(line) std::array<T, group_size<T>> sine_v, cosine_v;
    alignas(line) std::array<T, most_columns<T> + batch_size<T>> columns_u, sine_u, cosine_u;
    alignas(line) std::array<char, most_stage_bytes<T>> stage;

    // ---- sources

    void arrays(std::size_t first, std::size_t last) {
      work.in_domain = false;
      work.v_is_needed = batch.v_is_needed_;
      begin_stages(first);
      constexpr std::size_t G = group_size<T>;
      const T *u = batch.points_.u(), *v = batch.points_.v();
      for (std::size_t at = first, n = 0; at < last; at += n) {
        const std::size_t rest = last - at;
        prefetch(u, at + block_points, last);
        if (v != u + 1) prefetch(v, at + block_points, last);
        if (batch.points_.stride() == sizeof(T) && rest >= 4 * G) {  // a group more may be read there
          const std::size_t odd = batch.to_line(at);
          n = odd + std::min(block_points, (rest - G - odd) / G * G);
          block(at, n, {u + at}, {v + at});
        } else {
          n = rest < block_points + batch_size<T> ? rest : block_points;
          fill(raw_u, u, at, n);
          fill(raw_v, v, at, n);
          block(at, n, {raw_u.data()}, {raw_v.data()});
        }
      }
      end_stages();
    }

    // The sines of the columns are taken once for all rows, or where these are long for the pieces of them
    // that lie below each other.
    void grid(std::size_t first, std::size_t last) {
      const std::size_t width = batch.points_.columns() + 1;
      if (width < batch_size<T>) return short_rows(first, last);
      work.in_domain = true;
      const std::size_t tiles = (width + most_columns<T> - 1) / most_columns<T>;
      const std::size_t tile_width =
          (width + tiles - 1) / tiles;                    // as many in each, none too few for a kernel
      const std::size_t offset = batch.points_.offset();  // in the rows, of the call's first point
      const auto prepare = [&](Coordinate kind, const T* x, std::size_t count, T* sine, T* cosine) {
        (*batch.prepare_)[static_cast<std::size_t>(kind)](x, count, sine, cosine);
      };
      const std::size_t first_row = (offset + first) / width, last_row = (offset + last - 1) / width;
      if (last_row == first_row + 1) {  // no row is whole: each meets columns of its own
        grid(first, last_row * width - offset);
        return grid(last_row * width - offset, last);
      }
      const bool one_row = first_row == last_row;
      std::size_t left = one_row ? (offset + first) % width / tile_width * tile_width : 0;
      for (; left < width; left += tile_width) {
        if (one_row && left > (offset + last - 1) % width) break;
        const std::size_t columns = std::min(tile_width, width - left);
        const std::size_t padded = (columns + batch_size<T> - 1) / batch_size<T> * batch_size<T>;
        for (std::size_t i = 0; i < padded; ++i)
          columns_u[i] = batch.points_.column(left + std::min(i, columns - 1));
        prepare(batch.surface_.u, columns_u.data(), padded, sine_u.data(), cosine_u.data());
        bool open = false;
        for (std::size_t row = first_row; row * width + left < offset + last; ++row) {
          const std::size_t row_begin = row * width + left;
          const std::size_t begin = std::max(offset + first, row_begin);
          const std::size_t end = std::min(offset + last, row_begin + columns);
          if (begin >= end) continue;
          if (!open) begin_stages(begin - offset);
          open = columns == width;
          std::fill_n(raw_v.begin(), group_size<T>, batch.points_.row(row));
          prepare(batch.surface_.v, raw_v.data(), group_size<T>, sine_v.data(), cosine_v.data());
          const std::size_t i = begin - row_begin;
          for (std::size_t at = begin; at < end;) {
            const std::size_t rest = end - at, n = rest < block_points + batch_size<T> ? rest : block_points;
            const std::size_t k = i + at - begin;
            block(at - offset, n, {columns_u.data() + k, sine_u.data() + k, cosine_u.data() + k},
                  {raw_v.data(), sine_v.data(), cosine_v.data(), 0});
            at += n;
          }
          if (!open) end_stages();
        }
        if (open) end_stages();
      }
    }

    // Rows of fewer points than a kernel takes: as if they were arrays.
    void short_rows(std::size_t first, std::size_t last) {
      work.in_domain = false;
      begin_stages(first);
      for (std::size_t at = first; at < last;) {
        const std::size_t rest = last - at, n = rest < block_points + batch_size<T> ? rest : block_points;
        for (std::size_t i = 0; i < n + group_size<T>; ++i) {
          const auto [u, v] = batch.points_[at + std::min(i, n - 1)];
          raw_u[i] = u;
          raw_v[i] = v;
        }
        block(at, n, {raw_u.data()}, {raw_v.data()});
        at += n;
      }
      end_stages();
    }

    void singly(std::size_t first, std::size_t last) {
      work_first = first;
      for (std::size_t at = first; at < last; ++at) {
        work_first = at;
        place_slots();
        status[0] = 0;
        redo(0, 1);
        note(at, 1, true);
      }
      summary.points += last - first;
    }

    // Fetches the next block while this one is worked on.
    void prefetch(const T* from, std::size_t at, std::size_t last) const {
      const std::ptrdiff_t stride = batch.points_.stride();
      const char* source = reinterpret_cast<const char*>(from);
      const char* end = source + stride * static_cast<std::ptrdiff_t>(std::min(at + block_points, last));
      const std::ptrdiff_t step = std::max(stride, static_cast<std::ptrdiff_t>(line));
      for (source += stride * static_cast<std::ptrdiff_t>(std::min(at, last)); source < end; source += step)
        __builtin_prefetch(source);
    }

    // The n values from `at` on, and the last again to the end of a group.
    void fill(std::array<T, block_room<T>>& to, const T* from, std::size_t at, std::size_t n) const {
      const std::ptrdiff_t stride = batch.points_.stride();
      const char* source = reinterpret_cast<const char*>(from) + stride * static_cast<std::ptrdiff_t>(at);
      if (stride == 2 * sizeof(T)) {
        const T* pairs = reinterpret_cast<const T*>(source);
        for (std::size_t i = 0; i < n; ++i) to[i] = pairs[2 * i];
      } else {
        for (std::size_t i = 0; i < n; ++i)
          to[i] = *reinterpret_cast<const T*>(source + stride * static_cast<std::ptrdiff_t>(i));
      }
      std::fill_n(to.begin() + static_cast<std::ptrdiff_t>(n), group_size<T>, to[n - 1]);
    }

    // ---- blocks: as much of one as a kernel takes at once

    void block(std::size_t at, std::size_t n, const kernels::Source<T>& u, const kernels::Source<T>& v) {
      for (std::size_t done = 0; done < n; done += work.count) {
        work_first = at + done;
        work.count = n - done;
        if (batch.direct_) {
          const std::size_t odd = batch.to_line(work_first);
          work.past_caches = odd == 0;
          if (odd > 0 && work.count >= odd + 2 * group_size<T>) work.count = odd + group_size<T>;
        } else if (batch.on_stages() && work.count >= staged_points<T> + batch_size<T>) {
          work.count = staged_points<T>;
        }
        work.u = u.from(done);
        work.v = v.from(done);
        place_slots();
        bool any = true;
        if (work.count < batch_size<T>)
          redo(0, work.count);
        else
          any = batch.kernel_(work);
        note(work_first, work.count, any);
        if (batch.on_stages()) pass_on(work.count);
      }
      summary.points += n;
    }

    // ---- destinations

    // Where the point `work_first` goes: in memory, or on the stage.
    void place_slots() {
      for (std::size_t k = 0; k < batch.layout_.count; ++k) {
        const Destination& d = destinations[k];
        char* to = batch.on_stages() ? stage.data() + d.stage_at + d.filled
                                     : d.to + d.stride * static_cast<std::ptrdiff_t>(work_first);
        *uses[k] = reinterpret_cast<T*>(to);
      }
    }

    void begin_stages(std::size_t first) {
      if (!batch.on_stages()) return;
      for (std::size_t k = 0; k < batch.layout_.count; ++k) {
        Destination& d = destinations[k];
        char* to = d.to + d.stride * static_cast<std::ptrdiff_t>(first);
        d.skip = d.filled = reinterpret_cast<std::uintptr_t>(to) % line;
        d.line_to = to - d.skip;
      }
    }
    // Passes on the whole lines that `count` more points have filled.
    void pass_on(std::size_t count) {
      for (std::size_t k = 0; k < batch.layout_.count; ++k) {
        Destination& d = destinations[k];
        d.filled += count * static_cast<std::size_t>(d.stride);
        std::size_t lines = d.filled / line;
        if (lines == 0) continue;
        char* const begin = stage.data() + d.stage_at;
        char* from = begin;
        d.filled -= lines * line;
        if (d.skip > 0) {
          std::memcpy(d.line_to + d.skip, from + d.skip, line - d.skip);
          d.skip = 0;
          d.line_to += line;
          from += line;
          --lines;
        }
        batch.set_->stream_lines(d.line_to, from, lines);
        d.line_to += lines * line;
        if (d.filled > 0) std::memcpy(begin, from + lines * line, line);  // that is its room
      }
    }
    void end_stages() {
      if (!batch.past_caches_) return;
      for (std::size_t k = 0; batch.on_stages() && k < batch.layout_.count; ++k) {
        const Destination& d = destinations[k];
        std::memcpy(d.line_to + d.skip, stage.data() + d.stage_at + d.skip, d.filled - d.skip);
      }
      batch.set_->fence();
    }

    // ---- single points

    // `count` points from the work's point `begin` on, by the single-point functions.
    void redo(std::size_t begin, std::size_t count) {
      detail::PointValues<T> values;
      summary.point_by_point += count;
      for (std::size_t i = begin; i < begin + count; ++i) {
        const auto [u, v] = batch.points_[work_first + i];
        batch.surface_.point(batch.surface_.surface, u, v, batch.outputs_.attributes(), batch.sign_, values);
        status[i] = static_cast<std::uint32_t>(values.status);
        for (std::size_t a = 0; a < attribute_count; ++a) {
          const kernels::Slot<T>& slot = work.slots[a];
          const std::size_t n = attribute_infos[a].components;
          if (slot.arrangement == Arrangement::separate)
            for (std::size_t c = 0; c < n; ++c) slot.component[c][i] = values.values[a][c];
          else if (slot.arrangement == Arrangement::packed)
            std::copy_n(values.values[a].begin(), n, slot.component[0] + n * i);
          else if (slot.arrangement == Arrangement::tiled)
            for (std::size_t c = 0; c < n; ++c) tile_row(slot.row + c)[0] = values.values[a][c];
        }
        for (std::size_t r = 0; r < work.run_count; ++r)
          for (std::size_t k = 0; k < runs[r].count; ++k)
            reinterpret_cast<T*>(reinterpret_cast<char*>(runs[r].first) +
                                 runs[r].stride * static_cast<std::ptrdiff_t>(i))[k] =
                tile_row(runs[r].row + k)[0];
      }
    }
    T* tile_row(std::size_t row) { return tile.data() + row * batch_size<T>; }

    // Takes down the statuses of `count` points, all zero where not `any`, and clears them.
    void note(std::size_t first, std::size_t count, bool any) {
      if (Status* to = batch.outputs_.status_place(); to != nullptr) {
        const std::ptrdiff_t stride = batch.outputs_.status_stride();
        to = reinterpret_cast<Status*>(reinterpret_cast<char*>(to) +
                                       stride * static_cast<std::ptrdiff_t>(first));
        if (stride == sizeof(Status) && !any)
          std::fill_n(to, count, Status::regular);
        else
          for (std::size_t i = 0; i < count; ++i)
            *reinterpret_cast<Status*>(reinterpret_cast<char*>(to) +
                                       stride * static_cast<std::ptrdiff_t>(i)) =
                static_cast<Status>(status[i]);
      }
      if (!any) return;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::uint32_t bits = status[i]; bits != 0; bits &= bits - 1) {
          const auto k = static_cast<std::size_t>(std::countr_zero(bits));
          summary.first[k] = summary.count[k] == 0 ? first + i : std::min(summary.first[k], first + i);
          ++summary.count[k];
        }
        status[i] = 0;
      }
    }
  };

  detail::ErasedSurface<T> surface_;
  const Points<T>& points_;
  const Outputs<T>& outputs_;
  SignConvention sign_;
  Layout<T> layout_;
  const kernels::Kernels* set_ = nullptr;
  const std::array<kernels::Prepare<T>, 4>* prepare_ = nullptr;
  kernels::Kernel<T> kernel_ = nullptr;
  bool v_is_needed_ = true;
  Variant variant_ = Variant::everything;
  bool past_caches_ = false;
  bool direct_ = false;  // from the registers; else by way of the stages

  bool on_stages() const { return past_caches_ && !direct_; }

  // Whether all numbers of some point begin lines; and then at which points of a batch they do.
  bool can_be_aligned() {
    for (aligned_at_ = 0; aligned_at_ < batch_size<T>; ++aligned_at_)
      if (std::all_of(layout_.destinations.begin(), layout_.destinations.begin() + layout_.count,
                      [&](const Destination& d) {
                        return (reinterpret_cast<std::uintptr_t>(d.to) +
                                aligned_at_ * static_cast<std::size_t>(d.stride)) %
                                   line ==
                               0;
                      }))
        return true;
    return false;
  }
  // Points from `at` to the next one that is.
  std::size_t to_line(std::size_t at) const { return direct_ ? (aligned_at_ - at) % batch_size<T> : 0; }
  std::size_t aligned_at_ = 0;
};

template <class T>
StatusSummary evaluate_all(const detail::ErasedSurface<T>& surface, const Points<T>& points,
                           const Outputs<T>& outputs, const EvaluateOptions& options) {
  const std::size_t n = points.size();
  const auto check_room = [&](std::string_view name, std::size_t room) {
    if (room < n)
      throw ParameterError(std::string(name), "has room for " + std::to_string(room) +
                                                  " points, permitted are at least the " + std::to_string(n) +
                                                  " that are evaluated");
  };
  for (std::size_t a = 0; a < attribute_count; ++a)
    if (const auto attribute = static_cast<Attribute>(a); outputs.attributes().has(attribute))
      check_room(info_of(attribute).name, outputs.place(attribute).points);
  if (outputs.status_place() != nullptr) check_room("status", outputs.status_points());
  if (options.threads < 0)
    throw ParameterError("threads",
                         std::to_string(options.threads) + " threads, permitted is 0 (all) or more");
  const Batch<T> batch(surface, points, outputs, options);
  const std::size_t wanted = options.threads == 0 ? static_cast<std::size_t>(tbb::info::default_concurrency())
                                                  : static_cast<std::size_t>(options.threads);
  const std::size_t threads = std::min({wanted, n / least_per_thread, std::size_t{1024}});
  if (threads <= 1) return batch.run(0, n);
  std::array<StatusSummary, 1024> part;
  const auto begin_of = [&](std::size_t k) {
    return k == threads ? n : n / threads * k / batch_size<T> * batch_size<T>;
  };
  // In the caller's arena, whose workers stay awake from call to call; as many chunks as threads keep no more
  // busy. Isolated: no other task of the caller begins here, and its cancellation leaves nothing out.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, threads, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t k = range.begin(); k < range.end(); ++k)
            part[k] = batch.run(begin_of(k), begin_of(k + 1));
        },
        tbb::simple_partitioner{}, context);
  });
  StatusSummary total;
  for (std::size_t k = 0; k < threads; ++k) {
    total.points += part[k].points;
    total.point_by_point += part[k].point_by_point;
    for (std::size_t s = 0; s < total.count.size(); ++s) {
      if (total.count[s] == 0) total.first[s] = part[k].first[s];
      total.count[s] += part[k].count[s];
    }
  }
  return total;
}

}  // namespace

namespace detail {

StatusSummary evaluate(const ErasedSurface<double>& surface, const Points<double>& points,
                       const Outputs<double>& outputs, const EvaluateOptions& options) {
  return evaluate_all(surface, points, outputs, options);
}
StatusSummary evaluate(const ErasedSurface<float>& surface, const Points<float>& points,
                       const Outputs<float>& outputs, const EvaluateOptions& options) {
  return evaluate_all(surface, points, outputs, options);
}

}  // namespace detail

StatusSummary& StatusSummary::operator+=(const StatusSummary& next) {
  for (std::size_t s = 0; s < count.size(); ++s) {
    if (count[s] == 0 && next.count[s] > 0) first[s] = next.first[s] + points;
    count[s] += next.count[s];
  }
  points += next.points;
  point_by_point += next.point_by_point;
  return *this;
}

}  // namespace darboux
