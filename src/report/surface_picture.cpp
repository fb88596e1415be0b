#include "surface_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include "view.h"

namespace darboux {
namespace {

using Point = PicturePoint;  // x and y in tenths of a pixel

constexpr double picture_width = 4000, picture_height = 3000, margin = 420, arrow_length = 430,
                 head_length = 75;

// The direction to the light: above the viewer's left shoulder.
const Vec3<double> to_light = unit(-0.35 * to_right + 0.65 * upward + 0.7 * to_viewer);

constexpr int shades = 20;

struct Cell {
  int i, j;
  std::array<Point, 4> corners;  // (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
  double depth;                  // of the corners together, the nearer the larger
};

bool finite(const Vec3<double>& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

bool inside(const std::array<Point, 4>& corners, const Point& p) {
  bool result = false;
  for (std::size_t k = 0; k < 4; ++k) {
    const Point &a = corners[k], &b = corners[(k + 1) % 4];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) result = !result;
  }
  return result;
}

std::string text(double x) {
  return std::to_string(std::lround(x));
}

// "12 -3" with only the necessary spaces.
void append(std::string& path, std::string_view number) {
  const char last = path.back();
  if (number[0] != '-' && last >= '0' && last <= '9') path += ' ';
  path += number;
}

// A path through these points; relative after the first, to save bytes.
std::string path(const std::vector<Point>& points, bool closed) {
  std::string result = "M";
  long x = 0, y = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const long px = std::lround(points[k].x), py = std::lround(points[k].y);
    if (k == 1) result += 'l';
    append(result, std::to_string(px - x));
    append(result, std::to_string(py - y));
    x = px, y = py;
  }
  return closed ? result + 'z' : result;
}

class Drawing {
 public:
  explicit Drawing(const AnySurface& surface) : surface_(surface) {
    const SurfaceInfo& info = surface.info();
    if (info.u == Coordinate::linear && info.v == Coordinate::linear) columns_ = rows_ = 32;
    place();
    make_cells();
  }

  std::string svg() {
    out_ =
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"400\" height=\"300\" viewBox=\"0 0 4000 "
        "3000\">\n<title>" +
        std::string(surface_.info().name) +
        "</title>\n<style>path{fill:none;stroke-linejoin:round;stroke-linecap:round}"
        ".l,.k{stroke:#1b2a3a;stroke-width:4;stroke-opacity:.55}.k{stroke-width:13;stroke-opacity:1}"
        ".h{stroke:#fff;stroke-width:44;stroke-opacity:.85}.a{stroke-width:20}"
        "text{font:italic 110px serif}";
    for (int k = 0; k < shades; ++k)
      out_ += rule('f', k, {0x2c, 0x4a, 0x70}, {0xd6, 0xe8, 0xfa}) +
              rule('b', k, {0x80, 0x40, 0x12}, {0xff, 0xe0, 0xb8});
    out_ += "</style>\n<path style=\"fill:#fff\" d=\"M0 0h4000v3000h-4000z\"/>";
    for (const Cell& cell : cells_) draw(cell);
    end_path();
    axes();
    for (const auto& [u, v] : frame_points()) draw_frame(u, v);
    return std::move(out_) + "\n</svg>\n";
  }

 private:
  static constexpr int spacing = 4;  // cells between lines

  Vec3<double> position(int i, int j) const {
    return surface_.jet(static_cast<double>(i) / columns_, static_cast<double>(j) / rows_).position;
  }

  // Fits the surface into the picture.
  void place() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    double left = inf, right = -inf, bottom = inf, top = -inf;
    for (int j = 0; j <= rows_; ++j)
      for (int i = 0; i <= columns_; ++i) {
        const Vec3<double> p = position(i, j);
        if (!finite(p)) continue;
        left = std::min(left, dot(p, to_right)), right = std::max(right, dot(p, to_right));
        bottom = std::min(bottom, dot(p, upward)), top = std::max(top, dot(p, upward));
      }
    if (!(left <= right)) return;
    view_.scale = std::min((picture_width - 2 * margin) / std::max(right - left, 1e-300),
                           (picture_height - 2 * margin) / std::max(top - bottom, 1e-300));
    view_.x = picture_width / 2 - view_.scale * (left + right) / 2;
    view_.y = picture_height / 2 + view_.scale * (bottom + top) / 2;
  }

  void make_cells() {
    for (int j = 0; j < rows_; ++j)
      for (int i = 0; i < columns_; ++i) {
        Cell cell{i,
                  j,
                  {view_(position(i, j)), view_(position(i + 1, j)), view_(position(i + 1, j + 1)),
                   view_(position(i, j + 1))},
                  0};
        if (!std::all_of(cell.corners.begin(), cell.corners.end(), finite)) continue;
        // Rounded to tenths, so that rounding does not decide what is in front.
        for (const Point& p : cell.corners) cell.depth += std::round(p.z);
        cells_.push_back(cell);
      }
    std::stable_sort(cells_.begin(), cells_.end(),
                     [](const Cell& a, const Cell& b) { return a.depth < b.depth; });
  }

  // The unit normal in the middle of a cell: the surface's or, if it has none, the cell's own.
  Vec3<double> normal(const Cell& cell) const {
    const Vec3<double> n = surface_.frame((cell.i + 0.5) / columns_, (cell.j + 0.5) / rows_).n;
    if (finite(n)) return n;
    return unit(cross(position(cell.i + 1, cell.j + 1) - position(cell.i, cell.j),
                      position(cell.i, cell.j + 1) - position(cell.i + 1, cell.j)));
  }

  void draw(const Cell& cell) {
    const Vec3<double> n = normal(cell);
    const double side = dot(n, to_viewer) < 0 ? -1 : 1;
    const SurfaceInfo& info = surface_.info();
    if (side < 0 && info.orientable && info.euler_characteristic && !info.own_orientation) return;  // hidden
    const double brightness = 0.3 + 0.7 * std::max(0.0, side * dot(n, to_light));
    const int shade = std::clamp(static_cast<int>(std::lround(brightness * (shades - 1))), 0, shades - 1);
    const auto& c = cell.corners;
    add((side < 0 ? "b" : "f") + std::to_string(shade), path({c.begin(), c.end()}, true));
    const auto line = [&](int k, int last, const Point& a, const Point& b) {
      if (k % spacing != 0 || (std::lround(a.x) == std::lround(b.x) && std::lround(a.y) == std::lround(b.y)))
        return;
      add(k == 0 || k == last ? "k" : "l", path({a, b}, false));
    };
    line(cell.j, rows_, c[0], c[1]);
    line(cell.i + 1, columns_, c[1], c[2]);
    line(cell.j + 1, rows_, c[2], c[3]);
    line(cell.i, columns_, c[3], c[0]);
  }

  // Consecutive paths of one kind are merged.
  void add(const std::string& kind, const std::string& d) {
    if (kind != kind_) {
      end_path();
      out_ += "\n<path class=\"" + kind + "\" d=\"";
      kind_ = kind;
    }
    out_ += d;
  }
  void end_path() {
    if (!kind_.empty()) out_ += "\"/>";
    kind_.clear();
  }

  static std::string rule(char side, int k, const std::array<int, 3>& dark, const std::array<int, 3>& light) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string colour = "#";
    for (std::size_t c = 0; c < 3; ++c) {
      const int value = dark[c] + (light[c] - dark[c]) * k / (shades - 1);
      colour += {digits[static_cast<std::size_t>(value / 16)], digits[static_cast<std::size_t>(value % 16)]};
    }
    return "." + std::string(1, side) + std::to_string(k) + "{fill:" + colour + ";stroke:" + colour +
           ";stroke-width:5}";
  }

  // Up to three visible crossings of lines, far apart; with n towards the viewer if there are such.
  std::vector<Vec2<double>> frame_points() const {
    struct Candidate {
      Vec2<double> uv;
      Point at;
      long cost;  // of showing it, in millionths
    };
    std::vector<Candidate> candidates;
    const SurfaceInfo& info = surface_.info();
    const auto near_end = [](Coordinate kind, double x) {
      return (kind == Coordinate::linear || kind == Coordinate::half_turn) && (x < 0.15 || x > 0.85);
    };
    for (int j = spacing; j < rows_; j += spacing)
      for (int i = spacing; i < columns_; i += spacing) {
        const double u = static_cast<double>(i) / columns_, v = static_cast<double>(j) / rows_;
        const Sample<double> s = surface_.sample(u, v);
        if (near_end(info.u, u) || near_end(info.v, v) || s.frame.status != Status::regular) continue;
        const Point at = view_(s.jet.position);
        const double facing = dot(s.frame.n, to_viewer);
        if (std::fabs(facing) < 0.2 || !fits(at, s.frame) || hidden(at)) continue;
        // Blue before orange, arrows apart from each other, n neither towards the viewer nor across.
        const double cost =
            (facing < 0 ? 10 : 0) + (legible(s.frame) ? 0 : 3) + std::fabs(std::fabs(facing) - 0.55);
        candidates.push_back({{u, v}, at, std::lround(1e6 * cost)});
      }
    std::vector<Candidate> chosen;
    while (chosen.size() < 3 && !candidates.empty()) {
      const auto far = [&](const Candidate& c) {
        double least = std::numeric_limits<double>::infinity();
        for (const Candidate& other : chosen)
          least = std::min(least, std::hypot(c.at.x - other.at.x, c.at.y - other.at.y));
        return least;
      };
      const auto better = [&](const Candidate& a, const Candidate& b) {
        if (chosen.empty()) return a.cost < b.cost;
        const bool far_a = far(a) > 900, far_b = far(b) > 900;
        if (far_a != far_b) return far_a;
        if (far_a) return a.cost < b.cost;
        return std::lround(far(a)) > std::lround(far(b));
      };
      const auto best = std::min_element(candidates.begin(), candidates.end(), better);
      if (!chosen.empty() && far(*best) < 400) break;
      chosen.push_back(*best);
      candidates.erase(best);
    }
    std::vector<Vec2<double>> result;
    for (const Candidate& c : chosen) result.push_back(c.uv);
    return result;
  }

  // Whether the arrows with their names stay within the picture.
  static bool fits(const Point& base, const Frame<double>& f) {
    const std::array axes{f.t, f.b, f.n};
    return std::all_of(axes.begin(), axes.end(), [&](const Vec3<double>& a) {
      const double x = base.x + 1.2 * arrow_length * dot(a, to_right);
      const double y = base.y - 1.2 * arrow_length * dot(a, upward);
      return x > 60 && x < picture_width - 60 && y > 60 && y < picture_height - 60;
    });
  }

  // Whether all arrows are seen from the side and none overlaps another.
  static bool legible(const Frame<double>& f) {
    std::array<Vec2<double>, 3> seen;
    const std::array axes{f.t, f.b, f.n};
    for (std::size_t k = 0; k < 3; ++k) seen[k] = {dot(axes[k], to_right), dot(axes[k], upward)};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2<double>&a = seen[k], &b = seen[(k + 1) % 3];
      const double sine = a.x * b.y - a.y * b.x, cosine = a.x * b.x + a.y * b.y;
      if (std::hypot(a.x, a.y) < 0.35 || (cosine > 0 && std::fabs(sine) < 0.35 * cosine)) return false;
    }
    return true;
  }

  bool hidden(const Point& p) const {
    return std::any_of(cells_.begin(), cells_.end(), [&](const Cell& cell) {
      return cell.depth / 4 > p.z + 150 && inside(cell.corners, p);
    });
  }

  void draw_frame(double u, double v) {
    const Frame<double> f = surface_.frame(u, v);
    const Point base = view_(surface_.jet(u, v).position);
    struct Axis {
      std::string_view name, colour;
      Vec3<double> direction;
      bool normal;
    };
    std::array<Axis, 3> axes{
        {{"t", "#c81414", f.t, false}, {"b", "#0a7a14", f.b, false}, {"n", "#1414d2", f.n, true}}};
    std::stable_sort(axes.begin(), axes.end(), [](const Axis& a, const Axis& b) {
      return std::lround(1e6 * dot(a.direction, to_viewer)) < std::lround(1e6 * dot(b.direction, to_viewer));
    });
    for (const Axis& a : axes) {
      const double x = dot(a.direction, to_right), y = -dot(a.direction, upward);
      const bool behind = a.normal && dot(f.n, to_viewer) < 0;
      if (behind) out_ += "\n<g opacity=\".5\">";
      arrow(base, x, y, arrow_length, a.colour, a.name);
      if (behind) out_ += "</g>";
    }
  }

  void arrow(const Point& from, double x, double y, double length, std::string_view colour,
             std::string_view name) {
    const Point to{from.x + length * x, from.y + length * y, 0};
    const double size = std::hypot(x, y), head = std::min(head_length, 0.6 * length * size);
    const double ex = size > 0 ? x / size : 0, ey = size > 0 ? y / size : 0;
    const Point neck{to.x - head * ex, to.y - head * ey, 0};
    const std::vector<Point> tip{{to.x, to.y, 0},
                                 {neck.x - 0.45 * head * ey, neck.y + 0.45 * head * ex, 0},
                                 {neck.x + 0.45 * head * ey, neck.y - 0.45 * head * ex, 0}};
    const std::string shaft = path({from, neck}, false), triangle = path(tip, true);
    out_ += "\n<path class=\"h\" d=\"" + shaft + triangle + "\"/><g style=\"stroke:" + std::string(colour) +
            ";fill:" + std::string(colour) + "\"><path class=\"a\" d=\"" + shaft +
            "\"/><path style=\"fill:inherit\" d=\"" + triangle + "\"/></g>";
    const std::string place =
        "x=\"" + text(to.x + 75 * ex - 25) + "\" y=\"" + text(to.y + 75 * ey + 30) + "\"";
    out_ += "<text " + place + " style=\"fill:" + std::string(colour) +
            ";stroke:#fff;stroke-width:36;paint-order:stroke;stroke-opacity:.85;stroke-linejoin:round\">" +
            std::string(name) + "</text>";
  }

  // The directions of x, y, z in the lower left corner.
  void axes() {
    const Point origin{330, 2700, 0};
    const auto axis = [&](const Vec3<double>& e, std::string_view name) {
      arrow(origin, dot(e, to_right), -dot(e, upward), 230, "#555", name);
    };
    axis({0, 1, 0}, "y");
    axis({0, 0, 1}, "z");
    axis({1, 0, 0}, "x");
  }

  const AnySurface& surface_;
  int columns_ = 48, rows_ = 24;
  Projection view_;
  std::vector<Cell> cells_;
  std::string out_, kind_;
};

}  // namespace

std::string surface_picture(const AnySurface& surface) {
  return Drawing(surface).svg();
}

}  // namespace darboux
