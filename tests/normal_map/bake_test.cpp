// A surface's exact normals as a map for a coarse mesh: within the proven bound at texels, and what is left
// between them.
#include <gtest/gtest.h>

#include <darboux/bake.h>
#include <darboux/check_normal_map.h>
#include <darboux/error.h>
#include <darboux/frame.h>

#include "map_meshes.h"
#include "refusal_of.h"
#include "second_normal_map.h"

namespace darboux::test::bake_test {
namespace {

MapPiece coarse(const AnySurface& surface, int columns = 12, int rows = 6, double jitter = 0) {
  SampleMeshOptions options;
  options.columns = columns;
  options.rows = rows;
  options.jitter = jitter;
  return {.mesh = sample_mesh(surface, options)};
}

BakeResult bake(const AnySurface& surface, const MapPiece& piece, const BakeOptions& options) {
  return bake_normal_map(surface, std::span(&piece, 1), options);
}

// docs/theory/normal-maps.md: a texel of half a code h = 1/most in each channel decodes, in a frame of
// condition c, to within asin(c √3 h) of what was baked; dithered, of a whole code, asin(2 c √3 h). The
// frames are the second implementation's.
TEST(Bake, TexelsAreWithinTheProvenBound) {
  constexpr int size = 48;
  double closest = 0;
  for (const char* name : {"sphere", "torus", "catenoid", "monkey-saddle"}) {
    const AnySurface surface = make_surface(name);
    const MapPiece piece = coarse(surface, 10, 6, 0.2);
    for (const MapBasis basis : {MapBasis::stored, MapBasis::mikktspace})
      for (const MapDecode decode : {MapDecode::mikktspace, MapDecode::gltf_viewer})
        for (const auto& [type, dither] :
             {std::pair(SampleType::u8, false), {SampleType::u16, false}, {SampleType::u8, true}}) {
          BakeOptions options;
          options.width = options.height = size;
          options.basis = basis;
          options.decode = decode;
          options.type = type;
          if (dither) options.dither = 1;
          const BakeResult r = bake(surface, piece, options);
          ASSERT_EQ(r.map.conflicts, 0u);
          NormalMapOptions frames;
          frames.basis = basis;
          frames.decode = decode;
          const SecondNormalMap second(piece, frames, size, size);
          const double most = type == SampleType::u8 ? 255 : 65535;
          std::size_t texels = 0, beyond = 0, beyond_result = 0;
          for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
              const std::size_t i = static_cast<std::size_t>(y * size + x);
              if (r.map.states[i] != TexelState::covered) continue;
              const SecondFrame f = second.frames(x, y).at(0);
              const Eigen::Vector3d codes(code_at(r.map.image, 3 * i), code_at(r.map.image, 3 * i + 1),
                                          code_at(r.map.image, 3 * i + 2));
              const Eigen::Vector3d n = f.columns * ((codes / most).array() * 2 - 1).matrix();
              const Vec3<double> truth = surface.frame((x + 0.5) / size, (y + 0.5) / size).n;
              const double angle = angle_between({n.x(), n.y(), n.z()}, truth);
              // 1e-7: the normals are handed over in single precision.
              const double off = (dither ? 2 : 1) / most;
              const double bound = std::asin(std::fmin(1, f.condition() * (std::sqrt(3.0) * off + 1e-7)));
              beyond_result += angle > r.bound_deg * M_PI / 180;
              ++texels;
              beyond += angle > bound;
              closest = std::fmax(closest, angle / bound);
              EXPECT_LE(bound, r.bound_deg * M_PI / 180 * 1.001);
            }
          EXPECT_EQ(beyond, 0u) << name;
          EXPECT_EQ(beyond_result, 0u) << name << ", dither " << dither;
          EXPECT_GT(texels, 1000u) << name;
        }
  }
  std::printf("the largest angle is %.2f of its bound\n", closest);
  EXPECT_GT(closest, 0.5) << "the bound is not idle";
}

// A map takes the error of a coarse mesh's normals down to that of its codes, as far as its texels are fine.
TEST(Bake, TheMapTakesTheErrorOfTheMeshAway) {
  const AnySurface torus = make_surface("torus");
  const MapPiece piece = coarse(torus);
  BakeOptions options;
  double before = 90;
  for (const int size : {64, 256, 1024}) {
    options.width = options.height = size;
    options.type = SampleType::u16;
    const BakeResult r = bake(torus, piece, options);
    EXPECT_GT(r.all.without_map_deg.rms, 1) << "the mesh is coarse";
    EXPECT_LT(r.all.with_map_deg.rms, r.all.without_map_deg.rms / 8);
    EXPECT_LT(r.all.with_map_deg.rms, before / 2) << size;
    before = r.all.with_map_deg.rms;
    EXPECT_EQ(r.all.samples, r.errors[static_cast<std::size_t>(VertexClass::seam)].samples +
                                 r.errors[static_cast<std::size_t>(VertexClass::interior)].samples);
  }
  options.type = SampleType::u8;
  const BakeResult eight = bake(torus, piece, options);
  EXPECT_GT(eight.all.with_map_deg.rms, 5 * before) << "what is left is the rounding to 8 bits";
  EXPECT_LT(eight.all.with_map_deg.rms, eight.bound_deg);
}

// A baked map holds what the triangles leave out. It is no relief, so nothing tells which way its green
// points.
TEST(Bake, IsNoReliefToCheckNormalMap) {
  for (const char* name : {"sphere", "torus", "enneper", "hyperbolic-paraboloid", "helicoid", "catenoid",
                           "monkey-saddle", "elliptic-paraboloid", "pseudosphere", "superellipsoid",
                           "ellipsoid:semi_axis_x=2,semi_axis_y=1,semi_axis_z=0.7"})
    for (const auto& [columns, rows] : {std::pair(4, 4), {8, 6}, {16, 12}, {64, 48}})
      for (const auto& [type, size] : {std::pair(SampleType::u8, 256), {SampleType::u16, 128}}) {
        const AnySurface surface = make_surface(name);
        BakeOptions options;
        options.width = options.height = size;
        options.type = type;
        EXPECT_FALSE(check_normal_map(bake(surface, coarse(surface, columns, rows), options).map.image).green)
            << name << ", " << columns << " x " << rows;
      }
}

// On a plane the map says nothing that the mesh does not: half a code of 127.5 in x and in y is left.
TEST(Bake, OfAPlaneIsFlat) {
  const AnySurface plane = make_surface("plane");
  BakeOptions options;
  options.width = options.height = 32;
  const BakeResult r = bake(plane, coarse(plane, 2, 2), options);
  EXPECT_LT(r.all.without_map_deg.max, 1e-6);
  EXPECT_NEAR(r.all.with_map_deg.max, std::atan(std::sqrt(2) / 255) * 180 / M_PI, 1e-6);
  EXPECT_EQ(r.map.covered, 1024u);
}

TEST(Bake, DoesNotDependOnThreadsNorOnTheGreenAndTheOriginThatBothSidesKnow) {
  const AnySurface torus = make_surface("torus");
  MapPiece piece = coarse(torus);
  BakeOptions options;
  options.width = options.height = 200;
  options.basis = MapBasis::mikktspace;
  const BakeResult one = bake(torus, piece, options);
  options.threads = 3;
  EXPECT_EQ(bake(torus, piece, options).map.image.samples, one.map.image.samples);
  options.green = MapGreen::directx;
  EXPECT_NEAR(bake(torus, piece, options).all.with_map_deg.rms, one.all.with_map_deg.rms,
              0.05 * one.all.with_map_deg.rms);
  piece.v_up = true;
  EXPECT_NEAR(bake(torus, piece, options).all.with_map_deg.rms, one.all.with_map_deg.rms,
              0.05 * one.all.with_map_deg.rms);
}

// The mesh of a surface that lies elsewhere and whose uvs are sheared has the errors of the plain one: the
// frames turn with it, and the map is the same at other texels.
TEST(Bake, OfAPlacedSurfaceWithOtherUvs) {
  const AnySurface torus = make_surface("torus");
  BakeOptions options;
  options.width = options.height = 256;
  options.type = SampleType::u16;
  const MapPiece plain = coarse(torus);
  const BakeResult wanted = bake(torus, plain, options);
  SampleMeshOptions sheared;
  sheared.columns = 12;
  sheared.rows = 6;
  sheared.shear = 1;  // u + v, once round
  MapPiece piece{.mesh = sample_mesh(torus, sheared)};
  PlacedSurface surface{torus};
  surface.placement =
      Eigen::Translation3d(3, -2, 5) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized());
  surface.uv = {"affine", {1, -1, 0, 1, 0, 0}};
  const auto turned = [&](const Vec3<double>& a) {
    return from_eigen(surface.placement.linear() * to_eigen(a));
  };
  for (std::size_t v = 0; v < piece.mesh.positions.size(); ++v) {
    piece.mesh.positions[v] = from_eigen(surface.placement * to_eigen(piece.mesh.positions[v]));
    piece.mesh.normals[v] = turned(piece.mesh.normals[v]);
    const Vec3<double> t = turned(piece.mesh.tangents[v].xyz());
    piece.mesh.tangents[v] = {t.x, t.y, t.z, piece.mesh.tangents[v].w};
  }
  const BakeResult r = bake_normal_map(surface, std::span(&piece, 1), options);
  EXPECT_EQ(r.map.covered, wanted.map.covered);
  EXPECT_NEAR(r.all.without_map_deg.rms, wanted.all.without_map_deg.rms, 1e-6);
  // Other texels, so another error between them, of the same size.
  EXPECT_NEAR(r.all.with_map_deg.rms, wanted.all.with_map_deg.rms, 0.5 * wanted.all.with_map_deg.rms);
  EXPECT_GT(bake(torus, piece, options).all.without_map_deg.rms, 20) << "taken as it is";
  // Beyond the map lies what the map repeats, or it is refused.
  const AnySurface graph = make_surface("graph");
  MapPiece leaning{.mesh = sample_mesh(graph, sheared)};
  PlacedSurface open{graph};
  open.uv = surface.uv;
  EXPECT_NE(refusal_of<MeshError>([&] {
              bake_normal_map(open, std::span(&leaning, 1), options);
            }).find("expected uvs from 0 to 1"),
            std::string::npos);
  leaning.wrap = {MapWrap::clamp, MapWrap::clamp};
  EXPECT_GT(bake_normal_map(open, std::span(&leaning, 1), options).map.outside_map, 0u);
}

// A vertex that no triangle has is no part of the map, wherever its uv lies.
TEST(Bake, IgnoresVerticesWithoutTriangles) {
  const AnySurface graph = make_surface("graph");
  MapPiece piece = coarse(graph);
  BakeOptions options;
  options.width = options.height = 32;
  const BakeResult wanted = bake(graph, piece, options);
  Mesh& mesh = piece.mesh;
  mesh.positions.push_back(mesh.positions[0]);
  mesh.normals.push_back(mesh.normals[0]);
  mesh.tangents.push_back(mesh.tangents[0]);
  mesh.uvs.push_back({0.3, 7.4});
  EXPECT_EQ(bake(graph, piece, options).map.image.samples, wanted.map.image.samples);
  mesh.triangles[0][0] = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  EXPECT_NE(refusal_of<MeshError>([&] { bake(graph, piece, options); }).find("(0.3, 7.4)"),
            std::string::npos);
}

TEST(Bake, RefusesWhatItCannotDo) {
  const AnySurface torus = make_surface("torus");
  const MapPiece piece = coarse(torus);
  const auto with = [&](auto change) {
    BakeOptions options;
    options.width = options.height = 8;
    change(options);
    bake(torus, piece, options);
  };
  EXPECT_REFUSED(with([](BakeOptions& o) { o.width = 0; }), "2^28 texels");
  EXPECT_REFUSED(with([](BakeOptions& o) { o.width = o.height = 1 << 20; }), "2^28 texels");
  EXPECT_REFUSED(with([](BakeOptions& o) { o.basis = MapBasis::analytic; }), "stored or mikktspace");
  EXPECT_REFUSED(with([](BakeOptions& o) { o.samples = -1; }), "0 to 10000");
  EXPECT_REFUSED(with([](BakeOptions& o) { o.threads = -1; }), "threads");
  EXPECT_REFUSED(bake_normal_map(torus, {}), "triangles");
  MapPiece wrong = piece;
  wrong.mesh.uvs.clear();
  EXPECT_NE(refusal_of<MeshError>([&] { bake(torus, wrong, {}); }).find("uvs"), std::string::npos);
  wrong = piece;
  wrong.mesh.triangles[0][0] = 1 << 30;
  EXPECT_NE(refusal_of<MeshError>([&] { bake(torus, wrong, {}); }).find("1073741824"), std::string::npos);
}

}  // namespace
}  // namespace darboux::test::bake_test
