// The forms and curvatures of the whole catalogue against 100 digits, over random parameters of many decades:
// wherever a frame is regular they err by at most 8u times (1 + condition). The oracle shares the surfaces'
// formulas for the partials; what is made of them it computes by the definitions.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/christoffel.h>
#include <darboux/curvature.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/forms.h>
#include <darboux/shape_operator.h>

#include "any_surface/all_compiled_models.h"
#include "every_surface.h"
#include "multiprecision.h"
#include "random.h"

namespace darboux::test::forms_accuracy_test {
namespace {

using B = BoostDigits<100>;
constexpr double roundoff = 0x1p-53;
const B relative_step("1e-35");  // leaves 35 digits of a condition where 30 have cancelled

// Numbers that are one quantity: its error and its condition are relative to its 2-norm.
enum Quantity { gaussian, mean, principal, directions, dndu, dndv, first, second, christoffel_u_v };
constexpr std::array<const char*, 9> names{"K",    "H",          "k1, k2",      "directions", "dndu",
                                           "dndv", "first form", "second form", "Christoffel"};
template <class S>
using Values = std::array<std::vector<S>, names.size()>;

template <class S>
std::vector<S> list(const Vec3<S>& a) {
  return {a.x, a.y, a.z};
}
template <class S>
std::vector<S> list(const Vec3<S>& a, const Vec3<S>& b) {
  return {a.x, a.y, a.z, b.x, b.y, b.z};
}
template <class S>
S length(const std::vector<S>& q) {
  S sum(0);
  for (const S& x : q) sum += x * x;
  return sqrt(sum);
}

// By the definitions. [doCarmo2016, sec. 3-3, 4-3]
// \param side 1, or -1 where n opposes dpdu × dpdv
struct Exact {
  Values<B> values;
  double apart;  // |κ| / (κ1 - κ2)
  std::array<B, names.size()>
      scale;  // what rounding of the input alone can leave of a quantity that vanishes
  bool umbilic;

  Exact(const Jet2<B>& j, double side) {
    const Vec3<B> area = cross(j.dpdu, j.dpdv);
    const B size = sqrt(dot(area, area)), W = size * size;
    const Vec3<B> n = B(side) / size * area;
    const B E = dot(j.dpdu, j.dpdu), F = dot(j.dpdu, j.dpdv), G = dot(j.dpdv, j.dpdv);
    const B L = dot(n, j.d2pdu2), M = dot(n, j.d2pduv), N = dot(n, j.d2pdv2);
    const B K = (L * N - M * M) / W, H = (E * N - 2 * F * M + G * L) / (2 * W);
    B root = H * H - K;
    // ((a - c)/2)² + m² of the orthonormal basis: at least 0.
    if (root < 0) root = 0;
    root = sqrt(root);
    const B k1 = H + root, k2 = H - root, s = sqrt(k1 * k1 + k2 * k2);
    // (L - k E) x + (M - k F) y = 0 and (M - k F) x + (N - k G) y = 0, the larger of the two.
    const auto direction = [&](const B& k) {
      const B p = L - k * E, q = M - k * F, r = N - k * G;
      const Vec3<B> one = -q * j.dpdu + p * j.dpdv, two = r * j.dpdu - q * j.dpdv;
      const B of_one = dot(one, one), of_two = dot(two, two);
      return of_one > of_two ? B(1) / sqrt(of_one) * one : B(1) / sqrt(of_two) * two;
    };
    apart = static_cast<double>(s / (2 * root));
    umbilic = root < B("1e-12") * s;
    const Vec3<B> d1 = direction(k1), d2 = cross(n, d1);
    // -dn(dpdu) = S dpdu in the basis dpdu, dpdv
    const auto weingarten = [&](const B& x, const B& y) {
      return (F * y - G * x) / W * j.dpdu + (F * x - E * y) / W * j.dpdv;
    };
    values[gaussian] = {K};
    values[mean] = {H};
    values[principal] = {k1, k2};
    values[directions] = list(d1, d2);
    values[dndu] = list(weingarten(L, M));
    values[dndv] = list(weingarten(M, N));
    values[first] = {E, F, G};
    values[second] = {L, M, N};
    B terms(0);
    for (const Vec3<B>* d : {&j.d2pdu2, &j.d2pduv, &j.d2pdv2}) {
      const B x = dot(*d, j.dpdu), y = dot(*d, j.dpdv);
      values[christoffel_u_v].push_back((G * x - F * y) / W);
      values[christoffel_u_v].push_back((E * y - F * x) / W);
      terms += sqrt(dot(*d, *d));
    }
    scale = {s * s, s, s, 1, s * sqrt(E), s * sqrt(G), E + G, s * (E + G), terms / sqrt(E < G ? E : G)};
  }
};

template <class X>
Values<double> values_of(const X& surface, double u, double v, Status& status) {
  const Jet2<double> j = jet(surface, u, v);
  const Frame<double> f = frame(surface, u, v);
  const Curvature<double> c = curvature(surface, u, v, j, f);
  status = c.status;
  const NormalDerivatives<double> d = normal_derivatives(surface, u, v, j, f);
  const FirstForm<double> I = first_form(j);
  const SecondForm<double> II = second_form(surface, u, v, j, f);
  const Christoffel<double> g = christoffel(surface, u, v, j, f);
  return {{{c.gaussian},
           {c.mean},
           {c.principal[0], c.principal[1]},
           list(c.directions[0], c.directions[1]),
           list(d.dndu),
           list(d.dndv),
           {I.E, I.F, I.G},
           {II.L, II.M, II.N},
           {g.u[0], g.v[0], g.u[1], g.v[1], g.u[2], g.v[2]}}};
}

template <class X>
X random_surface(Random& random) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    X surface{};
    const double size = random.log_uniform(1e-6, 1e6);
    const bool related = random.bits() % 2 == 0;
    for_each_parameter<X>([&](const auto& p) {
      const double least = std::fmax(p.proven.smallest, 1e-6), most = std::fmin(p.proven.largest, 1e6);
      double x = related ? size * random.log_uniform(0.25, 4) : random.log_uniform(least, most);
      x = std::fmin(std::fmax(x, least), most);
      if (random.bits() % 2 == 0 && p.permitted.contains(-x)) x = -x;
      p.of(surface) = x;
    });
    try {
      return checked(surface);
    } catch (const ParameterError&) {
      // These do not go together: others.
    }
  }
  return X{};
}

double random_coordinate(Random& random) {
  switch (random.bits() % 8) {
    case 0:
      return random.log_uniform(1e-12, 0.1);
    case 1:
      return static_cast<double>(random.bits() % 9) / 8;
    default:
      return random.uniform();
  }
}

template <class X>
class FormsAccuracy : public ::testing::Test {};
TYPED_TEST_SUITE(FormsAccuracy, EveryCatalogueSurface, SurfaceNames);

// Control points and curves are inputs too, though no parameters: of these all x together, all y, all z count
// as one each.
template <class X>
constexpr bool made_of_data = X::info.name.ends_with("-patch") || X::info.name == "surface-of-revolution" ||
                              X::info.name == "extrusion" || X::info.name == "ruled-surface";

// The greatest error over its bound, by quantity, and where.
struct Worst {
  double error = 0, bound = 1;
  std::string at;
};

template <class X>
void compare(const X& surface, double u, double v, std::array<Worst, names.size()>& worst) {
  Status status;
  const Values<double> own = values_of(surface, u, v, status);
  if ((status | Status::umbilic) != Status::umbilic) return;
  auto wide = rebind<B>(surface);
  const Frame<double> f = frame(surface, u, v);
  const Jet2<B> j = jet(wide, B(u), B(v));
  const Vec3<B> area = cross(j.dpdu, j.dpdv);
  const double side = dot(area, Vec3<B>{f.n.x, f.n.y, f.n.z}) < 0 ? -1 : 1;
  const Exact exact(j, side);
  std::array<B, names.size()> condition{};
  const auto add = [&](const Exact& moved) {
    for (std::size_t q = 0; q < names.size(); ++q) {
      std::vector<B> change = exact.values[q];
      B sign = 1;
      if (q == directions) {
        B along(0);
        for (std::size_t i = 0; i < 3; ++i) along += change[i] * moved.values[q][i];
        if (along < 0) sign = -1;
      }
      for (std::size_t i = 0; i < change.size(); ++i) change[i] = sign * moved.values[q][i] - change[i];
      condition[q] += length(change) / relative_step;
    }
  };
  const B more = 1 + relative_step;
  if constexpr (made_of_data<X>)
    for (B Vec3<B>::*axis : {&Vec3<B>::x, &Vec3<B>::y, &Vec3<B>::z}) {
      Jet2<B> moved = j;
      for (Vec3<B>* p :
           {&moved.position, &moved.dpdu, &moved.dpdv, &moved.d2pdu2, &moved.d2pduv, &moved.d2pdv2})
        p->*axis *= more;
      add(Exact(moved, side));
    }
  if (u != 0) add(Exact(jet(wide, B(u) * more, B(v)), side));
  if (v != 0) add(Exact(jet(wide, B(u), B(v) * more), side));
  for_each_parameter<decltype(wide)>([&](const auto& p) {
    const B kept = p.of(wide);
    if (kept == 0) return;
    p.of(wide) = kept * more;
    add(Exact(jet(wide, B(u), B(v)), side));
    p.of(wide) = kept;
  });
  for (std::size_t q = 0; q < names.size(); ++q) {
    if (q == directions && (exact.umbilic || has(status, Status::umbilic))) continue;
    B sign = 1;
    if (q == directions && own[q][0] * static_cast<double>(exact.values[q][0]) +
                                   own[q][1] * static_cast<double>(exact.values[q][1]) +
                                   own[q][2] * static_cast<double>(exact.values[q][2]) <
                               0)
      sign = -1;
    std::vector<B> difference;
    for (std::size_t i = 0; i < own[q].size(); ++i)
      difference.push_back(sign * B(own[q][i]) - exact.values[q][i]);
    // What vanishes identically has no relative error: rounding of its terms.
    const B size = length(exact.values[q]), scale = exact.scale[q];
    const bool vanishes = !(size > B("1e-50") * scale);
    const double error =
        static_cast<double>(length(difference) / (vanishes ? (scale > 0 ? scale : B(1)) : size));
    double times = vanishes ? 1 : 1 + static_cast<double>(condition[q] / size);
    // The frame's own 4u beside it.
    if (q == gaussian || q == mean || q == principal) times += 0.5;
    // Where κ1 and κ2 are near each other, and not so near that 40 digits are taken, rounding turns the
    // directions by its share of their difference.
    if (q == directions) times += std::fmin(exact.apart, detail::cancellation_of_directions);
    // A surface's own number of roundings, 8 of most; and twice that of data, of which each number is an
    // input and not only the three axes.
    const double bound = (made_of_data<X> ? 4 : 2) * X::info.frame_error * roundoff * times;
    if (!(error / bound <= worst[q].error / worst[q].bound)) {
      char text[100];
      std::snprintf(text, sizeof text, " at u = %.17g, v = %.17g%s", u, v, vanishes ? " (0)" : "");
      worst[q] = {error, bound, AnySurface(surface).specification() + text};
    }
  }
}

TYPED_TEST(FormsAccuracy, IsEightRoundingsTimesOnePlusTheCondition) {
  using X = TypeParam;
  Random random(25);
  std::array<Worst, names.size()> worst;
  for (int set = 0; set < 20; ++set) {
    const X surface = set < 5 ? X{} : random_surface<X>(random);
    for (int i = 0; i < 10; ++i)
      compare(surface, random_coordinate(random), random_coordinate(random), worst);
  }
  for (std::size_t q = 0; q < names.size(); ++q) {
    const Worst& w = worst[q];
    EXPECT_LE(w.error, w.bound) << names[q] << ' ' << w.error / roundoff << " u of " << w.bound / roundoff
                                << " u, " << w.at;
  }
}

// Sizes up to 300 decades apart, where the entries of the shape operator may underflow while what is made of
// them does not: against the curvatures that the surfaces state, in 100 digits. Conditions are moderate, so
// that an error of 1e-9 is a digit lost and not rounding.
template <class X>
class FormsOfAnySize : public ::testing::Test {};
using SurfacesOfThreeSizes =
    ::testing::Types<Ellipsoid<double>, EllipticParaboloid<double>, HyperbolicParaboloid<double>,
                     OneSheetHyperboloid<double>, TwoSheetHyperboloid<double>>;
TYPED_TEST_SUITE(FormsOfAnySize, SurfacesOfThreeSizes);

TYPED_TEST(FormsOfAnySize, KeepTheirDigits) {
  using X = TypeParam;
  Random random(150);
  int compared = 0;
  for (int i = 0; i < 1500; ++i) {
    X surface{};
    for_each_parameter<X>([&](const auto& p) {
      p.of(surface) =
          random.log_uniform(std::fmax(p.proven.smallest, 1e-150), std::fmin(p.proven.largest, 1e150));
    });
    const double u = random.uniform(), v = 0.02 + 0.96 * random.uniform();
    const Curvature<double> c = curvature(surface, u, v);
    const auto wide = rebind<B>(surface);
    const B H = wide.mean_curvature(prepare<X::info.u>(B(u)), prepare<X::info.v>(B(v)));
    const B K = wide.gaussian_curvature(prepare<X::info.u>(B(u)), prepare<X::info.v>(B(v)));
    const B size = sqrt(4 * H * H - 2 * K);
    if (c.status != Status::regular || size < B("1e-300") || size > B("1e300")) continue;
    ++compared;
    const std::string at =
        AnySurface(surface).specification() + " at " + std::to_string(u) + ", " + std::to_string(v);
    EXPECT_LE(static_cast<double>(abs(c.mean - H) / size), 1e-9) << c.mean << " of " << at;
    for (const int k : {0, 1}) {
      const B kappa = k == 0 ? H + sqrt(H * H - K) : H - sqrt(H * H - K);
      EXPECT_LE(static_cast<double>(abs(c.principal[k] - kappa) / size), 1e-9)
          << c.principal[k] << " of " << at;
    }
    double mean = 0;
    evaluate(surface, Points<double>::arrays({&u, 1}, {&v, 1}),
             Outputs<double>().packed(Attribute::mean_curvature, {&mean, 1}));
    EXPECT_EQ(mean, c.mean) << at;
  }
  EXPECT_GT(compared, 1000);
}

}  // namespace
}  // namespace darboux::test::forms_accuracy_test
