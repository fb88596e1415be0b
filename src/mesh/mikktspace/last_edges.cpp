// The original names welded vertices by one of their corners, sorts the edges by the smaller name, the runs
// of equal ones by the greater, and the runs of equal edges by triangle; but it forgets the last run of each.
// So which of the last edges find each other depends on the order that its first sort leaves, and that on the
// names. This is followed here as far as it matters.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "connectivity.h"

namespace darboux::mikk {
namespace {

// Cells are slabs across the longest side of the mesh, in which the original looks for equal vertices.
constexpr std::size_t cell_count = 2048;

using Floats = float __attribute__((vector_size(16)));

// A corner, and where it is.
struct alignas(16) Entry {
  std::array<float, 3> p;
  Index corner;
};

struct Box {
  Floats low, high;  // the fourth numbers mean nothing

  explicit Box(const Floats& p) : low(p), high(p) {}
  void add(const Box& other) {
    low = other.low < low ? other.low : low;
    high = high < other.high ? other.high : high;
  }
  std::size_t longest() const {
    const Floats d = high - low;
    return d[1] > d[0] && d[1] > d[2] ? 1 : d[2] > d[0] ? 2 : 0;
  }
};
Box box_of(std::span<const Entry> entries) {
  const auto at = [&](std::size_t i) {
    Floats p;
    std::memcpy(&p, &entries[i], sizeof p);
    return Box(p);
  };
  std::array<Box, 2> box{at(0), at(0)};
  std::size_t i = 1;
  for (; i + 1 < entries.size(); i += 2) box[0].add(at(i)), box[1].add(at(i + 1));
  if (i < entries.size()) box[0].add(at(i));
  box[0].add(box[1]);
  return box[0];
}

// What halving a cell does, again and again until all that is left of a part is in one place or next to each
// other: those below the middle change places with those that are not, from both ends inwards. leaf(begin,
// end) in the order of the places.
class Halving {
 public:
  template <class Leaf>
  void operator()(std::span<Entry> cell, const Leaf& leaf) {
    if (below_.size() < cell.size())
      below_ = Buffer<Index>(cell.size()), others_ = Buffer<Index>(cell.size());
    parts_.assign(1, {0, static_cast<Index>(cell.size())});
    while (!parts_.empty()) {
      const auto [begin, end] = parts_.back();
      parts_.pop_back();
      const Box box = box_of(cell.subspan(begin, end - begin));
      const std::size_t axis = box.longest();
      const float low = box.low[axis], high = box.high[axis], middle = 0.5F * (high + low);
      if (middle >= high || middle <= low) {
        leaf(begin, end);
        continue;
      }
      Index below = 0, others = 0;
      for (Index i = begin; i < end; ++i) {
        const bool is_below = cell[i].p[axis] < middle;
        below_[below] = others_[others] = i;
        below += is_below ? 1 : 0;
        others += is_below ? 0 : 1;
      }
      const Index split = begin + below;
      for (Index i = 0; others_[i] < split; ++i) std::swap(cell[others_[i]], cell[below_[below - 1 - i]]);
      parts_.push_back({split, end});
      parts_.push_back({begin, split});
    }
  }

 private:
  std::vector<std::pair<Index, Index>> parts_;
  Buffer<Index> below_, others_;  // where they are
};

}  // namespace

// Names of the ids wanted, or of all: the first corner in the order in which halving a cell, again and again,
// leaves them.
void Connectivity::name(std::span<const Index> wanted) {
  if (name_.empty()) name_ = Buffer<Index>(ids_);
  std::fill(name_.data(), name_.data() + name_.size(), none);
  const std::size_t entries = 3 * all_;
  if (entries == 0) return;
  const auto position_of = [&](std::size_t entry) {
    return &mesh_.positions[3 * std::size_t{vertex(listed(entry))}];
  };
  const auto point = [&](std::size_t entry) {
    const float* p = position_of(entry);
    return Box(Floats{p[0], p[1], p[2], 0});
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
  std::vector<Box> boxes(blocks, point(0));
  in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
    Box box = boxes[b];
    for (std::size_t e = begin; e < end; ++e) box.add(point(e));
    boxes[b] = box;
  });
  Box box = boxes[0];
  for (const Box& other : boxes) box.add(other);
  const std::size_t axis = box.longest();
  const float low = box.low[axis], high = box.high[axis];
  const auto cell_of = [&](float x) {
    const float at = cell_count * ((x - low) / (high - low));
    return at >= 0 ? at < cell_count ? static_cast<std::size_t>(at) : cell_count - 1
                   : 0;  // 0 of a flat mesh too
  };
  std::vector<std::uint8_t> looked_at(cell_count, wanted.empty() ? 1 : 0);
  for (const Index id : wanted)
    looked_at[cell_of(mesh_.positions[3 * std::size_t{stands_for_[id]} + axis])] = 1;
  // Behind the entries stand, of each block, those that are looked at.
  const std::span<Index> hits = room_.as<Index>(entries, entries * sizeof(Entry));
  std::vector<std::size_t> hits_of(blocks);
  std::vector<Index> next(blocks * cell_count, 0);  // of each block and cell: its entries, then where they go
  in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
    std::size_t hit = begin;
    for (std::size_t e = begin; e < end; ++e) {
      const std::size_t cell = cell_of(position_of(e)[axis]);
      hits[hit] = static_cast<Index>(e);
      hit += looked_at[cell];
      next[b * cell_count + cell] += looked_at[cell];
    }
    hits_of[b] = hit - begin;
  });
  std::array<std::size_t, cell_count + 1> first;
  std::size_t sum = 0;
  for (std::size_t cell = 0; cell < cell_count; ++cell) {
    first[cell] = sum;
    for (std::size_t b = 0; b < blocks; ++b)
      sum += std::exchange(next[b * cell_count + cell], static_cast<Index>(sum));
  }
  first[cell_count] = sum;
  const std::span<Entry> all = room_.as<Entry>(sum);
  in_blocks([&](std::size_t b, std::size_t begin, std::size_t) {
    for (const Index e : hits.subspan(begin, hits_of[b])) {
      const float* p = position_of(e);
      all[next[b * cell_count + cell_of(p[axis])]++] = {{p[0], p[1], p[2]}, static_cast<Index>(listed(e))};
    }
  });
  in_pieces(
      cell_count, threads_,
      [&](std::size_t begin, std::size_t end) {
        Halving halve;
        for (std::size_t cell = begin; cell < end; ++cell) {
          if (first[cell] == first[cell + 1]) continue;
          const std::span<Entry> of_cell = all.subspan(first[cell], first[cell + 1] - first[cell]);
          halve(of_cell, [&](Index leaf, Index leaf_end) {
            for (Index i = leaf; i < leaf_end; ++i)
              if (Index& name = name_[id_[vertex(of_cell[i].corner)]]; name == none) name = of_cell[i].corner;
          });
        }
      },
      16);
}

// Zeros of either sign are equal, so that the name decides whose signs a vertex has.
void Connectivity::name_as_the_original() {
  if (!mixed_zeros_) return;
  name({});
  for (std::size_t id = 0; id < name_.size(); ++id)
    if (name_[id] != none) stands_for_[id] = vertex(name_[id]);
}

void Connectivity::find_last_neighbours() {
  const std::size_t ids = ids_, edges_count = 3 * good_;
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
  // The greatest of the smaller names of a triangle's edges is the median of its names.
  std::mutex mutex;
  Index bound = 0;
  in_pieces(good_, threads_, [&](std::size_t begin, std::size_t end) {
    Index here = 0;
    for (std::size_t t = begin; t < end; ++t) {
      const Index a = first[welded(3 * t)], b = first[welded(3 * t + 1)], c = first[welded(3 * t + 2)];
      here = std::max(here, std::max(std::min(a, b), std::min(std::max(a, b), c)));
    }
    const std::lock_guard lock(mutex);
    bound = std::max(bound, here);
  });
  std::vector<Index> open;
  const auto may_be_last = [&](Index id) { return last[id] >= bound; };
  for (Index id = 0; id < ids; ++id)
    if (may_be_last(id))
      for (const Index at : corners_at(id))
        if (may_be_last(welded(next(at)))) open.push_back(at);
  std::vector<Index> wanted;
  for (const Index e : open)
    for (const Index id : {welded(e), welded(next(e))})
      if (first[id] != last[id]) wanted.push_back(id);
  if (name_.empty() && wanted.empty()) {
    name_ = std::move(first);
  } else if (name_.empty()) {
    name(wanted);
    for (const Index e : open)  // the others have one name only
      for (const Index id : {welded(e), welded(next(e))})
        if (first[id] == last[id]) name_[id] = first[id];
  }
  Index greatest = 0;
  for (const Index e : open) greatest = std::max(greatest, smaller(name_, e));
  std::vector<Index> run;
  for (const Index e : open)
    if (smaller(name_, e) == greatest) run.push_back(e);
  const auto other = [&](Index edge) { return std::max(name_[welded(edge)], name_[welded(next(edge))]); };
  // Two edges find each other in any order, and so does none.
  std::vector<Index> others;
  for (const Index e : run) others.push_back(other(e));
  std::sort(others.begin(), others.end());
  if (run.size() < 3 || std::adjacent_find(others.begin(), others.end()) == others.end()) return;
  if (!mixed_zeros_) name({});
  // The original's first sort, of which only what leads to the last run is followed.
  struct NamedEdge {
    Index name, edge;
  };
  const std::span<NamedEdge> edges = room_.as<NamedEdge>(edges_count);
  in_pieces(edges_count, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) edges[e] = {smaller(name_, e), static_cast<Index>(e)};
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
  for (const Index e : run) neighbour_[e] = none;
  std::vector<Edge> equal;
  for (std::size_t i = 0, j; i < run.size(); i = j) {
    for (j = i; j < run.size() && other(run[j]) == other(run[i]);) ++j;
    if (j < run.size())
      std::sort(run.begin() + static_cast<std::ptrdiff_t>(i), run.begin() + static_cast<std::ptrdiff_t>(j));
    equal.clear();
    for (std::size_t k = i; k < j; ++k)
      equal.push_back({other(run[k]), run[k], welded(run[k]) < welded(next(run[k]))});
    pair_up(equal);
  }
}

}  // namespace darboux::mikk
