#include "convergence_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include <darboux/frame.h>
#include <darboux/sample_mesh.h>

#include "base/text.h"
#include "colour_map.h"
#include "svg.h"
#include "view.h"

namespace darboux {
namespace {

constexpr double width = 1000, height = 420;
constexpr std::array<const char*, 8> line_colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                  "#56b4e9", "#e69f00", "#000000", "#7f7f7f"};

// ---- the mesh
// -------------------------------------------------------------------------------------------------

struct ColouredMesh {
  Mesh mesh;
  std::vector<double> error_deg;  // of each triangle; NaN where nothing is compared
  double largest = 0;
};

ColouredMesh coloured_mesh(const ConvergeOptions& options, int rows) {
  const MeshFamily& family = *options.families.front();
  ColouredMesh result;
  result.mesh = sample_mesh(options.surfaces.front(),
                            mesh_options(family, rows, options.seed, options.v_first, options.v_last));
  const MeshFrames frames = mesh_frames(result.mesh, *options.methods.front());
  for (std::size_t t = 0; t < result.mesh.triangles.size(); ++t) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec4<double>& truth = result.mesh.tangents[result.mesh.triangles[t][k]];
      const CornerFrame& corner = frames.corner(3 * t + k);
      sum += corner.fallback ? std::numeric_limits<double>::quiet_NaN()
                             : angle_between(corner.t, {truth.x, truth.y, truth.z}) * 180 / std::numbers::pi;
    }
    result.error_deg.push_back(sum / 3);
    if (std::isfinite(sum)) result.largest = std::max(result.largest, sum / 3);
  }
  return result;
}

std::string mesh_panel(const ColouredMesh& coloured, const std::string& title, const std::string& subtitle) {
  constexpr double left = 20, top = 70, panel_width = 400, panel_height = 270;
  const Mesh& mesh = coloured.mesh;
  constexpr double inf = std::numeric_limits<double>::infinity();
  double x_low = inf, x_high = -inf, y_low = inf, y_high = -inf;
  for (const Vec3<double>& p : mesh.positions) {
    x_low = std::min(x_low, dot(p, to_right)), x_high = std::max(x_high, dot(p, to_right));
    y_low = std::min(y_low, dot(p, upward)), y_high = std::max(y_high, dot(p, upward));
  }
  const double scale = std::min(panel_width / std::max(x_high - x_low, 1e-300),
                                panel_height / std::max(y_high - y_low, 1e-300));
  const Projection view{scale, left + panel_width / 2 - scale * (x_low + x_high) / 2,
                        top + panel_height / 2 + scale * (y_low + y_high) / 2};
  struct Drawn {
    std::size_t triangle;
    double depth;  // the nearer the larger
  };
  std::vector<Drawn> order;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    double depth = 0;
    for (const std::uint32_t v : mesh.triangles[t]) depth += view(mesh.positions[v]).z;
    order.push_back({t, std::round(10 * depth)});  // so that rounding does not decide what is in front
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Drawn& a, const Drawn& b) { return a.depth < b.depth; });
  std::string out = svg::label(20, 30, title, "class=\"t\"") + svg::label(20, 50, subtitle);
  for (const Drawn& drawn : order) {
    const Triangle& triangle = mesh.triangles[drawn.triangle];
    const std::string colour =
        css_colour(colour_of(static_cast<float>(coloured.error_deg[drawn.triangle]), coloured.largest));
    out += "<path fill=\"" + colour + "\" d=\"M";
    for (std::size_t k = 0; k < 3; ++k) {
      const PicturePoint p = view(mesh.positions[triangle[k]]);
      out += (k > 0 ? "L" : "") + svg::tenths(p.x) + ' ' + svg::tenths(p.y);
    }
    out += "z\"/>\n";
  }
  // The scale.
  constexpr int steps = 32;
  constexpr double bar = 260, y = 372;
  for (int k = 0; k < steps; ++k)
    out += "<path stroke=\"none\" fill=\"" +
           css_colour(colour_of(static_cast<float>((k + 0.5) / steps * coloured.largest), coloured.largest)) +
           "\" d=\"M" + svg::tenths(90 + bar * k / steps) + ' ' + svg::tenths(y) + 'h' +
           svg::tenths(bar / steps + 0.5) + "v12h-" + svg::tenths(bar / steps + 0.5) + "z\"/>\n";
  return out + svg::label(90, y + 30, "0°", "text-anchor=\"middle\"") +
         svg::label(90 + bar, y + 30, rounded(coloured.largest, 2) + "°", "text-anchor=\"middle\"") +
         svg::label(90 + bar / 2, y + 30, "error of the tangent", "text-anchor=\"middle\"");
}

// ---- the plot
// -------------------------------------------------------------------------------------------------

class Plot {
 public:
  explicit Plot(std::vector<const Study*> studies) : studies_(std::move(studies)) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const Study* study : studies_)
      for (const Level& level : study->levels) {
        h_low_ = std::min(h_low_, level.h), h_high_ = std::max(h_high_, level.h);
        if (!(level.rms_deg > 0)) continue;
        least = std::min(least, level.rms_deg), most = std::max(most, level.rms_deg);
      }
    first_decade_ = static_cast<int>(std::floor(std::log10(least)));
    last_decade_ = static_cast<int>(std::ceil(std::log10(most)));
  }

  std::string svg() const {
    std::string out = svg::label(480, 30, "How fast the error falls", "class=\"t\"") +
                      svg::label(480, 50, "rms error of the tangent at interior corners, degrees");
    for (int d = first_decade_; d <= last_decade_; ++d)
      out += svg::line(left, y(std::pow(10.0, d)), right, y(std::pow(10.0, d)), "class=\"g\"") +
             svg::label(left - 6, y(std::pow(10.0, d)) + 4, svg::decade(d), "text-anchor=\"end\"");
    for (const Level& level : studies_.front()->levels)
      out += svg::line(x(level.h), top, x(level.h), bottom, "class=\"g\"") +
             svg::label(x(level.h), bottom + 18, std::to_string(level.resolution), "text-anchor=\"middle\"");
    out += svg::label((left + right) / 2, bottom + 38, "mesh width h of so many rows, finer to the left",
                      "text-anchor=\"middle\"");
    for (const int slope : {1, 2}) out += slope_line(slope);
    std::vector<std::pair<double, std::size_t>> ends;  // where each line's name would stand
    for (std::size_t k = 0; k < studies_.size(); ++k) {
      std::string path;
      for (const Level& level : studies_[k]->levels)
        if (level.rms_deg > 0)
          path += (path.empty() ? "M" : "L") + svg::tenths(x(level.h)) + ' ' + svg::tenths(y(level.rms_deg));
      out += "<path class=\"l\" stroke=\"" + std::string(line_colours[k % line_colours.size()]) +
             (k < line_colours.size() ? "\"" : "\" stroke-dasharray=\"7 3\"") + " d=\"" + path + "\"/>\n";
      ends.emplace_back(y(studies_[k]->levels.front().rms_deg), k);
    }
    std::sort(ends.begin(), ends.end());
    double last = -100;
    for (const auto& [at, k] : ends) {
      last = std::max(at, last + 16);
      out += svg::label(right + 8, last + 4, std::string(studies_[k]->method) + order_text(*studies_[k]),
                        "fill=\"" + std::string(line_colours[k % line_colours.size()]) + "\"");
    }
    return out;
  }

 private:
  static constexpr double left = 535, right = 820, top = 70, bottom = 360;

  static std::string order_text(const Study& study) {
    return std::isfinite(study.order) ? ", h^" + svg::tenths(study.order) : std::string();
  }
  double x(double h) const {
    return h_high_ == h_low_ ? left
                             : left + (right - left) * std::log(h / h_low_) / std::log(h_high_ / h_low_);
  }
  double y(double error) const {
    return bottom -
           (bottom - top) * (std::log10(error) - first_decade_) / std::max(1, last_decade_ - first_decade_);
  }
  // From the upper right corner of the plot, as far as it goes.
  std::string slope_line(int slope) const {
    const double from = std::pow(10.0, last_decade_ - 0.15);
    const double lowest = std::pow(10.0, first_decade_);
    const double h = std::max(h_low_, h_high_ * std::pow(lowest / from, 1.0 / slope));
    const double error = from * std::pow(h / h_high_, slope);
    return svg::line(x(h_high_), y(from), x(h), y(error), "class=\"s\"") +
           svg::label(x(h) + 4, y(error) - 6, slope == 1 ? "h" : "h²", "class=\"i\"");
  }

  std::vector<const Study*> studies_;
  double h_low_ = std::numeric_limits<double>::infinity(), h_high_ = 0;
  int first_decade_ = 0, last_decade_ = 0;
};

}  // namespace

std::string convergence_picture(const ConvergeOptions& options, const std::vector<Study>& studies) {
  constexpr int shown_rows = 16;
  std::vector<const Study*> drawn;
  for (const Study& s : studies)
    if (s.surface == studies.front().surface && s.mesh == studies.front().mesh && s.quantity == "tangent" &&
        s.vertex_class == VertexClass::interior)
      drawn.push_back(&s);
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + svg::tenths(width) +
                    "\" height=\"" + svg::tenths(height) + "\" viewBox=\"0 0 " + svg::tenths(width) + ' ' +
                    svg::tenths(height) +
                    "\" font-family=\"sans-serif\" font-size=\"13\" fill=\"#1b2a3a\">\n"
                    "<title>Tangent error on a mesh, and its convergence</title>\n"
                    "<style>.t{font-size:17px;font-weight:bold}.g{stroke:#d5dbe2;fill:none}"
                    ".s{stroke:#7f8b99;stroke-dasharray:5 4;fill:none}.i{font-style:italic;fill:#5a6675}"
                    ".l{stroke-width:2.2;fill:none}.m path{stroke:#fff;stroke-width:.25}</style>\n"
                    "<path fill=\"#fff\" d=\"M0 0h1000v420h-1000z\"/>\n<g class=\"m\">\n";
  out += mesh_panel(coloured_mesh(options, shown_rows),
                    "Tangent error: " + std::string(options.surfaces.front().info().name),
                    std::string(options.methods.front()->name) + " against the exact tangents, " +
                        std::to_string(2 * shown_rows) + " × " + std::to_string(shown_rows) + " cells, " +
                        std::string(options.families.front()->name));
  out += "</g>\n";
  if (!drawn.empty()) out += Plot(std::move(drawn)).svg();
  return out + "</svg>\n";
}

}  // namespace darboux
