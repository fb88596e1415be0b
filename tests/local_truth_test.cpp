// What a mesh's positions and uvs say of its frames, against the surface that they were taken from: the standard deviations are
// honest, in both directions, and the frames far better than averages.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include <darboux/local_truth.h>
#include <darboux/mesh_classes.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>

namespace darboux {
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

TEST(LocalTruth, DeviationsAreHonest) {
  for (const int n : {16, 32, 64})
    for (const Case& c : cases()) {
      const Mesh mesh = mesh_of(c, n);
      const std::vector<Truth> truth = local_truth(mesh);
      const MeshClasses classes = classify(mesh, {});
      for (const bool normal : {true, false}) {
        std::vector<double> errors, bars;
        double ratio[3] = {0, 0, 0};
        std::size_t corners = 0;
        for (std::size_t v = 0; v < truth.size(); ++v) {
          if (classes.of_vertex[v] != VertexClass::interior) continue;
          ++corners;
          const double error = normal ? degrees(truth[v].normal, mesh.normals[v])
                                      : degrees(truth[v].tangent, {mesh.tangents[v].x, mesh.tangents[v].y, mesh.tangents[v].z});
          const double bar = normal ? truth[v].normal_deg : truth[v].tangent_deg;
          if (!std::isfinite(bar)) continue;
          errors.push_back(error), bars.push_back(bar);
          for (int k = 0; k < 3; ++k) ratio[k] += error <= (k + 1) * bar;
        }
        for (double& r : ratio) r *= 100.0 / static_cast<double>(errors.size());
        std::cout << c.surface << ' ' << c.jitter << ' ' << c.shear << " n " << n << (normal ? " normal " : " tangent ") << corners
                  << " known " << errors.size() << " median error " << median(errors) << " bar/error " << median(bars) / median(errors)
                  << " within 1 2 3: " << ratio[0] << ' ' << ratio[1] << ' ' << ratio[2] << '\n';
      }
    }
}

double worst_free_rms(const std::vector<double>& x) {
  double s = 0;
  for (const double e : x) s += e * e;
  return std::sqrt(s / static_cast<double>(x.size()));
}

TEST(LocalTruth, IsFarBetterThanAverages) {
  for (const Case& c : cases()) {
    const Mesh mesh = mesh_of(c, 64);
    const std::vector<Truth> truth = local_truth(mesh);
    const MeshClasses classes = classify(mesh, {});
    const auto error_of = [&](const auto& tangent_at) {
      std::vector<double> errors;
      for (std::size_t i = 0; i < mesh.corners(); ++i) {
        const std::uint32_t v = mesh.triangles[i / 3][i % 3];
        if (classes.of_vertex[v] != VertexClass::interior || !std::isfinite(truth[v].tangent_deg)) continue;
        errors.push_back(degrees(tangent_at(i, v), {mesh.tangents[v].x, mesh.tangents[v].y, mesh.tangents[v].z}));
      }
      return worst_free_rms(errors);
    };
    const double local = error_of([&](std::size_t, std::uint32_t v) { return truth[v].tangent; });
    double best = 1e300;
    std::string name;
    for (const std::string_view method : {"mikktspace", "average", "unit", "area", "angle", "max"}) {
      const MeshFrames frames = mesh_frames(mesh, find_frame_method(method));
      const double error = error_of([&](std::size_t i, std::uint32_t) { return frames.corner(i).t; });
      if (error < best) best = error, name = method;
    }
    std::cout << c.surface << ' ' << c.jitter << ' ' << c.shear << " local " << local << " best " << name << ' ' << best << " ratio " << best / local << '\n';
  }
}

}  // namespace
}  // namespace darboux
