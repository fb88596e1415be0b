// Bounds of tiles of surfaces whose formulas can be evaluated in interval arithmetic.
#pragma once

#include <memory>

#include <darboux/tile_bounds.h>

#include "interval.h"

namespace darboux::tiles {

struct Enclosed {
  Jet2<Enclosure> jet;     // over the tile
  Vec3<Enclosure> normal;  // dpdu × dpdv
  Interval area;           // its length
  double side;             // sign by which the unit normal is multiplied to give n; 0: either
  bool smooth;             // dpdu and dpdv are continuous
  TileRates second;        // second derivatives of the frame, if requested
};

// Null for surfaces whose formulas do not support intervals, and if a formula would branch within the tile.
std::shared_ptr<const Enclosed> enclose(const AnySurface& surface, const Tile& tile, TileOrder order);

double enclosed_support(const Enclosed& s, const Vec3<double>& direction);
// An upper bound of n·E - offset·(n·P) over the tile, offset 1 for an eye, 0 for a direction.
double enclosed_facing(const Enclosed& s, const Vec3<double>& e, double offset);
TileRates enclosed_rates(const Enclosed& s);

}  // namespace darboux::tiles
