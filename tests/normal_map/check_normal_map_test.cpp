// What a map tells of itself: which way green points, above all; and how far two maps are apart.
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <darboux/check_normal_map.h>
#include <darboux/error.h>

#include "map_meshes.h"
#include "refusal_of.h"

namespace darboux::test::check_normal_map_test {
namespace {

// The slopes h_u and h_w, w up the image, at texel (x, y).
using Slope = std::function<std::array<double, 2>(double, double)>;

Image map_of(int size, const Slope& slope, MapGreen green, SampleType type = SampleType::u8,
             bool swapped = false) {
  Image image(size, size, 3, type);
  const double most = type == SampleType::u8 ? 255 : 65535;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto [p, q] = slope(x + 0.5, -(y + 0.5));
      const double length = std::sqrt(1 + p * p + q * q);
      std::array<double, 3> n{-p / length, (green == MapGreen::directx ? q : -q) / length, 1 / length};
      if (swapped) std::swap(n[0], n[1]);
      for (std::size_t c = 0; c < 3; ++c)
        std::visit(
            [&](auto& s) {
              s[static_cast<std::size_t>(3 * (y * size + x)) + c] =
                  static_cast<typename std::remove_reference_t<decltype(s)>::value_type>(
                      std::floor((n[c] + 1) / 2 * most + 0.5));
            },
            image.samples);
    }
  return image;
}

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// Heights: waves of any direction, round bumps and saddles, of sizes from 8 texels to the whole map.
Slope random_relief(std::mt19937_64& random, int size) {
  struct Wave {
    double a, ku, kw, phase;
  };
  struct Bump {
    double height, u, w, radius;
  };
  std::vector<Wave> waves;
  std::vector<Bump> bumps;
  const int kind = static_cast<int>(random() % 3);
  const auto length = [&] { return std::exp(uniform(random, std::log(8.0), std::log(1.0 * size))); };
  for (int i = 0; kind != 1 && i < 2 + static_cast<int>(random() % 12); ++i) {
    const double k = 2 * M_PI / length(), direction = uniform(random, 0, 2 * M_PI);
    waves.push_back({uniform(random, 0.02, 0.3) / k, k * std::cos(direction), k * std::sin(direction),
                     uniform(random, 0, 2 * M_PI)});
  }
  for (int i = 0; kind != 0 && i < 3 + static_cast<int>(random() % 20); ++i) {
    const double radius = length() / 2;
    bumps.push_back(
        {uniform(random, -0.5, 0.5) * radius, uniform(random, 0, size), uniform(random, -size, 0), radius});
  }
  return [=](double u, double w) {
    std::array<double, 2> slope{};
    for (const Wave& v : waves) {
      const double c = v.a * std::cos(v.ku * u + v.kw * w + v.phase);
      slope[0] += c * v.ku;
      slope[1] += c * v.kw;
    }
    for (const Bump& b : bumps) {
      const double du = (u - b.u) / b.radius, dw = (w - b.w) / b.radius;
      const double g = -2 * b.height / b.radius * std::exp(-du * du - dw * dw);
      slope[0] += g * du;
      slope[1] += g * dw;
    }
    return slope;
  };
}

// The figure: of 200 generated maps at 8 bits 95 % decided, 99 % of the decisions right.
TEST(CheckNormalMap, TellsWhichWayGreenPoints) {
  constexpr std::uint64_t seed = 2026;
  std::mt19937_64 random(seed);
  std::size_t decided = 0, right = 0, called_swapped = 0;
  for (int i = 0; i < 200; ++i) {
    const int size = std::array{64, 96, 128, 200}[random() % 4];
    const MapGreen green = random() % 2 == 0 ? MapGreen::opengl : MapGreen::directx;
    const NormalMapCheck check = check_normal_map(map_of(size, random_relief(random, size), green));
    EXPECT_FALSE(check.flat);
    called_swapped += check.swapped.value_or(false);
    if (!check.green) continue;
    ++decided;
    right += *check.green == green;
    EXPECT_GE(check.voting_cells, 16u);
    EXPECT_GE(check.agreeing, 0.8);
  }
  std::printf("seed %llu: %zu of 200 decided, %zu of them right\n", static_cast<unsigned long long>(seed),
              decided, right);
  EXPECT_GE(decided, 190u);
  EXPECT_GE(100 * right, 99 * decided);
  EXPECT_EQ(called_swapped, 0u);
}

// f(u) + g(w): no cell can vote, whatever the codes did, so that nothing is guessed.
TEST(CheckNormalMap, IsUndecidedOnFlatAndSeparableMaps) {
  constexpr std::uint64_t seed = 7;
  std::mt19937_64 random(seed);
  for (int i = 0; i < 60; ++i) {
    const double a = uniform(random, 0, 0.8), b = uniform(random, 0, 0.8), k = uniform(random, 0.02, 0.6),
                 m = uniform(random, 0.02, 0.6), bend = uniform(random, -0.01, 0.01);
    const Slope slope = [=](double u, double w) {
      return std::array{a * std::cos(k * u) + bend * u, b * std::sin(m * w) + bend * w};
    };
    const SampleType type = i % 4 == 0 ? SampleType::u16 : SampleType::u8;
    const NormalMapCheck check =
        check_normal_map(map_of(96, slope, i % 2 == 0 ? MapGreen::opengl : MapGreen::directx, type));
    EXPECT_FALSE(check.green) << i;
    EXPECT_EQ(check.voting_cells, 0u) << i;
  }
  const NormalMapCheck flat = check_normal_map(map_of(
      64,
      [](double, double) {
        return std::array{0.0, 0.0};
      },
      MapGreen::opengl));
  EXPECT_FALSE(flat.green);
  EXPECT_FALSE(flat.swapped);
  EXPECT_TRUE(flat.flat);
  EXPECT_EQ(flat.not_unit, 0u);
  // Noise is no field of slopes: neither sign wins.
  EXPECT_FALSE(check_normal_map(random_directions(128, 128, SampleType::u8, 3)).green);
}

TEST(CheckNormalMap, TellsSwappedChannels) {
  std::mt19937_64 random(11);
  std::size_t found = 0, wrong = 0, green_right = 0;
  for (int i = 0; i < 60; ++i) {
    const MapGreen green = i % 2 == 0 ? MapGreen::opengl : MapGreen::directx;
    const NormalMapCheck check =
        check_normal_map(map_of(96, random_relief(random, 96), green, SampleType::u8, true));
    found += check.swapped.value_or(false);
    wrong += !check.swapped.value_or(true);
    green_right += check.swapped.value_or(false) && check.green == green;
  }
  std::printf("%zu of 60 found, %zu wrong\n", found, wrong);
  EXPECT_GE(found, 48u);
  EXPECT_EQ(wrong, 0u);
  EXPECT_GE(green_right + 1, found);
}

TEST(CheckNormalMap, CountsLengthsAndWhatLooksBelow) {
  Image map(4, 4, 3, SampleType::f32);
  auto& s = std::get<2>(map.samples);
  for (std::size_t i = 0; i < 16; ++i) s[3 * i + 2] = 1;
  s[2] = -1;
  s[5] = 0.5f;
  s[6] = std::numeric_limits<float>::quiet_NaN();
  s[11] = 0;
  const NormalMapCheck check = check_normal_map(map, true);
  EXPECT_EQ(check.texels, 16u);
  EXPECT_EQ(check.not_finite, 2u) << "NaN and zero";
  EXPECT_EQ(check.below_surface, 1u);
  EXPECT_EQ(check.not_unit, 1u);
  EXPECT_EQ(check.least_length, 0.5);
  EXPECT_EQ(check.greatest_length, 1);
  EXPECT_EQ(check.z_channel, 2);
  EXPECT_FALSE(check.flat);
  EXPECT_EQ(check_normal_map(random_directions(64, 64, SampleType::u8, 1)).not_unit, 0u)
      << "what rounding does is no finding";
  EXPECT_FALSE(check_normal_map(random_directions(64, 64, SampleType::u8, 1)).z_channel);
}

// ---- two maps ---------------------------------------------------------------------------------------------

Image constant(int width, int height, const std::array<float, 3>& x) {
  Image image(width, height, 3, SampleType::f32);
  auto& s = std::get<2>(image.samples);
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = x[i % 3];
  return image;
}

TEST(CompareNormalMaps, GivesAnglesPerIslandAndTheWorstTexels) {
  SampleMeshOptions grid;
  grid.columns = 8;
  grid.rows = 4;
  const MapPiece piece{.mesh = halves_apart(make_surface("torus"), grid)};
  const Image a = constant(32, 32, {0, 0, 1});
  Image b = a;
  auto& s = std::get<2>(b.samples);
  // Ten degrees on the right half, and one texel of 30 and one of 60 on the left.
  const auto turn = [&](std::size_t texel, double degrees) {
    s[3 * texel] = static_cast<float>(2 * std::sin(degrees * M_PI / 180));
    s[3 * texel + 2] = static_cast<float>(2 * std::cos(degrees * M_PI / 180));
  };
  for (std::size_t y = 0; y < 32; ++y)
    for (std::size_t x = 16; x < 32; ++x) turn(32 * y + x, 10);
  turn(32 * 5 + 3, 60);
  turn(32 * 7 + 2, 30);
  CompareMapsOptions options{.signed_floats = true};
  options.worst = 3;
  const MapDifference d = compare_normal_maps(a, b, std::span(&piece, 1), options);
  EXPECT_EQ(d.compared, 1024u);
  EXPECT_NEAR(d.angle_deg.max, 60, 1e-5);
  ASSERT_EQ(d.islands.size(), 2u);
  const std::size_t right = d.islands[0].angle_deg.max < 20 ? 0 : 1;
  EXPECT_EQ(d.islands[right].texels, 512u);
  EXPECT_NEAR(d.islands[right].angle_deg.rms, 10, 1e-5);
  EXPECT_NEAR(d.islands[1 - right].angle_deg.rms, std::sqrt((3600.0 + 900) / 512), 1e-5);
  ASSERT_EQ(d.worst.size(), 3u);
  EXPECT_EQ(d.worst[0].x, 3);
  EXPECT_EQ(d.worst[0].y, 5);
  EXPECT_EQ(d.worst[1].x, 2);
  EXPECT_NEAR(d.worst[2].angle_deg, 10, 1e-5);
  const Image heat = heat_map(d, 32, 32, 30);
  const auto& h = std::get<0>(heat.samples);
  EXPECT_EQ((std::vector<int>{h[3 * (32 * 5 + 3)], h[3 * (32 * 5 + 3) + 1]}), (std::vector<int>{250, 230}));
  EXPECT_EQ(h[0], 40);
}

TEST(CompareNormalMaps, KnowsGreensDepthsAndWhatIsNotCovered) {
  Image a = constant(8, 8, {0, 0.6f, 0.8f}), b = constant(8, 8, {0, -0.6f, 0.8f});
  EXPECT_NEAR(
      compare_normal_maps(a, b, {}, {.signed_floats = true, .green_b = MapGreen::directx}).angle_deg.max, 0,
      1e-12);
  EXPECT_NEAR(compare_normal_maps(a, b, {}, {.signed_floats = true}).angle_deg.max,
              2 * std::asin(0.6) * 180 / M_PI, 1e-4);
  std::get<2>(a.samples)[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(compare_normal_maps(a, b, {}, {.signed_floats = true}).not_finite, 1u);
  const Image eight = random_directions(8, 8, SampleType::u8, 4),
              sixteen = random_directions(8, 8, SampleType::u16, 4);
  const MapDifference d = compare_normal_maps(eight, sixteen, {});
  EXPECT_LT(d.angle_deg.max, 0.4) << "two roundings of the same vectors";
  EXPECT_GT(d.angle_deg.max, 0);
  EXPECT_REFUSED(compare_normal_maps(eight, constant(8, 9, {0, 0, 1}), {}), "8 x 8 and 8 x 9");
  MapPiece piece{.mesh = sample_mesh(make_surface("plane"), {.columns = 1, .rows = 1})};
  for (Vec2<double>& uv : piece.mesh.uvs) uv.x /= 2;
  piece.wrap = {MapWrap::clamp, MapWrap::clamp};
  EXPECT_EQ(compare_normal_maps(eight, sixteen, std::span(&piece, 1)).compared, 32u);
  piece.mesh.uvs.clear();
  EXPECT_NE(
      refusal_of<MeshError>([&] { compare_normal_maps(eight, sixteen, std::span(&piece, 1)); }).find("uvs"),
      std::string::npos);
}

}  // namespace
}  // namespace darboux::test::check_normal_map_test
