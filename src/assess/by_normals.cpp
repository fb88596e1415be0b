#include "by_normals.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"
#include "base/text.h"
#include "fit/fit_kinds.h"
#include "mesh/triangle_signs.h"
#include "mesh/used_vertices.h"

namespace darboux {
namespace {

using Eigen::Vector3d;

constexpr double near = 0.02;      // rms residual of a start: of normals, and of positions over the size
constexpr std::size_t fewest = 6;  // vertices with a normal

struct Oriented {
  Vector3d p, n;  // p relative to the centre, over the size; n unit
};

// The axis of a surface of revolution, and its lengths in units of the mesh's size.
struct Axis {
  Vector3d point, direction;
  double radius = 0, tube = 0;  // of a torus
  double along_axis = 0;        // n·direction of a cone; its apex is the point
};

std::vector<Oriented> oriented_of(const Mesh& mesh, const Shape& shape) {
  const std::vector<bool> used = used_vertices(mesh);
  std::vector<Oriented> result;
  constexpr std::size_t most = 2000;
  for (const std::size_t v : evenly_chosen(used.size(), most)) {
    const Vec3<double>& n = mesh.normals[v];
    if (!used[v] || !detail::finite(mesh.positions[v]) || !detail::finite(n) || n == Vec3<double>{}) continue;
    result.push_back({(to_eigen(mesh.positions[v]) - shape.centre) / shape.size, to_eigen(n).normalized()});
  }
  return result;
}

// The direction along which the components of unit vectors are most nearly constant, and that constant.
// \param centred whether the constant may differ from 0
std::pair<Vector3d, double> constant_along(const std::vector<Vector3d>& normals, bool centred) {
  Vector3d mean = Vector3d::Zero();
  const auto count = static_cast<double>(normals.size());
  if (centred)
    for (const Vector3d& n : normals) mean += n / count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& n : normals) spread += (n - mean) * (n - mean).transpose() / count;
  const Vector3d axis = symmetric_eigen(spread).vectors.col(0);
  return {axis, mean.dot(axis)};
}

// The least-squares circle through points of a plane: its centre and radius.
std::optional<Vector3d> circle(const std::vector<std::array<double, 2>>& points) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const auto& [x, y] : points) {
    const Vector3d row(2 * x, 2 * y, 1);
    normal += row * row.transpose();
    right += (x * x + y * y) * row;
  }
  const std::optional<Vector3d> s = solve_regular(normal, right);
  if (!s) return std::nullopt;
  const double square = s->z() + s->x() * s->x() + s->y() * s->y();
  if (!(square > 0)) return std::nullopt;
  return Vector3d(s->x(), s->y(), std::sqrt(square));
}

std::pair<Vector3d, Vector3d> across(const Vector3d& axis) {
  const Vector3d x = axis.unitOrthogonal();
  return {x, axis.cross(x)};
}

std::optional<Axis> cylinder(const std::vector<Oriented>& list) {
  std::vector<Vector3d> normals;
  for (const Oriented& o : list) normals.push_back(o.n);
  const auto [axis, none] = constant_along(normals, false);
  const auto [x, y] = across(axis);
  std::vector<std::array<double, 2>> points;
  double lean = 0;
  for (const Oriented& o : list) {
    lean += o.n.dot(axis) * o.n.dot(axis) / static_cast<double>(list.size());
    points.push_back({o.p.dot(x), o.p.dot(y)});
  }
  if (!(std::sqrt(lean) <= near)) return std::nullopt;
  const auto round = circle(points);
  if (!round) return std::nullopt;
  return Axis{round->x() * x + round->y() * y, axis, round->z()};
}

std::optional<Axis> cone(std::vector<Oriented> list) {
  Vector3d axis;
  double height = 0;
  for (int round = 0; round < 2; ++round) {
    std::vector<Vector3d> normals;
    for (const Oriented& o : list) normals.push_back(o.n);
    std::tie(axis, height) = constant_along(normals, true);
    // The normal at an apex is not that of the cone's side.
    std::erase_if(list, [&](const Oriented& o) { return std::fabs(o.n.dot(axis) - height) > 5 * near; });
    if (list.size() < fewest) return std::nullopt;
  }
  double lean = 0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const Oriented& o : list) {
    lean += (o.n.dot(axis) - height) * (o.n.dot(axis) - height) / static_cast<double>(list.size());
    normal += o.n * o.n.transpose();
    right += o.n.dot(o.p) * o.n;
  }
  if (!(std::sqrt(lean) <= near) || std::fabs(height) < near || std::fabs(height) > 0.999)
    return std::nullopt;
  const std::optional<Vector3d> apex = solve_regular(normal, right);
  if (!apex) return std::nullopt;
  return Axis{.point = *apex, .direction = axis, .along_axis = height};
}

// The lines of all normals meet the axis: (p × n)·a + n·m = 0 with a its direction and m the moment of a
// point on it.
std::optional<Axis> torus(const std::vector<Oriented>& list) {
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  for (const Oriented& o : list) {
    Eigen::Matrix<double, 6, 1> row;
    row << o.p.cross(o.n), o.n;
    sum += row * row.transpose() / static_cast<double>(list.size());
  }
  const auto [squares, lines] = symmetric_eigen(Eigen::MatrixXd(sum));
  if (!(std::sqrt(std::fmax(squares[0], 0)) <= near)) return std::nullopt;
  const Eigen::Matrix<double, 6, 1> line = lines.col(0);
  const double length = line.head<3>().norm();
  if (!(length > 1e-3)) return std::nullopt;
  const Vector3d axis = line.head<3>() / length, moment = line.tail<3>() / length;
  if (std::fabs(axis.dot(moment)) > near) return std::nullopt;  // a screw
  const Vector3d point = moment.cross(axis);
  std::vector<std::array<double, 2>> profile;
  for (const Oriented& o : list) {
    const Vector3d d = o.p - point;
    profile.push_back({(d - d.dot(axis) * axis).norm(), d.dot(axis)});
  }
  const auto round = circle(profile);
  if (!round || !(round->x() > round->z())) return std::nullopt;
  return Axis{point + round->y() * axis, axis, round->x(), round->z()};
}

}  // namespace

std::optional<MeshFit> fit_by_normals(const Mesh& mesh, const Shape& shape, SurfaceKind kind) {
  if (mesh.normals.empty() || shape.is_faceted()) return std::nullopt;
  const std::vector<Oriented> list = oriented_of(mesh, shape);
  if (list.size() < fewest) return std::nullopt;
  std::optional<Axis> axis;
  if (kind == SurfaceKind::cylinder) axis = cylinder(list);
  if (kind == SurfaceKind::cone) axis = cone(list);
  if (kind == SurfaceKind::torus) axis = torus(list);
  if (!axis || !axis->point.allFinite()) return std::nullopt;
  // The mesh with the surface's own (u, v) of each position, for the fit.
  Mesh charted;
  charted.triangles = mesh.triangles;
  charted.positions = mesh.positions;
  const auto [x, y] = across(axis->direction);
  double lowest = 0, highest = 0, longest = 0;
  // Along the straight lines of a cone, so errors of positions along them do not count as distance.
  const double across_axis = std::sqrt(1 - axis->along_axis * axis->along_axis);
  const auto from_apex = [&](const Vector3d& q) {
    return std::fabs(axis->along_axis) * std::hypot(q.x(), q.y()) -
           std::copysign(across_axis, axis->along_axis) * q.z();
  };
  std::vector<Vector3d> local;
  for (const Vec3<double>& p : mesh.positions) {
    const Vector3d d = (to_eigen(p) - shape.centre) / shape.size - axis->point;
    local.emplace_back(d.dot(x), d.dot(y), d.dot(axis->direction));
    if (!local.back().allFinite()) continue;
    lowest = std::fmin(lowest, local.back().z()), highest = std::fmax(highest, local.back().z());
    longest = std::fmax(longest, from_apex(local.back()));
  }
  if (kind == SurfaceKind::cone && !(longest > 0)) return std::nullopt;
  for (const Vector3d& q : local) {
    const double r = std::hypot(q.x(), q.y()), u = std::atan2(q.y(), q.x()) / (2 * M_PI);
    const double v = kind == SurfaceKind::cylinder ? (q.z() - lowest) / std::fmax(highest - lowest, 1e-12)
                     : kind == SurfaceKind::cone   ? 1 - from_apex(q) / longest
                                                   : std::atan2(q.z(), r - axis->radius) / (2 * M_PI);
    charted.uvs.push_back({u, v});
  }
  try {
    std::optional<MeshFit> fit =
        fit_kinds(charted, std::nullopt, std::array{name_in(surface_kind_names, kind)}, UvMaps::plain,
                  triangle_signs(charted));
    if (!fit || !fit->fits) return std::nullopt;
    fit->chart = UvChart::unknown;
    fit->equivalent.clear();
    return fit;
  } catch (const MeshError&) {
    return std::nullopt;
  }
}

}  // namespace darboux
