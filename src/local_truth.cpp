#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include <darboux/error.h>
#include <darboux/local_jets.h>
#include <darboux/local_truth.h>

#include "mesh_frames/rings.h"

namespace darboux {
namespace {

constexpr int first_degree = 3, finest_degree = 4;
constexpr double close = 2e-5;  // a thousandth of a degree
constexpr int most_rings = 5;   // the corner of a grid has too few within four
constexpr double infinite = std::numeric_limits<double>::infinity();

Truth no_truth() {
  const Vec3<double> none = detail::nan_vector<double>();
  return {none, none, none, none, Status::no_frame, false, infinite, infinite};
}

// A direction of which three standard deviations are a radian is not known: beyond first order, as next to a pole.
double deviation_deg(double error) {
  return 3 * error < 1 ? 180 / std::numbers::pi * error : infinite;
}

Truth truth_of(const UvJet& jet, double winding) {
  return {.position = jet.jet.position,
          .normal = winding * jet.frame.n,
          .tangent = jet.frame.t,
          .bitangent = unit(jet.jet.dpdv),
          .status = jet.frame.status,
          .pole = false,
          .normal_deg = deviation_deg(jet.normal_error),
          .tangent_deg = deviation_deg(jet.tangent_error)};
}

// Whether dpdu or dpdv vanishes here or nearly so, that is, changes by more than twice its own length on the way to a neighbour:
// a pole, next to which it changes by its own length.
bool is_singular(const Jet2<double>& jet, const Vec2<double>& uv, std::span<const Vec2<double>> neighbours) {
  double change_u = 0, change_v = 0;
  for (const Vec2<double>& near : neighbours) {
    const double du = near.x - uv.x, dv = near.y - uv.y;
    change_u = std::fmax(change_u, norm(du * jet.d2pdu2 + dv * jet.d2pduv));
    change_v = std::fmax(change_v, norm(du * jet.d2pduv + dv * jet.d2pdv2));
  }
  return change_u > 2 * norm(jet.dpdu) || change_v > 2 * norm(jet.dpdv);
}

// Kept from node to node, for its memory.
struct Near {
  Rings::Walk walk;
  std::vector<Vec3<double>> positions;
  std::vector<Vec2<double>> uvs;
};

// Of a node, from the fewest rings that tell how well they know it; of the finest degree where the first leaves more than that.
Truth truth_at(const Rings& rings, Index node, Near& near) {
  auto& [walk, positions, uvs] = near;
  positions.clear();
  uvs.clear();
  int degree = first_degree;
  std::optional<UvJet> best;
  rings.start(node, walk);
  rings.grow(walk);
  for (int ring = 2; ring <= most_rings; ++ring) {
    rings.grow(walk);
    for (std::size_t i = positions.size() == 0 ? 0 : walk.ends[walk.ends.size() - 2]; i < walk.near.size();
         ++i) {
      const Vec3<double>& p = rings.position(walk.near[i]);
      const Vec2<double>& uv = rings.uv(walk.near[i]);
      if (!detail::finite(p) || !std::isfinite(uv.x) || !std::isfinite(uv.y)) continue;
      positions.push_back(p);
      uvs.push_back(uv);
    }
    const UvJet jet = uv_jet(uvs, positions, rings.uv(node), {.degree = degree});
    if (!std::isfinite(jet.normal_error) || !std::isfinite(jet.tangent_error)) continue;
    best = jet;
    if (degree == finest_degree || std::fmax(jet.normal_error, jet.tangent_error) < close) break;
    degree = finest_degree;
  }
  if (!best) return no_truth();
  const auto nearest = std::span<const Vec2<double>>(uvs).first(std::min(walk.ends[1], uvs.size()));
  return is_singular(best->jet, rings.uv(node), nearest) ? no_truth() : truth_of(*best, Rings::sign(node));
}

}  // namespace

std::vector<Truth> local_truth(const Mesh& mesh) {
  check_consistent(mesh, "mesh");
  if (mesh.uvs.empty()) throw MeshError("mesh", "has no uvs, frames need one uv set");
  Rings rings(mesh);
  rings.stop_at_creases();
  constexpr Index none = std::numeric_limits<Index>::max();
  std::vector<Index> node_of(mesh.positions.size(), none);  // of a vertex of two, that of its last corner
  for (std::size_t c = 0; c < mesh.corners(); ++c)
    if (const Index node = rings.frames.of_corner[c]; rings.used(node) && !rings.at_crease(node))
      node_of[mesh.triangles[c / 3][c % 3]] = node;
  std::vector<Truth> result(mesh.positions.size(), no_truth());
  std::vector<Index> first(rings.size(), none);  // of each node the vertex that has its truth
  Near near;
  for (Index v = 0; v < node_of.size(); ++v) {
    if (node_of[v] == none) continue;
    Index& known = first[node_of[v]];
    if (known == none)
      result[known = v] = truth_at(rings, node_of[v], near);
    else
      result[v] = result[known];
  }
  return result;
}

}  // namespace darboux
