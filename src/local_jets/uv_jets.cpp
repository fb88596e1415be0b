// Polynomials P(u, v) through the neighbours of several points at once, a point per lane; compiled once per
// instruction set, which DARBOUX_ISA names. Everything but the table has internal linkage.
#include "uv_jets.h"

#include <cmath>
#include <vector>

#include "evaluate/kernels/lanes.h"
#include "uv_fit.h"

namespace darboux::kernels {
namespace {

using S = Lanes<double>;
constexpr std::size_t W = S::lanes;

struct alignas(64) Tile {
  double of[W];
  operator S() const { return S::load(of); }  // NOLINT: converting
};
// A neighbour of each lane's point, relative to it.
struct Row {
  Tile root_of_weight, u, v, x, y, z;
};

double nearest_period(double x, bool periodic) {
  return periodic ? x - std::round(x) : x;
}

// A member over lanes, and the destination of each lane's.
template <class From, class To>
struct Member {
  From from;
  To to;
};

// Writes a number of each lane to its place in the results.
template <class Place>
void put(const UvJetWork& work, std::size_t first, const S& value, const Place& place) {
  Tile tile;
  value.store(tile.of);
  for (std::size_t k = 0; k < W && first + k < work.count; ++k) place(work.results[first + k]) = tile.of[k];
}
template <class Place>
void put(const UvJetWork& work, std::size_t first, const Vec3<S>& value, const Place& place) {
  put(work, first, value.x, [&](UvJet& jet) -> double& { return place(jet).x; });
  put(work, first, value.y, [&](UvJet& jet) -> double& { return place(jet).y; });
  put(work, first, value.z, [&](UvJet& jet) -> double& { return place(jet).z; });
}

// All of it, regular.
void put(const UvJetWork& work, std::size_t first, const UvFitResult<S>& result) {
  using From = Jet2<S>;
  using To = Jet2<double>;
  constexpr Member<Vec3<S> From::*, Vec3<double> To::*> of_jet[] = {
      {&From::position, &To::position}, {&From::dpdu, &To::dpdu},     {&From::dpdv, &To::dpdv},
      {&From::d2pdu2, &To::d2pdu2},     {&From::d2pduv, &To::d2pduv}, {&From::d2pdv2, &To::d2pdv2}};
  for (const auto& m : of_jet)
    put(work, first, result.jet.*m.from, [&m](UvJet& jet) -> Vec3<double>& { return jet.jet.*m.to; });
  constexpr Member<Vec3<S> Frame<S>::*, Vec3<double> Frame<double>::*> of_frame[] = {
      {&Frame<S>::t, &Frame<double>::t},
      {&Frame<S>::b, &Frame<double>::b},
      {&Frame<S>::n, &Frame<double>::n}};
  for (const auto& m : of_frame)
    put(work, first, result.frame.*m.from, [&m](UvJet& jet) -> Vec3<double>& { return jet.frame.*m.to; });
  using R = UvFitResult<S>;
  constexpr Member<S R::*, double UvJet::*> numbers[] = {
      {&R::dpdu_error, &UvJet::dpdu_error},       {&R::dpdv_error, &UvJet::dpdv_error},
      {&R::tangent_error, &UvJet::tangent_error}, {&R::normal_error, &UvJet::normal_error},
      {&R::condition, &UvJet::condition},         {&R::residual_rms, &UvJet::residual_rms}};
  for (const auto& m : numbers)
    put(work, first, result.*m.from, [&m](UvJet& jet) -> double& { return jet.*m.to; });
  for (std::size_t k = 0; k < W && first + k < work.count; ++k) {
    work.results[first + k].frame.handedness = 1;
    work.results[first + k].frame.status = Status::regular;
  }
}

template <int degree>
DARBOUX_FLATTEN void uv_jets(const UvJetWork& work) {
  UvFit<degree, S> fit;
  std::vector<Row> rows;
  for (std::size_t first = 0; first < work.count; first += W) {
    const UvNeighbours* of[W];  // missing ones at the end repeat the first
    Tile count, origin[3];
    std::size_t most = 0;
    for (std::size_t k = 0; k < W; ++k) {
      of[k] = work.of + (first + k < work.count ? first + k : first);
      most = of[k]->count > most ? of[k]->count : most;
      count.of[k] = static_cast<double>(of[k]->count);
      const Vec3<double>& p = of[k]->positions[of[k]->near[0]];
      origin[0].of[k] = p.x, origin[1].of[k] = p.y, origin[2].of[k] = p.z;
    }
    // Lane by lane, and all before any is read: loading a register just after its parts were stored is slow.
    rows.resize(most);
    for (std::size_t k = 0; k < W; ++k) {
      const UvNeighbours& n = *of[k];
      for (std::size_t i = 0; i < n.count; ++i) {
        const Vec2<double>& uv = n.uvs[n.near[i]];
        const Vec3<double>& p = n.positions[n.near[i]];
        rows[i].root_of_weight.of[k] = 1;
        rows[i].u.of[k] = nearest_period(uv.x - n.at.x, work.u_periodic);
        rows[i].v.of[k] = nearest_period(uv.y - n.at.y, work.v_periodic);
        rows[i].x.of[k] = p.x - origin[0].of[k];
        rows[i].y.of[k] = p.y - origin[1].of[k];
        rows[i].z.of[k] = p.z - origin[2].of[k];
      }
      for (std::size_t i = n.count; i < most; ++i)
        for (Tile Row::*const column : {&Row::root_of_weight, &Row::u, &Row::v, &Row::x, &Row::y, &Row::z})
          (rows[i].*column).of[k] = 0;
    }
    auto* const given = fit.resize(most);
    for (std::size_t i = 0; i < most; ++i) {
      const Row& row = rows[i];
      given[i] = {row.root_of_weight, row.u, row.v, {row.x, row.y, row.z}};
    }
    diverged = false;
    UvFitResult<S> result = fit.solve(count, count);
    result.jet.position = result.jet.position + Vec3<S>{origin[0], origin[1], origin[2]};
    const bool good =
        (result.sized > S(0) && result.condition < S(UvFit<degree, S>::Fit::worst_condition)).all() &&
        !diverged;
    for (std::size_t k = 0; k < W && first + k < work.count; ++k) work.done[first + k] = good;
    if (good) put(work, first, result);
  }
}

}  // namespace

#define DARBOUX_TABLE_(isa) uv_jet_table_##isa
#define DARBOUX_TABLE(isa) DARBOUX_TABLE_(isa)
extern const UvJetTable DARBOUX_TABLE(DARBOUX_ISA);
constinit const UvJetTable DARBOUX_TABLE(DARBOUX_ISA){{&uv_jets<2>, &uv_jets<3>, &uv_jets<4>}};

}  // namespace darboux::kernels
