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

#include <darboux/error.h>
#include <darboux/evaluate.h>

#include "kernels/dispatch.h"
#include "kernels/kernels.h"

namespace darboux {
namespace {

using kernels::Arrangement;
using kernels::group_size;
using kernels::most_lanes;
using kernels::Variant;

constexpr std::size_t line = 64;  // bytes that go to memory at once

// Points prepared at a time, whose sines stay in the first-level cache; the last block of a call may be longer by less than
// most_lanes, so that no kernel gets fewer.
constexpr std::size_t block_points = 256;
template <class T>
constexpr std::size_t block_room = block_points + group_size<T>;
// Columns of a grid whose sines are taken at once.
template <class T>
constexpr std::size_t most_columns = 4096 / sizeof(T);
// Points staged before they are written past the caches: two lines of each array.
template <class T>
constexpr std::size_t staged_points = 2 * line / sizeof(T);
// From so many bytes of results on they are written past the caches: about where these no longer hold them
// (docs/reports/evaluation.md).
constexpr std::size_t past_caches_from = std::size_t{10} << 20;
// A thread gets this many points at least.
constexpr std::size_t least_per_thread = 2048;

[[noreturn]] void refuse(Attribute a, const std::string& why) {
  throw ParameterError(std::string(info_of(a).name), why);
}

template <class T>
bool aligned_to_own_size(const T* p) {
  return reinterpret_cast<std::uintptr_t>(p) % alignof(T) == 0;
}

// ---- layouts ----------------------------------------------------------------------------------------------------

// An array of numbers, vectors or structs that results go to.
struct Destination {
  char* to;                 // of the call's first point
  std::ptrdiff_t stride;    // in bytes
  std::size_t stage_at;     // its stage, past the caches: bytes from the stages' begin
  std::size_t skip = 0;     // bytes of the stage's first line that are not ours
  std::size_t filled = 0;   // bytes of the stage, these included
  char* line_to = nullptr;  // where the stage's first line goes
};

// The plan of a call.
template <class T>
struct Layout {
  std::array<kernels::Slot<T>, attribute_count> slots{};
  std::array<kernels::Run<T>, all_components> runs{};
  std::size_t run_count = 0;
  std::array<Destination, all_components> destinations{};
  // Of each destination: the slot's component, or the run, whose first address it gives.
  struct Use {
    bool run;
    std::uint8_t slot_or_run, component;
  };
  std::array<Use, all_components> uses{};
  std::size_t count = 0;  // of destinations
  std::size_t stage_bytes = 0;
  std::size_t bytes_a_point = 0;
  bool without_gaps = true;  // all of it may be written in whole lines

  void add(T* to, std::ptrdiff_t stride, std::size_t bytes, Use use) {
    destinations[count] = {reinterpret_cast<char*>(to), stride, stage_bytes};
    uses[count++] = use;
    bytes_a_point += bytes;
    without_gaps = without_gaps && stride == static_cast<std::ptrdiff_t>(bytes);
    // What is left of the turn before, the points of one turn, and the last turn's excess.
    stage_bytes += (line + bytes * (staged_points<T> + most_lanes) + line - 1) / line * line + line;
  }
};
template <class T>
constexpr std::size_t most_stage_bytes = all_components*(3 * line +
                                                         sizeof(T) * (staged_points<T> + most_lanes));

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
  // The tile's rows are in the order of the numbers, so that each run is one piece of it. An attribute's own components are
  // consecutive numbers, and so consecutive rows.
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

// ---- evaluation -------------------------------------------------------------------------------------------------

template <class T>
class Batch {
 public:
  Batch(const detail::ErasedSurface<T>& surface, const Points<T>& points, const Outputs<T>& outputs,
        const EvaluateOptions& options)
      : surface_(surface), points_(points), outputs_(outputs), sign_(options.sign), layout_(plan(outputs)) {
    const auto found = kernels::find_kernels<T>(*surface.type, options.instruction_set);
    if (surface.proven && found.kernels != nullptr) {
      set_ = found.set;
      table_ = found.table;
      const Attributes asked = outputs.attributes();
      const auto only = [&](Attributes permitted) { return (asked | permitted) == permitted; };
      const Variant variant = only(frame_attributes)   ? Variant::frames
                              : only(first_attributes) ? Variant::first
                                                       : Variant::everything;
      kernel_ = (*found.kernels)[static_cast<std::size_t>(variant)];
      v_is_needed_ = !surface.tangent_depends_on_u_alone ||
                     !only(Attribute::tangent | Attribute::tangent4 | Attribute::handedness);
    }
    const bool past_caches =
        layout_.without_gaps && kernel_ != nullptr && set_->pass_caches &&
        (options.stores == Stores::past_caches ||
         (options.stores == Stores::automatic &&
          points.size() >= past_caches_from / std::max<std::size_t>(layout_.bytes_a_point, 1)));
    if (past_caches)
      way_ =
          set_->registers_are_lines && layout_.run_count == 0 && can_be_aligned() ? Way::direct : Way::staged;
  }

  // Points `first` to `last` of the call.
  StatusSummary run(std::size_t first, std::size_t last) const {
    Turn_ turn(*this);
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
    explicit Turn_(const Batch& b) : batch(b), runs(b.layout_.runs), destinations(b.layout_.destinations) {
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
    std::array<std::uint32_t, block_room<T>> status{};
    std::size_t work_first = 0;  // the point that is the work's first
    alignas(line) std::array<T, all_components * most_lanes> tile;
    alignas(line) std::array<T, block_room<T>> raw_u, raw_v;
    alignas(line) std::array<T, most_lanes> sine_v, cosine_v;
    alignas(line) std::array<T, most_columns<T> + most_lanes> columns_u, sine_u, cosine_u;
    alignas(line) std::array<char, most_stage_bytes<T>> stage;

    // ---- sources

    void arrays(std::size_t first, std::size_t last) {
      work.in_domain = false;
      work.v_is_needed = batch.v_is_needed_;
      begin_stages(first);
      for (std::size_t at = first; at < last;) {
        const std::size_t rest = last - at, n = rest < block_points + most_lanes ? rest : block_points;
        fill(raw_u, batch.points_.u(), at, n);
        fill(raw_v, batch.points_.v(), at, n);
        prefetch(batch.points_.u(), at + n, last);
        if (batch.points_.v() != batch.points_.u() + 1) prefetch(batch.points_.v(), at + n, last);
        block(at, n, {raw_u.data()}, {raw_v.data()});
        at += n;
      }
      end_stages();
    }

    // The sines of the columns are taken once for all rows, or where these are long for the pieces of them that lie below each
    // other.
    void grid(std::size_t first, std::size_t last) {
      const std::size_t width = batch.points_.columns() + 1;
      if (width < most_lanes) return short_rows(first, last);
      work.in_domain = true;
      const std::size_t tiles = (width + most_columns<T> - 1) / most_columns<T>;
      const std::size_t tile_width =
          (width + tiles - 1) / tiles;                    // as many in each, none too few for a kernel
      const std::size_t offset = batch.points_.offset();  // in the rows, of the call's first point
      const auto prepare = [&](Coordinate kind, const T* x, std::size_t count, T* sine, T* cosine) {
        batch.table_->prepare[static_cast<std::size_t>(kind)](x, count, sine, cosine);
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
        const std::size_t padded = (columns + most_lanes - 1) / most_lanes * most_lanes;
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
          std::fill_n(raw_v.begin(), most_lanes, batch.points_.row(row));
          prepare(batch.surface_.v, raw_v.data(), most_lanes, sine_v.data(), cosine_v.data());
          const std::size_t i = begin - row_begin;
          for (std::size_t at = begin; at < end;) {
            const std::size_t rest = end - at, n = rest < block_points + most_lanes ? rest : block_points;
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
        const std::size_t rest = last - at, n = rest < block_points + most_lanes ? rest : block_points;
        for (std::size_t i = 0; i < block_room<T>; ++i) {
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
      for (source += stride * static_cast<std::ptrdiff_t>(at); source < end; source += step)
        __builtin_prefetch(source);
    }

    // The n values from `at` on, and the last again for groups that are not whole.
    void fill(std::array<T, block_room<T>>& to, const T* from, std::size_t at, std::size_t n) const {
      const std::ptrdiff_t stride = batch.points_.stride();
      const char* source = reinterpret_cast<const char*>(from) + stride * static_cast<std::ptrdiff_t>(at);
      if (stride == sizeof(T)) {
        std::memcpy(to.data(), source, n * sizeof(T));
      } else if (stride == 2 * sizeof(T)) {
        const T* pairs = reinterpret_cast<const T*>(source);
        for (std::size_t i = 0; i < n; ++i) to[i] = pairs[2 * i];
      } else {
        for (std::size_t i = 0; i < n; ++i)
          to[i] = *reinterpret_cast<const T*>(source + stride * static_cast<std::ptrdiff_t>(i));
      }
      std::fill(to.begin() + static_cast<std::ptrdiff_t>(n), to.end(), to[n - 1]);
    }

    // ---- blocks: as much of one as a kernel takes at once

    void block(std::size_t at, std::size_t n, kernels::Source<T> u, kernels::Source<T> v) {
      for (std::size_t done = 0; done < n;) {
        work_first = at + done;
        std::size_t most = n;
        if (batch.way_ == Way::staged) most = staged_points<T>;
        if (batch.way_ == Way::direct) {
          const std::size_t to_line = batch.to_line_[work_first % most_lanes];
          work.past_caches = to_line == 0;
          if (to_line > 0) most = to_line + most_lanes;
        }
        const std::size_t rest = n - done;
        const bool all = rest < most + most_lanes;  // a kernel takes no fewer
        work.count = all ? rest : most;
        work.u = moved(u, done);
        work.v = moved(v, done);
        place_slots();
        std::fill_n(status.begin(), work.count, 0u);
        bool any = true;
        if (work.count < most_lanes)
          redo(0, work.count);
        else
          any = batch.kernel_(work);
        note(work_first, work.count, any);
        if (batch.way_ == Way::staged) pass_on(work.count);
        done += work.count;
      }
      summary.points += n;
    }
    static kernels::Source<T> moved(kernels::Source<T> x, std::size_t by) {
      by *= x.step;
      x.values += by;
      if (x.sine != nullptr) x.sine += by, x.cosine += by;
      return x;
    }

    // ---- destinations

    // Where the point `work_first` goes: in memory, or on the stage.
    void place_slots() {
      const bool staged = batch.way_ == Way::staged;
      for (std::size_t k = 0; k < batch.layout_.count; ++k) {
        const Destination& d = destinations[k];
        char* to = staged ? stage.data() + d.stage_at + d.filled
                          : d.to + d.stride * static_cast<std::ptrdiff_t>(work_first);
        *uses[k] = reinterpret_cast<T*>(to);
      }
    }

    void begin_stages(std::size_t first) {
      if (batch.way_ != Way::staged) return;
      for (std::size_t k = 0; k < batch.layout_.count; ++k) {
        Destination& d = destinations[k];
        char* to = d.to + d.stride * static_cast<std::ptrdiff_t>(first);
        d.skip = d.filled = reinterpret_cast<std::uintptr_t>(to) % line;
        d.line_to = to - d.skip;
      }
    }
    // Writes the whole lines that `count` more points have filled.
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
      if (batch.way_ == Way::cached) return;
      for (std::size_t k = 0; batch.way_ == Way::staged && k < batch.layout_.count; ++k) {
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
    T* tile_row(std::size_t row) { return tile.data() + row * most_lanes; }

    // Takes down the statuses of `count` points.
    void note(std::size_t first, std::size_t count, bool any) {
      if (Status* to = batch.outputs_.status_place(); to != nullptr)
        for (std::size_t i = 0; i < count; ++i)
          *reinterpret_cast<Status*>(reinterpret_cast<char*>(to) +
                                     batch.outputs_.status_stride() *
                                         static_cast<std::ptrdiff_t>(first + i)) =
              static_cast<Status>(status[i]);
      if (!any) return;
      for (std::size_t i = 0; i < count; ++i)
        for (std::uint32_t bits = status[i]; bits != 0; bits &= bits - 1) {
          const auto k = static_cast<std::size_t>(std::countr_zero(bits));
          summary.first[k] = summary.count[k] == 0 ? first + i : std::min(summary.first[k], first + i);
          ++summary.count[k];
        }
    }
  };

  detail::ErasedSurface<T> surface_;
  const Points<T>& points_;
  const Outputs<T>& outputs_;
  SignConvention sign_;
  Layout<T> layout_;
  // How results reach memory.
  enum class Way : std::uint8_t {
    cached,
    staged,  // past the caches, by way of a stage in the first-level cache
    direct,  // past the caches from the kernel's registers, each a line
  };
  // Whether some point's numbers all begin a line, and then how many points it is from one of index r, modulo 16, to it.
  bool can_be_aligned() {
    for (std::size_t p = 0; p < most_lanes; ++p) {
      bool all = true;
      for (std::size_t k = 0; k < layout_.count; ++k) {
        const Destination& d = layout_.destinations[k];
        all = all &&
              (reinterpret_cast<std::uintptr_t>(d.to) + p * static_cast<std::size_t>(d.stride)) % line == 0;
      }
      if (!all) continue;
      constexpr std::size_t period = line / sizeof(T);  // points
      for (std::size_t r = 0; r < most_lanes; ++r)
        to_line_[r] = static_cast<std::uint8_t>((p + most_lanes - r) % period);
      return true;
    }
    return false;
  }
  std::array<std::uint8_t, most_lanes> to_line_{};

  const kernels::Kernels* set_ = nullptr;
  const kernels::KernelTable<T>* table_ = nullptr;
  kernels::Kernel<T> kernel_ = nullptr;
  bool v_is_needed_ = true;
  Way way_ = Way::cached;
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
    return k == threads ? n : n / threads * k / most_lanes * most_lanes;
  };
  tbb::task_arena arena(std::min(static_cast<int>(threads), tbb::info::default_concurrency()));
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, threads, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t k = range.begin(); k < range.end(); ++k)
            part[k] = batch.run(begin_of(k), begin_of(k + 1));
        },
        tbb::static_partitioner{});
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

// ---- requests ---------------------------------------------------------------------------------------------------

template <std::floating_point T>
Points<T> Points<T>::arrays(std::span<const T> u, std::span<const T> v) {
  if (u.size() != v.size())
    throw ParameterError("points", std::to_string(u.size()) + " values of u and " + std::to_string(v.size()) +
                                       " of v, permitted are as many");
  if (!aligned_to_own_size(u.data()) || !aligned_to_own_size(v.data()))
    throw ParameterError("points", "u or v is not aligned to its numbers, permitted are multiples of " +
                                       std::to_string(alignof(T)) + " bytes");
  Points result;
  result.u_ = u.data();
  result.v_ = v.data();
  result.size_ = u.size();
  return result;
}

template <std::floating_point T>
Points<T> Points<T>::interleaved(std::span<const T> uv) {
  if (uv.size() % 2 != 0)
    throw ParameterError("points",
                         std::to_string(uv.size()) + " interleaved values, permitted is an even number");
  return interleaved(uv.data(), uv.size() / 2, 2 * sizeof(T));
}

template <std::floating_point T>
Points<T> Points<T>::interleaved(const T* uv, std::size_t points, std::ptrdiff_t stride) {
  if (uv == nullptr && points > 0)
    throw ParameterError("points", "uv is null, permitted is an array of pairs");
  if (stride < static_cast<std::ptrdiff_t>(2 * sizeof(T)) ||
      stride % static_cast<std::ptrdiff_t>(alignof(T)) != 0)
    throw ParameterError("points", "a stride of " + std::to_string(stride) +
                                       " bytes, permitted are multiples of " + std::to_string(alignof(T)) +
                                       " from " + std::to_string(2 * sizeof(T)) + " on");
  if (!aligned_to_own_size(uv))
    throw ParameterError("points", "uv is not aligned to its numbers, permitted are multiples of " +
                                       std::to_string(alignof(T)) + " bytes");
  Points result;
  result.u_ = uv;
  result.v_ = uv == nullptr ? nullptr : uv + 1;
  result.stride_ = stride;
  result.size_ = points;
  return result;
}

template <std::floating_point T>
Points<T> Points<T>::grid(std::size_t columns, std::size_t rows, std::size_t first, std::size_t count) {
  constexpr std::size_t most = std::size_t{1} << 31;
  if (columns < 1 || rows < 1 || columns > most || rows > most)
    throw ParameterError("grid", std::to_string(columns) + " columns and " + std::to_string(rows) +
                                     " rows, permitted are 1 to " + std::to_string(most) + " of each");
  if (first > rows)
    throw ParameterError(
        "grid", "row of points " + std::to_string(first) + ", permitted are 0 to " + std::to_string(rows));
  Points result;
  result.columns_ = columns;
  result.rows_ = rows;
  result.first_row_ = first;
  result.size_ = std::min(count, rows + 1 - first) * (columns + 1);
  return result;
}

template <std::floating_point T>
Points<T> Points<T>::part(std::size_t first, std::size_t count) const {
  if (first > size_ || count > size_ - first)
    throw ParameterError("points", std::to_string(count) + " points from " + std::to_string(first) +
                                       " on, permitted are parts of the " + std::to_string(size_) +
                                       " there are");
  Points result = *this;
  result.size_ = count;
  if (is_grid()) {
    result.offset_ += first;
  } else {
    const auto moved = [&](const T* x) {
      return reinterpret_cast<const T*>(reinterpret_cast<const char*>(x) +
                                        stride_ * static_cast<std::ptrdiff_t>(first));
    };
    result.u_ = moved(u_);
    result.v_ = moved(v_);
  }
  return result;
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::add(Attribute a, const OutputPlace<T>& place, std::size_t consecutive) {
  if (asked_.has(a)) refuse(a, "is asked for twice, permitted is once");
  for (std::size_t c = 0; c < info_of(a).components; ++c) {
    if (place.component[c] == nullptr && place.points > 0)
      refuse(a, "its array is null, permitted is the caller's memory");
    if (!aligned_to_own_size(place.component[c]))
      refuse(a, "its array is not aligned to its numbers, permitted are multiples of " +
                    std::to_string(alignof(T)) + " bytes");
  }
  if (place.stride < static_cast<std::ptrdiff_t>(consecutive * sizeof(T)) ||
      place.stride % static_cast<std::ptrdiff_t>(alignof(T)) != 0)
    refuse(a, "a stride of " + std::to_string(place.stride) + " bytes, permitted are multiples of " +
                  std::to_string(alignof(T)) + " from " + std::to_string(consecutive * sizeof(T)) + " on");
  asked_ |= a;
  places_[static_cast<std::size_t>(a)] = place;
  return *this;
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::separate(Attribute a, std::span<const std::span<T>> components) {
  if (components.size() != info_of(a).components)
    refuse(a, std::to_string(components.size()) + " arrays, permitted are its " +
                  std::to_string(info_of(a).components) + " components");
  OutputPlace<T> place;
  place.stride = sizeof(T);
  place.points = components[0].size();
  for (std::size_t c = 0; c < components.size(); ++c) {
    place.component[c] = components[c].data();
    place.points = std::min(place.points, components[c].size());
  }
  return add(a, place, 1);
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::packed(Attribute a, std::span<T> values) {
  const std::size_t n = info_of(a).components;
  return member(a, values.data(), values.size() / n, static_cast<std::ptrdiff_t>(n * sizeof(T)));
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::member(Attribute a, T* first, std::size_t points, std::ptrdiff_t stride) {
  OutputPlace<T> place;
  const std::size_t n = info_of(a).components;
  for (std::size_t c = 0; c < n; ++c) place.component[c] = first == nullptr ? nullptr : first + c;
  place.stride = stride;
  place.points = points;
  return add(a, place, n);
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::status(Status* first, std::size_t points, std::ptrdiff_t stride) {
  if (status_ != nullptr) throw ParameterError("status", "is asked for twice, permitted is once");
  if (first == nullptr && points > 0)
    throw ParameterError("status", "its array is null, permitted is the caller's memory");
  if (stride < static_cast<std::ptrdiff_t>(sizeof(Status)) ||
      stride % static_cast<std::ptrdiff_t>(alignof(Status)) != 0 || !aligned_to_own_size(first))
    throw ParameterError(
        "status", (aligned_to_own_size(first) ? "a stride of " + std::to_string(stride) + " bytes"
                                              : std::string("its array is not aligned to its values")) +
                      ", permitted are multiples of " + std::to_string(sizeof(Status)) + " bytes");
  status_ = first;
  status_points_ = points;
  status_stride_ = stride;
  return *this;
}

template class Points<double>;
template class Points<float>;
template class Outputs<double>;
template class Outputs<float>;

}  // namespace darboux
