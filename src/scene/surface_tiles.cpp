#include "surface_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <darboux/cone.h>
#include <darboux/cylinder.h>
#include <darboux/disk.h>
#include <darboux/ellipsoid.h>
#include <darboux/error.h>
#include <darboux/sphere.h>
#include <darboux/torus.h>

namespace darboux {
namespace {

constexpr std::size_t most_tiles = std::size_t{1} << 18;  // a quarter of a GB

constexpr double TileRates::*position_rates[] = {&TileRates::position_uu, &TileRates::position_uv,
                                                 &TileRates::position_vv};
constexpr double TileRates::*frame_rates[] = {
    &TileRates::frame_u,   &TileRates::frame_v,   &TileRates::normal_u,  &TileRates::normal_v,
    &TileRates::normal_uu, &TileRates::normal_uv, &TileRates::normal_vv, &TileRates::frame_uu,
    &TileRates::frame_uv,  &TileRates::frame_vv};

// The component-wise maximum of the finite rates.
void take_larger(TileRates& a, const TileRates& b) {
  const auto take = [&](double TileRates::*rate) {
    if (std::isfinite(b.*rate) && !(a.*rate >= b.*rate && std::isfinite(a.*rate))) a.*rate = b.*rate;
  };
  for (auto rate : position_rates) take(rate);
  for (auto rate : frame_rates) take(rate);
}

// Uses estimates where there are no bounds, as next to poles. Returns which rates are proven.
Proven take_estimates(TileRates& bounds, const TileRates& estimates) {
  const auto take = [&](double TileRates::*rate) {
    if (std::isfinite(bounds.*rate)) return true;
    bounds.*rate = estimates.*rate;
    return false;
  };
  Proven result{true, true};
  for (auto rate : position_rates) result.chord = take(rate) && result.chord;
  for (auto rate : frame_rates) result.frame = take(rate) && result.frame;
  return result;
}

void include(Vec3<double>& lo, Vec3<double>& hi, const Vec3<double>& p) {
  lo = {std::fmin(lo.x, p.x), std::fmin(lo.y, p.y), std::fmin(lo.z, p.z)};
  hi = {std::fmax(hi.x, p.x), std::fmax(hi.y, p.y), std::fmax(hi.z, p.z)};
}

bool has_box(const TileNode& node) {
  const auto finite = [](const Vec3<double>& a) { return std::isfinite(a.x + a.y + a.z); };
  return finite(node.lo) && finite(node.hi);
}

// A lower bound of the distance from a point to an ellipsoid, exact from outside up to rounding. There it is
// the largest d·P - h(d) over unit vectors d, with h the ellipsoid's support function: any d gives a lower
// bound. The best is along (x/(a² + t), ...), at that t >= 0 for which the nearest point (a² x/(a² + t),
// ...) lies on the ellipsoid. From inside: the distance to the unit sphere to which the axes scale it, times
// the shortest axis.
double distance_to_ellipsoid(const Vec3<double>& axes, const Vec3<double>& p) {
  const Vec3<double> q{p.x / axes.x, p.y / axes.y, p.z / axes.z};
  const double square = dot(q, q);
  const double longest = std::fmax(axes.x, std::fmax(axes.y, axes.z)),
               shortest = std::fmin(axes.x, std::fmin(axes.y, axes.z)),
               rounded = 0x1p-46 * (std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z) + longest);
  if (square <= 1) return std::fmax((1 - std::sqrt(square)) * shortest - rounded, 0);
  const Vec3<double> scaled{p.x * axes.x, p.y * axes.y, p.z * axes.z},
      squares{axes.x * axes.x, axes.y * axes.y, axes.z * axes.z};
  // Newton's method on 1/|s(t)| = 1, s = (a x/(a² + t), ...), nearly linear in t, from where |s| >= 1.
  double t = std::fmax(norm(scaled) - longest * longest, 0);
  Vec3<double> d{};
  for (int i = 0; i < 20; ++i) {
    const Vec3<double> over{1 / (squares.x + t), 1 / (squares.y + t), 1 / (squares.z + t)};
    d = {p.x * over.x, p.y * over.y, p.z * over.z};
    const Vec3<double> s{axes.x * d.x, axes.y * d.y, axes.z * d.z};
    const double length = norm(s),
                 falls = s.x * s.x * over.x + s.y * s.y * over.y + s.z * s.z * over.z;  // -½ d(|s|²)/dt
    const double step = length * length * (length - 1) / falls;
    // The error of d is in proportion to the step, and that of the distance to its square.
    if (!(std::fabs(step) > 1e-9 * (t + shortest * shortest))) break;
    t = std::fmax(t + step, 0);
  }
  const Vec3<double> a{axes.x * d.x, axes.y * d.y, axes.z * d.z};
  const double distance = (dot(d, p) - norm(a)) / norm(d) - rounded;
  return distance > 0 ? distance : 0;
}

}  // namespace

Tile TilePlace::tile() const {
  const double du = std::ldexp(1.0, -level_u), dv = std::ldexp(1.0, -level_v);
  return {column * du, (column + 1) * du, row * dv, (row + 1) * dv};
}

TilePlace TilePlace::half(bool along_u, bool along_v, std::uint32_t i, std::uint32_t k) const {
  TilePlace result = *this;
  if (along_u) {
    ++result.level_u;
    result.column = 2 * column + i;
  }
  if (along_v) {
    ++result.level_v;
    result.row = 2 * row + k;
  }
  return result;
}

SurfaceTiles::SurfaceTiles(const AnySurface& surface, TileOrder order) : surface_(surface), order_(order) {
  const TileBounds whole(surface, Tile{}, order == TileOrder::position ? order : TileOrder::first);
  known_ = whole.known();
  // Closed forms have all necessary rates at once, and tight ones.
  const TileRates rates = whole.rates();
  const bool has_frame = std::isfinite(rates.frame_uu);
  if (has_frame || (whole.attained() && order == TileOrder::position)) {
    finest_ = typical_ = sampled_ = rates;
    proven_ = {true, has_frame};
    is_typical_ = true;
  } else {
    sample();
    if (known_)
      find_finest();
    else
      finest_ = sampled_;
    typical_ = finest_;
    for (auto rate : position_rates) typical_.*rate = std::fmin(typical_.*rate, sampled_.*rate);
    for (auto rate : frame_rates) typical_.*rate = std::fmin(typical_.*rate, sampled_.*rate);
  }
  if (known_) find_closed_form();
  nodes_.push_back(make({}));
  TileNode& all = *nodes_.front();
  // Interval bounds may give boxes of the parts but none of the whole.
  for (std::uint8_t level = 1; level <= 3 && !has_box(all); ++level)
    for (std::uint32_t i = 0; i < 1u << level; ++i)
      for (std::uint32_t k = 0; k < 1u << level; ++k) {
        const std::unique_ptr<TileNode> part = make({level, level, i, k});
        if (i + k == 0) {
          all.lo = part->lo;
          all.hi = part->hi;
        }
        include(all.lo, all.hi, part->lo);
        include(all.lo, all.hi, part->hi);
      }
  centre_ = 0.5 * (all.lo + all.hi);
  radius_ = 0.5 * norm(all.hi - all.lo) * (1 + 0x1p-48);
  reach_of_all_ = norm(centre_) + radius_;
  constexpr TileLevels most{finest_level, finest_level};
  finest_levels_ = ChordLevels(finest_, 1, 1, most);
  typical_levels_ = ChordLevels(typical_, 1, 1, most);
}

void SurfaceTiles::find_closed_form() {
  if (const auto* s = surface_.get<Sphere<>>())
    meridian_ = {Meridian::Kind::circle, 0, s->radius};
  else if (const auto* torus = surface_.get<Torus<>>(); torus && torus->major_radius >= torus->minor_radius)
    meridian_ = {Meridian::Kind::circle, torus->major_radius, torus->minor_radius};
  else if (const auto* cylinder = surface_.get<Cylinder<>>())
    meridian_ = {Meridian::Kind::line, 0, 0, {cylinder->radius, 0}, {cylinder->radius, cylinder->height}};
  else if (const auto* cone = surface_.get<Cone<>>())
    meridian_ = {Meridian::Kind::line, 0, 0, {cone->radius, 0}, {0, cone->height}};
  else if (const auto* disk = surface_.get<Disk<>>())
    meridian_ = {Meridian::Kind::line, 0, 0, {disk->outer_radius, 0}, {disk->inner_radius, 0}};
  else if (const auto* ellipsoid = surface_.get<Ellipsoid<>>())
    ellipsoid_ = {ellipsoid->semi_axis_x, ellipsoid->semi_axis_y, ellipsoid->semi_axis_z};
}

// The distance of a point to a surface of revolution is that to the meridian in the point's own half-plane.
// Rounding is subtracted.
double SurfaceTiles::Meridian::distance(const Vec3<double>& p) const {
  const double rho = std::sqrt(p.x * p.x + p.y * p.y);
  double distance, size;
  if (kind == Kind::circle) {
    const double x = rho - centre;
    distance = std::fabs(std::sqrt(x * x + p.z * p.z) - radius);
    size = centre + radius;
  } else {
    const double x = to[0] - from[0], y = to[1] - from[1], a = rho - from[0], b = p.z - from[1];
    const double share = std::clamp((a * x + b * y) / (x * x + y * y), 0.0, 1.0);
    const double off_x = a - share * x, off_y = b - share * y;
    distance = std::sqrt(off_x * off_x + off_y * off_y);
    size = std::fabs(from[0]) + std::fabs(from[1]) + std::fabs(to[0]) + std::fabs(to[1]);
  }
  return std::max(0.0, distance - 0x1p-48 * (rho + std::fabs(p.z) + size));
}

// The largest rates over the chart. Interval bounds are loose over large tiles: those with the largest rates
// are subdivided as long as that improves the bound.
void SurfaceTiles::find_finest() {
  struct Part {
    TileRates rates;
    TilePlace place;
    TileOrder order;
    double bend() const {
      const TileRates& r = rates;
      const double positions = r.position_uu + 2 * r.position_uv + r.position_vv;
      return order != TileOrder::second
                 ? positions
                 : positions + r.frame_u + r.frame_v + r.frame_uu + 2 * r.frame_uv + r.frame_vv;
    }
    bool operator<(const Part& other) const { return bend() < other.bend(); }
  };
  const auto part = [&](const TilePlace& place) {
    return Part{TileBounds(surface_, place.tile(), order_).rates(), place, order_};
  };
  constexpr int finest = 6;
  int left = 12;  // cuts
  std::vector<Part> open{part({})};
  while (left-- > 0 && open.front().place.level_u < finest) {
    std::pop_heap(open.begin(), open.end());
    const Part cut = open.back();
    double most = 0;
    std::array<Part, 4> parts;
    for (std::uint32_t i = 0; i < 4; ++i) {
      parts[i] = part(cut.place.half(true, true, i % 2, i / 2));
      most = std::fmax(most, parts[i].bend());
    }
    if (std::isfinite(cut.bend()) && most > 0.9 * cut.bend()) {
      std::push_heap(open.begin(), open.end());
      break;
    }
    open.pop_back();
    for (const Part& p : parts) {
      open.push_back(p);
      std::push_heap(open.begin(), open.end());
    }
  }
  for (const Part& p : open) take_larger(finest_, p.rates);
  const bool everywhere = std::isfinite(open.front().bend());
  proven_ = take_estimates(finest_, sampled_);
  proven_.chord = proven_.chord && everywhere;
  proven_.frame = proven_.frame && everywhere && order_ == TileOrder::second;
}

// From samples, increased by half: not a bound, but a good estimate. Uses differences over adjoining
// stencils.
void SurfaceTiles::sample() {
  constexpr std::size_t cells = 64, width = cells + 1;
  constexpr double h = 1.0 / cells, more = 1.5;
  using Vector = std::array<double, 3>;
  std::vector<Vector> position(width * width), t(position), b(position), n(position);
  const auto values = [](std::vector<Vector>& v) { return std::span(v.front().data(), 3 * v.size()); };
  Outputs<double> outputs;
  outputs.packed(Attribute::position, values(position)).packed(Attribute::tangent, values(t));
  outputs.packed(Attribute::bitangent, values(b)).packed(Attribute::normal, values(n));
  surface_.evaluate(Points<double>::grid(cells, cells), outputs);

  TileRates most;
  for (std::size_t k = 1; k < cells; k += 2)
    for (std::size_t i = 1; i < cells; i += 2) {
      const auto at = [&](const std::vector<Vector>& v, int du, int dv) {
        const Vector& x =
            v[(k + static_cast<std::size_t>(1 + dv) - 1) * width + i + static_cast<std::size_t>(1 + du) - 1];
        return Vec3<double>{x[0], x[1], x[2]};
      };
      struct Differences {
        Vec3<double> centre, u, v, uu, uv, vv;
      };
      const auto differences = [&](const std::vector<Vector>& x) {
        return Differences{at(x, 0, 0),
                           (at(x, 1, 0) - at(x, -1, 0)) / (2 * h),
                           (at(x, 0, 1) - at(x, 0, -1)) / (2 * h),
                           (at(x, 1, 0) - 2.0 * at(x, 0, 0) + at(x, -1, 0)) / (h * h),
                           (at(x, 1, 1) - at(x, 1, -1) - at(x, -1, 1) + at(x, -1, -1)) / (4 * h * h),
                           (at(x, 0, 1) - 2.0 * at(x, 0, 0) + at(x, 0, -1)) / (h * h)};
      };
      const Differences p = differences(position);
      if (places_.empty()) lo_ = hi_ = p.centre;
      include(lo_, hi_, p.centre);
      places_.push_back(p.centre);
      reach_ = std::fmax(reach_, more * h * (norm(p.u) + norm(p.v)));
      TileRates here;
      here.position_uu = more * norm(p.uu);
      here.position_uv = more * norm(p.uv);
      here.position_vv = more * norm(p.vv);
      const auto across = [](const Vec3<double>& d, const Vec3<double>& x) {
        return more * norm(d - dot(d, x) * x);
      };
      const Differences normal = differences(n);
      here.normal_u = more * norm(normal.u);
      here.normal_v = more * norm(normal.v);
      here.normal_uu = across(normal.uu, normal.centre);
      here.normal_uv = across(normal.uv, normal.centre);
      here.normal_vv = across(normal.vv, normal.centre);
      here.frame_u = here.frame_v = here.frame_uu = here.frame_uv = here.frame_vv = 0;
      for (const auto* x : {&t, &b, &n}) {
        const Differences d = differences(*x);
        // Angular velocities of two vectors add.
        here.frame_u = std::fmax(here.frame_u, 2 * more * norm(d.u));
        here.frame_v = std::fmax(here.frame_v, 2 * more * norm(d.v));
        here.frame_uu = std::fmax(here.frame_uu, across(d.uu, d.centre));
        here.frame_uv = std::fmax(here.frame_uv, across(d.uv, d.centre));
        here.frame_vv = std::fmax(here.frame_vv, across(d.vv, d.centre));
      }
      take_larger(most, here);
    }
  const Vec3<double> margin = (more - 1) / 2 * (hi_ - lo_);
  lo_ = lo_ - margin;
  hi_ = hi_ + margin;
  sampled_ = most;
}

double SurfaceTiles::estimated_distance(const Vec3<double>& from) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3<double>& p : places_) nearest = std::fmin(nearest, norm(p - from));
  return std::fmax(nearest - reach_, 0);
}

void SurfaceTiles::find_nearest(std::uint32_t node, const Vec3<double>& from, double& nearest_squared) {
  constexpr int finest = 4;
  const std::uint32_t first = parts(node, Split::both);
  std::array<double, 4> squared;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const TileNode& part = *nodes_[first + i];
    squared[i] = squared_distance_to_box(from, part.lo, part.hi);
  }
  if (nodes_[first]->place.level_u == finest) {
    for (const double x : squared) nearest_squared = x < nearest_squared ? x : nearest_squared;
    return;
  }
  for (int left = 4; left > 0; --left) {
    const auto nearest = std::min_element(squared.begin(), squared.end());
    if (!(*nearest < nearest_squared)) return;
    *nearest = std::numeric_limits<double>::infinity();
    find_nearest(first + static_cast<std::uint32_t>(nearest - squared.begin()), from, nearest_squared);
  }
}

SurfaceTiles::Distance SurfaceTiles::distance(const Vec3<double>& from) {
  if (!known_) return {estimated_distance(from)};
  if (meridian_.kind != Meridian::Kind::none) return {meridian_.distance(from)};
  if (ellipsoid_) return {distance_to_ellipsoid(*ellipsoid_, from)};
  const double to_box = std::sqrt(squared_distance_to_box(from, nodes_.front()->lo, nodes_.front()->hi)),
               afar = 4 * radius_, way_to_jump = std::fabs(to_box - afar);
  if (!(to_box < afar)) return {to_box, false, way_to_jump};
  double squared = std::numeric_limits<double>::infinity();
  find_nearest(root, from, squared);
  return {std::sqrt(squared), true, way_to_jump};
}

std::unique_ptr<TileNode> SurfaceTiles::make(const TilePlace& place) {
  auto node =
      std::make_unique<TileNode>(TileNode{lo_,
                                          hi_,
                                          place,
                                          {},
                                          {},
                                          {},
                                          {},
                                          {surface_, known_ ? place.tile() : Tile{1, 0, 0, 0}, order_},
                                          finest_,
                                          {}});
  if (known_) {
    node->rates = node->bounds.rates();
    node->proven = take_estimates(node->rates, sampled_);
    const auto reach = [&](double x, double y, double z) { return node->bounds.support({x, y, z}); };
    node->lo = {-reach(-1, 0, 0), -reach(0, -1, 0), -reach(0, 0, -1)};
    node->hi = {reach(1, 0, 0), reach(0, 1, 0), reach(0, 0, 1)};
  }
  node->chord_levels = {node->rates,
                        std::ldexp(1.0, -place.level_u),
                        std::ldexp(1.0, -place.level_v),
                        {finest_level - place.level_u, finest_level - place.level_v}};
  return node;
}

FacingPoint SurfaceTiles::facing_point_at(double u, double v) const {
  const Frame<double> frame = surface_.frame(u, v);
  const double height = dot(frame.n, surface_.jet(u, v).position);
  if (frame.status != Status::regular || !std::isfinite(height)) return {{}, 0, true};
  return {frame.n, height, true};
}

void SurfaceTiles::make_middle(TileNode& node) const {
  const Tile t = node.place.tile();
  node.middle = facing_point_at(0.5 * (t.u0 + t.u1), 0.5 * (t.v0 + t.v1));
}

// Of 4 x 4 points, chooses the one whose normal is nearest to the octant's.
void SurfaceTiles::make_octants() {
  of_octants_.fill({{}, 0, true});
  std::array<double, 8> best{};
  for (int i = 0; i < 16; ++i) {
    const FacingPoint point = facing_point_at((i % 4 + 0.5) / 4, (i / 4 + 0.5) / 4);
    for (std::size_t k = 0; k < 8; ++k) {
      const double along = (k & 1 ? -point.normal.x : point.normal.x) +
                           (k & 2 ? -point.normal.y : point.normal.y) +
                           (k & 4 ? -point.normal.z : point.normal.z);
      if (!(along > best[k])) continue;
      best[k] = along;
      of_octants_[k] = point;
    }
  }
}

std::uint32_t SurfaceTiles::parts(std::uint32_t index, Split split) {
  TileNode& whole = *nodes_[index];
  std::uint32_t& kept = whole.parts[static_cast<std::size_t>(split)];
  if (kept != 0) return kept;
  const bool along_u = split != Split::v, along_v = split != Split::u;
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t k = 0; k < (along_v ? 2u : 1u); ++k)
    for (std::uint32_t i = 0; i < (along_u ? 2u : 1u); ++i) {
      nodes_.push_back(make(whole.place.half(along_u, along_v, i, k)));
      Vec3<double>&lo = nodes_.back()->lo, &hi = nodes_.back()->hi;
      lo = {std::fmax(lo.x, whole.lo.x), std::fmax(lo.y, whole.lo.y), std::fmax(lo.z, whole.lo.z)};
      hi = {std::fmin(hi.x, whole.hi.x), std::fmin(hi.y, whole.hi.y), std::fmin(hi.z, whole.hi.z)};
    }
  if (nodes_.size() > most_tiles)
    throw ParameterError("scene",
                         "expected bounds that at most " + std::to_string(most_tiles) +
                             " tiles of a surface keep, got smaller ones: ask for a larger chord or angle");
  return kept = first;
}

}  // namespace darboux
