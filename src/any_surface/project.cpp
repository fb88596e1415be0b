#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <darboux/project.h>

namespace darboux {
namespace {

constexpr int grid = 33;
constexpr std::size_t node_at(int row, int column) {
  return std::size_t{grid} * static_cast<std::size_t>(row) + static_cast<std::size_t>(column);
}
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding = std::numeric_limits<double>::epsilon();

bool is_periodic(Coordinate kind) {
  return kind == Coordinate::turn || kind == Coordinate::twisted_turn;
}

double squared(const Vec3<double>& a) {
  return dot(a, a);
}

bool usable(const Jet2<double>& j) {
  return detail::finite(j.position) && detail::finite(j.dpdu) && detail::finite(j.dpdv) &&
         detail::finite(j.d2pdu2) && detail::finite(j.d2pduv) && detail::finite(j.d2pdv2);
}

// (u, v) with whole periods removed.
Vec2<double> reduced(const SurfaceInfo& info, Vec2<double> uv) {
  const auto off = [](double& x) {
    const double whole = std::floor(x);
    x -= whole;
    const bool rounded_up = x >= 1;  // -1e-17
    if (rounded_up) x = 0;
    return std::fmod(whole + (rounded_up ? 1 : 0), 2) != 0;  // odd
  };
  if (is_periodic(info.u) && off(uv.x) && info.u == Coordinate::twisted_turn) uv.y = 1 - uv.y;
  if (is_periodic(info.v) && off(uv.y) && info.v == Coordinate::twisted_turn) uv.x = 1 - uv.x;
  if (info.u == Coordinate::turn && info.v == Coordinate::twisted_turn) off(uv.x);
  return uv;
}

// A Newton step for half the squared distance, in lengths along the coordinate curves.
// \param r from p to the position \param gradient along these curves, of lengths a and b; zero where a
// coordinate is not free
Vec2<double> newton_step(const Jet2<double>& j, const Vec3<double>& r, const Vec2<double>& gradient, double a,
                         double b, bool u_free, bool v_free) {
  constexpr double least_eigenvalue = 1e-6;
  double huu = 1, huv = 0, hvv = 1;
  if (u_free) huu += dot(r, j.d2pdu2 / a) / a;
  if (v_free) hvv += dot(r, j.d2pdv2 / b) / b;
  if (u_free && v_free) huv = dot(j.dpdu, j.dpdv) / a / b + dot(r, j.d2pduv / a) / b;
  // H = V diag(λ) V^T with λ replaced by |λ|: always downhill, Newton's step near a minimum.
  const double mean = (huu + hvv) / 2, half = std::hypot((huu - hvv) / 2, huv);
  const double angle = 0.5 * std::atan2(huv, (huu - hvv) / 2), c = std::cos(angle), s = std::sin(angle);
  const double first = std::fmax(std::fabs(mean + half), least_eigenvalue),
               second = std::fmax(std::fabs(mean - half), least_eigenvalue);
  const double x = -(c * gradient.x + s * gradient.y) / first,
               y = -(c * gradient.y - s * gradient.x) / second;
  return {c * x - s * y, s * x + c * y};
}

}  // namespace

Projector::Projector(const AnySurface& surface, Extent extent) : surface_(surface) {
  for (int row = 0; row < grid; ++row)
    for (int column = 0; column < grid; ++column) {
      const Vec2<double> uv{static_cast<double>(column) / (grid - 1), static_cast<double>(row) / (grid - 1)};
      nodes_.push_back({uv, surface.jet(uv.x, uv.y).position, 0});
    }
  size_ = 0;
  for (const Node& node : nodes_)
    if (detail::finite(node.position)) size_ = std::max(size_, detail::largest_component(node.position));
  for (int row = 0; row < grid; ++row)
    for (int column = 0; column < grid; ++column) {
      Node& node = nodes_[node_at(row, column)];
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, grid - 1); ++r)
        for (int c = std::max(column - 1, 0); c <= std::min(column + 1, grid - 1); ++c)
          node.reach = std::fmax(node.reach, norm(nodes_[node_at(r, c)].position - node.position));
    }
  // Whether a side of the grid is one point.
  const auto collapsed = [&](bool along_u, int line) {
    const auto node = [&](int k) -> const Node& {
      return nodes_[along_u ? node_at(line, k) : node_at(k, line)];
    };
    for (int k = 1; k < grid; ++k)
      if (!(norm(node(k).position - node(0).position) <= 64 * rounding * size_)) return false;
    return true;
  };
  const auto limits = [&](Coordinate kind, bool is_v) {
    if (is_periodic(kind)) return Limits{-infinity, infinity};
    if (kind == Coordinate::half_turn || extent == Extent::patch) return Limits{0, 1};
    return Limits{collapsed(is_v, 0) ? 0 : -infinity, collapsed(is_v, grid - 1) ? 1 : infinity};
  };
  u_ = limits(surface.info().u, false);
  v_ = limits(surface.info().v, true);
}

Vec2<double> Projector::limited(const Vec2<double>& uv) const {
  return {std::clamp(uv.x, u_.minimum, u_.maximum), std::clamp(uv.y, v_.minimum, v_.maximum)};
}

// At a point where a whole coordinate curve collapses, every value of that coordinate gives the same point:
// chooses the value along whose other curve the distance to p decreases fastest. False if none decreases it.
bool Projector::nearer_beside_collapse(const Vec3<double>& p, const Jet2<double>& j, Vec2<double>& uv) const {
  constexpr int directions = 16;
  const bool u_collapses = norm(j.dpdu) <= norm(j.dpdv);
  const Limits& across = u_collapses ? v_ : u_;
  const double at = u_collapses ? uv.y : uv.x;
  double steepest = 4 * rounding;
  bool found = false;
  for (int k = 0; k < directions; ++k) {
    const double other = static_cast<double>(k) / directions;
    const Vec2<double> candidate = u_collapses ? Vec2<double>{other, at} : Vec2<double>{at, other};
    const Jet2<double> beside = surface_.jet(candidate.x, candidate.y);
    const Vec3<double> along = unit(u_collapses ? beside.dpdv : beside.dpdu);
    double slope = dot(along, unit(p - beside.position));
    if (at <= across.minimum)
      slope = std::fmax(slope, 0);
    else if (at >= across.maximum)
      slope = std::fmax(-slope, 0);
    else
      slope = std::fabs(slope);
    if (slope > steepest) {
      steepest = slope;
      found = true;
      uv = candidate;
    }
  }
  return found;
}

Projection Projector::at(const Vec3<double>& p, const Vec2<double>& uv) const {
  Projection result;
  result.uv = reduced(surface_.info(), uv);
  const Frame<double> frame = surface_.frame(result.uv.x, result.uv.y);
  result.position = surface_.jet(result.uv.x, result.uv.y).position;
  result.normal = frame.n;
  result.status = frame.status;
  const Vec3<double> r = p - result.position;
  result.distance = dot(r, frame.n) < 0 ? -norm(r) : norm(r);
  return result;
}

Projection Projector::newton(const Vec3<double>& p, Vec2<double> uv) const {
  constexpr int most_iterations = 60, most_halvings = 40;
  constexpr double longest_turn = 0.125;
  const SurfaceInfo& info = surface_.info();
  const double scale = std::fmax(size_, detail::largest_component(p));
  uv = limited(uv);
  Jet2<double> j = surface_.jet(uv.x, uv.y);
  // Steps off a line where the partials are infinite.
  for (int k = 0; k < 4 && !usable(j); ++k) {
    constexpr double beside = 0.3 / (grid - 1);
    const Vec2<double> candidate =
        limited(uv + Vec2<double>{k % 2 ? beside : -beside, k / 2 ? beside : -beside});
    j = surface_.jet(candidate.x, candidate.y);
    if (usable(j)) uv = candidate;
  }
  bool converged = false;
  int iterations = 0, restarts = 0;
  while (iterations < most_iterations && usable(j)) {
    ++iterations;
    const Vec3<double> r = j.position - p;
    const double a = norm(j.dpdu), b = norm(j.dpdv);
    const double collapse = 1e-9 * std::fmax(a, b);
    // The unknowns are lengths along the coordinate curves. One that has collapsed, or is held at the border,
    // is excluded.
    double gu = a > collapse ? dot(r, j.dpdu) / a : 0, gv = b > collapse ? dot(r, j.dpdv) / b : 0;
    const bool u_free = a > collapse && !(uv.x <= u_.minimum && gu >= 0) && !(uv.x >= u_.maximum && gu <= 0);
    const bool v_free = b > collapse && !(uv.y <= v_.minimum && gv >= 0) && !(uv.y >= v_.maximum && gv <= 0);
    if (!u_free) gu = 0;
    if (!v_free) gv = 0;
    const double slope = std::hypot(gu, gv);
    // The part of the slope that rounding of uv and position explains.
    const double noise = 16 * rounding * (scale + norm(r));
    if (slope <= noise) {
      Vec2<double> beside = uv;
      if ((a <= collapse || b <= collapse) && ++restarts < 4 && nearer_beside_collapse(p, j, beside) &&
          beside != uv) {
        uv = beside;
        j = surface_.jet(uv.x, uv.y);
        continue;
      }
      converged = true;
      break;
    }
    const Vec2<double> step = newton_step(j, r, {gu, gv}, a, b, u_free, v_free);
    double du = u_free ? step.x / a : 0, dv = v_free ? step.y / b : 0;
    double longest = 1;
    if (info.u != Coordinate::linear) longest = std::fmax(longest, std::fabs(du) / longest_turn);
    if (info.v != Coordinate::linear) longest = std::fmax(longest, std::fabs(dv) / longest_turn);
    du /= longest;
    dv /= longest;
    const double square = squared(r);
    int halvings = 0;
    double moved_by = 0;
    for (; halvings < most_halvings; ++halvings, du /= 2, dv /= 2) {
      const Vec2<double> next = limited({uv.x + du, uv.y + dv});
      const Jet2<double> k = surface_.jet(next.x, next.y);
      if (!usable(k) || !(squared(k.position - p) <= square + noise * norm(r))) continue;
      moved_by = norm(k.position - j.position);
      uv = next;
      j = k;
      break;
    }
    if (halvings == most_halvings || moved_by <= 2 * rounding * scale) {
      converged = halvings == 0 || slope <= 64 * noise;
      break;
    }
  }
  Projection result = at(p, uv);
  result.iterations = iterations;
  result.converged = converged;
  return result;
}

Projection Projector::operator()(const Vec3<double>& p, const Vec2<double>& start) const {
  return newton(p, start);
}

Projection Projector::operator()(const Vec3<double>& p) const {
  if (!detail::finite(p)) {
    const Vec3<double> none = detail::nan_vector<double>();
    return {{none.x, none.x}, none, none, none.x, Status::non_finite_input, 0, false};
  }
  std::array<double, grid * grid> distance;
  for (std::size_t k = 0; k < distance.size(); ++k) distance[k] = squared(nodes_[k].position - p);
  struct Start {
    double distance;
    std::size_t node;
  };
  std::vector<Start> starts;
  for (int row = 0; row < grid; ++row)
    for (int column = 0; column < grid; ++column) {
      const auto at = node_at(row, column);
      bool least = std::isfinite(distance[at]);
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, grid - 1) && least; ++r)
        for (int c = std::max(column - 1, 0); c <= std::min(column + 1, grid - 1) && least; ++c)
          least = !(distance[node_at(r, c)] < distance[at]);
      if (least) starts.push_back({distance[at], at});
    }
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) {
    return std::pair(a.distance, a.node) < std::pair(b.distance, b.node);
  });
  constexpr std::size_t most_starts = 8;
  Projection best;
  best.distance = infinity;
  int iterations = 0;
  // A side that is one point yields many starts at the same place.
  std::vector<const Node*> tried;
  for (const Start& start : starts) {
    const Node& node = nodes_[start.node];
    if (tried.size() == most_starts) break;
    if (std::sqrt(start.distance) - node.reach > std::fabs(best.distance)) continue;
    const bool again = std::any_of(tried.begin(), tried.end(), [&](const Node* other) {
      const auto side = [](double x, double y) { return x == y && (x == 0 || x == 1); };
      return (side(node.uv.x, other->uv.x) || side(node.uv.y, other->uv.y)) &&
             norm(other->position - node.position) <= 64 * rounding * size_;
    });
    if (again) continue;
    tried.push_back(&node);
    const Projection found = newton(p, node.uv);
    iterations += found.iterations;
    if (std::fabs(found.distance) < std::fabs(best.distance)) best = found;
  }
  best.iterations = iterations;
  return best;
}

Projection project(const AnySurface& surface, const Vec3<double>& p, Extent extent) {
  return Projector(surface, extent)(p);
}

Projection project(const PlacedSurface& surface, const Vec3<double>& p, Extent extent) {
  const Eigen::Isometry3d inverse = surface.placement.inverse();
  Projection result = project(surface.surface, from_eigen(inverse * to_eigen(p)), extent);
  result.position = from_eigen(surface.placement * to_eigen(result.position));
  result.normal = from_eigen(surface.placement.linear() * to_eigen(result.normal));
  return result;
}

}  // namespace darboux
