#include "diagnose_normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <darboux/frame.h>

#include "findings.h"
#include "linear_maps.h"
#include "mesh/area_vector.h"
#include "mesh/frames/corner.h"
#include "mesh/frames/creases.h"
#include "normal_cones.h"
#include "rounding.h"

namespace darboux {
namespace {

using namespace diagnosis;

// Linearly mapped normals have no discretisation error, but eight unknowns would fit any small set of
// normals.
constexpr std::size_t least_normals = 50;
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
