// The original names welded vertices by one of their corners, sorts the edges by the smaller name, the runs of equal ones by
// the greater, and the runs of equal edges by triangle; but it forgets the last run of each. So which of the last edges find
// each other depends on the order that its first sort leaves, and that on the names. This is followed here as far as it
// matters.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "connectivity.h"

namespace darboux::mikk {
namespace {

// Cells are slabs across the longest side of the mesh, in which the original looks for equal vertices.
constexpr std::size_t cell_count = 2048;

// A corner, and where it is.
struct alignas(16) Entry {
  std::array<float, 3> p;
  Index corner;
};

struct Box {
  std::array<float, 3> low, high;

  explicit Box(const std::array<float, 3>& p) : low(p), high(p) {}
  void add(const std::array<float, 3>& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = p[k] < low[k] ? p[k] : low[k];
      high[k] = high[k] < p[k] ? p[k] : high[k];
    }
  }
  std::size_t longest() const {
    const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return y > x && y > z ? 1 : z > x ? 2 : 0;
  }
};

// What halving a cell does, again and again until all that is left of a part is in one place or next to each other: those
// below the middle change places with those that are not, from both ends inwards. leaf(begin, end) in the order of the places.
class Halving {
 public:
  template <class Leaf>
  void operator()(std::span<Entry> cell, const Leaf& leaf) {
    parts_.assign(1, {0, cell.size()});
    while (!parts_.empty()) {
      const auto [begin, end] = parts_.back();
      parts_.pop_back();
      Box box(cell[begin].p);
      for (std::size_t i = begin + 1; i < end; ++i) box.add(cell[i].p);
      const std::size_t axis = box.longest();
      const float low = box.low[axis], high = box.high[axis], middle = 0.5F * (high + low);
      if (middle >= high || middle <= low) {
        leaf(begin, end);
        continue;
      }
      std::size_t below = 0;
      for (std::size_t i = begin; i < end; ++i) below += cell[i].p[axis] < middle ? 1 : 0;
      const std::size_t split = begin + below;
      left_.resize(end - begin), right_.resize(end - begin);
      std::size_t lefts = 0, rights = 0;
      for (std::size_t i = begin; i < split; ++i) {
        left_[lefts] = i;
        lefts += cell[i].p[axis] < middle ? 0 : 1;
      }
      for (std::size_t i = end; i-- > split;) {
        right_[rights] = i;
        rights += cell[i].p[axis] < middle ? 1 : 0;
      }
      for (std::size_t i = 0; i < lefts; ++i) std::swap(cell[left_[i]], cell[right_[i]]);
      parts_.push_back({split, end});
      parts_.push_back({begin, split});
    }
  }

 private:
  std::vector<std::pair<std::size_t, std::size_t>> parts_;
  std::vector<std::size_t> left_, right_;  // those on the wrong side
};

}  // namespace

// Names of the ids: the first corner in the order in which halving a cell, again and again, leaves them.
void Connectivity::name(std::span<Index> names) {
  std::fill(names.begin(), names.end(), none);
  const std::size_t entries = 3 * all_;
  if (entries == 0) return;
  const auto place = [&](std::size_t corner) {
    const float* p = &mesh_.positions[3 * std::size_t{vertex(corner)}];
    return std::array<float, 3>{p[0], p[1], p[2]};
  };
  // Work is cut into the same blocks for all passes, so that the entries of a cell stay in order.
  constexpr std::size_t block = 1 << 16;
  const std::size_t blocks = (entries + block - 1) / block;
  const auto in_blocks = [&](const auto& f) {
    in_pieces(
        blocks, threads_,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t b = begin; b < end; ++b) f(b, b * block, std::min(entries, (b + 1) * block));
        },
        1);
  };
  std::vector<Box> boxes(blocks, Box(place(listed(0))));
  in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
    Box box = boxes[b];
    for (std::size_t e = begin; e < end; ++e) box.add(place(listed(e)));
    boxes[b] = box;
  });
  Box box = boxes[0];
  for (const Box& other : boxes) box.add(other.low), box.add(other.high);
  const std::size_t axis = box.longest();
  const float low = box.low[axis], high = box.high[axis];
  const auto cell_of = [&](float x) {
    const float at = cell_count * ((x - low) / (high - low));
    return at >= 0 ? at < cell_count ? static_cast<std::size_t>(at) : cell_count - 1
                   : 0;  // 0 of a flat mesh too
  };
  std::vector<Index> next(blocks * cell_count, 0);  // of each block and cell: its entries, then where they go
  in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e)
      ++next[b * cell_count + cell_of(mesh_.positions[3 * std::size_t{vertex(listed(e))} + axis])];
  });
  std::array<std::size_t, cell_count + 1> first;
  std::size_t sum = 0;
  for (std::size_t cell = 0; cell < cell_count; ++cell) {
    first[cell] = sum;
    for (std::size_t b = 0; b < blocks; ++b)
      sum += std::exchange(next[b * cell_count + cell], static_cast<Index>(sum));
  }
  first[cell_count] = sum;
  const std::span<Entry> all = room_.as<Entry>(entries);
  in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const std::size_t c = listed(e);
      const std::array<float, 3> p = place(c);
      all[next[b * cell_count + cell_of(p[axis])]++] = {p, static_cast<Index>(c)};
    }
  });
  in_pieces(
      cell_count, threads_,
      [&](std::size_t begin, std::size_t end) {
        Halving halve;
        for (std::size_t cell = begin; cell < end; ++cell) {
          if (first[cell] == first[cell + 1]) continue;
          const std::span<Entry> of_cell = all.subspan(first[cell], first[cell + 1] - first[cell]);
          halve(of_cell, [&](std::size_t leaf, std::size_t leaf_end) {
            for (std::size_t i = leaf; i < leaf_end; ++i)
              if (Index& name = names[id_[vertex(of_cell[i].corner)]]; name == none) name = of_cell[i].corner;
          });
        }
      },
      16);
}

// Zeros of either sign are equal, so that the name decides whose signs a vertex has.
void Connectivity::name_as_the_original() {
  if (!negative_zeros_) return;
  Buffer<Index> names(stands_for_.size());
  name({names.data(), names.size()});
  for (std::size_t id = 0; id < names.size(); ++id)
    if (names[id] != none) stands_for_[id] = vertex(names[id]);
}

void Connectivity::find_last_neighbours() {
  const std::size_t ids = stands_for_.size(), edges_count = 3 * good_;
  // The last run by the smaller name: bounds first, then names where these leave it open.
  Buffer<Index> first(ids), last(ids);
  if (corner_.empty()) {
    in_pieces(ids, threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t id = begin; id < end; ++id) {
        const std::span<const Index> corners = corners_at(static_cast<Index>(id));
        first[id] = corners.empty() ? none : corners.front();
        last[id] = corners.empty() ? 0 : corners.back();
      }
    });
  } else {
    std::fill(first.data(), first.data() + ids, none);
    std::fill(last.data(), last.data() + ids, 0);
    for (std::size_t e = 0; e < 3 * all_; ++e) {
      const std::size_t c = listed(e);
      const Index id = id_[vertex(c)];
      first[id] = std::min(first[id], static_cast<Index>(c));
      last[id] = std::max(last[id], static_cast<Index>(c));
    }
  }
  const auto smaller = [&](const Buffer<Index>& names, std::size_t edge) {
    return std::min(names[welded(edge)], names[welded(next(edge))]);
  };
  std::mutex mutex;
  Index bound = 0;
  in_pieces(edges_count, threads_, [&](std::size_t begin, std::size_t end) {
    Index here = 0;
    for (std::size_t e = begin; e < end; ++e) here = std::max(here, smaller(first, e));
    const std::lock_guard lock(mutex);
    bound = std::max(bound, here);
  });
  std::vector<Index> open;
  in_pieces(edges_count, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e)
      if (smaller(last, e) >= bound) {
        const std::lock_guard lock(mutex);
        open.push_back(static_cast<Index>(e));
      }
  });
  const bool ambiguous = std::any_of(open.begin(), open.end(), [&](Index e) {
    const Index a = welded(e), b = welded(next(e));
    return first[a] != last[a] || first[b] != last[b];
  });
  Buffer<Index> names = std::move(first);
  if (ambiguous) name({names.data(), ids});
  Index greatest = 0;
  for (const Index e : open) greatest = std::max(greatest, smaller(names, e));
  std::vector<Index> run;
  for (const Index e : open)
    if (smaller(names, e) == greatest) run.push_back(e);
  const auto other = [&](Index edge) { return std::max(names[welded(edge)], names[welded(next(edge))]); };
  // Two edges find each other in any order, and so does none.
  std::vector<Index> others;
  for (const Index e : run) others.push_back(other(e));
  std::sort(others.begin(), others.end());
  if (run.size() < 3 || std::adjacent_find(others.begin(), others.end()) == others.end()) return;
  if (!ambiguous) name({names.data(), ids});
  // The original's first sort, of which only what leads to the last run is followed.
  struct Edge {
    Index name, edge;
  };
  const std::span<Edge> edges = room_.as<Edge>(edges_count);
  in_pieces(edges_count, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) edges[e] = {smaller(names, e), static_cast<Index>(e)};
  });
  struct Part {
    std::ptrdiff_t first, last;
    std::uint32_t seed;
  };
  std::vector<Part> parts{{0, static_cast<std::ptrdiff_t>(edges.size()) - 1, 39871946}};
  while (!parts.empty()) {
    auto [begin, end, seed] = parts.back();
    parts.pop_back();
    if (end - begin < 1) continue;
    if (end - begin == 1) {
      if (edges[begin].name > edges[end].name) std::swap(edges[begin], edges[end]);
      continue;
    }
    seed += std::rotl(seed, static_cast<int>(seed & 31U)) + 3;
    const Index pivot =
        edges[begin + static_cast<std::ptrdiff_t>(seed % static_cast<std::uint32_t>(end - begin + 1))].name;
    std::ptrdiff_t left = begin, right = end;
    do {
      while (edges[left].name < pivot) ++left;
      while (edges[right].name > pivot) --right;
      if (left <= right) std::swap(edges[left++], edges[right--]);
    } while (left <= right);
    if (pivot == greatest && begin < right) parts.push_back({begin, right, seed});
    if (left < end) parts.push_back({left, end, seed});
  }
  for (std::size_t i = 0; i < run.size(); ++i) run[i] = edges[edges.size() - run.size() + i].edge;
  const auto same = [&](std::size_t i, std::size_t j) { return other(run[i]) == other(run[j]); };
  for (std::size_t i = 0, j; i < run.size(); i = j) {
    for (j = i; j < run.size() && same(i, j);) ++j;
    if (j < run.size())
      std::sort(run.begin() + static_cast<std::ptrdiff_t>(i), run.begin() + static_cast<std::ptrdiff_t>(j));
  }
  for (const Index e : run) neighbour_[e] = none;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (neighbour_[run[i]] != none) continue;
    for (std::size_t j = i + 1; j < run.size() && same(i, j); ++j)
      if (neighbour_[run[j]] == none && welded(run[j]) == welded(next(run[i]))) {
        neighbour_[run[i]] = run[j] / 3;
        neighbour_[run[j]] = run[i] / 3;
        break;
      }
  }
}

}  // namespace darboux::mikk
