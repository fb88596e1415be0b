// What a mesh's positions and uvs say of its frames, against the surface that they were taken from: the
// standard deviations are honest, in both directions, and the frames far better than averages.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <darboux/local_truth.h>
#include <darboux/mesh_classes.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>

#include "mesh/frames/rings.h"

namespace darboux::local_truth_test {
namespace {

struct Case {
  std::string surface;
  double jitter = 0, shear = 0, v_first = 0, v_last = 1;
};
// Smooth, without the neighbourhood of poles, where nothing of the chart is smooth.
const std::vector<Case>& cases() {
  static const std::vector<Case> list{{"torus"},
                                      {"torus", 0.3},
                                      {"torus", 0, 0.5},
                                      {"torus", 0.3, 0.5},
                                      {"sphere", 0, 0, 0.2, 0.8},
                                      {"sphere", 0.3, 0, 0.2, 0.8},
                                      {"ellipsoid", 0, 0, 0.2, 0.8},
                                      {"ellipsoid", 0.3, 0, 0.2, 0.8},
                                      {"cone", 0.3, 0, 0, 0.8},
                                      {"elliptic-paraboloid", 0.3, 0, 0.2, 1},
                                      {"helicoid", 0.3},
                                      {"catenoid", 0.3},
                                      {"moebius-strip", 0.3},
                                      {"klein-bottle", 0.3}};
  return list;
}

Mesh mesh_of(const Case& c, int n) {
  SampleMeshOptions o;
  o.columns = n, o.rows = n, o.jitter = c.jitter, o.random_diagonals = c.jitter > 0, o.seed = 20261123;
  o.shear = c.shear, o.v_first = c.v_first, o.v_last = c.v_last;
  return sample_mesh(make_surface(c.surface), o);
}

double degrees(const Vec3<double>& a, const Vec3<double>& b) {
  return 180 / std::numbers::pi * std::atan2(norm(cross(a, b)), dot(a, b));
}

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

double rms(const std::vector<double>& x) {
  double squares = 0;
  for (const double e : x) squares += e * e;
  return std::sqrt(squares / static_cast<double>(x.size()));
}

Vec3<double> tangent(const Mesh& mesh, std::uint32_t v) {
  return {mesh.tangents[v].x, mesh.tangents[v].y, mesh.tangents[v].z};
}

enum class Spoilt { no, quantised, noisy };

// Positions to the nearest of 65536 numbers over their range; or with noise of a thousandth of the mesh's
// size.
void spoil(Spoilt how, Mesh& mesh) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal(0, 1e-3);
  for (double Vec3<double>::*x : {&Vec3<double>::x, &Vec3<double>::y, &Vec3<double>::z}) {
    double low = INFINITY, high = -INFINITY;
    for (const auto& p : mesh.positions) low = std::fmin(low, p.*x), high = std::fmax(high, p.*x);
    const double step = (high - low) / 65535;
    for (auto& p : mesh.positions) {
      if (how == Spoilt::quantised) p.*x = low + step * std::rint((p.*x - low) / step);
      if (how == Spoilt::noisy) p.*x += normal(random);
    }
  }
}

// Two standard deviations cover the errors, which are those of truncation: a steady share of the deviation,
// not a random one, so that more than 95 % lie within; or those of noise. And they are no larger than that
// takes: their median is no more than five times the errors', of positions that are spoilt twelve times, as
// what noise leaves of the highest degree counts as hidden truncation.
void expect_honest(Spoilt how, bool with_uvs) {
  for (const Case& c : cases())
    for (const int n : {32, 64}) {
      Mesh mesh = mesh_of(c, n);
      spoil(how, mesh);
      const MeshClasses classes = classify(mesh, {});
      if (!with_uvs) mesh.uvs.clear();
      const std::vector<Truth> truth = local_truth(mesh);
      for (const bool normal : {true, false}) {
        if (!normal && !with_uvs) {
          for (const Truth& t : truth) EXPECT_TRUE(std::isnan(t.tangent.x) && std::isinf(t.tangent_deg));
          continue;
        }
        std::vector<double> errors, bars;
        std::size_t covered = 0, interior = 0;
        for (std::uint32_t v = 0; v < truth.size(); ++v) {
          if (classes.of_vertex[v] != VertexClass::interior) continue;
          ++interior;
          const double bar = 2 * (normal ? truth[v].normal_deg : truth[v].tangent_deg);
          if (!std::isfinite(bar)) continue;
          errors.push_back(normal ? degrees(truth[v].normal, mesh.normals[v])
                                  : degrees(truth[v].tangent, tangent(mesh, v)));
          bars.push_back(bar);
          covered += errors.back() <= bar;
        }
        SCOPED_TRACE(c.surface + " jitter " + std::to_string(c.jitter) + " shear " + std::to_string(c.shear) +
                     " n " + std::to_string(n) + (normal ? " normals" : " tangents"));
        // A strip that is twisted or bent much within a cell is no smooth mesh of 32 cells.
        if (n == 64) {
          // Noise is a bend of half a radian within a cell of the narrow strip.
          EXPECT_GE(errors.size(), (how == Spoilt::noisy ? 0.85
                                    : with_uvs           ? 0.97
                                                         : 0.95) *
                                       static_cast<double>(interior));
        }
        ASSERT_GE(errors.size(), 0.5 * static_cast<double>(interior));
        EXPECT_GE(covered, 0.93 * static_cast<double>(errors.size()));
        // Over a plane the even derivatives of a symmetric patch cancel from the error of a normal, which the
        // deviation does not know.
        EXPECT_LE(median(bars), (!with_uvs           ? 24
                                 : how != Spoilt::no ? 12
                                 : n == 64           ? 5
                                                     : 6) *
                                    median(errors))
            << median(errors);
        std::cout << c.surface << ' ' << c.jitter << ' ' << n << (normal ? " normals: " : " tangents: ")
                  << median(errors) << " deg, bar " << median(bars) / median(errors) << " times that, covers "
                  << 100.0 * static_cast<double>(covered) / static_cast<double>(errors.size()) << " %\n";
      }
    }
}

class LocalTruthWithUvs : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(LocalTruth, LocalTruthWithUvs, testing::Bool());

TEST_P(LocalTruthWithUvs, DeviationsAreHonest) {
  expect_honest(Spoilt::no, GetParam());
}
TEST_P(LocalTruthWithUvs, DeviationsOfQuantisedPositionsAreHonest) {
  expect_honest(Spoilt::quantised, GetParam());
}
TEST_P(LocalTruthWithUvs, DeviationsOfNoisyPositionsAreHonest) {
  expect_honest(Spoilt::noisy, GetParam());
}

// Where no symmetry cancels the errors of averages: on jittered meshes and on the triaxial ellipsoid.
TEST(LocalTruth, IsFarBetterThanAverages) {
  for (const Case& c : cases()) {
    if (c.jitter == 0 && c.surface != "ellipsoid") continue;
    const Mesh mesh = mesh_of(c, 64);
    const std::vector<Truth> truth = local_truth(mesh);
    const MeshClasses classes = classify(mesh, {});
    const auto error_of = [&](const auto& tangent_at) {
      std::vector<double> errors;
      for (std::size_t corner = 0; corner < mesh.corners(); ++corner) {
        const std::uint32_t v = mesh.triangles[corner / 3][corner % 3];
        if (classes.of_vertex[v] == VertexClass::interior && std::isfinite(truth[v].tangent_deg))
          errors.push_back(degrees(tangent_at(corner, v), tangent(mesh, v)));
      }
      return rms(errors);
    };
    const double local = error_of([&](std::size_t, std::uint32_t v) { return truth[v].tangent; });
    for (const std::string_view method : {"mikktspace", "average", "unit", "area", "angle", "max"}) {
      const MeshFrames frames = mesh_frames(mesh, find_frame_method(method));
      const double error =
          error_of([&](std::size_t corner, std::uint32_t) { return frames.corner(corner).t; });
      EXPECT_GE(error, 20 * local) << c.surface << " jitter " << c.jitter << ' ' << method;
    }
  }
}

// A vertex that is nowhere takes no others with it; uvs without area are none, and do not keep apart what
// differs in them.
TEST(LocalTruth, WithoutUvsOnlyNeighboursOfABrokenVertexAreUnknown) {
  Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 32, .rows = 16});
  const std::vector<Vec3<double>> normals = mesh.normals;
  for (std::size_t v = 0; v < mesh.uvs.size(); ++v) mesh.uvs[v] = {v % 3 == 0 ? 0.25 : 0.75, 0.5};
  mesh.positions[100].x = INFINITY;
  std::size_t known = 0;
  const std::vector<Truth> truth = local_truth(mesh);
  for (std::size_t v = 0; v < truth.size(); ++v) {
    if (!std::isfinite(truth[v].normal_deg)) continue;
    ++known;
    EXPECT_LE(degrees(truth[v].normal, normals[v]), 4 * truth[v].normal_deg + 1e-9) << v;
  }
  EXPECT_GT(known, truth.size() * 9 / 10);
}

// A walk that was started as often as there are numbers goes on as a new one does; and so does one from the
// same node again.
TEST(Rings, WalksStartAnew) {
  const Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 9, .rows = 7});
  const Rings rings(mesh);
  const auto near = [&](std::size_t node, Rings::Walk& walk) {
    rings.start(static_cast<Index>(node), walk);
    rings.grow(walk);
    rings.grow(walk);
    return walk.near;
  };
  for (Index node = 0; node < rings.size(); ++node) {
    Rings::Walk walk;
    const std::vector<Index> expected = near(node, walk);
    walk.starts = std::numeric_limits<Index>::max();
    near((node + rings.size() / 2) % rings.size(), walk);
    for (int again = 0; again < 2; ++again) EXPECT_EQ(near(node, walk), expected) << node;
  }
}

// Beside the border of a grid some polynomials have too few rows, and are singular; uvs that are turned and
// rounded to floats hide that. Normals were off by up to 160 degrees, known to two.
TEST(LocalTruth, TurnedUvsChangeNoNormal) {
  constexpr int n = 40;
  const auto truth_of_turned = [](double angle) {
    Mesh mesh;
    for (int i = 0; i <= n; ++i)
      for (int k = 0; k <= n; ++k) {
        const double x = static_cast<double>(i) / n, y = static_cast<double>(k) / n;
        mesh.positions.push_back({x, y, 0.04 * (std::sin(31 * x + 3) * std::cos(23 * y) + std::sin(41 * y))});
        mesh.uvs.push_back({static_cast<float>(std::cos(angle) * x - std::sin(angle) * y),
                            static_cast<float>(std::sin(angle) * x + std::cos(angle) * y)});
      }
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t a = i * (n + 1) + k, b = a + n + 1;
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
      }
    return local_truth(mesh);
  };
  const std::vector<Truth> straight = truth_of_turned(0);
  for (const double angle : {0.1, 0.5, 0.785, 1.05}) {
    SCOPED_TRACE("turned by " + std::to_string(angle));
    const std::vector<Truth> turned = truth_of_turned(angle);
    std::size_t known = 0;
    for (std::size_t v = 0; v < turned.size(); ++v) {
      if (!(turned[v].normal_deg < 5 && straight[v].normal_deg < 5)) continue;
      ++known;
      EXPECT_LT(degrees(turned[v].normal, straight[v].normal),
                1 + 6 * std::hypot(turned[v].normal_deg, straight[v].normal_deg))
          << "vertex " << v;
    }
    EXPECT_GT(known, 200u);
  }
}

}  // namespace
}  // namespace darboux::local_truth_test
