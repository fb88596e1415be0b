// What is asked of a mesh before any surface is fitted: the algebraic surfaces its places lie on.
#include <cmath>
#include <iostream>
#include <numbers>

#include <gtest/gtest.h>

#include "assess/shape.h"
#include "random_meshes.h"

namespace darboux::recognise_shape_test {
namespace {

constexpr std::uint64_t seed = 24;

Mesh rounded_to_float(Mesh mesh) {
  for (Vec3<double>& p : mesh.positions)
    p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  return mesh;
}

// (|p|² + R² - r²)² = 4 R² (x² + y²) has no other terms, and keeps its form in any position.
TEST(RecogniseShape, EveryTorusIsACyclide) {
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  for (int i = 0; i < 300; ++i) {
    const double minor = test::uniform(random, 0.05, 1.5), u = test::uniform(random, 0.1, 1),
                 v = test::uniform(random, 0, 0.9);
    Mesh mesh = sample_mesh(make_surface("torus:major_radius=1,minor_radius=" + std::to_string(minor)),
                            {.columns = test::integer(random, 6, 60),
                             .rows = test::integer(random, 6, 60),
                             .v_first = v,
                             .v_last = test::uniform(random, v + 0.1, 1)});
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
      return std::any_of(t.begin(), t.end(), [&](std::uint32_t k) { return mesh.uvs[k].x > u; });
    });
    place(mesh, random_pose(random, 100));
    mesh = rounded_to_float(std::move(mesh));
    EXPECT_TRUE(may_be_cyclide(mesh, shape_of(mesh))) << "torus " << i << ", tube of " << minor;
  }
}

// A torus whose tube waves is none, nor is a Klein bottle.
TEST(RecogniseShape, OtherClosedSurfacesAreNoCyclides) {
  for (const std::string_view name : {"klein-bottle", "superellipsoid:exponent_u=0.5,exponent_v=0.5"}) {
    const Mesh mesh = sample_mesh(make_surface(name), {.columns = 40, .rows = 30});
    EXPECT_FALSE(may_be_cyclide(mesh, shape_of(mesh))) << name;
  }
  Mesh mesh = sample_mesh(make_surface("torus:major_radius=1,minor_radius=0.4"), {.columns = 48, .rows = 24});
  for (Vec3<double>& p : mesh.positions) p = (1 + 0.05 * std::sin(5 * std::atan2(p.y, p.x))) * p;
  EXPECT_FALSE(may_be_cyclide(mesh, shape_of(mesh)));
}

}  // namespace
}  // namespace darboux::recognise_shape_test
