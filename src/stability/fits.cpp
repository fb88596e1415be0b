// Fits to points: the errors of parameters against the standard errors that the fit states.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <darboux/fit_points.h>
#include <darboux/frame.h>

#include "base/bounds.h"
#include "base/degrees.h"
#include "measure.h"

namespace darboux::sweeps {
namespace {

constexpr std::size_t parameters_quantity = 8, frames_quantity = 9;
constexpr double most_standard_errors = 6;

// Random numbers that are the same with every standard library, which std's distributions do not promise.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : bits_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  double normal() {  // Marsaglia's polar method
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), s = x * x + y * y;
      if (s > 0 && s < 1) return x * std::sqrt(-2 * std::log(s) / s);
    }
  }

 private:
  std::mt19937_64 bits_;
};

struct Cloud {
  int points = 1000;
  double outliers = 0, coverage = 1;
  double noise = 1e-3;  // of a coordinate, over the size of the surface
};

Cloud cloud_at(std::string_view sweep, double x) {
  Cloud cloud;
  if (sweep == "points") cloud.points = static_cast<int>(std::lround(x));
  if (sweep == "outliers") cloud.outliers = x;
  if (sweep == "coverage") {
    cloud.coverage = x;
    cloud.noise = 1e-4;
    cloud.points = 4000;
  }
  if (sweep == "noise") cloud.noise = x;
  return cloud;
}

// Half the largest extent, as a power of two, so that a scaled surface has scaled points.
double size_of(const AnySurface& surface) {
  Bounds box;
  for (int i = 0; i <= 16; ++i)
    for (int k = 0; k <= 16; ++k) box.add(surface.jet(i / 16.0, k / 16.0).position);
  return std::exp2(std::round(std::log2(box.longest_side() / 2)));
}

// Points on the surface, uniform by area over the middle of its chart, with noise; outliers in the box about
// them.
PointCloud points_on(const AnySurface& surface, const Cloud& cloud, Numbers& random) {
  PointCloud result;
  const double half = std::sqrt(cloud.coverage) / 2, noise = cloud.noise * size_of(surface);
  const auto area = [&](double u, double v) {
    const Jet2<double> j = surface.jet(u, v);
    return norm(cross(j.dpdu, j.dpdv));
  };
  double largest = 0;
  for (int i = 0; i <= 32; ++i)
    for (int k = 0; k <= 32; ++k)
      largest = std::fmax(largest, area(0.5 + half * (i / 16.0 - 1), 0.5 + half * (k / 16.0 - 1)));
  const int good = cloud.points - static_cast<int>(std::lround(cloud.outliers * cloud.points));
  Bounds box;
  while (static_cast<int>(result.positions.size()) < good) {
    const double u = random.uniform(0.5 - half, 0.5 + half), v = random.uniform(0.5 - half, 0.5 + half);
    if (random.uniform(0, 1.1 * largest) > area(u, v)) continue;
    const Vec3<double> p = surface.jet(u, v).position;
    box.add(p);
    result.positions.push_back(p + noise * Vec3<double>{random.normal(), random.normal(), random.normal()});
  }
  // The same margin beyond the surface in every direction: flat ones have outliers above and below.
  const double margin = 0.125 * box.longest_side();
  while (static_cast<int>(result.positions.size()) < cloud.points)
    result.positions.push_back({random.uniform(box.low.x - margin, box.high.x + margin),
                                random.uniform(box.low.y - margin, box.high.y + margin),
                                random.uniform(box.low.z - margin, box.high.z + margin)});
  return result;
}

// For closed surfaces only: parameters of others also bound the patch of points.
void compare_parameters(const AnySurface& surface, const PointFit& fit, auto add) {
  if (!surface.info().euler_characteristic) return;
  std::vector<ParameterValue> truth = surface.parameters();
  const std::vector<ParameterValue> found = fit.surface->surface.parameters();
  // A fit has no x, y and z: an ellipsoid's semi-axes, which come first, are in descending order.
  if (surface.info().name == "ellipsoid")
    std::sort(truth.begin(), truth.begin() + 3,
              [](const ParameterValue& a, const ParameterValue& b) { return a.value > b.value; });
  for (std::size_t k = 0; k < truth.size(); ++k)
    for (const StandardError& e : fit.standard_errors)
      if (e.name == found[k].name)
        add(parameters_quantity, found[k].name, std::fabs(found[k].value - truth[k].value), e.value,
            std::fabs(truth[k].value), Vec2<double>{});
}

// The fitted normal near points of the patch against the true one.
void compare_normals(const AnySurface& surface, const PointFit& fit, double half, auto add) {
  for (const double a : {-0.6, 0.1, 0.7})
    for (const double b : {-0.5, 0.2, 0.6}) {
      const Vec2<double> uv{0.5 + half * a, 0.5 + half * b};
      const Sample<double> truth = surface.sample(uv.x, uv.y);
      const UncertainFrame found = frame_near(fit, truth.jet.position);
      const double angle = angle_between_units(truth.frame.n, found.n) * 180 / std::numbers::pi;
      // A fitted surface may have either side.
      add(frames_quantity, "normal", std::fmin(angle, 180 - angle), found.normal_deg, degrees_per_radian, uv);
    }
}

}  // namespace

// elliptic-paraboloid apart: by that name its semi-axes may differ, and a fit takes a second.
bool is_fitted(const AnySurface& surface) {
  const auto& kinds = found_kinds();
  const std::string_view name = surface.info().name;
  return name != "elliptic-paraboloid" && std::find(kinds.begin(), kinds.end(), name) != kinds.end();
}

std::vector<Measurement> measure_fits(const StabilityOptions& options, const StabilitySweep& sweep,
                                      const AnySurface& surface) {
  std::vector<Measurement> result;
  for (std::size_t r = 0; r < options.routes.size(); ++r) {
    if (options.routes[r]->domain != StabilityDomain::fits) continue;
    std::uint64_t seed = options.seed * 7919;
    for (const double x : values_of_x(options, sweep)) {
      Numbers random(seed++);
      const Cloud cloud = cloud_at(sweep.name, x);
      PointFitOptions fit_options;
      fit_options.surface = std::string(surface.info().name);
      const PointFit fit = fit_points(points_on(surface, cloud, random), fit_options);
      if (!fit.usable) continue;  // it says so
      const auto add = [&](std::size_t quantity, std::string_view member, double error, double deviation,
                           double size, const Vec2<double>& uv) {
        if (deviation > 0 && std::isfinite(deviation))
          result.push_back({r,
                            x,
                            {quantity, member, {error / deviation, most_standard_errors, deviation / size}},
                            1,
                            uv.x,
                            uv.y,
                            surface.specification()});
      };
      compare_parameters(surface, fit, add);
      compare_normals(surface, fit, std::sqrt(cloud.coverage) / 2, add);
    }
  }
  return result;
}

}  // namespace darboux::sweeps
