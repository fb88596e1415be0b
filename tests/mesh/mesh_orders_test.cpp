// Orders of convergence, one table: normals, fragments inside triangles, polynomials. Those of tangents at
// vertices by class of vertex stand in converge_test.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/fragments.h>
#include <darboux/frame.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/statistics.h>
#include <darboux/vertex_normals.h>

namespace darboux::mesh_orders_test {
namespace {

constexpr std::uint64_t seed = 20261122;
constexpr double tolerance = 0.15;
constexpr std::array resolutions{32, 64, 128};

struct Sampled {
  Mesh mesh;
  AnySurface surface;
  std::vector<bool> inner;  // of each vertex: in the part of the chart that is measured, five edges and more
                            // from its borders

  Sampled(const AnySurface& of, int n, double jitter, bool random_diagonals)
      : mesh(sample_mesh(of, {.columns = 2 * n,
                              .rows = n,
                              .jitter = jitter,
                              .random_diagonals = random_diagonals,
                              .seed = seed,
                              .v_first = 0.2,
                              .v_last = 0.8})),
        surface(of) {
    for (const auto& [u, v] : mesh.uvs) inner.push_back(u > 0.1 && u < 0.9 && v > 0.3 && v < 0.7);
  }
  TriangleFrames triangle(std::size_t t) const {
    TriangleFrames result;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      result.p[k] = mesh.positions[v];
      result.uv[k] = mesh.uvs[v];
      const Vec3<double> along = mesh.tangents[v].xyz();
      result.frames[k] = {
          along, {}, mesh.normals[v], -mesh.tangents[v].w, false};  // gltf's sign is the raw one's opposite
    }
    return result;
  }
  Frame<double> truth(const Vec2<double>& uv) const { return surface.frame(uv.x, uv.y); }
};

// Errors in radians of one quantity, at every place that it has in the interior.
using Measure = std::function<void(const Sampled&, std::vector<double>&)>;

Measure normals(NormalWeight weight) {
  return [weight](const Sampled& s, std::vector<double>& errors) {
    const std::vector<Vec3<double>> found = vertex_normals(s.mesh, weight);
    for (std::size_t v = 0; v < found.size(); ++v)
      if (s.inner[v]) errors.push_back(angle_between(found[v], s.mesh.normals[v]));
  };
}

enum Quantity { t, n };
Measure at_vertices(const char* method, Quantity quantity) {
  return [method, quantity](const Sampled& s, std::vector<double>& errors) {
    const MeshFrames frames = mesh_frames(s.mesh, find_frame_method(method));
    for (std::size_t c = 0; c < s.mesh.corners(); ++c) {
      const std::uint32_t v = s.mesh.triangles[c / 3][c % 3];
      if (!s.inner[v]) continue;
      errors.push_back(quantity == t ? angle_between(frames.corner(c).t, s.mesh.tangents[v].xyz())
                                     : angle_between(frames.corner(c).n, s.mesh.normals[v]));
    }
  };
}

Measure inside(FragmentForm form, Quantity quantity,
               std::array<double, 3> weights = {1.0 / 3, 1.0 / 3, 1.0 / 3}) {
  return [=](const Sampled& s, std::vector<double>& errors) {
    for (std::size_t k = 0; k < s.mesh.triangles.size(); ++k) {
      if (!s.inner[s.mesh.triangles[k][0]]) continue;
      const TriangleFrames triangle = s.triangle(k);
      Vec2<double> uv{};
      for (std::size_t i = 0; i < 3; ++i)
        uv = {uv.x + weights[i] * triangle.uv[i].x, uv.y + weights[i] * triangle.uv[i].y};
      const CornerFrame frame = fragment_frame(form, triangle, weights);
      const Frame<double> truth = s.truth(uv);
      errors.push_back(quantity == t ? angle_between(frame.t, truth.t) : angle_between(frame.n, truth.n));
    }
  };
}

Measure face_normals_at_centroids() {
  return [](const Sampled& s, std::vector<double>& errors) {
    const MeshFrames frames = mesh_frames(s.mesh, find_frame_method("face"));
    for (std::size_t k = 0; k < s.mesh.triangles.size(); ++k) {
      const TriangleFrames triangle = s.triangle(k);
      if (!s.inner[s.mesh.triangles[k][0]]) continue;
      const Vec2<double> uv{(triangle.uv[0].x + triangle.uv[1].x + triangle.uv[2].x) / 3,
                            (triangle.uv[0].y + triangle.uv[1].y + triangle.uv[2].y) / 3};
      errors.push_back(angle_between(frames.corner(3 * k).n, s.truth(uv).n));
    }
  };
}

// An order, or `exact`: all errors stay below what rounding makes of them, by symmetry.
using Order = std::optional<double>;
constexpr Order exact = std::nullopt;
struct Row {
  std::string what;
  Measure measure;
  Order regular, jittered;
  int finer = 1;  // so many times the resolutions
};
// 2^-53 · 16 · |P| / (an edge of 1/128), and a hundred times that.
constexpr double floor_of_rounding = 1e-9;

// The meshes of a surface: all rows measure the same.
class Samples {
 public:
  explicit Samples(const AnySurface& surface) : surface_(surface) {}
  const Sampled& at(int n, double jitter, bool random_diagonals) {
    return sampled_.try_emplace({n, jitter, random_diagonals}, surface_, n, jitter, random_diagonals)
        .first->second;
  }

 private:
  const AnySurface& surface_;
  std::map<std::tuple<int, double, bool>, Sampled> sampled_;
};

Order order_of(const Row& row, Samples& samples, double jitter, bool random_diagonals) {
  std::vector<double> x, y;
  double greatest = 0;
  for (const int resolution : resolutions) {
    std::vector<double> errors;
    row.measure(samples.at(row.finer * resolution, jitter, random_diagonals), errors);
    const Statistics s = summarise(errors);
    x.push_back(-std::log(resolution));
    y.push_back(std::log(s.rms));
    greatest = std::max(greatest, s.max);
  }
  if (greatest < floor_of_rounding) return exact;
  return fit_line(x, y).slope;
}

std::string words(const Order& order) {
  return order ? std::to_string(*order) : "exact";
}

void expect_order(const Order& found, const Order& expected, const std::string& what) {
  ASSERT_EQ(found.has_value(), expected.has_value())
      << what << ": found " << words(found) << ", expected " << words(expected);
  if (found) {
    EXPECT_NEAR(*found, *expected, tolerance) << what;
  }
}

void expect_orders(const char* name, const std::vector<Row>& rows) {
  const AnySurface surface = make_surface(name);
  Samples samples(surface);
  std::cout << name << ", seed " << seed << ": order regular, jittered, jittered with random diagonals\n";
  for (const Row& row : rows) {
    const Order regular = order_of(row, samples, 0, false), jittered = order_of(row, samples, 0.15, false),
                diagonals = order_of(row, samples, 0.15, true);
    std::cout << "  " << row.what << ": " << words(regular) << ' ' << words(jittered) << ' '
              << words(diagonals) << '\n';
    const std::string what = std::string(name) + ", " + row.what;
    expect_order(regular, row.regular, what + ", regular");
    expect_order(jittered, row.jittered, what + ", jittered");
    expect_order(diagonals, row.jittered, what + ", random diagonals");
  }
}

std::vector<Row> rows() {
  const std::array<double, 3> off_centre{0.2, 0.7, 0.1};
  return {
      {"face n at the centroid", face_normals_at_centroids(), 1, 1},
      {"face t at vertices", at_vertices("face", t), 1, 1},
      {"vertex n, uniform", normals(NormalWeight::uniform), 2, 1},
      {"vertex n, area", normals(NormalWeight::area), 2, 1},
      {"vertex n, angle", normals(NormalWeight::angle), 2, 1},
      {"vertex n, Max", normals(NormalWeight::max), 2, 1},
      {"vertex t, average", at_vertices("average", t), 2, 1},
      {"vertex t, unit", at_vertices("unit", t), 2, 1},
      {"vertex t, area", at_vertices("area", t), 2, 1},
      {"vertex t, angle", at_vertices("angle", t), 2, 1},
      {"vertex t, Max", at_vertices("max", t), 2, 1},
      {"interpolated n", inside(FragmentForm::interpolated, n), 2, 2},
      {"interpolated n off centre", inside(FragmentForm::interpolated, n, off_centre), 2, 2},
      {"interpolated t", inside(FragmentForm::interpolated, t), 2, 2},
      {"interpolated t, raw", inside(FragmentForm::interpolated_raw, t), 2, 2},
      {"face t on interpolated n", inside(FragmentForm::projected, t), 1, 1},
      {"fragment-solve t at centroids", inside(FragmentForm::solve, t), 1, 1},
      {"fragment-gradient t at centroids", inside(FragmentForm::gradient, t), 1, 1},
      {"quadratic t", at_vertices("quadratic", t), 2, 2},
      {"quadratic n", at_vertices("quadratic", n), 2, 2},
      {"cubic t", at_vertices("cubic", t), 4, 3},
      {"cubic n", at_vertices("cubic", n), 4, 3},
  };
}

// The same with other orders in some rows.
std::vector<Row> rows_but(const std::vector<std::tuple<std::string, Order, Order>>& changes) {
  std::vector<Row> result = rows();
  for (const auto& [what, regular, jittered] : changes) {
    const auto row = std::find_if(result.begin(), result.end(), [&](const Row& r) { return r.what == what; });
    if (row == result.end()) throw std::logic_error(what);
    row->regular = regular, row->jittered = jittered;
  }
  return result;
}

// On a regular grid of a surface of revolution triangles before and behind a vertex are mirror images, so
// that averages of unit vectors are exact. Along a parallel t turns in a plane, and interpolating it errs by
// the third order; made perpendicular to an interpolated normal it loses that.
TEST(MeshOrders, Torus) {
  expect_orders("torus:major_radius=1,minor_radius=0.4", rows_but({{"vertex n, Max", exact, 1},
                                                                   {"vertex t, unit", exact, 1},
                                                                   {"vertex t, angle", exact, 1},
                                                                   {"vertex t, Max", exact, 1},
                                                                   {"interpolated t, raw", 3, 3}}));
}
TEST(MeshOrders, Sphere) {
  expect_orders("sphere", rows_but({{"vertex n, Max", exact, exact},  // as Max proves
                                    {"vertex t, unit", exact, 1},
                                    {"vertex t, angle", exact, 1},
                                    {"vertex t, Max", exact, 1},
                                    {"interpolated t, raw", 3, 3}}));
}
// Nothing cancels here but what opposite triangles do; the chart is not orthogonal.
TEST(MeshOrders, Ellipsoid) {
  std::vector<Row> expected = rows_but({{"fragment-gradient t at centroids", 0, 0}});
  // Its part of order 1 is small: it shows late.
  for (Row& row : expected)
    if (row.what == "vertex t, Max") row.finer = 4;
  expect_orders("ellipsoid", expected);
}
// t lies along the one direction that bends, n too: errors of every other order vanish.
TEST(MeshOrders, Cylinder) {
  std::vector<Row> expected = rows_but({{"interpolated n", 3, 3},
                                        {"interpolated n off centre", 3, 3},
                                        {"interpolated t", 3, 3},
                                        {"interpolated t, raw", 3, 3},
                                        {"face t on interpolated n", 3, 3},
                                        {"fragment-gradient t at centroids", 3, 3},
                                        {"quadratic t", exact, 3},
                                        {"quadratic n", exact, 3},
                                        {"cubic t", exact, 3},
                                        {"cubic n", exact, 3}});
  for (Row& row : expected) {
    if (row.what.starts_with("vertex")) row.regular = exact;
    if (row.what.starts_with("vertex t")) row.jittered = exact;
  }
  expect_orders("cylinder", expected);
}

}  // namespace
}  // namespace darboux::mesh_orders_test
