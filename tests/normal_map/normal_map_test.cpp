// Normal maps between spaces: there and back, against a second implementation, coverage, overlaps, options.
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include <darboux/error.h>

#include "map_meshes.h"
#include "normal_map/coverage.h"
#include "refusal_of.h"
#include "second_normal_map.h"
#include "thinning.h"

namespace darboux::test::normal_map_test {
namespace {

constexpr MapBasis both_bases[] = {MapBasis::stored, MapBasis::mikktspace};
constexpr MapDecode both_decodes[] = {MapDecode::mikktspace, MapDecode::gltf_viewer};
constexpr MapGreen both_greens[] = {MapGreen::opengl, MapGreen::directx};
constexpr SampleType integers[] = {SampleType::u8, SampleType::u16};

NormalMapResult convert(const Image& map, const MapPiece& piece, const NormalMapOptions& options) {
  return convert_normal_map(map, std::span(&piece, 1), options);
}

NormalMapOptions between(MapSpace from, MapSpace to) {
  NormalMapOptions options;
  options.from = from;
  options.to = to;
  return options;
}

double most_code(SampleType type) {
  return type == SampleType::u8 ? 255 : 65535;
}

// A square of the xy plane over the whole map: t = x, up the image is y.
MapPiece square(const Vec3<double>& t = {1, 0, 0}, const Vec3<double>& n = {0, 0, 1}) {
  MapPiece piece;
  Mesh& mesh = piece.mesh;
  for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
    mesh.positions.push_back({u, 1 - v, 0});
    mesh.uvs.push_back({u, v});
    mesh.normals.push_back(n);
    mesh.tangents.push_back({t.x, t.y, t.z, 1});
  }
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return piece;
}

Image constant(int width, int height, const std::array<float, 3>& x, int channels = 3) {
  Image image(width, height, channels, SampleType::f32);
  auto& s = std::get<2>(image.samples);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::size_t c = i % static_cast<std::size_t>(channels);
    s[i] = c == 3 ? 1 : x[c];
  }
  return image;
}

NormalMapOptions in_floats(MapSpace from, MapSpace to) {
  NormalMapOptions options = between(from, to);
  options.signed_floats = true;
  return options;
}

void expect_texel(const Image& image, std::size_t texel, const std::array<double, 3>& x, double within) {
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(code_at(image, texel * static_cast<std::size_t>(image.channels) + c), x[c], within)
        << "texel " << texel << " channel " << c;
}

// ---- there and back ---------------------------------------------------------------------------------------

// The figure: every channel returns within ceil(0.87 c + 1/2) - 1 codes, c the condition of the frame
// at the texel (docs/theory/normal-maps.md), as the second implementation has it.
TEST(NormalMap, ThereAndBackWithinTheProvenCodes) {
  constexpr int size = 64;
  std::size_t texels = 0, above_10 = 0, orthonormal = 0;
  int number = 0;
  for (const NamedPiece& mesh : map_meshes())
    for (const MapBasis basis : both_bases)
      for (const MapDecode decode : both_decodes)
        for (const SampleType type : integers) {
          if (!is_taken(number++)) continue;
          SCOPED_TRACE(mesh.name + ", basis " + std::to_string(static_cast<int>(basis)) + ", decode " +
                       std::to_string(static_cast<int>(decode)) + ", type " +
                       std::to_string(static_cast<int>(type)));
          const Image map = random_directions(size, size, type, 7);
          NormalMapOptions options = between(MapSpace::object, MapSpace::tangent);
          options.basis = basis;
          options.decode = decode;
          options.keep_length = true;
          const NormalMapResult there = convert(map, mesh.piece, options);
          ASSERT_EQ(there.conflicts, 0u);
          ASSERT_GT(there.covered, size * size / 3u);
          std::swap(options.from, options.to);
          const NormalMapResult back = convert(there.image, mesh.piece, options);
          EXPECT_EQ(back.covered, there.covered);
          const Returned r =
              returned(map, there, back.image, SecondNormalMap(mesh.piece, options, size, size));
          texels += r.texels, above_10 += r.above_10, orthonormal += r.orthonormal;
          EXPECT_EQ(r.wrong, 0u);
        }
  std::printf("%zu texels, %zu of orthonormal frames, %zu of a condition above 10\n", texels, orthonormal,
              above_10);
  EXPECT_GT(orthonormal, texels / 20);
}

TEST(NormalMap, ThereAndBackOnAnAnalyticBasisWithinOneCode) {
  for (const char* name : {"sphere", "torus", "catenoid", "helicoid"}) {
    const AnySurface surface = make_surface(name);
    for (const SampleType type : integers)
      for (const MapGreen green : both_greens) {
        const Image map = random_directions(50, 30, type, 11);
        NormalMapOptions options = between(MapSpace::object, MapSpace::tangent);
        options.basis = MapBasis::analytic;
        options.surface = &surface;
        options.keep_length = true;
        options.green = green;
        const NormalMapResult there = convert_normal_map(map, {}, options);
        EXPECT_EQ(there.covered, map.texels());
        EXPECT_EQ(there.condition, 1);
        std::swap(options.from, options.to);
        const NormalMapResult back = convert_normal_map(there.image, {}, options);
        double worst = 0;
        for (std::size_t i = 0; i < 3 * map.texels(); ++i)
          worst = std::fmax(worst, std::fabs(code_at(back.image, i) - code_at(map, i)));
        EXPECT_LE(worst, 1) << name;
      }
  }
}

// ---- a second implementation ------------------------------------------------------------------------------

// Equal codes, but where the number lies within 1e-6 of a code of a tie (weights of a few roundings, times
// 65535 and the condition), and the same texels, but where a centre lies within 2^-30 texels of an edge: none
// of these meshes has such a one.
TEST(NormalMap, IsWhatASecondImplementationGives) {
  constexpr int width = 48, height = 40;
  std::size_t texels = 0, ties = 0;
  int number = 0;
  for (const NamedPiece& mesh : map_meshes())
    for (const MapSpace to : {MapSpace::object, MapSpace::tangent})
      for (const MapBasis basis : both_bases)
        for (const MapDecode decode : both_decodes)
          for (const bool v_up : {false, true}) {
            if (!is_taken(number++)) continue;
            SCOPED_TRACE(mesh.name + ", to " + std::to_string(static_cast<int>(to)) + ", basis " +
                         std::to_string(static_cast<int>(basis)) + ", decode " +
                         std::to_string(static_cast<int>(decode)) + (v_up ? ", v up" : ""));
            MapPiece piece = mesh.piece;
            piece.v_up = v_up;
            const SampleType type = v_up ? SampleType::u8 : SampleType::u16;
            const Image map = random_directions(width, height, type, 3);
            NormalMapOptions options =
                between(to == MapSpace::object ? MapSpace::tangent : MapSpace::object, to);
            options.basis = basis;
            options.decode = decode;
            options.green = v_up ? MapGreen::directx : MapGreen::opengl;
            options.keep_length = v_up;
            const NormalMapResult result = convert(map, piece, options);
            ASSERT_EQ(result.conflicts, 0u);
            const SecondNormalMap second(piece, options, width, height);
            std::size_t other_coverage = 0, wrong = 0;
            double condition = 0;
            for (int y = 0; y < height; ++y)
              for (int x = 0; x < width; ++x) {
                const std::size_t i = static_cast<std::size_t>(y * width + x);
                const auto frames = second.frames(x, y);
                if (frames.empty() != (result.states[i] == TexelState::empty)) ++other_coverage;
                if (frames.empty()) continue;
                ++texels;
                for (const SecondFrame& f : frames) condition = std::fmax(condition, f.condition());
                const Eigen::Vector3d wanted =
                    second.convert({code_at(map, 3 * i), code_at(map, 3 * i + 1), code_at(map, 3 * i + 2)},
                                   most_code(type), frames.front().columns);
                for (Eigen::Index k = 0; k < 3; ++k) {
                  const double code = (wanted[k] + 1) / 2 * most_code(type);
                  const double nearest = std::fmin(most_code(type), std::floor(code + 0.5));
                  const double got = code_at(result.image, 3 * i + static_cast<std::size_t>(k));
                  if (got == nearest) continue;
                  const bool tie =
                      std::fabs(code - std::floor(code) - 0.5) < 1e-6 && std::fabs(got - nearest) <= 1;
                  ++(tie ? ties : wrong);
                }
              }
            EXPECT_EQ(other_coverage, 0u);
            EXPECT_EQ(wrong, 0u);
            EXPECT_NEAR(result.condition, condition, 1e-6 * condition);
          }
  std::printf("%zu texels, %zu channels are ties\n", texels, ties);
  EXPECT_LT(ties, texels / 1000);
}

// The condition that the result names, and so the bound of a bake, holds at any scale of x and y.
TEST(NormalMap, ConditionKeepsItsDigitsAtAnyScale) {
  MapPiece piece = map_meshes().front().piece;
  constexpr int size = 24;
  const Image map = random_directions(size, size, SampleType::u8, 3);
  for (const MapDecode decode : both_decodes)
    for (const double scale : {1e-9, 1e-6, 1e-3, 0.5, 1.0, 20.0, 1e4}) {
      piece.scale = scale;
      NormalMapOptions options = between(MapSpace::tangent, MapSpace::object);
      options.decode = decode;
      const SecondNormalMap second(piece, options, size, size);
      double condition = 0;
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
          for (const SecondFrame& f : second.frames(x, y)) condition = std::fmax(condition, f.condition());
      // Of what Eigen's singular values lose: 2^-53 of the largest.
      EXPECT_NEAR(convert(map, piece, options).condition, condition, (1e-6 + 1e-15 * condition) * condition)
          << scale;
    }
}

// ---- by hand ----------------------------------------------------------------------------------------------

// normalTexture.scale: (0.6, 0, 0.8) scaled by 2 is (1.2, 0, 0.8) made unit.
TEST(NormalMap, ScaleIsThatOfXAndY) {
  MapPiece piece = square();
  piece.scale = 2;
  const float length = std::sqrt(1.2f * 1.2f + 0.8f * 0.8f);
  const Image small = constant(4, 4, {0.6f, 0, 0.8f}),
              large = constant(4, 4, {1.2f / length, 0, 0.8f / length});
  const AnySurface plane = make_surface("plane");
  for (const MapBasis basis : {MapBasis::stored, MapBasis::mikktspace, MapBasis::analytic})
    for (const MapDecode decode : both_decodes) {
      NormalMapOptions options = in_floats(MapSpace::tangent, MapSpace::object);
      options.basis = basis;
      options.decode = decode;
      options.surface = &plane;
      const NormalMapResult there = convert(small, piece, options);
      expect_texel(there.image, 5, {1.2 / length, 0, 0.8 / length}, 1e-6);
      EXPECT_NEAR(there.condition, 2, 1e-6);
      std::swap(options.from, options.to);
      expect_texel(convert(large, piece, options).image, 5, {0.6, 0, 0.8}, 1e-6);
      MapPiece none = piece;
      none.scale = 0;
      EXPECT_NE(refusal_of<MeshError>([&] { convert(large, none, options); }).find("scale"),
                std::string::npos);
      std::swap(options.from, options.to);
      expect_texel(convert(small, none, options).image, 5, {0, 0, 1}, 1e-6);
    }
}

TEST(NormalMap, GreenPointsUpTheImageOrDown) {
  const Image up = constant(4, 4, {0, 0.6f, 0.8f}), down = constant(4, 4, {0, -0.6f, 0.8f});
  NormalMapOptions options = in_floats(MapSpace::tangent, MapSpace::object);
  expect_texel(convert(up, square(), options).image, 5, {0, 0.6, 0.8}, 1e-7);
  options.green = MapGreen::directx;
  expect_texel(convert(down, square(), options).image, 5, {0, 0.6, 0.8}, 1e-7);
  std::swap(options.from, options.to);
  expect_texel(convert(up, square(), options).image, 5, {0, -0.6, 0.8}, 1e-7);
  options.basis = MapBasis::mikktspace;
  expect_texel(convert(up, square(), options).image, 5, {0, -0.6, 0.8}, 1e-7);
  // A plane's own v runs down the image as well: up the image is -dpdv.
  const AnySurface plane = make_surface("plane");
  options.basis = MapBasis::analytic;
  options.surface = &plane;
  options.green = MapGreen::opengl;
  const Frame<double> f = plane.frame(0.4, 0.4);
  const Vec3<double> d = 0.8 * f.n - 0.6 * unit(plane.jet(0.4, 0.4).dpdv);
  const Image leans =
      constant(4, 4, {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)});
  expect_texel(convert_normal_map(leans, {}, options).image, 5, {0, 0.6, 0.8}, 1e-7);
}

// t = x, n = (0.6, 0, 0.8), b = n × t = (0, 0.8, 0). x t + y b + z n = d: of d = (0, 0, 1), z = 1/0.8 and
// x = -0.6/0.8, so (-0.6, 0, 1) made unit. The transpose would give (0, 0, 0.8).
TEST(NormalMap, TakesTheInverseOfAFrameThatIsNotOrthogonal) {
  const Image z = constant(4, 4, {0, 0, 1});
  const NormalMapResult r =
      convert(z, square({1, 0, 0}, {0.6, 0, 0.8}), in_floats(MapSpace::object, MapSpace::tangent));
  const double length = std::sqrt(1 + 0.36);
  expect_texel(r.image, 5, {-0.6 / length, 0, 1 / length}, 1e-7);
  // The cosine between t and n is 0.6, the lengths are 1, 1 and 0.8: singular values sqrt(1.6), sqrt(0.4),
  // 0.8.
  EXPECT_NEAR(r.condition, 2, 1e-12);
  EXPECT_EQ(r.below_surface, 0u);
}

TEST(NormalMap, ReadsTheWorldThroughTheNodesMatrix) {
  MapPiece piece = square();
  piece.to_world << 2, 0, 0, 0, 0, -1, 0, 1, 0;  // a quarter turn about x, and twice as long along x
  const Image map = constant(4, 4, {0.6f, 0, 0.8f});
  const NormalMapOptions options = in_floats(MapSpace::world, MapSpace::object);
  // Normals go to the world by the inverse transpose: (a, b, c) -> (a/2, -c, b).
  const double length = std::sqrt(1.2 * 1.2 + 0.8 * 0.8);
  expect_texel(convert(map, piece, options).image, 5, {1.2 / length, 0.8 / length, 0}, 1e-7);
  expect_texel(convert(map, piece, in_floats(MapSpace::world, MapSpace::tangent)).image, 5,
               {1.2 / length, 0.8 / length, 0}, 1e-7);
  piece.to_world.setZero();
  EXPECT_NE(refusal_of<MeshError>([&] { convert(map, piece, options); }).find("inverse"), std::string::npos);
}

TEST(NormalMap, MakesZOfTwoChannels) {
  Image map = constant(4, 4, {0.48f, 0.6f, -7});
  NormalMapOptions options = in_floats(MapSpace::tangent, MapSpace::object);
  options.two_channels = true;
  expect_texel(convert(map, square(), options).image, 5, {0.48, 0.6, 0.64}, 1e-7);
  std::get<2>(map.samples)[0] = 2;
  const NormalMapResult r = convert(map, square(), options);
  EXPECT_EQ(r.too_long, 1u);
  EXPECT_EQ(r.below_surface, 1u) << "z is 0";
}

TEST(NormalMap, KeepsLengthsWhereAsked) {
  const Image map = constant(4, 4, {0.3f, 0, 0.4f});
  NormalMapOptions options = in_floats(MapSpace::tangent, MapSpace::object);
  expect_texel(convert(map, square(), options).image, 5, {0.6, 0, 0.8}, 1e-7);
  options.keep_length = true;
  expect_texel(convert(map, square({0, 1, 0}), options).image, 5, {0, 0.3, 0.4}, 1e-7);
}

TEST(NormalMap, CountsWhatLooksBelowTheSurface) {
  Image map = constant(4, 4, {0, 0, 1});
  std::get<2>(map.samples)[2] = -1;
  EXPECT_EQ(convert(map, square(), in_floats(MapSpace::tangent, MapSpace::object)).below_surface, 1u);
  EXPECT_EQ(convert(map, square(), in_floats(MapSpace::object, MapSpace::tangent)).below_surface, 1u);
}

TEST(NormalMap, CountsWhatIsNoDirectionOrHasNoFrame) {
  Image map = constant(4, 4, {0, 0, 1});
  auto& s = std::get<2>(map.samples);
  s[0] = std::numeric_limits<float>::quiet_NaN();
  s[4] = std::numeric_limits<float>::infinity();
  s[8] = 0;
  const NormalMapOptions options = in_floats(MapSpace::object, MapSpace::tangent);
  const NormalMapResult r = convert(map, square(), options);
  EXPECT_EQ(r.not_finite, 3u);
  EXPECT_EQ(r.covered, 13u);
  for (const float x : std::get<2>(r.image.samples)) EXPECT_TRUE(std::isfinite(x));
  const NormalMapResult none = convert(map, square({0, 0, 0}), options);
  EXPECT_EQ(none.covered, 0u);
  EXPECT_EQ(none.no_frame + none.not_finite, 16u);
  EXPECT_EQ(convert(map, square({0, 0, 1}), options).covered, 0u) << "t along n";
}

// ---- codes ------------------------------------------------------------------------------------------------

TEST(NormalMap, RoundsToTheNearestCodeAndCarriesAlpha) {
  Image map = constant(4, 4, {0, 0, 1}, 4);
  std::get<2>(map.samples)[3] = 0.4f;
  NormalMapOptions options = in_floats(MapSpace::object, MapSpace::tangent);
  options.type = SampleType::u8;
  NormalMapResult r = convert(map, square(), options);
  ASSERT_EQ(r.image.channels, 4);
  const auto& s = std::get<0>(r.image.samples);
  EXPECT_EQ((std::vector<int>(s.begin(), s.begin() + 8)),
            (std::vector<int>{128, 128, 255, 102, 128, 128, 255, 255}));
  options.type = SampleType::u16;
  r = convert(map, square(), options);
  EXPECT_EQ(std::get<1>(r.image.samples)[0], 32768);
  EXPECT_EQ(std::get<1>(r.image.samples)[3], 26214);
}

// In codes alpha is cut off at both ends, and NaN is 0; floats keep it.
TEST(NormalMap, AlphaBeyondTheCodesIsCutOff) {
  Image map = constant(4, 4, {0, 0, 1}, 4);
  auto& in = std::get<2>(map.samples);
  in[3] = 2;
  in[7] = -1;
  in[11] = std::numeric_limits<float>::quiet_NaN();
  NormalMapOptions options = in_floats(MapSpace::object, MapSpace::tangent);
  for (const SampleType type : integers) {
    options.type = type;
    const Image out = convert(map, square(), options).image;
    EXPECT_EQ(code_at(out, 3), most_code(type));
    EXPECT_EQ(code_at(out, 7), 0);
    EXPECT_EQ(code_at(out, 11), 0);
    EXPECT_EQ(code_at(out, 15), most_code(type));
  }
  options.type = SampleType::f32;
  const Image out = convert(map, square(), options).image;
  EXPECT_EQ(code_at(out, 3), 2);
  EXPECT_EQ(code_at(out, 7), -1);
  EXPECT_TRUE(std::isnan(code_at(out, 11)));
}

// The angle by which rounding is off: half a code in each channel at most, of 255 over two units of length.
TEST(NormalMap, TellsWhatRoundingCosts) {
  for (const SampleType type : integers) {
    const Image map = random_directions(64, 64, SampleType::f32, 5);
    NormalMapOptions options = between(MapSpace::object, MapSpace::tangent);
    options.type = type;
    const NormalMapResult r = convert(map, square(), options);
    const double half_code = 1 / most_code(type), degrees = 180 / M_PI;
    EXPECT_LE(r.quantisation_max_deg, std::asin(std::sqrt(3) * half_code) * degrees * 1.001);
    EXPECT_GT(r.quantisation_max_deg, half_code * degrees);
    // Uniform errors of variance (2 half)²/12 in two directions across.
    EXPECT_NEAR(r.quantisation_rms_deg, half_code * std::sqrt(2.0 / 3) * degrees, 0.03 * half_code * degrees);
  }
}

// Dithered codes are right on average: within five standard errors of the mean.
TEST(NormalMap, DithersToTheRightMean) {
  const Image map = constant(256, 256, {0.36f, 0.48f, 0.8f});
  NormalMapOptions options = in_floats(MapSpace::object, MapSpace::tangent);
  options.type = SampleType::u8;
  options.dither = 17;
  const NormalMapResult r = convert(map, square(), options);
  for (std::size_t c = 0; c < 3; ++c) {
    double sum = 0;
    for (std::size_t i = 0; i < map.texels(); ++i) sum += code_at(r.image, 3 * i + c);
    const double wanted = (std::array{0.36, 0.48, 0.8}[c] + 1) / 2 * 255;
    EXPECT_NEAR(sum / static_cast<double>(map.texels()), wanted, 5 * 0.5 / 256);
  }
  EXPECT_EQ(convert(map, square(), options).image.samples, r.image.samples);
  options.dither = 18;
  EXPECT_NE(convert(map, square(), options).image.samples, r.image.samples);
}

// ---- coverage ---------------------------------------------------------------------------------------------

// A grid whose lines pass through centres: every texel belongs to one triangle.
TEST(NormalMap, EachTexelOfAMeshWithoutGapsBelongsToOneTriangle) {
  for (const auto& [columns, rows, size] : {std::array{8, 8, 12}, {3, 5, 16}, {16, 16, 16}, {7, 9, 33}}) {
    SampleMeshOptions options;
    options.columns = columns;
    options.rows = rows;
    const Mesh mesh = sample_mesh(make_surface("plane"), options);
    std::vector<int> owners(static_cast<std::size_t>(size * size));
    for (const Triangle& t : mesh.triangles) {
      std::array<Vec2<double>, 3> p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<double>(size) * mesh.uvs[t[k]];
      const auto triangle = normal_map::TexelTriangle::of(p);
      ASSERT_TRUE(triangle);
      const auto [first, last] = triangle->rows();
      for (std::int64_t y = first; y < last; ++y) {
        const normal_map::Span span = triangle->span(y);
        for (std::int64_t x = span.begin; x < span.end; ++x) ++owners[static_cast<std::size_t>(y * size + x)];
      }
    }
    EXPECT_EQ(std::count(owners.begin(), owners.end(), 1), size * size) << columns << " x " << rows;
  }
}

TEST(NormalMap, WrapsAsTheTextureDoes) {
  const Image map = random_directions(24, 20, SampleType::u16, 9);
  MapPiece piece = map_meshes()[2].piece;
  NormalMapOptions options = between(MapSpace::object, MapSpace::tangent);
  const Image plain = convert(map, piece, options).image;
  for (Vec2<double>& uv : piece.mesh.uvs) uv = {uv.x + 3, uv.y - 2};
  EXPECT_EQ(convert(map, piece, options).image.samples, plain.samples);
  piece.wrap = {MapWrap::clamp, MapWrap::repeat};
  const NormalMapResult beside = convert(map, piece, options);
  EXPECT_EQ(beside.covered, 0u);
  EXPECT_EQ(beside.outside_map, map.texels());
  piece.wrap = {MapWrap::repeat, MapWrap::clamp};
  EXPECT_EQ(convert(map, piece, options).outside_map, map.texels());
  // u from 3 to 4 is a mirrored tile, v from -2 to -1 is not: column i of the map is column W - 1 - i.
  piece.wrap = {MapWrap::mirror, MapWrap::mirror};
  MapPiece mirrored = map_meshes()[2].piece;
  for (Vec2<double>& uv : mirrored.mesh.uvs) uv.x = 1 - uv.x;
  EXPECT_EQ(convert(map, piece, options).image.samples, convert(map, mirrored, options).image.samples);
}

TEST(NormalMap, IslandsGrowIntoTheGutterAndStayThemselves) {
  const Image map = random_directions(60, 50, SampleType::u8, 13);
  MapPiece piece = map_meshes()[1].piece;
  for (Vec2<double>& uv : piece.mesh.uvs) uv = {0.25 + uv.x / 2, 0.4 + uv.y / 4};
  piece.wrap = {MapWrap::clamp, MapWrap::clamp};
  NormalMapOptions options = between(MapSpace::object, MapSpace::tangent);
  const NormalMapResult plain = convert(map, piece, options);
  EXPECT_EQ(plain.dilated, 0u);
  options.dilate = 5;
  const NormalMapResult grown = convert(map, piece, options);
  const auto covered = [&](int x, int y) {
    return plain.states[static_cast<std::size_t>(y * 60 + x)] == TexelState::covered;
  };
  std::size_t filled = 0;
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 60; ++x) {
      const std::size_t i = static_cast<std::size_t>(3 * (y * 60 + x));
      int distance = 1000;
      bool as_nearest = false;
      const auto same = [&](const Image& a, std::size_t j) {
        for (std::size_t c = 0; c < 3; ++c)
          if (code_at(grown.image, i + c) != code_at(a, j + c)) return false;
        return true;
      };
      for (int qy = 0; qy < 50; ++qy)
        for (int qx = 0; qx < 60; ++qx) {
          if (!covered(qx, qy)) continue;
          const int d = std::max(std::abs(qx - x), std::abs(qy - y));
          if (d > distance) continue;
          as_nearest = (d == distance && as_nearest) ||
                       same(plain.image, static_cast<std::size_t>(3 * (qy * 60 + qx)));
          distance = d;
        }
      EXPECT_TRUE(distance > 5 ? same(plain.image, i) : as_nearest) << x << ' ' << y << " at " << distance;
      filled += distance > 0 && distance <= 5;
    }
  EXPECT_EQ(grown.dilated, filled);
}

TEST(NormalMap, DilationGoesAroundMapsThatRepeat) {
  const Image map = random_directions(16, 16, SampleType::u8, 2);
  MapPiece piece = square();
  for (Vec2<double>& uv : piece.mesh.uvs) uv = {uv.x / 4, uv.y};
  NormalMapOptions options = between(MapSpace::object, MapSpace::tangent);
  options.dilate = 2;
  EXPECT_EQ(convert(map, piece, options).dilated, 4u * 16);
  piece.wrap = {MapWrap::clamp, MapWrap::clamp};
  EXPECT_EQ(convert(map, piece, options).dilated, 2u * 16);
}

// ---- overlaps ---------------------------------------------------------------------------------------------

// Mirrored halves on the same texels: one tangent-space map serves both, one object-space map cannot.
TEST(NormalMap, MirroredHalvesCannotShareAnObjectSpaceMap) {
  SampleMeshOptions grid;
  grid.columns = 16;
  grid.rows = 8;
  grid.mirror = true;
  const MapPiece piece{.mesh = sample_mesh(make_surface("torus"), grid)};
  Image flat(32, 32, 3, SampleType::u8);
  for (std::size_t i = 0; i < flat.texels(); ++i) {
    std::get<0>(flat.samples)[3 * i] = std::get<0>(flat.samples)[3 * i + 1] = 128;
    std::get<0>(flat.samples)[3 * i + 2] = 255;
  }
  const NormalMapOptions options = between(MapSpace::tangent, MapSpace::object);
  const NormalMapResult r = convert(flat, piece, options);
  EXPECT_GT(r.conflicts, 900u);
  EXPECT_EQ(r.image.texels(), 0u);
  ASSERT_TRUE(r.first_conflict);
  const MapConflict& c = *r.first_conflict;
  const SecondNormalMap second(piece, options, 32, 32);
  const auto frames = second.frames(c.x, c.y);
  ASSERT_EQ(frames.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(c.owners[k].triangle, frames[k].triangle);
    const Eigen::Vector3d wanted = second.convert({128, 128, 255}, 255, frames[k].columns);
    for (Eigen::Index j = 0; j < 3; ++j)
      EXPECT_EQ(c.owners[k].codes[static_cast<std::size_t>(j)], std::floor((wanted[j] + 1) / 2 * 255 + 0.5));
  }
  const Image picture = picture_of(r, 32, 32);
  const std::size_t at = static_cast<std::size_t>(3 * (32 * c.y + c.x));
  EXPECT_EQ(code_at(picture, at), 255);
  EXPECT_EQ(code_at(picture, at + 1), 0);

  // The mirrored halves of an object-space map that agree in tangent space are no conflict.
  MapPiece apart{.mesh = halves_apart(make_surface("torus"), grid)};
  const NormalMapResult object = convert(flat, apart, options);
  ASSERT_EQ(object.conflicts, 0u);
  const NormalMapResult tangent = convert(object.image, apart, between(MapSpace::object, MapSpace::tangent));
  for (std::size_t i = 0; i < 3 * flat.texels(); ++i)
    if (tangent.states[i / 3] == TexelState::covered) {
      EXPECT_NEAR(code_at(tangent.image, i), code_at(flat, i), 1);
    }
}

TEST(NormalMap, TrianglesThatAgreeMayOverlap) {
  MapPiece piece = square();
  piece.mesh.triangles.push_back(piece.mesh.triangles[0]);
  const NormalMapResult r = convert(random_directions(8, 8, SampleType::u8, 1), piece,
                                    between(MapSpace::tangent, MapSpace::object));
  EXPECT_EQ(r.conflicts, 0u);
  EXPECT_EQ(r.covered, 64u);
}

// ---- threads ----------------------------------------------------------------------------------------------

TEST(NormalMap, BitsDoNotDependOnThreads) {
  const Image map = random_directions(300, 400, SampleType::u16, 21);
  for (const NamedPiece& mesh : map_meshes()) {
    NormalMapOptions options = between(MapSpace::object, MapSpace::tangent);
    options.basis = MapBasis::mikktspace;
    options.dither = 1;
    const NormalMapResult one = convert(map, mesh.piece, options);
    options.threads = 3;
    const NormalMapResult three = convert(map, mesh.piece, options);
    EXPECT_EQ(one.image.samples, three.image.samples);
    EXPECT_EQ(one.quantisation_rms_deg, three.quantisation_rms_deg);
    EXPECT_EQ(one.condition, three.condition);
  }
}

// ---- what is refused --------------------------------------------------------------------------------------

TEST(NormalMap, RefusesWhatItCannotDo) {
  const Image map = random_directions(8, 8, SampleType::u8, 1);
  const NormalMapOptions options = between(MapSpace::tangent, MapSpace::object);
  const auto mesh_refusal = [&](const auto& change, NormalMapOptions with) {
    MapPiece piece = square();
    change(piece.mesh);
    return refusal_of<MeshError>([&] { convert(map, piece, with); });
  };
  const auto expect = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect(mesh_refusal([](Mesh& m) { m.uvs.clear(); }, options), "expected uvs");
  expect(mesh_refusal([](Mesh& m) { m.normals.clear(); }, options), "expected normals");
  expect(mesh_refusal([](Mesh& m) { m.tangents.clear(); }, options), "mikktspace");
  expect(mesh_refusal([](Mesh& m) { m.uvs[0].x = NAN; }, options), "uv");
  expect(mesh_refusal([](Mesh& m) { m.uvs[0].x = 1e9; }, options), "2^22 texels");
  expect(mesh_refusal(
             [](Mesh& m) {
               for (auto& uv : m.uvs) uv = 3000.0 * uv;
             },
             options),
         "64 times");
  EXPECT_REFUSED(convert(map, square(), between(MapSpace::object, MapSpace::world)), "object or tangent");
  EXPECT_REFUSED(convert(map, square(), between(MapSpace::object, MapSpace::object)), "another space");
  EXPECT_REFUSED(convert_normal_map(map, {}, options), "triangles");
  NormalMapOptions wrong = options;
  wrong.basis = MapBasis::analytic;
  EXPECT_REFUSED(convert(map, square(), wrong), "surface");
  wrong = between(MapSpace::object, MapSpace::tangent);
  wrong.two_channels = true;
  EXPECT_REFUSED(convert(map, square(), wrong), "tangent space");
  wrong.two_channels = false;
  wrong.dilate = -1;
  EXPECT_REFUSED(convert(map, square(), wrong), "0 to 1024");
  EXPECT_REFUSED(convert(Image(), square(), options), "image");
  Image torn = map;
  std::get<0>(torn.samples).pop_back();
  EXPECT_REFUSED(convert(torn, square(), options), "192 samples");
}

TEST(NormalMap, TrianglesWithoutAreaInUvCoverNothingAndAreCounted) {
  const Image map = random_directions(8, 8, SampleType::u8, 1);
  MapPiece piece = square();
  piece.mesh.triangles.push_back({0, 0, 1});
  piece.mesh.tangents[2].w = -1;
  const NormalMapResult r = convert(map, piece, between(MapSpace::tangent, MapSpace::object));
  EXPECT_EQ(r.degenerate_uv_triangles, 1u);
  EXPECT_EQ(r.mixed_sign_triangles, 2u);
}

}  // namespace
}  // namespace darboux::test::normal_map_test
