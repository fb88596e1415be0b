#include "surface_tiles.h"

#include <cmath>

namespace darboux {
namespace {

// Calls f(largest, one) for each pair of rates.
template <class F>
void for_each_rate(TileRates& a, const TileRates& b, F f) {
  f(a.position_uu, b.position_uu);
  f(a.position_uv, b.position_uv);
  f(a.position_vv, b.position_vv);
  f(a.frame_u, b.frame_u);
  f(a.frame_v, b.frame_v);
  f(a.frame_uu, b.frame_uu);
  f(a.frame_uv, b.frame_uv);
  f(a.frame_vv, b.frame_vv);
  f(a.normal_u, b.normal_u);
  f(a.normal_v, b.normal_v);
  f(a.normal_uu, b.normal_uu);
  f(a.normal_uv, b.normal_uv);
  f(a.normal_vv, b.normal_vv);
}

void take_larger(TileRates& a, const TileRates& b) {
  for_each_rate(a, b, [](double& largest, double one) {
    if (std::isfinite(one)) largest = std::fmax(largest, one);
  });
}

void include(Vec3<double>& lo, Vec3<double>& hi, const Vec3<double>& p) {
  lo = {std::fmin(lo.x, p.x), std::fmin(lo.y, p.y), std::fmin(lo.z, p.z)};
  hi = {std::fmax(hi.x, p.x), std::fmax(hi.y, p.y), std::fmax(hi.z, p.z)};
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

SurfaceTiles::SurfaceTiles(const AnySurface& surface) : surface_(surface) {
  known_ = TileBounds(surface, Tile{}).known();
  if (!known_) {
    estimate();
  } else {
    // Of an eighth each way, so that no more than the surroundings of singular points are without finite
    // rates.
    TilePlace place{3, 3, 0, 0};
    for (place.row = 0; place.row < 8; ++place.row)
      for (place.column = 0; place.column < 8; ++place.column)
        take_larger(finest_, tile_rates(surface_, place.tile()));
  }
  nodes_.push_back(make({}));
  const TileNode& whole = nodes_.front();
  centre_ = 0.5 * (whole.lo + whole.hi);
  radius_ = 0.5 * norm(whole.hi - whole.lo) * (1 + 0x1p-48);
}

// From samples, a quarter more: no bound, but as good a guess as any.
void SurfaceTiles::estimate() {
  constexpr int cells = 32;
  constexpr double more = 1.25;
  for (int i = 0; i <= cells; ++i)
    for (int k = 0; k <= cells; ++k) {
      const double u = double(i) / cells, v = double(k) / cells, step = 1.0 / 1024;
      const Jet2<double> j = surface_.jet(u, v);
      if (i + k == 0) lo_ = hi_ = j.position;
      include(lo_, hi_, j.position);
      TileRates here{};
      here.position_uu = more * norm(j.d2pdu2);
      here.position_uv = more * norm(j.d2pduv);
      here.position_vv = more * norm(j.d2pdv2);
      const Frame<double> f = surface_.frame(u, v),
                          along_u = surface_.frame(u < 0.5 ? u + step : u - step, v),
                          along_v = surface_.frame(u, v < 0.5 ? v + step : v - step);
      here.normal_u = more * norm(along_u.n - f.n) / step;
      here.normal_v = more * norm(along_v.n - f.n) / step;
      here.frame_u = here.normal_u + more * norm(along_u.t - f.t) / step;
      here.frame_v = here.normal_v + more * norm(along_v.t - f.t) / step;
      take_larger(finest_, here);
    }
  const Vec3<double> margin = (more - 1) / 2 * (hi_ - lo_);
  lo_ = lo_ - margin;
  hi_ = hi_ + margin;
  finest_.normal_uu = finest_.normal_uv = finest_.normal_vv = std::numeric_limits<double>::infinity();
  finest_.frame_uu = finest_.frame_uv = finest_.frame_vv = std::numeric_limits<double>::infinity();
}

TileNode SurfaceTiles::make(const TilePlace& place) const {
  if (!known_) return {place, TileBounds(surface_, {1, 0, 0, 0}), finest_, lo_, hi_, {}};
  const Tile tile = place.tile();
  const TileBounds bounds(surface_, tile);
  const auto most = [&](double x, double y, double z) { return bounds.support({x, y, z}); };
  return {place,
          bounds,
          tile_rates(surface_, tile),
          {-most(-1, 0, 0), -most(0, -1, 0), -most(0, 0, -1)},
          {most(1, 0, 0), most(0, 1, 0), most(0, 0, 1)},
          {}};
}

std::uint32_t SurfaceTiles::parts(std::uint32_t node, Split split) {
  const auto which = static_cast<std::size_t>(split);
  if (nodes_[node].parts[which] == 0) {
    const TilePlace place = nodes_[node].place;
    const bool along_u = split != Split::v, along_v = split != Split::u;
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    for (std::uint32_t k = 0; k < (along_v ? 2u : 1u); ++k)
      for (std::uint32_t i = 0; i < (along_u ? 2u : 1u); ++i)
        nodes_.push_back(make(place.half(along_u, along_v, i, k)));
    nodes_[node].parts[which] = first;
  }
  return nodes_[node].parts[which];
}

}  // namespace darboux
