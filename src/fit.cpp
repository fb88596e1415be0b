#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <ceres/ceres.h>

#include <darboux/catalogue.h>
#include <darboux/ceres_jet.h>
#include <darboux/error.h>
#include <darboux/fit.h>

namespace darboux {
namespace {

constexpr std::size_t most_points = 4096;

// Usable vertices, centred and scaled to a bounding box of diagonal 1.
struct Data {
  std::vector<Vec3<double>> positions;
  std::vector<Vec2<double>> uvs;
  Eigen::Vector3d centre;
  double diagonal;
};

Data usable_vertices(const Mesh& mesh) {
  if (mesh.uvs.empty()) throw MeshError("mesh", "has no uvs, a fit needs one uv set");
  std::vector<bool> referenced(mesh.positions.size(), false);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) referenced[v] = true;
  std::vector<std::uint32_t> usable;
  Eigen::AlignedBox3d box;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const bool finite =
        detail::finite(mesh.positions[v]) && std::isfinite(mesh.uvs[v].x) && std::isfinite(mesh.uvs[v].y);
    if (!referenced[v] || !finite) continue;
    usable.push_back(v);
    box.extend(to_eigen(mesh.positions[v]));
  }
  if (usable.size() < 4)
    throw MeshError("mesh", std::to_string(usable.size()) + " usable vertices, a fit needs at least 4");
  Data data;
  data.centre = box.center();
  data.diagonal = box.diagonal().norm();
  if (!(data.diagonal > 0)) throw MeshError("mesh", "all vertices are at one point, a fit needs an extent");
  for (const std::uint32_t v : usable) {
    data.positions.push_back(from_eigen((to_eigen(mesh.positions[v]) - data.centre) / data.diagonal));
    data.uvs.push_back(mesh.uvs[v]);
  }
  return data;
}

Data evenly_chosen(const Data& all) {
  if (all.positions.size() <= most_points) return all;
  Data chosen{{}, {}, all.centre, all.diagonal};
  // One of each stretch, at random within it: a fixed stride could keep step with the rows of a grid.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (std::size_t i = 0; i < most_points; ++i) {
    const double share = (static_cast<double>(i) + uniform(random)) / static_cast<double>(most_points);
    const std::size_t v =
        std::min(all.positions.size() - 1,
                 static_cast<std::size_t>(share * static_cast<double>(all.positions.size())));
    chosen.positions.push_back(all.positions[v]);
    chosen.uvs.push_back(all.uvs[v]);
  }
  return chosen;
}

// The kinds whose position is linear in their parameters, all of them lengths: the linear start takes both for granted.
// The order is that of preference: a sphere is an ellipsoid too.
template <template <class> class... Surfaces>
struct Kinds {
  template <class F>
  static void for_each(F f) {
    (f.template operator()<Surfaces>(), ...);
  }
};
using FittedKinds = Kinds<Plane, Disk, Sphere, Cylinder, Cone, Torus, Ellipsoid>;

template <class X>
constexpr int parameter_count = static_cast<int>(X::parameters().size());

// Placement and parameters in the units of the scaled data.
template <int N>
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  std::array<double, N> parameters{};
};

template <template <class> class Surface, class S>
Vec3<S> local_position(const S* parameters, const Vec2<double>& uv) {
  using X = Surface<S>;
  X surface;
  constexpr auto list = X::parameters();
  for (std::size_t k = 0; k < list.size(); ++k) list[k].of(surface) = parameters[k];
  return jet(surface, lift<S>(uv.x), lift<S>(uv.y)).position;
}

// Position of the placed surface minus the data's.
template <template <class> class Surface>
struct Residual {
  Vec2<double> uv;
  Vec3<double> target;

  template <class S>
  bool operator()(const S* rotation, const S* translation, const S* parameters, S* residual) const {
    const Vec3<S> local = local_position<Surface>(parameters, uv);
    const Eigen::Map<const Eigen::Quaternion<S>> q(rotation);
    Eigen::Map<Eigen::Matrix<S, 3, 1>> r(residual);
    r = q * to_eigen(local) + Eigen::Map<const Eigen::Matrix<S, 3, 1>>(translation) -
        to_eigen(target).cast<S>();
    return true;
  }
};

template <template <class> class Surface, int N>
double rms(const Data& data, const UvConvention& convention, const Pose<N>& pose) {
  double sum = 0;
  for (std::size_t i = 0; i < data.positions.size(); ++i) {
    const Vec2<double> uv = convention.surface_uv(data.uvs[i]);
    const Vec3<double> local = local_position<Surface>(pose.parameters.data(), uv);
    sum += (pose.rotation * to_eigen(local) + pose.translation - to_eigen(data.positions[i])).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(data.positions.size()));
}

// The linear start: P = O + sum_k A_k B_k(u, v) with B_k = ∂P/∂p_k, and A_k = p_k Q on the span of B_k.
template <template <class> class Surface>
std::optional<Pose<parameter_count<Surface<double>>>> linear_start(const Data& data,
                                                                   const UvConvention& convention) {
  constexpr int N = parameter_count<Surface<double>>;
  using D = Dual<double, N>;
  std::array<D, N> variables;
  for (int k = 0; k < N; ++k) {
    constexpr auto list = Surface<double>::parameters();
    variables[k] = D::variable(list[k].of(Surface<double>{}), k);
  }
  const auto n = static_cast<Eigen::Index>(data.positions.size());
  Eigen::MatrixXd design(n, 1 + 3 * N), right(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3<D> p = local_position<Surface>(variables.data(), convention.surface_uv(data.uvs[i]));
    design(i, 0) = 1;
    for (int k = 0; k < N; ++k)
      design.block<1, 3>(i, 1 + 3 * k) << p.x.derivative[k], p.y.derivative[k], p.z.derivative[k];
    right.row(i) = to_eigen(data.positions[i]).transpose();
  }
  // Minimum norm where the data leave a direction open: A_k is then zero there.
  const Eigen::MatrixXd solution = design.completeOrthogonalDecomposition().solve(right);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int k = 0; k < N; ++k) sum += solution.middleRows<3>(1 + 3 * k).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  // A direction that nothing determines may be turned either way; one that is determined may not.
  if (rotation.determinant() < 0) {
    Eigen::Matrix3d u = svd.matrixU();
    u.col(2) *= -1;
    rotation = u * svd.matrixV().transpose();
  }
  Pose<N> pose;
  pose.rotation = Eigen::Quaterniond(rotation).normalized();
  pose.translation = solution.row(0).transpose();
  for (int k = 0; k < N; ++k) {
    const Eigen::Matrix3d a = rotation.transpose() * solution.middleRows<3>(1 + 3 * k).transpose();
    double trace = 0, directions = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (design.col(1 + 3 * k + axis).cwiseAbs().maxCoeff() > 1e-9) trace += a(axis, axis), ++directions;
    constexpr auto list = Surface<double>::parameters();
    pose.parameters[k] = directions > 0 ? trace / directions : list[k].of(Surface<double>{});
    if (!list[k].permitted.contains(pose.parameters[k])) {
      // A limit value is permitted data (R = 0) that rounding may push across; anything else is another
      // convention.
      if (!list[k].permitted.minimum_included || pose.parameters[k] < list[k].permitted.minimum - 1e-3)
        return std::nullopt;
      pose.parameters[k] = list[k].permitted.minimum;
    }
  }
  return pose;
}

struct Refined {
  bool converged;
  int iterations;
};

template <template <class> class Surface, int N>
Refined refine(const Data& data, const UvConvention& convention, const std::array<bool, N>& held,
               bool placement_held, Pose<N>& pose) {
  ceres::Problem problem;
  double* rotation = pose.rotation.coeffs().data();
  double* translation = pose.translation.data();
  double* parameters = pose.parameters.data();
  for (std::size_t i = 0; i < data.positions.size(); ++i)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Residual<Surface>, 3, 4, 3, N>(
            new Residual<Surface>{convention.surface_uv(data.uvs[i]), data.positions[i]}),
        nullptr, rotation, translation, parameters);
  problem.SetManifold(rotation, new ceres::EigenQuaternionManifold);
  if (placement_held) {
    problem.SetParameterBlockConstant(rotation);
    problem.SetParameterBlockConstant(translation);
  }
  constexpr auto list = Surface<double>::parameters();
  std::vector<int> constant;
  for (int k = 0; k < N; ++k) {
    if (held[k])
      constant.push_back(k);
    else
      problem.SetParameterLowerBound(
          parameters, k,
          list[k].permitted.minimum_included ? list[k].permitted.minimum : list[k].permitted.minimum + 1e-12);
  }
  if (static_cast<int>(constant.size()) == N)
    problem.SetParameterBlockConstant(parameters);
  else if (!constant.empty())
    problem.SetManifold(parameters, new ceres::SubsetManifold(N, constant));
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 50;
  options.function_tolerance = 1e-15;  // to the last digits: data are scaled to size 1
  options.gradient_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {summary.IsSolutionUsable() && summary.termination_type == ceres::CONVERGENCE,
          static_cast<int>(summary.iterations.size())};
}

template <template <class> class Surface>
MeshFit fit_kind(const Data& all, const SurfaceSpecification& kind,
                 const std::optional<Eigen::Isometry3d>& placement) {
  using X = Surface<double>;
  constexpr int N = parameter_count<X>;
  constexpr auto list = X::parameters();
  const Data data = evenly_chosen(all);
  std::array<bool, N> held{};
  X start;
  for (const auto& [name, value] : kind.parameters)
    for (int k = 0; k < N; ++k)
      if (list[k].name == name) {
        held[k] = true;
        list[k].of(start) = value;
      }
  checked(start);

  // Lengths of the data are scaled by 1 / diagonal, so every parameter that is a length is too.
  const double scale = 1 / data.diagonal;
  std::optional<MeshFit> best;
  for (const UvConvention& convention : uv_conventions()) {
    std::optional<Pose<N>> pose = linear_start<Surface>(data, convention);
    if (!pose) continue;
    for (int k = 0; k < N; ++k)
      if (held[k]) pose->parameters[k] = list[k].of(start) * scale;
    if (placement) {
      pose->rotation = Eigen::Quaterniond(placement->linear());
      pose->translation = (placement->translation() - data.centre) * scale;
    }
    // A start this far off is another convention's mesh; refining it would only confirm that.
    constexpr double hopeless = 0.2;
    Refined refined{false, 0};
    if (rms<Surface>(data, convention, *pose) < hopeless)
      refined = refine<Surface, N>(data, convention, held, placement.has_value(), *pose);
    X surface;
    bool permitted = true, degenerate = false;
    for (int k = 0; k < N; ++k) {
      // At its open bound a parameter has shrunk the surface to a line or a point.
      degenerate = degenerate || (!held[k] && !list[k].permitted.minimum_included &&
                                  pose->parameters[k] < list[k].permitted.minimum + 1e-6);
      list[k].of(surface) = held[k] ? list[k].of(start) : pose->parameters[k] * data.diagonal;
      permitted = permitted && list[k].permitted.contains(list[k].of(surface));
    }
    if constexpr (RefusesCombinations<X>) permitted = permitted && surface.refusal().empty();
    if (!permitted) continue;
    MeshFit fit{.surface = {AnySurface(surface), Eigen::Isometry3d::Identity(), convention},
                .equivalent = {}};
    fit.rms_relative = rms<Surface>(all, convention, *pose);
    fit.rms = fit.rms_relative * data.diagonal;
    fit.fits = refined.converged && !degenerate && fit.rms_relative <= fits_below;
    fit.iterations = refined.iterations;
    if (placement) {
      fit.surface.placement = *placement;
    } else {
      fit.surface.placement.linear() = pose->rotation.normalized().toRotationMatrix();
      fit.surface.placement.translation() = pose->translation * data.diagonal + data.centre;
    }
    if (best && best->fits) {
      if (fit.fits) best->equivalent.push_back(convention.name);
    } else if (!best || fit.fits || fit.rms_relative < best->rms_relative) {
      best = std::move(fit);
    }
  }
  if (!best)
    throw MeshError("mesh",
                    "no uv convention lets a " + kind.name + " start, the positions do not follow the uvs");
  return *best;
}

template <class F>
void for_each_kind(F f) {
  FittedKinds::for_each([&]<template <class> class Surface>() {
    f(Surface<double>::info.name, [](const auto&... arguments) { return fit_kind<Surface>(arguments...); });
  });
}

}  // namespace

const std::vector<std::string_view>& fitted_kinds() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> list;
    for_each_kind([&](std::string_view name, auto) { list.push_back(name); });
    return list;
  }();
  return names;
}

MeshFit fit_surface(const Mesh& mesh, const SurfaceSpecification& kind,
                    const std::optional<Eigen::Isometry3d>& placement) {
  make_surface(kind);  // refuses unknown names and values out of range
  std::optional<MeshFit> result;
  std::string known;
  for_each_kind([&](std::string_view name, auto fit) {
    known += (known.empty() ? "" : ", ") + std::string(name);
    if (name == kind.name) result = fit(usable_vertices(mesh), kind, placement);
  });
  if (!result) throw ParameterError(kind.name, "cannot be fitted to a mesh, permitted are " + known);
  return *result;
}

MeshFit fit_any_surface(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement) {
  const Data data = usable_vertices(mesh);
  std::optional<MeshFit> best;
  for_each_kind([&](std::string_view name, auto fit_this) {
    if (best && best->fits) return;
    try {
      MeshFit fit = fit_this(data, SurfaceSpecification{std::string(name), {}}, placement);
      if (!best || std::pair(!fit.fits, fit.rms_relative) < std::pair(!best->fits, best->rms_relative))
        best = std::move(fit);
    } catch (const MeshError&) {
      // Not this kind: no convention even starts.
    }
  });
  if (!best) throw MeshError("mesh", "is none of the surfaces that can be fitted");
  return *best;
}

}  // namespace darboux
