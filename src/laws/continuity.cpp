// Positions and first partials do not jump, along lines of constant u and of constant v.
#include <algorithm>
#include <utility>

#include "law.h"

namespace darboux::laws {
namespace {

constexpr std::size_t most_lines = 32;  // of constant u, and of constant v
constexpr int intervals = 256;          // of a line, from its first middle to its last

struct End {
  double x;
  Jet2<double> j;
};

// What the trapezoidal rule leaves of the change of partial `of`, whose derivative is partial `is`: of a
// smooth one an eighth remains when the interval is halved, of a jump all.
double jump(const Derivative& d, const End& a, const End& b) {
  const Vec3<double> change = partial(b.j, d.of) - partial(a.j, d.of);
  return norm(change - (b.x - a.x) / 2 * (partial(a.j, d.is) + partial(b.j, d.is)));
}

}  // namespace

void check_continuity(const AnySurface& surface, const Points& points, Checks& checks) {
  std::vector<Law> laws;
  for (int of = 0; of < 3; ++of) laws.emplace_back(points.name, "continuity", names[of]);
  const std::size_t lines = std::min(points.list.size(), most_lines);
  for (std::size_t line = 0; line < lines; ++line)
    for (const int along : {0, 1}) {
      const Point& p = points.list[line];
      const auto uv = [&](double x) { return along == 0 ? Vec2<double>{x, p.v} : Vec2<double>{p.u, x}; };
      const auto end = [&](double x) { return End{x, surface.jet(uv(x).x, uv(x).y)}; };
      std::vector<End> ends;
      for (int i = 0; i < intervals; ++i) ends.push_back(end((i + 0.5) / intervals));
      for (const Derivative& d : derivatives) {
        if (d.along != along) continue;
        // Written so that a NaN is the worst.
        const auto less = [&](double x, double y) { return !(y <= x) && !std::isnan(x); };
        std::size_t worst = 0;
        for (std::size_t i = 1; i + 1 < ends.size(); ++i)
          if (less(jump(d, ends[worst], ends[worst + 1]), jump(d, ends[i], ends[i + 1]))) worst = i;
        End a = ends[worst], b = ends[worst + 1];
        const double scale = points.scale[static_cast<std::size_t>(d.of)];
        for (double middle; middle = a.x + (b.x - a.x) / 2, middle != a.x && middle != b.x;) {
          const End m = end(middle);
          (less(jump(d, m, b), jump(d, a, m)) ? b : a) = m;
        }
        const auto known = [&](const End& e) {  // as where a spline has a crease
          return surface.frame(uv(e.x).x, uv(e.x).y).status != Status::regular;
        };
        const double error = jump(d, a, b) / scale;
        if (!(error <= worst_estimate) && (known(a) || known(b))) continue;
        laws[static_cast<std::size_t>(d.of)].compare(error, worst_estimate, uv(b.x).x, uv(b.x).y);
      }
    }
  for (const Law& law : laws) checks.push_back(law.result("the surface says of each jump that it has one"));
}

}  // namespace darboux::laws
