// What recognition claims: surfaces that are one, and nothing of polyhedra. The full figures:
// tests/statistics/recognition.sh.
#include <iostream>
#include <map>

#include <gtest/gtest.h>

#include "random_meshes.h"
#include "thinning.h"

namespace darboux::recognition_test {
namespace {

constexpr std::uint64_t seed = 2026;

TEST(Recognition, ClaimsNothingOfPolyhedra) {
  const int each = 50 / test::thinning();  // 750 shapes in long runs: claims of one in 250 pass once in 20
  std::cout << "seeds from " << seed << '\n';
  for (const test::NegativeFamily& family : test::negative_families())
    for (int i = 0; i < each; ++i) {
      const std::string kind =
          test::false_claim(family, test::negative(family, seed + static_cast<std::uint64_t>(i)));
      EXPECT_EQ(kind, "") << family.name << ", seed " << seed + static_cast<std::uint64_t>(i);
    }
}

TEST(Recognition, FindsSurfaces) {
  const int each = std::max(20 / test::thinning(), 5);
  std::cout << "seeds from " << seed << '\n';
  for (const test::PositiveFamily& family : test::positive_families())
    for (const auto storage : {test::Storage::single, test::Storage::half, test::Storage::int16})
      for (const bool uvs : {false, true}) {
        int found = 0;
        for (int i = 0; i < each; ++i)
          found += test::is_recognised(
              family, test::positive(family, storage, uvs, seed + static_cast<std::uint64_t>(i)));
        // Halves round some cones by more than a surface may be off, a ten-thousandth of the size.
        EXPECT_GE(found, storage == test::Storage::half ? each - 1 : each)
            << family.name << " in " << test::storage_names[static_cast<std::size_t>(storage)]
            << (uvs ? " with uvs" : "");
      }
}

// An elliptic cone is no kind of the catalogue. A paraboloid goes through any two rings of it, with normals
// that are not the stored ones.
TEST(Recognition, TwoRingsAreNoParaboloid) {
  for (const double last : {0.5, 0.75, 1.0})
    for (const double y : {0.5, 2.0}) {
      Mesh mesh = sample_mesh(make_surface("cone:radius=1,height=3"),
                              {.columns = 24, .rows = 1, .v_first = 0, .v_last = last});
      for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        mesh.positions[v].y *= y;
        const Vec3<double>& n = mesh.normals[v];
        mesh.normals[v] = unit(Vec3<double>{n.x, n.y / y, n.z});
        const Vec4<double> t = mesh.tangents[v];
        const Vec3<double> along = unit(Vec3<double>{t.x, y * t.y, t.z});
        mesh.tangents[v] = {along.x, along.y, along.z, t.w};
        mesh.uvs[v].y /= last;
      }
      test::round_to_floats(mesh);
      const Assessment assessment = assess(mesh);
      EXPECT_FALSE(assessment.fit && assessment.fit->fits) << last << ' ' << y;
      EXPECT_EQ(assessment.report.verdict, Verdict::pass) << last << ' ' << y;
    }
}

// Some places of large meshes are looked at. Their number may not keep step with the rows of a grid.
TEST(Recognition, FindsSurfacesOfFineGrids) {
  for (const std::string_view name : {"torus", "sphere", "cylinder", "cone", "ellipsoid", "catenoid"})
    for (const int n : {200, 400}) {
      const Mesh mesh = sample_mesh(make_surface(name), {.columns = n, .rows = n});
      const std::vector<Assessment> assessments = assess_parts(mesh);
      ASSERT_EQ(assessments.size(), 1u) << name << ' ' << n;
      ASSERT_TRUE(assessments[0].fit && assessments[0].fit->fits) << name << ' ' << n;
      EXPECT_EQ(assessments[0].fit->surface.surface.info().name, name) << n;
    }
}

}  // namespace
}  // namespace darboux::recognition_test
