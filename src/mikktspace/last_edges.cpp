// The original names welded vertices by one of their corners, sorts the edges by the smaller name, the runs of equal ones by
// the greater, and the runs of equal edges by triangle; but it forgets the last run of each. So which of the last edges find
// each other depends on the order that its first sort leaves, and that on the names. This is followed here as far as it
// matters.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "connectivity.h"

namespace darboux::mikk {
namespace {

// Cells are slabs across the longest side of the mesh, in which the original looks for equal vertices.
struct Cells {
  static constexpr int count = 2048;
  int axis = 0;
  float low = 0, high = 0;
  std::size_t of(const Vector& p) const {
    const float place = count * ((component(p, axis) - low) / (high - low));
    return place >= 0 ? place < count ? static_cast<std::size_t>(place) : count - 1
                      : 0;  // 0 of a flat mesh too
  }
  static float component(const Vector& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }
  static int longest(const Vector& d) { return d.y > d.x && d.y > d.z ? 1 : d.z > d.x ? 2 : 0; }
};

}  // namespace

// Names of the vertices wanted, or of all, and of others: the first corner in the order in which halving a cell, again and
// again, leaves them.
void Connectivity::name(const std::vector<std::uint8_t>* wanted, std::vector<Index>& names) const {
  const std::size_t entries = 3 * all_;
  if (entries == 0) return;
  Vector low = position(vertex(listed(0))), high = low;
  for (std::size_t e = 1; e < entries; ++e) {
    const Vector p = position(vertex(listed(e)));
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Cells cells;
  cells.axis = Cells::longest(high - low);
  cells.low = Cells::component(low, cells.axis);
  cells.high = Cells::component(high, cells.axis);
  std::vector<std::uint8_t> looked_at(Cells::count, wanted == nullptr ? 1 : 0);
  for (std::size_t v = 0; wanted != nullptr && v < wanted->size(); ++v)
    if ((*wanted)[v] != 0) looked_at[cells.of(position(static_cast<Index>(v)))] = 1;
  std::vector<std::vector<Index>> members(Cells::count);
  for (std::size_t e = 0; e < entries; ++e)
    if (const std::size_t cell = cells.of(position(vertex(listed(e)))); looked_at[cell] != 0)
      members[cell].push_back(static_cast<Index>(e));
  struct Entry {
    Vector p;
    Index entry;
  };
  in_pieces(
      Cells::count, threads_,
      [&](std::size_t begin, std::size_t end) {
        std::vector<Entry> x;
        std::vector<std::pair<std::ptrdiff_t, std::ptrdiff_t>> parts;
        for (std::size_t cell = begin; cell < end; ++cell) {
          x.clear();
          for (const Index e : members[cell]) x.push_back({position(vertex(listed(e))), e});
          parts.assign(1, {0, static_cast<std::ptrdiff_t>(x.size()) - 1});
          while (!parts.empty()) {
            const auto [first, last] = parts.back();
            parts.pop_back();
            if (first > last) continue;
            Vector lowest = x[first].p, highest = lowest;
            for (std::ptrdiff_t i = first + 1; i <= last; ++i) {
              const Vector& p = x[i].p;
              lowest = {std::min(lowest.x, p.x), std::min(lowest.y, p.y), std::min(lowest.z, p.z)};
              highest = {std::max(highest.x, p.x), std::max(highest.y, p.y), std::max(highest.z, p.z)};
            }
            const int axis = Cells::longest(highest - lowest);
            const float a = Cells::component(lowest, axis), b = Cells::component(highest, axis);
            const float middle = 0.5F * (b + a);
            if (middle >= b || middle <= a) {  // all in one place, or next to each other
              for (std::ptrdiff_t i = first; i <= last; ++i) {
                const std::size_t c = listed(x[i].entry);
                Index& name = names[same_as_[vertex(c)]];
                if (name == none) name = static_cast<Index>(c);
              }
              continue;
            }
            const auto below = [&](std::ptrdiff_t i) { return Cells::component(x[i].p, axis) < middle; };
            std::ptrdiff_t left = first, right = last;
            while (left < right) {
              while (left < right && below(left)) ++left;
              while (left < right && !below(right)) --right;
              if (left < right) std::swap(x[left++], x[right--]);
            }
            if (left == right) below(right) ? ++left : --right;
            if (left < last + 1) parts.push_back({left, last});
            if (first <= right) parts.push_back({first, right});
          }
        }
      },
      16);
}

// Zeros of either sign are equal, so that the name decides whose signs a vertex has.
void Connectivity::name_as_the_original() {
  if (!negative_zeros_) return;
  std::vector<Index> names(mesh_.vertex_count(), none);
  name(nullptr, names);
  for (Index& v : same_as_)
    if (names[v] != none) v = vertex(names[v]);
}

void Connectivity::find_last_neighbours() {
  // The last run by the smaller name: bounds first, then names where these leave it open.
  std::vector<Index> first(mesh_.vertex_count(), none), last(mesh_.vertex_count(), 0);
  for (std::size_t e = 0; e < 3 * all_; ++e) {
    const std::size_t c = listed(e);
    const Index v = same_as_[vertex(c)];
    first[v] = std::min(first[v], static_cast<Index>(c));
    last[v] = std::max(last[v], static_cast<Index>(c));
  }
  const auto smaller = [&](const std::vector<Index>& names, std::size_t edge) {
    return std::min(names[welded(edge)], names[welded(next(edge))]);
  };
  Index bound = 0;
  for (std::size_t e = 0; e < 3 * good_; ++e) bound = std::max(bound, smaller(first, e));
  std::vector<Index> open;
  for (std::size_t e = 0; e < 3 * good_; ++e)
    if (smaller(last, e) >= bound) open.push_back(static_cast<Index>(e));
  std::vector<std::uint8_t> wanted(mesh_.vertex_count(), 0);
  bool ambiguous = false;
  for (const Index e : open)
    for (const Index v : {welded(e), welded(next(e))}) {
      wanted[v] = 1;
      ambiguous = ambiguous || first[v] != last[v];
    }
  std::vector<Index> names;
  if (ambiguous) {
    names.assign(mesh_.vertex_count(), none);
    name(&wanted, names);
  } else {
    names = first;
  }
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
  if (ambiguous) name(nullptr, names);
  // The original's first sort, of which only what leads to the last run is followed.
  struct Edge {
    Index name, edge;
  };
  std::vector<Edge> edges(3 * good_);
  for (std::size_t e = 0; e < edges.size(); ++e) edges[e] = {smaller(names, e), static_cast<Index>(e)};
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
