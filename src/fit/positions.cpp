// A mesh's surface from its positions alone, and the truth at its vertices.
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include <darboux/error.h>
#include <darboux/fit_mesh.h>

#include "base/evenly_chosen.h"
#include "base/linear_algebra.h"
#include "fit/common/arguments.h"
#include "fit/primitives/fit_primitives.h"
#include "fit/primitives/list.h"
#include "fit_kinds.h"
#include "mesh/triangle_signs.h"
#include "mesh/used_vertices.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t fitted_vertices = 1024;
constexpr double tip_share =
    30;  // a normal is known to two degrees if its radius is this many times the error
constexpr double far_share = 10 * fits_below;  // of the size: no vertex is farther from the surface

// Vertices that triangles use and whose positions are finite.
std::vector<std::uint32_t> usable_vertices(const Mesh& mesh) {
  const std::vector<bool> used = used_vertices(mesh);
  std::vector<std::uint32_t> result;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v] && detail::finite(mesh.positions[v])) result.push_back(v);
  return result;
}

// a, b and d of MeshFit::projection, if the uvs are a projection. Positions are those of `vertices`, over the
// size of the mesh.
std::optional<Eigen::Matrix3d> projection_of(const Mesh& mesh, const std::vector<std::uint32_t>& vertices,
                                             const Eigen::Vector3d& centre, double size) {
  const auto n = static_cast<Eigen::Index>(vertices.size());
  Eigen::Matrix<double, Eigen::Dynamic, 3> uv1(n, 3), p(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::uint32_t v = vertices[static_cast<std::size_t>(i)];
    uv1.row(i) << mesh.uvs[v].x, mesh.uvs[v].y, 1;
    p.row(i) = (to_eigen(mesh.positions[v]) - centre).transpose() / size;
  }
  if (!uv1.allFinite()) return std::nullopt;
  const std::optional<Eigen::MatrixXd> affine = solve_least_squares(uv1, p);
  if (!affine) return std::nullopt;
  const Eigen::Matrix<double, Eigen::Dynamic, 3> rest = p - uv1 * *affine;
  const auto spread = symmetric_eigen(Eigen::Matrix3d(rest.transpose() * rest / static_cast<double>(n)));
  if (!(std::sqrt(std::fmax(spread.values[1], 0)) <= fits_below)) return std::nullopt;
  Eigen::Matrix3d result;
  result << size * affine->row(0).transpose(), size * affine->row(1).transpose(), spread.vectors.col(2);
  // Uvs along a line in the projected plane are not a projection.
  const Eigen::Vector3d seen = result.col(0).cross(result.col(1));
  if (!(std::fabs(seen.dot(result.col(2))) > 1e-6 * result.col(0).norm() * result.col(1).norm()))
    return std::nullopt;
  return result;
}

// Sets the given parameters and placement. The other parameters move to their likeliest values under that
// condition, with the fit's covariance taken as Gaussian; the covariance shrinks accordingly. False if the
// result is not a surface.
bool hold(const std::optional<SurfaceSpecification>& kind, const std::optional<Eigen::Isometry3d>& placement,
          PointFit& found) {
  Eigen::MatrixXd& c = found.covariance;
  Eigen::VectorXd move = Eigen::VectorXd::Zero(c.rows());
  std::vector<double> values;
  std::vector<Eigen::Index> held;
  for (const ParameterValue& p : found.surface->surface.parameters()) {
    const auto k = static_cast<Eigen::Index>(6 + values.size());
    values.push_back(p.value);
    if (!kind) continue;
    for (const auto& [name, value] : kind->parameters)
      if (name == p.name) {
        held.push_back(k);
        move[k] = value - p.value;
      }
  }
  if (!held.empty()) {
    const Eigen::MatrixXd gain =
        solve_least_norm(c(held, held), Eigen::MatrixXd(c(held, Eigen::all))).transpose();
    const Eigen::VectorXd given = move(held);
    move = gain * given;
    c -= (gain * c(held, Eigen::all)).eval();
    move(held) = given;
    c(held, Eigen::all).setZero();
    c(Eigen::all, held).setZero();
  }
  Eigen::Isometry3d& at = found.surface->placement;
  if (placement) {
    at = *placement;
    c.topRows<6>().setZero();
    c.leftCols<6>().setZero();
  } else if (const double angle = move.head<3>().norm(); angle > 0) {
    const Eigen::AngleAxisd turn(angle, move.head<3>() / angle);
    at.translation() = found.centre + turn * (at.translation() - found.centre);
    at.linear() = (turn * at.linear()).eval();
  }
  if (!placement) at.translation() += move.segment<3>(3);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] += move[static_cast<Eigen::Index>(6 + k)];
  for (std::size_t k = 0; kind && k < values.size(); ++k)  // exactly
    for (const auto& [name, value] : kind->parameters)
      if (name == found.surface->surface.parameters()[k].name) values[k] = value;
  try {
    found.surface->surface = found.surface->surface.with(values);
  } catch (const ParameterError&) {
    return false;
  }
  return true;
}

}  // namespace

std::optional<MeshFit> fit_positions(const Mesh& mesh, const std::optional<SurfaceSpecification>& only,
                                     const std::optional<Eigen::Isometry3d>& placement) {
  check_consistent(mesh, "mesh");
  fit::check_placement(placement);
  const std::vector<std::uint32_t> vertices = usable_vertices(mesh);
  PointCloud cloud;
  Eigen::AlignedBox3d box;
  for (const std::uint32_t v : vertices) box.extend(to_eigen(mesh.positions[v]));
  for (const std::size_t i : evenly_chosen(vertices.size(), fitted_vertices))
    cloud.positions.push_back(mesh.positions[vertices[i]]);
  const double size = box.isEmpty() ? 0 : box.diagonal().stableNorm();
  for (const fit::Primitive* primitive : fit::primitives()) {
    if (only && only->name != primitive->name) continue;
    PointFit found =
        fit::fit_primitives(cloud, {.surface = std::string(primitive->name)}, primitive, fit::Effort::plain);
    if (!found.usable || !(found.rms <= fits_below * size) || !hold(only, placement, found)) continue;
    double squares = 0, farthest = 0;
    for (const std::uint32_t v : vertices) {
      const double d = norm(frame_near(found, mesh.positions[v]).position - mesh.positions[v]);
      squares += d * d;
      farthest = std::fmax(farthest, d);
    }
    const double rms = std::sqrt(squares / static_cast<double>(vertices.size()));
    if (!(rms <= fits_below * size) || farthest > far_share * size) continue;
    MeshFit fit{{found.covariance, found.centre}, *found.surface};
    fit.rms = rms;
    fit.rms_relative = rms / size;
    fit.sigma = only || placement ? rms : found.sigma;
    fit.fits = true;
    fit.iterations = found.iterations;
    fit.chart = UvChart::unknown;
    if (mesh.uvs.empty()) return fit;
    if (const auto projection = projection_of(mesh, vertices, box.center(), size)) {
      fit.chart = UvChart::projected;
      fit.projection = *projection;
    }
    return fit;
  }
  return std::nullopt;
}

std::vector<Truth> truths(const Mesh& mesh, const MeshFit& fit) {
  check_consistent(mesh, "mesh");
  if (fit.chart == UvChart::own && mesh.uvs.empty() && !mesh.positions.empty())
    throw MeshError("mesh", "expected uvs, which the fit has, got none");
  return truths(mesh, fit, fit.chart == UvChart::own ? triangle_signs(mesh) : std::vector<signed char>{});
}

std::vector<Truth> truths(const Mesh& mesh, const MeshFit& fit, std::span<const signed char> signs) {
  const Vec3<double> none = detail::nan_vector<double>();
  const Truth unknown{none, none, none, none, Status::no_frame, false, infinity, infinity};
  std::vector<Truth> result;
  if (fit.chart == UvChart::own) {
    result = truths_at(fit, mesh.uvs);
    std::vector<bool> used(mesh.positions.size(), false), with_area(mesh.positions.size(), false);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t]) {
        used[v] = true;
        if (signs[t] != 0) with_area[v] = true;
      }
    for (std::size_t v = 0; v < used.size(); ++v)
      if (used[v] && !with_area[v]) result[v] = unknown;
    return result;
  }
  result.reserve(mesh.positions.size());
  const Eigen::Vector3d d = fit.projection.col(2);
  // A cone's apex has no normal, and a point within the error of the positions from it may be on any side of
  // it.
  const fit::Primitive* primitive = fit::primitive_named(fit.surface.surface.info().name);
  const bool tipped = primitive && primitive->has_apex;
  const Eigen::Isometry3d to_local = fit.surface.placement.inverse();
  const auto known_to = [&](const Vec3<double>& p) {
    return std::fmax(fit.rms,
                     std::fmax(mesh.half_steps.position, 0x1p-24 * to_eigen(p).cwiseAbs().maxCoeff()));
  };
  const auto is_tip = [&](const Vec3<double>& p) {
    if (!tipped) return false;
    const Eigen::Vector3d q = to_local * to_eigen(p);
    return std::hypot(q.x(), q.y()) <= tip_share * known_to(p);
  };
  // Where a projection looks along the surface, its tangent turns by 180 degrees. Returns whether p is away
  // from there by ten times the error of its position and normal: a deviation is 6 degrees then.
  const auto is_seen = [&](const Vec3<double>& p, const UncertainFrame& frame) {
    constexpr double surely = 10, steep = 0.1;
    const double facing = to_eigen(frame.n).dot(d);
    if (!(std::fabs(facing) > surely * frame.normal_deg * std::numbers::pi / 180)) return false;
    if (std::fabs(facing) > steep) return true;
    const Vec3<double> away = surely * known_to(p) * from_eigen(d);
    return to_eigen(frame_near(fit.surface, fit, p + away).n).dot(d) * facing > 0 &&
           to_eigen(frame_near(fit.surface, fit, p - away).n).dot(d) * facing > 0;
  };
  for (const Vec3<double>& p : mesh.positions) {
    Truth truth = unknown;
    if (is_tip(p)) {
      truth.pole = true;
    } else if (detail::finite(p)) {
      const UncertainFrame frame = frame_near(fit.surface, fit, p);
      truth.position = frame.position;
      truth.normal = frame.n;
      truth.normal_deg = frame.normal_deg;
      truth.status = frame.status;
      if (fit.chart == UvChart::projected && detail::finite(frame.n) && is_seen(p, frame)) {
        const Eigen::Vector3d n = to_eigen(frame.n);
        const double facing = n.dot(d);
        const Eigen::Vector3d t = fit.projection.col(0) - n.dot(fit.projection.col(0)) / facing * d,
                              b = fit.projection.col(1) - n.dot(fit.projection.col(1)) / facing * d;
        truth.tangent = from_eigen(t.normalized());
        truth.bitangent = from_eigen(b.normalized());
        // n turned by δ moves t by (t·δ) d / (n·d).
        truth.tangent_deg = frame.normal_deg * t.normalized().cross(d).norm() / std::fabs(facing);
      }
    }
    result.push_back(truth);
  }
  return result;
}

}  // namespace darboux
