// Batches of placed surfaces, which run in lanes, give the bits of single points.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/evaluate.h>

#include "adapted.h"
#include "random.h"

namespace darboux::test::placed_batch_test {
namespace {

constexpr std::array few_attributes{
    Attributes(Attribute::tangent),          Attribute::position | Attribute::normal,
    Attribute::position | Attribute::d2pduv, frame_attributes,
    partial_attributes | frame_attributes,   partial_attributes | frame_attributes | curvature_attributes};

// All results of a batch as bytes: of arrays per component, or of structs.
template <class T>
struct Results {
  std::vector<T> numbers;
  std::vector<Status> status;
  StatusSummary summary;
};

template <class T>
Results<T> results(const AnySurface& surface, const Points<T>& points, Attributes asked, bool structs,
                   const EvaluateOptions& options) {
  const std::size_t n = points.size();
  std::size_t components = 0;
  for (std::size_t a = 0; a < attribute_count; ++a)
    if (asked.has(static_cast<Attribute>(a))) components += attribute_infos[a].components;
  Results<T> result{std::vector<T>(n * components), std::vector<Status>(n), {}};
  Outputs<T> outputs;
  std::size_t row = 0;
  for (std::size_t a = 0; a < attribute_count; ++a) {
    const auto attribute = static_cast<Attribute>(a);
    if (!asked.has(attribute)) continue;
    const std::size_t count = attribute_infos[a].components;
    if (structs) {
      outputs.member(attribute, &result.numbers[row], n, static_cast<std::ptrdiff_t>(components * sizeof(T)));
    } else {
      std::vector<std::span<T>> rows;
      for (std::size_t c = 0; c < count; ++c) rows.emplace_back(&result.numbers[(row + c) * n], n);
      outputs.separate(attribute, rows);
    }
    row += count;
  }
  outputs.status(result.status);
  result.summary = surface.evaluate(points, outputs, options);
  return result;
}

template <class T>
void expect_same(const Results<T>& one, const Results<T>& other, const std::string& what) {
  std::size_t differ = 0;
  for (std::size_t i = 0; i < one.numbers.size(); ++i)
    differ += !(std::isnan(one.numbers[i]) && std::isnan(other.numbers[i])) &&
              std::memcmp(&one.numbers[i], &other.numbers[i], sizeof(T)) != 0;
  EXPECT_EQ(differ, 0u) << what;
  EXPECT_EQ(one.status, other.status) << what;
  EXPECT_EQ(one.summary.count, other.summary.count) << what;
  for (std::size_t k = 0; k < one.summary.count.size(); ++k) {
    if (one.summary.count[k] > 0) {
      EXPECT_EQ(one.summary.first[k], other.summary.first[k]) << what;
    }
  }
  EXPECT_EQ(one.summary.points, other.summary.points) << what;
}

// Of the adapted surfaces those that are placed.
std::vector<Adapted> every_placed() {
  std::vector<Adapted> result;
  for (Adapted& x : every_adapted())
    if (x.A != Linear{1, 0, 0, 0, 1, 0, 0, 0, 1}) result.push_back(std::move(x));
  return result;
}

class EveryPlaced : public ::testing::TestWithParam<Adapted> {
 public:
  template <class T>
  void check() {
    const AnySurface& surface = GetParam().surface;
    Random random(41);
    std::vector<T> u, v;
    const auto add = [&](double x, double y) {
      u.push_back(static_cast<T>(x)), v.push_back(static_cast<T>(y));
    };
    for (int i = 0; i < 300; ++i) add(random.uniform(), random.uniform());
    for (const double x : {0.0, 0.25, 0.5, 1.0, -0.25, 1.5})
      for (const double y : {0.0, 0.5, 1.0, 1.25}) add(x, y);
    add(std::numeric_limits<double>::quiet_NaN(), 0.5), add(0.5, std::numeric_limits<double>::infinity());
    // More than one block, and no whole number of registers.
    for (int i = 0; i < 77; ++i) add(random.uniform(), random.uniform());
    const std::array points{Points<T>::arrays(u, v), Points<T>::grid(17, 19)};
    for (const Points<T>& at : points)
      for (const Attributes asked : few_attributes)
        for (const bool structs : {false, true}) {
          const SignConvention sign = structs ? SignConvention::raw : SignConvention::gltf;
          EvaluateOptions options{.sign = sign, .instruction_set = InstructionSet::points};
          const Results<T> expected = results(surface, at, asked, structs, options);
          for (const InstructionSet set : instruction_sets()) {
            options.instruction_set = set;
            options.threads = structs ? 3 : 1;
            expect_same(results(surface, at, asked, structs, options), expected,
                        std::string(name_of(set)) + (structs ? " structs" : " arrays"));
          }
        }
  }
};
INSTANTIATE_TEST_SUITE_P(Adaptors, EveryPlaced, ::testing::ValuesIn(every_placed()),
                         [](const auto& info) { return info.param.name; });

TEST_P(EveryPlaced, GivesTheBitsOfSinglePointsInDouble) {
  check<double>();
}
TEST_P(EveryPlaced, GivesTheBitsOfSinglePointsInFloat) {
  check<float>();
}

// All points of a placed surface go through its kernel, but for the rows at poles.
TEST(PlacedBatch, RunsInLanes) {
  const auto point_by_point = [](const auto& surface) {
    std::vector<double> n(3 * 41 * 41);
    Outputs<double> outputs;
    outputs.packed(Attribute::normal, n);
    return evaluate(surface, Points<double>::grid(40, 40), outputs).point_by_point;
  };
  if (instruction_sets().size() < 2) GTEST_SKIP() << "this build has no kernels";
  EXPECT_LE(point_by_point(Placed{Sphere{1.0}, uneven, {1, 2, 3}}), 2u * 41 + 16);  // the rows of the poles
  EXPECT_EQ(point_by_point(Placed{Torus{1.0, 0.25}, uneven, {1, 2, 3}}), 0u);
  EXPECT_EQ(point_by_point(Placed{Placed{Torus{1.0, 0.25}, uneven, {1, 2, 3}}, uneven, {0, 0, 1}}), 0u);
}

}  // namespace
}  // namespace darboux::test::placed_batch_test
