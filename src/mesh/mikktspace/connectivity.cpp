#include "connectivity.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>
#include <vector>

namespace darboux::mikk {

namespace {

// The maximum number of triangles: two per quad.
std::size_t triangles_of(const MikkMesh& mesh) {
  return mesh.face_sizes.empty() ? mesh.corner_count() / 3 : 2 * mesh.face_sizes.size();
}

// The most memory that any step takes.
std::size_t scratch_bytes(const MikkMesh& mesh, std::size_t threads) {
  return std::max({weld_places(mesh.vertex_count()) * sizeof(std::uint64_t),
                   sizeof(Index) * most_ids(mesh.vertex_count(), threads),
                   sizeof(Directions) * triangles_of(mesh)});
}

// Room for everything if no triangle is degenerate, as one allocation.
std::size_t usual_bytes(const MikkMesh& mesh, std::size_t threads, bool lengths) {
  constexpr std::size_t rounding = 1 << 12;
  const std::size_t of_ids = 5 * sizeof(Index), of_vertices = sizeof(Index),
                    of_triangles = 6 * sizeof(Index) + sizeof(Orientation) + (lengths ? sizeof(Lengths) : 0);
  return scratch_bytes(mesh, threads) + of_ids * most_ids(mesh.vertex_count(), threads) +
         of_vertices * mesh.vertex_count() + of_triangles * triangles_of(mesh) + rounding;
}

}  // namespace

Connectivity::Connectivity(const MikkMesh& mesh, const Range& range, const LaneKernels& lanes,
                           const MikkOptions& options, bool lengths, Memory& memory)
    : mesh_(mesh), range_(range), threads_(thread_count(options.threads)), lanes_(lanes), memory_(memory) {
  memory_.start(usual_bytes(mesh, threads_, lengths));
  scratch_ = memory_.take<std::byte>(scratch_bytes(mesh, threads_));
  weld();
  list_triangles();
  take_values_of_representatives();
  set_degenerate_apart();
  weld_corners();
  list_corners();
  if (!options.sort_all_edges && good_ > 0) find_last_edges();
  representative_ = {};
  differentiate(lengths);
  orient_any();
}

// Quads are cut along the diagonal that is shorter in uv or, if these are equal, in space.
void Connectivity::list_triangles() {
  const bool quads =
      std::any_of(mesh_.face_sizes.begin(), mesh_.face_sizes.end(), [](auto n) { return n == 4; });
  all_ = mesh_.corner_count() / 3;
  if (!quads) return;
  all_ = mesh_.corner_count() - 2 * mesh_.face_sizes.size();
  corner_ = memory_.take<Index>(3 * all_);
  face_ = memory_.take<Index>(all_);
  face_begin_ = memory_.take<Index>(mesh_.face_sizes.size());
  std::size_t first = 0, triangle = 0;
  for (std::size_t f = 0; f < mesh_.face_sizes.size(); first += mesh_.face_sizes[f++]) {
    const auto add = [&](const std::array<Index, 3>& corners) {
      for (std::size_t k = 0; k < 3; ++k) corner_[3 * triangle + k] = static_cast<Index>(first) + corners[k];
      face_[triangle++] = static_cast<Index>(f);
    };
    face_begin_[f] = static_cast<Index>(first);
    if (mesh_.face_sizes[f] == 3) {
      add({0, 1, 2});
      continue;
    }
    const auto diagonal = [&](auto&& value, std::size_t a, std::size_t b) {
      const Vector d = value(vertex(first + b)) - value(vertex(first + a));
      return dot(d, d);
    };
    const auto uv = [&](Index v) {
      return Vector{mesh_.uvs[2 * std::size_t{v}], mesh_.uvs[2 * std::size_t{v} + 1], 1};
    };
    const auto p = [&](Index v) { return position(v); };
    const float uv02 = diagonal(uv, 0, 2), uv13 = diagonal(uv, 1, 3);
    const bool along02 = uv02 < uv13 ? true : uv13 < uv02 ? false : !(diagonal(p, 1, 3) < diagonal(p, 0, 2));
    if (along02) {
      add({0, 1, 2});
      add({0, 2, 3});
    } else {
      add({0, 1, 3});
      add({1, 2, 3});
    }
  }
  cut_ = memory_.take<Index>(corner_.size());
  std::ranges::copy(corner_, cut_.begin());
}

// Triangles with two corners at the same position are degenerate. Each is swapped with the next good one not
// yet swapped, so that they come last. All sums follow the order of the good ones.
void Connectivity::set_degenerate_apart() {
  const auto is_degenerate = [&](std::size_t t) {
    const Vector a = position(vertex(corner(3 * t))), b = position(vertex(corner(3 * t + 1))),
                 c = position(vertex(corner(3 * t + 2)));
    const auto same = [](const Vector& p, const Vector& q) {  // without branches
      return (p.x == q.x) & (p.y == q.y) & (p.z == q.z);
    };
    return (same(a, b) | same(a, c) | same(b, c)) != 0;
  };
  std::atomic<std::size_t> count = 0;
  parallel_ranges(all_, threads_, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (std::size_t t = begin; t < end; ++t) here += is_degenerate(t) ? 1 : 0;
    count += here;
  });
  good_ = all_ - count;
  if (count == 0) return;
  const std::span<std::uint8_t> degenerate = memory_.take<std::uint8_t>(all_);
  for (std::size_t t = 0; t < all_; ++t) degenerate[t] = is_degenerate(t) ? 1 : 0;
  if (corner_.empty()) {
    corner_ = memory_.take<Index>(3 * all_);
    for (std::size_t i = 0; i < corner_.size(); ++i) corner_[i] = static_cast<Index>(i);
    face_ = memory_.take<Index>(all_);
    for (std::size_t t = 0; t < all_; ++t) face_[t] = static_cast<Index>(t);
  }
  alone_ = memory_.take<std::uint8_t>(all_);
  std::ranges::fill(alone_, 0);
  for (std::size_t t = 0; t + 1 < all_; ++t)
    if (face_[t] == face_[t + 1]) {
      alone_[t] = alone_[t + 1] = degenerate[t] != degenerate[t + 1];
      ++t;
    }
  std::size_t good = 1;
  for (std::size_t t = 0; t < good_; ++t) {
    if (!degenerate[t]) {
      good = std::max(good, t + 2);
      continue;
    }
    while (good < all_ && degenerate[good]) ++good;
    if (good == all_) break;
    for (std::size_t k = 0; k < 3; ++k) std::swap(corner_[3 * t + k], corner_[3 * good + k]);
    std::swap(face_[t], face_[good]);
    std::swap(alone_[t], alone_[good]);
    std::swap(degenerate[t], degenerate[good]);
    ++good;
  }
}

void Connectivity::weld_corners() {
  if (corner_.empty() && (mesh_.corners.empty() || !joined_)) {  // as they lie there
    welded_ = mesh_.corners.empty() ? std::span<const Index>(id_) : mesh_.corners;
    return;
  }
  const std::span<Index> ids = memory_.take<Index>(3 * all_);
  parallel_ranges(3 * all_, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; ++at) ids[at] = id_[vertex(corner(at))];
  });
  welded_ = ids;
}

void Connectivity::list_corners() {
  const std::size_t ids = ids_;
  begin_ = memory_.take<Index>(ids + 1);
  at_vertex_ = memory_.take<Index>(3 * good_);
  const std::span<Index> all_next = reused<Index>(scratch_, ids);
  // Each thread has some of the ids and reads all corners, which costs too much with many threads.
  const std::size_t parts = ids < least_counted ? 1 : std::min<std::size_t>(threads_, 8);
  const auto of_ids = [&](const auto& f) { parallel_ranges(ids, parts, f, ids / parts + 1); };
  of_ids([&](std::size_t first, std::size_t last) {
    std::ranges::fill(begin_.subspan(first, last - first), 0);
    for (std::size_t at = 0; at < 3 * good_; ++at)
      if (const std::size_t id = welded(at) - first; id < last - first) ++begin_[first + id];
  });
  Index sum = 0;
  for (std::size_t id = 0; id < ids; ++id) sum += std::exchange(begin_[id], sum);
  begin_[ids] = sum;
  of_ids([&](std::size_t first, std::size_t last) {
    const std::span<Index> next = all_next.subspan(first, last - first);
    std::ranges::copy(begin_.subspan(first, last - first), next.begin());
    for (std::size_t at = 0; at < 3 * good_; ++at)
      if (const std::size_t id = welded(at) - first; id < last - first)
        at_vertex_[next[id]++] = static_cast<Index>(at);
  });
}

// An edge is a number: the vertex at its other end, the place of the corner at this end, and whether it
// leaves from there. A good triangle has one edge between two vertices, so edges are in the order of the
// triangles.
void Connectivity::find_links(Index id, Links& x) const {
  const std::span<const Index> corners = corners_at(id);
  x.after.assign(corners.size(), none);
  x.before.assign(corners.size(), none);
  x.keys.clear();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    x.keys.push_back(std::uint64_t{welded(next(corners[i]))} << 32 | i << 1 | 1);
    x.keys.push_back(std::uint64_t{welded(previous(corners[i]))} << 32 | i << 1);
  }
  std::sort(x.keys.begin(), x.keys.end());
  const auto other = [&](std::size_t i) { return x.keys[i] >> 32; };
  const auto leaves = [&](std::size_t i) { return (x.keys[i] & 1) != 0; };
  for (std::size_t first = 0, last; first < x.keys.size(); first = last) {
    for (last = first + 1; last < x.keys.size() && other(last) == other(first);) ++last;
    pair_up(
        last - first, [&](std::size_t i) { return leaves(first + i); },
        [&](std::size_t i, std::size_t j) {
          std::uint64_t leaving = x.keys[first + i], arriving = x.keys[first + j];
          if (!leaves(first + i)) std::swap(leaving, arriving);
          const Index from = static_cast<Index>(leaving) >> 1, to = static_cast<Index>(arriving) >> 1;
          x.after[from] = to;
          x.before[to] = from;
        },
        x.taken);
  }
  if (is_at_last_edge(id)) link_last_edges(id, x);
}

// The first group that reaches a triangle without uv area gives it its orientation, and groups begin in the
// order of the corners. So groups at the vertices of such triangles are formed one after the other.
void Connectivity::orient_any() {
  if (!any_) return;
  label_ = memory_.take<Index>(3 * good_);
  std::ranges::fill(label_, none);
  labelled_ = memory_.take<std::uint8_t>(ids_);
  std::ranges::fill(labelled_, 0);
  for (std::size_t at = 0; at < 3 * good_; ++at)
    if (orientation_[at / 3].any != 0) labelled_[welded(at)] = 1;
  // Like at_vertex_, for those with labels.
  const std::span<Index> after = memory_.take<Index>(3 * good_), before = memory_.take<Index>(3 * good_);
  parallel_ranges(ids_, threads_, [&](std::size_t begin, std::size_t end) {
    Links links;
    for (std::size_t id = begin; id < end; ++id) {
      if (labelled_[id] == 0) continue;
      find_links(static_cast<Index>(id), links);
      std::ranges::copy(links.after, &after[begin_[id]]);
      std::ranges::copy(links.before, &before[begin_[id]]);
    }
  });
  std::vector<Index> reached;  // places in at_vertex_
  for (std::size_t first = 0; first < 3 * good_; ++first) {
    const Index v = welded(first);
    if (labelled_[v] == 0 || label_[first] != none || orientation_[first / 3].any != 0) continue;
    const auto preserves = orientation_[first / 3].preserves;
    const auto label = static_cast<Index>(first);
    label_[first] = label;
    reached.assign({begin_[v] + place_at(v, label)});
    while (!reached.empty()) {
      const Index from = reached.back();
      reached.pop_back();
      for (const Index link : {after[from], before[from]}) {
        if (link == none) continue;
        const Index to = begin_[v] + link, there = at_vertex_[to], t = there / 3;
        if (label_[there] != none) continue;
        Orientation& d = orientation_[t];
        if (d.any != 0 && label_[3 * t] == none && label_[3 * t + 1] == none && label_[3 * t + 2] == none)
          d.preserves = preserves;
        if (d.preserves != preserves) continue;
        label_[there] = label;
        reached.push_back(to);
      }
    }
  }
}

}  // namespace darboux::mikk
