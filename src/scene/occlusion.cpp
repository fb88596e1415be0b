#include "occlusion.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace darboux {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int view_columns = 128;
// Levels of the grid over a chart.
constexpr TileLevels fewest{3, 3}, most{5, 4};
// Larger than all rounding errors, of lengths and of positions in cells.
constexpr double rounding = 0x1p-40, cell_rounding = 0x1p-20;
// Beyond, positions are not exact enough.
constexpr double farthest_cell = 1e6;

double share_of(int level) {
  return std::ldexp(1.0, -level);
}

double dot3(const Eigen::Vector3d& a, const double* b) {
  return a.x() * b[0] + a.y() * b[1] + a.z() * b[2];
}

}  // namespace

Occlusion::Occlusion(const Camera& camera)
    : perspective_(camera.projection == Camera::Projection::perspective),
      columns_(view_columns),
      near_(camera.near_distance),
      eye_(camera.pose.translation()),
      to_camera_(camera.pose.linear().transpose()) {
  const double aspect = double(camera.width_px) / camera.height_px,
               half_y =
                   perspective_ ? std::tan(camera.vertical_field_of_view_rad / 2) : camera.view_height / 2,
               half_x = half_y * aspect;
  rows_ = std::clamp(static_cast<int>(std::lround(view_columns / aspect)), 1, 2 * view_columns);
  scale_x_ = columns_ / (2 * half_x);
  scale_y_ = rows_ / (2 * half_y);
  stretch_ = perspective_ ? std::sqrt(1 + half_x * half_x + half_y * half_y) : 1;
  to_camera_.row(2) *= -1;
}

Occlusion::Seen Occlusion::see(const Eigen::Vector3d& p) const {
  const double w = perspective_ ? 1 / p.z() : 1;
  return {0.5 * columns_ + scale_x_ * p.x() * w, 0.5 * rows_ + scale_y_ * p.y() * w, p.z()};
}

Occlusion::Range Occlusion::range(double x0, double x1, double y0, double y1) const {
  const auto first = [](double x, int size) { return x <= 0 ? 0 : x < size ? static_cast<int>(x) : size; };
  const auto last = [](double x, int size) { return x < 0 ? 0 : x < size ? static_cast<int>(x) + 1 : size; };
  return {first(x0, columns_), last(x1, columns_), first(y0, rows_), last(y1, rows_)};
}

double Occlusion::size_of(const Ball& ball) const {
  const double scale = std::max(scale_x_, scale_y_);
  return ball.radius * (perspective_ ? scale / std::max(near_, (ball.centre - eye_).norm()) : scale);
}

void Occlusion::finish() {
  if (empty()) return;
  for (int level = 1; level < most_levels; ++level) {
    const auto size = [](int n, int levels) { return ((n - 1) >> levels) + 1; };
    const int columns = size(columns_, level), rows = size(rows_, level), below = size(columns_, level - 1),
              rows_below = size(rows_, level - 1);
    const std::vector<double>& from = depths_[static_cast<std::size_t>(level - 1)];
    std::vector<double>& to = depths_[static_cast<std::size_t>(level)];
    to.assign(static_cast<std::size_t>(columns * rows), -infinity);
    for (int y = 0; y < rows_below; ++y)
      for (int x = 0; x < below; ++x) {
        double& farthest = to[static_cast<std::size_t>((y >> 1) * columns + (x >> 1))];
        farthest = std::max(farthest, from[static_cast<std::size_t>(y * below + x)]);
      }
  }
  levels_ = most_levels;
}

// Whether cell (x, y) of a level hides everything beyond `nearest`, within a range of finest cells.
bool Occlusion::hides(int level, int x, int y, const Range& r, double nearest) const {
  const auto columns = static_cast<std::size_t>(((columns_ - 1) >> level) + 1);
  if (depths_[static_cast<std::size_t>(level)]
             [static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)] < nearest)
    return true;
  if (level == 0) return false;
  const int half = 1 << (level - 1);
  for (int b = 2 * y; b < 2 * y + 2; ++b)
    for (int a = 2 * x; a < 2 * x + 2; ++a)
      if (a * half < r.x1 && (a + 1) * half > r.x0 && b * half < r.y1 && (b + 1) * half > r.y0 &&
          !hides(level - 1, a, b, r, nearest))
        return false;
  return true;
}

bool Occlusion::hides(const Range& r, double nearest) const {
  if (r.x0 >= r.x1 || r.y0 >= r.y1) return false;
  const int level =
      std::min(levels_,
               static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(r.x1 - r.x0, r.y1 - r.y0))))) -
      1;
  for (int y = r.y0 >> level; y << level < r.y1; ++y)
    for (int x = r.x0 >> level; x << level < r.x1; ++x)
      if (!hides(level, x, y, r, nearest)) return false;
  return true;
}

// A box along the axes of the camera. Empty where its depth is not positive.
Occlusion::Range Occlusion::range(const Eigen::Vector3d& c, const Eigen::Vector3d& half) const {
  if (perspective_ && !(c.z() - half.z() > 0)) return {};
  const double of_nearest = perspective_ ? 1 / (c.z() - half.z()) : 1,
               of_farthest = perspective_ ? 1 / (c.z() + half.z()) : 1;
  const auto least = [&](double x) { return x * (x < 0 ? of_nearest : of_farthest); };
  const auto greatest = [&](double x) { return x * (x > 0 ? of_nearest : of_farthest); };
  return range(0.5 * columns_ + scale_x_ * least(c.x() - half.x()) - cell_rounding,
               0.5 * columns_ + scale_x_ * greatest(c.x() + half.x()) + cell_rounding,
               0.5 * rows_ + scale_y_ * least(c.y() - half.y()) - cell_rounding,
               0.5 * rows_ + scale_y_ * greatest(c.y() + half.y()) + cell_rounding);
}

Eigen::Vector3d Occlusion::half_of(const Ball& ball) const {
  const double r =
      ball.radius + rounding * (ball.centre.cwiseAbs().sum() + eye_.cwiseAbs().sum() + ball.radius);
  return {r, r, r};
}

bool Occlusion::hides_box(const Eigen::Vector3d& middle, const Eigen::Vector3d& half) const {
  const double least = middle.z() - half.z();
  return nearest_ < least && hides(range(middle, half), least);
}

bool Occlusion::hides(const Ball& ball) const {
  return hides_box(to_camera_ * (ball.centre - eye_), half_of(ball));
}

bool Occlusion::may_hide_of(const Ball& ball) const {
  const Eigen::Vector3d middle = to_camera_ * (ball.centre - eye_);
  const double most = middle.z() + ball.radius;
  const Range r = range(middle, half_of(ball));
  if (!(nearest_ < most) || r.x0 >= r.x1 || r.y0 >= r.y1) return false;
  for (const int y : {r.y0, (r.y0 + r.y1) / 2, r.y1 - 1})
    for (const int x : {r.x0, (r.x0 + r.x1) / 2, r.x1 - 1})
      if (depth(x, y) < most) return true;
  return false;
}

Occlusion::OfCamera::OfCamera(const Occlusion& view, const Eigen::Affine3d& placement)
    : matrix(view.to_camera_ * placement.linear()),
      offset(view.to_camera_ * (placement.translation() - view.eye_)),
      lengths(placement.translation().norm() + view.eye_.norm()) {}

bool Occlusion::hides(const OfCamera& to, const Vec3<double>& lo, const Vec3<double>& hi) const {
  const Eigen::Vector3d middle = to.matrix * to_eigen(0.5 * (lo + hi)) + to.offset,
                        half = to.matrix.cwiseAbs() * to_eigen(0.5 * (hi - lo));
  const double rounded = rounding * (to.lengths + middle.cwiseAbs().sum() + half.sum());
  return hides_box(middle, half.array() + rounded);
}

// ---- what hides -----------------------------------------------------------------------------------------

// The corner of a cell. Where the chart closes, the last is the first, so that borders are closed.
std::size_t Occlusion::corner(int i, int k) const {
  if (round_u_ && i == cells_u_) i = 0;
  if (round_v_ && k == cells_v_) k = 0;
  return static_cast<std::size_t>(k * (cells_u_ + 1) + i);
}

void Occlusion::find_drawn(std::span<const Drawn> drawn, const TileLevels& levels) {
  cells_.assign(static_cast<std::size_t>(cells_u_ * cells_v_), Cell{});
  for (const Drawn& d : drawn) {
    const int deeper_u = d.place.level_u - levels.u, deeper_v = d.place.level_v - levels.v;
    const auto first = [](std::uint32_t at, int deeper) {
      return static_cast<int>(deeper > 0 ? at >> deeper : at << -deeper);
    };
    const int i0 = first(d.place.column, deeper_u),
              i1 = deeper_u > 0 ? i0 + 1 : first(d.place.column + 1, deeper_u),
              k0 = first(d.place.row, deeper_v),
              k1 = deeper_v > 0 ? k0 + 1 : first(d.place.row + 1, deeper_v);
    const double share = share_of(std::max(deeper_u, 0) + std::max(deeper_v, 0));
    const TileLevels finest{d.place.level_u + d.cells.u, d.place.level_v + d.cells.v};
    for (int k = k0; k < k1; ++k)
      for (int i = i0; i < i1; ++i) {
        Cell& cell = cells_[static_cast<std::size_t>(k * cells_u_ + i)];
        cell.drawn += share;  // exact
        cell.finest = {std::min(cell.finest.u, finest.u), std::min(cell.finest.v, finest.v)};
      }
  }
}

// Determines whether a cell faces the camera, and its range in the view. n · (eye - P) changes by at most
// |dn| times the distance.
void Occlusion::find_sides(const Occluder& o, const TileLevels& levels) {
  const Eigen::Matrix3d& m = o.instance.placement.linear();
  const Eigen::Vector3d& t = o.instance.placement.translation();
  const Eigen::Matrix3d inverse = m.inverse(), of_camera = to_camera_ * m;
  const Eigen::Vector3d offset = to_camera_ * (t - eye_);
  // Towards the eye, in the surface's own space.
  const Eigen::Vector3d eye =
      inverse * (perspective_ ? Eigen::Vector3d(eye_ - t) : Eigen::Vector3d(-to_camera_.row(2)));
  const double from_eye =
      perspective_ ? (eye - to_eigen(o.tiles.centre())).norm() + o.tiles.radius() : eye.norm();
  const double lengths = perspective_ ? eye.norm() + from_eye : from_eye;
  for (std::size_t c = 0; c < seen_.size(); ++c) {
    const double* p = &positions_[3 * c];
    const double* n = &normals_[3 * c];
    away_[c] = perspective_ ? (eye - Eigen::Vector3d(p[0], p[1], p[2])).norm() : from_eye;
    facing_[c] = perspective_ ? dot3(eye, n) - (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) : dot3(eye, n);
    seen_[c] = see(of_camera * Eigen::Vector3d(p[0], p[1], p[2]) + offset);
  }
  const TileRates& rates = o.tiles.finest();
  const double du = share_of(levels.u), dv = share_of(levels.v), here = rates.chord(du, dv),
               rounded = rounding * (o.ball.centre.norm() + o.ball.radius + eye_.norm());
  TileLevels known{-1, -1};
  double error = 0, turning = 0;
  bool within = false;
  for (int k = 0; k < cells_v_; ++k)
    for (int i = 0; i < cells_u_; ++i) {
      Cell& cell = cells_[static_cast<std::size_t>(k * cells_u_ + i)];
      if (cell.drawn != 1) continue;
      if (!(cell.finest == known)) {
        known = cell.finest;
        const double drawn_u = share_of(known.u), drawn_v = share_of(known.v);
        error = o.largest * (here + rates.chord(drawn_u, drawn_v)) + rounded;
        // Over all corners of a drawn cell that reaches into this one.
        turning = rates.normal_u * (std::max(du, drawn_u) - du / 2) +
                  rates.normal_v * (std::max(dv, drawn_v) - dv / 2);
        within = drawn_u <= du && drawn_v <= dv;
      }
      double least_facing = infinity, most_facing = -infinity, least_depth = infinity, most_depth = -infinity;
      double x0 = infinity, x1 = -infinity, y0 = infinity, y1 = -infinity, away = 0;
      bool finite = true;
      for (const std::size_t c : {corner(i, k), corner(i + 1, k), corner(i, k + 1), corner(i + 1, k + 1)}) {
        const Seen& s = seen_[c];
        least_facing = std::min(least_facing, facing_[c]);
        most_facing = std::max(most_facing, facing_[c]);
        away = std::max(away, away_[c]);
        least_depth = std::min(least_depth, s.depth);
        most_depth = std::max(most_depth, s.depth);
        x0 = std::min(x0, s.x);
        x1 = std::max(x1, s.x);
        y0 = std::min(y0, s.y);
        y1 = std::max(y1, s.y);
        finite = finite && std::isfinite(facing_[c] + s.depth) && std::fabs(s.x) < farthest_cell &&
                 std::fabs(s.y) < farthest_cell;
      }
      // Beyond the far plane a cell could hide only what is beyond it, too.
      if (!finite || !(least_depth - 2 * error >= near_)) continue;
      const double change =
          turning * (within ? std::min(away + here, from_eye) : from_eye) + 0x1p-20 * lengths;
      if (least_facing > change)
        cell.side = Cell::front;
      else if (o.double_sided && most_facing < -change)
        cell.side = Cell::back;
      else
        continue;
      // A point seen at a depth z that moves by e appears to move by at most e s / (z - e).
      const double moved = error * stretch_ / (perspective_ ? least_depth - 2 * error : 1);
      cell.error_x = moved * scale_x_ + cell_rounding;
      cell.error_y = moved * scale_y_ + cell_rounding;
      cell.depth = most_depth + error;
      cell.range = range(x0 - cell.error_x, x1 + cell.error_x, y0 - cell.error_y, y1 + cell.error_y);
    }
}

bool Occlusion::can_hide(const SurfaceTiles& tiles, const Eigen::Affine3d& placement) {
  const SurfaceInfo& info = tiles.surface().info();
  const TileRates& rates = tiles.finest();
  const bool bounded = tiles.known() &&
                       (tiles.is_typical() || (tiles.proven().chord && tiles.proven().frame)) &&
                       std::isfinite(rates.chord(1, 1) + rates.normal_u + rates.normal_v);
  const Eigen::Matrix3d m = placement.linear();
  constexpr double most_condition = 1e6;  // facing is exact enough
  return bounded && info.u != Coordinate::twisted_turn && info.v != Coordinate::twisted_turn &&
         m.norm() * m.inverse().norm() < most_condition;
}

void Occlusion::add(const Occluder& o) {
  const SurfaceTiles& tiles = o.tiles;
  const SurfaceInfo& info = tiles.surface().info();
  const double depth = to_camera_.row(2).dot(o.ball.centre - eye_) - o.ball.radius;
  const double cell = (perspective_ ? std::max(near_, depth) : 1) / std::max(scale_x_, scale_y_);
  TileLevels levels = tiles.finest_chord_levels()(0.25 * cell / o.largest).levels;
  levels = {std::clamp(levels.u, fewest.u, most.u), std::clamp(levels.v, fewest.v, most.v)};
  cells_u_ = 1 << levels.u;
  cells_v_ = 1 << levels.v;
  round_u_ = info.u == Coordinate::turn;
  round_v_ = info.v == Coordinate::turn;
  const std::size_t corners = static_cast<std::size_t>((cells_u_ + 1) * (cells_v_ + 1));
  positions_.resize(3 * corners);
  normals_.resize(3 * corners);
  facing_.resize(corners);
  away_.resize(corners);
  seen_.resize(corners);
  Outputs<double> outputs;
  outputs.packed(Attribute::position, positions_).packed(Attribute::normal, normals_);
  tiles.surface().evaluate(
      Points<double>::grid(static_cast<std::size_t>(cells_u_), static_cast<std::size_t>(cells_v_)), outputs);
  find_drawn(o.drawn, levels);
  find_sides(o, levels);
  cover(Cell::front);
  if (o.double_sided) cover(Cell::back);
}

// Covers the border of the cells on one side, and its interior.
void Occlusion::cover(std::uint8_t side) {
  Range all{columns_, 0, rows_, 0};
  for (const Cell& cell : cells_)
    if (cell.side == side) {
      all.x0 = std::min(all.x0, cell.range.x0);
      all.x1 = std::max(all.x1, cell.range.x1);
      all.y0 = std::min(all.y0, cell.range.y0);
      all.y1 = std::max(all.y1, cell.range.y1);
    }
  if (all.x0 >= all.x1 || all.y0 >= all.y1) return;
  std::vector<double>& depths = depths_.front();
  if (depths.empty()) depths.assign(index(0, rows_), infinity);
  const std::size_t first = index(0, all.y0), count = index(0, all.y1) - first;
  const auto clear = [&](auto& values, auto value) {
    values.resize(depths.size() + 1);  // the end of the last row belongs to no column
    std::fill_n(&values[first], count, value);
  };
  clear(farthest_, -infinity);
  clear(windings_, std::int32_t{0});
  clear(touched_, std::uint8_t{0});
  for (int k = 0; k < cells_v_; ++k)
    for (int i = 0; i < cells_u_; ++i) {
      const Cell& cell = cells_[static_cast<std::size_t>(k * cells_u_ + i)];
      if (cell.side != side) continue;
      for (int y = cell.range.y0; y < cell.range.y1; ++y)
        for (int x = cell.range.x0; x < cell.range.x1; ++x) {
          double& farthest = farthest_[index(x, y)];
          farthest = std::max(farthest, cell.depth);
        }
      const auto same_side = [&](int a, int b) {
        if (round_u_) a = (a + cells_u_) % cells_u_;
        if (round_v_) b = (b + cells_v_) % cells_v_;
        return a >= 0 && a < cells_u_ && b >= 0 && b < cells_v_ &&
               cells_[static_cast<std::size_t>(b * cells_u_ + a)].side == side;
      };
      const Seen &p = seen_[corner(i, k)], &q = seen_[corner(i + 1, k)], &r = seen_[corner(i + 1, k + 1)],
                 &s = seen_[corner(i, k + 1)];
      if (!same_side(i, k - 1)) mark(p, q, cell, all);
      if (!same_side(i + 1, k)) mark(q, r, cell, all);
      if (!same_side(i, k + 1)) mark(r, s, cell, all);
      if (!same_side(i - 1, k)) mark(s, p, cell, all);
    }
  for (int y = all.y0; y < all.y1; ++y) {
    std::int32_t winding = 0;
    for (int x = all.x0; x < all.x1; ++x) {
      const std::size_t at = index(x, y);
      winding += windings_[at];
      if (winding == 0 || touched_[at]) continue;
      depths[at] = std::min(depths[at], farthest_[at]);
      nearest_ = std::min(nearest_, depths[at]);
    }
  }
}

// Marks a segment of a border: the cells that it may touch, and where it crosses the middles of rows.
void Occlusion::mark(const Seen& from, const Seen& to, const Cell& cell, const Range& within) {
  const double low = std::min(from.y, to.y), high = std::max(from.y, to.y);
  const auto at = [&](double y) {
    return high > low ? from.x + (y - from.y) / (to.y - from.y) * (to.x - from.x) : from.x;
  };
  const Range rows = range(0, 0, low - cell.error_y, high + cell.error_y);
  for (int y = std::max(rows.y0, within.y0); y < std::min(rows.y1, within.y1); ++y) {
    // Of the part of it that is so near to this row.
    const double x0 = at(std::clamp(y - cell.error_y, low, high)),
                 x1 = high > low ? at(std::clamp(y + 1 + cell.error_y, low, high)) : to.x;
    const Range columns = range(std::min(x0, x1) - cell.error_x, std::max(x0, x1) + cell.error_x, 0, 0);
    std::fill_n(&touched_[index(columns.x0, y)], columns.x1 - columns.x0, std::uint8_t{1});
    const double middle = y + 0.5;
    if ((from.y <= middle) == (to.y <= middle)) continue;
    const double x = std::max(std::floor(at(middle) + 0.5), double(within.x0));
    if (x < within.x1) windings_[index(static_cast<int>(x), y)] += to.y > from.y ? 1 : -1;
  }
}

}  // namespace darboux
