#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <string>
#include <utility>

#include <darboux/error.h>
#include <darboux/instruction_set.h>
#include <darboux/mikktspace.h>

#include "base/text.h"
#include "connectivity.h"
#include "vertex_tangents.h"

namespace darboux {
namespace {

using mikk::Index;
using mikk::LaneKernels;
using mikk::none;
using mikk::normalised;
using mikk::Part;
using mikk::Range;
using mikk::Vector;

// Groups about each vertex and their averages.
class Tangents : mikk::Connectivity {
 public:
  Tangents(const MikkMesh& mesh, const Range& range, const LaneKernels& lanes, const MikkOptions& options,
           bool lengths, mikk::Memory& memory)
      : Connectivity(mesh, range, lanes, options, lengths, memory),
        cosine_(static_cast<float>(
            std::cos(static_cast<double>(options.angular_threshold * static_cast<float>(M_PI) / 180.0F)))) {}

  // Whether the groups serve all corners.
  bool serve_all() const { return good_ == all_ && !any_; }
  // put(corner, tangent) for the corners that the groups serve, once for triangles; copy(from, to) for the
  // corners of degenerate triangles, which copy others. Each thread has a copy of `put`. If it has
  // end_of_vertex(), that is called after all corners of equal vertices.
  template <class Put, class Copy>
  void of_corners(const Put& put, const Copy& copy) const;

 private:
  struct Scratch;
  template <class Put>
  void serve(Index id, Scratch& scratch, Put& put) const;
  // Groups and members: places in the corners of the vertex.
  template <class Put>
  void serve_group(std::span<const Index> group, Scratch& scratch, Put& put) const;
  // Serves the vertices [begin, end).
  template <class Put>
  void serve_in_lanes(std::size_t begin, std::size_t end, Scratch& scratch, Put& put) const;
  void go_round(Index id, mikk::Ring& ring) const;
  bool is_one_group(const mikk::Ring& ring, std::span<const Index> corners) const;
  MikkTangent evaluate(std::span<const Index> members, const Scratch& scratch) const;
  bool any(std::size_t at) const { return orientation_[at / 3].any != 0; }
  bool preserves(std::size_t at) const { return orientation_[at / 3].preserves != 0; }

  float cosine_;
};

// Scratch data of the vertex being served.
struct Tangents::Scratch {
  std::span<const Index> corners;
  std::vector<Part> part;  // of each, and more
  Links links;
  std::vector<Index> group, reached, first, next, members, served;
};

// The average over some corners, weighted by the angle between a triangle's edges projected along the normal.
MikkTangent Tangents::evaluate(std::span<const Index> members, const Scratch& x) const {
  // x, y, z, and the angle.
  using Four = float __attribute__((vector_size(16)));
  const bool all = !lengths_.empty();  // else only t is needed
  Four s_sum{}, t_sum{};
  float s_length = 0, t_length = 0, sum = 0;
  for (const Index i : members) {
    const Index at = x.corners[i];
    if (any(at)) continue;
    const Part& part = x.part[i];
    Four part_s, part_t;
    std::memcpy(&part_s, &part, sizeof part_s);
    std::memcpy(&part_t, reinterpret_cast<const char*>(&part) + offsetof(Part, t), sizeof part_t);
    s_sum += part.angle * part_s;
    if (all) {
      t_sum += part.angle * part_t;
      s_length += part.angle * lengths_[at / 3].s;
      t_length += part.angle * lengths_[at / 3].t;
    }
    sum += part.angle;
  }
  Vector s{s_sum[0], s_sum[1], s_sum[2]}, t{t_sum[0], t_sum[1], t_sum[2]};
  s = normalised(s);
  if (!all) return {.t = {s.x, s.y, s.z}, .served = true};
  t = normalised(t);
  if (sum > 0) {
    s_length /= sum;
    t_length /= sum;
  }
  return {{s.x, s.y, s.z}, {t.x, t.y, t.z}, s_length, t_length, 1, true};
}

template <class Put>
void Tangents::serve_group(std::span<const Index> group, Scratch& x, Put& put) const {
  const float sign = preserves(x.corners[group[0]]) ? 1.0F : -1.0F;
  const auto write = [&](Index i, MikkTangent tangent) {
    tangent.sign = sign;
    put(corner(x.corners[i]), tangent);
  };
  const auto together = [&](Index i, Index j) {
    const Index a = x.corners[i], b = x.corners[j];
    return any(a) || any(b) || face(a / 3) == face(b / 3) ||
           (dot(x.part[i].s, x.part[j].s) > cosine_ && dot(x.part[i].t, x.part[j].t) > cosine_);
  };
  // At the usual 180 degrees only opposite directions are separated: there are none if all are on one side.
  bool all = cosine_ <= -1;
  Index first = none;
  for (std::size_t i = 0; all && i < group.size(); ++i) {
    if (any(x.corners[group[i]])) continue;
    if (first == none) first = group[i];
    const Part &a = x.part[group[i]], &b = x.part[first];
    all = group[i] == first || (dot(a.s, b.s) > 0.1F && dot(a.t, b.t) > 0.1F);
  }
  if (!all) {
    all = true;
    for (std::size_t i = 0; all && i < group.size(); ++i)
      for (std::size_t j = 0; all && j < i; ++j) all = together(group[i], group[j]);
  }
  if (all) {
    const MikkTangent tangent = evaluate(group, x);
    for (const Index i : group) write(i, tangent);
    return;
  }
  for (const Index a : group) {
    x.members.clear();
    for (const Index b : group)
      if (together(a, b)) x.members.push_back(b);
    write(a, evaluate(x.members, x));
  }
}

template <class Put>
void Tangents::serve(Index id, Scratch& x, Put& put) const {
  const std::span<const Index> corners = corners_at(id);
  x.corners = corners;
  find_parts(corners, x.part);
  const bool labelled = !labelled_.empty() && labelled_[id] != 0;
  if (!labelled) find_links(id, x.links);
  // Groups: corners linked between triangles of one orientation; numbered by their first.
  x.group.assign(corners.size(), none);
  Index groups = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (labelled) {
      if (const Index label = label_[corners[i]]; label != none)
        x.group[i] = label == corners[i] ? groups++ : none - 1;
      continue;
    }
    if (x.group[i] != none) continue;
    x.group[i] = groups;
    x.reached.assign(1, static_cast<Index>(i));
    while (!x.reached.empty()) {
      const Index from = x.reached.back();
      x.reached.pop_back();
      for (const Index there : {x.links.after[from], x.links.before[from]}) {
        if (there == none || x.group[there] != none || preserves(corners[there]) != preserves(corners[i]))
          continue;
        x.group[there] = groups;
        x.reached.push_back(there);
      }
    }
    ++groups;
  }
  if (labelled)
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (x.group[i] == none - 1) x.group[i] = x.group[place_at(id, label_[corners[i]])];

  // The corners of each group, ascending.
  x.first.assign(groups, none);
  x.next.resize(corners.size());
  for (std::size_t i = corners.size(); i-- > 0;)
    if (x.group[i] != none) x.next[i] = std::exchange(x.first[x.group[i]], static_cast<Index>(i));
  for (Index g = 0; g < groups; ++g) {
    x.served.clear();
    for (Index i = x.first[g]; i != none; i = x.next[i]) x.served.push_back(i);
    serve_group(x.served, x, put);
  }
  if constexpr (requires { put.end_of_vertex(); }) put.end_of_vertex();
}

void Tangents::go_round(Index id, mikk::Ring& ring) const {
  const std::span<const Index> corners = corners_at(id);
  ring.count = corners.size();
  ring.next.fill(none);
  ring.previous.fill(none - 1);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    ring.next[i] = welded(next(corners[i]));
    ring.previous[i] = welded(previous(corners[i]));
  }
}

// Whether one path or cycle visits all corners, whose triangles have one orientation. If links lead back to
// where they come from, no edge of it is used more than twice; a path begins where there is no such link.
bool Tangents::is_one_group(const mikk::Ring& ring, std::span<const Index> corners) const {
  std::size_t start = 0;
  bool alike = true;
  for (std::size_t i = 0; i < ring.count; ++i) {
    if (ring.before[i] == none) start = i;
    alike &= preserves(corners[i]) == preserves(corners[0]);
  }
  if (!alike) return false;
  std::size_t reached = 1;
  for (std::size_t at = start;; ++reached) {
    const Index to = ring.after[at];
    if (to == none) return reached == ring.count && ring.before[start] == none;
    if (ring.before[to] != at) return false;
    if (to == start) return reached == ring.count;
    at = to;
  }
}

// A few vertices at a time. Unusual ones are left to serve().
template <class Put>
void Tangents::serve_in_lanes(std::size_t begin, std::size_t end, Scratch& x, Put& put) const {
  constexpr std::size_t at_a_time = 64;
  std::array<mikk::Ring, at_a_time> rings;
  std::array<Index, at_a_time> ids;
  std::array<mikk::Group, at_a_time> groups;
  std::array<mikk::Average, at_a_time> averages;
  for (std::size_t id = begin; id < end;) {
    std::size_t count = 0;
    for (; id < end && count < at_a_time; ++id) {
      const std::size_t corners = begin_[id + 1] - begin_[id];
      if (corners == 0) continue;
      const bool labelled = !labelled_.empty() && labelled_[id] != 0;
      if (labelled || corners > mikk::Ring::most || is_at_last_edge(static_cast<Index>(id))) {
        serve(static_cast<Index>(id), x, put);
        continue;
      }
      ids[count] = static_cast<Index>(id);
      go_round(static_cast<Index>(id), rings[count++]);
    }
    lanes_.link(rings.data(), count);
    std::size_t of_lanes = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::span<const Index> corners = corners_at(ids[k]);
      if (!is_one_group(rings[k], corners)) {
        serve(ids[k], x, put);
        continue;
      }
      ids[of_lanes] = ids[k];
      groups[of_lanes++] = {corners.data(), corners.size(), source(corners[0])};
    }
    if (of_lanes > 0)
      lanes_.average({directions_.data(), mesh_.normals.data(), static_cast<Index>(mesh_.vertex_count() - 1),
                      groups.data(), of_lanes},
                     averages.data());
    for (std::size_t k = 0; k < of_lanes; ++k) {
      const std::span<const Index> corners = corners_at(ids[k]);
      const Vector& t = averages[k].s;
      if (averages[k].near == 0) {
        serve(ids[k], x, put);
        continue;
      }
      const MikkTangent tangent{
          .t = {t.x, t.y, t.z}, .sign = preserves(corners[0]) ? 1.0F : -1.0F, .served = true};
      if constexpr (requires { put.end_of_vertex(); })
        put.all_alike(corners, tangent);
      else
        for (const Index at : corners) put(corner(at), tangent);
    }
  }
}

template <class Put, class Copy>
void Tangents::of_corners(const Put& put, const Copy& copy) const {
  const bool in_lanes = lengths_.empty() && cosine_ <= -1;
  parallel_ranges(
      ids_, threads_,
      [&](std::size_t begin, std::size_t end) {
        Scratch scratch;
        Put mine = put;
        if (in_lanes) return serve_in_lanes(begin, end, scratch, mine);
        for (std::size_t id = begin; id < end; ++id)
          if (begin_[id] != begin_[id + 1]) serve(static_cast<Index>(id), scratch, mine);
      },
      mikk::least_served);
  // A corner of a degenerate triangle copies the first good corner at its vertex.
  for (std::size_t at = 3 * good_; at < 3 * all_; ++at)
    if (alone_[at / 3] == 0)
      if (const auto corners = corners_at(welded(at)); !corners.empty()) copy(corner(corners[0]), corner(at));
  // The fourth corner of a quad with one degenerate triangle copies the corner at the same position.
  for (std::size_t t = 0; good_ < all_ && t < good_; ++t) {
    if (alone_[t] == 0) continue;
    const std::size_t begin = face_begin_[face(t)];
    const auto at = [&](std::size_t k) { return corner(3 * t + k); };
    for (std::size_t missing = begin; missing < begin + 4; ++missing) {
      if (missing == at(0) || missing == at(1) || missing == at(2)) continue;
      for (std::size_t k = 0; k < 3; ++k)
        if (position(vertex(at(k))) == position(vertex(missing))) {
          copy(at(k), missing);
          break;
        }
    }
  }
}

// For meshes whose triangles are in order.
class PutByVertex {
 public:
  struct Others {
    std::mutex mutex;
    std::vector<mikk::CornerTangent> all;
  };
  PutByVertex(const MikkMesh& mesh, mikk::Buffer<Vec4<float>>& of_vertices, Others& others)
      : vertices_(mesh.corners.data()), tangents_(of_vertices.data()), others_(&others) {}

  void operator()(std::size_t corner, const MikkTangent& x) {
    here_.push_back({static_cast<Index>(corner), four(x)});
  }
  void all_alike(std::span<const Index> corners, const MikkTangent& x) {
    for (const Index corner : corners) tangents_[vertices_[corner]] = four(x);
  }
  void end_of_vertex() {
    const auto vertex = [&](std::size_t i) { return vertices_[here_[i].corner]; };
    std::ranges::sort(here_, {},
                      [&](const mikk::CornerTangent& x) { return std::pair(vertices_[x.corner], x.corner); });
    for (std::size_t i = 0; i < here_.size(); ++i) {
      Vec4<float>& first = tangents_[vertex(i)];
      if (i == 0 || vertex(i) != vertex(i - 1)) {
        first = here_[i].tangent;
      } else if (std::memcmp(&first, &here_[i].tangent, sizeof first) != 0) {
        const std::lock_guard lock(others_->mutex);
        others_->all.push_back(here_[i]);
      }
    }
    here_.clear();
  }

 private:
  static Vec4<float> four(const MikkTangent& x) { return {x.t[0], x.t[1], x.t[2], x.sign}; }

  const Index* vertices_;
  Vec4<float>* tangents_;
  Others* others_;
  std::vector<mikk::CornerTangent> here_;  // at equal vertices
};

void put_at(float* to, const MikkTangent& x) {
  to[0] = x.t[0], to[1] = x.t[1], to[2] = x.t[2], to[3] = x.sign;
}
// Four numbers for each corner of a mesh without quads.
void put_all(const Tangents& tangents, std::size_t corners, float unserved_sign, float* tangent4) {
  if (!tangents.serve_all())
    for (std::size_t c = 0; c < corners; ++c) put_at(tangent4 + 4 * c, {.sign = unserved_sign});
  tangents.of_corners(
      [=](std::size_t corner, const MikkTangent& x) { put_at(tangent4 + 4 * corner, x); },
      [=](std::size_t from, std::size_t to) { std::copy_n(tangent4 + 4 * from, 4, tangent4 + 4 * to); });
}

bool has_quads(const MikkMesh& mesh) {
  return std::any_of(mesh.face_sizes.begin(), mesh.face_sizes.end(), [](auto n) { return n == 4; });
}

// The average of the contributions of a quad's two triangles to a corner.
MikkTangent average(const MikkTangent& a, const MikkTangent& b) {
  const auto same = [](const auto& x, const auto& y) {
    return std::equal(std::begin(x), std::end(x), std::begin(y));
  };
  if (a.t_length == b.t_length && a.b_length == b.b_length && same(a.t, b.t) && same(a.b, b.b)) {
    MikkTangent both = a;
    both.sign = b.sign;
    return both;
  }
  const auto mean = [](const auto& x, const auto& y) {
    return normalised(Vector{x[0], x[1], x[2]} + Vector{y[0], y[1], y[2]});
  };
  const Vector t = mean(a.t, b.t), bt = mean(a.b, b.b);
  return {{t.x, t.y, t.z},
          {bt.x, bt.y, bt.z},
          0.5F * (a.t_length + b.t_length),
          0.5F * (a.b_length + b.b_length),
          b.sign,
          true};
}

}  // namespace

MikkMemory::MikkMemory() = default;
MikkMemory::MikkMemory(MikkMemory&&) noexcept = default;
MikkMemory& MikkMemory::operator=(MikkMemory&&) noexcept = default;
MikkMemory::~MikkMemory() = default;
std::size_t MikkMemory::bytes() const {
  return memory_ ? memory_->bytes() : 0;
}
void MikkMemory::release() {
  memory_.reset();
}

// The caller's memory, or some of its own.
struct MikkMemory::OfCall {
  MikkMemory own;
  MikkMemory& used;

  explicit OfCall(MikkMemory* kept) : used(kept == nullptr ? own : *kept) {
    if (!used.memory_) used.memory_ = std::make_unique<mikk::Memory>();
  }
  mikk::Memory& operator*() const { return *used.memory_; }
};

std::vector<MikkTangent> mikktspace(const MikkMesh& mesh, const MikkOptions& options) {
  const mikk::Range range = mikk::check(mesh, options);
  const LaneKernels& lanes = mikk::lanes_of(chosen_instruction_set());
  std::vector<MikkTangent> result(mesh.corner_count(), MikkTangent{.sign = options.unserved_sign});
  std::vector<std::uint8_t> written(has_quads(mesh) ? result.size() : 0);
  const MikkMemory::OfCall memory(options.memory);
  Tangents(mesh, range, lanes, options, true, *memory)
      .of_corners(
          [&](std::size_t corner, const MikkTangent& tangent) {
            result[corner] = !written.empty() && std::exchange(written[corner], 1) != 0
                                 ? average(result[corner], tangent)
                                 : tangent;
          },
          [&](std::size_t from, std::size_t to) { result[to] = result[from]; });
  return result;
}

mikk::VertexTangents mikk::vertex_tangents(const MikkMesh& mesh, const MikkOptions& options) {
  const Range range = check(mesh, options);
  const LaneKernels& lanes = lanes_of(chosen_instruction_set());
  const MikkMemory::OfCall memory(options.memory);
  const Tangents tangents(mesh, range, lanes, options, false, *memory);
  VertexTangents result;
  if (tangents.serve_all()) {
    result.of_vertices = Buffer<Vec4<float>>(mesh.vertex_count());
    std::fill_n(result.of_vertices.data(), mesh.vertex_count(), Vec4<float>{1, 0, 0, 0});
    PutByVertex::Others others;
    tangents.of_corners(PutByVertex(mesh, result.of_vertices, others), [](std::size_t, std::size_t) {});
    result.others = std::move(others.all);
    std::ranges::sort(result.others, {}, &CornerTangent::corner);
  } else {
    result.of_corners = Buffer<Vec4<float>>(mesh.corner_count());
    put_all(tangents, mesh.corner_count(), options.unserved_sign, &result.of_corners.data()->x);
  }
  return result;
}

void mikktspace(const MikkMesh& mesh, std::span<float> tangent4, const MikkOptions& options) {
  const mikk::Range range = mikk::check(mesh, options);
  const LaneKernels& lanes = mikk::lanes_of(chosen_instruction_set());
  if (tangent4.size() != 4 * mesh.corner_count())
    throw ParameterError("tangent4", expected_got("four numbers for each of the " +
                                                      std::to_string(mesh.corner_count()) + " corners",
                                                  std::to_string(tangent4.size()) + " numbers"));
  if (has_quads(mesh)) {
    const std::vector<MikkTangent> all = mikktspace(mesh, options);
    for (std::size_t c = 0; c < all.size(); ++c) put_at(&tangent4[4 * c], all[c]);
    return;
  }
  const MikkMemory::OfCall memory(options.memory);
  put_all(Tangents(mesh, range, lanes, options, false, *memory), mesh.corner_count(), options.unserved_sign,
          tangent4.data());
}

}  // namespace darboux
