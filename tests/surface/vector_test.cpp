#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <darboux/vector.h>

namespace darboux::vector_test {
namespace {

TEST(Vec3, ArithmeticIsComponentwise) {
  const Vec3<double> a{1, 2, 3}, b{4, -5, 6};
  EXPECT_EQ(a + b, (Vec3<double>{5, -3, 9}));
  EXPECT_EQ(a - b, (Vec3<double>{-3, 7, -3}));
  EXPECT_EQ(-a, (Vec3<double>{-1, -2, -3}));
  EXPECT_EQ(2.0 * a, a * 2.0);
  EXPECT_EQ(a / 2.0, (Vec3<double>{0.5, 1, 1.5}));
  Vec3<double> c = a;
  EXPECT_EQ(c += b, a + b);
}

TEST(Vec3, DotAndCrossOfIntegersAreExact) {
  const Vec3<double> a{1, 2, 3}, b{4, -5, 6};
  EXPECT_EQ(dot(a, b), 12);
  EXPECT_EQ(cross(a, b), (Vec3<double>{27, 6, -13}));
  EXPECT_EQ(cross(b, a), -cross(a, b));
  EXPECT_EQ(cross(Vec3<double>{1, 0, 0}, Vec3<double>{0, 1, 0}), (Vec3<double>{0, 0, 1}));
}

TEST(Vec3, CrossesToEigenAndBack) {
  const Vec3<double> a{1, 2, 3}, b{4, -5, 6};
  EXPECT_EQ(from_eigen(to_eigen(a)), a);
  EXPECT_EQ(from_eigen(to_eigen(a) + to_eigen(b)), a + b);
  EXPECT_EQ(from_eigen(to_eigen(a).cross(to_eigen(b))), cross(a, b));
}

TEST(Vec4, HoldsDirectionAndSign) {
  constexpr Vec4<float> tangent{1, 2, 3, -1};
  EXPECT_EQ(tangent.xyz(), (Vec3<float>{1, 2, 3}));
  EXPECT_NE(tangent, (Vec4<float>{1, 2, 3, 1}));
}

}  // namespace
}  // namespace darboux::vector_test
