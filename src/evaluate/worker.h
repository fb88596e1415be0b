// The work of one thread.
#pragma once

#include <algorithm>
#include <array>

#include "call.h"
#include "output_stages.h"
#include "scalar_fallback.h"
#include "statuses.h"

namespace darboux::evaluation {

// The part of a call that one thread evaluates. Blocks of points pass from the source (arrays, a grid)
// through the kernel, or the scalar fallback, to the stages.
template <class T>
class Worker {
 public:
  // \param points that it evaluates in all
  Worker(const Call<T>& call, std::size_t points)
      : call_(call),
        stages_(call, work_, runs_),
        statuses_(call.outputs, points),
        fallback_(call, work_, runs_, statuses_) {
    std::copy_n(call.layout.runs.begin(), call.layout.run_count, runs_.begin());
    work_.surface = call.surface.surface;
    work_.raw_sign = call.sign == SignConvention::raw;
    work_.status = statuses_.data();
    work_.tile = tile_.data();
    work_.runs = runs_.data();
    work_.run_count = call.layout.run_count;
    work_.scalar_fallback = [](void* self, std::size_t begin, std::size_t count) {
      auto& worker = *static_cast<Worker*>(self);
      worker.fallback_(worker.work_first_, begin, count);
    };
    work_.context = this;
    work_.slots = call.layout.slots;
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Points `first` to `last` of the call.
  StatusSummary run(std::size_t first, std::size_t last) {
    if (call_.kernel.run == nullptr)
      one_by_one(first, last);
    else if (call_.points.is_grid() && first < last)
      grid(first, last);
    else
      arrays(first, last);
    return statuses_.summary;
  }

 private:
  // ---- sources

  void arrays(std::size_t first, std::size_t last) {
    work_.in_domain = false;
    work_.v_is_needed = call_.v_is_needed;
    stages_.begin(first);
    constexpr std::size_t G = group_size<T>;
    const T *u = call_.points.u(), *v = call_.points.v();
    for (std::size_t at = first, n = 0; at < last; at += n) {
      const std::size_t rest = last - at;
      prefetch(u, at + block_points, last);
      if (v != u + 1) prefetch(v, at + block_points, last);
      if (call_.points.stride() == sizeof(T) && rest >= 4 * G) {  // one more group can be read there
        const std::size_t odd = call_.to_line(at);
        n = odd + std::min(block_points, (rest - G - odd) / G * G);
        block(at, n, {u + at}, {v + at});
      } else {
        n = rest < block_points + batch_size<T> ? rest : block_points;
        fill(raw_u_, u, at, n);
        fill(raw_v_, v, at, n);
        block(at, n, {raw_u_.data()}, {raw_v_.data()});
      }
    }
    stages_.end();
  }

  void prepare(Coordinate kind, const T* x, std::size_t count, T* sine, T* cosine) const {
    (*call_.prepare)[static_cast<std::size_t>(kind)](x, count, sine, cosine);
  }

  // The sines of the columns are computed once for all rows; for long rows, once per tile of columns.
  void grid(std::size_t first, std::size_t last) {
    const std::size_t width = call_.points.columns() + 1;
    if (width < batch_size<T>) return short_rows(first, last);
    if (width < joined_rows_below<T> && !call_.kernel.by_rows) return joined_rows(first, last);
    work_.in_domain = true;
    const std::size_t tiles = (width + most_columns<T> - 1) / most_columns<T>;
    const std::size_t tile_width = (width + tiles - 1) / tiles;  // equal widths, none too small for a kernel
    const std::size_t offset = call_.points.offset();            // in the rows, of the call's first point
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
        columns_u_[i] = call_.points.column(left + std::min(i, columns - 1));
      prepare(call_.surface.u, columns_u_.data(), padded, sine_u_.data(), cosine_u_.data());
      bool open = false;
      for (std::size_t row = first_row; row * width + left < offset + last; ++row) {
        const std::size_t row_begin = row * width + left;
        const std::size_t begin = std::max(offset + first, row_begin);
        const std::size_t end = std::min(offset + last, row_begin + columns);
        if (begin >= end) continue;
        if (!open) stages_.begin(begin - offset);
        open = columns == width;
        std::fill_n(raw_v_.begin(), group_size<T>, call_.points.row(row));
        prepare(call_.surface.v, raw_v_.data(), group_size<T>, sine_v_.data(), cosine_v_.data());
        const std::size_t i = begin - row_begin;
        for (std::size_t at = begin; at < end;) {
          const std::size_t rest = end - at, n = rest < block_points + batch_size<T> ? rest : block_points;
          const std::size_t k = i + at - begin;
          block(at - offset, n, {columns_u_.data() + k, sine_u_.data() + k, cosine_u_.data() + k},
                {raw_v_.data(), sine_v_.data(), cosine_v_.data(), 0});
          at += n;
        }
        if (!open) stages_.end();
      }
      if (open) stages_.end();
    }
  }

  // Joins several short rows, which would leave registers partly empty, with copies of the sines of the
  // columns. If a row is singular (at an end of the chart), it is so as a whole, and is evaluated separately.
  void joined_rows(std::size_t first, std::size_t last) {
    work_.in_domain = true;
    const Points<T>& points = call_.points;
    const std::size_t width = points.columns() + 1, offset = points.offset();
    const std::size_t last_row = (offset + last - 1) / width;
    const bool linear_u = call_.surface.u == Coordinate::linear;
    const bool linear_v = call_.surface.v == Coordinate::linear;
    // Copies whole registers: values beyond `count` are overwritten by the next row, or never read.
    const auto copy = [](const T* from, std::size_t count, T* to) {
      for (std::size_t i = 0; i < count; i += batch_size<T>)
        for (std::size_t k = 0; k < batch_size<T>; ++k) to[i + k] = from[i + k];
    };
    const auto repeat = [](T x, std::size_t count, T* to) {
      for (std::size_t i = 0; i < count; i += batch_size<T>)
        for (std::size_t k = 0; k < batch_size<T>; ++k) to[i + k] = x;
    };
    const std::size_t padded = (width + batch_size<T> - 1) / batch_size<T> * batch_size<T>;
    for (std::size_t i = 0; i < padded; ++i) columns_u_[i] = points.column(std::min(i, width - 1));
    prepare(call_.surface.u, columns_u_.data(), padded, sine_u_.data(), cosine_u_.data());
    const bool has_ends = linear_v || call_.surface.v == Coordinate::half_turn;
    const auto is_end = [&](std::size_t row) {
      return has_ends && (points.row(row) == T(0) || points.row(row) == T(1));
    };
    std::size_t rows_from = 0, rows_to = 0;  // rows whose sines are computed
    stages_.begin(first);
    for (std::size_t at = first, n = 0; at < last; at += n) {
      std::size_t row = (offset + at) / width, column = (offset + at) % width;
      std::size_t rest = last - at;
      if (is_end(row))
        rest = std::min(rest, width - column);
      else if (row < last_row && is_end(last_row))
        rest = last_row * width - offset - at;
      n = rest < joined_points<T> + batch_size<T> ? rest : joined_points<T>;
      for (std::size_t done = 0; done < n; ++row, column = 0) {
        if (row >= rows_to) {
          rows_from = row;
          rows_to = row + group_size<T>;
          for (std::size_t k = 0; k < group_size<T>; ++k) raw_v_[k] = points.row(std::min(row + k, last_row));
          prepare(call_.surface.v, raw_v_.data(), group_size<T>, sine_v_.data(), cosine_v_.data());
        }
        const std::size_t count = std::min(width - column, n - done), k = row - rows_from;
        copy(column + (linear_u ? columns_u_.data() : sine_u_.data()), count, joined_[0].data() + done);
        if (!linear_u) copy(cosine_u_.data() + column, count, joined_[1].data() + done);
        repeat(linear_v ? raw_v_[k] : sine_v_[k], count, joined_[2].data() + done);
        if (!linear_v) repeat(cosine_v_[k], count, joined_[3].data() + done);
        done += count;
      }
      block(at, n, {joined_[0].data(), joined_[0].data(), joined_[1].data()},
            {joined_[2].data(), joined_[2].data(), joined_[3].data()});
    }
    stages_.end();
  }

  // Rows with fewer points than a kernel requires are evaluated like arrays.
  void short_rows(std::size_t first, std::size_t last) {
    work_.in_domain = false;
    stages_.begin(first);
    for (std::size_t at = first; at < last;) {
      const std::size_t rest = last - at, n = rest < block_points + batch_size<T> ? rest : block_points;
      for (std::size_t i = 0; i < n + group_size<T>; ++i) {
        const auto [u, v] = call_.points[at + std::min(i, n - 1)];
        raw_u_[i] = u;
        raw_v_[i] = v;
      }
      block(at, n, {raw_u_.data()}, {raw_v_.data()});
      at += n;
    }
    stages_.end();
  }

  void one_by_one(std::size_t first, std::size_t last) {
    for (std::size_t at = first; at < last; ++at) {
      stages_.place(at);
      statuses_.set(0, Status::regular);
      fallback_(at, 0, 1);
      statuses_.note(at, 1, true);
    }
    statuses_.summary.points += last - first;
  }

  // Prefetches the next block while this one is evaluated.
  void prefetch(const T* from, std::size_t at, std::size_t last) const {
    const std::ptrdiff_t stride = call_.points.stride();
    const char* source = reinterpret_cast<const char*>(from);
    const char* end = source + stride * static_cast<std::ptrdiff_t>(std::min(at + block_points, last));
    const std::ptrdiff_t step = std::max(stride, static_cast<std::ptrdiff_t>(line));
    for (source += stride * static_cast<std::ptrdiff_t>(std::min(at, last)); source < end; source += step)
      __builtin_prefetch(source);
  }

  // The n values from `at` on, and the last again to the end of a group.
  void fill(std::array<T, block_room<T>>& to, const T* from, std::size_t at, std::size_t n) const {
    const std::ptrdiff_t stride = call_.points.stride();
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
    for (std::size_t done = 0; done < n; done += work_.count) {
      work_first_ = at + done;
      work_.count = n - done;
      if (call_.direct) {
        const std::size_t odd = call_.to_line(work_first_);
        work_.past_caches = odd == 0;
        if (odd > 0 && work_.count >= odd + 2 * group_size<T>) work_.count = odd + group_size<T>;
      } else if (call_.on_stages() && work_.count >= staged_points<T> + batch_size<T>) {
        work_.count = staged_points<T>;
      }
      work_.u = u.from(done);
      work_.v = v.from(done);
      stages_.place(work_first_);
      bool any = true;
      if (work_.count < batch_size<T>)
        fallback_(work_first_, 0, work_.count);
      else
        any = call_.kernel.run(work_);
      statuses_.note(work_first_, work_.count, any);
      if (call_.on_stages()) stages_.pass_on(work_.count);
    }
    statuses_.summary.points += n;
  }

  const Call<T>& call_;
  kernels::Work<T> work_;
  std::array<kernels::Run<T>, all_components> runs_;
  Stages<T> stages_;
  Statuses<T> statuses_;
  ScalarFallback<T> fallback_;
  std::size_t work_first_ = 0;  // index of the first point of the work
  alignas(line) std::array<T, all_components * batch_size<T>> tile_;
  alignas(line) std::array<T, block_room<T>> raw_u_, raw_v_;
  alignas(line) std::array<T, group_size<T>> sine_v_, cosine_v_;
  alignas(line) std::array<T, most_columns<T> + batch_size<T>> columns_u_, sine_u_, cosine_u_;
  // Joined rows: sines and cosines of u and v; for linear coordinates, values in place of sines.
  alignas(line) std::array<std::array<T, joined_points<T> + 2 * batch_size<T>>, 4> joined_;
};

}  // namespace darboux::evaluation
