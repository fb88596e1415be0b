#include "diagnose.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/LU>

#include <darboux/frame.h>

#include "base/degrees.h"
#include "base/linear_algebra.h"
#include "base/text.h"
#include "findings.h"
#include "mesh/area_vector.h"
#include "mesh/frames/corner.h"
#include "mesh/frames/creases.h"
#include "normal_cones.h"
#include "rounding.h"

namespace darboux {
namespace {

constexpr std::size_t most_samples = 4096, least_samples = 10;
// Linearly mapped normals have no discretisation error, but eight unknowns would fit any small set of
// normals.
constexpr std::size_t least_normals = 50;

struct Pair {
  std::size_t corner;            // or, for normals, vertex
  Vec3<double> stored, t, b, v;  // unit; b perpendicular to t, on the side of v
  double w, raw;                 // raw: of the triangle, 0 without uv area
  double limit;                  // degrees
  double rounding = 0;           // degrees by which rounding may have turned the reference
  bool within(double deg) const { return deg <= limit + rounding; }
};

double angle_deg(const Vec3<double>& a, const Vec3<double>& b) {
  return degrees_per_radian * angle_between(a, b);
}

std::vector<Pair> samples_of(const MeshUnderTest& under_test,
                             const std::function<Directions(std::size_t)>& reference, double max_angle_deg) {
  const Mesh& mesh = under_test.mesh;
  const std::size_t step = (mesh.corners() + most_samples - 1) / most_samples;
  std::vector<Pair> samples;
  for (std::size_t c = 0; c < mesh.corners(); c += step) {
    const std::uint32_t v = mesh.triangles[c / 3][c % 3];
    const Vec4<double>& t = mesh.tangents[v];
    const Directions d = reference(c);
    if (!detail::finite(t.xyz()) || t.xyz() == Vec3<double>{} || !detail::finite(d.t) ||
        !detail::finite(d.b) || under_test.classes.of_vertex[v] == VertexClass::pole)
      continue;
    const Vec3<double> along = unit(d.t), across = unit(d.b - dot(d.b, along) * along);
    samples.push_back({c, unit(t.xyz()), along, across, unit(d.b), t.w,
                       static_cast<double>(under_test.raw_sign[c / 3]),
                       limit_of(under_test.classes.of_vertex[v], max_angle_deg)});
  }
  return samples;
}

// The share of samples that are within their limits of the direction.
template <class F>
double share_within(const std::vector<Pair>& samples, F direction) {
  std::size_t within = 0;
  for (const Pair& s : samples) within += s.within(angle_deg(s.stored, direction(s)));
  return static_cast<double>(within) / static_cast<double>(samples.size());
}

// How the stored tangent lies relative to the reference's t and b, and which uvs would make it right: with
// `keeps` their triangles have the sign of the stored uvs' triangles, with `turns` the opposite one.
struct Axes {
  std::string_view what;
  double t, b;
  std::string_view keeps, turns;
};
constexpr Axes other_axes[] = {{"-t", -1, 0, "flip both", "flip u"},
                               {"b", 0, 1, "swap flip u", "swap"},
                               {"-b", 0, -1, "swap flip v", "swap flip both"}};

// Three directions count as along v: the one perpendicular to t, if tangents were turned or bitangents stored
// in their place; the reference's own direction of v, if u and v were swapped; and MikkTSpace's tangent of
// swapped uvs, for coarse meshes.
bool follow_other_axes(const MeshUnderTest& under_test, const std::vector<Pair>& samples,
                       const ValidateOptions& options, MeshReport& report) {
  const Mesh& mesh = under_test.mesh;
  const std::size_t corners = mesh.corners();
  std::optional<MikktspaceReference> swapped;
  const auto along_v = [&](const Pair& s) {
    return direction_of(swapped->at(s.corner, mesh.triangles[s.corner / 3][s.corner % 3]));
  };
  for (const Axes& axes : other_axes) {
    double share = share_within(samples, [&](const Pair& s) { return axes.t * s.t + axes.b * s.b; });
    if (share < explains_most && axes.b != 0)
      share = share_within(samples, [&](const Pair& s) { return axes.b * s.v; });
    if (share < explains_most && axes.b != 0 && !mesh.normals.empty() && !mesh.uvs.empty()) {
      if (!swapped) {
        std::vector<Vec2<double>> uvs;
        for (const Vec2<double>& uv : mesh.uvs) uvs.push_back({uv.y, uv.x});
        swapped = mikktspace_reference(mesh, uvs, options.threads);
      }
      share = share_within(samples, [&](const Pair& s) { return axes.b * along_v(s); });
    }
    if (share < explains_most) continue;
    double raw = 0;
    for (const Pair& s : samples) raw += s.w * s.raw;
    const std::string_view gltf_uvs = raw > 0 ? axes.turns : axes.keeps,
                           raw_uvs = raw > 0 ? axes.keeps : axes.turns;
    add(report, finding(Code::tangent_axes, corners,
                        ": they lie along " + std::string(axes.what) +
                            " (t of u, b of v), as those of uvs '" + std::string(gltf_uvs) +
                            "' with glTF's sign, or '" + std::string(raw_uvs) + "' with the raw one"));
    return true;
  }
  return false;
}

bool follow_other_uv_set(const MeshUnderTest& under_test, const std::vector<Pair>& samples,
                         const ValidateOptions& options, MeshReport& report) {
  if (under_test.mesh.normals.empty()) return false;
  const auto share_of = [&](const MikktspaceReference& mikktspace) {
    return share_within(samples, [&](const Pair& s) {
      return direction_of(mikktspace.at(s.corner, under_test.mesh.triangles[s.corner / 3][s.corner % 3]));
    });
  };
  // The other set may be a copy of the mesh's own.
  const double own = under_test.mikktspace.empty() ? 0 : share_of(under_test.mikktspace);
  for (const auto& [set, uvs] : options.other_uvs) {
    const double share = share_of(mikktspace_reference(under_test.mesh, uvs, options.threads));
    if (share < explains_most || share <= own) continue;
    add(report, finding(Code::tangent_uv_set, under_test.mesh.corners(),
                        ": MikkTSpace's of TEXCOORD_" + std::to_string(set)));
    return true;
  }
  return false;
}

// The one angle, in degrees, by which nearly all tangents are turned from the reference about their normals.
std::optional<double> turn_deg_of(const Mesh& mesh, const std::vector<Pair>& samples, double limit) {
  if (mesh.normals.empty() || samples.size() < least_samples) return std::nullopt;
  double x = 0, y = 0;
  const auto normal = [&](const Pair& s) { return mesh.normals[mesh.triangles[s.corner / 3][s.corner % 3]]; };
  for (const Pair& s : samples) {
    const Vec3<double> n = normal(s);
    if (!detail::finite(n) || n == Vec3<double>{}) continue;
    const double along = dot(s.stored, s.t), across = dot(s.stored, cross(unit(n), s.t));
    x += along, y += across;
  }
  const double turn = std::atan2(y, x), cosine = std::cos(turn), sine = std::sin(turn);
  if (std::fabs(turn) * 180 / std::numbers::pi < 3 * limit) return std::nullopt;
  const double share =
      share_within(samples, [&](const Pair& s) { return cosine * s.t + sine * cross(unit(normal(s)), s.t); });
  if (share < explains_most) return std::nullopt;
  return turn * 180 / std::numbers::pi;
}

// Whether all are turned by one angle about their normals, relative to the reference or as Cones found.
bool are_turned(const MeshUnderTest& under_test, const std::vector<Pair>& samples, double limit,
                MeshReport& report) {
  std::optional<Cones::Turn> turn;
  if (const auto deg = turn_deg_of(under_test.mesh, samples, limit))
    turn = {*deg, false};
  else
    turn = under_test.cones.turn();
  if (!turn) return false;
  const bool quarters = std::fabs(std::remainder(turn->deg, 90)) <= limit;
  // Turned uvs turn the tangents of mirrored charts the other way.
  const auto has = [&](signed char sign) {
    return std::find(under_test.raw_sign.begin(), under_test.raw_sign.end(), sign) !=
           under_test.raw_sign.end();
  };
  const bool both = has(-1) && has(1);
  const double signed_deg = turn->by_sign && both ? std::fabs(turn->deg) : turn->deg;
  const std::string deg = std::to_string(std::lround(signed_deg));
  add(report, finding(quarters ? Code::tangent_axes : Code::tangent_uv_set, under_test.mesh.corners(),
                      ": all are turned about their normals by about " + deg + " deg" +
                          (turn->by_sign && both ? ", in mirrored charts the other way" : "") +
                          (turn->by_sign || !both ? ", as those of uvs that are turned" : "")));
  return true;
}

// Unit vectors that span the stored ones, a column each: two where these lie in one plane, as the normals of
// a cylinder do.
Eigen::MatrixXd span_of(const std::vector<Pair>& samples) {
  constexpr double flat = 1e-6;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const Pair& s : samples) moments += to_eigen(s.stored) * to_eigen(s.stored).transpose();
  const auto [values, vectors] = symmetric_eigen(moments);
  if (values[0] > flat * values.sum()) return Eigen::Matrix3d::Identity();
  return vectors.rightCols<2>();
}

// A description of a map's effect on positions. \param of_normals m maps normals, by the inverse transpose
std::string text_of_map(const Eigen::Matrix3d& m, Eigen::Index dimensions, bool of_normals) {
  const Eigen::Vector3d singular = singular_value_decomposition(m).values,
                        scale = singular / singular[dimensions - 1];
  const std::string mirrors = dimensions == 3 && m.determinant() < 0 ? " and mirrors" : "";
  if (scale[0] < 1.01) return ": by a map that turns" + mirrors;
  constexpr double along_axes = 0.01;
  Eigen::Array3d diagonal = m.diagonal().array().abs();
  if (dimensions == 3 &&
      (m - Eigen::Matrix3d(m.diagonal().asDiagonal())).norm() < along_axes * diagonal.minCoeff()) {
    if (of_normals) diagonal = diagonal.inverse();
    diagonal /= diagonal.minCoeff();
    return ": by a map that scales x : y : z as " + rounded(diagonal[0], 3) + " : " +
           rounded(diagonal[1], 3) + " : " + rounded(diagonal[2], 3) + mirrors;
  }
  return ": by a map that scales as " + rounded(scale[0], 3) +
         (dimensions == 3 ? " : " + rounded(scale[1], 3) : "") + " : 1" + mirrors;
}

// How many stored vectors beyond the limit differ by a degree and more, up to least_different.
constexpr std::size_t least_different = 8;
std::size_t different_off(const std::vector<Pair>& samples) {
  constexpr double same_deg = 1;
  std::vector<Vec3<double>> different;
  for (const Pair& s : samples) {
    if (different.size() == least_different) break;
    if (!s.within(angle_deg(s.stored, s.t)) &&
        std::none_of(different.begin(), different.end(),
                     [&](const Vec3<double>& d) { return angle_deg(d, s.stored) < same_deg; }))
      different.push_back(s.stored);
  }
  return different.size();
}

// The linear map M of their span that takes the stored vectors to the reference's t, up to their length: the
// least of sum |T x M t|² at |M| = 1. \param least_ratio maps that scale by less are not told \returns what
// it does, where it explains nearly all
std::optional<std::string> linear_map_of(const std::vector<Pair>& samples, double limit, bool of_normals,
                                         double least_ratio = 1) {
  const Eigen::MatrixXd span = span_of(samples);
  const Eigen::Index d = span.cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3 * d, 3 * d);
  for (const Pair& s : samples) {
    const Eigen::VectorXd t = span.transpose() * to_eigen(s.stored);
    const Eigen::Vector3d to = to_eigen(s.t);
    Eigen::Matrix3d across;
    across << 0, -to.z(), to.y(), to.z(), 0, -to.x(), -to.y(), to.x(), 0;
    Eigen::MatrixXd by(3, 3 * d);  // of M's columns
    for (Eigen::Index k = 0; k < d; ++k) by.middleCols<3>(3 * k) = t[k] * across;
    sum += by.transpose() * by / static_cast<double>(samples.size());
  }
  const auto [least, maps] = symmetric_eigen(sum);
  // Collinear vectors do not determine M, nor do coplanar references. Where many different normals are off,
  // as those of roofs whose ridges are parallel, it is the one nearest to the identity.
  constexpr double identifiable = 1e-3;
  Eigen::VectorXd column = maps.col(0);
  if (!(least[1] > identifiable)) {
    if (!of_normals || different_off(samples) < least_different) return std::nullopt;
    const Eigen::VectorXd identity = span.reshaped();
    column.setZero();
    for (Eigen::Index k = 0; k < least.size() && least[k] <= identifiable; ++k)
      column += maps.col(k).dot(identity) * maps.col(k);
    column.normalize();
  }
  Eigen::Matrix3d m = Eigen::Map<const Eigen::MatrixXd>(column.data(), 3, d) * span.transpose();
  double along = 0;
  for (const Pair& s : samples) along += to_eigen(s.t).dot(m * to_eigen(s.stored));
  if (along < 0) m = -m;
  std::size_t within = 0;
  for (const Pair& s : samples)
    within += angle_deg(s.t, from_eigen(Eigen::Vector3d(m * to_eigen(s.stored)))) <= limit + s.rounding;
  if (static_cast<double>(within) < explains_most * static_cast<double>(samples.size())) return std::nullopt;
  const Eigen::Vector3d singular = singular_value_decomposition(m).values, scale = singular / singular[d - 1];
  if (!(scale[0] < 1e3 && scale[0] >= least_ratio)) return std::nullopt;
  return text_of_map(m, d, of_normals);
}

// The rotation that takes the stored vectors nearest to the reference's, if it explains nearly all and they
// span space. [Kabsch1976]
std::optional<std::string> rotation_of(const std::vector<Pair>& samples) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero(), moments = Eigen::Matrix3d::Zero();
  for (const Pair& s : samples) {
    sum += to_eigen(s.t) * to_eigen(s.stored).transpose();
    moments += to_eigen(s.stored) * to_eigen(s.stored).transpose();
  }
  constexpr double spans = 0.05;
  if (!(symmetric_eigen(moments).values[0] > spans * static_cast<double>(samples.size())))
    return std::nullopt;
  const auto [u, values, v] = singular_value_decomposition(sum);
  const Eigen::Matrix3d r = u * v.transpose();
  if (r.determinant() < 0) return std::nullopt;
  const double share =
      share_within(samples, [&](const Pair& s) { return from_eigen(r.transpose() * to_eigen(s.t)); });
  if (share < explains_most) return std::nullopt;
  return ": by a map that turns";
}

constexpr double known_plane_deg = 30;  // planes that rounding may have turned further tell nothing

// Unit normals of the triangles, oriented like the stored normals.
std::vector<Vec3<double>> planes_of(const MeshUnderTest& under_test) {
  const double side = under_test.normals.all_oppose ? -1 : 1;
  std::vector<Vec3<double>> result;
  for (const Triangle& t : under_test.mesh.triangles)
    result.push_back(side * unit(area_vector(under_test.mesh, t)));
  return result;
}

// Whether the normals at the corners of a triangle are n.
bool has_one_normal(const Mesh& mesh, const Triangle& triangle, const Vec3<double>& n) {
  constexpr double same_deg = 0.9;  // assimp joins dot products of 0.9999
  return std::all_of(triangle.begin(), triangle.end(),
                     [&](std::uint32_t v) { return angle_deg(n, mesh.normals[v]) <= same_deg; });
}

// Pairs of stored normal and plane normal for vertices whose triangles all lie in one plane, and have one
// normal each: at hard edges and on facets no other normal is right, and a map leaves equal ones equal.
// Vertices with one place and one normal, as along uv seams, count as one.
std::vector<Pair> normals_of_facets(const MeshUnderTest& under_test, double limit) {
  const Mesh& mesh = under_test.mesh;
  const double same_plane = limit / 2;
  VertexJoins of_part;
  const std::vector<std::uint32_t>& joined = joins_of(under_test, of_part).position_and_normal;
  const std::vector<Vec3<double>> planes = planes_of(under_test);
  // Of each vertex the plane that is known best.
  std::vector<Vec3<double>> plane(mesh.positions.size());
  std::vector<double> rounding(mesh.positions.size(), 180), rounding_of(mesh.triangles.size(), 180);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!under_test.has_area[t]) continue;
    rounding_of[t] = plane_rounding_deg(mesh, mesh.triangles[t]);
    for (const std::uint32_t v : mesh.triangles[t])
      if (const std::uint32_t at = joined[v]; rounding_of[t] < rounding[at])
        plane[at] = planes[t], rounding[at] = rounding_of[t];
  }
  std::vector<bool> is_bent(mesh.positions.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!under_test.has_area[t]) continue;
    const bool is_shaded_flat = has_one_normal(mesh, mesh.triangles[t], mesh.normals[mesh.triangles[t][0]]);
    for (const std::uint32_t v : mesh.triangles[t]) {
      const std::uint32_t at = joined[v];
      is_bent[at] = is_bent[at] || !is_shaded_flat ||
                    !(angle_deg(plane[at], planes[t]) <= same_plane + rounding[at] + rounding_of[t]);
    }
  }
  const std::size_t step = std::max<std::size_t>(1, mesh.positions.size() / most_samples);
  std::vector<Pair> samples;
  for (std::size_t v = 0; v < mesh.positions.size(); v += step) {
    const Vec3<double>& n = mesh.normals[v];
    const Vec3<double>& across = plane[joined[v]];
    if (!(rounding[joined[v]] <= known_plane_deg) || is_bent[joined[v]] || !detail::finite(n) ||
        n == Vec3<double>{})
      continue;
    samples.push_back({v, unit(n), across, {}, {}, 1, 1, limit, rounding[joined[v]]});
  }
  return samples;
}

// Calls f(t, other, turn in degrees) for both triangles of each edge.
template <class F>
void for_each_turn(const MeshUnderTest& under_test, const std::vector<Vec3<double>>& planes, F f) {
  const Mesh& mesh = under_test.mesh;
  VertexJoins of_part;
  const std::vector<std::uint32_t>& places = joins_of(under_test, of_part).position;
  for_each_shared_edge(
      mesh.triangles.size(), mesh.positions.size(),
      [&](std::uint32_t t, std::uint32_t k) { return places[mesh.triangles[t][k]]; },
      [&](const SharedEdge& e) {
        const double turn = angle_deg(planes[e.triangle[0]], planes[e.triangle[1]]);
        f(e.triangle[0], e.triangle[1], turn);
        f(e.triangle[1], e.triangle[0], turn);
      });
}

constexpr double round_turn = 1.5;  // deviation of exact normals from averages, over that turn

// Removes samples of facets that are parts of a curved polygon: their normal is that of a neighbouring
// triangle, too, which turns little, and it lies between the normals of both planes; or, at a border, it is
// off by at most one and a half times that turn.
std::vector<Pair> without_polygons(const MeshUnderTest& under_test, std::vector<Pair> samples) {
  constexpr double within_deg = 1;
  const Mesh& mesh = under_test.mesh;
  const std::vector<Vec3<double>> planes = planes_of(under_test);
  std::vector<bool> rounded(mesh.positions.size(), false);
  for_each_turn(under_test, planes, [&](std::uint32_t t, std::uint32_t other, double turn) {
    const Vec3<double>& n = mesh.normals[mesh.triangles[t][0]];
    if (!(turn <= crease_deg) || !has_one_normal(mesh, mesh.triangles[other], n)) return;
    for (const std::uint32_t v : mesh.triangles[t]) {
      const double off = angle_deg(planes[t], mesh.normals[v]);
      const bool at_border = under_test.classes.of_vertex[v] == VertexClass::border;
      if (off + angle_deg(mesh.normals[v], planes[other]) <= turn + within_deg ||
          (at_border && off <= round_turn * turn))
        rounded[v] = true;
    }
  });
  samples.erase(
      std::remove_if(samples.begin(), samples.end(),
                     [&](const Pair& s) { return rounded[s.corner] && !s.within(angle_deg(s.stored, s.t)); }),
      samples.end());
  return samples;
}

// Pairs of stored normals and angle-weighted averages over their triangles.
std::vector<Pair> normals_of_averages(const MeshUnderTest& under_test, double limit) {
  const Mesh& mesh = under_test.mesh;
  VertexJoins of_part;
  const std::vector<std::uint32_t>& joined = joins_of(under_test, of_part).position_and_normal;
  const std::vector<Vec3<double>> planes = planes_of(under_test);
  std::vector<Vec3<double>> sums(mesh.positions.size());
  std::vector<double> rounding(mesh.positions.size(), 0), angles(mesh.positions.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!under_test.has_area[t]) continue;
    const Triangle& triangle = mesh.triangles[t];
    const double turned = plane_rounding_deg(mesh, triangle);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t at = joined[triangle[static_cast<std::size_t>(k)]];
      const double angle = corner_angle(
          {mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]}, k);
      sums[at] = sums[at] + angle * planes[t];
      rounding[at] += angle * turned;
      angles[at] += angle;
    }
  }
  const std::size_t step = std::max<std::size_t>(1, mesh.positions.size() / most_samples);
  std::vector<Pair> samples;
  for (std::size_t v = 0; v < mesh.positions.size(); v += step) {
    const Vec3<double>& n = mesh.normals[v];
    const Vec3<double> average = unit(sums[joined[v]]);
    const double turned = rounding[joined[v]] / angles[joined[v]];
    if (average == Vec3<double>{} || !(turned <= known_plane_deg) || !detail::finite(average) ||
        !detail::finite(n) || n == Vec3<double>{})
      continue;
    samples.push_back({v, unit(n), average, {}, {}, 1, 1, limit, turned});
  }
  return samples;
}

// Widens their limits by the deviation of exact normals from averages on a coarse mesh: one and a half times
// the turn from triangle to triangle.
void widen_by_turns(const MeshUnderTest& under_test, std::vector<Pair>& samples) {
  const Mesh& mesh = under_test.mesh;
  VertexJoins of_part;
  const std::vector<std::uint32_t>& joined = joins_of(under_test, of_part).position_and_normal;
  std::vector<double> turns(mesh.positions.size(), 0);
  // A hard edge does not count: its two sides have normals of their own.
  for_each_turn(under_test, planes_of(under_test), [&](std::uint32_t t, std::uint32_t other, double turn) {
    const auto& [a, b, c] = mesh.triangles[other];
    for (const std::uint32_t v : mesh.triangles[t])
      if (const std::uint32_t at = joined[v];
          turn <= crease_deg || at == joined[a] || at == joined[b] || at == joined[c])
        turns[at] = std::fmax(turns[at], turn);
  });
  for (Pair& s : samples) s.limit = std::fmax(s.limit, round_turn * turns[joined[s.corner]]);
}

// Share of the limit that three standard deviations of an estimate from the neighbours may take up.
constexpr double known_to = 0.4;
std::vector<Pair> normals_of_neighbours(const MeshUnderTest& under_test, double limit) {
  const Mesh& mesh = under_test.mesh;
  const double side = under_test.normals.all_oppose ? -1 : 1;
  const std::size_t step = std::max<std::size_t>(1, under_test.local.size() / most_samples);
  std::vector<Pair> samples;
  for (std::size_t v = 0; v < under_test.local.size(); v += step) {
    const Truth& truth = under_test.local[v];
    const Vec3<double>& n = mesh.normals[v];
    if (!(certain * truth.normal_deg <= known_to * limit) || !detail::finite(n) || n == Vec3<double>{})
      continue;
    samples.push_back({v, unit(n), side * truth.normal, {}, {}, 1, 1, limit});
  }
  return samples;
}

// The share of normals that are averages of their own triangles': these follow the mesh.
double share_of_averages(const MeshUnderTest& under_test, const std::vector<Pair>& samples) {
  std::vector<bool> asked(under_test.mesh.positions.size(), false);
  for (const Pair& s : samples) asked[s.corner] = true;
  VertexJoins of_part;
  const std::vector<bool> average =
      are_average_normals(under_test.mesh, joins_of(under_test, of_part), asked);
  const auto averages =
      std::count_if(samples.begin(), samples.end(), [&](const Pair& s) { return average[s.corner]; });
  return static_cast<double>(averages) / static_cast<double>(samples.size());
}

bool are_averages(const MeshUnderTest& under_test, const std::vector<Pair>& samples) {
  return share_of_averages(under_test, samples) > 1 - Accurate::enough;
}

bool are_off(const std::vector<Pair>& samples) {
  return samples.size() >= least_samples &&
         share_within(samples, [](const Pair& s) { return s.t; }) < Accurate::enough;
}

// \param map_limit how near a map with eight unknowns must bring them
bool add_map(const MeshUnderTest& under_test, const std::vector<Pair>& samples, double map_limit,
             MeshReport& report) {
  std::optional<std::string> map = rotation_of(samples);
  if (!map && samples.size() >= least_normals) map = linear_map_of(samples, map_limit, true);
  if (map) add(report, finding(Code::normal_stale, under_test.mesh.corners(), *map));
  return map.has_value();
}

// Whether the directions in a plane leave no gap of a quarter turn.
bool go_all_round(const std::vector<Pair>& samples, const Eigen::MatrixXd& plane) {
  std::vector<double> turns;
  for (const Pair& s : samples) {
    const Eigen::Vector2d along = plane.transpose() * to_eigen(s.stored);
    turns.push_back(std::atan2(along.y(), along.x()));
  }
  std::sort(turns.begin(), turns.end());
  double widest = turns.front() + 2 * std::numbers::pi - turns.back();
  for (std::size_t k = 1; k < turns.size(); ++k) widest = std::fmax(widest, turns[k] - turns[k - 1]);
  return widest < std::numbers::pi / 2;
}

// On a coarse mesh exact normals, too, are far from averages. Of a column, whose normals lie in one plane and
// go all round it, no map that scales much brings most of them near; leaves and bands are lit like what they
// belong to, which may well be a map.
void add_map_of_column(const MeshUnderTest& under_test, const std::vector<Pair>& samples, double limit,
                       MeshReport& report) {
  constexpr double least_ratio = 1.5, most_right = 0.5;  // those along the map's axes are right
  const Eigen::MatrixXd span = span_of(samples);
  if (under_test.normals.all_oppose || span.cols() != 2 || !go_all_round(samples, span) ||
      different_off(samples) < least_different ||
      share_within(samples, [](const Pair& s) { return s.t; }) > most_right ||
      share_of_averages(under_test, samples) > most_right)
    return;
  const std::optional<std::string> map = linear_map_of(samples, limit, true, least_ratio);
  if (!map) return;
  Finding found = finding(Code::normal_stale, under_test.mesh.corners(),
                          *map + "; told by averages of the triangles alone");
  found.to_do =
      "nothing, where the mesh is meant to be lit as another shape; else transform normals by the inverse "
      "transpose of the map";
  add(report, std::move(found));
}

std::size_t drawn_vertices(const MeshUnderTest& under_test) {
  const std::vector<bool>& drawn = under_test.normals.drawn;
  return static_cast<std::size_t>(std::count(drawn.begin(), drawn.end(), true));
}

// Where no surface is known: against the planes of facets, else against the neighbours, else against
// averages.
bool diagnose_unknown(const MeshUnderTest& under_test, const ValidateOptions& options, MeshReport& report) {
  if (under_test.mesh.normals.empty()) return false;
  const double limit = options.max_angle_deg;
  std::vector<Pair> facets = normals_of_facets(under_test, limit / 5);
  if (are_off(facets)) facets = without_polygons(under_test, std::move(facets));
  // If facets are few, as along a fold of a curved surface, the other vertices are better evidence.
  constexpr std::size_t least_share = 5;
  if (are_off(facets) && least_share * facets.size() >= std::min(most_samples, drawn_vertices(under_test)) &&
      add_map(under_test, facets, limit / 5, report))
    return true;
  const std::vector<Pair> neighbours = normals_of_neighbours(under_test, limit);
  if (are_off(neighbours) && !are_averages(under_test, neighbours) &&
      add_map(under_test, neighbours, known_to * limit, report))
    return true;
  std::vector<Pair> averages = normals_of_averages(under_test, limit);
  if (!are_off(averages)) return false;
  std::vector<Pair> widened = averages;
  widen_by_turns(under_test, widened);
  if (are_off(widened) && !are_averages(under_test, widened) &&
      add_map(under_test, widened, known_to * limit, report))
    return true;
  add_map_of_column(under_test, averages, limit, report);
  return false;  // too uncertain to make any normal an error
}

}  // namespace

bool diagnose_tangents(const MeshUnderTest& under_test,
                       const std::function<Directions(std::size_t)>& reference,
                       const ValidateOptions& options, bool held, MeshReport& report) {
  const double limit = options.max_angle_deg;
  const std::size_t corners = under_test.mesh.corners();
  const std::vector<Pair> samples = samples_of(under_test, reference, limit);
  if (samples.size() < least_samples) return !held && are_turned(under_test, samples, limit, report);
  if (share_within(samples, [](const Pair& s) { return s.t; }) >= Accurate::enough) return false;
  if (follow_other_uv_set(under_test, samples, options, report)) return true;
  if (held) return false;
  if (follow_other_axes(under_test, samples, options, report)) return true;
  if (are_turned(under_test, samples, limit, report)) return true;
  const std::optional<std::string> map = linear_map_of(samples, limit, false);
  if (map) add(report, finding(Code::tangent_stale, corners, *map));
  return map.has_value();
}

NormalMistake diagnose_normals(const MeshUnderTest& under_test, const Accurate& accurate,
                               const ValidateOptions& options, MeshReport& report) {
  if (!accurate.known())
    return diagnose_unknown(under_test, options, report) ? NormalMistake::mapped : NormalMistake::none;
  const Mesh& mesh = under_test.mesh;
  const double limit = options.max_angle_deg;
  const std::size_t step = std::max<std::size_t>(1, mesh.positions.size() / most_samples);
  std::vector<Pair> samples;
  for (std::size_t v = 0; v < mesh.positions.size(); v += step) {
    const auto vertex = static_cast<std::uint32_t>(v);
    if (accurate.normal(vertex) == Claim::none) continue;
    const Vec3<double>& n = accurate.truth(vertex).normal;
    samples.push_back({v, unit(mesh.normals[v]), accurate.inward(vertex) ? -n : n, {}, {}, 1, 1, limit});
  }
  if (samples.size() < least_samples) return NormalMistake::none;
  if (share_within(samples, [](const Pair& s) { return -s.t; }) >= explains_most)
    return NormalMistake::negated;
  if (samples.size() < least_normals) return NormalMistake::none;
  const std::optional<std::string> map = linear_map_of(samples, limit / 5, true);
  if (!map) return NormalMistake::none;
  add(report, finding(Code::normal_stale, mesh.corners(), *map));
  return NormalMistake::mapped;
}

}  // namespace darboux
