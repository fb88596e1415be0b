#include "validate_page.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "base/counted.h"
#include "report/colour_map.h"
#include "report/histogram.h"
#include "report/html.h"
#include "report/mesh_picture.h"

namespace darboux {

extern const std::string_view validate_page_js, validate_page_js_sha256;  // embedded by the build

namespace {

constexpr std::size_t most_triangles = 300000;  // in the pictures of a page
constexpr std::size_t most_open = 4;            // meshes, before they are folded
constexpr std::size_t most_parts = 12;          // of a mesh, before those that pass are folded

constexpr std::string_view style = R"css(
[hidden]{display:none!important}
h2{margin-top:1.75rem}
h4{font-size:.95rem;margin:1.25rem 0 .25rem}
summary{cursor:pointer}
h1,h2,h3,p,li{overflow-wrap:anywhere}
th[colspan]{text-align:center;border-bottom:1px solid var(--line)}
figcaption{margin-top:.4rem}
.controls{display:flex;flex-wrap:wrap;align-items:center;gap:.5rem 1rem;margin:1rem 0 .75rem;font-size:.9rem}
.controls label{display:flex;align-items:center;gap:.35rem}
select{font:inherit;color:inherit;background:var(--card);border:1px solid var(--line);border-radius:.35rem;
  padding:.15rem .35rem;
  max-width:16rem}
.card.mesh{padding:0;margin:0 0 .6rem}
.mesh>summary,.row{display:grid;grid-template-columns:8.5rem minmax(0,1fr) 7rem 7rem;gap:.1rem 1rem;
  align-items:baseline;
  padding:.6rem 1rem;list-style:none}
.mesh>summary::-webkit-details-marker{display:none}
.mesh[open]>summary{border-bottom:1px solid var(--faint)}
.body{padding:1rem}
.name{font-weight:600;overflow-wrap:anywhere}
.name .soft{font-weight:400}
.codes{grid-column:2/-1;color:var(--soft);font-size:.85rem;overflow-wrap:anywhere}
.row.head{color:var(--soft);font-size:.9rem;padding-top:0;padding-bottom:.3rem}
.findings{list-style:none;margin:0;padding:0}
.findings li{padding:.45rem 0;border-bottom:1px solid var(--faint)}
.findings li>span{display:block}
.findings .verdict{display:inline-block;margin-right:.4rem}
.part{border:1px solid var(--faint);border-radius:.4rem;padding:.4rem .8rem;margin:.5rem 0}
.part[open]>summary{margin-bottom:.5rem}
.warn{background:#fbf1cf;color:#5d4700}
.histogram{display:block;width:100%;max-width:48rem;font-size:12px}
.histogram text{fill:var(--soft)}
.histogram path{fill:none}
.grid{stroke:var(--faint)}
.axis{stroke:var(--soft)}
.limit{stroke:var(--ink);stroke-dasharray:5 4}
canvas{display:block;width:100%;max-width:32rem;border:1px solid var(--line);border-radius:.35rem;
  color:var(--soft)}
canvas.uv,canvas.view{aspect-ratio:1}
canvas.view{cursor:grab;touch-action:none}
canvas.view:active{cursor:grabbing}
.legend{display:flex;flex-wrap:wrap;align-items:center;gap:.25rem .5rem;margin:0 0 .75rem;font-size:.9rem;
  color:var(--soft)}
.legend i{display:inline-block;height:1rem;width:min(16rem,40%);border-radius:.2rem}
.legend i.none{width:1rem;margin-left:1rem}
@media (max-width:40rem){
  main{padding:1rem .75rem 2rem}
  .row.head{display:none}
  .name{order:1}
  .histogram{font-size:16px}
  .codes{order:2}
  .mesh>summary,.row{grid-template-columns:auto minmax(0,1fr) auto;padding:.55rem .7rem}
  .name{grid-column:1/-1}
  .codes{grid-column:1/-1}
  .body{padding:.7rem}
  .part{padding:.4rem .5rem}
}
@media screen and (prefers-color-scheme:dark){.warn{background:#4b3c08;color:#f6e3a1}}
)css";

std::string text(std::string_view words) {
  return "<bdi>" + escape(one_line(std::string(words))) + "</bdi>";
}

std::string badge(Verdict verdict) {
  constexpr std::pair<std::string_view, std::string_view> marks[] = {
      {"plain", "–"}, {"good", "✓"}, {"plain", "?"}, {"bad", "✕"}};
  const auto k = static_cast<std::size_t>(verdict);
  return "<span class=\"verdict " + std::string(marks[k].first) + "\">" + std::string(marks[k].second) + ' ' +
         std::string(verdict_names[k]) + "</span>";
}

std::string badge(Severity severity) {
  constexpr std::string_view classes[] = {"plain", "warn", "bad"};
  const auto k = static_cast<std::size_t>(severity);
  return "<span class=\"verdict " + std::string(classes[k]) + "\">" + std::string(severity_names[k]) +
         "</span>";
}

std::string css_gradient() {
  std::string stops;
  for (const Vec3<float>& colour : viridis()) stops += ',' + css_colour(colour);
  return ".legend i{background:linear-gradient(to right" + stops +
         ")}\n.legend i.none{background:" + css_colour(not_compared) + "}\n";
}

// "shared/…/IridescenceSuzanne.glb": the beginning and the end, whole names where they fit. The whole path
// is the title.
std::string path_text(const std::string& path) {
  constexpr std::size_t most = 64;
  const std::string line = one_line(path);
  if (line.size() <= most) return text(line);
  // Cut between characters, not within one.
  const auto is_inside = [&](std::size_t k) { return k < line.size() && (line[k] & 0xc0) == 0x80; };
  std::size_t begin = line.find('/', 1), end = line.size() - std::min(line.size(), most - 14);
  begin = begin == std::string::npos || begin > 12 ? 12 : begin + 1;
  if (const std::size_t name = line.find('/', end); name != std::string::npos) end = name;
  while (is_inside(begin)) ++begin;
  while (is_inside(end)) ++end;
  return "<bdi title=\"" + escape(line) + "\">" + escape(line.substr(0, begin)) + "…" +
         escape(line.substr(end)) + "</bdi>";
}

// ---- one mesh

// A primitive and its assessments: the whole, or its parts.
struct Entry {
  const AssessedFile& file;
  const AssessedPrimitive& assessed;
  std::size_t number;  // of its first assessment, as in the JSON
  bool alone;          // in its file
  double limit;
  std::size_t step = 1;  // every step-th triangle is drawn
  Verdict verdict = Verdict::nothing;
  std::size_t corners = 0;
  std::vector<std::uint32_t> triangles{};
  std::vector<float> errors{};  // of their corners
  float worst = std::numeric_limits<float>::quiet_NaN();

  bool has_tangents() const { return !assessed.primitive.data.tangents.empty(); }
  std::string quantity() const { return has_tangents() ? "tangent" : "normal"; }  // that the errors are of
};

std::vector<Entry> entries_of(const std::vector<AssessedFile>& files, double max_angle_deg) {
  std::vector<Entry> entries;
  std::size_t number = 0;
  for (const AssessedFile& file : files)
    for (const AssessedPrimitive& assessed : file.primitives) {
      Entry e{file, assessed, number, file.primitives.size() == 1, max_angle_deg};
      number += assessed.assessments.size();
      for (const Assessment& j : assessed.assessments) {
        e.verdict = std::max(e.verdict, j.report.verdict);
        e.corners += j.report.corners;
        const std::size_t count = j.report.errors_deg.size() / 3;
        for (std::size_t t = 0; t < count; ++t)
          e.triangles.push_back(j.triangles.empty() ? static_cast<std::uint32_t>(t) : j.triangles[t]);
        e.errors.insert(e.errors.end(), j.report.errors_deg.begin(), j.report.errors_deg.end());
      }
      for (const float error : e.errors) e.worst = std::fmax(e.worst, error);
      entries.push_back(std::move(e));
    }
  std::vector<std::size_t> triangles;
  for (const Entry& e : entries) triangles.push_back(e.triangles.size());
  const std::vector<std::size_t> steps = picture_steps(triangles, most_triangles);
  for (std::size_t k = 0; k < entries.size(); ++k) entries[k].step = steps[k];
  std::vector<Entry> sorted;  // failures first
  for (const Verdict v : {Verdict::fail, Verdict::undetermined, Verdict::pass, Verdict::nothing})
    for (Entry& e : entries)
      if (e.verdict == v) sorted.push_back(std::move(e));
  return sorted;
}

// The sentence on what decided.
std::string_view decided_by(const MeshReport& report) {
  switch (report.reference) {
    case ReferenceKind::analytic:
      return "Judged by that surface.";
    case ReferenceKind::triangles:
      return "Judged by the mesh's own triangles: what directions their uvs permit.";
    case ReferenceKind::local:
      return "Compared with polynomials through the mesh's own positions and uvs.";
    case ReferenceKind::mikktspace:
      return "Judged by MikkTSpace's tangents of the mesh's own data.";
    case ReferenceKind::none:
      break;
  }
  return report.corners == 0 ? ""
                             : "No surface is known here; normals were held against their own triangles.";
}

std::string reference_text(const Assessment& assessment) {
  const MeshReport& report = assessment.report;
  std::string words;
  if (assessment.fit && assessment.fit->fits)
    words = "The surface is " + text(assessment.fit->surface.surface.specification(6)) +
            (assessment.fit->chart == UvChart::unknown
                 ? std::string()
                 : "; the uvs are " + text(uv_convention(*assessment.fit))) +
            ". ";
  if (assessment.fit && assessment.fit->fits && assessment.evidence && !assessment.evidence->text.empty())
    words += "What speaks for it: " + text(assessment.evidence->text) + ". ";
  words += decided_by(report);
  if (has_uncertainty(report))
    words += " It is uncertain by " +
             escape(deviation_text(report.normal_uncertainty_deg.rms(), 2, "° rms")) + " (normals)" +
             (has_tangent_angles(report)
                  ? " and " + escape(deviation_text(report.tangent_uncertainty_deg.rms(), 2, "° rms")) +
                        " (tangents)."
                  : ".");
  if (report.triangles && report.triangles->compared + report.triangles->open > 0) {
    const TrianglesReport& t = *report.triangles;
    if (t.compared > 0) {
      words += " At " + std::to_string(t.compared - t.outside) + " of " + counted(t.compared, "corner") +
               " the tangent lies within the cone of its own triangles";
      if (t.outside > 0) words += ", at the others up to " + rounded(t.worst_deg, 3) + "° outside";
      words += '.';
    }
    if (t.open > 0)
      words +=
          " The triangles cannot judge " + counted(t.open, t.compared > 0 ? "other corner" : "corner") + '.';
  }
  if (report.faceted > 0)
    words += " Faceted: at " + counted(report.faceted, "corner") + " the normal is the triangle's own.";
  if (report.handedness.convention != HandednessConvention::none)
    words += " The sign w follows the convention " + text(name_of(report.handedness.convention)) + '.';
  if (report.mikktspace)
    words += " The tangents equal MikkTSpace's to the bit at " +
             rounded(100 * report.mikktspace->equal_bits, 4) + " % of corners.";
  return "<p>" + words + "</p>\n";
}

std::string findings_list(const MeshReport& report) {
  if (report.findings.empty()) return "<p>Nothing was found.</p>\n";
  std::string rows;
  for (const Finding& f : report.findings)  // the worst first
    rows += "<li class=finding>" + badge(f.severity) + "<code>" + text(f.code) + "</code> <b>" +
            std::to_string(f.count) + "</b><span class=message>" + text(f.message) +
            "</span><span class=\"soft to-do\">" + text(f.to_do) + "</span></li>\n";
  return "<ul class=findings>\n" + rows + "</ul>\n";
}

std::string class_table(const Assessment& assessment) {
  const MeshReport& report = assessment.report;
  std::string rows;
  for (const ClassReport& c : report.classes) {
    if (!c.normal_deg && !c.tangent_deg && !c.bitangent_deg) continue;
    rows += "<tr class=vertex-class><th scope=row>" + text(name_of(c.vertex_class)) + "<td class=n>" +
            std::to_string(c.corners);
    for (const auto& s : {c.normal_deg, c.tangent_deg, c.bitangent_deg})
      for (const auto member : {&Statistics::max, &Statistics::rms, &Statistics::p95})
        rows += "<td class=n>" + (s ? rounded((*s).*member, 3) : std::string("–"));
    rows += "<td class=n>" + (c.worst ? std::to_string(c.worst->vertex) : std::string("–")) + "</tr>\n";
  }
  if (rows.empty()) return {};
  std::string head;
  for (int k = 0; k < 3; ++k)
    head += "<th scope=col class=n>largest<th scope=col class=n>rms<th scope=col class=n>95&nbsp;% below";
  const ReferenceKind angles_to = reference_of_classes(assessment);
  return "<h4>Errors by class of vertices, in degrees" +
         (angles_to == report.reference ? "" : ", against " + std::string(name_of(angles_to))) +
         "</h4>\n<div class=scroll tabindex=0><table class=classes>\n"
         "<thead><tr><th rowspan=2 scope=col>class<th rowspan=2 scope=col class=n>corners"
         "<th colspan=3 scope=colgroup>normals<th colspan=3 scope=colgroup>tangents"
         "<th colspan=3 scope=colgroup>bitangents<th rowspan=2 scope=col class=n>worst<br>vertex</tr>\n<tr>" +
         head + "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n";
}

std::string legend(double limit_deg) {
  const std::string limit = rounded(limit_deg, 4) + "°";
  return "<div class=legend role=img aria-label=\"Colours from 0 to " + limit +
         " of error, dark to light; grey: not compared\"><span>0°</span><i></i><span>" + limit +
         " and more</span><i class=none></i><span>not compared</span></div>\n";
}

std::string pictures(const Entry& e) {
  if (e.triangles.empty()) return {};
  const Json data =
      mesh_picture(e.assessed.primitive.data,
                   {.triangles = e.triangles, .errors_deg = e.errors, .limit_deg = e.limit, .step = e.step});
  std::string html =
      legend(e.limit) +
      "<div hidden class=pictures>\n<figure><canvas class=view tabindex=0 role=application "
      "aria-label=\"The mesh, coloured by " +
      e.quantity() +
      " error. Arrow keys turn it, plus and minus zoom, 0 starts again.\"></canvas>"
      "<p class=no-webgl hidden>The mesh is not shown: this browser has no WebGL 2.</p>"
      "<figcaption>The mesh, coloured by " +
      e.quantity() +
      " error. Drag or use the arrow keys to turn it; the wheel (after a click), two fingers or + and "
      "− zoom; 0 starts again.</figcaption></figure>\n";
  if (const auto square = data.find("square"); square != data.end()) {
    const auto at = [&](std::size_t k) { return rounded((*square)[k].get<double>(), 4); };
    const std::string range = "u from " + at(0) + " to " + at(1) + ", v from " + at(2) + " to " + at(3);
    html += "<figure><canvas class=uv role=img aria-label=\"The uv square, coloured by error: " + range +
            "\"></canvas><figcaption>Over the uvs: " + range +
            ", v downwards; the frame is the square from 0 to 1. Where triangles overlap, the largest error "
            "shows."
            "</figcaption></figure>\n";
  }
  html += "</div>\n";
  if (e.step > 1)
    html += "<p class=soft>Of " + std::to_string(e.triangles.size()) + " triangles every " +
            std::to_string(e.step) +
            (e.step == 2   ? "nd"
             : e.step == 3 ? "rd"
                           : "th") +
            " is drawn. Tables and histogram are of all.</p>\n";
  return html + "<script type=\"application/json\">" + script_json(data) + "</script>\n";
}

// How often a code was found with one severity.
struct CodeCount {
  const FindingKind* kind;
  Severity severity;
  std::size_t count;
};

// Over all parts, errors and warnings, errors first.
std::vector<CodeCount> codes_of(const Entry& e) {
  std::vector<CodeCount> codes;
  for (const Severity severity : {Severity::error, Severity::warning})
    for (const Assessment& j : e.assessed.assessments)
      for (const Finding& f : j.report.findings) {
        if (f.severity != severity) continue;
        const auto at = std::find_if(codes.begin(), codes.end(), [&](const CodeCount& c) {
          return c.kind == &finding_kinds()[f.kind] && c.severity == severity;
        });
        if (at == codes.end())
          codes.push_back({&finding_kinds()[f.kind], severity, f.count});
        else
          at->count += f.count;
      }
  return codes;
}

// Those of one severity: "TANGENT_ANGLE 12, NORMAL_ANGLE 3".
std::string codes_text(const std::vector<CodeCount>& codes, Severity severity, const char* between) {
  std::string words;
  for (const CodeCount& c : codes)
    if (c.severity == severity)
      words += (words.empty() ? "" : between) + text(c.kind->code) + ' ' + std::to_string(c.count);
  return words;
}

std::string histogram(const Entry& e) {
  const std::string svg = histogram_svg(e.errors, e.limit, e.quantity() + " errors");
  if (svg.empty()) return {};
  std::size_t compared = 0, beyond = 0;
  for (const float error : e.errors) compared += !std::isnan(error), beyond += error > e.limit;
  std::string words = std::to_string(beyond) + " of " + counted(compared, "corner") +
                      " compared lie beyond the interior's limit, " + rounded(e.limit, 4) + "°.";
  const std::vector<CodeCount> codes = codes_of(e);
  const std::string errors = codes_text(codes, Severity::error, ", "),
                    warnings = codes_text(codes, Severity::warning, ", ");
  if (beyond > 0) words += " Seams, pole rings, creases and borders may be three times as far.";
  if (beyond > 0 && !errors.empty())
    words += " A corner counts as one error at most, the first that it meets: " + errors + '.';
  if (beyond > 0 && !warnings.empty())
    words += " Warnings, of which a corner may have several: " + warnings + '.';
  double uncertain = 0;
  for (const Assessment& j : e.assessed.assessments)
    uncertain = std::fmax(
        uncertain,
        (e.has_tangents() ? j.report.tangent_uncertainty_deg : j.report.normal_uncertainty_deg).rms());
  if (beyond > 0 && uncertain > e.limit / 10)
    words += " The reference itself is uncertain by up to " + escape(deviation_text(uncertain, 2, "° rms")) +
             "; what that may explain is not counted.";
  return "<h4>How many corners have which " + e.quantity() + " error</h4>\n<figure>" + svg + "<figcaption>" +
         words + "</figcaption></figure>\n";
}

std::string assessment_body(const Assessment& j, std::size_t number) {
  return "<div class=assessment data-number=" + std::to_string(number) +
         " data-verdict=" + std::string(name_of(j.report.verdict)) +
         " data-corners=" + std::to_string(j.report.corners) + ">\n" + findings_list(j.report) +
         reference_text(j) + class_table(j) + "</div>\n";
}

// The parts of a mesh, failures first, those of many that pass folded into one.
std::string parts(const Entry& e) {
  const std::vector<Assessment>& all = e.assessed.assessments;
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const MeshReport &x = all[a].report, &y = all[b].report;
    return x.verdict != y.verdict ? x.verdict > y.verdict : x.corners > y.corners;
  });
  std::string html = "<h4>Its " + counted(all.size(), "part") + "</h4>\n";
  bool folded = false;
  std::size_t shown = 0;
  for (const std::size_t k : order) {
    const MeshReport& report = all[k].report;
    if (!folded && report.verdict <= Verdict::pass && shown > 0 && all.size() > most_parts) {
      html += "<details class=part><summary>" + std::to_string(all.size() - shown) +
              " more parts that pass</summary>\n";
      folded = true;
    }
    ++shown;
    html += "<details class=part" +
            std::string(report.verdict == Verdict::fail && shown == 1 ? " open" : "") + "><summary>" +
            badge(report.verdict) + " part " + std::to_string(all[k].part.value_or(k)) +
            "<span class=soft> " + counted(report.corners, "corner") +
            (all[k].fit && all[k].fit->fits ? ", " + text(all[k].fit->surface.surface.info().name) : "") +
            "</span></summary>\n" + assessment_body(all[k], e.number + k) + "</details>\n";
  }
  return html + (folded ? "</details>\n" : "");
}

std::string entry(const Entry& e, bool one_file, bool open) {
  const std::vector<CodeCount> found = codes_of(e);
  std::string codes = codes_text(found, Severity::error, " · ");
  if (const std::string warnings = codes_text(found, Severity::warning, " · "); !warnings.empty())
    codes += (codes.empty() ? "warnings: " : " · warnings: ") + warnings;
  std::set<std::string> names;
  for (const CodeCount& c : found) names.emplace(c.kind->code);
  std::string code_names;
  for (const std::string& name : names) code_names += (code_names.empty() ? "" : " ") + name;
  const std::string place = primitive_text(e.assessed.primitive);
  const std::string name = one_file ? text(place)
                           : e.alone
                               ? path_text(e.file.path)
                               : path_text(e.file.path) + " <span class=soft>" + text(place) + "</span>";
  std::string html = "<details class=\"card mesh\" id=m" + std::to_string(e.number) + (open ? " open" : "") +
                     " data-verdict=" + std::string(name_of(e.verdict)) + " data-codes=\"" +
                     escape(code_names) + "\" data-corners=" + std::to_string(e.corners) +
                     " data-worst=" + (std::isnan(e.worst) ? "-1" : rounded(e.worst, 6)) +
                     ">\n<summary><span>" + badge(e.verdict) + "</span><span class=name>" + name +
                     "</span><span class=n>" + std::to_string(e.corners) + "</span><span class=n>" +
                     (std::isnan(e.worst) ? "–" : rounded(e.worst, 3) + "°") + "</span>";
  const std::size_t count = e.assessed.assessments.size();
  if (count > 1 || !codes.empty())
    html += "<span class=codes>" + (count > 1 ? counted(count, "part") : "") +
            (count > 1 && !codes.empty() ? " · " : "") + codes + "</span>";
  html += "</summary>\n<div class=body>\n";
  if (!one_file) html += "<p class=soft>" + text(e.file.path) + ", " + text(place) + "</p>\n";
  html += pictures(e);
  if (count == 1) html += assessment_body(e.assessed.assessments.front(), e.number);
  html += histogram(e);
  if (count > 1) html += parts(e);
  return html + "</div></details>\n";
}

// ---- the page

// The filters by verdict and code, and the sort order; the script shows these controls.
std::string controls(const std::vector<Entry>& entries, std::size_t unread) {
  std::string html = "<div hidden class=controls>\n";
  for (const Verdict v : {Verdict::fail, Verdict::undetermined, Verdict::pass, Verdict::nothing}) {
    const auto k = static_cast<std::size_t>(v);
    const std::size_t count =
        static_cast<std::size_t>(
            std::count_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.verdict == v; })) +
        (v == Verdict::fail ? unread : 0);
    if (count > 0)
      html += "<label><input type=checkbox checked class=by-verdict value=" + std::string(verdict_names[k]) +
              ">" + badge(v) + " " + std::to_string(count) + "</label>\n";
  }
  std::map<std::string, std::size_t> codes;  // and of how many meshes
  for (const Entry& e : entries) {
    std::set<std::string> names;
    for (const CodeCount& c : codes_of(e)) names.emplace(c.kind->code);
    for (const std::string& name : names) ++codes[name];
  }
  if (!codes.empty()) {
    html += "<label>finding <select class=by-code><option value=\"\">any</option>";
    for (const auto& [code, count] : codes)
      html += "<option value=\"" + escape(code) + "\">" + escape(code) + " (" + std::to_string(count) +
              ")</option>";
    html += "</select></label>\n";
  }
  return html +
         "<label>sort by <select class=sort><option value=verdict>verdict</option><option "
         "value=name>name</option>"
         "<option value=corners>corners</option><option value=worst>largest error</option></select></label>\n"
         "<span class=\"soft shown\" aria-live=polite></span></div>\n";
}

// Rows without a picture: files that could not be read, and what was not assessed, one line per reason.
std::string unread_rows(const std::vector<AssessedFile>& files) {
  std::string html;
  for (const AssessedFile& file : files)
    if (!file.readable())
      html +=
          "<div class=\"card mesh row\" data-verdict=fail data-codes=\"\" data-corners=0 "
          "data-worst=-1><span>" +
          badge(Verdict::fail) + "</span><span class=name>" + path_text(file.path) +
          "</span><span class=n>–</span><span class=n>–</span><span class=codes>Not read: " +
          text(file.error) + "</span></div>\n";
  return html;
}

std::string not_assessed(const std::vector<AssessedFile>& files) {
  std::map<std::string, std::vector<std::string>> by_reason;
  for (const AssessedFile& file : files) {
    if (!file.readable()) continue;
    for (const SkippedPrimitive& s : file.skipped)
      by_reason[s.reason].push_back((files.size() > 1 ? file.path + ", " : std::string()) +
                                    primitive_text(s.mesh, s.primitive));
    if (file.primitives.empty() && file.skipped.empty())
      by_reason["no triangles to judge"].push_back(file.path);
  }
  std::string html;
  for (const auto& [reason, places] : by_reason) {
    html += "<details class=part><summary>Not judged, " + std::to_string(places.size()) + ": " +
            text(reason) + "</summary>\n<ul>\n";
    for (const std::string& place : places) html += "<li>" + text(place) + "</li>\n";
    html += "</ul></details>\n";
  }
  return html;
}

}  // namespace

std::string validate_page(const std::vector<AssessedFile>& files, double max_angle_deg) {
  Verdict verdict = Verdict::nothing;
  for (const AssessedFile& file : files)
    verdict = std::max(verdict, file.readable() ? file.verdict : Verdict::fail);
  const std::string what = files.size() == 1 ? one_line(files.front().path) : counted(files.size(), "file");
  const std::vector<Entry> entries = entries_of(files, max_angle_deg);
  const auto unread = static_cast<std::size_t>(
      std::count_if(files.begin(), files.end(), [](const AssessedFile& f) { return !f.readable(); }));

  // Only the one script may run, whatever a file or a name contains.
  std::string page = "<!DOCTYPE html>\n<html lang=en class=both>\n<head>\n<meta charset=utf-8>\n" +
                     content_policy({validate_page_js_sha256}) +
                     "<meta name=viewport content=\"width=device-width, initial-scale=1\">\n<title>" +
                     escape(std::string(name_of(verdict)) + ": " + what) +
                     " – Darboux</title>\n<link rel=icon href=\"data:,\">\n<style>";
  page += page_style;
  page += style;
  page +=
      css_gradient() + "</style>\n</head>\n<body>\n<main>\n<h1>" + text(what) + ' ' + badge(verdict) +
      "</h1>\n<p>The normals and tangents stored in a mesh, compared with what they should be. Angles are in "
      "degrees; inside a mesh up to " +
      rounded(max_angle_deg, 4) +
      "° are allowed, three times that at seams, pole rings, creases and "
      "borders.</p>\n<noscript><p class=card>The mesh and its uvs are drawn by JavaScript, which is off. All "
      "else is here.</p></noscript>\n";
  if (entries.size() + unread > 1)
    page += controls(entries, unread) +
            "<div class=\"row head\"><span>verdict</span><span>mesh</span><span class=n>corners</span>"
            "<span class=n>largest error</span></div>\n";
  page += "<div class=meshes>\n";
  const std::size_t failed = static_cast<std::size_t>(std::count_if(
      entries.begin(), entries.end(), [](const Entry& e) { return e.verdict == Verdict::fail; }));
  bool unread_done = false;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    if (entries[k].verdict != Verdict::fail && !unread_done) page += unread_rows(files), unread_done = true;
    page += entry(entries[k], files.size() == 1, k < (failed > 0 ? failed : entries.size()) && k < most_open);
  }
  if (!unread_done) page += unread_rows(files);
  page += "</div>\n" + not_assessed(files);
  Json scale{{"colours", Json::array()}, {"not_compared", {not_compared.x, not_compared.y, not_compared.z}}};
  for (const Vec3<float>& c : viridis()) scale["colours"].push_back({c.x, c.y, c.z});
  page += "<p class=soft>Made by darboux validate " DARBOUX_VERSION
          ".</p>\n</main>\n<script type=\"application/json\" id=scale>" +
          script_json(scale) + "</script>\n<script>";
  page += validate_page_js;
  page += "</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace darboux
