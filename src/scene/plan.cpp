#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/scene.h>

#include "base/hash_table.h"
#include "patch_layout.h"
#include "surface_tiles.h"
#include "view.h"

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int tile_level = 4;                             // a tile has no more than 2^4 × 2^4 cells
constexpr int finest_level = 14;                          // of the cells of a chart
constexpr std::uint32_t chart_size = 1u << finest_level;  // in whole numbers

// 2^-level
double share_of(int level) {
  return 1.0 / static_cast<double>(1u << level);
}

constexpr Attributes tangent_attributes =
    Attribute::tangent | Attribute::bitangent | Attribute::handedness | Attribute::tangent4;

double distance_to_box(const Vec3<double>& p, const Vec3<double>& lo, const Vec3<double>& hi) {
  const auto beyond = [](double x, double from, double to) {
    return x < from ? from - x : x > to ? x - to : 0;
  };
  const Vec3<double> d{beyond(p.x, lo.x, hi.x), beyond(p.y, lo.y, hi.y), beyond(p.z, lo.z, hi.z)};
  return std::sqrt(dot(d, d));
}

// The fewest cells on a rectangle of the chart for which error(du, dv) <= 1, which falls with both: no fewer
// than a first guess has and no more than 2^most. Halves that side of the cells that is worth more.
template <class F>
TileLevels fewest_cells(double width_u, double width_v, const TileLevels& most, F error,
                        TileLevels result = {}) {
  double du = width_u * share_of(result.u), dv = width_v * share_of(result.v);
  while ((result.u < most.u || result.v < most.v) && !(error(du, dv) <= 1)) {
    if (result.v == most.v || (result.u < most.u && !(error(du, dv / 2) < error(du / 2, dv)))) {
      ++result.u;
      du /= 2;
    } else {
      ++result.v;
      dv /= 2;
    }
  }
  return result;
}

// The fewest cells, as a power of two no greater than 2^most, whose squared number is no less than
// `cells_squared`.
int levels_for(double cells_squared, int most) {
  if (!(cells_squared > 1)) return 0;
  int exponent = 0;
  const double mantissa = std::frexp(cells_squared, &exponent);  // in [1/2, 1)
  if (mantissa == 0.5) --exponent;
  return std::min(most, (exponent + 1) / 2);
}

// Rates of frames that a placement M stretches, of a given condition. Of f = M x / |M x|, with L and F the
// rates of x of first and second order, |f'| <= κ L, and across f |f''| <= κ F + 2 κ² L². What is square to
// two such vectors adds theirs.
TileRates stretched(const TileRates& r, double condition) {
  const double k = condition, k2 = condition * condition;
  TileRates result = r;
  result.normal_u = k * r.normal_u;
  result.normal_v = k * r.normal_v;
  result.normal_uu = k * r.normal_uu + 2 * k2 * r.normal_u * r.normal_u;
  result.normal_uv = k * r.normal_uv + 2 * k2 * r.normal_u * r.normal_v;
  result.normal_vv = k * r.normal_vv + 2 * k2 * r.normal_v * r.normal_v;
  result.frame_u = 2 * k * r.frame_u;
  result.frame_v = 2 * k * r.frame_v;
  result.frame_uu = 2 * k * r.frame_uu + 6 * k2 * r.frame_u * r.frame_u;
  result.frame_uv = 2 * k * r.frame_uv + 6 * k2 * r.frame_u * r.frame_v;
  result.frame_vv = 2 * k * r.frame_vv + 6 * k2 * r.frame_v * r.frame_v;
  return result;
}

// The angle of interpolated frames. Where there is no bound yet, beyond all bounds and falling with the
// cells.
double interpolation_angle(const TileRates& r, bool of_tangents, double du, double dv) {
  const double angle =
      of_tangents ? r.frame_interpolation_angle(du, dv) : r.normal_interpolation_angle(du, dv);
  if (std::isfinite(angle)) return angle;
  return std::numbers::pi +
         (of_tangents ? r.frame_u * du + r.frame_v * dv : r.normal_u * du + r.normal_v * dv);
}

// An instance before a camera.
struct Placed {
  Vec3<double> eye;  // in the surface's own space; of an orthographic camera the direction to it
  std::array<Vec3<double>, 6> normals;
  std::array<double, 6> offsets;
  bool seen;                 // or wholly outside the frustum, with all that surrounds it
  double smallest, largest;  // by what the placement scales lengths
  double condition;          // their ratio, 1 where it scales all alike
  double displacement;
  double eye_rounding;    // of `eye`
  double plane_rounding;  // of normals and offsets
};

// A tile that was looked at, in the tree of its instance.
struct Visited {
  std::uint32_t node;
  std::uint32_t first_part = 0;
  Split split = Split::none;
  bool needed = false;
  std::uint8_t planes = 0;  // of the frustum, those that may cut it
  TileLevels cells;         // of a tile that is needed
};

// The instance that is planned.
struct Current {
  SurfaceTiles* tiles;
  Placed placed;
  double nearest;     // distance from the eye
  TileLevels finest;  // cells that the nearest point needs
  Attributes asked;
  bool bounds_chord, bounds_frame;  // what is asked for
};

// The cells of a tile as its place asks for them, whether or not it is seen.
struct Resolution {
  TileLevels cells;
  Proven proven;

  Split split() const {
    const bool u = cells.u > tile_level, v = cells.v > tile_level;
    return u && v ? Split::both : u ? Split::u : v ? Split::v : Split::none;
  }
};

void check(const Scene& scene, const SceneRequest& request) {
  const auto positive = [](const char* name, double bound) {
    if (!(bound > 0)) throw ParameterError(name, "expected a bound > 0, got " + std::to_string(bound));
  };
  positive("chord_px", request.chord_px);
  positive("chord", request.chord);
  positive("frame_angle_rad", request.frame_angle_rad);
  if (request.attributes.empty()) throw ParameterError("attributes", "expected at least one, got none");
  for (const SceneMaterial& m : scene.materials)
    if (!(m.displacement >= 0) || !std::isfinite(m.displacement))
      throw ParameterError("material " + m.name,
                           "expected a displacement >= 0, got " + std::to_string(m.displacement));
  if (scene.instances.size() > std::numeric_limits<std::uint32_t>::max() / 2)
    throw ParameterError("scene",
                         "expected fewer than 2^31 instances, got " + std::to_string(scene.instances.size()));
}

// The extent of a tile in whole numbers.
struct Extent {
  std::uint32_t u0, u1, v0, v1;
  explicit Extent(const TilePlace& p)
      : u0(p.column << (finest_level - p.level_u)),
        u1((p.column + 1) << (finest_level - p.level_u)),
        v0(p.row << (finest_level - p.level_v)),
        v1((p.row + 1) << (finest_level - p.level_v)) {}
};

// What samples the tiles of an instance have on an edge of another one, that are no multiples of `spacing`.
struct EdgeSearch {
  bool along_u;  // the edge is v = line, else u = line
  bool below;    // of the tiles below the line, or of those above
  std::uint32_t line, from, to, spacing;
  bool mirrored;  // across a twisted seam

  // Whether a tile touches the edge.
  bool touches(const Extent& e) const {
    const std::uint32_t near = along_u ? e.v0 : e.u0, far = along_u ? e.v1 : e.u1;
    return line >= near && line <= far && begin(e) < end(e);
  }
  std::uint32_t begin(const Extent& e) const { return std::max(from, along_u ? e.u0 : e.v0); }
  std::uint32_t end(const Extent& e) const { return std::min(to, along_u ? e.u1 : e.v1); }

  void take(const Extent& e, const TileLevels& cells, std::vector<std::uint32_t>& found) const {
    if (line != (below ? (along_u ? e.v1 : e.u1) : (along_u ? e.v0 : e.u0))) return;
    const std::uint32_t step = along_u ? (e.u1 - e.u0) >> cells.u : (e.v1 - e.v0) >> cells.v;
    if (step >= spacing) return;
    for (std::uint32_t x = (begin(e) + step - 1) / step * step; x <= end(e); x += step)
      if (x % spacing != 0) found.push_back(mirrored ? chart_size - x : x);
  }
};

// Tiles of the finest resolution that a tile is made of.
std::uint64_t tiles_within(const TilePlace& place, const TileLevels& finest) {
  const TileLevels deepest{std::max(finest.u - tile_level, 0), std::max(finest.v - tile_level, 0)};
  return std::uint64_t{1} << (deepest.u - place.level_u + deepest.v - place.level_v);
}

}  // namespace

class ScenePlanner::Planner {
 public:
  Planner(const Scene& scene, const SceneRequest& request);
  ScenePlan plan(const Camera& camera);

 private:
  Placed place(std::uint32_t instance, SurfaceTiles& tiles) const;
  double nearest_distance(SurfaceTiles& tiles, const Placed& placed);
  TileLevels cells_needed(const Placed& placed, double distance, Attributes asked, const TileRates& rates,
                          const TilePlace& place, FrameLevels& kept) const;
  bool bounds_frames(Attributes asked) const {
    return asked.has_any(frame_attributes) && request_.frame_angle_rad < std::numbers::pi;
  }
  void plan_instance(std::uint32_t instance);
  void visit_tiles(bool one_sided);
  void add_patches(std::uint32_t instance);
  Resolution resolution(std::uint32_t node) const;
  bool outside(const Placed& placed, const TileNode& node, std::uint8_t& planes) const;
  bool faces_away(const Placed& placed, const TileNode& node) const;
  void find_edges(const Visited& tile, ScenePatch& patch);
  void add(std::uint32_t instance, ScenePatch patch);

  const Scene& scene_;
  SceneRequest request_;
  View view_{Camera()};
  std::vector<std::unique_ptr<SurfaceTiles>> tiles_;
  Current current_{};
  std::vector<Visited> visited_;
  std::vector<std::uint32_t> found_;                    // samples on an edge
  std::vector<std::pair<double, std::uint32_t>> open_;  // tiles by their distance
  HashTable known_patches_;
  ScenePlan plan_;
};

ScenePlanner::Planner::Planner(const Scene& scene, const SceneRequest& request)
    : scene_(scene), request_(request), tiles_(scene.surfaces.size()) {
  check(scene, request);
}

Placed ScenePlanner::Planner::place(std::uint32_t index, SurfaceTiles& tiles) const {
  const SceneInstance& instance = scene_.instances[index];
  const Eigen::Matrix3d m = instance.placement.linear();
  const Eigen::Vector3d t = instance.placement.translation();
  const auto wrong = [&](const char* what) {
    return ParameterError("instance " + std::to_string(index),
                          std::string("expected a placement that is finite and invertible, got ") + what);
  };
  if (!m.allFinite() || !t.allFinite()) throw wrong("one that is not finite");
  Placed result{};
  const Eigen::Matrix3d square = m.transpose() * m;
  const double scale = square.trace() / 3;
  Eigen::Matrix3d inverse;
  if ((square - scale * Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 1e-14 * scale && scale > 0) {
    result.smallest = std::sqrt(scale) * (1 - 1e-13);
    result.largest = std::sqrt(scale) * (1 + 1e-13);
    result.condition = 1;
    inverse = m.transpose() / scale;
  } else {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Vector3d s = svd.singularValues();
    if (!(s[2] > 1e-12 * s[0])) throw wrong("a singular one");
    result.smallest = s[2] * (1 - 1e-13);
    result.largest = s[0] * (1 + 1e-13);
    result.condition = result.largest / result.smallest;
    // Cofactors lose the square of the condition.
    inverse = svd.matrixV() * s.cwiseInverse().asDiagonal() * svd.matrixU().transpose();
  }
  constexpr double rounding = 0x1p-48;
  const double lengths = view_.eye().norm() + t.norm();
  result.eye =
      view_.perspective() ? from_eigen(inverse * (view_.eye() - t)) : from_eigen(inverse * view_.backward());
  // With what inverting an ill-conditioned placement loses.
  result.eye_rounding = rounding * result.condition * (view_.perspective() ? lengths : 1) / result.smallest;
  result.plane_rounding = rounding * (lengths + result.largest * (norm(tiles.centre()) + tiles.radius()));
  for (std::size_t k = 0; k < 6; ++k) {
    const Plane3& plane = view_.planes()[k];
    result.normals[k] = from_eigen(m.transpose() * plane.normal);
    result.offsets[k] = plane.offset - plane.normal.dot(t);
  }
  result.displacement = scene_.materials[instance.material].displacement;
  const double reach = result.largest * tiles.radius() + result.displacement + result.plane_rounding;
  result.seen = true;
  for (std::size_t k = 0; k < 6; ++k)
    result.seen = result.seen && !(dot(result.normals[k], tiles.centre()) - result.offsets[k] < -reach);
  return result;
}

// From the eye to the surface, in the scene; what is nearer than the near plane is not seen.
double ScenePlanner::Planner::nearest_distance(SurfaceTiles& tiles, const Placed& placed) {
  if (!view_.perspective()) return infinity;
  const auto to = [&](std::uint32_t node) {
    return distance_to_box(placed.eye, tiles[node].lo, tiles[node].hi);
  };
  double nearest = tiles.known() ? to(SurfaceTiles::root) : tiles.estimated_distance(placed.eye);
  // A box says little from near by: the least of those of tiles, down to some size.
  if (tiles.known() && nearest < 4 * tiles.radius()) {
    constexpr int finest = 4;
    nearest = infinity;
    auto& open = open_;
    open.assign(1, {to(SurfaceTiles::root), SurfaceTiles::root});
    const auto later = [](const auto& a, const auto& b) { return a.first > b.first; };
    while (!open.empty()) {
      std::pop_heap(open.begin(), open.end(), later);
      const auto [distance, node] = open.back();
      open.pop_back();
      if (tiles[node].place.level_u == finest) {
        nearest = distance;
        break;
      }
      const std::uint32_t first = tiles.parts(node, Split::both);
      for (std::uint32_t i = 0; i < 4; ++i) {
        open.emplace_back(to(first + i), first + i);
        std::push_heap(open.begin(), open.end(), later);
      }
    }
  }
  const double rounded = nearest - placed.eye_rounding - 0x1p-48 * nearest;
  return std::fmax(rounded * placed.smallest - placed.displacement, view_.near_distance());
}

// How many cells a tile needs at a distance from the eye: what its chords ask for and what its frames ask
// for.
TileLevels ScenePlanner::Planner::cells_needed(const Placed& placed, double distance, Attributes asked,
                                               const TileRates& rates, const TilePlace& place,
                                               FrameLevels& kept) const {
  const TileLevels most{finest_level - place.level_u, finest_level - place.level_v};
  const double width_u = share_of(place.level_u), width_v = share_of(place.level_v);
  const double chord =
      std::fmin(request_.chord, view_.length_of(request_.chord_px, distance)) / placed.largest;
  TileLevels result;
  if (std::isfinite(chord))
    result = fewest_cells(width_u, width_v, most,
                          [&](double du, double dv) { return rates.chord(du, dv) / chord; },
                          {levels_for(width_u * width_u * rates.position_uu / (8 * chord), most.u),
                           levels_for(width_v * width_v * rates.position_vv / (8 * chord), most.v)});
  if (!bounds_frames(asked)) return result;
  // These do not depend on the distance.
  const bool of_tangents = asked.has_any(tangent_attributes);
  if (kept.condition != placed.condition || kept.of_tangents != of_tangents ||
      kept.angle != request_.frame_angle_rad) {
    // What scales all alike but for rounding, as matrices in single precision do, turns vectors by that much.
    const double turned = 4 * (placed.condition - 1), asked_for = request_.frame_angle_rad;
    const bool alike = turned <= 0.01 * asked_for;
    const TileRates of_frames = alike ? rates : stretched(rates, placed.condition);
    const double angle = alike ? asked_for - turned : asked_for;
    kept = {placed.condition, asked_for, of_tangents,
            fewest_cells(width_u, width_v, most, [&](double du, double dv) {
              return interpolation_angle(of_frames, of_tangents, du, dv) / angle;
            })};
  }
  return {std::max(result.u, kept.levels.u), std::max(result.v, kept.levels.v)};
}

// Whether a tile lies wholly beyond a plane of the frustum. By its box, then by itself.
bool ScenePlanner::Planner::outside(const Placed& placed, const TileNode& node, std::uint8_t& planes) const {
  for (std::size_t k = 0; k < 6; ++k) {
    if (!(planes >> k & 1)) continue;
    const Vec3<double>& n = placed.normals[k];
    const auto along = [](double a, double lo, double hi) {
      return std::pair(a < 0 ? a * hi : a * lo, a < 0 ? a * lo : a * hi);
    };
    const auto [x0, x1] = along(n.x, node.lo.x, node.hi.x);
    const auto [y0, y1] = along(n.y, node.lo.y, node.hi.y);
    const auto [z0, z1] = along(n.z, node.lo.z, node.hi.z);
    const double margin = placed.displacement + placed.plane_rounding;
    if (x0 + y0 + z0 - placed.offsets[k] > margin) {
      planes = static_cast<std::uint8_t>(planes & ~(1u << k));
      continue;
    }
    if (x1 + y1 + z1 - placed.offsets[k] < -margin) return true;
    if (node.bounds.support(n) - placed.offsets[k] < -margin) return true;
  }
  return false;
}

bool ScenePlanner::Planner::faces_away(const Placed& placed, const TileNode& node) const {
  const double facing =
      view_.perspective() ? node.bounds.facing(placed.eye) : node.bounds.facing_along(placed.eye);
  return facing < -placed.eye_rounding;
}

Resolution ScenePlanner::Planner::resolution(std::uint32_t index) const {
  const Placed& placed = current_.placed;
  SurfaceTiles& tiles = *current_.tiles;
  const TileNode& node = tiles[index];
  // The finest is enough everywhere. The bounds of a large tile may ask for more.
  const TileLevels most{current_.finest.u - node.place.level_u, current_.finest.v - node.place.level_v};
  // A chart is never cut finer than 2^finest_level.
  const bool limited_u = current_.finest.u == finest_level, limited_v = current_.finest.v == finest_level;
  const Resolution finest{most, limited_u || limited_v ? Proven{} : tiles.proven()};
  if (!request_.skip.below_error) return finest;
  // Smaller tiles have bounds where this one has none, but for those at a pole.
  constexpr int small = 5;
  const bool bounded =
      (!current_.bounds_chord || node.proven.chord) && (!current_.bounds_frame || node.proven.frame);
  if (!bounded && tiles.known() && (node.place.level_u < small || node.place.level_v < small) &&
      (most.u > tile_level || most.v > tile_level))
    return finest;
  double distance = current_.nearest;
  if (view_.perspective() && tiles.known()) {
    const double to_box = distance_to_box(placed.eye, node.lo, node.hi);
    distance = std::fmax(
        distance, (to_box - placed.eye_rounding - 0x1p-48 * to_box) * placed.smallest - placed.displacement);
  }
  const TileLevels cells =
      cells_needed(placed, distance, current_.asked, node.rates, node.place, tiles.frame_levels(index));
  const bool enough = cells.u <= most.u - limited_u && cells.v <= most.v - limited_v;
  return enough ? Resolution{cells, node.proven} : finest;
}

void ScenePlanner::Planner::plan_instance(std::uint32_t index) {
  const SceneInstance& instance = scene_.instances[index];
  if (instance.surface >= scene_.surfaces.size() || instance.material >= scene_.materials.size())
    throw ParameterError("instance " + std::to_string(index),
                         "expected a surface below " + std::to_string(scene_.surfaces.size()) +
                             " and a material below " + std::to_string(scene_.materials.size()) + ", got " +
                             std::to_string(instance.surface) + " and " + std::to_string(instance.material));
  const SceneMaterial& material = scene_.materials[instance.material];
  std::unique_ptr<SurfaceTiles>& kept = tiles_[instance.surface];
  if (!kept)
    kept = std::make_unique<SurfaceTiles>(
        scene_.surfaces[instance.surface],
        bounds_frames(request_.attributes) ? TileOrder::second : TileOrder::first);
  SurfaceTiles& tiles = *kept;
  const Placed placed = place(index, tiles);
  const SceneRequest::Skip& skip = request_.skip;

  // Every tile of the finest resolution.
  const double nearest = nearest_distance(tiles, placed);
  const auto levels = [&](const TileRates& rates, FrameLevels& kept) {
    return cells_needed(placed, nearest, request_.attributes, rates, {}, kept);
  };
  const TileLevels uniform = levels(tiles.typical(), tiles.typical_frame_levels());
  const TileLevels finest = skip.below_error ? levels(tiles.finest(), tiles.frame_levels()) : uniform;
  const std::uint64_t all_tiles = tiles_within({}, finest);
  plan_.tiles_all += all_tiles;
  plan_.samples_full += ((std::uint64_t{1} << uniform.u) + 1) * ((std::uint64_t{1} << uniform.v) + 1);

  Attributes asked = request_.attributes;
  if (skip.unread_attributes && !material.reads_tangents()) {
    asked = Attributes();
    for (std::size_t a = 0; a < attribute_count; ++a) {
      const auto attribute = static_cast<Attribute>(a);
      if (request_.attributes.has(attribute) && !tangent_attributes.has(attribute)) asked |= attribute;
    }
    if (asked.empty()) {
      plan_.skipped.no_normal_map += all_tiles;
      return;
    }
  }
  const bool bounds_chord = std::isfinite(request_.chord) || std::isfinite(request_.chord_px);
  const bool bounds_frame = bounds_frames(asked);
  current_ = {&tiles, placed, nearest, finest, asked, bounds_chord, bounds_frame};
  if (skip.outside_frustum && tiles.known() && !placed.seen) {
    plan_.skipped.outside_frustum += all_tiles;
    return;
  }
  visit_tiles(!material.double_sided && material.displacement == 0);
  add_patches(index);
}

// The tiles that the current instance needs, of the coarsest resolution that is enough, and those above them.
void ScenePlanner::Planner::visit_tiles(bool one_sided) {
  SurfaceTiles& tiles = *current_.tiles;
  const Placed& placed = current_.placed;
  const SceneRequest::Skip& skip = request_.skip;
  visited_.clear();
  visited_.push_back({SurfaceTiles::root,
                      0,
                      Split::none,
                      false,
                      skip.outside_frustum && tiles.known() ? std::uint8_t{63} : std::uint8_t{0},
                      {}});
  std::size_t leaves = 0;
  for (std::size_t i = 0; i < visited_.size(); ++i) {
    Visited here = visited_[i];
    const TileNode& node = tiles[here.node];
    const std::uint64_t all = tiles_within(node.place, current_.finest);
    if (here.planes != 0 && outside(placed, node, here.planes)) {
      plan_.skipped.outside_frustum += all;
      continue;
    }
    if (skip.back_facing && one_sided && tiles.known() && faces_away(placed, node)) {
      plan_.skipped.back_facing += all;
      continue;
    }
    const Resolution needed = resolution(here.node);
    here.cells = needed.cells;
    here.split = needed.split();
    if (here.split != Split::none) {
      here.first_part = static_cast<std::uint32_t>(visited_.size());
      const std::uint32_t first = tiles.parts(here.node, here.split);
      for (std::uint32_t k = 0; k < part_count(here.split); ++k)
        visited_.push_back({first + k, 0, Split::none, false, here.planes, {}});
    } else {
      here.needed = true;
      ++leaves;
      const Proven& proven = needed.proven;
      if ((current_.bounds_chord && !proven.chord) || (current_.bounds_frame && !proven.frame))
        ++plan_.tiles_unbounded;
      plan_.skipped.below_error += all - 1;
    }
    visited_[i] = here;
  }
  if (leaves > 0) ++plan_.instances_needed;
}

// A patch for each tile that is needed.
void ScenePlanner::Planner::add_patches(std::uint32_t index) {
  for (std::size_t i = 0; i < visited_.size(); ++i) {
    const Visited& tile = visited_[i];
    if (!tile.needed) continue;
    const TilePlace& at = (*current_.tiles)[tile.node].place;
    ScenePatch patch;
    patch.surface = scene_.instances[index].surface;
    patch.level_u = at.level_u;
    patch.level_v = at.level_v;
    patch.cells_u = static_cast<std::uint16_t>(1u << tile.cells.u);
    patch.cells_v = static_cast<std::uint16_t>(1u << tile.cells.v);
    patch.column = at.column;
    patch.row = at.row;
    patch.attributes = current_.asked;
    patch.first_edge_coordinate = static_cast<std::uint32_t>(plan_.edge_coordinates.size());
    if (visited_.size() > 1) find_edges(tile, patch);
    add(index, patch);
  }
}

// Tiles that are not seen count like the others: what a tile's triangles are does not depend on what is
// culled.
void ScenePlanner::Planner::find_edges(const Visited& tile, ScenePatch& patch) {
  SurfaceTiles& tiles = *current_.tiles;
  const auto search = [&](const EdgeSearch& edge) {
    const auto unseen = [&](const auto& self, std::uint32_t node) -> void {
      const Extent extent(tiles[node].place);
      if (!edge.touches(extent)) return;
      const Resolution r = resolution(node);
      if (r.split() == Split::none) return edge.take(extent, r.cells, found_);
      const std::uint32_t first = tiles.parts(node, r.split());
      for (std::uint32_t k = 0; k < part_count(r.split()); ++k) self(self, first + k);
    };
    const auto seen = [&](const auto& self, std::uint32_t visited) -> void {
      const Visited& v = visited_[visited];
      const Extent extent(tiles[v.node].place);
      if (!edge.touches(extent)) return;
      if (v.split != Split::none) {
        for (std::uint32_t k = 0; k < part_count(v.split); ++k) self(self, v.first_part + k);
      } else if (v.needed) {
        edge.take(extent, v.cells, found_);
      } else {
        unseen(unseen, v.node);
      }
    };
    seen(seen, 0);
  };
  const Extent e(tiles[tile.node].place);
  const SurfaceInfo& info = tiles.surface().info();
  const auto round = [](Coordinate c) { return c == Coordinate::turn || c == Coordinate::twisted_turn; };
  const std::uint32_t step_u = (e.u1 - e.u0) >> tile.cells.u, step_v = (e.v1 - e.v0) >> tile.cells.v;
  for (std::size_t k = 0; k < 4; ++k) {
    const bool along_u = k < 2, upper = k % 2 == 1;
    // No tile is finer than the finest.
    if (along_u ? tiles[tile.node].place.level_u + tile.cells.u >= current_.finest.u
                : tiles[tile.node].place.level_v + tile.cells.v >= current_.finest.v)
      continue;
    std::uint32_t line = along_u ? (upper ? e.v1 : e.v0) : (upper ? e.u1 : e.u0);
    std::uint32_t from = along_u ? e.u0 : e.v0, to = along_u ? e.u1 : e.v1;
    bool mirrored = false;
    found_.clear();
    if (line == (upper ? chart_size : 0)) {  // across the seam
      const Coordinate across = along_u ? info.v : info.u;
      if (!round(across)) continue;
      line = chart_size - line;
      if (across == Coordinate::twisted_turn) {
        mirrored = true;
        from = chart_size - std::exchange(to, chart_size - from);
      }
    }
    search({along_u, !upper, line, from, to, along_u ? step_u : step_v, mirrored});
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    patch.edge_counts[k] = static_cast<std::uint32_t>(found_.size());
    for (const std::uint32_t x : found_)
      plan_.edge_coordinates.push_back(std::ldexp(double(x), -finest_level));
  }
}

// A tile of an instance: the samples of a patch that is there already, or of a new one.
void ScenePlanner::Planner::add(std::uint32_t instance, ScenePatch patch) {
  const auto coordinates = [&](const ScenePatch& p) {
    return std::span<const double>(plan_.edge_coordinates).subspan(p.first_edge_coordinate, edge_samples(p));
  };
  std::uint32_t found = static_cast<std::uint32_t>(plan_.patches.size());
  std::uint32_t hash = 0;
  if (request_.skip.duplicates) {
    std::uint64_t h = 0;
    const auto mix = [&](std::uint64_t x) {
      h = (h ^ x) * 0x9E3779B97F4A7C15u;
      h ^= h >> 32;
    };
    mix(std::uint64_t{patch.surface} << 32 | patch.column);
    mix(std::uint64_t{patch.row} << 32 | std::uint64_t{patch.level_u} << 24 |
        std::uint64_t{patch.level_v} << 16 | patch.cells_u);
    mix(std::uint64_t{patch.cells_v} << 32 | edge_samples(patch));
    for (const double x : coordinates(patch)) mix(std::bit_cast<std::uint64_t>(x));
    hash = static_cast<std::uint32_t>(h >> 32);
    known_patches_.any_of(hash, [&](std::uint32_t i) {
      const ScenePatch& p = plan_.patches[i];
      const bool same = p.surface == patch.surface && p.level_u == patch.level_u &&
                        p.level_v == patch.level_v && p.cells_u == patch.cells_u &&
                        p.cells_v == patch.cells_v && p.column == patch.column && p.row == patch.row &&
                        p.attributes == patch.attributes && p.edge_counts == patch.edge_counts &&
                        std::ranges::equal(coordinates(p), coordinates(patch));
      if (same) found = i;
      return same;
    });
  }
  if (found == plan_.patches.size()) {
    if (request_.skip.duplicates) known_patches_.insert(hash, found);
    plan_.patches.push_back(patch);
  } else {
    ++plan_.skipped.duplicates;
    plan_.edge_coordinates.resize(patch.first_edge_coordinate);
  }
  constexpr std::size_t most = std::size_t{1} << 24;
  if (plan_.tiles.size() == most || plan_.edge_coordinates.size() > 4 * most)
    throw ParameterError("scene", "expected bounds that at most " + std::to_string(most) +
                                      " tiles keep, got smaller ones: ask for a larger chord or angle");
  ++plan_.patches[found].tile_count;
  plan_.tiles.push_back({instance, found});
}

ScenePlan ScenePlanner::Planner::plan(const Camera& camera) {
  camera.check();
  view_ = View(camera);
  plan_ = {};
  known_patches_ = {};
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) plan_instance(i);
  plan_.tiles_needed = plan_.patches.size();
  std::uint32_t next = 0;
  for (ScenePatch& patch : plan_.patches) {
    patch.first_tile = next;
    next += patch.tile_count;
    const std::uint64_t samples = sample_count(patch, plan_.edge_coordinates);
    plan_.samples_needed += samples;
    for (std::size_t a = 0; a < attribute_count; ++a)
      if (patch.attributes.has(static_cast<Attribute>(a))) plan_.attribute_samples[a] += samples;
  }
  // By patch, in the order of the instances.
  std::vector<PlannedTile> sorted(plan_.tiles.size());
  std::vector<std::uint32_t> place(plan_.patches.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = plan_.patches[i].first_tile;
  for (const PlannedTile& tile : plan_.tiles) sorted[place[tile.patch]++] = tile;
  plan_.tiles = std::move(sorted);
  return std::move(plan_);
}

ScenePlanner::ScenePlanner(const Scene& scene, const SceneRequest& request)
    : planner_(std::make_unique<Planner>(scene, request)) {}
ScenePlanner::ScenePlanner(ScenePlanner&&) noexcept = default;
ScenePlanner& ScenePlanner::operator=(ScenePlanner&&) noexcept = default;
ScenePlanner::~ScenePlanner() = default;

ScenePlan ScenePlanner::plan(const Camera& camera) {
  return planner_->plan(camera);
}

ScenePlan plan_scene(const Scene& scene, const Camera& camera, const SceneRequest& request) {
  return ScenePlanner(scene, request).plan(camera);
}

}  // namespace darboux
