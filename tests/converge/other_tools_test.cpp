// Orders that were measured on the files of other people's tools, on the same meshes: three.js r187's
// computeTangents is `average`, mikktspace 1.1.1 `mikktspace`.
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/converge.h>

namespace darboux::other_tools_test {
namespace {

constexpr double tolerance = 0.15;
constexpr std::uint64_t seed = 20261121;

// three.js lays the vertices of a sphere's pole half a cell off.
constexpr MeshFamily half_cell_poles{.name = "half-cell", .summary = "", .pole = PolePlacement::half_cell};

struct Row {
  const char* surface;
  const MeshFamily* family;
  VertexClass vertex_class;
  std::optional<double> average, mikktspace;  // order of the rms from 64 to 128 rows; none: at the floor
};

std::vector<Row> rows() {
  const MeshFamily *regular = &find_mesh_family("regular"), *jittered = &find_mesh_family("jittered"),
                   *sheared = &find_mesh_family("sheared");
  constexpr auto interior = VertexClass::interior, seam = VertexClass::seam, ring = VertexClass::pole_ring,
                 pole = VertexClass::pole;
  constexpr const char *torus = "torus:major_radius=1,minor_radius=0.4",
                       *ellipsoid = "ellipsoid:semi_axis_x=1,semi_axis_y=0.7,semi_axis_z=0.5";
  constexpr auto floor = std::nullopt;
  return {{torus, regular, interior, 2.0, floor},
          {torus, regular, seam, 1.0, 1.0},
          {torus, jittered, interior, 1.0, 1.0},
          {torus, jittered, seam, 1.0, 1.0},
          {torus, sheared, interior, 2.0, floor},
          {torus, sheared, seam, 1.0, 1.0},
          {"sphere", &half_cell_poles, interior, 1.4, floor},
          {"sphere", &half_cell_poles, seam, 1.0, 1.0},
          {"sphere", &half_cell_poles, ring, 1.0, floor},
          {"sphere", &half_cell_poles, pole, floor, floor},
          {"sphere", regular, interior, 1.4, floor},
          {"sphere", regular, seam, 1.0, 1.0},
          {"sphere", regular, ring, 1.0, floor},
          {"sphere", regular, pole, 1.0, 1.0},
          {ellipsoid, &half_cell_poles, interior, 1.4, 2.0},
          {ellipsoid, &half_cell_poles, seam, 1.0, 1.0},
          {ellipsoid, &half_cell_poles, ring, 1.0, 2.0},
          {ellipsoid, &half_cell_poles, pole, floor, floor},
          {"cylinder", regular, interior, floor, floor},
          {"cylinder", regular, seam, floor, floor}};
}

TEST(OtherTools, OrdersAreTheirs) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  for (const Row& row : rows()) {
    ConvergeOptions o;
    o.surfaces = {make_surface(row.surface)};
    o.families = {row.family};
    o.methods = {&find_frame_method("average"), &find_frame_method("mikktspace")};
    o.resolutions = {32, 64, 128};
    o.seed = seed;
    for (const Study& s : converge(o)) {
      if (s.vertex_class != row.vertex_class || s.quantity != "tangent") continue;
      const std::optional<double> expected = s.method == "average" ? row.average : row.mikktspace;
      const Level &coarse = s.levels[1], &fine = s.levels[2];
      const std::string what = s.surface + ' ' + std::string(s.mesh) + ' ' + std::string(s.method) + ' ' +
                               std::string(vertex_class_names[static_cast<std::size_t>(s.vertex_class)]);
      if (!expected) {
        EXPECT_LT(fine.rms_deg, fine.floor_deg) << what;
      } else {
        EXPECT_NEAR(std::log2(coarse.rms_deg / fine.rms_deg), *expected, tolerance) << what;
      }
    }
  }
}

}  // namespace
}  // namespace darboux::other_tools_test
