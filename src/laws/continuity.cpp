// Positions and first partials do not jump, along lines of constant u and of constant v.
#include <algorithm>

#include "base/bounds.h"
#include "law.h"

namespace darboux::laws {
namespace {

constexpr std::size_t most_lines = 32;  // of constant u, and of constant v
constexpr int intervals = 256;          // of a line, between its middles; and one to each end
constexpr double inset = 0x1p-20;       // of the ends, which may be poles

// Where a partial may jump, as at a spline's crease or a chart's pole.
constexpr Status known_jumps = Status::crease | Status::dpdu_zero | Status::dpdv_zero | Status::parallel |
                               Status::limit_frame | Status::no_frame;

struct End {
  double x;
  Jet2<double> j;
};

double change(const Derivative& d, const End& a, const End& b) {
  return norm(partial(b.j, d.of) - partial(a.j, d.of));
}

// The error of the trapezoidal rule for the change of partial `of`, whose derivative is partial `is`: when
// the interval is halved, an eighth remains of a smooth one, and all of a jump.
double remainder(const Derivative& d, const End& a, const End& b) {
  const Vec3<double> all = partial(b.j, d.of) - partial(a.j, d.of);
  return norm(all - (b.x - a.x) / 2 * (partial(a.j, d.is) + partial(b.j, d.is)));
}

// The remainder of the change between neighbours; all of it if a derivative is infinite. Above `bound` it is
// reduced by the decrease of the change over ten halvings: this leaves nothing of |x|^a with a >= 0.1, whose
// neighbours may differ by much, and all of a jump.
double jump_of(const std::vector<double>& changes, double remainder, double bound) {
  constexpr std::size_t halvings = 10;
  const double last = changes.back(), left = remainder <= last ? remainder : last;
  if (!(left > bound) || changes.size() <= halvings) return left;
  const double before = changes[changes.size() - 1 - halvings];
  return before > last && before < infinity ? std::fmax(left - (before - last), 0) : left;
}

// NaN counts as the largest.
bool less(double x, double y) {
  return !(y <= x) && !std::isnan(x);
}

double extent_of(const Points& points) {
  const Vec3<double>& first = points.list.front().j.position;
  Bounds box{first, first};
  for (const Point& p : points.list) box.add(p.j.position);
  return box.diagonal();
}

}  // namespace

void check_continuity(const AnySurface& surface, const Points& points, Checks& checks) {
  std::vector<Law> laws;
  for (int of = 0; of < 3; ++of) laws.emplace_back(points.name, "continuity", names[of]);
  const std::size_t lines = std::min(points.list.size(), most_lines);
  const double extent = lines > 0 ? extent_of(points) : 0;
  for (std::size_t line = 0; line < lines; ++line)
    for (const int along : {0, 1}) {
      const Point& p = points.list[line];
      const auto uv = [&](double x) { return along == 0 ? Vec2<double>{x, p.v} : Vec2<double>{p.u, x}; };
      const auto end = [&](double x) { return End{x, surface.jet(uv(x).x, uv(x).y)}; };
      const auto is_known = [&](const End& e) {
        return has(surface.frame(uv(e.x).x, uv(e.x).y).status, known_jumps);
      };
      std::vector<End> ends{end(inset)};
      for (int i = 0; i < intervals; ++i) ends.push_back(end((i + 0.5) / intervals));
      ends.push_back(end(1 - inset));
      for (const Derivative& d : derivatives) {
        if (d.along != along) continue;
        const auto of = static_cast<std::size_t>(d.of);
        double largest = points.scale[of];
        for (const End& e : ends)
          if (const double size = norm(partial(e.j, d.of)); size < infinity)
            largest = std::fmax(largest, size);
        const double scale = d.of == 0 && extent > 0 ? extent : largest,
                     bound = worst_estimate + 16 * unit_roundoff * largest / scale;
        std::size_t worst = 0;  // the interval whose jump is always refined to the end
        for (std::size_t i = 1; i + 1 < ends.size(); ++i)
          if (less(remainder(d, ends[worst], ends[worst + 1]), remainder(d, ends[i], ends[i + 1]))) worst = i;
        double error = 0, where = ends[worst].x;
        for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
          End a = ends[i], b = ends[i + 1];
          double left = remainder(d, a, b);
          std::vector<double> changes{change(d, a, b)};
          while (i == worst || !(left <= bound * scale)) {
            const double middle = a.x + (b.x - a.x) / 2;
            if (middle == a.x || middle == b.x) break;
            const End m = end(middle);
            (less(remainder(d, m, b), remainder(d, a, m)) ? b : a) = m;
            left = remainder(d, a, b);
            changes.push_back(change(d, a, b));
          }
          if (i != worst && left <= bound * scale) continue;
          const double jump = jump_of(changes, left, bound * scale);
          if (!less(error, jump / scale)) continue;
          if (d.of != 0 && !(jump <= bound * scale) && (is_known(a) || is_known(b))) continue;
          error = jump / scale;
          where = b.x;
        }
        laws[of].compare(error, bound, uv(where).x, uv(where).y);
      }
    }
  for (const Law& law : laws) checks.push_back(law.result());
}

}  // namespace darboux::laws
