// Occlusion culling: finds what is hidden behind opaque surfaces that are drawn.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/scene.h>

#include "surface_tiles.h"

namespace darboux {

// A depth buffer of cells: in every point of a cell, something opaque is drawn at the depth of the cell or
// nearer. This holds for the triangles and for the surface itself.
//
// Only the parts of a chart that face the camera with a margin, beyond the near plane, are used. The winding
// number of their projected border about a cell is the degree of the projection: the number of times they
// cover each point of the cell, with sign. As no part faces away, a non-zero degree means that something is
// drawn there. Border and depths are known from samples within the chord bound; any cell within that distance
// counts as not covered. The argument holds for any continuous surface near these samples, hence for the true
// surface and for the triangles of a plan.
class Occlusion {
 public:
  explicit Occlusion(const Camera& camera);

  // A bounding sphere of an instance, in front of the camera.
  struct Ball {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius = 0;
  };
  // Its approximate projected radius, in cells.
  double size_of(const Ball& ball) const;

  // A part of a chart that is drawn with cells of this size, each a power of two.
  struct Drawn {
    TilePlace place;
    TileLevels cells;
  };
  struct Occluder {
    const SceneInstance& instance;
    const SurfaceTiles& tiles;
    bool double_sided;
    Ball ball;
    double largest;  // largest scale factor of the placement
    std::span<const Drawn> drawn;
  };
  // False without proven bounds of chords and normals, or if the instance is too flat.
  static bool can_hide(const SurfaceTiles& tiles, const Eigen::Affine3d& placement);
  // \param occluder one for which can_hide() is true. Cost: about 30 us, with up to 33 x 17 samples.
  void add(const Occluder& occluder);
  void finish();  // call after the last add(): makes queries faster

  // From the space of an instance to that of the camera, with z the depth.
  struct OfCamera {
    OfCamera(const Occlusion& view, const Eigen::Affine3d& placement);
    Eigen::Matrix3d matrix;
    Eigen::Vector3d offset;
    double lengths;  // that are rounded
  };
  // Whether there are no occluders; whether a ball, or a box in the space of an instance, is entirely hidden.
  bool empty() const { return !(nearest_ < std::numeric_limits<double>::infinity()); }
  bool hides(const Ball& ball) const;
  bool hides(const OfCamera& of_camera, const Vec3<double>& lo, const Vec3<double>& hi) const;
  // Whether parts of the content of this ball may be hidden. A heuristic: a wrong answer costs only time.
  bool may_hide_of(const Ball& ball) const;

 private:
  struct Range {
    int x0, x1, y0, y1;  // cells, ends exclusive
  };
  struct Seen {
    double x, y, depth;  // in cells, and a length
  };
  Seen see(const Eigen::Vector3d& of_camera) const;
  // Cells that a rectangle touches.
  Range range(double x0, double x1, double y0, double y1) const;
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * columns_ + x); }
  double depth(int x, int y) const { return depths_.front()[index(x, y)]; }
  bool hides(const Range& cells, double nearest) const;
  bool hides(int level, int x, int y, const Range& within, double nearest) const;
  Range range(const Eigen::Vector3d& middle, const Eigen::Vector3d& half) const;
  Eigen::Vector3d half_of(const Ball& ball) const;
  bool hides_box(const Eigen::Vector3d& middle, const Eigen::Vector3d& half) const;

  bool perspective_;
  int columns_, rows_;
  double scale_x_, scale_y_;  // cells per length, of a perspective camera at unit depth
  double stretch_, near_;
  Eigen::Vector3d eye_;
  Eigen::Matrix3d to_camera_;
  // Depth per cell and, after finish(), a pyramid in which each level has the farthest depth of 2 x 2 cells
  // of the level below.
  static constexpr int most_levels = 6;
  int levels_ = 1;
  std::array<std::vector<double>, most_levels> depths_;
  double nearest_ = std::numeric_limits<double>::infinity();  // of these

  // A grid over the chart of the occluder that is being added.
  struct Cell {
    double drawn = 0;           // the share of it that is
    TileLevels finest{64, 64};  // at least so fine, in powers of two of the chart
    enum : std::uint8_t { neither, front, back } side = neither;  // of those that count, all of it
    double depth = 0;                                             // the largest
    double error_x = 0, error_y = 0;  // how far from it what it stands for may be seen, in cells of the view
    Range range{};
  };
  void find_drawn(std::span<const Drawn> drawn, const TileLevels& levels);
  void find_sides(const Occluder& occluder, const TileLevels& levels);
  std::size_t corner(int i, int k) const;
  void cover(std::uint8_t side);
  void mark(const Seen& from, const Seen& to, const Cell& cell, const Range& within);
  int cells_u_ = 0, cells_v_ = 0;
  bool round_u_ = false, round_v_ = false;
  std::vector<double> positions_, normals_, facing_, away_;  // at corners of cells
  std::vector<Seen> seen_;
  std::vector<Cell> cells_;
  // Of the cells of the view.
  std::vector<double> farthest_;
  std::vector<std::int32_t> windings_;
  std::vector<std::uint8_t> touched_;
};

}  // namespace darboux
