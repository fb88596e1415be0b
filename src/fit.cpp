#include <algorithm>
#include <cmath>

#include <darboux/error.h>
#include <darboux/fit.h>

#include "fit/fit_kinds.h"
#include "fit/kinds.h"
#include "fit/with_uv/starts.h"

namespace darboux {
namespace {

// Vertices that a fit looks at before all of them: for a linear start, and to see whether a surface fits at all.
constexpr std::size_t start_points = 80, trial_points = 2048;

// A start this far off is another convention's mesh; refining it would only confirm that.
constexpr double hopeless = 0.2;
// Nor is one with a point this far off: it would take all the digits.
constexpr double too_far = 1e6;

// What fits few points this many times worse than permitted is not refined on more.
constexpr double hopeless_share = 30;

// An affine map is so free that it must fit better: this share of fits_below.
constexpr double affine_share = 1e-2;

// Usable vertices, centred and scaled to a bounding box of diagonal 1.
struct Data {
  UvPoints all, trial, few;
};

Data usable_vertices(const Mesh& mesh) {
  if (mesh.uvs.empty()) throw UndeterminedError("mesh", "has no uvs, a fit needs one uv set");
  std::vector<bool> referenced(mesh.positions.size(), false);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) referenced[v] = true;
  std::vector<std::uint32_t> usable;
  Eigen::AlignedBox3d box;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (!referenced[v] || !detail::finite(mesh.positions[v]) || !usable_uv(mesh.uvs[v])) continue;
    usable.push_back(v);
    box.extend(to_eigen(mesh.positions[v]));
  }
  if (usable.size() < 4)
    throw UndeterminedError("mesh",
                            std::to_string(usable.size()) + " usable vertices, a fit needs at least 4");
  Data data;
  data.all.centre = box.center();
  data.all.size = box.diagonal().stableNorm();
  if (!(data.all.size > 0))
    throw UndeterminedError("mesh", "all vertices are at one point, a fit needs an extent");
  data.all.positions.reserve(usable.size());
  data.all.uvs.reserve(usable.size());
  for (const std::uint32_t v : usable) {
    data.all.positions.push_back(from_eigen((to_eigen(mesh.positions[v]) - data.all.centre) / data.all.size));
    data.all.uvs.push_back(mesh.uvs[v]);
  }
  data.trial = data.all.chosen(trial_points, 1);
  data.few = data.trial.chosen(start_points, 1);
  return data;
}

// A surface that Ceres fitted to the trial points.
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

std::optional<AnySurface> surface_of(const UvModel& model, const UvState& state, double size,
                                     const SurfaceSpecification& given) {
  const UvKind& kind = *model.kind;
  SurfaceSpecification result{std::string(kind.name), {}};
  for (std::size_t k = 0; k < state.parameters.size(); ++k) {
    const ParameterValue& p = kind.parameters[k];
    if (!model.held[k] && kind.vanishes(static_cast<int>(k), state.parameters[k])) return std::nullopt;
    const auto held = std::find_if(given.parameters.begin(), given.parameters.end(),
                                   [&](const auto& g) { return g.first == p.name; });
    result.parameters.emplace_back(p.name, held != given.parameters.end()
                                               ? held->second
                                               : state.parameters[k] * (kind.length[k] ? size : 1));
  }
  try {
    return make_surface(result);
  } catch (const ParameterError&) {
    return std::nullopt;  // the values do not go together
  }
}

UvHeld held_values(const Data& data, const UvKind& kind, const SurfaceSpecification& given,
                   const std::optional<Eigen::Isometry3d>& placement) {
  UvHeld held;
  held.parameters.resize(kind.parameters.size());
  for (const auto& [name, value] : given.parameters)
    for (std::size_t k = 0; k < kind.parameters.size(); ++k)
      if (kind.parameters[k].name == name) held.parameters[k] = value / (kind.length[k] ? data.all.size : 1);
  if (placement) {
    held.placement = *placement;
    held.placement->translation() = (placement->translation() - data.all.centre) / data.all.size;
  }
  return held;
}

// Whether the points tell all that is estimated, and more: those on a line lie on a thin strip in any position.
bool determined(const UvModel& model, const UvState& state) {
  return 3 * model.points->count() > model.unknowns() &&
         model.spread(state, model.sums(state, Mixture{})).undetermined.empty();
}

// From one start; nothing where the parameters that come out are not permitted.
std::optional<Trial> tried(const Data& data, UvStart start, const SurfaceSpecification& given) {
  start.model.points = &data.trial;
  Solved solved;
  if (start.median < hopeless && rms(start.model, start.state) < too_far) {
    // Far from a few of the points it is far from all.
    start.model.points = &data.few;
    solved = start.model.solve(start.state, Mixture{}, 1e-3);
    const bool far = rms(start.model, start.state) > hopeless_share * fits_below;
    start.model.points = &data.trial;
    if (far)
      solved.converged = false;
    else
      solved = start.model.solve(start.state, Mixture{}, 1e-14);
  }
  if (!surface_of(start.model, start.state, data.all.size, given)) return std::nullopt;
  const double error = rms(start.model, start.state);
  if (!std::isfinite(error)) return std::nullopt;
  const double permitted = fits_below * (start.model.free_affine.empty() ? 1 : affine_share);
  bool fits = solved.converged && error <= permitted;
  if (fits && !determined(start.model, start.state)) {
    // On a surface that came out as one of revolution the offset of u is a rotation, and may be held.
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
std::optional<Trial> try_conventions(const Data& data, const UvKind& kind, const SurfaceSpecification& given,
                                     const UvHeld& held) {
  std::optional<Trial> best;
  for (UvStart& start : convention_starts(kind, data.few, held, false).proper) {
    std::optional<Trial> trial = tried(data, std::move(start), given);
    if (best && best->fits) {
      if (trial && trial->fits) best->equivalent.push_back(trial->model.convention.name);
    } else {
      keep_better(best, std::move(trial));
    }
  }
  return best;
}

std::optional<Trial> try_affine(const Data& data, const UvKind& kind, const SurfaceSpecification& given,
                                const UvHeld& held) {
  // Two points must follow beyond those that any such surface goes through: nearly every quad lies on a Möbius strip.
  if (3 * data.all.count() < 6 + kind.parameters.size() + 6 + 6) return std::nullopt;
  std::optional<Trial> best;
  for (UvStart& start : affine_starts(kind, data.few, held, false)) {
    keep_better(best, tried(data, std::move(start), given));
    if (best && best->fits) break;
  }
  return best;
}

// The answer from all vertices.
MeshFit completed(const Data& data, Trial trial, const SurfaceSpecification& given,
                  const std::optional<Eigen::Isometry3d>& placement) {
  trial.model.points = &data.all;
  if (trial.fits) {
    Mixture squares;
    UvState state = trial.state;
    trial.model.polish(state, squares, std::nullopt, 6);
    if (surface_of(trial.model, state, data.all.size, given)) trial.state = state;
  }
  MeshFit fit{{},
              {*surface_of(trial.model, trial.state, data.all.size, given), Eigen::Isometry3d::Identity(),
               trial.model.whole_convention(trial.state)}};
  fit.equivalent = trial.equivalent;
  std::vector<double> squares;
  UvSums sums;
  if (trial.fits)
    sums = trial.model.sums(trial.state, Mixture{}, &squares);
  else
    squares = trial.model.squares(trial.state);
  fit.rms_relative = rms(squares);
  fit.rms = fit.rms_relative * data.all.size;
  fit.fits = trial.fits && fit.rms_relative <= fits_below;
  const auto n = static_cast<double>(data.all.count());
  if (fit.fits) {  // so there are more coordinates than unknowns
    const double sigma =
        fit.rms_relative * std::sqrt(n / (3 * n - static_cast<double>(trial.model.unknowns())));
    fit.sigma = sigma * data.all.size;
    const UvSpread spread = trial.model.spread(trial.state, sums);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto& p : data.all.positions) centre += to_eigen(p) / n;
    static_cast<SurfaceUncertainty&>(fit) =
        trial.model.uncertainty(trial.state, sigma * sigma * spread.covariance, centre);
  }
  fit.iterations = trial.iterations;
  if (placement) {
    fit.surface.placement = *placement;
  } else {
    fit.surface.placement.linear() = trial.state.rotation.toRotationMatrix();
    fit.surface.placement.translation() = trial.state.translation * data.all.size + data.all.centre;
  }
  return fit;
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
  make_surface(given);  // refuses unknown names and values out of range
  const UvKind* kind = find_uv_kind(given.name);
  if (!kind) throw ParameterError(given.name, "cannot be fitted to a mesh, permitted are " + uv_kind_names());
  const Data data = usable_vertices(mesh);
  const UvHeld held = held_values(data, *kind, given, placement);
  std::optional<Trial> best = try_conventions(data, *kind, given, held);
  if (!best || !best->fits) {
    // What another kind explains under a plain convention is that kind, and no limit of this one with bent uvs: a torus
    // of major radius 0 is a sphere.
    const bool another = std::any_of(uv_kinds().begin(), uv_kinds().end(), [&](const UvKind& other) {
      if (&other == kind) return false;
      const SurfaceSpecification any{std::string(other.name), {}};
      const auto trial = try_conventions(data, other, any, held_values(data, other, any, placement));
      return trial && trial->fits;
    });
    if (!another) keep_better(best, try_affine(data, *kind, given, held));
  }
  if (!best)
    throw MeshError("mesh", "no uv convention lets " + fit::with_article(given.name) +
                                " start, the positions do not follow the uvs");
  return completed(data, *best, given, placement);
}

MeshFit fit_any_surface(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement) {
  if (std::optional<MeshFit> fit = fit_kinds(mesh, placement, fitted_kinds(), UvMaps::any)) return std::move(*fit);
  throw MeshError("mesh", "is none of the surfaces that can be fitted");
}

std::optional<MeshFit> fit_kinds(const Mesh& mesh, const std::optional<Eigen::Isometry3d>& placement,
                                 std::span<const std::string_view> kinds, UvMaps maps) {
  const Data data = usable_vertices(mesh);
  std::optional<Trial> best;
  for (const bool affine : {false, true}) {
    if (affine ? maps == UvMaps::plain : maps == UvMaps::affine) continue;
    for (const UvKind& kind : uv_kinds()) {
      if (std::find(kinds.begin(), kinds.end(), kind.name) == kinds.end()) continue;
      const SurfaceSpecification given{std::string(kind.name), {}};
      const UvHeld held = held_values(data, kind, given, placement);
      std::optional<Trial> trial =
          affine ? try_affine(data, kind, given, held) : try_conventions(data, kind, given, held);
      if (trial && trial->fits)
        if (MeshFit fit = completed(data, *trial, given, placement); fit.fits) return fit;
      keep_better(best, std::move(trial));
    }
  }
  if (!best) return std::nullopt;
  return completed(data, *best, {std::string(best->model.kind->name), {}}, placement);
}

}  // namespace darboux
