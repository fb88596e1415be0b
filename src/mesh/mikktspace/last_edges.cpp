// The order in which the original MikkTSpace leaves the edges that it forgets to sort.
//
// MikkTSpace finds neighbours by sorting all edges: first by their smaller vertex, then each run of equal
// smaller vertices by the greater one, then each run of equal edges by triangle. Its loops miss the last run
// at every level. So the edges with the greatest smaller vertex stay as the first sort left them, and equal
// ones that do not lie side by side there do not find each other.
//
// To give the same bits, this file follows the original where that matters: the corner by which it identifies
// each welded vertex (its representative), because the sort compares these; and the path of its quicksort to
// the last run.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
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

// A corner and its position.
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

// The order in which the original has the corners of a cell. It halves the cell across its longest side,
// repeatedly, until the remaining corners are at one position or adjacent. Halving swaps corners below the
// middle with those that are not, from both ends inwards. leaf(begin, end) is called for each part in order
// of position.
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

// The corners of all triangles, sorted into the cells. The entries to search are the corners or, if
// by_vertex, the vertices, of which there are fewer; that requires their corners to be listed and in order.
class Cells {
 public:
  Cells(Connectivity& mesh, bool by_vertex)
      : mesh_(mesh),
        by_vertex_(by_vertex),
        entries_(by_vertex_ ? mesh.ids_ : 3 * mesh.all_),
        blocks_((entries_ + block - 1) / block) {
    std::size_t some = 0;
    while (by_vertex_ && mesh.corners_at(static_cast<Index>(some)).empty()) ++some;
    std::vector<Box> boxes(blocks_, point(some));
    in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
      Box box = boxes[b];
      for (std::size_t e = begin; e < end; ++e)
        if (is_there(e)) box.add(point(e));
      boxes[b] = box;
    });
    Box box = boxes[0];
    for (const Box& other : boxes) box.add(other);
    axis_ = box.longest();
    low_ = box.low[axis_];
    high_ = box.high[axis_];
  }

  std::size_t axis() const { return axis_; }
  // The cell of a coordinate along the axis; 0 also in a flat mesh.
  std::size_t at(float x) const {
    const float at = place(x);
    return at >= 0 ? at < cell_count ? static_cast<std::size_t>(at) : cell_count - 1 : 0;
  }

  // A counting sort of the entries of the requested cells; within a cell they keep their order.
  void sort(const std::vector<std::uint8_t>& asked) {
    // The requested entries, block by block.
    const std::span<Index> hits = reused<Index>(mesh_.scratch_, entries_);
    std::vector<std::size_t> hits_of(blocks_);
    std::vector<Index> next(blocks_ * cell_count, 0);  // per block and cell: a count, then where they go
    // Most entries are before or after all requested cells.
    const auto is_asked = [](std::uint8_t x) { return x != 0; };
    const auto first_asked = std::find_if(asked.begin(), asked.end(), is_asked) - asked.begin(),
               past_asked = asked.rend() - std::find_if(asked.rbegin(), asked.rend(), is_asked);
    constexpr float infinite = std::numeric_limits<float>::infinity();
    const float from = first_asked == 0 ? -infinite : static_cast<float>(first_asked),
                to = past_asked == cell_count ? infinite : static_cast<float>(past_asked);
    in_blocks([&](std::size_t b, std::size_t begin, std::size_t end) {
      std::size_t hit = begin;
      for (std::size_t four = begin; four < end; four += 4) {
        const std::size_t count = std::min<std::size_t>(4, end - four);
        Floats x{};
        for (std::size_t k = 0; k < count; ++k)
          x[k] = is_there(four + k) ? position(four + k)[axis_] : std::numeric_limits<float>::quiet_NaN();
        const Floats places = place(x);
        const auto outside = (places < from) | (places >= to);
        if ((outside[0] & outside[1] & outside[2] & outside[3]) != 0) continue;
        for (std::size_t e = four; e < four + count; ++e) {
          if (!is_there(e)) continue;
          const std::size_t cell = at(position(e)[axis_]);
          if (asked[cell] == 0) continue;
          hits[hit++] = static_cast<Index>(e);
          next[b * cell_count + cell] += static_cast<Index>(count_of(e));
        }
      }
      hits_of[b] = hit - begin;
    });
    std::size_t sum = 0;
    for (std::size_t cell = 0; cell < cell_count; ++cell) {
      first_[cell] = sum;
      for (std::size_t b = 0; b < blocks_; ++b)
        sum += std::exchange(next[b * cell_count + cell], static_cast<Index>(sum));
    }
    first_[cell_count] = sum;
    sorted_ = mesh_.memory_.take<Entry>(sum);
    in_blocks([&](std::size_t b, std::size_t begin, std::size_t) {
      for (const Index e : hits.subspan(begin, hits_of[b])) {
        const float* p = position(e);
        Index& to = next[b * cell_count + at(p[axis_])];
        const auto add = [&](std::size_t corner) {
          sorted_[to++] = {{p[0], p[1], p[2]}, static_cast<Index>(corner)};
        };
        if (!by_vertex_)
          add(mesh_.listed(e));
        else
          for (const Index corner : mesh_.corners_at(e)) add(corner);
      }
    });
    if (by_vertex_)
      for (std::size_t cell = 0; cell < cell_count; ++cell)
        if (asked[cell] != 0) std::ranges::sort((*this)[cell], {}, &Entry::corner);
  }
  std::span<Entry> operator[](std::size_t cell) {
    return {sorted_.data() + first_[cell], first_[cell + 1] - first_[cell]};
  }

 private:
  static constexpr std::size_t block = 1 << 16;

  // Along the axis, in cells.
  template <class X>
  X place(const X& x) const {
    return static_cast<float>(cell_count) * ((x - low_) / (high_ - low_));
  }
  const float* position(std::size_t entry) const {
    const Index v = by_vertex_ ? mesh_.stands_for_[entry] : mesh_.vertex(mesh_.listed(entry));
    return &mesh_.mesh_.positions[3 * std::size_t{v}];
  }
  // Some ids are not used.
  bool is_there(std::size_t entry) const { return !by_vertex_ || count_of(entry) > 0; }
  std::size_t count_of(std::size_t entry) const {
    return by_vertex_ ? mesh_.begin_[entry + 1] - mesh_.begin_[entry] : 1;
  }
  Box point(std::size_t entry) const {
    const float* p = position(entry);
    return Box(Floats{p[0], p[1], p[2], 0});
  }
  // Calls f(block, begin, end). All passes use the same blocks, so that the entries of a cell stay in order.
  template <class F>
  void in_blocks(const F& f) const {
    parallel_ranges(
        blocks_, mesh_.threads_,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t b = begin; b < end; ++b) f(b, b * block, std::min(entries_, (b + 1) * block));
        },
        1);
  }

  Connectivity& mesh_;
  bool by_vertex_;
  std::size_t entries_, blocks_, axis_ = 0;
  float low_ = 0, high_ = 0;
  std::array<std::size_t, cell_count + 1> first_{};
  std::span<Entry> sorted_;
};

struct KeyedEdge {
  Index key, edge;  // its smaller representative; the corner where it begins
};

// The original's first sort, a quicksort with pivots from its own random numbers, followed only as far as it
// leads to the run of the greatest key.
void sort_as_the_original(std::span<KeyedEdge> edges, Index greatest) {
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
      if (edges[begin].key > edges[end].key) std::swap(edges[begin], edges[end]);
      continue;
    }
    seed += std::rotl(seed, static_cast<int>(seed & 31U)) + 3;
    const Index pivot =
        edges[begin + static_cast<std::ptrdiff_t>(seed % static_cast<std::uint32_t>(end - begin + 1))].key;
    std::ptrdiff_t left = begin, right = end;
    do {
      while (edges[left].key < pivot) ++left;
      while (edges[right].key > pivot) --right;
      if (left <= right) std::swap(edges[left++], edges[right--]);
    } while (left <= right);
    if (pivot == greatest && begin < right) parts.push_back({begin, right, seed});
    if (left < end) parts.push_back({left, end, seed});
  }
}

}  // namespace

// The representatives of the requested ids, or of all: the first corner of each in the original's order.
void Connectivity::find_representatives(std::span<const Index> wanted) {
  if (representative_.empty()) representative_ = memory_.take<Index>(ids_);
  std::ranges::fill(representative_, none);
  if (all_ == 0) return;
  // Few cells will be requested, and sorting them costs little.
  const bool by_vertex = !wanted.empty() && wanted.size() < cell_count / 16 && corner_.empty();
  Cells cells(*this, by_vertex);
  std::vector<std::uint8_t> asked(cell_count, wanted.empty() ? 1 : 0);
  for (const Index id : wanted)
    asked[cells.at(mesh_.positions[3 * std::size_t{stands_for_[id]} + cells.axis()])] = 1;
  cells.sort(asked);
  parallel_ranges(
      cell_count, threads_,
      [&](std::size_t begin, std::size_t end) {
        Halving halve;
        for (std::size_t cell = begin; cell < end; ++cell) {
          const std::span<Entry> entries = cells[cell];
          if (entries.empty()) continue;
          halve(entries, [&](Index leaf, Index leaf_end) {
            for (Index i = leaf; i < leaf_end; ++i)
              if (Index& first = representative_[id_[vertex(entries[i].corner)]]; first == none)
                first = entries[i].corner;
          });
        }
      },
      16);
}

// Zeros of both signs are equal, so the representative decides the signs of a vertex's zeros.
void Connectivity::take_values_of_representatives() {
  if (!mixed_zeros_) return;
  find_representatives({});
  for (std::size_t id = 0; id < representative_.size(); ++id)
    if (representative_[id] != none) stands_for_[id] = vertex(representative_[id]);
}

// The first and the last corner of each id, which bound its representative, if triangles are not in order.
void Connectivity::bound_representatives(std::span<Index> first, std::span<Index> last) const {
  std::ranges::fill(first, none);
  std::ranges::fill(last, 0);
  for (std::size_t e = 0; e < 3 * all_; ++e) {
    const std::size_t c = listed(e);
    const Index id = id_[vertex(c)];
    first[id] = std::min(first[id], static_cast<Index>(c));
    last[id] = std::max(last[id], static_cast<Index>(c));
  }
}

// The edges that may be in the last run; also computes their representatives where bounds do not suffice.
std::vector<Index> Connectivity::candidates_for_the_last_run() {
  const bool in_order = corner_.empty();
  std::span<Index> firsts, lasts;
  if (!in_order) {
    firsts = memory_.take<Index>(ids_), lasts = memory_.take<Index>(ids_);
    bound_representatives(firsts, lasts);
  }
  const auto first = [&](Index id) { return in_order ? corners_at(id).front() : firsts[id]; };
  const auto last = [&](Index id) { return in_order ? corners_at(id).back() : lasts[id]; };
  // The greatest of the smaller representatives of a triangle's edges is the median of its three
  // representatives. In order, none of these is after the triangle's last corner.
  Index bound = 0;
  for (std::size_t t = good_; t-- > 0 && !(in_order && 3 * t + 2 <= bound);) {
    const Index a = first(welded(3 * t)), b = first(welded(3 * t + 1)), c = first(welded(3 * t + 2));
    bound = std::max(bound, std::max(std::min(a, b), std::min(std::max(a, b), c)));
  }
  const auto may_be_last = [&](Index id) { return last(id) >= bound; };
  std::vector<Index> candidates;
  for (std::size_t at = in_order ? bound : 0; at < 3 * good_; ++at) {
    const Index id = welded(at);
    if (corners_at(id).back() != at || !may_be_last(id)) continue;  // each id once
    for (const Index edge : corners_at(id))
      if (may_be_last(welded(next(edge)))) candidates.push_back(edge);
  }
  std::vector<Index> wanted;
  for (const Index e : candidates)
    for (const Index id : {welded(e), welded(next(e))})
      if (first(id) != last(id)) wanted.push_back(id);
  if (!representative_.empty()) return candidates;
  if (wanted.empty())
    representative_ = memory_.take<Index>(ids_);
  else
    find_representatives(wanted);
  for (const Index e : candidates)  // the others have one corner only
    for (const Index id : {welded(e), welded(next(e))})
      if (first(id) == last(id)) representative_[id] = first(id);
  return candidates;
}

void Connectivity::find_last_edges() {
  const std::vector<Index> candidates = candidates_for_the_last_run();
  const auto smaller = [&](std::size_t edge) {
    return std::min(representative_[welded(edge)], representative_[welded(next(edge))]);
  };
  const auto greater = [&](Index edge) {
    return std::max(representative_[welded(edge)], representative_[welded(next(edge))]);
  };
  Index greatest = 0;
  for (const Index e : candidates) greatest = std::max(greatest, smaller(e));
  std::vector<Index> run, others;
  for (const Index e : candidates)
    if (smaller(e) == greatest) run.push_back(e), others.push_back(greater(e));
  // The order matters only among three or more edges, two of which are equal.
  std::sort(others.begin(), others.end());
  if (run.size() < 3 || std::adjacent_find(others.begin(), others.end()) == others.end()) return;

  if (!mixed_zeros_) find_representatives({});
  const std::span<KeyedEdge> edges = reused<KeyedEdge>(scratch_, 3 * good_);
  parallel_ranges(edges.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) edges[e] = {smaller(e), static_cast<Index>(e)};
  });
  sort_as_the_original(edges, greatest);
  for (std::size_t i = 0; i < run.size(); ++i) run[i] = edges[edges.size() - run.size() + i].edge;
  std::vector<Index> across(run.size(), none);
  std::vector<std::uint8_t> taken;
  for (std::size_t i = 0, j; i < run.size(); i = j) {
    for (j = i; j < run.size() && greater(run[j]) == greater(run[i]);) ++j;
    if (j < run.size())
      std::sort(run.begin() + static_cast<std::ptrdiff_t>(i), run.begin() + static_cast<std::ptrdiff_t>(j));
    pair_up(
        j - i, [&](std::size_t k) { return welded(run[i + k]) < welded(next(run[i + k])); },
        [&](std::size_t k, std::size_t l) {
          across[i + k] = run[i + l] / 3;
          across[i + l] = run[i + k] / 3;
        },
        taken);
  }
  for (std::size_t i = 0; i < run.size(); ++i) {
    last_edges_.push_back({run[i], across[i]});
    last_ids_.insert(last_ids_.end(), {welded(run[i]), welded(next(run[i]))});
  }
  std::ranges::sort(last_edges_, {}, &LastEdge::at);
  std::ranges::sort(last_ids_);
}

bool Connectivity::is_at_last_edge(Index id) const {
  return !last_ids_.empty() && std::ranges::binary_search(last_ids_, id);
}

void Connectivity::link_last_edges(Index id, Links& x) const {
  const std::span<const Index> corners = corners_at(id);
  const auto link = [&](Index edge, Index& place) {
    const auto found = std::ranges::lower_bound(last_edges_, edge, {}, &LastEdge::at);
    if (found == last_edges_.end() || found->at != edge) return;
    place = found->neighbour == none ? none : place_at(id, corner_at(id, found->neighbour));
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    link(corners[i], x.after[i]);
    link(static_cast<Index>(previous(corners[i])), x.before[i]);
  }
}

}  // namespace darboux::mikk
