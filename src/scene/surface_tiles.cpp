#include "surface_tiles.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace darboux {
namespace {

constexpr double TileRates::*every_rate[] = {
    &TileRates::position_uu, &TileRates::position_uv, &TileRates::position_vv, &TileRates::frame_u,
    &TileRates::frame_v,     &TileRates::normal_u,    &TileRates::normal_v,    &TileRates::normal_uu,
    &TileRates::normal_uv,   &TileRates::normal_vv,   &TileRates::frame_uu,    &TileRates::frame_uv,
    &TileRates::frame_vv};

// The larger of the finite ones, each by itself.
void take_larger(TileRates& a, const TileRates& b) {
  for (double TileRates::*rate : every_rate)
    if (std::isfinite(b.*rate) && !(a.*rate >= b.*rate && std::isfinite(a.*rate))) a.*rate = b.*rate;
}

// Estimates in place of larger bounds, as those next to poles and those on intervals over large tiles.
// Whether there were some.
bool take_estimates(TileRates& bounds, const TileRates& estimates) {
  bool some = false;
  for (double TileRates::*rate : every_rate) {
    constexpr double nothing = 1e-100;  // what rounding makes of 0
    if (bounds.*rate <= estimates.*rate + nothing) continue;
    bounds.*rate = estimates.*rate;
    some = true;
  }
  return some;
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
  sample();
  known_ = TileBounds(surface, Tile{}).known();
  if (known_)
    find_finest();
  else
    finest_ = sampled_;
  nodes_.push_back(make({}));
  const TileNode& whole = nodes_.front();
  centre_ = 0.5 * (whole.lo + whole.hi);
  radius_ = 0.5 * norm(whole.hi - whole.lo) * (1 + 0x1p-48);
}

// The largest rates over the chart. Bounds on intervals are loose over large tiles: those that bend most are
// cut, as long as that tells more.
void SurfaceTiles::find_finest() {
  struct Part {
    TileRates rates;
    TilePlace place;
    double bend() const {
      const TileRates& r = rates;
      return r.position_uu + 2 * r.position_uv + r.position_vv + r.frame_u + r.frame_v + r.frame_uu +
             2 * r.frame_uv + r.frame_vv;
    }
    bool operator<(const Part& other) const { return bend() < other.bend(); }
  };
  const auto part = [&](const TilePlace& place) {
    return Part{TileBounds(surface_, place.tile(), TileOrder::second).rates(), place};
  };
  constexpr int finest = 6;
  int left = 100;  // cuts
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
  const bool estimated = take_estimates(finest_, sampled_);
  complete_ = std::isfinite(open.front().bend()) && !estimated;
}

// From samples, half as much again: no bound, but as good a guess as any.
void SurfaceTiles::sample() {
  constexpr int places = 17;
  constexpr double h = 1.0 / 256, more = 1.5;
  TileRates most;
  for (int i = 0; i < places; ++i)
    for (int k = 0; k < places; ++k) {
      const double u = h + (1 - 2 * h) * i / (places - 1), v = h + (1 - 2 * h) * k / (places - 1);
      const Jet2<double> j = surface_.jet(u, v);
      if (i + k == 0) lo_ = hi_ = j.position;
      include(lo_, hi_, j.position);
      std::array<Frame<double>, 9> f;
      for (std::size_t n = 0; n < 9; ++n)
        f[n] = surface_.frame(u + h * (double(n % 3) - 1), v + h * (double(n / 3) - 1));
      TileRates here;
      const auto look = [&](Vec3<double> Frame<double>::*member, double& first_u, double& first_v, double& uu,
                            double& uv, double& vv) {
        const auto x = [&](std::size_t n) { return f[n].*member; };
        const auto across = [&](const Vec3<double>& d) { return more * norm(d - dot(d, x(4)) * x(4)); };
        const auto larger = [](double& a, double b) { a = std::isfinite(a) ? std::fmax(a, b) : b; };
        larger(first_u, more * norm(x(5) - x(3)) / (2 * h));
        larger(first_v, more * norm(x(7) - x(1)) / (2 * h));
        larger(uu, across(x(5) - 2.0 * x(4) + x(3)) / (h * h));
        larger(uv, across(x(8) - x(6) - x(2) + x(0)) / (4 * h * h));
        larger(vv, across(x(7) - 2.0 * x(4) + x(1)) / (h * h));
      };
      using F = Frame<double>;
      look(&F::n, here.normal_u, here.normal_v, here.normal_uu, here.normal_uv, here.normal_vv);
      for (Vec3<double> F::*member : {&F::t, &F::b, &F::n})
        look(member, here.frame_u, here.frame_v, here.frame_uu, here.frame_uv, here.frame_vv);
      here.position_uu = more * norm(j.d2pdu2);
      here.position_uv = more * norm(j.d2pduv);
      here.position_vv = more * norm(j.d2pdv2);
      take_larger(most, here);
    }
  const Vec3<double> margin = (more - 1) / 2 * (hi_ - lo_);
  lo_ = lo_ - margin;
  hi_ = hi_ + margin;
  // Angular velocities add those of two vectors.
  most.frame_u *= 2;
  most.frame_v *= 2;
  sampled_ = most;
}

TileNode SurfaceTiles::make(const TilePlace& place) const {
  if (!known_) return {place, TileBounds(surface_, Tile{1, 0, 0, 0}), finest_, false, lo_, hi_, {}, {}};
  const TileBounds bounds(surface_, place.tile(), TileOrder::second);
  const auto most = [&](double x, double y, double z) { return bounds.support({x, y, z}); };
  TileRates rates = bounds.rates();
  const bool proven = !take_estimates(rates, sampled_);
  return {place,
          bounds,
          rates,
          proven,
          {-most(-1, 0, 0), -most(0, -1, 0), -most(0, 0, -1)},
          {most(1, 0, 0), most(0, 1, 0), most(0, 0, 1)},
          {},
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
