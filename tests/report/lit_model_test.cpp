// One model, lit through a tangent-space map and through the object-space map made of it: the same picture.
#include "report/lit_model.h"

#include <gtest/gtest.h>

#include <darboux/error.h>

#include "map_meshes.h"
#include "refusal_of.h"

namespace darboux::test::lit_model_test {
namespace {

// Round bumps, as the rasteriser's own.
Image bumps(int size, SampleType type) {
  Image image(size, size, 3, type);
  const double most = type == SampleType::f32 ? 1 : type == SampleType::u8 ? 255 : 65535;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Vec3<double> n = bump({(x + 0.5) / size, (y + 0.5) / size});
      const std::array<double, 3> numbers{n.x, n.y, n.z};
      for (std::size_t c = 0; c < 3; ++c)
        std::visit(
            [&](auto& s) {
              s[static_cast<std::size_t>(3 * (y * size + x)) + c] =
                  static_cast<typename std::remove_reference_t<decltype(s)>::value_type>(
                      most == 1 ? (numbers[c] + 1) / 2 : std::floor((numbers[c] + 1) / 2 * most + 0.5));
            },
            image.samples);
    }
  return image;
}

struct Difference {
  int most = 0;
  double rms = 0;
  std::size_t drawn = 0;
};

Difference difference(const Picture& a, const Picture& b) {
  Difference d;
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    if (a.rgb[i] == 255 && b.rgb[i] == 255) continue;
    const int off = std::abs(a.rgb[i] - b.rgb[i]);
    d.most = std::max(d.most, off);
    sum += off * off;
    ++d.drawn;
  }
  d.rms = std::sqrt(sum / static_cast<double>(d.drawn));
  return d;
}

// A map whose x and y are halved, and scaled by 2, is the map.
TEST(LitModel, ScalesTheMap) {
  MapPiece piece{.mesh = sample_mesh(make_surface("torus"), {})};
  Image map = bumps(256, SampleType::f32);
  const auto drawn = [&] { return lit_model(map, std::span(&piece, 1), {.width = 100, .height = 80}); };
  const Picture whole = drawn();
  auto& samples = std::get<2>(map.samples);
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (i % 3 != 2) samples[i] = 0.5f + (samples[i] - 0.5f) / 2;
  EXPECT_GT(difference(whole, drawn()).most, 10);
  piece.scale = 2;
  EXPECT_LE(difference(whole, drawn()).most, 1);
}

// A grey is off by at most 290 of its codes per radian: 255 √(0.8 (0.12 + 0.88 n·l)) has that slope where
// the light just misses. The rounding of the object-space map is off by up to √3/255 radians (2 codes), at
// 16 bits by nothing that shows; both maps are read between texels, where the frame turned by up to one of
// 1024 parts of a turn, which the mean of four takes off but for its square; a rounding of each grey.
// MikkTSpace's frames jump at the seam, where the object-space map mixes texels of both sides: measured 3
// codes more.
TEST(LitModel, IsTheSameThroughEitherMap) {
  const AnySurface torus = make_surface("torus:major_radius=1,minor_radius=0.4");
  SampleMeshOptions grid;
  grid.columns = 32;
  grid.rows = 16;
  grid.jitter = 0.2;
  const MapPiece piece{.mesh = sample_mesh(torus, grid)};
  for (const SampleType type : {SampleType::u8, SampleType::u16})
    for (const MapBasis basis : {MapBasis::stored, MapBasis::mikktspace}) {
      const Image tangent = bumps(1024, type);
      NormalMapOptions convert;
      convert.basis = basis;
      convert.decode = MapDecode::gltf_viewer;
      const NormalMapResult object = convert_normal_map(tangent, std::span(&piece, 1), convert);
      ASSERT_EQ(object.conflicts, 0u);
      LitModelOptions options{.basis = basis, .width = 320, .height = 240};
      const Picture one = lit_model(tangent, std::span(&piece, 1), options);
      options.space = MapSpace::object;
      const Picture other = lit_model(object.image, std::span(&piece, 1), options);
      const Difference d = difference(one, other);
      std::printf("%zu pixels, most %d, rms %.3f\n", d.drawn, d.most, d.rms);
      EXPECT_GT(d.drawn, 10000u);
      EXPECT_LE(d.most, (type == SampleType::u8 ? 3 : 2) + (basis == MapBasis::mikktspace ? 3 : 0));
      EXPECT_LT(d.rms, type == SampleType::u8 ? 1 : 0.3);
      // The wrong green is another picture.
      options.space = MapSpace::tangent;
      options.green = MapGreen::directx;
      EXPECT_GT(difference(one, lit_model(tangent, std::span(&piece, 1), options)).rms, 10);
    }
}

TEST(LitModel, RefusesWhatItCannotDraw) {
  MapPiece piece{.mesh = sample_mesh(make_surface("torus"), {})};
  piece.mesh.tangents.clear();
  const Image map(4, 4, 3, SampleType::u8);
  const auto refusal = [&] {
    return refusal_of<MeshError>([&] { lit_model(map, std::span(&piece, 1), {.width = 8, .height = 8}); });
  };
  EXPECT_NE(refusal().find("mikktspace"), std::string::npos) << refusal();
  piece.mesh.uvs.clear();
  EXPECT_NE(refusal().find("uvs"), std::string::npos) << refusal();
}

}  // namespace
}  // namespace darboux::test::lit_model_test
