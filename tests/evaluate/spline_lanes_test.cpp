// Places in the lists of splines over lanes are whole numbers, however long the lists are.
#include "evaluate/kernels/spline_lanes.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace darboux::spline_lanes_test {
namespace {

using S = kernels::Lanes<float>;
using Place = detail::SpanPlace<S>;

constexpr int beyond_float = (1 << 24) + 1;  // the first whole number that float lacks

// What SpanPlace asks of a knot vector, of so many spans that their knots need not be there.
struct ManySpans {
  std::vector<float> none;
  const std::vector<float>& knots() const { return none; }
  int degree() const { return 1; }
  int count() const { return 2 * beyond_float; }
  int not_empty(int m) const { return m; }
  int find(float t) const { return t < 0.5F ? beyond_float : beyond_float + 2; }
};

TEST(SplineLanes, FindsSpansThatFloatLacks) {
  float t[S::lanes] = {};
  EXPECT_TRUE(Place::find(ManySpans{}, S::load(t)).same);
  t[1] = 1;
  const Place found = Place::find(ManySpans{}, S::load(t));
  EXPECT_FALSE(found.same);
  for (std::size_t k = 0; k < S::lanes; ++k) EXPECT_EQ(found.at[k], beyond_float + (k == 1 ? 2 : 0));
}

}  // namespace
}  // namespace darboux::spline_lanes_test
