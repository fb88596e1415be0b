#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <darboux/error.h>
#include <darboux/scene.h>

#include "patch_layout.h"

namespace darboux {

Tile ScenePatch::tile() const {
  const double du = std::ldexp(1.0, -level_u), dv = std::ldexp(1.0, -level_v);
  return {column * du, (column + 1) * du, row * dv, (row + 1) * dv};
}

std::vector<SplitCell> split_cells(const ScenePatch& patch, std::span<const double> coordinates) {
  std::vector<SplitCell> result;
  const Tile t = patch.tile();
  std::uint32_t next = patch.first_edge_coordinate;
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const bool along_u = edge < 2;
    const double from = along_u ? t.u0 : t.v0;
    const double per_cell = along_u ? (t.u1 - t.u0) / patch.cells_u : (t.v1 - t.v0) / patch.cells_v;
    for (std::uint32_t i = 0; i < patch.edge_counts[edge]; ++i, ++next) {
      const auto cell = static_cast<std::uint32_t>((coordinates[next] - from) / per_cell);
      const std::uint32_t across = edge % 2 == 0 ? 0 : (along_u ? patch.cells_v : patch.cells_u) - 1u;
      const std::uint32_t column = along_u ? cell : across, row = along_u ? across : cell;
      auto found = std::find_if(result.begin(), result.end(),
                                [&](const SplitCell& c) { return c.column == column && c.row == row; });
      if (found == result.end()) found = result.insert(found, SplitCell{column, row, {}, {}});
      if (found->count[edge]++ == 0) found->first[edge] = next - patch.first_edge_coordinate;
    }
  }
  return result;
}

// The number of cells that split_cells() finds: cell numbers ascend along each edge, and corner cells are on
// two edges.
static std::size_t count_split_cells(const ScenePatch& patch, std::span<const double> coordinates) {
  if (patch.cells_u == 1 || patch.cells_v == 1) return split_cells(patch, coordinates).size();
  const Tile t = patch.tile();
  std::size_t count = 0;
  std::array<bool, 4> first{}, last{};
  const double* next = coordinates.data() + patch.first_edge_coordinate;
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const bool along_u = edge < 2;
    const std::uint32_t cells = along_u ? patch.cells_u : patch.cells_v;
    const double from = along_u ? t.u0 : t.v0, per_cell = ((along_u ? t.u1 : t.v1) - from) / cells;
    std::uint32_t before = cells;
    for (std::uint32_t i = 0; i < patch.edge_counts[edge]; ++i, ++next) {
      const auto cell = static_cast<std::uint32_t>((*next - from) / per_cell);
      count += cell != before;
      before = cell;
      first[edge] = first[edge] || cell == 0;
      last[edge] = last[edge] || cell + 1 == cells;
    }
  }
  return count - (first[0] && first[2]) - (last[0] && first[3]) - (first[1] && last[2]) -
         (last[1] && last[3]);
}

std::uint64_t sample_count(const ScenePatch& patch, std::span<const double> coordinates) {
  const std::uint64_t corners = (patch.cells_u + std::uint64_t{1}) * (patch.cells_v + std::uint64_t{1});
  return patch.plain() ? corners : corners + edge_samples(patch) + count_split_cells(patch, coordinates);
}

namespace {

// The first n elements of a buffer reused from tile to tile, without initialisation.
template <class T>
std::span<T> room(std::vector<T>& buffer, std::size_t n) {
  if (buffer.size() < n) buffer.resize(n);
  return std::span(buffer).first(n);
}

std::uint32_t* add_triangle(std::uint32_t* next, std::size_t a, std::size_t b, std::size_t c) {
  for (const std::size_t i : {a, b, c}) *next++ = static_cast<std::uint32_t>(i);
  return next;
}

// Two triangles for each cell that is not split.
std::uint32_t* add_triangles(std::uint32_t columns, std::uint32_t rows, const std::vector<bool>& is_split,
                             std::uint32_t* next) {
  const std::uint32_t width = columns + 1;
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      if (!is_split.empty() && is_split[std::size_t{row} * columns + column]) continue;
      const std::uint32_t a = row * width + column, b = a + 1, c = a + width + 1, d = a + width;
      for (const std::uint32_t i : {a, b, c, a, c, d}) *next++ = i;
    }
  return next;
}

// The samples of a patch beyond the corners of its cells, and its triangles: a fan around the centre of each
// cell that is split.
std::span<const std::uint32_t> add_split_cells(const ScenePatch& patch, std::span<const double> coordinates,
                                               std::vector<double>& uv, std::vector<std::uint32_t>& buffer) {
  const std::uint32_t columns = patch.cells_u, rows = patch.cells_v;
  const std::size_t width = std::size_t{columns} + 1, corners = width * (rows + 1);
  const Tile t = patch.tile();
  const auto add_uv = [&](double u, double v) {
    uv.push_back(u);
    uv.push_back(v);
  };
  std::size_t next = patch.first_edge_coordinate;
  for (std::size_t edge = 0; edge < 4; ++edge)
    for (std::uint32_t i = 0; i < patch.edge_counts[edge]; ++i, ++next) {
      const double x = coordinates[next];
      edge < 2 ? add_uv(x, edge == 0 ? t.v0 : t.v1) : add_uv(edge == 2 ? t.u0 : t.u1, x);
    }
  const double du = (t.u1 - t.u0) / columns, dv = (t.v1 - t.v0) / rows;
  std::vector<bool> is_split(std::size_t{columns} * rows);
  const std::vector<SplitCell> cells = split_cells(patch, coordinates);
  const std::size_t most = 2 * std::size_t{columns} * rows + 4 * cells.size() + edge_samples(patch);
  const std::span<std::uint32_t> triangles = room(buffer, 3 * most);
  std::uint32_t* end = triangles.data();
  for (const SplitCell& cell : cells) {
    is_split[std::size_t{cell.row} * columns + cell.column] = true;
    const std::size_t centre = corners + uv.size() / 2;
    add_uv(t.u0 + (cell.column + 0.5) * du, t.v0 + (cell.row + 0.5) * dv);
    // Around the border: ascending along v0 and u1, descending along v1 and u0.
    const std::size_t first = cell.row * width + cell.column;
    std::size_t last = first;
    const auto to = [&](std::size_t i) {
      end = add_triangle(end, centre, last, i);
      last = i;
    };
    const auto along = [&](std::size_t edge, bool rising) {
      for (std::uint32_t i = 0; i < cell.count[edge]; ++i)
        to(corners + cell.first[edge] + (rising ? i : cell.count[edge] - 1 - i));
    };
    along(0, true);
    to(first + 1);
    along(3, true);
    to(first + width + 1);
    along(1, false);
    to(first + width);
    along(2, false);
    to(first);
  }
  end = add_triangles(columns, rows, is_split, end);
  return triangles.first(static_cast<std::size_t>(end - triangles.data()));
}

}  // namespace

const TileSamples& TileEvaluator::evaluate(const ScenePatch& patch, const EvaluateOptions& options) {
  const auto refuse_other = [](std::size_t index, const char* of, std::size_t size) {
    throw ParameterError("scene", "expected the scene and the plan that the patch is of, got a patch of " +
                                      std::string(of) + " " + std::to_string(index) + " where there are " +
                                      std::to_string(size));
  };
  if (patch.surface >= scene_->surfaces.size())
    refuse_other(patch.surface, "surface", scene_->surfaces.size());
  if (const std::size_t end = std::size_t{patch.first_tile} + patch.tile_count; end > plan_->tiles.size())
    refuse_other(end, "tile", plan_->tiles.size());
  if (const std::size_t end = std::size_t{patch.first_edge_coordinate} + edge_samples(patch);
      !patch.plain() && end > plan_->edge_coordinates.size())
    refuse_other(end, "edge coordinate", plan_->edge_coordinates.size());
  TileSamples& s = samples_;
  s.patch_ = &patch;
  s.tiles_ = std::span(plan_->tiles).subspan(patch.first_tile, patch.tile_count);
  const std::uint32_t columns = patch.cells_u, rows = patch.cells_v;
  const std::size_t corners = (std::size_t{columns} + 1) * (rows + 1);
  const auto grid = Points<double>::part_of_grid(
      std::size_t{columns} << patch.level_u, std::size_t{rows} << patch.level_v,
      std::size_t{patch.column} * columns, columns, std::size_t{patch.row} * rows, rows);

  s.corners_ = grid;
  s.others_.clear();
  if (patch.plain()) {
    std::vector<std::uint32_t>& triangles = of_plain_[{columns, rows}];
    if (triangles.empty()) {
      triangles.resize(std::size_t{6} * columns * rows);
      add_triangles(columns, rows, {}, triangles.data());
    }
    s.triangles_ = triangles;
  } else {
    s.triangles_ = add_split_cells(patch, plan_->edge_coordinates, s.others_, triangles_);
  }

  const std::size_t size = corners + s.others_.size() / 2;
  std::size_t components = 0;
  for (std::size_t a = 0; a < attribute_count; ++a)
    if (patch.attributes.has(static_cast<Attribute>(a))) components += attribute_infos[a].components;
  double* next = room(memory_, components * size).data();
  s.status_ = room(status_, size);
  s.values_ = {};
  Outputs<double> on_corners, others;
  on_corners.status(s.status_.first(corners));
  others.status(s.status_.subspan(corners));
  for (std::size_t a = 0; a < attribute_count; ++a) {
    const auto attribute = static_cast<Attribute>(a);
    if (!patch.attributes.has(attribute)) continue;
    const std::size_t n = attribute_infos[a].components;
    s.values_[a] = next;
    on_corners.packed(attribute, {next, n * corners});
    others.packed(attribute, {next + n * corners, n * (size - corners)});
    next += n * size;
  }
  EvaluateOptions here = options;
  here.threads = 1;
  here.stores = Stores::cached;
  const AnySurface& surface = scene_->surfaces[patch.surface];
  surface.evaluate(grid, on_corners, here);
  if (size > corners)
    surface.evaluate(Points<double>::interleaved(std::span<const double>(s.others_)), others, here);
  return s;
}

}  // namespace darboux
