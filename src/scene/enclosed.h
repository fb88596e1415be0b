// Bounds of tiles of surfaces whose formulas run on intervals.
#pragma once

#include <optional>

#include <darboux/tile_bounds.h>

namespace darboux::tiles {

// Nothing for surfaces whose formulas do not, and where a formula would branch within the tile.
std::optional<Enclosed> enclose(const AnySurface& surface, const Tile& tile, TileOrder order);

double enclosed_support(const Enclosed& s, const Vec3<double>& direction);
// Of n·E - offset·(n·P), offset 1 for an eye, 0 for a direction.
double enclosed_facing(const Enclosed& s, const Vec3<double>& e, double offset);

TileRates enclosed_rates(const Enclosed& s);

}  // namespace darboux::tiles
