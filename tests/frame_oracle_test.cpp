// Frames and partials of every surface in the catalogue against 40 digits. The oracle's frame is the cross
// product of the partials, so it shares nothing with the closed form but the surface's parameters.
#include <array>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/evaluate.h>

#include "every_surface.h"
#include "many_digits.h"

namespace darboux::test {
namespace {

using Long = long double;  // 64 bits hold an oracle's component to 0.0005u, enough to compare with 4u

#ifdef DARBOUX_SHORT_TESTS
constexpr int random_points = 100'000;
#else
constexpr int random_points = 1'000'000;
#endif

const HalfTurns& half_turns() {
  static const HalfTurns instance;
  return instance;
}

template <class X>
using Many = decltype(rebind<Mp>(X{}));

Vec3<Mp> normalised(const Vec3<Mp>& a) {
  return inverse_sqrt(dot(a, a)) * a;
}

Vec3<Long> rounded(const Vec3<Mp>& a) {
  return {static_cast<Long>(a.x), static_cast<Long>(a.y), static_cast<Long>(a.z)};
}

struct Oracle {
  Vec3<Long> t, b, n;
  int handedness;
};

template <class X>
Oracle oracle(const Many<X>& surface, const Mp& u, const Mp& v) {
  const auto pu = prepare_many_digits<X::info.u>(half_turns(), u);
  const auto pv = prepare_many_digits<X::info.v>(half_turns(), v);
  const Jet2<Mp> j = surface.jet(pu, pv);
  const int handedness = stated_handedness(surface, pv);
  const Vec3<Mp> t = normalised(j.dpdu), n = Mp(handedness) * normalised(cross(j.dpdu, j.dpdv));
  return {rounded(t), rounded(cross(n, t)), rounded(n), handedness};
}

// Where a partial vanishes the frame is the limit along the given u: the oracle steps 1e-18 along v, into the
// domain or to the side that the surface calls its outside. The frame turns by at most 2π 1e-18 = 0.06u.
template <class X>
Oracle limit_oracle(const Many<X>& surface, double u, double v) {
  const Mp step("1e-18");
  if (v < 0.5 && X::info.v != Coordinate::turn) return oracle<X>(surface, u, v + step);
  const Oracle below = oracle<X>(surface, u, v - step);
  return X::info.v != Coordinate::turn || below.handedness > 0 ? below : oracle<X>(surface, u, v + step);
}

template <class S>
Long difference(const Vec3<S>& a, const Vec3<Long>& b) {
  const Long d = std::fmax(std::fmax(std::fabs(a.x - b.x), std::fabs(a.y - b.y)), std::fabs(a.z - b.z));
  return std::isnan(Long(a.x) + a.y + a.z) ? std::numeric_limits<Long>::infinity() : d;
}

template <class S>
Long deviation_from_orthonormal(const Frame<S>& f) {
  const auto wide = [](const Vec3<S>& a) { return Vec3<Long>{a.x, a.y, a.z}; };
  const std::array<Vec3<Long>, 3> columns{wide(f.t), wide(f.b), wide(f.n)};
  Long worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = i; k < 3; ++k)
      worst = std::fmax(worst, std::fabs(dot(columns[i], columns[k]) - (i == k ? 1 : 0)));
  return worst;
}

// On a spindle torus the side is decided by the sign of R + r cos 2πv as it is rounded. It is not decided
// within the error of that: relative to r |cos 2πv|, 3.3u for the cosine (1.65 ulp), u for the product, and
// in single precision u each for R and r.
template <class X, class V>
bool side_undecided(const X&, const V&, double) {
  return false;
}
bool side_undecided(const Torus<double>& torus, const Turn<double>& v, double roundoff) {
  return torus.major_radius < torus.minor_radius &&
         std::fabs(torus.major_radius + torus.minor_radius * v.cos) <
             7 * roundoff * torus.minor_radius * std::fabs(v.cos);
}

// The largest errors of frames of number type S, in roundings of S.
template <class X, class S>
struct Worst {
  static constexpr double roundoff = std::numeric_limits<S>::epsilon() / 2;
  Long t = 0, b = 0, n = 0, orthonormality = 0;
  int points = 0, limits = 0, undecided = 0, wrong_side = 0;

  void add(const X& surface, const Many<X>& many, S u, S v) {
    if (side_undecided(surface, prepare<X::info.v>(static_cast<double>(v)), roundoff)) {
      ++undecided;
      return;
    }
    const Frame<S> f = frame(surface, u, v);
    const bool limit = has(f.status, Status::limit_frame);
    const Oracle exact = limit ? limit_oracle<X>(many, u, v) : oracle<X>(many, u, v);
    ++points;
    limits += limit;
    wrong_side += static_cast<int>(f.handedness) != exact.handedness;
    t = std::fmax(t, difference(f.t, exact.t));
    b = std::fmax(b, difference(f.b, exact.b));
    n = std::fmax(n, difference(f.n, exact.n));
    orthonormality = std::fmax(orthonormality, deviation_from_orthonormal(f));
  }

  void expect_within_goals() const {
    std::cout << X::info.name << ": " << points << " points (" << limits << " limit frames), max error t "
              << t / roundoff << " b " << b / roundoff << " n " << n / roundoff << ", |T'T - I| "
              << orthonormality / roundoff << " roundings; " << undecided
              << " points left out, R + r cos 2πv within rounding of zero\n";
    // A component is at most the product of a sine and a cosine, each within 1.65 ulp
    // <= 1.65u, rounded once (u/2): 3.8u. A column with that error has a square off by 7.6u at most. Measured
    // maxima 1.9u and 4.4u.
    EXPECT_LE(t, 4 * roundoff);
    EXPECT_LE(b, 4 * roundoff);
    EXPECT_LE(n, 4 * roundoff);
    EXPECT_LE(orthonormality, 8 * roundoff);
    EXPECT_EQ(wrong_side, 0);
    // R = (1 - 2^-52) r at v = 1/2 and its two neighbours, 20 values of u each; hardly ever a random point.
    EXPECT_LE(undecided, 3 * 20 + 4);
  }
};

// Ends, quarter turns, their neighbours, and numbers too small to move 1 - v.
template <class S>
std::vector<S> special_coordinates() {
  std::vector<S> result{S(1e-30), S(1e-17), S(1e-9), std::numeric_limits<S>::denorm_min(),
                        std::numeric_limits<S>::min()};
  if constexpr (sizeof(S) == 8) result.insert(result.end(), {1e-300, 1e-150});
  for (const S quarter : {S(0), S(0.25), S(0.5), S(0.75), S(1)}) {
    result.push_back(quarter);
    if (quarter > 0) result.push_back(std::nextafter(quarter, S(0)));
    if (quarter < 1) result.push_back(std::nextafter(quarter, S(1)));
  }
  return result;
}

// Random parameters and those at which a torus touches or crosses itself.
template <class X>
std::vector<X> special_surfaces(Random& random, double smallest, double largest) {
  std::vector<X> result{X{}};
  for (int i = 0; i < 20; ++i) result.push_back(random_surface<X>(random, smallest, largest));
  for (const double ratio : {0.0, 0.5, 1.0 - 0x1p-52, 1.0, 1.0 + 0x1p-52, 0x1p53})
    if constexpr (requires(X x) { x.major_radius; }) result.push_back(X{ratio, 1.0});
  return result;
}

template <class X>
class FrameOracle : public ::testing::Test {};
TYPED_TEST_SUITE(FrameOracle, EveryCatalogueSurface, SurfaceNames);

template <class X, class S>
void check_frames(std::uint64_t seed, int points, double smallest, double largest) {
  Random random(seed);
  Worst<X, S> worst;
  for (const X& surface : special_surfaces<X>(random, smallest, largest)) {
    const auto many = rebind<Mp>(surface);
    for (const S u : special_coordinates<S>())
      for (const S v : special_coordinates<S>()) worst.add(surface, many, u, v);
  }
  for (int i = 0; i < points; ++i) {
    const X surface = random_surface<X>(random, smallest, largest);
    const S u = static_cast<S>(random.uniform());
    // One in four close to an end of v, as close as log-uniform gets.
    const S v = static_cast<S>(i % 4 == 0 ? random.log_uniform(1e-30, 1) : random.uniform());
    worst.add(surface, rebind<Mp>(surface), u, i % 8 == 0 ? 1 - v : v);
  }
  worst.expect_within_goals();
}

TYPED_TEST(FrameOracle, DoubleFramesErrByAtMostFourRoundings) {
  check_frames<TypeParam, double>(20'240'601, random_points, 1e-150, 1e150);
}

// Single precision throughout, u and v the exact floats.
TYPED_TEST(FrameOracle, FloatFramesErrByAtMostFourRoundings) {
  check_frames<TypeParam, float>(20'240'602, random_points / 10, 1e-15, 1e15);
}

// Every partial, relative to its largest magnitude on this surface.
TYPED_TEST(FrameOracle, PartialsErrByAtMostEightRoundingsOfTheirScale) {
  using X = TypeParam;
  constexpr std::array members{&Jet2<double>::position, &Jet2<double>::dpdu,   &Jet2<double>::dpdv,
                               &Jet2<double>::d2pdu2,   &Jet2<double>::d2pduv, &Jet2<double>::d2pdv2};
  constexpr std::array many_members{&Jet2<Mp>::position, &Jet2<Mp>::dpdu,   &Jet2<Mp>::dpdv,
                                    &Jet2<Mp>::d2pdu2,   &Jet2<Mp>::d2pduv, &Jet2<Mp>::d2pdv2};
  constexpr int points = 100;
  Random random(20'240'603);
  std::array<Long, 6> worst{};
  for (int i = 0; i < random_points / 2000; ++i) {
    const X surface = random_surface<X>(random, 1e-150, 1e150);
    const auto many = rebind<Mp>(surface);
    std::array<Long, 6> error{}, scale{};
    for (int k = 0; k < points; ++k) {
      const double u = random.uniform(), v = random.uniform();
      const Jet2<double> j = jet(surface, u, v);
      const Jet2<Mp> exact = many.jet(prepare_many_digits<X::info.u>(half_turns(), u),
                                      prepare_many_digits<X::info.v>(half_turns(), v));
      for (int m = 0; m < 6; ++m) {
        const Vec3<Long> e = rounded(exact.*many_members[m]);
        error[m] = std::fmax(error[m], difference(j.*members[m], e));
        scale[m] = std::fmax(scale[m], difference(e, Vec3<Long>{}));
      }
    }
    for (int m = 0; m < 6; ++m)
      worst[m] = std::fmax(worst[m], scale[m] == 0 ? error[m] : error[m] / scale[m]);
  }
  std::cout << X::info.name << ": " << random_points / 2000 * points << " points, max error";
  for (const Long w : worst) std::cout << ' ' << w * 0x1p53L;
  std::cout << "u\n";
  // The product of a sine and a cosine errs by 3.8u (above), π or τ by u/2, twice in second partials, and the
  // three or four further products and sums by u/2 each.
  for (const Long w : worst) EXPECT_LE(w, 8 * 0x1p-53L);
}

// The oracle's own trigonometry against boost's, which takes another way (Taylor after halving the argument).
TEST(HalfTurnsOracle, AgreesWithBoost) {
  using std::sin, std::cos;
  Random random(20'240'604);
  for (int i = 0; i < 1000; ++i) {
    const double x = i % 2 == 0 ? random.uniform() : random.log_uniform(1e-300, 1);
    const auto [s, c] = half_turns()(x);
    const Mp angle = pi<Mp>() * x, exact = sin(angle);
    // 40 digits and a handful of roundings; relative to the sine itself only where x is small.
    EXPECT_LE(abs(s - exact), Mp("1e-39") * (x < 0.5 ? exact : Mp(1))) << x;
    EXPECT_LE(abs(c - cos(angle)), Mp("1e-39")) << x;
  }
}

TEST(HalfTurnsOracle, InverseSquareRootHasAllDigits) {
  Random random(20'240'605);
  for (int i = 0; i < 1000; ++i) {
    const Mp x = Mp(random.log_uniform(1e-300, 1e300)) * Mp(random.log_uniform(1e-300, 1e300));
    const Mp r = inverse_sqrt(x);
    EXPECT_LE(abs(r * r * x - 1), Mp("1e-39"));
  }
}

}  // namespace
}  // namespace darboux::test
