#include "evidence.h"

#include <algorithm>
#include <cmath>

#include <darboux/ellipsoid.h>
#include <darboux/frame.h>
#include <darboux/sphere.h>

#include "base/evenly_chosen.h"
#include "base/text.h"
#include "mesh/used_vertices.h"
#include "surface_kind.h"

namespace darboux {
namespace {

enum class Symmetry { plane, sphere, axis, none };

// Prior knowledge about a kind of surface.
struct Prior {
  SurfaceKind kind;
  Symmetry symmetry;
  int unknowns;  // of a profile through rings about the axis; of lengths between points of a ball; else of
                 // the whole fit
  double log10_odds;  // log10 odds that a part of a typical model is one, against all alternatives
};
constexpr Prior priors[] = {
    {SurfaceKind::sphere, Symmetry::sphere, 2, -2},
    {SurfaceKind::cylinder, Symmetry::axis, 1, -1},
    {SurfaceKind::cone, Symmetry::axis, 2, -1},
    {SurfaceKind::torus, Symmetry::axis, 3, -3},
    {SurfaceKind::ellipsoid, Symmetry::sphere, 3, -3},
    {SurfaceKind::elliptic_paraboloid, Symmetry::none, 10, -5},
    {SurfaceKind::catenoid, Symmetry::axis, 3, -5},
};
constexpr Prior any_other{SurfaceKind::other, Symmetry::none, 10, -6};

constexpr double across_deg = 45, most_across = 0.2;
constexpr double same = 1e-3;  // of the size, for rings; for lengths, ten times that, of their median
constexpr std::size_t looked_at = 5000;  // positions and vertices of large meshes, spread evenly
constexpr double agree_deg = 5, tight_deg = 1;
constexpr double most_positions = 8, most_uvs = 4, most_normals = 4;
constexpr double least_explained = 100;  // least ratio of a plane's residual to the surface's

const Prior& prior_of(SurfaceKind kind) {
  for (const Prior& prior : priors)
    if (prior.kind == kind) return prior;
  return any_other;
}

// How many different values there are: the number of intervals of that width that cover them all.
std::size_t different(std::vector<double> values, double tolerance) {
  std::sort(values.begin(), values.end());
  std::size_t count = 0;
  double end = -1;
  for (const double x : values)
    if (count == 0 || x > end) ++count, end = x + tolerance;
  return count;
}

// If one vertex of a symmetric lattice lies on the surface, so do its images. They count once: rings about an
// axis, lengths between neighbours on a ball.
struct Orbits {
  std::size_t count = 0;
  std::size_t sides = 0;     // of the finest ring that goes all round, 0 if none does
  std::size_t columns = 0;   // different angles about the axis
  std::size_t mirrored = 0;  // the same, with mirror images counted once
};

Orbits rings(const Mesh& mesh, const Shape& shape, const Eigen::Isometry3d& placement) {
  struct Ring {
    double z, r;
    std::vector<double> angles;
  };
  std::vector<Ring> list;
  Orbits result;
  const double tolerance = same * shape.size;
  const Eigen::Isometry3d to_local = placement.inverse();
  for (const std::size_t i : evenly_chosen(shape.places.size(), looked_at)) {
    const Eigen::Vector3d p = to_local * to_eigen(mesh.positions[shape.places[i]]);
    const double r = std::hypot(p.x(), p.y());
    auto at = std::find_if(list.begin(), list.end(), [&](const Ring& ring) {
      return std::fabs(ring.z - p.z()) <= tolerance && std::fabs(ring.r - r) <= tolerance;
    });
    if (at == list.end()) {
      if (list.size() >= 64) continue;  // plenty
      at = list.insert(list.end(), {p.z(), r, {}});
    }
    at->angles.push_back(std::atan2(p.y(), p.x()));
  }
  result.count = list.size();
  std::vector<double> columns;
  for (Ring& ring : list) {
    if (!(ring.r > tolerance)) continue;
    columns.insert(columns.end(), ring.angles.begin(), ring.angles.end());
    const double step = tolerance / ring.r;
    std::sort(ring.angles.begin(), ring.angles.end());
    double widest = ring.angles.front() + 2 * M_PI - ring.angles.back();
    for (std::size_t i = 1; i < ring.angles.size(); ++i)
      widest = std::fmax(widest, ring.angles[i] - ring.angles[i - 1]);
    const std::size_t sides = different(ring.angles, step);
    if (widest <= 1.6 * 2 * M_PI / static_cast<double>(sides) || widest < M_PI / 6)
      result.sides = std::max(result.sides, sides);
  }
  if (columns.empty()) return result;
  // Angles from one side of the widest gap to the other.
  std::sort(columns.begin(), columns.end());
  std::size_t first = 0;
  double widest = columns.front() + 2 * M_PI - columns.back();
  for (std::size_t i = 1; i < columns.size(); ++i)
    if (const double gap = columns[i] - columns[i - 1]; gap > widest) first = i, widest = gap;
  for (std::size_t i = 0; i < first; ++i) columns[i] += 2 * M_PI;
  const auto [low, high] = std::minmax_element(columns.begin(), columns.end());
  const double middle = (*low + *high) / 2, step = same * (*high - *low);
  result.columns = different(columns, step);
  for (double& angle : columns) angle = std::fabs(angle - middle);
  result.mirrored = different(std::move(columns), step);
  return result;
}

// A strip of a cylinder or a cone consists of straight lines. Any three that are parallel, or go through one
// point, lie on such a surface. So do any four that are mirror images in pairs, as a trapezoid has a
// circumcircle.
double spare_columns(const Orbits& orbits) {
  return std::fmin(static_cast<double>(orbits.columns) - 3, static_cast<double>(orbits.mirrored) - 2);
}

// The number of positions that differ by more than the signs of their coordinates.
std::size_t folded(const Mesh& mesh, const Shape& shape, const Eigen::Isometry3d& placement) {
  std::vector<Eigen::Vector3d> list;
  const Eigen::Isometry3d to_local = placement.inverse();
  for (const std::uint32_t v : shape.places) {
    const Eigen::Vector3d p = (to_local * to_eigen(mesh.positions[v])).cwiseAbs();
    if (std::none_of(list.begin(), list.end(), [&](const Eigen::Vector3d& q) {
          return (p - q).cwiseAbs().maxCoeff() <= same * shape.size;
        }))
      list.push_back(p);
    if (list.size() >= 64) break;  // plenty
  }
  return list.size();
}

// The number of different heights of the positions along the axis of the placement. A parabola goes through
// any two of them.
std::size_t heights(const Mesh& mesh, const Shape& shape, const Eigen::Isometry3d& placement) {
  const Eigen::Isometry3d back = placement.inverse();
  std::vector<double> result;
  for (const std::size_t i : evenly_chosen(shape.places.size(), looked_at))
    result.push_back((back * to_eigen(mesh.positions[shape.places[i]])).z());
  return different(std::move(result), same * shape.size);
}

// The number of different edge lengths on the unit ball whose image the surface is.
std::size_t lengths(const Mesh& mesh, const Shape& shape, const MeshFit& fit) {
  Eigen::Vector3d axes = Eigen::Vector3d::Ones();
  if (const auto* sphere = fit.surface.surface.get<Sphere<double>>()) axes.setConstant(sphere->radius);
  if (const auto* e = fit.surface.surface.get<Ellipsoid<double>>())
    axes = {e->semi_axis_x, e->semi_axis_y, e->semi_axis_z};
  const Eigen::Isometry3d to_local = fit.surface.placement.inverse();
  std::vector<double> values;
  for (const auto& [v, w] : shape.edges) {
    const Eigen::Vector3d a = to_local * to_eigen(mesh.positions[v]),
                          b = to_local * to_eigen(mesh.positions[w]);
    values.push_back((a - b).cwiseQuotient(axes).norm());
    if (values.size() >= 4096) break;
  }
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double tolerance = 10 * same * *middle;
  return different(std::move(values), tolerance);
}

// Whether the stored normals are the surface's, on either side.
struct Normals {
  double agree = 0;  // the share of vertices
  double tight = 0;  // the share within a degree
  std::size_t compared = 0;
};

// \param on_axis positions this near to the axis of the placement are tips, which have no normal; negative:
// there is no axis
Normals compare_normals(const Mesh& mesh, const MeshFit& fit, double on_axis) {
  const std::vector<bool> used = used_vertices(mesh);
  Mesh few;
  few.half_steps = mesh.half_steps;
  const Eigen::Isometry3d to_local = fit.surface.placement.inverse();
  for (const std::size_t v : evenly_chosen(used.size(), looked_at)) {
    const Vec3<double>& n = mesh.normals[v];
    const Eigen::Vector3d p = to_local * to_eigen(mesh.positions[v]);
    if (!used[v] || !detail::finite(n) || n == Vec3<double>{} || !(std::hypot(p.x(), p.y()) > on_axis))
      continue;
    few.positions.push_back(mesh.positions[v]);
    few.normals.push_back(n);
    if (!mesh.uvs.empty()) few.uvs.push_back(mesh.uvs[v]);
  }
  Normals result;
  std::size_t agree = 0, tight = 0;
  const std::vector<Truth> truth = truths(few, fit);
  for (std::size_t v = 0; v < truth.size(); ++v) {
    const Vec3<double>&n = few.normals[v], &m = truth[v].normal;
    if (!detail::finite(m) || truth[v].pole || !std::isfinite(truth[v].normal_deg)) continue;
    const double angle = angle_between(n, dot(n, m) < 0 ? -m : m) * 180 / M_PI;
    ++result.compared;
    agree += angle <= agree_deg;
    tight += angle <= tight_deg;
  }
  if (result.compared == 0) return result;
  result.agree = static_cast<double>(agree) / static_cast<double>(result.compared);
  result.tight = static_cast<double>(tight) / static_cast<double>(result.compared);
  return result;
}

// The share of the area whose triangles lie across the surface: more than across_deg from the mean of its
// normals at their corners. One ring of positions and a tip lie on cones that the triangles between them do
// not follow.
double share_across(const Mesh& mesh, const MeshFit& fit) {
  Mesh few;
  few.half_steps = mesh.half_steps;
  for (const std::size_t t : evenly_chosen(mesh.triangles.size(), looked_at / 3))
    for (const std::uint32_t v : mesh.triangles[t]) {
      few.positions.push_back(mesh.positions[v]);
      if (!mesh.uvs.empty()) few.uvs.push_back(mesh.uvs[v]);
    }
  const std::vector<Truth> truth = truths(few, fit);
  double area = 0, across = 0;
  for (std::size_t c = 0; c < few.positions.size(); c += 3) {
    const Vec3<double> plane =
        cross(few.positions[c + 1] - few.positions[c], few.positions[c + 2] - few.positions[c]);
    Vec3<double> normal;
    for (std::size_t k = c; k < c + 3; ++k)
      if (detail::finite(truth[k].normal) && !truth[k].pole) normal = normal + truth[k].normal;
    if (normal == Vec3<double>{} || !(norm(plane) > 0)) continue;
    area += norm(plane);
    if (angle_between(dot(plane, normal) < 0 ? -plane : plane, normal) * 180 / M_PI > across_deg)
      across += norm(plane);
  }
  return area > 0 ? across / area : 0;
}

}  // namespace

Evidence evidence_for(const Mesh& mesh, const Shape& shape, const MeshFit& fit) {
  const Prior& prior = prior_of(kind_of(fit));
  const std::string name(fit.surface.surface.info().name);
  Evidence result{.log10_odds = prior.log10_odds, .rival = "chance", .text = ""};
  const double explained = shape.thickness * shape.size / std::fmax(fit.rms, 1e-12 * shape.size);
  if (!(explained >= least_explained)) {
    result.log10_odds = -10;
    result.rival = "plane";
    result.text = "it explains the positions only " + rounded(explained, 2) + " times as well as a plane";
    return result;
  }
  const Eigen::Isometry3d& placement = fit.surface.placement;
  // Positions: spare orbits.
  Orbits orbits;
  if (prior.symmetry == Symmetry::axis) {
    orbits = rings(mesh, shape, placement);
  } else {
    orbits.count = lengths(mesh, shape, fit);
    if (prior.symmetry == Symmetry::sphere) {
      // Positions that a rotation or a mirror maps onto each other on a ball count once, whatever the axis.
      orbits.count = std::min(orbits.count, folded(mesh, shape, placement));
      for (int axis = 0; axis < 3; ++axis)
        for (const Eigen::Matrix3d& frame : {Eigen::Matrix3d(placement.linear()), shape.axes}) {
          Eigen::Isometry3d turned = placement;
          turned.linear() << frame.col((axis + 1) % 3), frame.col((axis + 2) % 3), frame.col(axis);
          orbits.count = std::min(orbits.count, rings(mesh, shape, turned).count);
        }
    }
  }
  const bool own = fit.chart == UvChart::own, affine = has_affine_uvs(fit);
  const bool ruled = prior.kind == SurfaceKind::cylinder || prior.kind == SurfaceKind::cone;
  const auto places = static_cast<double>(shape.places.size());
  const double unknowns = static_cast<double>(6 + fit.surface.surface.parameters().size()) + (affine ? 6 : 0);
  const double by_rings = static_cast<double>(orbits.count) - prior.unknowns,
               by_orbits = ruled ? std::fmin(by_rings, spare_columns(orbits)) : by_rings,
               by_places = ((own ? 3 : 1) * places - unknowns) / (own ? 3 : 1);
  const double sharp = std::fmin(1, std::log10(explained) / 3);
  const double positions = std::fmin(std::fmin(by_orbits, by_places) * sharp, most_positions);
  // Uvs: the same orbits once more, if the uvs are the surface's own.
  const double uvs =
      !own ? 0 : std::fmax(0, std::fmin(static_cast<double>(orbits.count) - (affine ? 3 : 1), most_uvs));
  // Normals that agree with the surface and not with their triangles.
  double normals = 0;
  Normals compared;
  const bool faceted = shape.is_faceted();
  if (!mesh.normals.empty() && !faceted) {
    compared = compare_normals(mesh, fit, prior.symmetry == Symmetry::axis ? same * shape.size : -1);
    if (compared.compared > 0)
      normals =
          compared.agree >= 0.8
              ? std::fmin((compared.tight >= 0.8 ? 1.5 : 1) * static_cast<double>(orbits.count), most_normals)
          : compared.agree >= 0.5 ? 0
                                  : -3;
    if (normals < 0 && share_across(mesh, fit) > most_across) {
      result.log10_odds = -10;
      result.rival = "polyhedron";
      result.text = "its triangles lie across the surface that its positions lie on";
      return result;
    }
  } else if (faceted) {
    normals = -4;
  }
  if (prior.kind == SurfaceKind::elliptic_paraboloid && !(normals > 0) &&
      heights(mesh, shape, placement) < 3) {
    result.log10_odds = -10;
    result.rival = "cone";
    result.text = name + ": its positions lie at fewer than three heights, as those of a cone do";
    return result;
  }
  // Without normals and its own uvs nothing would be compared with the surface, so positions alone must give
  // more evidence.
  const double mute = !own && mesh.normals.empty() ? -2 : 0;
  // A ring of eight sides or more with smooth normals is intended to be round.
  const double round = orbits.sides >= 8 && (normals > 0 || (own && mesh.normals.empty())) ? 2 : 0;
  const double fine = shape.turn_deg <= 15 ? 2 : shape.turn_deg <= 31 ? 1 : 0;
  result.log10_odds += positions + uvs + normals + mute + round + fine;
  result.rival = faceted         ? "faceted"
                 : normals < 0   ? "authored normals"
                 : positions < 2 ? "polyhedron"
                                 : "chance";
  result.text =
      name + ": " + std::to_string(orbits.count) +
      (prior.symmetry == Symmetry::axis ? " different rings" : " different lengths of edges") + " of " +
      std::to_string(shape.places.size()) + " positions, " + rounded(explained, 2) +
      " times as near as to a plane" + (own ? ", uvs are its own" : "") +
      (compared.compared > 0 ? ", normals agree at " + rounded(100 * compared.agree, 3) + " %" : "") +
      (faceted ? ", normals are the triangles'" : "") + ", faces turn by " + rounded(shape.turn_deg, 2) +
      " deg";
  return result;
}

}  // namespace darboux
