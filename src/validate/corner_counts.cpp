#include "corner_counts.h"

#include <cmath>
#include <string_view>

#include "base/text.h"
#include "linear_maps.h"

namespace darboux {
namespace {

// Why a deviation is no error, and what to do then; empty: what its kind says.
struct Reason {
  std::string_view why, to_do;
};
namespace reasons {

constexpr Reason unsure{
    "; by the recognised surface, with which too few corners agree to call that an error",
    "nothing, if the mesh is not that surface; otherwise declare it (--surface), and correct what is off"},
    edge{
        "; at borders, seams and creases of the recognised surface, or blended from there, where they may be "
        "authored: the corners' own triangles do not speak against them",
        "nothing, where they are authored; else recompute them"},
    coarse{
        "; averages of their own triangles', or near these: the mesh is too coarse for the recognised "
        "surface, or leaves it",
        "nothing, or refine the mesh there"},
    chords{
        "; outside the cone of their own triangles, which are too coarse to tell: neighbouring vertices "
        "allow it",
        "nothing, or refine the mesh there"},
    few{"; few corners, told by their own triangles alone, which may have been cut, subdivided or "
        "simplified since",
        "nothing, if triangles were cut, subdivided, simplified or quantised after tangents were computed; "
        "else recompute tangents"},
    nearby{"; told by neighbouring vertices alone, so only what is beyond three times the limit counts", ""},
    lit_otherwise{
        "; more than 80 deg from their own triangles, at borders, at slivers or where normals are smooth, "
        "which may be meant",
        "nothing, where cards, skirts or crowns are lit as the ground or the whole is, or at slivers; else "
        "recompute normals"},
    departing{"; more than 60 deg from their own triangles, and no average of these",
              "nothing, where they are authored; else recompute normals"};

// By Excuse.
constexpr std::array of_excuse{unsure, edge, coarse};

}  // namespace reasons

// The warning with the reason's `why` appended to its message.
Finding warning(Code code, std::size_t count, const std::string& more, const Reason& reason) {
  Finding result = warning(code, count, more + std::string(reason.why));
  if (!reason.to_do.empty()) result.to_do = reason.to_do;
  return result;
}

void count_errors(const Answers& answers, const Judge& judge, const CornerGroup& group, Code error,
                  CornerCounts& counts) {
  const std::uint32_t v = group.vertex;
  const std::size_t corners = group.corners;
  if (error != Judge::no_code) counts.of_error[static_cast<std::size_t>(error)] += corners;
  const bool cones = !answers.under_test.cones.empty();
  const double outside = cones ? answers.under_test.cones.outside_deg(v, group.sign) : 0;
  if (cones && answers.under_test.cones.claim(v, group.sign) != Claim::none) {
    counts.triangles.compared += corners;
    if (outside > 0) counts.triangles.outside += corners;
    counts.triangles.worst_deg = std::fmax(counts.triangles.worst_deg, outside);
  } else if (cones && group.sign != 0 && answers.checks[v].has_tangent && answers.checks[v].has_normal &&
             answers.under_test.normals.drawn[v]) {
    counts.triangles.open += corners;
  }
  if (error == Code::tangent_not_unit) counts.tangent_lengths.add(norm(answers.mesh.tangents[v].xyz()));
  if (error == Code::normal_not_unit) counts.normal_lengths.add(norm(answers.mesh.normals[v]));
  if (error == Code::tangent_not_orthogonal) {
    const double along = cosine_between(answers.mesh.tangents[v].xyz(), answers.mesh.normals[v]);
    counts.most_along_normal = std::fmax(counts.most_along_normal, along);
    if (counts.planes.empty()) {
      VertexJoins of_part;
      counts.planes = planes_of_vertices(answers.mesh, joins_of(answers.under_test, of_part));
    }
    if (cosine_between(answers.mesh.tangents[v].xyz(), counts.planes[v]) <= along / 2)
      counts.in_plane += corners;
  }
  const Angles surface = answers.accurate.known() ? answers.accurate.angles(v) : Angles{};
  const Judge::Decider decider =
      answers.mesh.tangents.empty() ? Judge::Decider::nobody : judge.tangent_error(group);
  if (decider != Judge::Decider::nobody) counts.tangents.in_all += corners;
  if (error == Code::tangent_angle) {
    const bool by_surface = decider == Judge::Decider::surface;
    (by_surface ? counts.tangents.by_surface : counts.tangents.by_triangles) += corners;
    counts.tangents.worst =
        std::fmax(counts.tangents.worst, by_surface ? surface.projected_tangent : outside);
  }
  if (judge.normal_error(v)) counts.normals.in_all += corners;
  if (error == Code::normal_angle) {
    const bool by_triangles = judge.is_unsupported(v);
    (by_triangles ? counts.normals.by_triangles : counts.normals.by_surface) += corners;
    counts.normals.worst = std::fmax(counts.normals.worst, surface.normal);
  }
}

void count_warnings(const Answers& answers, const Judge& judge, const CornerGroup& group, Code error,
                    CornerCounts& counts) {
  const std::uint32_t v = group.vertex;
  const auto warn = [&](Beyond& where, double angle) {
    where.by_surface += group.corners;
    where.worst = std::fmax(where.worst, angle);
  };
  const Angles surface = answers.accurate.known() ? answers.accurate.angles(v) : Angles{};
  if (answers.is_pole(v) && surface.tangent > answers.limit_of(v)) warn(counts.poles, surface.tangent);
  if (answers.checks[v].leans && !answers.is_unseen(v)) counts.leaning += group.corners;
  if (judge.is_unsupported(v) && judge.may_be_lit_otherwise(v)) counts.lit_otherwise += group.corners;
  // At a border of a coarse sheet, even exact normals may be this far off.
  const bool is_told = answers.accurate.known() || answers.classes.of_vertex[v] == VertexClass::border ||
                       (answers.smooth.known() && answers.smooth.normals[v] != Claim::none);
  if (!is_told && !answers.mesh.normals.empty() && answers.under_test.normals.departing[v])
    counts.departing += group.corners;
  if (error == Judge::no_code && answers.accurate.known() && answers.accurate.tangent(v) == Claim::beyond)
    warn(counts.excused_tangents[static_cast<std::size_t>(judge.tangent_excuse(group))],
         surface.projected_tangent);
  if (!judge.normal_error(v) && answers.accurate.known() && answers.accurate.normal(v) == Claim::beyond)
    warn(counts.excused_normals[static_cast<std::size_t>(judge.normal_excuse(v))], surface.normal);
  if (!answers.smooth.known() || answers.is_pole(v)) return;
  if (error == Judge::no_code && !answers.accurate.known() && !answers.under_test.cones.empty() &&
      answers.under_test.cones.claim(v, group.sign) == Claim::beyond)
    warn(counts.chord_tangents, answers.under_test.cones.outside_deg(v, group.sign));
  // Polynomials ignore folds of the uvs, such as those of octahedral maps.
  const bool is_average =
      !answers.under_test.cones.empty() && answers.under_test.cones.claim(v, group.sign) == Claim::within;
  if (error == Judge::no_code && answers.smooth.tangents[v] == Claim::beyond && !is_average &&
      (!answers.accurate.known() || answers.accurate.tangent(v) == Claim::none))
    warn(counts.local_tangents, answers.smooth.angles[v].projected_tangent);
  if (!judge.normal_error(v) && !judge.is_unsupported(v) && answers.smooth.normals[v] == Claim::beyond &&
      (!answers.accurate.known() || answers.accurate.normal(v) == Claim::none))
    warn(counts.local_normals, answers.smooth.angles[v].normal);
}

void add_errors(const CornerCounts& counts, const Answers& answers, const Judge& judge, MeshReport& report) {
  const double limit = answers.options.max_angle_deg;
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
                                                                       : worst_text(limit, b.worst, more);
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
    if (counts.are_few(code, answers.mesh.corners(), limit)) {
      add(report, warning(code, counts.of_error[k], more(code), reasons::few));
      continue;
    }
    Finding found = finding(code, counts.of_error[k], more(code));
    if (code == Code::normal_angle && judge.normal_mistake() == NormalMistake::negated) {
      found.message += "; nearly all are the true ones, negated";
      found.to_do = "negate the normals";
    }
    if (code == Code::normal_not_unit && counts.normal_lengths.hold_zero())
      found.to_do = counts.normal_lengths.are_zero()
                        ? "recompute them"
                        : "recompute those of length 0; normalise the others before writing";
    if (code == Code::tangent_not_orthogonal &&
        static_cast<double>(counts.in_plane) >= explains_most * static_cast<double>(counts.of_error[k])) {
      found.message +=
          "; they lie much nearer to the plane of their triangles, so the normals may be the ones that are "
          "wrong";
      found.to_do =
          "if the normals are wrong, transform them by the inverse transpose or recompute them; else "
          "project: t - (t.n) n, then normalise";
    }
    add(report, std::move(found));
  }
}

void add_warnings(const CornerCounts& counts, double limit, MeshReport& report) {
  const auto warn = [&](Code code, const Beyond& b, const Reason& reason) {
    add(report,
        warning(code, b.counted(), worst_text(limit, b.worst, std::string(reason.why)), {"", reason.to_do}));
  };
  for (std::size_t k = 0; k < excuses; ++k) {
    warn(Code::tangent_angle, counts.excused_tangents[k], reasons::of_excuse[k]);
    warn(Code::normal_angle, counts.excused_normals[k], reasons::of_excuse[k]);
  }
  warn(Code::tangent_angle, counts.chord_tangents, reasons::chords);
  warn(Code::tangent_angle, counts.local_tangents, reasons::nearby);
  warn(Code::normal_angle, counts.local_normals, reasons::nearby);
  add(report, warning(Code::normal_angle, counts.lit_otherwise, "", reasons::lit_otherwise));
  add(report, warning(Code::normal_angle, counts.departing, "", reasons::departing));
  add(report, warning(Code::tangent_not_orthogonal, counts.leaning,
                      " (|t.n| > " + rounded(orthogonal_tolerance, 2) + "; above " +
                          rounded(along_normal_tolerance, 2) + " an error)"));
  add(report, finding(Code::pole_tangent, counts.poles.counted(),
                      " (worst " + rounded(counts.poles.worst, 4) + " deg)"));
}

}  // namespace

void Lengths::add(double length) {
  least_ = std::fmin(least_, length), most_ = std::fmax(most_, length);
}

std::string Lengths::text() const {
  const std::string from = rounded(least_, 4), to = rounded(most_, 4);
  return from == to ? " (length " + to + ")" : " (lengths " + from + " to " + to + ")";
}

bool CornerCounts::are_few(Code code, std::size_t corners, double limit_deg) const {
  constexpr std::size_t most = 24, most_near = 12;
  const bool near = tangents.by_triangles <= most_near && tangents.worst <= 2.5 * limit_deg;
  const std::size_t in = near ? 80 : 500;
  return code == Code::tangent_angle && tangents.by_surface == 0 && in * tangents.by_triangles < corners &&
         tangents.by_triangles <= most;
}

std::string worst_text(double limit_deg, double worst_deg, const std::string& more) {
  return (worst_deg > 0 ? " (worst " + rounded(worst_deg, 4) + " deg, limit " : std::string(" (limit ")) +
         rounded(limit_deg, 4) + " in the interior, " + rounded(3 * limit_deg, 4) + " elsewhere" + more + ")";
}

CornerCounts count_corners(const Answers& answers, const Judge& judge) {
  CornerCounts counts;
  for_each_corner_group(answers, [&](const CornerGroup& group) {
    const Code error = judge.error_of(group);
    count_errors(answers, judge, group, error, counts);
    count_warnings(answers, judge, group, error, counts);
  });
  return counts;
}

void add_findings(const CornerCounts& counts, const Answers& answers, const Judge& judge,
                  MeshReport& report) {
  add_errors(counts, answers, judge, report);
  add_warnings(counts, answers.options.max_angle_deg, report);
}

}  // namespace darboux
