#include "shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <darboux/fit_mesh.h>
#include <darboux/frame.h>
#include <darboux/weld.h>

#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"
#include "base/text.h"
#include "mesh/frames/creases.h"

namespace darboux {
namespace {

constexpr double same = 1e-6;                           // of the size
constexpr double flat_deg = 1;                          // faces that turn by less count as coplanar
constexpr double facet_deg = 1;                         // a normal this near to its triangle's is that one
constexpr double equal_deg = 0.01;                      // normals of corners this near to each other are one
constexpr std::size_t whole = 10000, looked_at = 5000;  // vertices: of larger meshes the triangles about some
constexpr std::size_t algebraic_places = 400;
constexpr double near_algebraic = 3 * fits_below;  // of the size
constexpr double apart = 10;               // the second nearest quadric must be this many times as far
constexpr double clear = 1e-3;             // of the largest eigenvalue of a quadric's form
constexpr std::size_t fewest = 8;          // positions
constexpr double most_polyhedral = 0.2;    // of the edges that turn
constexpr std::size_t many_places = 1000;  // beyond, folds (as of Schwarz's lantern) are no evidence
// Many small facets that turn by equal angles still make a surface.
constexpr std::size_t fine_places = 48;
constexpr double fine_turn_deg = 35;

constexpr std::size_t fewest_jumps = 8;
constexpr double same_jump = 2e-3;  // in units of uv
constexpr double most_alike = 0.5;

// Whether half of the values lie in two short intervals.
bool two_values(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::size_t most = 0, second = 0;
  for (std::size_t first = 0, last = 0; first < values.size(); first = last) {
    while (last < values.size() && values[last] <= values[first] + same_jump) ++last;
    second = std::max(second, std::min(most, last - first));
    most = std::max(most, last - first);
  }
  return static_cast<double>(most + second) >= most_alike * static_cast<double>(values.size());
}

// All triangles, or all about some vertices.
std::vector<std::uint32_t> looked_at_triangles(const Mesh& mesh, const std::vector<std::uint32_t>& vertices) {
  std::vector<bool> looked(mesh.positions.size(), vertices.size() <= whole);
  if (vertices.size() > whole)
    for (const std::size_t i : evenly_chosen(vertices.size(), looked_at)) looked[vertices[i]] = true;
  std::vector<std::uint32_t> result;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (std::any_of(mesh.triangles[t].begin(), mesh.triangles[t].end(),
                    [&](std::uint32_t v) { return looked[v]; }))
      result.push_back(t);
  return result;
}

}  // namespace

namespace {

// The examined sample of a mesh: some triangles, and their vertices, welded by position.
struct Sampled {
  const Mesh& mesh;
  std::vector<bool> used;                // vertices of triangles whose position is finite
  std::vector<std::uint32_t> triangles;  // of the mesh
  std::vector<std::uint32_t> vertices;   // of these triangles
  std::vector<std::uint32_t> index;      // per vertex of the mesh, its place in `vertices`
  std::vector<std::uint32_t> place;      // per sampled vertex, the first at its position

  std::uint32_t place_of(std::uint32_t v) const { return place[index[v]]; }
};

// Sets the shape's size, centre and places too.
Sampled sampled(const Mesh& mesh, Shape& shape) {
  Sampled s{mesh, std::vector<bool>(mesh.positions.size(), false), {}, {}, {}, {}};
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t) s.used[v] = detail::finite(mesh.positions[v]);
  std::vector<std::uint32_t> vertices;
  Eigen::AlignedBox3d box;
  for (std::uint32_t v = 0; v < s.used.size(); ++v)
    if (s.used[v]) box.extend(to_eigen(mesh.positions[v])), vertices.push_back(v);
  if (box.isEmpty()) return s;
  shape.size = box.diagonal().stableNorm();
  shape.centre = box.center();
  if (!(shape.size > 0) || !std::isfinite(shape.size)) return s;
  s.triangles = looked_at_triangles(mesh, vertices);
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  s.index.assign(mesh.positions.size(), none);
  std::vector<Vec3<double>> points;
  for (const std::uint32_t t : s.triangles)
    for (const std::uint32_t v : mesh.triangles[t])
      if (s.index[v] == none) {
        s.index[v] = static_cast<std::uint32_t>(s.vertices.size());
        s.vertices.push_back(v);
        points.push_back(s.used[v] ? mesh.positions[v] : detail::nan_vector<double>());
      }
  s.place = weld(points, same * shape.size);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (s.used[s.vertices[i]] && s.place[i] == i) shape.places.push_back(s.vertices[i]);
  return s;
}

Eigen::Vector3d in_units_of(const Shape& shape, const Vec3<double>& p) {
  return (to_eigen(p) - shape.centre) / shape.size;
}

// The principal axes of the positions, and their distance from a plane.
void measure_spread(const Mesh& mesh, Shape& shape) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto n = static_cast<double>(shape.places.size());
  const auto local = [&](std::uint32_t v) { return in_units_of(shape, mesh.positions[v]); };
  for (const std::uint32_t v : shape.places) mean += local(v) / n;
  for (const std::uint32_t v : shape.places) {
    const Eigen::Vector3d d = local(v) - mean;
    spread += d * d.transpose() / n;
  }
  shape.axes = symmetric_eigen(spread).vectors;
  if (shape.axes.determinant() < 0) shape.axes.col(2) *= -1;
  shape.plane_normal = shape.axes.col(0);
  double squares = 0;  // from distances: the eigenvalue has only half the digits
  for (const std::uint32_t v : shape.places) {
    const double d = (local(v) - mean).dot(shape.plane_normal);
    squares += d * d / n;
  }
  shape.thickness = std::sqrt(squares);
}

// The unit normals of the triangles, zero without area; and how many of them are shaded flat.
std::vector<Eigen::Vector3d> faces_of(const Sampled& s, Shape& shape) {
  std::vector<Eigen::Vector3d> faces;
  std::size_t with_area = 0, faceted = 0;
  const double own_cosine = std::cos(facet_deg * M_PI / 180);
  const auto local = [&](std::uint32_t v) { return in_units_of(shape, s.mesh.positions[v]); };
  for (const std::uint32_t t : s.triangles) {
    const auto& [v, w, x] = s.mesh.triangles[t];
    const Eigen::Vector3d face = (local(w) - local(v)).cross(local(x) - local(v));
    const double area = face.norm();
    faces.push_back(area > 1e-12 ? Eigen::Vector3d(face / area) : Eigen::Vector3d::Zero());
    if (!(area > 1e-12)) continue;
    ++with_area;
    // Normals of a fine mesh are near those of its triangles too, but differ among the corners of each.
    const auto is_normal_of_first = [&](std::uint32_t corner) {
      const Eigen::Vector3d first = to_eigen(s.mesh.normals[v]), n = to_eigen(s.mesh.normals[corner]);
      return first.cross(n).norm() <= equal_deg * M_PI / 180 * first.norm() * n.norm();
    };
    faceted += !s.mesh.normals.empty() && is_normal_of_first(w) && is_normal_of_first(x) &&
               std::all_of(s.mesh.triangles[t].begin(), s.mesh.triangles[t].end(), [&](std::uint32_t corner) {
                 const Eigen::Vector3d n = to_eigen(s.mesh.normals[corner]);
                 return n.dot(faces.back()) >= own_cosine * n.norm();
               });
  }
  shape.faceted = with_area == 0 ? 0 : static_cast<double>(faceted) / static_cast<double>(with_area);
  return faces;
}

std::vector<std::array<std::uint32_t, 2>> edges_of(const Sampled& s) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const std::uint32_t t : s.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = s.mesh.triangles[t][k], w = s.mesh.triangles[t][(k + 1) % 3];
      const std::uint32_t a = s.place_of(v), b = s.place_of(w);
      if (s.used[v] && s.used[w] && a != b)
        edges.push_back({std::min(s.vertices[a], s.vertices[b]), std::max(s.vertices[a], s.vertices[b])});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

// How neighbouring triangles turn, and how uvs jump between them.
void measure_turning(const Sampled& s, const std::vector<Eigen::Vector3d>& faces, Shape& shape) {
  const Mesh& mesh = s.mesh;
  std::vector<double> turns, jumps_u, jumps_v;
  std::size_t moderate = 0;
  const auto node = [&](std::uint32_t t, std::uint32_t k) {
    return s.place_of(mesh.triangles[s.triangles[t]][k]);
  };
  for_each_shared_edge(s.triangles.size(), s.vertices.size(), node, [&](const SharedEdge& e) {
    if (!mesh.uvs.empty())
      for (const std::uint32_t end : e.node) {
        Vec2<double> uv[2];
        for (std::size_t side = 0; side < 2; ++side)
          for (std::uint32_t k = 0; k < 3; ++k)
            if (node(e.triangle[side], k) == end)
              uv[side] = mesh.uvs[mesh.triangles[s.triangles[e.triangle[side]]][k]];
        const double u = std::fabs(uv[0].x - uv[1].x), v = std::fabs(uv[0].y - uv[1].y);
        if (std::isfinite(u + v) && (u > 1e-6 || v > 1e-6)) jumps_u.push_back(u), jumps_v.push_back(v);
      }
    const Eigen::Vector3d &a = faces[e.triangle[0]], &b = faces[e.triangle[1]];
    if (a.isZero() || b.isZero()) return;
    const double turn = std::atan2(a.cross(b).norm(), (e.turned ? -1 : 1) * a.dot(b)) * 180 / M_PI;
    if (turn <= flat_deg) return;
    turns.push_back(turn);
    moderate += turn <= crease_deg;
  });
  shape.one_chart = jumps_u.size() < fewest_jumps || two_values(jumps_u) || two_values(jumps_v);
  shape.turning = turns.size();
  if (turns.empty()) return;
  shape.moderate = static_cast<double>(moderate) / static_cast<double>(turns.size());
  const auto middle = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2);
  std::nth_element(turns.begin(), middle, turns.end());
  shape.turn_deg = *middle;
}

}  // namespace

Shape shape_of(const Mesh& mesh) {
  Shape shape;
  const Sampled s = sampled(mesh, shape);
  if (s.triangles.empty()) return shape;
  measure_spread(mesh, shape);
  const std::vector<Eigen::Vector3d> faces = faces_of(s, shape);
  shape.edges = edges_of(s);
  measure_turning(s, faces, shape);
  return shape;
}

namespace {

// The polynomials F in given monomials that come nearest to the positions [Taubin1991]: the coefficients of
// each, and the roots of the least values of sum F² over sum |grad F|², which are distances in units of the
// mesh's size.
template <int N>
struct Algebraic {
  std::size_t places = 0;
  Eigen::Matrix<double, N, 1> distances;
  Eigen::Matrix<double, N, N> coefficients;

  // \param monomials writes the values of N monomials and their derivatives at (x, y, z)
  template <class Monomials>
  Algebraic(const Mesh& mesh, const Shape& shape, Monomials monomials) {
    using Row = Eigen::Matrix<double, N, 1>;
    Eigen::Matrix<double, N, N> values = Eigen::Matrix<double, N, N>::Zero(), slopes = values;
    for (const std::size_t i : evenly_chosen(shape.places.size(), algebraic_places)) {
      const Eigen::Vector3d p = 2 * (to_eigen(mesh.positions[shape.places[i]]) - shape.centre) / shape.size;
      Row f, fx, fy, fz;
      monomials(p.x(), p.y(), p.z(), f, fx, fy, fz);
      values += f * f.transpose();
      slopes += fx * fx.transpose() + fy * fy.transpose() + fz * fz.transpose();
      ++places;
    }
    // Regularises: the constant has no slope.
    slopes += 1e-9 * static_cast<double>(places) * Eigen::Matrix<double, N, N>::Identity();
    const auto [squares, vectors] = generalised_symmetric_eigen(values, slopes);
    distances = squares.cwiseMax(0).cwiseSqrt() / 2;
    coefficients = vectors;
  }
};

void quadratic(double x, double y, double z, auto&& f, auto&& fx, auto&& fy, auto&& fz) {
  f << x * x, y * y, z * z, x * y, y * z, z * x, x, y, z, 1;
  fx << 2 * x, 0, 0, y, 0, z, 1, 0, 0, 0;
  fy << 0, 2 * y, 0, x, z, 0, 0, 1, 0, 0;
  fz << 0, 0, 2 * z, 0, y, x, 0, 0, 1, 0;
}

}  // namespace

Quadric quadric_of(const Mesh& mesh, const Shape& shape) {
  using Row = Eigen::Matrix<double, 10, 1>;
  const Algebraic<10> nearest(mesh, shape,
                              [](double x, double y, double z, Row& f, Row& fx, Row& fy, Row& fz) {
                                quadratic(x, y, z, f, fx, fy, fz);
                              });
  if (nearest.places < 10) return Quadric::any;
  if (nearest.distances[0] > near_algebraic) return Quadric::none;
  if (nearest.distances[1] < apart * near_algebraic) return Quadric::any;
  const Row q = nearest.coefficients.col(0);
  Eigen::Matrix3d form;
  form << q[0], q[3] / 2, q[5] / 2, q[3] / 2, q[1], q[4] / 2, q[5] / 2, q[4] / 2, q[2];
  Eigen::Vector3d shares = symmetric_eigenvalues(form);
  shares /= shares[0] + shares[2] < 0 ? shares[0] : shares[2];  // of the largest
  const double least = shares.minCoeff();
  return least > clear ? Quadric::definite : least < -clear ? Quadric::indefinite : Quadric::any;
}

bool may_be_cyclide(const Mesh& mesh, const Shape& shape) {
  using Row = Eigen::Matrix<double, 14, 1>;
  const Algebraic<14> nearest(mesh, shape,
                              [](double x, double y, double z, Row& f, Row& fx, Row& fy, Row& fz) {
                                quadratic(x, y, z, f.head<10>(), fx.head<10>(), fy.head<10>(), fz.head<10>());
                                const double s = x * x + y * y + z * z;
                                f.tail<4>() << s * x, s * y, s * z, s * s;
                                fx.tail<4>() << s + 2 * x * x, 2 * x * y, 2 * x * z, 4 * s * x;
                                fy.tail<4>() << 2 * y * x, s + 2 * y * y, 2 * y * z, 4 * s * y;
                                fz.tail<4>() << 2 * z * x, 2 * z * y, s + 2 * z * z, 4 * s * z;
                              });
  return nearest.places < 14 || nearest.distances[0] <= near_algebraic;
}

std::optional<Evidence> against_any_surface(const Shape& shape) {
  const auto against = [](const std::string& rival, const std::string& why) {
    return Evidence{-10, rival, rival + ": " + why};
  };
  if (shape.places.size() < fewest)
    return against("polyhedron", std::to_string(shape.places.size()) + " positions lie on many surfaces");
  if (shape.turning > 0 && shape.moderate < 1 - most_polyhedral && shape.places.size() < many_places)
    return against("polyhedron", rounded(100 * (1 - shape.moderate), 3) +
                                     " % of its edges turn by more than " + rounded(crease_deg, 3) + " deg");
  if (shape.is_faceted() && !(shape.places.size() >= fine_places && shape.turn_deg <= fine_turn_deg))
    return against("faceted",
                   rounded(100 * shape.faceted, 3) + " % of its triangles store their own normals");
  return std::nullopt;
}

}  // namespace darboux
