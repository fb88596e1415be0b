// Local fits of unknown surfaces: the orders of their errors, and how much of these their standard errors
// cover.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/local_jets.h>
#include <darboux/statistics.h>

#include "jet_patches.h"
#include "random.h"

namespace darboux::test::local_jets_accuracy_test {
namespace {

double slope(const std::vector<double>& h, const std::vector<double>& errors) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < h.size(); ++i) x.push_back(std::log(h[i])), y.push_back(std::log(errors[i]));
  return fit_line(x, y).slope;
}

double rms(const std::vector<double>& x) {
  double sum = 0;
  for (const double v : x) sum += v * v;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

// The foot of the fit lies off the query by O(h^(d + 1)): truth is that at the query.
TEST(LocalJets, NormalsOfOrderDAndCurvaturesOfOrderDMinus1) {
  for (const char* specification : specifications)
    for (int degree = 2; degree <= 4; ++degree) {
      const AnySurface surface = make_surface(specification);
      Random random(20 + static_cast<std::uint64_t>(degree));
      std::vector<double> sizes, normals, curvatures, directions;
      for (double h = 0.1; h > 0.02; h /= 1.5) {
        std::vector<double> n, k, d;
        for (int i = 0; i < 400; ++i) {
          const Patch patch = random_patch(surface, random, 30, h);
          const Frame<double> frame = surface.frame(patch.uv.x, patch.uv.y);
          const auto truth = curvature(surface, patch.uv.x, patch.uv.y);
          const LocalJet jet = local_jet(patch.points, patch.points[0], {.degree = degree, .side = frame.n});
          ASSERT_EQ(jet.status, Status::regular);
          n.push_back(angle_between(jet.n, frame.n));
          for (int c = 0; c < 2; ++c) k.push_back(jet.curvature.principal[c] - truth.principal[c]);
          // Where the curvatures are close, the directions mean little.
          if (truth.principal[0] - truth.principal[1] > 0.5)
            d.push_back(line_angle(jet.curvature.directions[0], truth.directions[0]));
        }
        sizes.push_back(h);
        normals.push_back(rms(n));
        curvatures.push_back(rms(k));
        directions.push_back(d.empty() ? 1 : rms(d));
      }
      const double n = slope(sizes, normals), k = slope(sizes, curvatures), d = slope(sizes, directions);
      std::cout << specification << " degree " << degree << ": orders normal " << n << ", curvature " << k
                << ", direction " << d << "; at h = 0.1 " << normals[0] << ", " << curvatures[0] << ", "
                << directions[0] << '\n';
      // A sphere has no odd terms over its tangent plane, and gains an order where those would lead.
      const bool sphere = std::string(specification).starts_with("sphere");
      const double order = degree + (sphere && degree % 2 == 0 ? 1 : 0);
      EXPECT_NEAR(n, order, 0.2) << specification << degree;
      EXPECT_NEAR(k, order - 1, 0.2) << specification << degree;
      if (!sphere) {
        EXPECT_NEAR(d, order - 1, 0.2) << specification << degree;
      }
    }
}

TEST(UvJets, PartialsOfOrderD) {
  for (const char* specification : specifications)
    for (int degree = 2; degree <= 4; ++degree) {
      const AnySurface surface = make_surface(specification);
      Random random(30 + static_cast<std::uint64_t>(degree));
      std::vector<double> sizes, firsts, seconds, tangents;
      for (double h = 0.1; h > 0.02; h /= 1.5) {
        std::vector<double> first, second, tangent;
        for (int i = 0; i < 400; ++i) {
          const Patch patch = random_patch(surface, random, 30, h);
          const Jet2<double> truth = surface.jet(patch.uv.x, patch.uv.y);
          const UvJet jet = uv_jet(patch.uvs, patch.points, patch.uv, {.degree = degree});
          ASSERT_EQ(jet.frame.status, Status::regular);
          first.push_back(norm(jet.jet.dpdu - truth.dpdu) / norm(truth.dpdu));
          first.push_back(norm(jet.jet.dpdv - truth.dpdv) / norm(truth.dpdv));
          second.push_back(norm(jet.jet.d2pdu2 - truth.d2pdu2));
          second.push_back(norm(jet.jet.d2pduv - truth.d2pduv));
          second.push_back(norm(jet.jet.d2pdv2 - truth.d2pdv2));
          tangent.push_back(angle_between(jet.frame.t, unit(truth.dpdu)));
        }
        sizes.push_back(h);
        firsts.push_back(rms(first));
        seconds.push_back(rms(second));
        tangents.push_back(rms(tangent));
      }
      const double f = slope(sizes, firsts), s = slope(sizes, seconds), t = slope(sizes, tangents);
      std::cout << specification << " degree " << degree << ": orders first " << f << ", second " << s
                << ", tangent " << t << "; at h = 0.1 " << firsts[0] << ", " << seconds[0] << '\n';
      EXPECT_NEAR(f, degree, 0.2) << specification;
      EXPECT_NEAR(s, degree - 1, 0.2) << specification;
      EXPECT_GT(t, degree - 0.2) << specification;  // what errs along dpdu does not turn it
    }
}

// Of many |error| / standard error: how many are at most 2, and the root mean square.
class Coverage {
 public:
  void add(double error, double standard_error) {
    ++count_;
    if (std::fabs(error) <= 2 * standard_error) ++within_;
    ratios_.push_back(std::fabs(error) / standard_error);
  }
  double within() const { return within_ / count_; }
  double median() {
    std::nth_element(ratios_.begin(), ratios_.begin() + static_cast<std::ptrdiff_t>(ratios_.size() / 2),
                     ratios_.end());
    return ratios_[ratios_.size() / 2];
  }
  double count() const { return count_; }

 private:
  double within_ = 0, count_ = 0;
  std::vector<double> ratios_;
};

// 95 % of the errors lie within two standard errors, less what chance takes from a share of so many; and the
// standard errors are no wild guess: half of the errors are above a tenth of them.
void expect_honest(const std::string& what, Coverage& coverage, double least_within = 0.95,
                   double least_median = 0.1) {
  const double chance = 3 * std::sqrt(0.95 * 0.05 / coverage.count());
  std::cout << what << ": within two " << coverage.within() << ", median error / standard error "
            << coverage.median() << '\n';
  EXPECT_GT(coverage.within(), least_within - chance) << what;
  EXPECT_GT(coverage.median(), least_median) << what;
}

TEST(LocalJets, ErrorsCoverNoiseAndTruncation) {
  for (const char* specification : {specifications[0], specifications[1]})
    for (int degree = 2; degree <= 4; ++degree)
      for (const auto& [h, sigma] :
           {std::pair{0.05, 0.0}, {0.05, 1e-6}, {0.05, 1e-4}, {0.15, 0.0}, {0.15, 1e-5}, {0.15, 1e-3}}) {
        const AnySurface surface = make_surface(specification);
        Random random(40 + static_cast<std::uint64_t>(degree));
        Coverage normals, k1, k2, directions;
        for (int i = 0; i < 1000; ++i) {
          Patch patch = random_patch(surface, random, 2 * jet_coefficients(degree + 1), h);
          const Vec3<double> at = patch.points[0];
          add_noise(patch, random, sigma);
          const Frame<double> frame = surface.frame(patch.uv.x, patch.uv.y);
          const auto truth = curvature(surface, patch.uv.x, patch.uv.y);
          const LocalJet jet = local_jet(patch.points, at, {.degree = degree, .side = frame.n});
          normals.add(angle_between(jet.n, frame.n), jet.normal_error);
          k1.add(jet.curvature.principal[0] - truth.principal[0], jet.principal_error[0]);
          k2.add(jet.curvature.principal[1] - truth.principal[1], jet.principal_error[1]);
          if (jet.direction_error < 0.2)  // radians: it is of first order
            directions.add(line_angle(jet.curvature.directions[0], truth.directions[0]), jet.direction_error);
        }
        const std::string what = std::string(specification).substr(0, 9) + " degree " +
                                 std::to_string(degree) + " h " + std::to_string(h) + " noise " +
                                 std::to_string(sigma);
        // At 3/8 of the torus' radius what comes after the next degree shows too: nine in ten.
        const double within = h > 0.1 ? 0.9 : 0.95;
        expect_honest(what + " normal", normals, within);
        expect_honest(what + " k1", k1, within);
        expect_honest(what + " k2", k2, within);
        if (directions.count() > 100) expect_honest(what + " directions", directions, within);
      }
}

// The 19 vertices up to two edges away on a regular triangulation, in uv.
Patch two_ring(const AnySurface& surface, Random& random, double h, double jitter) {
  Patch patch{{random.uniform(0, 1), random.uniform(0.2, 0.8)}, {}, {}};
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      if (std::abs(i + j) <= 2)
        patch.uvs.push_back(patch.uv + Vec2<double>{h * (i + random.uniform(-jitter, jitter)),
                                                    h * (j + random.uniform(-jitter, jitter))});
  for (const auto& uv : patch.uvs) patch.points.push_back(surface.jet(uv.x, uv.y).position);
  return patch;
}

TEST(UvJets, ErrorsCoverNoiseAndTruncation) {
  for (const char* specification : {specifications[0], specifications[1]})
    for (int degree = 2; degree <= 3; ++degree)
      for (const double jitter : {0.0, 0.2, -1.0})  // the last stands for random neighbours
        for (const double sigma : {0.0, 1e-6, 1e-3}) {
          const AnySurface surface = make_surface(specification);
          Random random(50 + static_cast<std::uint64_t>(degree));
          Coverage us, vs, tangents, normals;
          for (int i = 0; i < 1000; ++i) {
            Patch patch = jitter < 0 ? random_patch(surface, random, 2 * jet_coefficients(degree + 1), 0.15)
                                     : two_ring(surface, random, 0.01, jitter);
            add_noise(patch, random, sigma);
            const Jet2<double> truth = surface.jet(patch.uv.x, patch.uv.y);
            const UvJet jet = uv_jet(patch.uvs, patch.points, patch.uv, {.degree = degree});
            us.add(norm(jet.jet.dpdu - truth.dpdu), jet.dpdu_error);
            vs.add(norm(jet.jet.dpdv - truth.dpdv), jet.dpdv_error);
            tangents.add(angle_between(jet.jet.dpdu, truth.dpdu), jet.tangent_error);
            normals.add(angle_between(jet.frame.n, frame_from_partials(truth.dpdu, truth.dpdv).n),
                        jet.normal_error);
          }
          const std::string what = std::string(specification).substr(0, 9) + " degree " +
                                   std::to_string(degree) + " jitter " + std::to_string(jitter) + " noise " +
                                   std::to_string(sigma);
          // On a symmetric ring the cubic gains an order that its errors do not claim.
          const double least_median = degree == 3 && jitter == 0 && sigma == 0 ? 0 : 0.1;
          expect_honest(what + " dpdu", us, 0.95, least_median);
          expect_honest(what + " dpdv", vs, 0.95, least_median);
          expect_honest(what + " t", tangents, 0.95, least_median);
          expect_honest(what + " n", normals, 0.95, least_median);
        }
}

}  // namespace
}  // namespace darboux::test::local_jets_accuracy_test
