#include "recognise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <darboux/disk.h>
#include <darboux/error.h>

#include "base/evenly_chosen.h"
#include "base/text.h"
#include "by_normals.h"
#include "evidence.h"
#include "fit/fit_kinds.h"
#include "mesh/area_vector.h"
#include "mesh/triangle_signs.h"
#include "shape.h"
#include "surface_kind.h"
#include "validate/consistent.h"

namespace darboux {
namespace {

constexpr double flat = fits_below;              // thickness: below, it is a plane or nothing
constexpr std::size_t fewest_in_a_plane = 4;     // triangles
constexpr std::size_t fewest_under_a_map = 40;   // positions, of a surface found only by its uvs
constexpr std::size_t fewest_by_positions = 32;  // positions, if the stored normals are not the surface's
constexpr double plane_normals = 0.8;            // share of normals that must be the plane's

}  // namespace

std::string nearest_fit(const MeshFit& fit, double limit) {
  return ": nearest is " + fit.surface.surface.specification(6) + " with an rms distance of " +
         rounded(fit.rms_relative, 2) + " of the mesh's size, " +
         (fit.rms_relative <= limit ? "which leaves some of its unknowns open"
                                    : "expected at most " + rounded(limit, 1)) +
         (has_affine_uvs(fit) ? " under affine uvs" : "");
}

namespace {

bool may_be(SurfaceKind kind, Quadric quadric) {
  using enum SurfaceKind;
  constexpr std::array no_quadrics{torus, helicoid, catenoid, moebius_strip, klein_bottle, enneper};
  if (std::find(no_quadrics.begin(), no_quadrics.end(), kind) != no_quadrics.end())
    return quadric == Quadric::none;
  const bool closed = kind == sphere || kind == ellipsoid;
  return quadric == Quadric::any || (quadric == Quadric::definite && closed) ||
         (quadric == Quadric::indefinite && !closed);
}

// A disk without a hole is fitted with a hole of the size of rounding: its centre is a pole all the same.
void mark_middle(const MeshFit& fit, const Mesh& mesh, std::vector<Truth>& truth) {
  const auto* disk = fit.surface.surface.get<Disk<double>>();
  if (!disk || !(disk->inner_radius <= fits_below * disk->outer_radius)) return;
  const Eigen::Vector3d middle = fit.surface.placement.translation();
  for (std::size_t v = 0; v < truth.size(); ++v)
    if ((to_eigen(mesh.positions[v]) - middle).norm() <= 2 * fits_below * disk->outer_radius)
      truth[v].pole = true;
}

// Whether u runs over the triangles as it does on the surface. Uvs that repeat too often for the mesh's
// columns may fit, at the vertices only, a surface on which they run the other way.
bool runs_along_triangles(const Mesh& mesh, const MeshFit& fit) {
  if (fit.chart != UvChart::own) return true;
  constexpr std::size_t looked_at = 500;
  Mesh few;
  few.half_steps = mesh.half_steps;
  for (const std::size_t t : evenly_chosen(mesh.triangles.size(), looked_at)) {
    const auto first = static_cast<std::uint32_t>(few.positions.size());
    few.triangles.push_back({first, first + 1, first + 2});
    for (const std::uint32_t v : mesh.triangles[t]) {
      few.positions.push_back(mesh.positions[v]);
      few.uvs.push_back(mesh.uvs[v]);
    }
  }
  const std::vector<signed char> signs = triangle_signs(few);
  const std::vector<Truth> truth = truths(few, fit, signs);
  std::size_t compared = 0, along = 0;
  for (std::size_t t = 0; t < few.triangles.size(); ++t) {
    const Vec3<double> dpdu = direction_of_dpdu(few, few.triangles[t], signs[t]);
    for (const std::uint32_t v : few.triangles[t]) {
      const double cosine = dot(dpdu, truth[v].tangent);
      if (truth[v].pole || !(cosine < 0 || cosine > 0)) continue;
      ++compared;
      along += cosine > 0;
    }
  }
  return 2 * along >= compared;
}

SearchBudget::Outline outline(const Mesh& mesh, const Shape& shape) {
  const auto digits = [](double x, double step) { return static_cast<std::size_t>(std::llround(x / step)); };
  std::size_t of_uvs = 0;
  for (const Vec2<double>& uv : mesh.uvs)
    for (const double x : {uv.x, uv.y}) of_uvs = 31 * of_uvs + std::hash<double>{}(x);
  double along = 0;  // of the triangles' normals
  for (const Triangle& t : mesh.triangles) {
    if (mesh.normals.empty()) break;
    const Vec3<double> n = area_vector(mesh, t);
    for (const std::uint32_t v : t)
      if (const double cosine = dot(unit(n), unit(mesh.normals[v])); std::isfinite(cosine)) along += cosine;
  }
  return {shape.places.size(),
          shape.edges.size(),
          shape.turning,
          digits(shape.thickness, 1e-5),
          digits(shape.turn_deg, 1e-2),
          of_uvs,
          digits(along / static_cast<double>(std::max<std::size_t>(mesh.corners(), 1)), 1e-4)};
}

// The search on one mesh.
class Search {
 public:
  Search(const Mesh& mesh, std::span<const signed char> signs,
         const std::optional<Eigen::Isometry3d>& placement, SearchBudget& budget,
         std::optional<std::string_view> charted)
      : mesh_(mesh),
        signs_(signs),
        placement_(placement),
        budget_(budget),
        charted_(charted),
        shape_(shape_of(mesh)) {}

  Recognition result() && {
    if (shape_.places.size() < 3 || !(shape_.size > 0)) {
      result_.identifiable = false;
      result_.reason =
          ": " + std::to_string(shape_.places.size()) + " different positions; a surface needs more";
      return std::move(result_);
    }
    if (shape_.thickness <= flat) {
      look_for_plane();
      return std::move(result_);
    }
    if (std::optional<Evidence> against = against_any_surface(shape_)) {
      reject(std::move(*against));
      return std::move(result_);
    }
    const SearchBudget::Outline its_outline = outline(mesh_, shape_);
    const bool has_failed = !charted_ && budget_.has_failed(its_outline);
    if (has_failed || budget_.spent()) {
      result_.reason = has_failed ? ": similar parts matched no surface" : ": the time for it ran out";
      return std::move(result_);
    }
    look_for_surface();
    if (!result_.fits() && !charted_ && !budget_.cut_short()) budget_.failed(its_outline);
    return std::move(result_);
  }

 private:
  static constexpr std::array<std::string_view, 2> planar_{"plane", "disk"};
  static constexpr std::array<std::string_view, 4> found_in_brief{"sphere", "cylinder", "cone", "torus"};

  std::optional<MeshFit> by_uvs(std::span<const std::string_view> kinds, UvMaps maps) {
    if (mesh_.uvs.empty() || !shape_.one_chart) return std::nullopt;
    try {
      std::optional<MeshFit> fit = fit_kinds(mesh_, placement_, kinds, maps, signs_);
      if (fit && fit->fits && !runs_along_triangles(mesh_, *fit)) {
        result_.reason = ": between vertices its uvs run another way than those of " +
                         fit->surface.surface.specification(6);
        return std::nullopt;
      }
      if (fit && !fit->fits) {
        // Which kind comes nearest to what is none of them says nothing.
        if (!result_.fit || fit->rms_relative < result_.fit->rms_relative) result_.fit = std::move(*fit);
        return std::nullopt;
      }
      return fit;
    } catch (const MeshError& e) {
      result_.reason = std::string(": ") + e.what();
      return std::nullopt;
    }
  }

  void take(MeshFit fit, Evidence evidence) {
    result_.truth = truths(mesh_, fit, signs_);
    mark_middle(fit, mesh_, result_.truth);
    result_.fit = std::move(fit);
    result_.evidence = std::move(evidence);
  }

  void reject(Evidence evidence) {
    result_.reason = ": " + evidence.text;
    result_.evidence = std::move(evidence);
  }

  // Accepts a fit if the evidence is sufficient.
  bool weigh(MeshFit fit) {
    Evidence evidence = evidence_for(mesh_, shape_, fit);
    if (evidence.log10_odds >= evidence_needed) {
      take(std::move(fit), std::move(evidence));
      return true;
    }
    if (!result_.evidence || evidence.log10_odds > result_.evidence->log10_odds) {
      result_.reason = ": too little evidence for " + evidence.text;
      result_.evidence = std::move(evidence);
    }
    return false;
  }

  void look_for_plane() {
    // Counts corners, so the result does not depend on how vertices are shared.
    std::size_t agree = 0, compared = 0;
    std::vector<signed char> agrees(mesh_.normals.size(), -1);  // -1: there is none
    for (std::size_t v = 0; v < agrees.size(); ++v) {
      const Vec3<double>& n = mesh_.normals[v];
      if (detail::finite(n) && n != Vec3<double>{})
        agrees[v] = std::fabs(to_eigen(n).normalized().dot(shape_.plane_normal)) >= 0.996;  // 5 degrees
    }
    if (!agrees.empty())
      for (const Triangle& t : mesh_.triangles)
        for (const std::uint32_t v : t) {
          compared += agrees[v] >= 0;
          agree += agrees[v] > 0;
        }
    if (static_cast<double>(agree) < plane_normals * static_cast<double>(compared))
      return reject(
          {-10, "authored normals", "the positions lie in a plane, but the normals are not the plane's"});
    if (mesh_.triangles.size() < fewest_in_a_plane)
      return reject({-10, "polygon",
                     "a polygon of " + std::to_string(mesh_.triangles.size()) +
                         " triangles: too few to claim a plane"});
    std::optional<MeshFit> fit = by_uvs(planar_, UvMaps::any);
    if (!fit) fit = fit_positions(mesh_, SurfaceSpecification{"plane", {}}, placement_);
    if (fit)
      return take(std::move(*fit), {evidence_needed + 4, "polygon",
                                    "all positions lie in a plane, and the normals are the plane's"});
    result_.reason = ": the positions lie in a plane";
    result_.evidence = Evidence{-10, "polygon", ""};
  }

  // Tries a kind by positions and normals, then through uvs. \param brief skips slow fits
  bool weigh_by_places(std::string_view kind, bool brief) {
    std::optional<MeshFit> fit;
    if (!placement_) fit = fit_by_normals(mesh_, shape_, kind_of(kind));
    if (!fit && (!brief || kind_of(kind) == SurfaceKind::sphere) &&
        (mesh_.normals.empty() || shape_.places.size() >= fewest_by_positions))
      fit = fit_positions(mesh_, SurfaceSpecification{std::string(kind), {}}, placement_);
    if (!fit) return false;
    if (auto charted = by_uvs(std::array{kind}, UvMaps::affine)) fit = std::move(charted);
    return weigh(std::move(*fit));
  }

  // Tries quick fits first.
  void look_for_surface() {
    if (charted_) {
      if (auto fit = by_uvs(std::array{*charted_}, UvMaps::any)) weigh(std::move(*fit));
      return;
    }
    const Quadric quadric = quadric_of(mesh_, shape_);
    const bool no_torus = quadric != Quadric::none || !may_be_cyclide(mesh_, shape_);
    const auto ruled_out = [&](std::string_view name) {
      const SurfaceKind kind = kind_of(name);
      return !may_be(kind, quadric) || (kind == SurfaceKind::torus && no_torus);
    };
    std::vector<std::string_view> kinds;
    for (const std::string_view kind : fitted_kinds())
      if (!ruled_out(kind)) kinds.push_back(kind);
    if (budget_.count_if_brief()) {
      if (auto fit = by_uvs(kinds, UvMaps::plain); fit && weigh(std::move(*fit))) return;
      for (const std::string_view kind : found_in_brief)
        if (!ruled_out(kind) && !budget_.spent() && weigh_by_places(kind, true)) return;
      return;
    }
    if (auto fit = by_uvs(kinds, UvMaps::plain))
      if (weigh(std::move(*fit))) return;
    for (const std::string_view kind : found_kinds()) {
      if (kind_of(kind) == SurfaceKind::plane || ruled_out(kind) || budget_.spent()) continue;
      if (weigh_by_places(kind, false)) return;
    }
    if (shape_.places.size() < fewest_under_a_map || mesh_.uvs.empty() || !budget_.may_search_affine(shape_))
      return;
    if (auto fit = by_uvs(kinds, UvMaps::affine)) weigh(std::move(*fit));
  }

  const Mesh& mesh_;
  std::span<const signed char> signs_;
  const std::optional<Eigen::Isometry3d>& placement_;
  SearchBudget& budget_;
  std::optional<std::string_view> charted_;
  Shape shape_;
  Recognition result_;
};

constexpr std::size_t thorough_failures = 12, numbers_of_shape = 5;

}  // namespace

SearchBudget::SearchBudget(const AssessOptions& options)
    : history_(options.history ? *options.history : own_), failed_before_(history_.failed.size()) {
  if (options.budget)
    until_ =
        std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                               std::chrono::duration<double>(*options.budget));
}

bool SearchBudget::spent() const {
  const bool spent = until_ && std::chrono::steady_clock::now() >= *until_;
  cut_short_ = cut_short_ || spent;
  return spent;
}

bool SearchBudget::has_failed(const Outline& outline) const {
  const std::span<const Outline> before(history_.failed.data(), failed_before_),
      here = std::span<const Outline>(history_.failed).subspan(failed_before_);
  return std::find(before.begin(), before.end(), outline) != before.end() ||
         std::any_of(here.begin(), here.end(), [&](const Outline& other) {
           return std::equal(outline.begin(), outline.begin() + numbers_of_shape, other.begin());
         });
}

bool SearchBudget::count_if_brief() {
  const bool brief = history_.failed.size() >= thorough_failures;
  searched_briefly_ += brief;
  return brief;
}

void SearchBudget::failed(const Outline& outline) {
  history_.failed.push_back(outline);
}

bool SearchBudget::may_search_affine(const Shape& shape) {
  if (!one_chart_) one_chart_ = shape.one_chart;
  if (!*one_chart_ || !shape.one_chart || affine_searched_ || spent()) return false;
  return affine_searched_ = true;
}

Recognition recognise(const Mesh& mesh, std::span<const signed char> signs,
                      const std::optional<Eigen::Isometry3d>& placement, SearchBudget& budget,
                      std::optional<std::string_view> charted) {
  return Search(mesh, signs, placement, budget, charted).result();
}

}  // namespace darboux
