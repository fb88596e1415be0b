// What a normal map of a surface leaves of the error of a coarse mesh, stage by stage.
#include <gtest/gtest.h>

#include <darboux/bake.h>
#include <darboux/error.h>
#include <darboux/map_cost.h>
#include <darboux/mesh_frames.h>

#include "map_meshes.h"
#include "refusal_of.h"

namespace darboux::test::map_cost_test {
namespace {

MapPiece coarse(const AnySurface& surface) {
  SampleMeshOptions options;
  options.columns = 24;
  options.rows = 12;
  options.jitter = 0.2;
  return {.mesh = sample_mesh(surface, options)};
}

// Tangents by MikkTSpace, of glTF's sign: a vertex for each corner.
void make_tangents(Mesh& mesh) {
  const MeshFrames frames = mesh_frames(mesh, find_frame_method("mikktspace"));
  Mesh corners;
  for (std::size_t i = 0; i < mesh.corners(); ++i) {
    const std::uint32_t v = mesh.triangles[i / 3][i % 3];
    corners.positions.push_back(mesh.positions[v]);
    corners.normals.push_back(mesh.normals[v]);
    corners.uvs.push_back(mesh.uvs[v]);
    const CornerFrame& f = frames.corner(i);
    corners.tangents.push_back({f.t.x, f.t.y, f.t.z, -static_cast<double>(f.sign)});
    if (i % 3 == 2)
      corners.triangles.push_back({static_cast<std::uint32_t>(i - 2), static_cast<std::uint32_t>(i - 1),
                                   static_cast<std::uint32_t>(i)});
  }
  mesh = corners;
}

TEST(MapCost, StagesAreThoseOfTheChain) {
  const PlacedSurface torus{make_surface("torus:major_radius=1,minor_radius=0.4")};
  MapPiece piece = coarse(torus.surface);
  make_tangents(piece.mesh);
  const MapCostOptions options{.width = 512, .height = 512};
  const MapCost cost = normal_map_cost(torus, piece, options);
  const MapCostStages& all = cost.all;
  EXPECT_EQ(cost.conflicts, 0u);
  EXPECT_EQ(all.samples, 16 * piece.mesh.triangles.size());
  // A chord of h = 2 pi 0.4 / 12 round the tube turns by h / 0.4 = 30 degrees: 15 at its ends, more by
  // jitter.
  EXPECT_GT(all.triangle_deg.max, 12);
  EXPECT_LT(all.triangle_deg.max, 30);
  // Interpolation is of second order: 30 degrees squared over 8 is 2.
  EXPECT_LT(all.normal_deg.max, 5);
  EXPECT_LT(all.frame_deg.max, 1e-5) << "the stored tangents are those the map is made for";
  // The three maps are those of bake(), with its errors.
  BakeOptions bake;
  bake.width = bake.height = 512;
  for (const auto& [type, stage] : {std::pair{SampleType::f32, &MapCostStages::texel_deg},
                                    {SampleType::u16, &MapCostStages::codes16_deg},
                                    {SampleType::u8, &MapCostStages::codes8_deg}}) {
    bake.type = type;
    const BakeResult wanted = bake_normal_map(torus, std::span(&piece, 1), bake);
    EXPECT_NEAR(all.normal_deg.rms, wanted.all.without_map_deg.rms, 1e-12);
    EXPECT_NEAR((all.*stage).rms, wanted.all.with_map_deg.rms, 1e-6);
  }
  EXPECT_GT(all.codes8_deg.rms, 2 * all.codes16_deg.rms);
  std::size_t samples = 0;
  for (const MapCostStages& of : cost.classes) samples += of.samples;
  EXPECT_EQ(samples, all.samples);
  EXPECT_LT(normal_map_cost(torus, piece, {.width = 1024, .height = 1024}).all.texel_deg.rms,
            all.texel_deg.rms);
}

// A map read in other frames than it was made for: tangents turned by a degree about their normals turn the
// normals by a degree about the mesh's, which are off by less than 5 degrees: 5 sin 1 = 0.09 degrees.
TEST(MapCost, OtherFramesThanTheBakersCost) {
  const PlacedSurface torus{make_surface("torus:major_radius=1,minor_radius=0.4")};
  MapPiece piece = coarse(torus.surface);
  make_tangents(piece.mesh);
  const MapCost right = normal_map_cost(torus, piece, {.width = 64, .height = 64});
  const double s = std::sin(M_PI / 180), c = std::cos(M_PI / 180);
  for (std::size_t v = 0; v < piece.mesh.tangents.size(); ++v) {
    Vec4<double>& t = piece.mesh.tangents[v];
    const Vec3<double> turned = c * t.xyz() + s * cross(piece.mesh.normals[v], t.xyz());
    t = {turned.x, turned.y, turned.z, t.w};
  }
  const MapCost cost = normal_map_cost(torus, piece, {.width = 64, .height = 64});
  EXPECT_EQ(cost.all.normal_deg.rms, right.all.normal_deg.rms);
  EXPECT_GT(cost.all.frame_deg.max, 0.01);
  EXPECT_LT(cost.all.frame_deg.max, 0.09);
  // Turned by half a turn, and of the other sign, the normals lean the wrong way: twice the mesh's error.
  for (Vec4<double>& t : piece.mesh.tangents) t = {-t.x, -t.y, -t.z, t.w};
  EXPECT_NEAR(normal_map_cost(torus, piece, {.width = 64, .height = 64}).all.frame_deg.rms,
              2 * right.all.normal_deg.rms, 0.1 * right.all.normal_deg.rms);
  piece.mesh.tangents.clear();
  EXPECT_LT(normal_map_cost(torus, piece, {.width = 64, .height = 64}).all.frame_deg.max, 1e-5)
      << "none are stored";
}

// Triangles on the same texels, whose frames differ, want two maps; so do uvs that repeat where the surface
// does not.
TEST(MapCost, OverlappingIslandsHaveNoMap) {
  const PlacedSurface sphere{make_surface("sphere")};
  MapPiece piece = coarse(sphere.surface);
  const std::size_t vertices = piece.mesh.positions.size(), triangles = piece.mesh.triangles.size();
  Mesh& mesh = piece.mesh;
  for (std::size_t v = 0; v < vertices; ++v) {
    mesh.positions.push_back(mesh.positions[v]);
    mesh.normals.push_back(unit(mesh.normals[v] + Vec3<double>{0.1, 0.2, 0.3}));
    mesh.uvs.push_back(mesh.uvs[v]);
    mesh.tangents.push_back(mesh.tangents[v]);
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    Triangle t = mesh.triangles[i];
    for (std::uint32_t& v : t) v += static_cast<std::uint32_t>(vertices);
    mesh.triangles.push_back(t);
  }
  const MapCost cost = normal_map_cost(sphere, piece, {.width = 64, .height = 64});
  EXPECT_GT(cost.conflicts, 2000u);
  EXPECT_GT(cost.all.normal_deg.rms, 1);
  EXPECT_EQ(cost.all.texel_deg.max, 0);
  MapPiece repeats = coarse(sphere.surface);
  for (Vec2<double>& uv : repeats.mesh.uvs) uv.x *= 2;
  PlacedSurface twice = sphere;
  twice.uv = {"affine", {0.5, 0, 0, 1, 0, 0}};
  EXPECT_NE(refusal_of<MeshError>([&] { normal_map_cost(twice, repeats); }).find("uvs from 0 to 1"),
            std::string::npos);
}

TEST(MapCost, DoesNotDependOnThreads) {
  const PlacedSurface torus{make_surface("torus")};
  const MapPiece piece = coarse(torus.surface);
  const MapCost one = normal_map_cost(torus, piece, {.width = 128, .height = 128}),
                three = normal_map_cost(torus, piece, {.width = 128, .height = 128, .threads = 3});
  EXPECT_EQ(one.all.codes8_deg.rms, three.all.codes8_deg.rms);
  EXPECT_EQ(one.all.frame_deg.max, three.all.frame_deg.max);
}

}  // namespace
}  // namespace darboux::test::map_cost_test
