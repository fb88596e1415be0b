#include <algorithm>
#include <cmath>

#include <darboux/error.h>
#include <darboux/fit_mesh.h>

#include "base/evenly_chosen.h"
#include "base/quantile.h"
#include "fit/common/arguments.h"
#include "fit/common/kinds.h"
#include "fit/common/parameter_jet.h"
#include "fit/uv/starts.h"
#include "fit_kinds.h"
#include "mesh/area_vector.h"
#include "mesh/triangle_signs.h"

namespace darboux {
namespace {

// The number of vertices used before all of them: for a linear start, and to test whether a surface fits at
// all.
constexpr std::size_t start_points = 80, trial_points = 2048;

// A start this far off belongs to another convention; refining it would only confirm that.
constexpr double hopeless = 0.2;
// A start with a larger rms distance is not refined either: rounding would hide everything else.
constexpr double too_far = 1e6;

// If a fit to the few points is still this many times above the limit after first_steps, it is not refined on
// more points: fits that succeed get there in fewer than eight steps.
constexpr double hopeless_share = 30;
constexpr int first_steps = 12;

// An affine map is so flexible that it must fit better: within this share of fits_below.
constexpr double affine_share = 1e-2;

// No vertex counts as an outlier.
constexpr fit::Mixture least_squares;

// Usable vertices, centred and scaled to a bounding box of diagonal 1.
struct Data {
  fit::NormalisedPoints all, trial, few;
  std::vector<double> shears;  // that edges suggest
  // The rms distance due to rounding of the stored positions, and of positions and uvs, with a margin.
  double rounding = 0, rounding_with_uvs = 0;
};

// The slopes Δu/Δv that most edges have: in a sheared grid, those of its columns and diagonals.
std::vector<double> slopes_of_edges(const Mesh& mesh, std::span<const signed char> signs) {
  constexpr std::size_t looked_at = 2000, most = 3;
  std::vector<double> slopes;
  for (const std::size_t t : evenly_chosen(mesh.triangles.size(), looked_at)) {
    if (signs[t] == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2<double>&a = mesh.uvs[mesh.triangles[t][k]], &b = mesh.uvs[mesh.triangles[t][(k + 1) % 3]];
      const double slope = (b.x - a.x) / (b.y - a.y);
      if (std::fabs(slope) < 1e4) slopes.push_back(slope);
    }
  }
  std::sort(slopes.begin(), slopes.end());
  std::vector<std::pair<std::size_t, double>> groups;  // the size, and the slope in the middle
  for (std::size_t first = 0, last = 0; first < slopes.size(); first = last) {
    const double end = slopes[first] + 1e-3 * (1 + std::fabs(slopes[first]));
    while (last < slopes.size() && slopes[last] <= end) ++last;
    groups.emplace_back(last - first, slopes[(first + last) / 2]);
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<double> result;
  for (const auto& [count, slope] : groups)
    if (result.size() < most && 10 * count > slopes.size()) result.push_back(slope);
  return result;
}

// The rms distance by which rounding of the stored uvs moves most points, estimated from the mesh's own
// edges. It may differ much along u and v; a third of a grid's edges run along u, a third along v, and a
// third are diagonals.
double moved_by_uvs(const Mesh& mesh, std::span<const signed char> signs) {
  constexpr std::size_t looked_at = 2000;
  std::vector<double> moved;
  for (const std::size_t t : evenly_chosen(mesh.triangles.size(), looked_at)) {
    if (signs[t] == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      const auto &from = mesh.uvs[a], &to = mesh.uvs[b];
      const double half_step =
          std::fmax(mesh.half_steps.uv, 0x1p-24 * std::fmax(std::fabs(from.x), std::fabs(from.y)));
      const double by_uv =
          norm(mesh.positions[b] - mesh.positions[a]) / norm(Vec2<double>{to.x - from.x, to.y - from.y});
      if (std::isfinite(by_uv))
        moved.push_back(std::sqrt(2.0 / 3) * half_step * by_uv);  // of two coordinates
    }
  }
  return moved.empty() ? 0 : quantile(moved, 0.8);
}

Data usable_vertices(const Mesh& mesh, std::span<const signed char> signs) {
  if (mesh.uvs.empty()) throw UndeterminedError("mesh", "has no uvs, a fit needs one uv set");
  // Triangles without area do not count: their uvs or positions have collapsed.
  std::vector<bool> referenced(mesh.positions.size(), false);
  const bool any = std::any_of(signs.begin(), signs.end(), [](signed char s) { return s != 0; });
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (signs[t] != 0 || !any) referenced[v] = true;
  std::vector<std::uint32_t> usable;
  Eigen::AlignedBox3d box;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (!referenced[v] || !detail::finite(mesh.positions[v]) || !fit::usable_uv(mesh.uvs[v])) continue;
    usable.push_back(v);
    box.extend(to_eigen(mesh.positions[v]));
  }
  if (usable.size() < 4)
    throw UndeterminedError("mesh",
                            std::to_string(usable.size()) + " usable vertices, a fit needs at least 4");
  Data data;
  data.all.centre = box.center();
  data.all.scale = box.diagonal().stableNorm();
  if (!(data.all.scale > 0))
    throw UndeterminedError("mesh", "all vertices are at one point, a fit needs an extent");
  const Eigen::Vector3d largest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
  constexpr double room = 1.5;
  const double of_positions =
      std::fmax(mesh.half_steps.position, 0x1p-24 / std::sqrt(3) * largest.stableNorm());
  data.rounding = room * of_positions / data.all.scale;
  // Coarser uvs give no information about a surface.
  const double of_uvs = std::fmin(moved_by_uvs(mesh, signs) / data.all.scale, 10 * fits_below);
  data.rounding_with_uvs = std::hypot(data.rounding, room * of_uvs);
  data.all.cloud.resize(3, static_cast<Eigen::Index>(usable.size()));
  data.all.uvs.reserve(usable.size());
  for (const std::uint32_t v : usable) {
    const auto column = static_cast<Eigen::Index>(data.all.uvs.size());
    data.all.cloud.col(column) = (to_eigen(mesh.positions[v]) - data.all.centre) / data.all.scale;
    data.all.uvs.push_back(mesh.uvs[v]);
  }
  data.trial = data.all.chosen(trial_points, 1);
  data.few = data.trial.chosen(start_points, 1);
  data.shears = slopes_of_edges(mesh, signs);
  return data;
}

// A fit to the trial points.
struct Trial {
  UvModel model;
  UvState state;
  double rms;
  bool fits;
  int iterations;
  std::vector<std::string_view> equivalent{};
};

double rms(const std::vector<double>& squares) {
  double sum = 0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}
double rms(const UvModel& model, const UvState& state) {
  return rms(model.squares(state));
}

// The caller's request, and the values that are held.
struct Wanted {
  const UvKind& kind;
  std::vector<std::pair<std::string, double>> parameters{};  // held values
  std::optional<AnySurface> exact{};                         // all held except its placement
  std::optional<Eigen::Isometry3d> placement{};
  enum class Roundings { ignored, of_positions, of_all } roundings = Roundings::ignored;
  const Mesh* mesh = nullptr;  // its side decides if the surface is exact; nullptr: no side is required

  // The rms distance up to which it fits. Rounding widens the limit only for declared surfaces.
  double limit(const Data& data, bool affine) const {
    const double rounding = roundings == Roundings::of_all         ? data.rounding_with_uvs
                            : roundings == Roundings::of_positions ? data.rounding
                                                                   : 0;
    return std::fmax(fits_below * (affine ? affine_share : 1), rounding);
  }

  UvHeld held(double size, const Eigen::Vector3d& centre) const {
    UvHeld result;
    result.parameters.resize(kind.parameters.size());
    if (exact) result.parameters.front() = 1 / size;
    for (const auto& [name, value] : parameters)
      for (std::size_t k = 0; k < kind.parameters.size(); ++k)
        if (kind.parameters[k].name == name) result.parameters[k] = value / (kind.length[k] ? size : 1);
    if (placement) {
      result.placement = *placement;
      result.placement->translation() = (placement->translation() - centre) / size;
    }
    return result;
  }
};

std::optional<AnySurface> surface_of(const Data& data, const UvModel& model, const UvState& state,
                                     const Wanted& wanted) {
  if (wanted.exact) return wanted.exact;
  const double size = data.all.scale;
  const UvKind& kind = *model.kind;
  SurfaceSpecification result{std::string(kind.name), {}};
  for (std::size_t k = 0; k < state.parameters.size(); ++k) {
    const ParameterValue& p = kind.parameters[k];
    if (!model.held[k] && kind.vanishes(static_cast<int>(k), state.parameters[k], data.rounding))
      return std::nullopt;
    const auto held = std::find_if(wanted.parameters.begin(), wanted.parameters.end(),
                                   [&](const auto& g) { return g.first == p.name; });
    result.parameters.emplace_back(p.name, held != wanted.parameters.end()
                                               ? held->second
                                               : state.parameters[k] * (kind.length[k] ? size : 1));
  }
  try {
    return make_surface(result);
  } catch (const ParameterError&) {
    return std::nullopt;  // the values contradict each other
  }
}

// Whether the points identify everything that is estimated, with coordinates to spare: points on a line lie
// on a thin strip in any placement.
bool determined(const UvModel& model, const UvState& state) {
  return 3 * model.points->count() > model.unknowns() &&
         model.spread(state, model.sums(state, least_squares)).undetermined.empty();
}

Eigen::Isometry3d placement_of(const Data& data, const UvState& state, const Wanted& wanted) {
  if (wanted.placement) return *wanted.placement;
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = state.rotation.toRotationMatrix();
  result.translation() = state.translation * data.all.scale + data.all.centre;
  return result;
}

// Whether the surface's n is on the side of the mesh's normals or, without normals, of its triangles: a
// half-turn maps some surfaces to themselves with their sides exchanged, and one flip of the uvs to another.
// True if no side is required.
bool is_on_side(const Data& data, const Trial& trial, const Wanted& wanted) {
  if (!wanted.mesh) return true;
  constexpr std::size_t enough = 256;
  const Mesh& mesh = *wanted.mesh;
  const PlacedSurface surface{*wanted.exact, placement_of(data, trial.state, wanted),
                              trial.model.whole_convention(trial.state)};
  const std::size_t step = std::max<std::size_t>(1, mesh.triangles.size() / enough);
  int sides = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += step) {
    const Triangle& triangle = mesh.triangles[t];
    const std::uint32_t v = triangle[0];
    const Vec3<double> n = mesh.normals.empty() ? area_vector(mesh, triangle) : mesh.normals[v];
    const double cosine = dot(n, surface.truth(mesh.uvs[v]).normal);
    sides += cosine > 0 ? 1 : cosine < 0 ? -1 : 0;
  }
  return sides >= 0;
}

// The fit from one start; none if it ends at parameters that are not permitted.
std::optional<Trial> fit_from(const Data& data, UvStart start, const Wanted& wanted) {
  start.model.points = &data.trial;
  Solved solved;
  const double most = hopeless_share * fits_below;
  if (start.median < hopeless && start.least_rms <= most && rms(start.model, start.state) < too_far) {
    // If it is far from a few of the points, it is far from all.
    start.model.points = &data.few;
    solved = start.model.solve(start.state, least_squares, 1e-3, first_steps);
    const bool far = rms(start.model, start.state) > most;
    start.model.points = &data.trial;
    if (far)
      solved.converged = false;
    else
      solved = start.model.solve(start.state, least_squares, 1e-14);
  }
  if (!surface_of(data, start.model, start.state, wanted)) return std::nullopt;
  const double error = rms(start.model, start.state);
  if (!std::isfinite(error)) return std::nullopt;
  // At the level of rounding nothing is left to converge to: a length may sit at its bound.
  bool fits = (solved.converged || error <= data.rounding_with_uvs) &&
              error <= wanted.limit(data, !start.model.free_affine.empty());
  if (fits && !determined(start.model, start.state)) {
    // If the result is a surface of revolution, the offset of u is a rotation about its axis, and is held.
    fits = std::erase(start.model.free_affine, 4) == 1 && determined(start.model, start.state);
  }
  return Trial{start.model, start.state, error, fits, solved.iterations};
}

void keep_better(std::optional<Trial>& best, std::optional<Trial> trial) {
  if (trial &&
      (!best || (trial->fits && !best->fits) || (trial->fits == best->fits && trial->rms < best->rms)))
    best = std::move(trial);
}

// The first of uv_conventions() that fits, else the best.
std::optional<Trial> try_conventions(const Data& data, const Wanted& wanted) {
  std::optional<Trial> best;
  const UvHeld held = wanted.held(data.all.scale, data.all.centre);
  for (UvStart& start : convention_starts(wanted.kind, data.few, held, false).proper) {
    std::optional<Trial> trial = fit_from(data, std::move(start), wanted);
    if (best && best->fits) {
      if (!trial || !trial->fits) continue;
      if (!is_on_side(data, *best, wanted) && is_on_side(data, *trial, wanted)) {
        trial->equivalent = std::move(best->equivalent);
        std::swap(best, trial);
      }
      best->equivalent.push_back(trial->model.convention.name);
    } else {
      keep_better(best, std::move(trial));
    }
  }
  return best;
}

// Several maps may go through the same points. The intended one stays in the surface's domain, not beyond its
// pole or apex, and is the least steep: with few columns, a map several times as steep meets the points too.
double strangeness(const UvModel& model, const UvState& state) {
  const auto& m = state.affine;
  const double outside = outside_of_domain(*model.kind, model.whole_convention(state), model.points->uvs);
  constexpr double rounding = 1e-3;
  return std::hypot(std::hypot(m[0], m[1]), std::hypot(m[2], m[3])) * (outside > rounding ? 1e3 : 1);
}

std::optional<Trial> try_affine(const Data& data, const Wanted& wanted) {
  // Two points more than any such surface can interpolate: nearly every quad lies on a Möbius strip.
  if (3 * data.all.count() < 6 + wanted.kind.parameters.size() + 6 + 6) return std::nullopt;
  std::optional<Trial> best;
  for (UvStart& start : affine_starts(wanted.kind, data.few, wanted.held(data.all.scale, data.all.centre),
                                      false, data.shears)) {
    if (!best || !best->fits) {
      keep_better(best, fit_from(data, std::move(start), wanted));
      continue;
    }
    // At most as strange if the best one is on the wrong side, else less strange.
    const double best_strangeness = strangeness(best->model, best->state);
    if (!(strangeness(start.model, start.state) < 1.1 * best_strangeness)) continue;
    const bool other_side = !is_on_side(data, *best, wanted);
    const double most = (other_side ? 1.1 : 0.9) * best_strangeness;
    if (!(strangeness(start.model, start.state) < most)) continue;
    std::optional<Trial> trial = fit_from(data, std::move(start), wanted);
    if (trial && trial->fits && trial->rms <= std::fmax(2 * best->rms, data.rounding_with_uvs) &&
        strangeness(trial->model, trial->state) < most && (!other_side || is_on_side(data, *trial, wanted)))
      best = std::move(trial);
  }
  return best;
}

// The covariance of a rigid_kind(), whose one length is held, with the surface's own parameters in place of
// that length. They are held too, so they have no variance.
Eigen::MatrixXd with_exact_parameters(const Eigen::MatrixXd& covariance, const AnySurface& surface) {
  const Eigen::Index own = SurfaceWithParameters(surface).parameters(), of_map = covariance.rows() - 7;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(6 + own + of_map, 6 + own + of_map);
  result.topLeftCorner<6, 6>() = covariance.topLeftCorner<6, 6>();
  result.topRightCorner(6, of_map) = covariance.topRightCorner(6, of_map);
  result.bottomLeftCorner(of_map, 6) = covariance.bottomLeftCorner(of_map, 6);
  result.bottomRightCorner(of_map, of_map) = covariance.bottomRightCorner(of_map, of_map);
  return result;
}

// The result, from all vertices.
MeshFit completed(const Data& data, Trial trial, const Wanted& wanted) {
  trial.model.points = &data.all;
  if (trial.fits) {
    fit::MixtureInVolume without_outliers;
    UvState state = trial.state;
    trial.model.polish(state, without_outliers, 6);
    if (surface_of(data, trial.model, state, wanted)) trial.state = state;
  }
  MeshFit fit{{},
              {*surface_of(data, trial.model, trial.state, wanted), Eigen::Isometry3d::Identity(),
               trial.model.whole_convention(trial.state)}};
  fit.equivalent = trial.equivalent;
  std::vector<double> squares;
  UvSums sums;
  if (trial.fits)
    sums = trial.model.sums(trial.state, least_squares, &squares);
  else
    squares = trial.model.squares(trial.state);
  fit.rms_relative = rms(squares);
  fit.rms = fit.rms_relative * data.all.scale;
  fit.fits = trial.fits && fit.rms_relative <= wanted.limit(data, false);
  const auto n = static_cast<double>(data.all.count());
  if (fit.fits) {  // so there are more coordinates than unknowns
    const double sigma =
        fit.rms_relative * std::sqrt(n / (3 * n - static_cast<double>(trial.model.unknowns())));
    fit.sigma = sigma * data.all.scale;
    const UvSpread spread = trial.model.spread(trial.state, sums);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto p : data.all.cloud.colwise()) centre += p / n;
    static_cast<SurfaceUncertainty&>(fit) =
        trial.model.uncertainty(trial.state, sigma * sigma * spread.covariance, centre);
    if (wanted.exact) fit.covariance = with_exact_parameters(fit.covariance, *wanted.exact);
  }
  fit.iterations = trial.iterations;
  fit.surface.placement = placement_of(data, trial.state, wanted);
  return fit;
}

DeclaredFit declared(const Data& data, const Trial& best, const Wanted& wanted) {
  return {completed(data, best, wanted), wanted.limit(data, !best.model.free_affine.empty())};
}

MeshError no_start(std::string_view name) {
  return MeshError("mesh",
                   "under no uv convention do the positions follow the uvs on " + fit::with_article(name));
}

}  // namespace

const std::vector<std::string_view>& fitted_kinds() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> list;
    for (const UvKind& kind : uv_kinds()) list.push_back(kind.name);
    return list;
  }();
  return names;
}

MeshFit fit_surface(const Mesh& mesh, const SurfaceSpecification& given,
                    const std::optional<Eigen::Isometry3d>& placement) {
  check_consistent(mesh, "mesh");
  return fit_declared(mesh, given, placement, triangle_signs(mesh)).fit;
}
MeshFit fit_surface(const Mesh& mesh, const AnySurface& exact,
                    const std::optional<Eigen::Isometry3d>& placement) {
  check_consistent(mesh, "mesh");
  return fit_declared(mesh, exact, placement, triangle_signs(mesh)).fit;
}

DeclaredFit fit_declared(const Mesh& mesh, const SurfaceSpecification& given,
                         const std::optional<Eigen::Isometry3d>& placement,
                         std::span<const signed char> signs) {
  const AnySurface surface = make_surface(given);  // refuses unknown names and values out of range
  const UvKind* kind = find_uv_kind(given.name);
  if (!kind) return fit_declared(mesh, surface, placement, signs);
  fit::check_placement(placement);
  const Data data = usable_vertices(mesh, signs);
  const Wanted wanted{*kind, given.parameters, {}, placement, Wanted::Roundings::of_all};
  std::optional<Trial> best = try_conventions(data, wanted);
  if (!best || !best->fits) {
    // If another kind explains the mesh under a plain convention, the mesh is of that kind, not a limit of
    // this one with distorted uvs: a torus of major radius 0 is a sphere.
    const bool another = std::any_of(uv_kinds().begin(), uv_kinds().end(), [&](const UvKind& other) {
      if (&other == kind) return false;
      const auto trial = try_conventions(data, {other, {}, {}, placement, Wanted::Roundings::of_positions});
      return trial && trial->fits;
    });
    if (!another) keep_better(best, try_affine(data, wanted));
  }
  if (!best) throw no_start(given.name);
  return declared(data, *best, wanted);
}

DeclaredFit fit_declared(const Mesh& mesh, const AnySurface& exact,
                         const std::optional<Eigen::Isometry3d>& placement,
                         std::span<const signed char> signs) {
  const UvKind kind = rigid_kind(exact);
  fit::check_placement(placement);
  const Data data = usable_vertices(mesh, signs);
  const Wanted wanted{kind, {}, exact, placement, Wanted::Roundings::of_all, &mesh};
  std::optional<Trial> best = try_conventions(data, wanted);
  if (!best || !best->fits) keep_better(best, try_affine(data, wanted));
  if (!best) throw no_start(exact.info().name);
  return declared(data, *best, wanted);
}

std::optional<MeshFit> fit_kinds(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement,
                                 std::span<const std::string_view> kinds, UvMaps maps,
                                 std::span<const signed char> signs) {
  fit::check_placement(placement);
  const Data data = usable_vertices(mesh, signs);
  std::optional<Trial> best;
  for (const bool affine : {false, true}) {
    if (affine ? maps == UvMaps::plain : maps == UvMaps::affine) continue;
    for (const UvKind& kind : uv_kinds()) {
      if (std::find(kinds.begin(), kinds.end(), kind.name) == kinds.end()) continue;
      const Wanted wanted{kind, {}, {}, placement};
      std::optional<Trial> trial = affine ? try_affine(data, wanted) : try_conventions(data, wanted);
      if (trial && trial->fits)
        if (MeshFit fit = completed(data, *trial, wanted); fit.fits) return fit;
      keep_better(best, std::move(trial));
    }
  }
  if (!best) return std::nullopt;
  return completed(data, *best, {*best->model.kind, {}, {}, placement});
}

}  // namespace darboux
