// Polynomials through several neighbourhoods at once, a lane each: those of one, to the bit, on every
// instruction set.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/evaluate.h>
#include <darboux/local_jets.h>

#include "evaluate/kernels/dispatch.h"
#include "jet_patches.h"
#include "local_jets/batch.h"
#include "random.h"

namespace darboux::test::uv_jets_in_lanes_test {
namespace {

using kernels::UvNeighbours;

// All numbers of a jet; every NaN the same.
std::vector<std::uint64_t> bits(const UvJet& jet) {
  std::vector<std::uint64_t> result{static_cast<std::uint64_t>(jet.frame.status)};
  const auto add = [&](double x) {
    result.push_back(std::bit_cast<std::uint64_t>(std::isnan(x) ? std::nan("") : x));
  };
  const Jet2<double>& j = jet.jet;
  for (const Vec3<double>& a :
       {j.position, j.dpdu, j.dpdv, j.d2pdu2, j.d2pduv, j.d2pdv2, jet.frame.t, jet.frame.b, jet.frame.n})
    add(a.x), add(a.y), add(a.z);
  for (const double x : {jet.frame.handedness, jet.dpdu_error, jet.dpdv_error, jet.tangent_error,
                         jet.normal_error, jet.condition, jet.residual_rms})
    add(x);
  return result;
}

UvNeighbours neighbours(const Patch& patch) {
  static const std::vector<std::uint32_t> all = [] {
    std::vector<std::uint32_t> indices(1000);
    std::iota(indices.begin(), indices.end(), 0);
    return indices;
  }();
  EXPECT_LE(patch.points.size(), all.size());
  return {patch.uvs.data(), patch.points.data(), all.data(), patch.points.size(), patch.uv};
}

// Of several sizes and surfaces, so that lanes have rows of zeros; some across a seam.
std::vector<Patch> regular_patches(Random& random, std::size_t count) {
  std::vector<Patch> patches;
  for (std::size_t i = 0; i < count; ++i) {
    const AnySurface surface = make_surface(specifications[i % 3]);
    const auto n = static_cast<std::size_t>(random.uniform(24, 60));
    patches.push_back(random_patch(surface, random, n, 0.1));
    if (i % 2 == 0) add_noise(patches.back(), random, 1e-3);
    for (std::size_t k = i % 5; k < n && i % 5 > 2; k += 2)
      patches.back().uvs[k].x += 1, patches.back().uvs[k].y -= 2;
  }
  return patches;
}

// What needs a look of its own: each in one way.
std::vector<Patch> odd_patches(Random& random) {
  std::vector<Patch> patches = regular_patches(random, 11);
  const auto each_point = [&](std::size_t k, auto f) {
    for (std::size_t i = 0; i < patches[k].points.size(); ++i) f(patches[k].uvs[i], patches[k].points[i]);
  };
  patches[0].points.resize(1), patches[0].uvs.resize(1);
  patches[1].points.resize(5), patches[1].uvs.resize(5);
  patches[2].points.resize(15), patches[2].uvs.resize(15);  // too few to judge some degrees
  patches[3].points[7].y = std::nan("");
  patches[4].uvs[0].x = infinite;
  each_point(5, [](Vec2<double>&, Vec3<double>& p) { p = {1, 2, 3}; });
  each_point(6, [](Vec2<double>& uv, Vec3<double>&) { uv.y = 0.5; });
  each_point(7, [](Vec2<double>& uv, Vec3<double>&) { uv.y = uv.x; });
  each_point(8, [](Vec2<double>&, Vec3<double>& p) { p = 1e-200 * p; });
  each_point(9, [](Vec2<double>&, Vec3<double>& p) { p = 1e200 * p; });
  each_point(10, [](Vec2<double>&, Vec3<double>& p) { p.x = p.y = 0; });  // on a line: no normal
  return patches;
}

void expect_those_of_one(const std::vector<Patch>& patches) {
  std::vector<UvNeighbours> of;
  for (const Patch& patch : patches) of.push_back(neighbours(patch));
  for (const InstructionSet set : instruction_sets())
    for (int degree = 2; degree <= 4; ++degree)
      for (const bool periodic : {false, true}) {
        std::vector<UvJet> jets(of.size());
        uv_jets(of, degree, periodic, periodic, jets, set);
        for (std::size_t i = 0; i < of.size(); ++i)
          EXPECT_EQ(bits(jets[i]),
                    bits(uv_jet(patches[i].uvs, patches[i].points, patches[i].uv,
                                {.degree = degree, .u_periodic = periodic, .v_periodic = periodic})))
              << name_of(set) << ", degree " << degree << ", patch " << i;
      }
}

TEST(UvJetsInLanes, HaveTheBitsOfOne) {
  Random random(401);
  expect_those_of_one(regular_patches(random, 150));
}

TEST(UvJetsInLanes, HaveTheBitsOfOneAmongOddOnes) {
  Random random(402);
  expect_those_of_one(odd_patches(random));
  // Each odd one among regular ones.
  for (const Patch& odd : odd_patches(random)) {
    std::vector<Patch> patches = regular_patches(random, 9);
    patches[4] = odd;
    expect_those_of_one(patches);
    expect_those_of_one(std::vector<Patch>(19, odd));  // registers of nothing else
  }
}

TEST(UvJetsInLanes, AreUsed) {
  Random random(403);
  const std::vector<Patch> patches = regular_patches(random, 19);
  std::vector<UvNeighbours> of;
  for (const Patch& patch : patches) of.push_back(neighbours(patch));
  for (const InstructionSet set : instruction_sets()) {
    const kernels::UvJetTable* const table = kernels::find_uv_jets(set);
    EXPECT_EQ(table == nullptr, set == InstructionSet::points);
    if (table == nullptr) continue;
    for (const auto& jets_of_degree : table->of_degree) {
      std::vector<UvJet> jets(of.size());
      std::array<bool, 19> done{};
      jets_of_degree({of.data(), of.size(), false, false, jets.data(), done.data()});
      for (const bool x : done) EXPECT_TRUE(x) << name_of(set);
    }
  }
}

}  // namespace
}  // namespace darboux::test::uv_jets_in_lanes_test
