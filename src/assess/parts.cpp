#include "parts.h"

#include <cmath>
#include <numbers>
#include <unordered_map>

#include <darboux/frame.h>

#include "base/degrees.h"
#include "base/disjoint_sets.h"
#include "mesh/frames/creases.h"
#include "mesh/frames/rings.h"
#include "validate/angles.h"

namespace darboux {

Cutter::Cutter(const MeshUnderTest& whole)
    : whole_(whole),
      joined_(whole.equal.empty() ? join_equal_vertices(whole.mesh) : std::vector<std::uint32_t>()),
      equal_(whole.equal.empty() ? joined_ : whole.equal),
      number_(whole.mesh.positions.size(), none) {}

std::uint32_t Cutter::number(std::uint32_t vertex) {
  if (number_[vertex] == none) {
    number_[vertex] = static_cast<std::uint32_t>(seen_.size());
    seen_.push_back(vertex);
  }
  return number_[vertex];
}

void Cutter::forget() {
  for (const std::uint32_t v : seen_) number_[v] = none;
  seen_.clear();
}

std::vector<Cutter::Triangles> Cutter::pieces(const Triangles& triangles, bool at_creases) {
  const Mesh& mesh = whole_.mesh;
  for (const std::uint32_t t : triangles)
    for (const std::uint32_t v : mesh.triangles[t]) number(equal_[v]);
  const auto sign = [&](std::uint32_t i) { return whole_.raw_sign[triangles[i]]; };
  DisjointSets sets(triangles.size());
  // First triangles with uv area; then each of the others joins one neighbour, so it cannot connect two
  // pieces.
  std::vector<bool> placed(triangles.size(), false);
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    sets.join(a, b);
    placed[a] = placed[b] = true;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> without_area;
  for_each_shared_edge(
      triangles.size(), seen_.size(),
      [&](std::uint32_t i, std::uint32_t k) { return number_[equal_[mesh.triangles[triangles[i]][k]]]; },
      [&](const SharedEdge& e) {
        const auto [a, b] = e.triangle;
        if (at_creases && is_sharp(mesh, {{triangles[a], triangles[b]}, {e.node[0], e.node[1]}, e.turned}))
          return;
        if (!mesh.uvs.empty() && (sign(a) == 0 || sign(b) == 0))
          without_area.emplace_back(a, b);
        else if (sign(a) == sign(b))
          join(a, b);
      });
  forget();
  for (const auto& [a, b] : without_area)
    if (!(sign(a) == 0 && placed[a]) && !(sign(b) == 0 && placed[b])) join(a, b);
  std::vector<Triangles> pieces;
  std::unordered_map<std::uint32_t, std::size_t> piece_of;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto [place, is_new] = piece_of.try_emplace(sets.find(i), pieces.size());
    if (is_new) pieces.emplace_back();
    pieces[place->second].push_back(triangles[i]);
  }
  return pieces;
}

MeshPart Cutter::part(Triangles triangles) {
  const Mesh& whole = whole_.mesh;
  MeshPart part;
  part.triangles = std::move(triangles);
  part.mesh.triangles.reserve(part.triangles.size());
  part.raw_sign.reserve(part.triangles.size());
  for (const std::uint32_t t : part.triangles) {
    const auto& [a, b, c] = whole.triangles[t];
    const std::uint32_t first = number(a), second = number(b), third = number(c);
    part.mesh.triangles.push_back({first, second, third});
    part.raw_sign.push_back(whole_.raw_sign[t]);
  }
  part.vertices = seen_;
  forget();
  const auto take = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(part.vertices.size());
    for (const std::uint32_t v : part.vertices) to.push_back(from[v]);
  };
  take(whole.positions, part.mesh.positions);
  take(whole.normals, part.mesh.normals);
  take(whole.uvs, part.mesh.uvs);
  take(whole.tangents, part.mesh.tangents);
  part.mesh.half_steps = whole.half_steps;
  return part;
}

UvSets restrict_to(std::span<const UvSets::value_type> whole, const MeshPart& part) {
  UvSets sets;
  for (const auto& [set, uvs] : whole) {
    sets.emplace_back(set, std::vector<Vec2<double>>{});
    for (const std::uint32_t v : part.vertices) sets.back().second.push_back(uvs[v]);
  }
  return sets;
}

std::vector<bool> between_parts(const MeshUnderTest& whole, std::span<const MeshPart> parts,
                                double max_angle_deg) {
  const Mesh& mesh = whole.mesh;
  const VertexJoins& joins = whole.joins;
  const std::size_t n = joins.position_and_normal.size();
  struct First {
    std::uint32_t part, vertex;  // part: from 1; vertex: in the part
  };
  std::vector<First> first(n, First{0, 0});
  std::vector<bool> group(n, false);
  const double limit = max_angle_deg / degrees_per_radian;
  const auto differ = [&](const First& a, const First& b) {
    const MeshPart &p = parts[a.part - 1], &q = parts[b.part - 1];
    if (p.recognition.truth.empty() || q.recognition.truth.empty()) return true;
    const Truth &s = p.recognition.truth[a.vertex], &t = q.recognition.truth[b.vertex];
    if (s.pole || t.pole) return true;
    const double turn = angle_between(s.normal, t.normal);
    if (!(std::fmin(turn, std::numbers::pi - turn) <= limit)) return true;
    const std::uint32_t v = p.vertices[a.vertex], w = q.vertices[b.vertex];
    const bool one_tangent = !mesh.tangents.empty() && mesh.tangents[v] == mesh.tangents[w] &&
                             (mesh.uvs.empty() || mesh.uvs[v] == mesh.uvs[w]);
    return one_tangent && !(angle_between(s.tangent, t.tangent) <= limit);
  };
  for (std::uint32_t k = 0; k < parts.size(); ++k)
    for (std::uint32_t i = 0; i < parts[k].vertices.size(); ++i) {
      const std::uint32_t at = joins.position_and_normal[parts[k].vertices[i]];
      const First here{k + 1, i};
      if (first[at].part == 0) first[at] = here;
      if (first[at].part != here.part && differ(first[at], here)) group[at] = true;
    }
  std::vector<bool> result(n);
  for (std::uint32_t v = 0; v < n; ++v) result[v] = group[joins.position_and_normal[v]];
  return result;
}

}  // namespace darboux
