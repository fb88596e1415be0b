#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/validate.h>

#include "accurate.h"
#include "authored.h"
#include "averages.h"
#include "base/degrees.h"
#include "base/flatten.h"
#include "base/text.h"
#include "corner_counts.h"
#include "diagnose.h"
#include "findings.h"
#include "mesh_under_test.h"
#include "mikktspace_comparison.h"
#include "signs.h"
#include "smooth.h"

namespace darboux {
namespace {

constexpr double expected_agreement = 0.8;  // of two references; error bars cover less if coarse
constexpr double agree_within = 0.1;        // of the limit: references that differ by less agree
constexpr auto no_code = static_cast<Code>(corner_errors);

// Angles are negative where there is nothing to compare.
float kept(double angle) {
  return angle < 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(angle);
}

// Whether two references agree within their uncertainties.
DARBOUX_FLATTEN bool agree(const Truth& a, const Truth& b, double floor_deg) {
  const auto within = [&](double angle, double one, double other) {
    return degrees_per_radian * angle <= certain * std::hypot(one, other) + floor_deg;
  };
  const double normal = angle_between_units(a.normal, b.normal);
  return within(std::fmin(normal, std::numbers::pi - normal), a.normal_deg, b.normal_deg) &&
         within(angle_between_units(a.tangent, b.tangent), a.tangent_deg, b.tangent_deg);
}

bool known(const Truth& t) {
  return detail::finite(t.normal) && detail::finite(t.tangent) && std::isfinite(t.normal_deg) &&
         std::isfinite(t.tangent_deg);
}

// Corners of one vertex with the same assessment.
struct CornerGroup {
  std::uint32_t vertex;
  std::int8_t sign;  // of their triangles, 0 without uv area
  bool wrong_sign;   // w differs from their island's
  std::uint32_t corners;
};

// The validation of one mesh: its data and intermediate results.
class MeshValidation {
 public:
  MeshValidation(const MeshUnderTest& under_test, std::span<const Truth> truth, Basis basis,
                 const ValidateOptions& options)
      : under_test_(under_test),
        mesh_(under_test.mesh),
        classes_(under_test.classes),
        options_(options),
        checks_(checks_of(mesh_)),
        corners_of_(mesh_.positions.size(), 0),
        signs_(under_test, checks_) {
    for (const Triangle& triangle : mesh_.triangles)
      for (const std::uint32_t v : triangle) ++corners_of_[v];
    accurate_ = Accurate(under_test, checks_, corners_of_, truth, basis, signs_.raw(), options.max_angle_deg);
    if (accurate_.known() && !accurate_.declared()) {
      authored_ = darboux::may_be_authored(under_test_, accurate_);
      is_beside_pole_.assign(mesh_.positions.size(), false);
      for (const Triangle& triangle : mesh_.triangles)
        if (std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) { return is_pole(v); }))
          for (const std::uint32_t v : triangle) is_beside_pole_[v] = true;
    }
    averages_ = Averages(under_test, accurate_, checks_, corners_of_);
    if (!under_test.local.empty())
      smooth_ = check_smooth(under_test, accurate_, checks_, signs_.raw(), options.max_angle_deg);
    report_.corners = mesh_.corners();
    report_.handedness = signs_.handedness();
  }

  MeshReport report() && {
    compare();
    diagnose();
    check_corners();
    keep_errors_by_triangles();
    compare_with_neighbours();
    compare_with_mikktspace();
    look_at_signs();
    add_notes();
    decide();
    return std::move(report_);
  }

 private:
  static std::vector<VertexChecks> checks_of(const Mesh& mesh) {
    std::vector<VertexChecks> checks(mesh.positions.size());
    for (std::uint32_t v = 0; v < checks.size(); ++v) checks[v] = check_vertex(mesh, v);
    return checks;
  }
  bool only_mikktspace() const {
    const References& r = options_.references;
    return r.mikktspace && !r.analytic && !r.triangles && !r.local;
  }
  double limit_of(std::uint32_t v) const {
    return darboux::limit_of(classes_.of_vertex[v], options_.max_angle_deg);
  }
  bool is_pole(std::uint32_t v) const { return classes_.of_vertex[v] == VertexClass::pole; }
  // At the boundary of a recognised surface, artists blend its normals into the adjacent surface, and
  // tangents follow.
  // Whether the tangent is in the cone of its triangles. At a seam beside a pole one of the two that give it
  // may have no area: they cannot judge it.
  bool may_follow_triangles(std::uint32_t v, int sign) const {
    const Claim claim = under_test_.cones.claim(v, sign);
    return claim == Claim::within ||
           (claim == Claim::none && is_beside_pole_[v] && classes_.of_vertex[v] == VertexClass::seam &&
            accurate_.angles(v).projected_tangent < 90);
  }
  bool may_be_authored(std::uint32_t v) const { return !authored_.empty() && authored_[v]; }
  std::string worst_text(double worst, const std::string& more = {}) const {
    return (worst > 0 ? " (worst " + rounded(worst, 4) + " deg, limit " : std::string(" (limit ")) +
           rounded(options_.max_angle_deg, 4) + " in the interior, " +
           rounded(3 * options_.max_angle_deg, 4) + " elsewhere" + more + ")";
  }
  std::span<const Truth> statistics_truth() const {
    return accurate_.known() ? accurate_.truths() : std::span<const Truth>(under_test_.local);
  }
  // The angles for the statistics: to the surface, else to the neighbours.
  Angles statistics_angles(std::uint32_t v) const {
    if (corners_of_[v] == 0) return {};
    if (accurate_.known()) return accurate_.angles(v);
    return smooth_.known() ? smooth_.angles[v] : Angles{};
  }
  // \param angles_at returns the angles of a vertex
  template <class AnglesAt>
  std::vector<ClassReport> class_reports(std::span<const Truth> truth, const AnglesAt& angles_at) const {
    ClassSums sums(mesh_, classes_.of_vertex);
    for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v)
      sums.add(classes_.of_vertex[v], v, corners_of_[v], angles_at(v), truth.empty() ? nullptr : &truth[v]);
    return sums.reports();
  }
  template <class F>
  void for_each_corner_group(F f) const;

  bool is_average_tangent(std::uint32_t v, int sign) const {
    return !tangents_diagnosed_ && averages_.tangent(v, under_test_.followed_sign(v, sign));
  }
  bool is_unsupported(std::uint32_t v) const {
    return !mesh_.normals.empty() && under_test_.normals.unsupported[v];
  }
  // Whether no triangle with area, or none with uv area, uses it: its tangent then has no visible effect.
  bool is_unseen(std::uint32_t v) const {
    return is_hidden(v) || (!mesh_.uvs.empty() && !under_test_.has_uv_area[v]);
  }
  bool is_hidden(std::uint32_t v) const { return !mesh_.normals.empty() && !under_test_.normals.drawn[v]; }
  // Leaves and grass on cards are lit like the crown or the ground.
  bool may_be_lit_otherwise(std::uint32_t v) const {
    return !accurate_.known() &&
           (classes_.of_vertex[v] == VertexClass::border || under_test_.normals.may_be_meant[v]);
  }

  void compare();
  void diagnose();
  void check_corners();
  void count_errors(const CornerGroup& group, Code error, CornerCounts& counts);
  void count_warnings(const CornerGroup& group, Code error, CornerCounts& counts);
  void add_errors(const CornerCounts& counts);
  void add_warnings(const CornerCounts& counts);
  enum class Decider { nobody, surface, triangles };
  Decider tangent_error(const CornerGroup& group) const;
  bool may_be_exact(std::uint32_t v) const;
  bool normals_diagnosed() const { return normal_mistake_ != NormalMistake::none; }
  bool normal_error(std::uint32_t v) const;
  Code error_of(const CornerGroup& group) const;
  void count_vertex(std::uint32_t v);
  void keep_errors_by_triangles();
  void compare_with_neighbours();
  void compare_with_mikktspace();
  void look_at_signs();
  bool lacks_uv_area() const;
  void add_notes();
  void decide();

  const MeshUnderTest& under_test_;
  const Mesh& mesh_;
  const MeshClasses& classes_;
  const ValidateOptions& options_;
  std::vector<VertexChecks> checks_;
  std::vector<std::uint32_t> corners_of_;  // number of corners per vertex
  Signs signs_;
  Accurate accurate_;
  std::vector<bool> is_beside_pole_;  // empty where the surface is declared or unknown
  std::vector<bool> authored_;        // of a recognised surface
  Averages averages_;
  Smooth smooth_;
  bool tangents_diagnosed_ = false;
  NormalMistake normal_mistake_ = NormalMistake::none;
  // Numbers of corners: decided by the surface; compared with it but undecided; decided by the neighbours.
  std::size_t decided_ = 0, undecided_ = 0, locally_ = 0;
  MeshReport report_;
};

void MeshValidation::compare() {
  report_.classes =
      class_reports(statistics_truth(), [this](std::uint32_t v) { return statistics_angles(v); });
  if (!options_.keep_errors) return;
  report_.errors_deg.reserve(mesh_.corners());
  std::vector<float> of_vertex(mesh_.positions.size());
  for (std::uint32_t v = 0; v < of_vertex.size(); ++v) {
    const Angles a = statistics_angles(v);
    of_vertex[v] = kept(mesh_.tangents.empty() ? a.normal : a.tangent);
  }
  for (const Triangle& triangle : mesh_.triangles)
    for (const std::uint32_t v : triangle) report_.errors_deg.push_back(of_vertex[v]);
}

// Nearly all corners of a vertex are alike; the others are listed.
template <class F>
void MeshValidation::for_each_corner_group(F f) const {
  std::vector<CornerGroup> others;
  std::vector<std::int8_t> first(mesh_.positions.size(), -1);  // the properties of a corner, as a number
  std::vector<std::uint32_t> alike = corners_of_;
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
    for (const std::uint32_t v : mesh_.triangles[t]) {
      const auto sign = static_cast<std::int8_t>(under_test_.raw_sign[t]);
      const bool wrong = !mesh_.tangents.empty() && signs_.wrong(t, v);
      const auto key = static_cast<std::int8_t>(2 * (sign + 1) + (wrong ? 1 : 0));
      if (first[v] < 0) first[v] = key;
      if (first[v] == key) continue;
      others.push_back({v, sign, wrong, 1});
      --alike[v];
    }
  for (std::uint32_t v = 0; v < alike.size(); ++v)
    if (alike[v] > 0)
      f(CornerGroup{v, static_cast<std::int8_t>(first[v] / 2 - 1), first[v] % 2 == 1, alike[v]});
  for (const CornerGroup& group : others) f(group);
}

// Which reference, if any, makes the tangent an error.
MeshValidation::Decider MeshValidation::tangent_error(const CornerGroup& group) const {
  const std::uint32_t v = group.vertex;
  if (is_pole(v) || !checks_[v].uv_finite) return Decider::nobody;
  if (accurate_.known()) {
    const Claim claim = accurate_.tangent(v);
    if (claim == Claim::within) return Decider::nobody;
    if (is_hidden(v) && !accurate_.declared()) return Decider::nobody;
    // At a seam every tool sees one side only: with few columns its tangents are far from the surface's.
    const bool authored = may_be_authored(v) && !tangents_diagnosed_ && !under_test_.cones.empty() &&
                          may_follow_triangles(v, group.sign);
    if (claim == Claim::beyond && accurate_.decides(accurate_.tangents_agree(), tangents_diagnosed_))
      return authored || is_average_tangent(v, group.sign) ? Decider::nobody : Decider::surface;
  }
  const auto beyond = [&](int sign) { return under_test_.cones.claim(v, sign) == Claim::beyond; };
  if (under_test_.cones.empty() || !beyond(group.sign) || may_be_exact(v)) return Decider::nobody;
  const int sign = tangents_diagnosed_ ? group.sign : under_test_.followed_sign(v, group.sign);
  return beyond(sign) ? Decider::triangles : Decider::nobody;
}

// A mistake or turn that all tangents share is not due to coarse triangles.
bool MeshValidation::may_be_exact(std::uint32_t v) const {
  return smooth_.known() && smooth_.may_be_exact[v] && !tangents_diagnosed_ && !under_test_.cones.turn();
}

bool MeshValidation::normal_error(std::uint32_t v) const {
  const bool unsupported = is_unsupported(v) && !may_be_lit_otherwise(v);
  // Either side of a plane may be its outside, so it cannot excuse a normal that its own triangles do not
  // support.
  const bool within = accurate_.known() && accurate_.has_sides() && accurate_.normal(v) == Claim::within;
  if (unsupported && !within) return true;
  return accurate_.known() && accurate_.normal(v) == Claim::beyond &&
         accurate_.decides(accurate_.normals_agree(), normals_diagnosed()) &&
         !(((may_be_authored(v) && !normals_diagnosed()) || averages_.normal(v)) && !is_unsupported(v));
}

// The first error that fits.
Code MeshValidation::error_of(const CornerGroup& group) const {
  using enum Code;
  const std::uint32_t v = group.vertex;
  const VertexChecks& c = checks_[v];
  if (!mesh_.tangents.empty()) {
    if (!c.tangent_finite) return tangent_not_finite;
    if (c.tangent_zero && under_test_.has_uv_area[v]) return tangent_zero;
    if (!c.tangent_zero && !c.tangent_unit) return tangent_not_unit;
    // A zero w has no effect where there is no uv area: the bitangents of FBX and COLLADA are zero there and
    // give no sign.
    if (!c.tangent_zero && !c.sign_valid && (!is_unseen(v) || mesh_.tangents[v].w != 0))
      return tangent_invalid_sign;
    if (c.along_normal && !is_unseen(v)) return tangent_not_orthogonal;
    if (group.wrong_sign && !is_hidden(v)) return tangent_handedness;
    if (tangent_error(group) != Decider::nobody) return tangent_angle;
  }
  if (!c.normal_finite) return normal_not_finite;
  if (!c.normal_unit && (c.has_normal || under_test_.normals.drawn[v])) return normal_not_unit;
  if (normal_error(v)) return normal_angle;
  if (!c.position_finite) return position_not_finite;
  if (!c.uv_finite) return uv_not_finite;
  return no_code;
}

// Counts what does not depend on the verdict.
void MeshValidation::count_vertex(std::uint32_t v) {
  const std::uint32_t corners = corners_of_[v];
  const VertexChecks& c = checks_[v];
  if (!mesh_.tangents.empty() && c.tangent_zero) report_.zero_tangents += corners;
  if (!c.tangent_finite || !c.normal_finite || !c.position_finite || !c.uv_finite)
    report_.non_finite += corners;
  if (!mesh_.tangents.empty() && c.has_tangent && !c.tangent_unit) report_.non_unit += corners;
  if (!c.orthogonal) report_.non_orthogonal += corners;
  const std::span<const Truth> truth = statistics_truth();
  if (truth.empty() || !c.uv_finite) return;
  report_.normal_uncertainty_deg.add(truth[v].normal_deg, corners);
  report_.tangent_uncertainty_deg.add(truth[v].tangent_deg, corners);
  if (accurate_.known()) {
    const Angles& a = accurate_.angles(v);
    const Claim normal = accurate_.normal(v), tangent = accurate_.tangent(v);
    if (normal != Claim::none || tangent != Claim::none) decided_ += corners;
    if (!is_pole(v) && ((a.normal >= 0 && normal == Claim::none) ||
                        (a.tangent >= 0 && tangent == Claim::none && !is_unseen(v))))
      undecided_ += corners;
    if (accurate_.has_sides() && accurate_.inward(v)) report_.inward += corners;
  }
  if (smooth_.known() && (smooth_.normals[v] != Claim::none || smooth_.tangents[v] != Claim::none))
    locally_ += corners;
}

void MeshValidation::check_corners() {
  CornerCounts counts;
  for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v)
    if (corners_of_[v] > 0) count_vertex(v);
  if (!under_test_.cones.empty()) report_.triangles.emplace();
  for_each_corner_group([&](const CornerGroup& group) {
    const Code error = error_of(group);
    count_errors(group, error, counts);
    count_warnings(group, error, counts);
  });
  add_errors(counts);
  add_warnings(counts);
}

void MeshValidation::count_errors(const CornerGroup& group, Code error, CornerCounts& counts) {
  const std::uint32_t v = group.vertex;
  const std::size_t corners = group.corners;
  if (error != no_code) counts.of_error[static_cast<std::size_t>(error)] += corners;
  const double outside = report_.triangles ? under_test_.cones.outside_deg(v, group.sign) : 0;
  if (report_.triangles && under_test_.cones.claim(v, group.sign) != Claim::none) {
    report_.triangles->compared += corners;
    if (outside > 0) report_.triangles->outside += corners;
    report_.triangles->worst_deg = std::fmax(report_.triangles->worst_deg, outside);
  } else if (report_.triangles && group.sign != 0 && checks_[v].has_tangent && checks_[v].has_normal &&
             under_test_.normals.drawn[v]) {
    report_.triangles->open += corners;
  }
  if (error == Code::tangent_not_unit) counts.tangent_lengths.add(norm(mesh_.tangents[v].xyz()));
  if (error == Code::normal_not_unit) counts.normal_lengths.add(norm(mesh_.normals[v]));
  if (error == Code::tangent_not_orthogonal) {
    const double along = cosine_between(mesh_.tangents[v].xyz(), mesh_.normals[v]);
    counts.most_along_normal = std::fmax(counts.most_along_normal, along);
    if (counts.planes.empty()) {
      VertexJoins of_part;
      counts.planes = planes_of_vertices(mesh_, joins_of(under_test_, of_part));
    }
    if (cosine_between(mesh_.tangents[v].xyz(), counts.planes[v]) <= along / 2) counts.in_plane += corners;
  }
  const Angles surface = accurate_.known() ? accurate_.angles(v) : Angles{};
  const Decider decider = mesh_.tangents.empty() ? Decider::nobody : tangent_error(group);
  if (decider != Decider::nobody) counts.tangents.in_all += corners;
  if (error == Code::tangent_angle) {
    const bool by_surface = decider == Decider::surface;
    (by_surface ? counts.tangents.by_surface : counts.tangents.by_triangles) += corners;
    counts.tangents.worst =
        std::fmax(counts.tangents.worst, by_surface ? surface.projected_tangent : outside);
  }
  if (normal_error(v)) counts.normals.in_all += corners;
  if (error == Code::normal_angle) {
    const bool by_triangles = is_unsupported(v);
    (by_triangles ? counts.normals.by_triangles : counts.normals.by_surface) += corners;
    counts.normals.worst = std::fmax(counts.normals.worst, surface.normal);
  }
}

void MeshValidation::count_warnings(const CornerGroup& group, Code error, CornerCounts& counts) {
  const std::uint32_t v = group.vertex;
  const auto warn = [&](Beyond& where, double angle) {
    where.by_surface += group.corners;
    where.worst = std::fmax(where.worst, angle);
  };
  const Angles surface = accurate_.known() ? accurate_.angles(v) : Angles{};
  if (is_pole(v) && surface.tangent > limit_of(v)) warn(counts.poles, surface.tangent);
  if (checks_[v].leans && !is_unseen(v)) counts.leaning += group.corners;
  if (is_unsupported(v) && may_be_lit_otherwise(v)) counts.lit_otherwise += group.corners;
  // At a border of a coarse sheet, even exact normals may be this far off.
  const bool is_told = accurate_.known() || classes_.of_vertex[v] == VertexClass::border ||
                       (smooth_.known() && smooth_.normals[v] != Claim::none);
  if (!is_told && !mesh_.normals.empty() && under_test_.normals.departing[v])
    counts.departing += group.corners;
  if (error == no_code && accurate_.known() && accurate_.tangent(v) == Claim::beyond)
    warn(!accurate_.decides(accurate_.tangents_agree(), tangents_diagnosed_) ? counts.surface_tangents
         : is_average_tangent(v, group.sign)                                 ? counts.coarse_tangents
                                                                             : counts.authored_tangents,
         surface.projected_tangent);
  if (!normal_error(v) && accurate_.known() && accurate_.normal(v) == Claim::beyond)
    warn(!accurate_.decides(accurate_.normals_agree(), normals_diagnosed()) ? counts.surface_normals
         : averages_.normal(v)                                              ? counts.coarse_normals
                                                                            : counts.authored_normals,
         surface.normal);
  if (!smooth_.known() || is_pole(v)) return;
  if (error == no_code && !accurate_.known() && !under_test_.cones.empty() &&
      under_test_.cones.claim(v, group.sign) == Claim::beyond)
    warn(counts.chord_tangents, under_test_.cones.outside_deg(v, group.sign));
  // Polynomials ignore folds of the uvs, such as those of octahedral maps.
  const bool is_average =
      !under_test_.cones.empty() && under_test_.cones.claim(v, group.sign) == Claim::within;
  if (error == no_code && smooth_.tangents[v] == Claim::beyond && !is_average &&
      (!accurate_.known() || accurate_.tangent(v) == Claim::none))
    warn(counts.local_tangents, smooth_.angles[v].projected_tangent);
  if (!normal_error(v) && !is_unsupported(v) && smooth_.normals[v] == Claim::beyond &&
      (!accurate_.known() || accurate_.normal(v) == Claim::none))
    warn(counts.local_normals, smooth_.angles[v].normal);
}

// Adds errors with the reference that decided, and says where other corners beyond the limit are counted.
void MeshValidation::add_errors(const CornerCounts& counts) {
  const auto text = [&](const Beyond& b, const char* by_triangles) {
    std::string more;
    if (b.by_surface > 0) more += "; " + std::to_string(b.by_surface) + " by the surface";
    if (b.by_triangles > 0) more += "; " + std::to_string(b.by_triangles) + by_triangles;
    if (b.in_all > b.counted())
      more += "; " + std::to_string(b.in_all) + " in all, of which " +
              std::to_string(b.in_all - b.counted()) +
              " have an error that comes before this one and count there";
    // The limit does not matter for what the triangles' planes alone decide.
    return &b == &counts.normals && b.by_surface == 0 && !more.empty() ? " (" + more.substr(2) + ")"
                                                                       : worst_text(b.worst, more);
  };
  const auto more = [&](Code code) -> std::string {
    switch (code) {
      case Code::tangent_not_unit:
        return counts.tangent_lengths.text();
      case Code::tangent_not_orthogonal:
        return " (|t.n| up to " + rounded(counts.most_along_normal, 3) + ", limit " +
               rounded(along_normal_tolerance, 2) + ")";
      case Code::tangent_angle:
        return text(counts.tangents, " outside the cone of their own triangles");
      case Code::normal_not_unit:
        return counts.normal_lengths.text();
      case Code::normal_angle:
        return text(counts.normals, " more than 80 deg from their own triangles");
      default:
        return "";
    }
  };
  for (std::size_t k = 0; k < corner_errors; ++k) {
    const auto code = static_cast<Code>(k);
    if (counts.of_error[k] == 0) continue;
    if (counts.are_few(code, mesh_.corners(), options_.max_angle_deg)) {
      add(report_, warning(code, counts.of_error[k], more(code), reasons::few));
      continue;
    }
    Finding found = finding(code, counts.of_error[k], more(code));
    if (code == Code::normal_angle && normal_mistake_ == NormalMistake::negated) {
      found.message += "; nearly all are the true ones, negated";
      found.to_do = "negate the normals";
    }
    if (code == Code::tangent_not_orthogonal &&
        static_cast<double>(counts.in_plane) >= explains_most * static_cast<double>(counts.of_error[k])) {
      found.message +=
          "; they lie much nearer to the plane of their triangles, so the normals may be the ones that are "
          "wrong";
      found.to_do =
          "if the normals are wrong, transform them by the inverse transpose or recompute them; else "
          "project: t - (t.n) n, then normalise";
    }
    add(report_, std::move(found));
  }
}

void MeshValidation::add_warnings(const CornerCounts& counts) {
  for (const auto& [code, b, reason] :
       {std::tuple{Code::tangent_angle, counts.surface_tangents, reasons::unsure},
        {Code::normal_angle, counts.surface_normals, reasons::unsure},
        {Code::tangent_angle, counts.authored_tangents, reasons::edge},
        {Code::normal_angle, counts.authored_normals, reasons::edge},
        {Code::tangent_angle, counts.coarse_tangents, reasons::coarse},
        {Code::normal_angle, counts.coarse_normals, reasons::coarse},
        {Code::tangent_angle, counts.chord_tangents, reasons::chords},
        {Code::tangent_angle, counts.local_tangents, reasons::nearby},
        {Code::normal_angle, counts.local_normals, reasons::nearby}}) {
    add(report_,
        warning(code, b.counted(), worst_text(b.worst, std::string(reason.why)), {"", reason.to_do}));
  }
  add(report_, warning(Code::normal_angle, counts.lit_otherwise, "", reasons::lit_otherwise));
  add(report_, warning(Code::normal_angle, counts.departing, "", reasons::departing));
  add(report_, warning(Code::tangent_not_orthogonal, counts.leaning,
                       " (|t.n| > " + rounded(orthogonal_tolerance, 2) + "; above " +
                           rounded(along_normal_tolerance, 2) + " an error)"));
  add(report_, finding(Code::pole_tangent, counts.poles.counted(),
                       " (worst " + rounded(counts.poles.worst, 4) + " deg)"));
}

// For meshes without angles for the statistics.
void MeshValidation::keep_errors_by_triangles() {
  for (std::size_t c = 0; c < report_.errors_deg.size(); ++c) {
    if (!std::isnan(report_.errors_deg[c])) continue;
    const std::uint32_t v = mesh_.triangles[c / 3][c % 3];
    const auto sign = static_cast<std::int8_t>(under_test_.raw_sign[c / 3]);
    if (mesh_.tangents.empty() ? normal_error(v) : tangent_error({v, sign, false, 1}) == Decider::triangles)
      report_.errors_deg[c] =
          kept(mesh_.tangents.empty() ? supported_deg : under_test_.cones.outside_deg(v, sign));
  }
}

void MeshValidation::compare_with_neighbours() {
  if (!smooth_.known()) return;
  LocalReport& report = report_.local.emplace();
  if (!accurate_.known()) {
    report.classes = report_.classes;
    return;
  }
  report.classes = class_reports(under_test_.local, [this](std::uint32_t v) {
    return corners_of_[v] == 0 ? Angles{} : smooth_.angles[v];
  });
  std::size_t agreeing = 0;
  for (std::uint32_t v = 0; v < accurate_.truths().size(); ++v) {
    const Truth &a = accurate_.truth(v), &b = under_test_.local[v];
    if (classes_.of_vertex[v] != VertexClass::interior || !known(a) || !known(b)) continue;
    report.compared += corners_of_[v];
    if (agree(a, b, agree_within * options_.max_angle_deg)) agreeing += corners_of_[v];
  }
  if (report.compared == 0) return;
  report.agreement = static_cast<double>(agreeing) / static_cast<double>(report.compared);
  if (report.agreement < expected_agreement)
    add(report_, finding(Code::references_disagree, report.compared,
                         ": they agree at " + rounded(100 * report.agreement, 3) +
                             " % of interior corners, so that the positions stray from the surface in "
                             "waves, or the uvs are others"));
}

void MeshValidation::compare_with_mikktspace() {
  if (under_test_.mikktspace.empty()) return;
  MikktspaceComparison comparison =
      darboux::compare_with_mikktspace(under_test_, checks_, corners_of_, signs_.raw(), options_);
  const MikkReport& report = report_.mikktspace.emplace(std::move(comparison.report));
  add(report_, finding(Code::tangent_not_mikktspace, comparison.beyond, worst_text(comparison.worst_deg)));
  if (!only_mikktspace()) return;
  report_.classes = report.classes;
  for (std::size_t c = 0; c < report_.errors_deg.size(); ++c) {
    const std::uint32_t v = mesh_.triangles[c / 3][c % 3];
    const Vec4<float>& m = under_test_.mikktspace.at(c, v);
    const bool comparable = m.w != 0 && checks_[v].has_tangent;
    report_.errors_deg[c] =
        kept(comparable ? angles_to_mikktspace(mesh_, v, checks_[v], m, signs_.raw()).tangent : -1);
  }
}

void MeshValidation::look_at_signs() {
  if (mesh_.tangents.empty()) return;
  const HandednessConvention convention = report_.handedness.convention;
  // Where all normals oppose the winding, w has the opposite meaning: normals, winding or w may be wrong.
  if (!under_test_.normals.all_oppose) {
    if (convention == HandednessConvention::raw && options_.sign == SignConvention::gltf)
      add(report_,
          finding(Code::handedness_convention, signs_.all().raw, " (it would be glTF's if v were flipped)"));
    if (convention == HandednessConvention::gltf && options_.sign == SignConvention::raw)
      add(report_, finding(Code::binormal_against_v, signs_.all().gltf));
  }
  const bool mixed = convention == HandednessConvention::mixed;
  add(report_,
      finding(Code::handedness_mixed, mixed ? report_.handedness.wrong : signs_.in_opposite_islands(),
              signs_.islands_text()));
  std::size_t across = 0;
  for (std::uint32_t v = 0; v < corners_of_.size(); ++v)
    across += under_test_.across_mirror[v] ? corners_of_[v] : 0;
  add(report_, finding(Code::vertex_across_mirror, across));
}

void MeshValidation::diagnose() {
  if (!accurate_.known() || (accurate_.normals_agree() < Accurate::enough && !averages_.explain_normals()))
    normal_mistake_ = diagnose_normals(under_test_, accurate_, options_, report_);
  if (mesh_.tangents.empty()) return;
  const std::span<const Truth> truth = statistics_truth();
  std::size_t oblique = 0;
  double most = 0;
  const double near = 0.99 * std::sin(std::fmin(options_.max_angle_deg, 90) / degrees_per_radian);
  for (std::uint32_t v = 0; v < truth.size(); ++v) {
    const Vec3<double>&t = truth[v].tangent, &b = truth[v].bitangent;
    // For nearly all of them the cosine shows quickly that the angle is near 90 degrees.
    if (dot(t, b) * dot(t, b) < near * near * dot(t, t) * dot(b, b)) continue;
    if (is_pole(v) || !known(truth[v])) continue;
    const double off = std::fabs(90 - degrees_per_radian * angle_between(t, b));
    if (!(off - certain * truth[v].tangent_deg > options_.max_angle_deg)) continue;
    oblique += corners_of_[v];
    most = std::fmax(most, off);
  }
  add(report_, finding(Code::bitangent_not_orthogonal, oblique, " (by up to " + rounded(most, 3) + " deg)"));
  // The mesh's own triangles say whether there is anything to diagnose. Without a surface: any tangent
  // outside their cones. If a surface was recognised and their cones hold most tangents, its chart is not the
  // mesh's, and only another uv set may explain the tangents better.
  bool held = false;
  if (!accurate_.declared() && !under_test_.cones.empty()) {
    std::size_t within = 0, beyond = 0;
    for (std::uint32_t v = 0; v < mesh_.positions.size(); ++v) {
      const Claim claim = under_test_.cones.claim(v, 0);
      within += claim == Claim::within ? corners_of_[v] : 0;
      beyond += claim == Claim::beyond ? corners_of_[v] : 0;
    }
    if (!accurate_.known() && beyond == 0) return;
    held = accurate_.known() && within > beyond;
  }
  const auto mikktspace = [&](std::size_t c) {
    const std::uint32_t v = mesh_.triangles[c / 3][c % 3];
    const Vec4<float>& m = under_test_.mikktspace.at(c, v);
    const Vec3<double> n = mesh_.normals[v];
    if (m.w == 0 || !detail::finite(n))
      return Directions{detail::nan_vector<double>(), detail::nan_vector<double>()};
    const Vec3<double> t = direction_of(m);
    return Directions{t, double{m.w} * cross(n, t)};
  };
  const auto known_truth = [&](std::size_t c) {
    const Truth& t = truth[mesh_.triangles[c / 3][c % 3]];
    return Directions{t.tangent, t.bitangent};
  };
  // MikkTSpace's tangents of the same triangles are more certain than estimates from neighbours.
  const bool known_tangents =
      accurate_.known() &&
      std::any_of(truth.begin(), truth.end(), [](const Truth& t) { return std::isfinite(t.tangent_deg); });
  if (!known_tangents && !under_test_.mikktspace.empty())
    tangents_diagnosed_ = diagnose_tangents(under_test_, mikktspace, options_, held, report_);
  if (!tangents_diagnosed_ && !truth.empty())
    tangents_diagnosed_ = diagnose_tangents(under_test_, known_truth, options_, held, report_);
}

// Without uv area a tangent has no visible effect, so none can be wrong.
bool MeshValidation::lacks_uv_area() const {
  const auto any = [](const std::vector<bool>& of) {
    return std::find(of.begin(), of.end(), true) != of.end();
  };
  return !mesh_.uvs.empty() && any(under_test_.has_area) && !any(under_test_.has_uv_area);
}

void MeshValidation::add_notes() {
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    if (!under_test_.has_area[t])
      ++report_.degenerate_triangles;
    else if (!mesh_.uvs.empty() && under_test_.raw_sign[t] == 0)
      ++report_.degenerate_uv_triangles;
  }
  report_.faceted = 3 * static_cast<std::size_t>(std::count(under_test_.normals.faceted.begin(),
                                                            under_test_.normals.faceted.end(), true));
  add(report_, finding(Code::normals_oppose_winding, under_test_.normals.opposing));
  add(report_,
      finding(Code::reference_uncertain, undecided_,
              ": normals are known to " +
                  deviation_text(report_.normal_uncertainty_deg.rms(), 2, " deg rms") + ", tangents to " +
                  deviation_text(report_.tangent_uncertainty_deg.rms(), 2, " deg rms")));
  const std::size_t at_least_one = std::max<std::size_t>(mesh_.corners(), 1);
  add(report_, finding(Code::normals_inward, report_.inward));
  add(report_,
      finding(Code::faceted, report_.faceted,
              accurate_.known() && !accurate_.declared() ? "; they are not compared with the surface" : ""));
  add(report_, finding(Code::tangent_missing, mesh_.tangents.empty() ? at_least_one : 0,
                       mesh_.normals.empty() ? "" : "; only its normals are judged"));
  add(report_, finding(Code::normal_missing, mesh_.normals.empty() ? at_least_one : 0));
  add(report_,
      finding(Code::uv_without_area, !mesh_.tangents.empty() && lacks_uv_area() ? report_.corners : 0));
  add(report_, finding(Code::triangles_missing, mesh_.triangles.empty() ? 1 : 0));
  add(report_, finding(Code::vertex_unreferenced,
                       static_cast<std::size_t>(std::count(corners_of_.begin(), corners_of_.end(), 0U))));
}

void MeshValidation::decide() {
  const bool by_triangles = report_.triangles && report_.triangles->compared > 0;
  using enum ReferenceKind;
  report_.reference = decided_ > 0                              ? analytic
                      : by_triangles                            ? triangles
                      : locally_ > 0                            ? local
                      : report_.mikktspace && only_mikktspace() ? mikktspace
                                                                : none;
  const bool tangents = !mesh_.tangents.empty() && !(!mesh_.normals.empty() && lacks_uv_area());
  report_.without_errors = mesh_.triangles.empty() || (!tangents && mesh_.normals.empty()) ? Verdict::nothing
                           : !tangents || decided_ > 0 || by_triangles                     ? Verdict::pass
                                                                       : Verdict::undetermined;
  const bool any_error = !report_.findings.empty() && report_.findings.front().severity == Severity::error;
  report_.verdict = any_error ? Verdict::fail : report_.without_errors;
}

}  // namespace

MeshReport validate(const MeshUnderTest& under_test, std::span<const Truth> truth, Basis basis,
                    const ValidateOptions& options) {
  return MeshValidation(under_test, truth, basis, options).report();
}

MeshReport validate(const Mesh& mesh, const std::optional<PlacedSurface>& placed,
                    const ValidateOptions& options) {
  std::vector<Truth> truth;
  if (placed) truth.reserve(mesh.uvs.size());
  if (placed)
    for (const Vec2<double>& uv : mesh.uvs) truth.push_back(placed->truth(uv));
  return validate(mesh, truth, options);
}

MeshReport validate(const Mesh& mesh, std::span<const Truth> truth, const ValidateOptions& options) {
  check_consistent(mesh, "mesh");
  if (!truth.empty() && truth.size() != mesh.positions.size())
    throw MeshError("mesh", std::to_string(truth.size()) + " truths for " +
                                std::to_string(mesh.positions.size()) +
                                " vertices, expected one per vertex or none");
  MeshUnderTest under_test = prepare(mesh, options);
  add_references(under_test, options);
  classify_vertices(under_test, poles(truth), options);
  return validate(under_test, truth, Basis::declared, options);
}

}  // namespace darboux
