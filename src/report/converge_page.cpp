#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/text.h"
#include "converge_report.h"
#include "html.h"
#include "report_page.h"

namespace darboux {

extern const std::string_view converge_page_js, converge_page_js_sha256;

namespace {

using Json = nlohmann::ordered_json;

// A picture needs only three digits, without trailing zeros; null if there is no number.
Json shown(double x, int digits = 3) {
  return std::isfinite(x) ? Json::parse(rounded(x, digits)) : Json(nullptr);
}

// Distinct names and their indices.
struct Names {
  std::vector<std::string> list;
  std::size_t place(std::string_view name) {
    const auto at = std::find(list.begin(), list.end(), name);
    if (at != list.end()) return static_cast<std::size_t>(at - list.begin());
    list.emplace_back(name);
    return list.size() - 1;
  }
};

// A study in the format that the script unpacks, in the order of its columns; `grid` has the widths of its
// surface and mesh.
Json study_row(const Study& s, std::size_t surface, std::size_t mesh, std::size_t method,
               const std::map<int, double>& grid) {
  Json at = Json::array(), rms = Json::array(), p95 = Json::array(), max = Json::array(),
       used = Json::array(), least = Json::array(), most = Json::array();
  for (const Level& l : s.levels) {
    at.push_back(std::distance(grid.begin(), grid.find(l.resolution)));
    rms.push_back(shown(l.rms_deg));
    p95.push_back(shown(l.p95_deg));
    max.push_back(shown(l.max_deg));
    used.push_back(l.used ? 1 : 0);
    const auto [low, high] = std::minmax_element(l.rms_of_mesh.begin(), l.rms_of_mesh.end());
    least.push_back(shown(*low));
    most.push_back(shown(*high));
  }
  const bool spread = s.levels.front().rms_of_mesh.size() > 1;
  return {surface,
          mesh,
          method,
          static_cast<std::size_t>(s.vertex_class),
          std::find(study_quantities.begin(), study_quantities.end(), s.quantity) - study_quantities.begin(),
          shown(s.order),
          shown(s.order_low),
          shown(s.order_high),
          s.expected_order,
          shown(s.max_order),
          static_cast<std::size_t>(s.verdict),
          s.holds() ? 1 : 0,
          shown(s.levels.back().floor_deg, 2),
          s.levels.size() == grid.size() ? Json(nullptr) : at,
          rms,
          p95,
          max,
          used,
          spread ? least : Json(nullptr),
          spread ? most : Json(nullptr)};
}

// The data that the page's script unpacks: names by index, widths once per surface and mesh, times once per
// surface, mesh and method.
Json page_data(const std::vector<Study>& studies) {
  Names surfaces, meshes, methods;
  for (const Study& s : studies) {
    surfaces.place(s.surface);
    meshes.place(s.mesh);
    methods.place(s.method);
  }
  // The levels that any study of a surface and mesh has.
  std::map<std::pair<std::size_t, std::size_t>, std::map<int, double>> widths;
  for (const Study& s : studies)
    for (const Level& l : s.levels)
      widths[{surfaces.place(s.surface), meshes.place(s.mesh)}][l.resolution] = l.h;
  Json grids = Json::array(), seconds = Json::array();
  for (std::size_t i = 0; i < surfaces.list.size(); ++i) {
    Json of_surface = Json::array(), times = Json::array();
    for (std::size_t k = 0; k < meshes.list.size(); ++k) {
      Json grid = Json::array();
      for (const auto& [n, h] : widths[{i, k}]) grid.push_back({n, shown(h, 6)});
      Json of_method = Json::array();
      for (std::size_t m = 0; m < methods.list.size(); ++m)
        of_method.push_back(std::vector<double>(grid.size(), 0.0));
      of_surface.push_back(std::move(grid));
      times.push_back(std::move(of_method));
    }
    grids.push_back(std::move(of_surface));
    seconds.push_back(std::move(times));
  }
  Json list = Json::array();
  for (const Study& s : studies) {
    const std::size_t surface = surfaces.place(s.surface), mesh = meshes.place(s.mesh),
                      method = methods.place(s.method);
    const auto& grid = widths[{surface, mesh}];
    for (const Level& l : s.levels)
      seconds[surface][mesh][method]
             [static_cast<std::size_t>(std::distance(grid.begin(), grid.find(l.resolution)))] =
                 shown(l.seconds);
    list.push_back(study_row(s, surface, mesh, method, grid));
  }
  Json of_meshes = Json::array(), of_methods = Json::array();
  for (const std::string& name : meshes.list) {
    const MeshFamily& family = find_mesh_family(name);
    of_meshes.push_back(
        {{"name", name}, {"summary", family.summary}, {"random", family.is_random() ? 1 : 0}});
  }
  for (const std::string& name : methods.list)
    of_methods.push_back({{"name", name}, {"summary", find_frame_method(name).summary}});
  return {{"surfaces", surfaces.list},
          {"meshes", of_meshes},
          {"methods", of_methods},
          {"classes", vertex_class_names},
          {"quantities", study_quantities},
          {"verdicts", order_verdict_names},
          {"least_order", least_order},
          {"grids", grids},
          {"seconds", seconds},
          {"studies", list}};
}

constexpr std::string_view sections = R"html(
<section class=card id=interactive hidden>
<h2 id=what>Pictures</h2>
<p class=soft id=about-mesh></p>
<div class=controls>
<label>Surface <select id=surface></select></label>
<label>Mesh <select id=mesh></select></label>
<label>Vertices <select id=class></select></label>
<label>Quantity <select id=quantity></select></label>
<label>Error <select id=statistic><option value=rms>root mean square<option value=p95>95 % are below
<option value=max>largest</select></label>
</div>
<fieldset class=legend id=legend aria-label="Methods that are drawn"></fieldset>
<div class=pictures>
)html";

constexpr std::string_view tables = R"html(</div>
<p class=soft id=at-floor aria-live=polite></p>
<h2 id=map-of>Orders</h2>
<p class=soft>By method, mesh and class of vertices. The stronger the colour, the higher the order; exact: the
error is nothing but rounding; ×: does not converge; red: below what is expected.
A click shows the curve.</p>
<div class=scroll><table class=map id=map></table></div>
</section>
<section class=card>
<h2>All studies</h2>
<p class=soft>The order is the slope of the logarithm of the root mean square error over that of the mesh
width, over the widths where that line does not bend, with its 95&nbsp;% confidence interval: the spread of
random meshes is in it, and what is left of the bend. The error is that of the finest mesh. The floor is what
rounding alone may cause there; a study that reaches it has no order. Angles in degrees. A click on a head
sorts, one on a verdict shows the curve.</p>
<div class=controls>
<label class=needs-script hidden>Find <input type=search id=find placeholder="cubic seam slower"></label>
<label class=needs-script hidden><span>Only what the pictures show</span>
<input type=checkbox id=only checked></label>
</div>
<div class=scroll><table id=studies></table></div>
</section>
)html";

}  // namespace

std::string converge_page(const std::vector<Study>& studies, const Provenance& p) {
  ReportPage page;
  page.title = "Darboux: convergence of mesh frames";
  page.question = "How wrong are the tangents of a mesh, and how fast do they get better?";
  page.lead =
      "A normal map needs a tangent and a bitangent at every vertex: the directions in which its texture "
      "runs "
      "over the surface. Software computes them from triangles, each in its own way. Here triangles are laid "
      "on surfaces whose true directions are known exactly, finer and finer, and every method’s result is "
      "compared with the truth. The error is an angle. <b>Order 1</b> means that half the mesh width halves "
      "the error, <b>order 2</b> that it quarters it.";
  page.answer = verdict_summary(studies) + ".";
  page.body =
      std::string(sections) +
      picture_html("against-h",
                   "Error against mesh width. Parallel to a dashed line beside the data means that order. "
                   "Hollow points are not part of the fit.") +
      picture_html("against-time",
                   "Error against run time. Further left is faster, further down is more accurate.") +
      std::string(tables) + "<noscript><section class=card><pre class=scroll>" +
      escape(orders_text(studies)) + "</pre></section></noscript>\n";
  page.data = page_data(studies);
  page.script = converge_page_js;
  page.script_sha256 = converge_page_js_sha256;
  return report_page(page, p);
}

}  // namespace darboux
