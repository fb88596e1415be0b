// Local jets of a torus cloud beside CGAL's Monge_via_jet_fitting, and their orders: tables of
// docs/reports/fit.md.
//   benchmark_local_jets [--quick]
// Both fit the same neighbours of the same points on one core, in turns; finding the neighbours is not timed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include <darboux/catalogue.h>
#include <darboux/curvature.h>
#include <darboux/local_jets.h>

#ifdef DARBOUX_BENCHMARK_CGAL
#define CGAL_EIGEN3_ENABLED
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/version.h>
#endif

#include "base/neighbours.h"
#include "measure.h"

namespace darboux::bench {
namespace {

// Points spread evenly over a torus, the truth at the first `fits` of them, and the neighbours of these.
struct Cloud {
  std::vector<Vec3<double>> points;
  std::vector<Vec3<double>> normals;
  std::vector<Curvature<double>> curvatures;
};

Cloud torus_cloud(std::size_t count, std::size_t fits) {
  const Torus<double> torus{1, 0.4};
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Cloud cloud;
  while (cloud.points.size() < count) {
    const double u = uniform(random), v = uniform(random);
    const double most =
        torus.major_radius +
        torus.minor_radius;  // of the distance from the axis, to which the area is proportional
    if (uniform(random) * most > torus.major_radius + torus.minor_radius * std::cos(2 * std::numbers::pi * v))
      continue;
    cloud.points.push_back(jet(torus, u, v).position);
    if (cloud.normals.size() == fits) continue;
    cloud.normals.push_back(frame(torus, u, v).n);
    cloud.curvatures.push_back(curvature(torus, u, v));
  }
  return cloud;
}

// Errors over the fits: of the normal in radians, of both curvatures over the larger.
struct Errors {
  std::vector<double> normal, curvature;
  void add(const Vec3<double>& n, double k1, double k2, const Vec3<double>& true_n,
           const Curvature<double>& truth) {
    const double size = std::max(std::fabs(truth.principal[0]), std::fabs(truth.principal[1]));
    normal.push_back(angle_between(n, true_n));
    curvature.push_back(std::max(std::fabs(k1 - truth.principal[0]), std::fabs(k2 - truth.principal[1])) /
                        size);
  }
};

double sink = 0;  // so that nothing is left out

void table(bool quick) {
  const std::size_t count = quick ? 4000 : 20000, fits = quick ? 300 : 2000;
  const int rounds = quick ? 3 : 15;
  const Cloud cloud = torus_cloud(count, fits);
  const Neighbours tree(cloud.points);
  std::printf("\n### Local jets\n\n");
  std::printf(
      "%zu points of a torus (radii 1 and 0.4), fits at %zu of them, one core, seed %llu, best of %d rounds; "
      "the "
      "neighbours are known. Errors: medians.\n\n",
      count, fits, static_cast<unsigned long long>(seed), rounds);
#ifdef DARBOUX_BENCHMARK_CGAL
  std::printf("CGAL %s, Monge_via_jet_fitting with Eigen_svd.\n\n", CGAL_VERSION_STR);
#else
  std::printf(
      "Without CGAL: CGAL/Monge_via_jet_fitting.h, gmp or mpfr was not there when this was built.\n\n");
#endif
  std::printf(
      "| degree | neighbours | Darboux, fits/s | CGAL, fits/s | × CGAL | normal error, Darboux | CGAL | "
      "curvature error, "
      "Darboux | CGAL |\n|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const auto& row : {std::pair{2, 12}, {2, 20}, {3, 20}, {3, 30}, {4, 31}, {4, 42}}) {
    const int degree = row.first, k = row.second;
    const auto size = static_cast<std::size_t>(k);
    std::vector<std::uint32_t> near(size);
    std::vector<double> squared(size);
    std::vector<Vec3<double>> points;
    for (std::size_t i = 0; i < fits; ++i) {
      tree.nearest(cloud.points[i], near, squared);
      for (const std::uint32_t j : near) points.push_back(cloud.points[j]);
    }
    const auto of = [&](std::size_t i) { return std::span(points).subspan(i * size, size); };
    const auto ours = [&](std::size_t i) {
      return local_jet(of(i), cloud.points[i], {.degree = degree, .side = cloud.normals[i]});
    };
    std::vector<Timing> timings;
    timings.push_back({"", "Darboux", fits, [&] {
                         for (std::size_t i = 0; i < fits; ++i) sink += ours(i).n.x;
                       }});
    Errors errors[2];
    for (std::size_t i = 0; i < fits; ++i) {
      const LocalJet jet = ours(i);
      errors[0].add(jet.n, jet.curvature.principal[0], jet.curvature.principal[1], cloud.normals[i],
                    cloud.curvatures[i]);
    }
#ifdef DARBOUX_BENCHMARK_CGAL
    using Kernel = CGAL::Simple_cartesian<double>;
    using Fit = CGAL::Monge_via_jet_fitting<Kernel>;
    std::vector<Kernel::Point_3> theirs;
    for (const Vec3<double>& p : points) theirs.emplace_back(p.x, p.y, p.z);
    const auto cgal = [&](std::size_t i) {
      Fit fit;
      const auto begin = theirs.begin() + static_cast<std::ptrdiff_t>(i * size);
      // What we give as well: curvatures and no derivatives of theirs.
      auto monge = fit(begin, begin + k, static_cast<std::size_t>(degree), 2);
      monge.comply_wrt_given_normal({cloud.normals[i].x, cloud.normals[i].y, cloud.normals[i].z});
      return monge;
    };
    timings.push_back({"", "CGAL", fits, [&] {
                         for (std::size_t i = 0; i < fits; ++i) sink += cgal(i).normal_direction().x();
                       }});
    for (std::size_t i = 0; i < fits; ++i) {
      const auto monge = cgal(i);
      const auto n = monge.normal_direction();
      errors[1].add({n.x(), n.y(), n.z()}, monge.principal_curvatures(0), monge.principal_curvatures(1),
                    cloud.normals[i], cloud.curvatures[i]);
    }
#endif
    measure(timings, rounds);
    std::printf("| %d | %d | %.0f |", degree, k, 1e9 / timings[0].best());
    if (timings.size() > 1)
      std::printf(" %.0f | %.1f | %.1e | %.1e | %.1e | %.1e |\n", 1e9 / timings[1].best(),
                  ratio(timings[1], timings[0]), median(errors[0].normal), median(errors[1].normal),
                  median(errors[0].curvature), median(errors[1].curvature));
    else
      std::printf(" not measured | | %.1e | | %.1e | |\n", median(errors[0].normal),
                  median(errors[0].curvature));
    std::fflush(stdout);
  }
  if (!std::isfinite(sink)) std::printf("\nA fit gave no number.\n");
}

// Errors at twice the distance between points over those at the distance, as powers of two: orders.
void orders(bool quick) {
  const std::size_t fits = quick ? 300 : 2000, fewest = quick ? 4000 : 20000;
  std::printf(
      "\nOrders: %zu, %zu and %zu points of the same torus, the spacing halved twice, slope of the medians' "
      "logarithms.\n\n| degree | neighbours | order of the normal | required | order of the curvatures | "
      "required |\n|---:|---:|---:|---:|---:|---:|\n",
      fewest, 4 * fewest, 16 * fewest);
  for (const auto& row : {std::pair{2, 20}, {3, 30}, {4, 42}}) {
    const int degree = row.first;
    std::vector<std::uint32_t> near(static_cast<std::size_t>(row.second));
    std::vector<double> squared(near.size()), normal, curvature;
    for (const std::size_t count : {fewest, 4 * fewest, 16 * fewest}) {
      const Cloud cloud = torus_cloud(count, fits);
      const Neighbours tree(cloud.points);
      Errors errors;
      for (std::size_t i = 0; i < fits; ++i) {
        tree.nearest(cloud.points[i], near, squared);
        std::vector<Vec3<double>> points;
        for (const std::uint32_t j : near) points.push_back(cloud.points[j]);
        const LocalJet jet = local_jet(points, cloud.points[i], {.degree = degree, .side = cloud.normals[i]});
        errors.add(jet.n, jet.curvature.principal[0], jet.curvature.principal[1], cloud.normals[i],
                   cloud.curvatures[i]);
      }
      normal.push_back(std::log2(median(errors.normal)));
      curvature.push_back(std::log2(median(errors.curvature)));
    }
    std::printf("| %d | %d | %.2f | %d ± 0.2 | %.2f | %d ± 0.2 |\n", degree, row.second,
                (normal[0] - normal[2]) / 2, degree, (curvature[0] - curvature[2]) / 2, degree - 1);
  }
}

}  // namespace
}  // namespace darboux::bench

int main(int count, char** arguments) {
  const bool quick = count == 2 && std::strcmp(arguments[1], "--quick") == 0;
  if (count > 2 || (count == 2 && !quick)) {
    std::fprintf(stderr, "usage: benchmark_local_jets [--quick]\n");
    return 2;
  }
  darboux::bench::table(quick);
  darboux::bench::orders(quick);
}
