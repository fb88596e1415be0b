#include "validate_page.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base64.h"
#include "report/colour_map.h"
#include "report/histogram.h"
#include "report/html.h"
#include "report/mesh_picture.h"

namespace darboux {

extern const std::string_view validate_page_js, validate_page_js_sha256;  // embedded by the build

namespace {

constexpr std::size_t most_triangles = 300000;  // in the pictures of a page
constexpr std::size_t most_open = 4;            // sections, before they are folded

constexpr std::string_view style = R"css(
[hidden]{display:none!important}
h2{margin-top:1.75rem}
h3{display:inline;font-size:1rem}
h4{font-size:.95rem;margin:1.25rem 0 .25rem}
summary{cursor:pointer}
summary .soft{margin-left:.5rem}
h1,h2,h3,p{overflow-wrap:anywhere}
details>p:first-of-type{margin-top:.75rem}
th[colspan]{text-align:center;border-bottom:1px solid var(--line)}
figcaption{margin-top:.4rem}
td.wrap{white-space:normal;min-width:16rem}
.warn{background:#fbf1cf;color:#5d4700}
.histogram{display:block;width:100%;max-width:48rem;font-size:12px}
.histogram text{fill:var(--soft)}
.histogram path{fill:none}
.grid{stroke:var(--faint)}
.axis{stroke:var(--soft)}
.limit{stroke:var(--ink);stroke-dasharray:5 4}
canvas{display:block;width:100%;border:1px solid var(--line);border-radius:.35rem;color:var(--soft)}
canvas.uv,canvas.view{aspect-ratio:1}
canvas.view{cursor:grab;touch-action:none}
canvas.view:active{cursor:grabbing}
.legend{display:flex;flex-wrap:wrap;align-items:center;gap:.25rem .5rem;margin:.75rem 0;font-size:.9rem;color:var(--soft)}
.legend i{display:inline-block;height:1rem;width:min(16rem,40%);border-radius:.2rem}
.legend i.none{width:1rem;margin-left:1rem}
@media (prefers-color-scheme:dark){.warn{background:#4b3c08;color:#f6e3a1}}
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

std::string plural(std::size_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

std::string css_gradient() {
  std::string stops;
  for (const Vec3<float>& colour : viridis()) stops += ',' + css_colour(colour);
  return ".legend i{background:linear-gradient(to right" + stops +
         ")}\n.legend i.none{background:" + css_colour(not_compared) + "}\n";
}

// ---- one judgement

struct Section {
  const JudgedPrimitive& judged;
  const Judgement& judgement;
  double limit;
  std::size_t step;  // every step-th triangle is drawn

  const MeshReport& report() const { return judgement.report; }
  const Mesh& mesh() const { return judged.primitive.data; }
  std::size_t triangles() const { return report().errors_deg.size() / 3; }
  std::string quantity() const { return mesh().tangents.empty() ? "normal" : "tangent"; }
  float worst() const {
    float result = std::numeric_limits<float>::quiet_NaN();
    for (const float e : report().errors_deg) result = std::fmax(result, e);
    return result;
  }
  std::string worst_text() const {
    return std::isnan(worst()) ? "nothing compared"
                               : "largest " + quantity() + " error " + rounded(worst(), 3) + "°";
  }
};

std::string reference_text(const Section& s) {
  const MeshReport& report = s.report();
  std::string words;
  if (s.judgement.fit && s.judgement.fit->fits)
    words = "The surface is " + text(s.judgement.fit->surface.surface.specification(6)) + "; the uvs are " +
            text(uv_convention(*s.judgement.fit)) + ". ";
  words += report.reference == "analytic" ? "Judged by that surface."
           : report.reference == "local"  ? "Judged by polynomials through the mesh's own positions and uvs."
           : report.reference == "mikktspace" ? "Judged by MikkTSpace's tangents of the mesh's own data."
                                              : "No reference decides: nothing to compare with is known.";
  if (report.reference == "analytic" || report.reference == "local")
    words += " It is uncertain by " +
             escape(deviation_text(report.normal_uncertainty_deg.rms(), 2, "° rms")) + " (normals) and " +
             escape(deviation_text(report.tangent_uncertainty_deg.rms(), 2, "° rms")) + " (tangents).";
  if (report.handedness.convention != "none")
    words += " The sign w follows the convention " + text(report.handedness.convention) + '.';
  if (report.mikktspace)
    words += " MikkTSpace's tangents are met to the bit at " +
             rounded(100 * report.mikktspace->equal_bits, 4) + " % of corners.";
  return "<p>" + words + "</p>\n";
}

std::string findings_table(const MeshReport& report) {
  if (report.findings.empty()) return "<p>Nothing was found.</p>\n";
  std::string rows;
  for (const Finding& f : report.findings)
    rows += "<tr class=finding><td>" + badge(f.severity) + "<th scope=row><code>" + text(f.code) +
            "</code><td class=n>" + std::to_string(f.count) + "<td class=wrap>" + text(f.message) +
            "<td class=wrap>" + text(f.to_do) + "</tr>\n";
  return "<div class=scroll><table class=findings>\n<thead><tr><th scope=col>severity<th scope=col>code"
         "<th scope=col class=n>corners<th scope=col>what<th scope=col>what to do</tr></thead>\n<tbody>" +
         rows + "</tbody></table></div>\n";
}

std::string class_table(const MeshReport& report) {
  std::string rows;
  for (const ClassReport& c : report.classes) {
    rows += "<tr class=vertex-class><th scope=row>" +
            text(vertex_class_names[static_cast<std::size_t>(c.vertex_class)]) + "<td class=n>" +
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
  return "<h4>Errors by class of vertices, in degrees</h4>\n<div class=scroll><table class=classes>\n"
         "<thead><tr><th rowspan=2 scope=col>class<th rowspan=2 scope=col class=n>corners"
         "<th colspan=3 scope=colgroup>normals<th colspan=3 scope=colgroup>tangents"
         "<th colspan=3 scope=colgroup>bitangents<th rowspan=2 scope=col class=n>worst<br>vertex</tr>\n<tr>" +
         head + "</tr></thead>\n<tbody>" + rows + "</tbody></table></div>\n";
}

std::string legend(const Section& s) {
  const std::string limit = rounded(s.limit, 4) + "°";
  return "<div class=legend role=img aria-label=\"Colours from 0 to " + limit +
         " of error, dark to light; grey: not compared\"><span>0°</span><i></i><span>" + limit +
         " and more</span><i class=none></i><span>not compared</span></div>\n";
}

std::string pictures(const Section& s) {
  if (s.triangles() == 0) return {};
  const Json data = mesh_picture(s.mesh(), {.triangles = s.judgement.triangles,
                                            .errors_deg = s.report().errors_deg,
                                            .limit_deg = s.limit,
                                            .step = s.step});
  std::string html =
      "<h4>Where they are</h4>\n" + legend(s) +
      "<div hidden class=pictures>\n<figure><canvas class=view tabindex=0 role=application "
      "aria-label=\"The mesh, coloured by " +
      s.quantity() +
      " error. Arrow keys turn it, plus and minus zoom, 0 starts again.\"></canvas>"
      "<p class=no-webgl hidden>The mesh is not shown: this browser has no WebGL 2.</p>"
      "<figcaption>The mesh, coloured by " +
      s.quantity() +
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
  if (s.step > 1)
    html += "<p class=soft>Of " + std::to_string(s.triangles()) + " triangles every " +
            std::to_string(s.step) +
            (s.step == 2   ? "nd"
             : s.step == 3 ? "rd"
                           : "th") +
            " is drawn. Tables and histogram are of all.</p>\n";
  return html + "<script type=\"application/json\">" + script_json(data) + "</script>\n";
}

std::string section(const Section& s, std::size_t number, bool open) {
  const MeshReport& report = s.report();
  std::string html = "<details class=card id=m" + std::to_string(number) + (open ? " open" : "") +
                     ">\n<summary>" + badge(report.verdict) + " <h3>" +
                     text(place_of(s.judged.primitive, s.judgement)) + "</h3><span class=soft>" +
                     plural(report.corners, "corner") + ", " + s.worst_text() + "</span></summary>\n";
  html += reference_text(s) + "<h4>Findings</h4>\n" + findings_table(report) + class_table(report);
  const std::string histogram = histogram_svg(report.errors_deg, s.limit, s.quantity() + " errors");
  if (!histogram.empty())
    html += "<h4>How many corners have which " + s.quantity() + " error</h4>\n<figure>" + histogram +
            "</figure>\n";
  return html + pictures(s) + "</details>\n";
}

// ---- the page

std::vector<Section> sections_of(const std::vector<JudgedFile>& files, double max_angle_deg) {
  std::vector<Section> sections;
  std::vector<std::size_t> triangles;
  for (const JudgedFile& file : files)
    for (const JudgedPrimitive& judged : file.primitives)
      for (const Judgement& judgement : judged.judgements)
        triangles.push_back(sections.emplace_back(Section{judged, judgement, max_angle_deg, 1}).triangles());
  const std::vector<std::size_t> steps = picture_steps(triangles, most_triangles);
  for (std::size_t k = 0; k < sections.size(); ++k) sections[k].step = steps[k];
  return sections;
}

std::string summary_table(const std::vector<JudgedFile>& files, const std::vector<Section>& sections) {
  std::string rows;
  std::size_t number = 0;
  for (const JudgedFile& file : files) {
    const std::size_t judged =
        std::accumulate(file.primitives.begin(), file.primitives.end(), std::size_t{0},
                        [](std::size_t sum, const JudgedPrimitive& p) { return sum + p.judgements.size(); });
    if (judged == 0)
      rows += "<tr><th scope=row>" + text(file.path) + "<td>–<td>" + badge(file.verdict) +
              "<td class=n>–<td class=n>–<td class=n>–</tr>\n";
    for (const std::size_t end = number + judged; number < end; ++number) {
      const Section& s = sections[number];
      const auto count = [&](Severity severity) {
        return std::to_string(std::count_if(s.report().findings.begin(), s.report().findings.end(),
                                            [&](const Finding& f) { return f.severity == severity; }));
      };
      rows += "<tr class=judgement><th scope=row>" + text(file.path) + "<td><a href=\"#m" +
              std::to_string(number) + "\">" + text(place_of(s.judged.primitive, s.judgement)) + "</a><td>" +
              badge(s.report().verdict) + "<td class=n>" + std::to_string(s.report().corners) +
              "<td class=n>" + (std::isnan(s.worst()) ? "–" : rounded(s.worst(), 3) + "°") + "<td class=n>" +
              count(Severity::error) + "<td class=n>" + count(Severity::warning) + "</tr>\n";
    }
  }
  return "<section class=card><div class=scroll><table class=summary>\n<thead><tr><th scope=col>file"
         "<th scope=col>mesh<th scope=col>verdict<th scope=col class=n>corners<th scope=col class=n>largest "
         "error"
         "<th scope=col class=n>errors<th scope=col class=n>warnings</tr></thead>\n<tbody>" +
         rows + "</tbody></table></div></section>\n";
}

// The digest that a policy names a script by.
std::string digest(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return "'sha256-" + base64(bytes) + "'";
}

}  // namespace

std::string validate_page(const std::vector<JudgedFile>& files, double max_angle_deg) {
  Verdict verdict = Verdict::nothing;
  for (const JudgedFile& file : files)
    verdict = std::max(verdict, file.error.empty() ? file.verdict : Verdict::fail);
  const std::string what = files.size() == 1 ? one_line(files.front().path) : plural(files.size(), "file");
  const std::vector<Section> sections = sections_of(files, max_angle_deg);

  // Nothing but the one script runs, whatever a file or a name holds.
  std::string page =
      "<!DOCTYPE html>\n<html lang=en class=both>\n<head>\n<meta charset=utf-8>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; script-src " +
      digest(validate_page_js_sha256) +
      "\">\n<meta name=viewport content=\"width=device-width, initial-scale=1\">\n<title>" +
      escape(std::string(verdict_names[static_cast<std::size_t>(verdict)]) + ": " + what) +
      " – Darboux</title>\n<link rel=icon href=\"data:,\">\n<style>";
  page += page_style;
  page += style;
  page +=
      css_gradient() + "</style>\n</head>\n<body>\n<main>\n<h1>" + text(what) + ' ' + badge(verdict) +
      "</h1>\n<p>The normals and tangents stored in a mesh, compared with what they should be. Angles are in "
      "degrees; inside a mesh up to " +
      rounded(max_angle_deg, 4) +
      "° are permitted, three times that at seams, pole rings, creases and "
      "borders.</p>\n<noscript><p class=card>The mesh and its uvs are drawn by JavaScript, which is off. All "
      "else is here.</p></noscript>\n";
  if (files.size() > 1 || sections.size() > 1) page += summary_table(files, sections);
  std::size_t number = 0;
  for (const JudgedFile& file : files) {
    if (files.size() > 1)
      page += "<h2>" + text(file.path) + ' ' + badge(file.error.empty() ? file.verdict : Verdict::fail) +
              "</h2>\n";
    if (!file.error.empty()) {
      page += "<p class=card>Not read: " + text(file.error) + "</p>\n";
      continue;
    }
    if (file.primitives.empty()) page += "<p class=card>There are no triangles to judge.</p>\n";
    for (const JudgedPrimitive& judged : file.primitives)
      for (std::size_t k = 0; k < judged.judgements.size(); ++k, ++number)
        page += section(sections[number], number, sections.size() <= most_open);
    for (const SkippedPrimitive& s : file.skipped)
      page += "<p class=soft>Not judged: mesh " + std::to_string(s.mesh) + " primitive " +
              std::to_string(s.primitive) + ": " + text(s.reason) + ".</p>\n";
  }
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
