#include "local_truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <darboux/local_jets.h>
#include <darboux/local_truth.h>

#include "base/degrees.h"
#include "batch.h"
#include "mesh/frames/corner.h"
#include "mesh/largest_coordinate.h"
#include "mesh/triangle_signs.h"

namespace darboux {
namespace {

constexpr int first_degree = 3, finest_degree = 4;
constexpr double close = 2e-5;  // a thousandth of a degree
// A polynomial that its neighbours do not determine, such as one of the fourth degree over four rows, is
// singular. If the rows are askew, float rounding (6e-8) hides the singularity and its error; beyond this
// condition, rounding decides the result.
constexpr double worst_condition = 1e6;
constexpr int most_rings = 5;  // the corner of a grid has too few within four
constexpr double infinite = std::numeric_limits<double>::infinity();

Truth no_truth() {
  const Vec3<double> none = detail::nan_vector<double>();
  return {none, none, none, none, Status::no_frame, false, infinite, infinite};
}

// A direction whose three standard deviations exceed a radian is unknown: first-order errors are invalid
// there, as next to a pole.
double deviation_deg(double error) {
  return 3 * error < 1 ? degrees_per_radian * error : infinite;
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

// Only the normal: if a plane's coordinates stand in for uvs, tangents mean nothing.
Truth normal_of(const UvJet& jet) {
  Truth truth = no_truth();
  truth.position = jet.jet.position;
  truth.normal = jet.frame.n;
  truth.normal_deg = deviation_deg(jet.normal_error);
  return truth;
}

// A plane's own coordinates, counter-clockwise about its normal.
struct PlaneAxes {
  Vec3<double> x, y;
  explicit PlaneAxes(const Vec3<double>& normal) : x(any_perpendicular(normal)), y(cross(normal, x)) {}
  Vec2<double> operator()(const Vec3<double>& p) const { return {dot(p, x), dot(p, y)}; }
};

// If a neighbour's triangles lean farther than this from those around the node, the surface is no graph over
// its plane.
constexpr double least_cosine = 0.3;
// If the polynomial leans farther than this from the triangles at its own node, they do not resolve the
// surface.
constexpr double least_own_cosine = 0.8;

// Whether dpdu or dpdv vanishes here or nearly so, that is, changes by more than twice its own length on the
// way to a neighbour: a pole, next to which it changes by its own length.
bool is_singular(const Jet2<double>& jet, const Vec2<double>& uv, std::span<const Index> near,
                 std::span<const Vec2<double>> uvs) {
  const double by_u = 1 / norm(jet.dpdu), by_v = 1 / norm(jet.dpdv);
  const auto is_far = [](const Vec3<double>& change) { return !(dot(change, change) <= 4); };
  return std::any_of(near.begin(), near.end(), [&](Index v) {
    const double du = uvs[v].x - uv.x, dv = uvs[v].y - uv.y;
    return is_far(by_u * (du * jet.d2pdu2 + dv * jet.d2pduv)) ||
           is_far(by_v * (du * jet.d2pduv + dv * jet.d2pdv2));
  });
}

// The truth at some nodes, each from the fewest rings that determine its uncertainty; of the finest degree if
// that of the first is too uncertain.
class LocalTruth {
 public:
  LocalTruth(const Mesh& mesh, const Rings& rings, bool by_uvs)
      : mesh_(mesh), rings_(rings), by_uvs_(by_uvs), is_finite_(mesh.positions.size()) {
    for (std::size_t v = 0; v < is_finite_.size(); ++v)
      is_finite_[v] = detail::finite(mesh.positions[v]) && (!by_uvs || detail::finite(mesh.uvs[v]));
    if (by_uvs) return;
    across_.resize(rings.size());
    const double largest = largest_coordinate(mesh.positions);
    const double scale = largest > 0 ? std::ldexp(1, -std::ilogb(largest) - 1) : 1;  // products stay in range
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const std::array p = scaled({mesh.positions[a], mesh.positions[b], mesh.positions[c]}, scale);
      const Vec3<double> area = cross(p[1] - p[0], p[2] - p[0]);
      for (std::size_t k = 0; k < 3 && detail::finite(area); ++k) {
        Vec3<double>& sum = across_[rings.frames.of_corner[3 * t + k]];
        sum = sum + area;
      }
    }
    for (Vec3<double>& n : across_) n = unit(n);
  }

  std::span<const Truth> operator()(std::span<const Index> nodes) {
    open_.clear();
    for (const Index node : nodes) open_.push_back({.node = node});
    for (int ring = 2; ring <= most_rings; ++ring)
      for (const int degree : {finest_degree, first_degree}) fit(ring, degree);
    truths_.clear();
    for (const Open& o : open_) truths_.push_back(o.best);
    return truths_;
  }

 private:
  struct Open {
    Index node;
    int degree = first_degree;  // of its next polynomial, 0 where none is to come
    Truth best = no_truth();
  };
  // A requested polynomial, and the range of its neighbours in near_.
  struct Asked {
    Open* open;
    std::size_t begin, end, first_ring_end;
  };

  // Walks all rings again, which costs little compared with a polynomial.
  void gather(Open& open, int ring) {
    rings_.start(open.node, walk_);
    for (int r = 0; r < ring; ++r) rings_.grow(walk_);
    Asked asked{&open, near_.size(), 0, 0};
    for (const Index node : walk_.near)
      if (const Index v = rings_.vertex(node); is_finite_[v]) near_.push_back(v);
    asked.end = near_.size();
    // Fewer would not determine the error.
    if (asked.end - asked.begin < jet_coefficients(open.degree + 1) + 3 ||
        (!by_uvs_ && is_folded(open.node))) {
      near_.resize(asked.begin);
      return;
    }
    asked.first_ring_end = std::min(asked.begin + walk_.ends[1], asked.end);
    asked_.push_back(asked);
  }

  // Whether the node and the neighbours just found are seen from opposite sides.
  bool is_folded(Index node) const {
    return std::any_of(walk_.near.begin(), walk_.near.end(),
                       [&](Index near) { return !(dot(across_[near], across_[node]) > least_cosine); });
  }

  // Their coordinates in the plane about their node, in the order of near_.
  void project() {
    in_plane_.resize(near_.size()), positions_.resize(near_.size()), order_.resize(near_.size());
    std::iota(order_.begin(), order_.end(), Index{0});
    for (const Asked& a : asked_) {
      const PlaneAxes plane(across_[a.open->node]);
      for (std::size_t i = a.begin; i < a.end; ++i) {
        positions_[i] = mesh_.positions[near_[i]];
        in_plane_[i] = plane(positions_[i] - rings_.position(a.open->node));
      }
    }
  }

  void fit(int ring, int degree) {
    near_.clear(), asked_.clear(), neighbours_.clear();
    for (Open& open : open_)
      if (open.degree == degree) gather(open, ring);
    if (asked_.empty()) return;
    if (!by_uvs_) project();
    for (const Asked& a : asked_)
      neighbours_.push_back(
          by_uvs_ ? kernels::UvNeighbours{mesh_.uvs.data(), mesh_.positions.data(), &near_[a.begin],
                                          a.end - a.begin, rings_.uv(a.open->node)}
                  : kernels::UvNeighbours{
                        in_plane_.data(), positions_.data(), &order_[a.begin], a.end - a.begin, {}});
    jets_.resize(asked_.size());
    uv_jets(neighbours_, degree, false, false, jets_);
    for (std::size_t k = 0; k < asked_.size(); ++k) {
      const auto& [open, begin, end, first_ring_end] = asked_[k];
      const UvJet& jet = jets_[k];
      const double error = by_uvs_ ? std::fmax(jet.normal_error, jet.tangent_error) : jet.normal_error;
      if (!(jet.condition < worst_condition) || !std::isfinite(jet.normal_error) || !std::isfinite(error))
        continue;
      const auto first_ring = std::span<const Index>(near_).subspan(begin, first_ring_end - begin);
      if (!by_uvs_ && !(dot(jet.frame.n, across_[open->node]) > least_own_cosine)) continue;
      open->best = !by_uvs_ ? normal_of(jet)
                   : is_singular(jet.jet, rings_.uv(open->node), first_ring, mesh_.uvs)
                       ? no_truth()
                       : truth_of(jet, rings_.sign(open->node));
      const bool enough = degree == finest_degree || error < close;
      open->degree = enough ? 0 : finest_degree;
    }
  }

  const Mesh& mesh_;
  const Rings& rings_;
  bool by_uvs_;
  std::vector<bool> is_finite_;       // vertices: position and uv
  std::vector<Vec3<double>> across_;  // without uvs: the unit normal of each node's triangles
  Rings::Walk walk_;
  std::vector<Open> open_;
  std::vector<Asked> asked_;
  std::vector<Index> near_;              // vertices
  std::vector<Vec2<double>> in_plane_;   // see project()
  std::vector<Vec3<double>> positions_;  // of near_
  std::vector<Index> order_;
  std::vector<kernels::UvNeighbours> neighbours_;
  std::vector<UvJet> jets_;
  std::vector<Truth> truths_;
};

}  // namespace

bool has_uv_area(std::span<const signed char> signs) {
  return std::any_of(signs.begin(), signs.end(), [](signed char sign) { return sign != 0; });
}

std::vector<Truth> local_truth(const Mesh& mesh) {
  check_consistent(mesh, "mesh");
  const bool by_uvs = has_uv_area(triangle_signs(mesh));
  return local_truth(mesh, join_equal_vertices(mesh, by_uvs), by_uvs);
}

std::vector<Truth> local_truth(const Mesh& mesh, std::span<const Index> joined, bool by_uvs) {
  Rings rings(mesh, joined, by_uvs);
  rings.stop_at_creases();
  constexpr Index none = std::numeric_limits<Index>::max();
  std::vector<Index> node_of(mesh.positions.size(), none);  // of a vertex of two, that of its last corner
  for (std::size_t c = 0; c < mesh.corners(); ++c)
    if (const Index node = rings.frames.of_corner[c]; rings.used(node) && !rings.at_crease(node))
      node_of[mesh.triangles[c / 3][c % 3]] = node;
  std::vector<Truth> result(mesh.positions.size(), no_truth());
  std::vector<Index> first(rings.size(), none);  // for each node the vertex that has its truth
  LocalTruth truth(mesh, rings, by_uvs);
  std::vector<Index> nodes;
  for (Index v = 0; v < node_of.size(); ++v) {
    if (node_of[v] != none && first[node_of[v]] == none) {
      first[node_of[v]] = v;
      nodes.push_back(node_of[v]);
    }
    if (nodes.size() < jets_at_once && v + 1 < node_of.size()) continue;
    const std::span<const Truth> truths = truth(nodes);
    for (std::size_t k = 0; k < nodes.size(); ++k) result[first[nodes[k]]] = truths[k];
    nodes.clear();
  }
  for (Index v = 0; v < node_of.size(); ++v)
    if (node_of[v] != none && first[node_of[v]] != v) result[v] = result[first[node_of[v]]];
  return result;
}

}  // namespace darboux
