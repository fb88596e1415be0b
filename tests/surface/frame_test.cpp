#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/frame.h>

#include "base/linear_algebra.h"
#include "every_surface.h"
#include "multiprecision.h"
#include "random.h"

namespace darboux::test::frame_test {
namespace {

constexpr double u = 0x1p-53;  // unit roundoff
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr int points = 20'000;

Vec3<Boost40> many(const Vec3<double>& a) {
  return {a.x, a.y, a.z};
}
Vec3<Boost40> unit_many(const Vec3<Boost40>& a) {
  return (1 / sqrt(dot(a, a))) * a;
}
double distance(const Vec3<double>& a, const Vec3<Boost40>& b) {
  const Vec3<Boost40> d = many(a) - b;
  return static_cast<double>(sqrt(dot(d, d)));
}
bool all_nan(const Vec3<double>& a) {
  return std::isnan(a.x) && std::isnan(a.y) && std::isnan(a.z);
}

double deviation_from_rotation(const Eigen::Matrix3d& m) {
  return (m.transpose() * m - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

Frame<double> random_frame(Random& random) {
  return frame_from_partials(random.direction(), random.direction());
}

// ---- difference of products, norm, unit, angle
// ----------------------------------------------------------------

TEST(DifferenceOfProducts, ErrsByAtMostTwoUlpsWhateverCancels) {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < points; ++i) {
    const double a = random.uniform(-1, 1), b = random.uniform(-1, 1);
    // c d agrees with a b in up to all its digits.
    const double slip = random.sign() * random.log_uniform(1e-17, 1);
    const double c = a * (1 + slip), d = b * (1 - slip * random.uniform());
    const Boost40 exact = Boost40(a) * b - Boost40(c) * d;
    const double computed = difference_of_products(a, b, c, d);
    if (exact == 0) {
      EXPECT_EQ(computed, 0);
      continue;
    }
    const Boost40 ulp = ldexp(Boost40(1), ilogb(exact) - 52);
    worst = std::max(worst, static_cast<double>(abs(computed - exact) / ulp));
  }
  std::cout << worst << " ulp\n";
  EXPECT_LE(worst, 2);  // as documented; the two products are exact, three sums are rounded
}

TEST(Norm, IsAccurateAtEverySize) {
  Random random(2);
  double worst = 0, worst_unit = 0;
  for (int i = 0; i < points; ++i) {
    const Vec3<double> a = random.log_uniform(1e-300, 1e300) * random.direction();
    const Boost40 exact = sqrt(dot(many(a), many(a)));
    worst = std::max(worst, static_cast<double>(abs(norm(a) - exact) / exact));
    worst_unit = std::max(worst_unit, distance(unit(a), unit_many(many(a))));
  }
  std::cout << worst / u << "u, unit " << worst_unit / u << "u\n";
  // Squares and two sums err by 3u, halved by the root, and the root by u.
  EXPECT_LE(worst, 2.5 * u);
  // And the division by u.
  EXPECT_LE(worst_unit, 3.5 * u);
}

TEST(Norm, SpecialVectors) {
  constexpr double tiny = std::numeric_limits<double>::denorm_min(),
                   huge = std::numeric_limits<double>::max();
  EXPECT_EQ(norm(Vec3<double>{}), 0);
  EXPECT_EQ(unit(Vec3<double>{}), Vec3<double>{});
  EXPECT_EQ(norm(Vec3<double>{0, tiny, 0}), tiny);
  EXPECT_EQ(unit(Vec3<double>{0, tiny, 0}), (Vec3<double>{0, 1, 0}));
  EXPECT_EQ(unit(Vec3<double>{huge, 0, 0}), (Vec3<double>{1, 0, 0}));
  EXPECT_EQ(norm(Vec3<double>{3 * 0x1p700, 0, 4 * 0x1p700}), 5 * 0x1p700);
  EXPECT_EQ(norm(Vec3<double>{huge, huge, 0}), infinity);
  EXPECT_TRUE(std::isnan(norm(Vec3<double>{nan_value, 1, 0})));
}

TEST(AngleBetween, IsAccurateNearZeroAndNearPi) {
  Random random(3);
  double worst = 0;
  for (int i = 0; i < points; ++i) {
    const Frame<double> f = random_frame(random);
    const double angle = random.log_uniform(1e-15, 1.5);
    const Vec3<double> a = random.log_uniform(1e-200, 1e200) * f.t,
                       b = random.log_uniform(1e-200, 1e200) * (f.t + std::tan(angle) * f.b);
    const Vec3<Boost40> c = cross(unit_many(many(a)), unit_many(many(b)));
    const Boost40 cosine = dot(unit_many(many(a)), unit_many(many(b)));
    const Boost40 exact = atan2(Boost40(sqrt(dot(c, c))), cosine);
    worst = std::max({worst, static_cast<double>(abs(angle_between(a, b) - exact)),
                      static_cast<double>(abs(angle_between(a, -b) - (pi<Boost40>() - exact)))});
  }
  std::cout << worst / u << "u\n";
  // The two unit vectors err by 3.5u each; the result, up to π, by one rounding of its two, 2u.
  EXPECT_LE(worst, 9 * u);
  EXPECT_EQ(angle_between(Vec3<double>{1, 2, 3}, Vec3<double>{2, 4, 6}), 0);
  EXPECT_EQ(angle_between(Vec3<double>{1, 0, 0}, Vec3<double>{-1e-300, 0, 0}), pi<double>());
}

// ---- frame_from_partials
// ----------------------------------------------------------------------------------------

TEST(FrameFromPartials, IsAccurateAtEveryLengthAndNearlyParallel) {
  Random random(4);
  double worst_t = 0, worst_b = 0, worst_n = 0, worst_rotation = 0;
  for (int i = 0; i < points; ++i) {
    const Frame<double> axes = random_frame(random);
    const double angle = random.log_uniform(1e-8, 1.5);
    const Vec3<double> dpdu = random.log_uniform(1e-160, 1e160) * axes.t;
    const Vec3<double> dpdv = random.log_uniform(1e-160, 1e160) *
                              (random.sign() * axes.t + random.sign() * std::tan(angle) * axes.b);
    const Frame<double> f = frame_from_partials(dpdu, dpdv);
    ASSERT_EQ(f.status, Status::regular);
    EXPECT_EQ(f.handedness, 1);
    const Vec3<Boost40> t = unit_many(many(dpdu)), n = unit_many(cross(many(dpdu), many(dpdv)));
    worst_t = std::max(worst_t, distance(f.t, t));
    worst_n = std::max(worst_n, distance(f.n, n));
    worst_b = std::max(worst_b, distance(f.b, cross(n, t)));
    worst_rotation = std::max(worst_rotation, deviation_from_rotation(tangent_to_object(f)));
  }
  std::cout << "t " << worst_t / u << "u, b " << worst_b / u << "u, n " << worst_n / u << "u, rotation "
            << worst_rotation / u << "u\n";
  // For the partials as given, however nearly parallel, since each component of the cross product keeps its
  // digits: t 3.5u (see Norm); n 2 ulp = 4u per component more; b the errors of both and 4u: 15u.
  EXPECT_LE(worst_t, 3.5 * u);
  EXPECT_LE(worst_n, 8 * u);
  EXPECT_LE(worst_b, 15 * u);
  EXPECT_LE(worst_rotation, 16 * u);
}

TEST(FrameFromPartials, FlagsWhatHasNoFrame) {
  const Vec3<double> zero{}, x{1, 0, 0}, y{0, 1, 0};
  const auto expect_none = [](const Frame<double>& f, Status why) {
    EXPECT_EQ(f.status, Status::no_frame | why);
    EXPECT_TRUE(all_nan(f.t) && all_nan(f.b) && all_nan(f.n));
  };
  expect_none(frame_from_partials(zero, y), Status::dpdu_zero);
  expect_none(frame_from_partials(x, zero), Status::dpdv_zero);
  expect_none(frame_from_partials(zero, zero), Status::dpdu_zero | Status::dpdv_zero);
  expect_none(frame_from_partials(x, -2.0 * x), Status::parallel);
  expect_none(frame_from_partials(Vec3<double>{1e-200, 2e-200, 3e-200}, Vec3<double>{1e-200, 2e-200, 3e-200}),
              Status::parallel);
  for (const double bad : {nan_value, infinity, -infinity}) {
    expect_none(frame_from_partials(Vec3<double>{bad, 0, 0}, y), Status::non_finite_input);
    expect_none(frame_from_partials(x, Vec3<double>{0, 0, bad}), Status::non_finite_input);
  }
}

TEST(FrameFromPartials, ServesFloat) {
  const Frame<float> f = frame_from_partials(Vec3<float>{0, 2e30F, 0}, Vec3<float>{3e-30F, 1e-30F, 0});
  EXPECT_EQ(f.t, (Vec3<float>{0, 1, 0}));
  EXPECT_EQ(f.n, (Vec3<float>{0, 0, -1}));
  EXPECT_EQ(f.b, (Vec3<float>{1, 0, 0}));
}

// ---- Gram-Schmidt
// ------------------------------------------------------------------------------------------------

TEST(GramSchmidt, FollowsItsFormulas) {
  Random random(5);
  double worst = 0, worst_rotation = 0;
  for (int i = 0; i < points; ++i) {
    const Frame<double> axes = random_frame(random);
    // Up to 30 degrees off, of any length, left-handed half of the time.
    const double side = random.sign();
    const Vec3<double> t =
        random.log_uniform(1e-3, 1e3) * (axes.t + random.uniform(0, 0.5) * random.direction());
    const Vec3<double> b =
        random.log_uniform(1e-3, 1e3) * (side * axes.b + random.uniform(0, 0.3) * random.direction());
    const Orthogonalised<double> o = gram_schmidt(t, b, axes.n);
    const Vec3<Boost40> T = many(t), B = many(b), N = many(axes.n);
    const Vec3<Boost40> t1 = unit_many(T - dot(T, N) * N);
    const Vec3<Boost40> b1 = unit_many(B - dot(B, N) * N - dot(B, t1) * t1);
    worst = std::max({worst, distance(o.t, t1), distance(o.b, b1)});
    EXPECT_EQ(o.n, axes.n);
    EXPECT_EQ(o.status, Status::regular);
    EXPECT_EQ(o.handedness, side);
    EXPECT_GT(dot(o.b, b), 0);
    EXPECT_GT(dot(o.t, t), 0);
    Eigen::Matrix3d m;
    m << to_eigen(o.t), to_eigen(o.b), to_eigen(o.n);
    worst_rotation = std::max(worst_rotation, deviation_from_rotation(m));
  }
  std::cout << worst / u << "u, rotation " << worst_rotation / u << "u\n";
  // The part taken off is at most 0.5 of 1.5 in t and 0.6 of 1.3 in b, so the rest is longer than 0.7 and 0.5
  // of it: 10 roundings of the whole are 20 of the rest, and b adds t's error.
  EXPECT_LE(worst, 40 * u);
  EXPECT_LE(worst_rotation, 40 * u);
}

TEST(GramSchmidt, LeavesAnOrthonormalFrame) {
  const Vec3<double> x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const auto right = gram_schmidt(x, y, z), left = gram_schmidt(x, -y, z);
  EXPECT_EQ(right.t, x);
  EXPECT_EQ(right.b, y);
  EXPECT_EQ(right.handedness, 1);
  EXPECT_EQ(left.b, -y);
  EXPECT_EQ(left.handedness, -1);
}

TEST(GramSchmidt, FlagsWhatItCannotOrthogonalise) {
  const Vec3<double> x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const auto along_normal = gram_schmidt(3.0 * z, y, z);
  EXPECT_EQ(along_normal.status, Status::no_frame);
  EXPECT_TRUE(all_nan(along_normal.t) && all_nan(along_normal.b));
  const auto in_plane = gram_schmidt(x, 2.0 * x + z, z);
  EXPECT_EQ(in_plane.status, Status::no_frame);
  EXPECT_EQ(in_plane.t, x);
  EXPECT_TRUE(all_nan(in_plane.b));
  EXPECT_EQ(gram_schmidt(Vec3<double>{}, y, z).status, Status::no_frame);
}

// The same in general position, where rounding leaves a residue of the parts taken off: a residue is no
// direction.
TEST(GramSchmidt, FlagsWhatItCannotOrthogonaliseInGeneralPosition) {
  Random random(6);
  int missed_t = 0, missed_b = 0;
  for (int i = 0; i < 1000; ++i) {
    const Frame<double> f = random_frame(random);
    const double length = random.log_uniform(1e-3, 1e3);
    missed_t += gram_schmidt(length * f.n, f.b, f.n).status != Status::no_frame;
    missed_b += gram_schmidt(f.t, length * (f.t + 2.0 * f.n), f.n).status != Status::no_frame;
  }
  EXPECT_EQ(missed_t, 0);
  EXPECT_EQ(missed_b, 0);
}

// ---- rotation between spaces
// ---------------------------------------------------------------------------------------

TEST(Rotation, BothWaysAreInverse) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const Frame<double> f = random_frame(random);
    const Eigen::Matrix3d to_object = tangent_to_object(f), to_tangent = object_to_tangent(f);
    EXPECT_EQ(to_tangent, to_object.transpose());
    EXPECT_LE(deviation_from_rotation(to_object), 16 * u);
    // det = 1 + the deviations' first order: three squares' halves.
    EXPECT_NEAR(to_object.determinant(), 1, 48 * u);
    // A normal map's (0, 0, 1) is the surface's own normal, exactly; its columns are t and b.
    EXPECT_EQ(from_eigen(to_object * Eigen::Vector3d::UnitZ()), f.n);
    EXPECT_EQ(from_eigen(to_object.col(0)), f.t);
    EXPECT_EQ(from_eigen(to_object.col(1)), f.b);
    // A light along n arrives along z, and comes back.
    const Eigen::Vector3d light = to_eigen(random.direction());
    EXPECT_LE((to_object * (to_tangent * light) - light).cwiseAbs().maxCoeff(), 24 * u);
    EXPECT_NEAR((to_tangent * to_eigen(f.n)).z(), 1, 16 * u);
  }
}

TEST(Rotation, HomogeneousHasNoTranslation) {
  Random random(8);
  const Eigen::Matrix3d rotation = tangent_to_object(random_frame(random));
  const Eigen::Matrix4d m = homogeneous(rotation);
  EXPECT_EQ((m.topLeftCorner<3, 3>()), rotation);
  EXPECT_EQ(m.col(3), Eigen::Vector4d::UnitW());
  EXPECT_EQ(m.row(3), Eigen::RowVector4d(0, 0, 0, 1));
  const ParametricFrame<double> oblique{{1, 0, 0}, {0.6, 0.8, 0}, {0, 0, 1}};
  EXPECT_EQ(tangent_to_object(oblique).col(1), Eigen::Vector3d(0.6, 0.8, 0));
}

TEST(Tangent4, HasTheSignOfTheConventionAsked) {
  Frame<double> f{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
  EXPECT_EQ(tangent4(f), (Vec4<double>{0, 1, 0, -1}));
  EXPECT_EQ(tangent4(f, SignConvention::gltf), tangent4(f));
  EXPECT_EQ(tangent4(f, SignConvention::raw), (Vec4<double>{0, 1, 0, 1}));
  f.handedness = -1;
  EXPECT_EQ(tangent4(f).w, 1);
  EXPECT_EQ(tangent4(f, SignConvention::raw).w, -1);
}

// w cross(n, t) leans towards dpdv in the raw convention, and away from it in gltf's, whose v runs down.
TEST(Tangent4, RebuildsTheSideOfTheBitangent) {
  for (const double side : {1.0, -1.0}) {
    const Vec3<double> dpdv{0.5, side, 0}, n{0, 0, 1};
    const Frame<double> f{{1, 0, 0}, {0, 1, 0}, n, side};
    const Vec4<double> raw = tangent4(f, SignConvention::raw), gltf = tangent4(f);
    EXPECT_GT(dot(raw.w * cross(n, raw.xyz()), dpdv), 0);
    EXPECT_LT(dot(gltf.w * cross(n, gltf.xyz()), dpdv), 0);
  }
}

// ---- transforms
// ----------------------------------------------------------------------------------------------------

Eigen::Matrix3d random_matrix(Random& random) {
  Eigen::Matrix3d m;
  for (double& x : m.reshaped()) x = random.uniform(-1, 1);
  return m;
}

// Transforming the frame is transforming the partials: M (dpdu × dpdv) goes by det M M^-T, so a mirror turns
// the cross product of the new partials against n, and the handedness says so.
TEST(FrameTransform, AgreesWithTransformedPartials) {
  Random random(9);
  int mirrors = 0;
  for (int i = 0; i < points; ++i) {
    const Eigen::Matrix3d m = random.log_uniform(1e-60, 1e60) * random_matrix(random);
    const Vec3<double> dpdu = random.direction(), dpdv = random.direction();
    const double stated = random.sign();  // of a surface that states its own orientation
    Frame<double> f = frame_from_partials(dpdu, dpdv);
    f.n = stated * f.n;
    f.b = stated * f.b;
    f.handedness = stated;
    const Eigen::Vector3d singular = singular_value_decomposition(m).values;
    const double condition = singular[0] / singular[2];
    const double angle = norm(cross(dpdu, dpdv));
    if (condition > 1e6 || angle < 1e-3) continue;
    const double mirror = m.determinant() < 0 ? -1 : 1;
    mirrors += mirror < 0;

    const Frame<double> moved = FrameTransform<double>(m)(f);
    const Frame<double> expected =
        frame_from_partials(from_eigen(m * to_eigen(dpdu)), from_eigen(m * to_eigen(dpdv)));
    // The map amplifies the roundings of f and of M dpdu by its condition; the cross product of the new
    // partials, whose angle may be smaller by the condition again, by that.
    const double bound = 16 * u * condition * (1 + condition / angle);
    EXPECT_LE(norm(moved.t - expected.t), bound);
    EXPECT_LE(norm(moved.n - stated * mirror * expected.n), bound);
    EXPECT_LE(norm(moved.b - stated * mirror * expected.b), bound);
    EXPECT_EQ(moved.handedness, stated * mirror);
    EXPECT_LE(deviation_from_rotation(tangent_to_object(moved)), 16 * u * condition);
  }
  EXPECT_GT(mirrors, points / 4);
}

TEST(FrameTransform, MovesTheParametricFrameByTheMap) {
  Random random(10);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix3d m = random_matrix(random);
    if (std::fabs(m.determinant()) < 0.1) continue;
    const ParametricFrame<double> f{random.direction(), random.direction(), random.direction()};
    const ParametricFrame<double> moved = FrameTransform<double>(m)(f);
    // |det| > 0.1 and entries below 1 keep the condition below 3³/0.1 = 270.
    EXPECT_LE(norm(moved.t - unit(from_eigen(m * to_eigen(f.t)))), 8 * 270 * u);
    EXPECT_LE(norm(moved.b - unit(from_eigen(m * to_eigen(f.b)))), 8 * 270 * u);
    EXPECT_LE(norm(moved.n - unit(from_eigen(m.inverse().transpose() * to_eigen(f.n)))), 8 * 270 * u);
    EXPECT_EQ(moved.handedness, m.determinant() < 0 ? -1 : 1);
  }
}

// A mirror keeps n on its side of the surface: the plane z = 0 mirrored in x still looks up.
TEST(FrameTransform, AMirrorFlipsTheHandednessOnly) {
  const Frame<double> f{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Frame<double> moved = FrameTransform<double>(Eigen::Vector3d(-1, 1, 1).asDiagonal())(f);
  EXPECT_EQ(moved.t, (Vec3<double>{-1, 0, 0}));
  EXPECT_EQ(moved.n, (Vec3<double>{0, 0, 1}));
  EXPECT_EQ(moved.b, (Vec3<double>{0, -1, 0}));
  EXPECT_EQ(moved.handedness, -1);
}

TEST(FrameTransform, KeepsTheFrameUnderScaleAndTranslation) {
  Random random(11);
  const Frame<double> f = random_frame(random);
  for (const double scale : {1e-67, 1e-200, 1.0, 1e100}) {  // det M = 1e-201 and, in the second, 0
    const Eigen::Affine3d map = Eigen::Translation3d(1e12, -3, 1e300) * Eigen::Scaling(scale);
    const Frame<double> moved = FrameTransform<double>(map)(f);
    EXPECT_LE(norm(moved.t - f.t), 4 * u) << scale;
    EXPECT_LE(norm(moved.n - f.n), 4 * u) << scale;
    EXPECT_EQ(moved.handedness, 1) << scale;
  }
  Frame<double> flagged = f;
  flagged.status = Status::limit_frame | Status::dpdu_zero;
  EXPECT_EQ(FrameTransform<double>(Eigen::Matrix3d::Identity())(flagged).status, flagged.status);
}

// A very unequal scale is no singular one.
TEST(FrameTransform, TakesUnequalScales) {
  const Frame<double> f{{0.6, 0, 0.8}, {0, 1, 0}, {-0.8, 0, 0.6}};
  const Frame<double> moved = FrameTransform<double>(Eigen::Vector3d(1, 1, 1e-12).asDiagonal())(f);
  EXPECT_LE(norm(moved.t - Vec3<double>{1, 0, 0.8e-12 / 0.6}), 4 * u);
  EXPECT_LE(norm(moved.n - Vec3<double>{-0.8e-12 / 0.6, 0, 1}), 4 * u);
}

TEST(FrameTransform, RefusesSingularMapsByName) {
  Eigen::Matrix3d rank_two, nearly;
  rank_two << 1, 2, 3, 2, 4, 6, 1, 0, 1;
  nearly << 1, 2, 3, 4, 5, 6, 7, 8, 9;  // det = 0, and 6.7e-16 as computed
  const Eigen::Matrix3d zero = Eigen::Matrix3d::Zero();
  for (const Eigen::Matrix3d& m : {zero, rank_two, nearly, Eigen::Matrix3d(1e-100 * nearly)}) {
    try {
      FrameTransform<double>{m};
      ADD_FAILURE() << m << " was accepted";
    } catch (const ParameterError& error) {
      EXPECT_STREQ(error.what(),
                   "transform: expected an invertible map, got a linear part that is singular or not finite");
    }
  }
  for (const double bad : {nan_value, infinity, -infinity}) {
    Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
    m(1, 2) = bad;
    EXPECT_THROW(FrameTransform<double>{m}, ParameterError) << bad;
  }
}

}  // namespace
}  // namespace darboux::test::frame_test
