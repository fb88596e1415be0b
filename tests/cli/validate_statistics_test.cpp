// `validate --json` against a second computation from the file alone: what is printed of each class is what
// second_opinion.h finds.
#include "cli.h"
#include "second_shapes.h"

namespace darboux::test::validate_statistics_test {
namespace {

std::optional<Statistics> printed(const Json& of_class, const char* quantity) {
  if (!of_class.contains(quantity)) return std::nullopt;
  const Json& s = of_class[quantity];
  return Statistics{.max = s["max"], .rms = s["rms"], .p95 = s["p95"]};
}

std::string option(const Eigen::Isometry3d& placement) {
  std::string text = "--placement ";
  for (int k = 0; k < 16; ++k)
    text += (k > 0 ? "," : "") + std::to_string(static_cast<int>(placement.matrix().data()[k]));
  return text;
}

// Of surfaces and placements that are declared: nothing is fitted, so only the rounding of doubles lies
// between the two.
TEST_F(Cli, JsonStatisticsAreThoseOfASecondComputation) {
  for (const std::string name : {"jittertorus_016.mikk.glb", "plainsphere_016.three.glb"}) {
    const Shape shape = *shape_of(name);
    const Json mesh = only_mesh(Json::parse(sh("darboux validate data/" + name + " --json --surface " +
                                               shape.specification + ' ' + option(shape.placement))
                                                .out));
    EXPECT_EQ(mesh["reference"], "analytic");
    const Read file = second_read(path("data/" + name));
    const Truths truths = truths_of(file, shape, shape.placement.linear());
    const auto expected = second_opinion(file, truths.at, truths.pole, [](std::size_t) { return true; });
    EXPECT_EQ(mesh["classes"].size(), expected.size());
    for (const auto& [vertex_class, e] : expected) {
      const std::string class_name(vertex_class_names[static_cast<std::size_t>(vertex_class)]);
      const std::string what = name + ", " + class_name;
      ASSERT_TRUE(mesh["classes"].contains(class_name)) << what;
      const Json& c = mesh["classes"][class_name];
      EXPECT_EQ(c["corners"], e.corners) << what;
      const double rounding = 5e-14;  // degrees: a unit vector of doubles is turned by some 6e-15
      expect_same(printed(c, "normal_deg"), e.normal, rounding, what + " normals");
      expect_same(printed(c, "tangent_deg"), e.tangent, rounding, what + " tangents");
      expect_same(printed(c, "bitangent_deg"), e.bitangent, rounding, what + " bitangents");
    }
  }
}

}  // namespace
}  // namespace darboux::test::validate_statistics_test
