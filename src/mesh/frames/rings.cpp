// Methods that use the vertices about a vertex: least-squares polynomials and the Procrustes rotation.
#include "rings.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/QR>

#include "base/hash_table.h"
#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "corner.h"
#include "creases.h"
#include "mesh/triangle_signs.h"

namespace darboux {

std::vector<Index> join_equal_vertices(const Mesh& mesh, bool by_uvs) {
  const Vec3<double> no_normal;
  const Vec2<double> no_uv;
  const auto normal = [&](Index v) -> const Vec3<double>& {
    return mesh.normals.empty() ? no_normal : mesh.normals[v];
  };
  const auto uv = [&](Index v) -> const Vec2<double>& {
    return mesh.uvs.empty() || !by_uvs ? no_uv : mesh.uvs[v];
  };
  std::vector<Index> joined(mesh.positions.size());
  std::vector<std::uint32_t> hashes(joined.size());
  for (Index v = 0; v < joined.size(); ++v) {
    const Vec3<double>&p = mesh.positions[v], &n = normal(v);
    const Vec2<double>& q = uv(v);
    std::uint64_t hash = 0;
    for (const double x : {p.x, p.y, p.z, n.x, n.y, n.z, q.x, q.y}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15;  // -0 is 0
      hash ^= hash >> 32;
    }
    hashes[v] = static_cast<std::uint32_t>(hash * 0xd6e8feb86659fd93 >> 32);
  }
  HashTable distinct;
  for (Index v = 0; v < joined.size(); ++v) {
    if (v + HashTable::soon < hashes.size()) distinct.prefetch(hashes[v + HashTable::soon]);
    joined[v] = v;
    const Vec3<double>&p = mesh.positions[v], &n = normal(v);
    const Vec2<double>& q = uv(v);
    const auto joins_its_equal = [&](Index w) {
      if (!(p == mesh.positions[w] && n == normal(w) && q == uv(w))) return false;
      joined[v] = w;
      return true;
    };
    const bool equals_itself = p == p && n == n && q == q;  // as NaN does not
    if (equals_itself && !distinct.any_of(hashes[v], joins_its_equal)) distinct.insert(hashes[v], v);
  }
  return joined;
}

Rings::Rings(const Mesh& mesh, std::span<const Index> joined, bool by_uvs) : mesh_(mesh) {
  nodes_.reserve(mesh.triangles.size());
  frames.of_corner.reserve(mesh.corners());
  std::vector<bool> good;
  for (const Triangle& triangle : mesh.triangles) {
    const auto& [a, b, c] = triangle;
    int sign = by_uvs ? plain_sign(mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]) : 1;
    good.push_back(sign != 0 && !is_degenerate(mesh.positions[a], mesh.positions[b], mesh.positions[c]));
    if (!good.back() && by_uvs) {
      const Face face(mesh, triangle);
      count_degenerate(face, frames);
      good.back() = face.solved.has_value();
      sign = face.sign > 0 ? 1 : -1;
    }
    Triangle& nodes = nodes_.emplace_back();
    for (int k = 0; k < 3; ++k) {
      nodes[k] = 2 * joined[triangle[k]] + (sign > 0 ? 1 : 0);
      frames.of_corner.push_back(nodes[k]);
    }
  }
  list_triangles(good);
  // A triangle without uv area has no winding: its corners join the triangles that have one.
  for (std::size_t c = 0; c < frames.of_corner.size(); ++c) {
    Index& node = frames.of_corner[c];
    if (!good[c / 3] && !used(node) && used(node ^ 1)) node ^= 1;
  }
  split_fans(good);
  if (!split_from_.empty()) list_triangles(good);
}

void Rings::list_triangles(const std::vector<bool>& good) {
  begin_.assign(size() + 1, 0);
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    for (int k = 0; good[t] && k < 3; ++k) ++begin_[nodes_[t][k] + 1];
  for (std::size_t i = 0; i < size(); ++i) begin_[i + 1] += begin_[i];
  triangles_.resize(begin_.back());
  std::vector<Index> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    for (int k = 0; good[t] && k < 3; ++k) triangles_[next[nodes_[t][k]]++] = static_cast<Index>(t);
}

// Triangles about a node, including those without uv area, form one fan if a chain of edges at the node
// connects them.
void Rings::split_fans(const std::vector<bool>& good) {
  std::vector<Index>& of_corner = frames.of_corner;
  std::vector<Index> begin(wound() + 1, 0), corners(of_corner.size());
  for (const Index node : of_corner) ++begin[node + 1];
  for (std::size_t i = 0; i < wound(); ++i) begin[i + 1] += begin[i];
  std::vector<Index> next(begin.begin(), begin.end() - 1);
  for (std::size_t c = 0; c < of_corner.size(); ++c) corners[next[of_corner[c]]++] = static_cast<Index>(c);
  std::vector<std::pair<Index, Index>> ends;  // per edge at the node: the other end, the corner's place
  std::vector<Index> fan, name;               // per corner: one before it in its fan; per fan: its node
  const auto root = [&](Index i) {
    while (fan[i] != i) i = fan[i] = fan[fan[i]];
    return i;
  };
  for (Index node = 0; node < wound(); ++node) {
    const auto about = std::span<const Index>(corners).subspan(begin[node], begin[node + 1] - begin[node]);
    if (about.size() < 2) continue;
    fan.resize(about.size());
    ends.clear();
    for (Index i = 0; i < about.size(); ++i) {
      fan[i] = i;
      const Index first = about[i] / 3 * 3;
      for (Index c = first; c < first + 3; ++c)
        if (c != about[i]) ends.emplace_back(whole(of_corner[c]), i);
    }
    std::sort(ends.begin(), ends.end());
    std::size_t fans = about.size();
    for (std::size_t e = 1; e < ends.size(); ++e) {
      if (ends[e].first != ends[e - 1].first) continue;
      const Index a = root(ends[e - 1].second), b = root(ends[e].second);
      fans -= a != b;
      fan[std::max(a, b)] = std::min(a, b);
    }
    if (fans == 1) continue;
    name.assign(about.size(), node);
    for (Index i = 1; i < about.size(); ++i) {
      const Index first = root(i);
      if (first == 0) continue;
      if (first == i) {
        name[i] = static_cast<Index>(size());
        split_from_.push_back(node);
      }
      of_corner[about[i]] = name[first];
      if (good[about[i] / 3]) nodes_[about[i] / 3][about[i] % 3] = name[first];
    }
  }
}

void Rings::stop_at_creases() {
  at_crease_.assign(size(), false);
  for_each_shared_edge(
      nodes_.size(), size(), [&](Index t, Index k) { return nodes_[t][k]; },
      [&](const SharedEdge& e) {
        if (is_sharp(mesh_, e)) at_crease_[e.node[0]] = at_crease_[e.node[1]] = true;
      });
}

void Rings::start(Index node, Walk& walk) const {
  if (++walk.starts == 0) walk.seen.clear();  // all were used
  if (walk.seen.empty()) {
    walk.seen.assign(size(), 0);
    walk.starts = 1;
  }
  walk.near.assign(1, node);
  walk.ends.assign(1, 1);
  walk.seen[node] = walk.starts;
}

void Rings::grow(Walk& walk) const {
  const std::size_t first = walk.ends.size() == 1 ? 0 : walk.ends[walk.ends.size() - 2],
                    last = walk.ends.back();
  const bool whole = walk.ends.size() == 1;
  for (std::size_t i = first; i < last; ++i) {
    if (at_crease(walk.near[i])) continue;
    const std::size_t begin = begin_[walk.near[i]], count = begin_[walk.near[i] + 1] - begin,
                      taken = whole ? count : std::min(count, most_triangles);
    for (std::size_t k = 0; k < taken && (whole || walk.near.size() < most_nodes); ++k)
      for (const Index node : nodes_[triangles_[begin + (taken == count ? k : k * count / taken)]]) {
        if (walk.seen[node] == walk.starts) continue;
        walk.seen[node] = walk.starts;
        walk.near.push_back(node);
      }
  }
  walk.ends.push_back(walk.near.size());
}

namespace {

// The neighbours of a node, relative to it, in units of the greatest distance in u, in v and in space.
struct Neighbourhood {
  Eigen::Matrix<double, Eigen::Dynamic, 2> uv;
  Eigen::Matrix<double, Eigen::Dynamic, 3> p;
  double u_unit, v_unit, p_unit;

  Neighbourhood(const Rings& rings, const Rings::Walk& walk)
      : uv(walk.near.size() - 1, 2), p(walk.near.size() - 1, 3) {
    const Index centre = walk.near.front();
    for (std::size_t i = 1; i < walk.near.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i - 1);
      const Vec3<double> d = rings.position(walk.near[i]) - rings.position(centre);
      p.row(row) << d.x, d.y, d.z;
      uv.row(row) << rings.uv(walk.near[i]).x - rings.uv(centre).x,
          rings.uv(walk.near[i]).y - rings.uv(centre).y;
    }
    u_unit = uv.col(0).cwiseAbs().maxCoeff(), v_unit = uv.col(1).cwiseAbs().maxCoeff();
    p_unit = p.cwiseAbs().maxCoeff();
  }
};

// Directions of dpdu and dpdv at uv = 0 of the least-squares polynomial through 0 and the neighbours; none if
// these do not determine it, or barely do.
std::optional<TangentPair> fit_polynomial(const Neighbourhood& near, int degree) {
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 9, 9>;
  constexpr double worst_condition = 1e3;
  constexpr double parallel_below = 8 * 0x1p-53;
  const Eigen::Index unknowns = degree == 3 ? 9 : degree == 2 ? 5 : 2;
  if (near.p.rows() < unknowns || near.u_unit == 0 || near.v_unit == 0 || near.p_unit == 0)
    return std::nullopt;
  // Orthonormal columns w, [du dv] = w [[r00, r01], [0, r11]]: two affine charts of one neighbourhood give
  // the same w up to a rotation.
  const Eigen::VectorXd du = near.uv.col(0) / near.u_unit, dv = near.uv.col(1) / near.v_unit;
  Eigen::Matrix<double, Eigen::Dynamic, 2> w(near.p.rows(), 2);
  const double r00 = du.norm();
  w.col(0) = du / r00;
  const double r01 = w.col(0).dot(dv);
  w.col(1) = dv - r01 * w.col(0);
  const double r11 = w.col(1).norm();
  if (!(r11 > parallel_below * dv.norm())) return std::nullopt;
  w.col(1) /= r11;
  w /= w.rowwise().norm().maxCoeff();
  // Monomials are weighted so that a rotation of w rotates those of one degree.
  const double sqrt2 = std::sqrt(2.0), sqrt3 = std::sqrt(3.0);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Eigen::Dynamic, 9> a(near.p.rows(), unknowns);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const double x = w(i, 0), y = w(i, 1);
    a(i, 0) = x, a(i, 1) = y;
    if (degree >= 2) a(i, 2) = x * x, a(i, 3) = sqrt2 * x * y, a(i, 4) = y * y;
    if (degree >= 3)
      a(i, 5) = x * x * x, a(i, 6) = sqrt3 * x * x * y, a(i, 7) = sqrt3 * x * y * y, a(i, 8) = y * y * y;
  }
  // Frobenius norms: no rotation changes them.
  const Eigen::HouseholderQR<decltype(a)> qr(a);
  const Coefficients r = qr.matrixQR().topRows(unknowns).template triangularView<Eigen::Upper>();
  const Coefficients inverse =
      r.template triangularView<Eigen::Upper>().solve(Coefficients::Identity(unknowns, unknowns));
  if (!(r.norm() * inverse.norm() < worst_condition)) return std::nullopt;
  const Eigen::Matrix<double, Eigen::Dynamic, 3> c = qr.solve(near.p / near.p_unit);
  // dpdu = (c0 - r01/r11 c1) / r00, dpdv = c1 / r11.
  const Eigen::Vector3d t = c.row(0) - (r01 / r11) * c.row(1), b = c.row(1);
  return TangentPair{from_eigen(t), from_eigen(b)};
}

// Sets frame(walk) for each node that a triangle uses.
template <class FrameOf>
MeshFrames of_nodes(const Mesh& mesh, int threads, const FrameOf& frame) {
  Rings rings(mesh);
  std::vector<CornerFrame>& frames = rings.frames.frames;
  frames.resize(rings.size());
  parallel_ranges(
      rings.size(), thread_count(threads),
      [&](std::size_t begin, std::size_t end) {
        Rings::Walk walk;
        for (auto node = static_cast<Index>(begin); node < end; ++node) {
          std::optional<TangentPair> pair;
          if (rings.used(node)) {
            rings.start(node, walk);
            pair = frame(rings, walk);
          }
          const double sign = rings.sign(node);
          const Vec3<double> own = mesh.normals.empty() ? Vec3<double>{} : mesh.normals[rings.vertex(node)];
          frames[node] =
              pair ? frame_or_fallback(unit(pair->t), unit(pair->b),
                                       unit(sign * accurate_cross(unit(pair->t), unit(pair->b))), sign)
                   : fallback_frame(own, sign);
        }
      },
      1024);
  count_fallbacks(rings.frames);
  return std::move(rings.frames);
}

MeshFrames compute_polynomial(const Mesh& mesh, int threads, int degree) {
  constexpr int most_rings = 4;
  return of_nodes(
      mesh, threads, [degree](const Rings& rings, Rings::Walk& walk) -> std::optional<TangentPair> {
        rings.grow(walk);
        for (int d = degree; d > 0; --d)
          for (int ring = 2; ring <= most_rings; ++ring) {
            if (walk.ends.size() == static_cast<std::size_t>(ring)) rings.grow(walk);
            if (ring > 2 && walk.ends[ring] == walk.ends[ring - 1]) break;
            Rings::Walk part{
                {walk.near.begin(), walk.near.begin() + static_cast<std::ptrdiff_t>(walk.ends[ring])},
                {},
                {}};
            if (const auto pair = fit_polynomial(Neighbourhood(rings, part), d)) return pair;
          }
        return std::nullopt;
      });
}

}  // namespace

MeshFrames compute_quadratic(const Mesh& mesh, int threads) {
  return compute_polynomial(mesh, threads, 2);
}
MeshFrames compute_cubic(const Mesh& mesh, int threads) {
  return compute_polynomial(mesh, threads, 3);
}

// With A = Σ Δp (Δu, Δv)ᵀ over the neighbours, [t b] is the nearest matrix of orthonormal columns:
// W Vᵀ of A = W S Vᵀ.
MeshFrames compute_procrustes(const Mesh& mesh, int threads) {
  return of_nodes(mesh, threads, [](const Rings& rings, Rings::Walk& walk) -> std::optional<TangentPair> {
    constexpr double parallel_below = 8 * 0x1p-53;
    rings.grow(walk);
    const Neighbourhood near(rings, walk);
    const double uv_unit = std::max(near.u_unit, near.v_unit);
    if (uv_unit == 0 || near.p_unit == 0) return std::nullopt;
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    a.leftCols<2>() = (near.p / near.p_unit).transpose() * (near.uv / uv_unit);
    const SingularValues svd = singular_value_decomposition(a);
    if (!(svd.values(1) > parallel_below * svd.values(0))) return std::nullopt;
    const Eigen::Matrix<double, 3, 2> r = svd.u.leftCols<2>() * svd.v.topLeftCorner<2, 2>().transpose();
    return TangentPair{{r(0, 0), r(1, 0), r(2, 0)}, {r(0, 1), r(1, 1), r(2, 1)}};
  });
}

}  // namespace darboux
