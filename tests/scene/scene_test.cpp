// Plans of scenes: nothing that is seen is missing, bounds hold between the samples, tiles leave no gaps, and
// every tile is counted once.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/bspline_patch.h>
#include <darboux/frame.h>
#include <darboux/scene.h>

#include "base/linear_algebra.h"
#include "every_surface.h"
#include "random.h"
#include "random_scene.h"
#include "refusal_of.h"

namespace darboux::test::scene_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Scene, EveryTileIsCountedOnce) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Scene scene = random_scene(random, 40);
    SceneRequest request;
    request.chord_px = random.log_uniform(3, 10);
    request.frame_angle_rad = random.log_uniform(0.05, 0.3);
    if (i % 4 == 0) request.attributes = Attribute::tangent;
    request.skip.occluded = i % 2 == 1;
    const ScenePlan plan = plan_scene(scene, random_camera(random), request);
    EXPECT_EQ(plan.tiles_needed + total(plan.skipped), plan.tiles_all);
    EXPECT_EQ(plan.tiles.size(), plan.patches.size() + plan.skipped.duplicates);
    std::uint64_t samples = 0, corners = 0;
    for_each_tile(scene, plan, [&](const TileSamples& tile) {
      samples += tile.size();
      corners += (tile.patch().cells_u + 1u) * (tile.patch().cells_v + 1u);
      for (const PlannedTile& t : tile.tiles())
        ASSERT_EQ(scene.instances[t.instance].surface, tile.patch().surface);
    });
    EXPECT_EQ(samples, plan.samples_needed);
    // Tiles repeat edges: 33·17/(32·16) = 1.096.
    EXPECT_LE(corners, 1.13 * plan.samples_full + 4 * scene.instances.size());
    if (i % 4 == 0) {
      EXPECT_GT(plan.skipped.no_normal_map, 0u);
    } else {
      EXPECT_EQ(plan.skipped.no_normal_map, 0u);
    }
  }
}

TEST(Scene, OfAnotherPlanIsRefused) {
  Random random(2);
  const Scene scene = random_scene(random, 30);
  const ScenePlan plan = plan_scene(scene, random_camera(random), {.skip = SceneRequest::Skip::nothing()});
  ASSERT_FALSE(plan.patches.empty());
  EXPECT_REFUSED(for_each_tile(Scene{}, plan, [](const TileSamples&) {}),
                 "scene: expected the scene and the plan that the patch is of, got a patch of surface");
  const ScenePlan empty;
  EXPECT_REFUSED(TileEvaluator(scene, empty).evaluate(plan.patches.front()), "where there are 0");
}

TEST(Scene, WithoutSkippingAllIsEvaluated) {
  Random random(2);
  const Scene scene = random_scene(random, 30);
  SceneRequest request;
  request.chord_px = 5;
  request.frame_angle_rad = 0.2;
  request.skip = SceneRequest::Skip::nothing();
  const ScenePlan plan = plan_scene(scene, random_camera(random), request);
  EXPECT_EQ(plan.tiles_needed, plan.tiles_all);
  EXPECT_EQ(total(plan.skipped), 0u);
  EXPECT_EQ(plan.instances_needed, scene.instances.size());
  EXPECT_EQ(plan.attribute_samples[static_cast<std::size_t>(Attribute::tangent4)], plan.samples_needed);
}

// Chords of splines have bounds, whether or not frames are asked for.
TEST(Scene, ChordsOfSplinesHaveBoundsByThemselves) {
  Random random(15);
  std::size_t tiles = 0;
  for (int degree = 2; degree <= 3; ++degree)
    for (int i = 0; i < 40; ++i) {
      std::vector<Vec3<double>> net;
      for (int k = 0; k < 36; ++k) net.push_back({k / 6 / 5.0, k % 6 / 5.0, random.uniform(0, 0.3)});
      const BSplinePatch<> spline(degree, degree, clamped_knots(degree, 6), clamped_knots(degree, 6), net);
      const Scene scene{{AnySurface(spline)}, {{}}, {{}}};
      Camera camera;
      camera.pose = Camera::look_at(to_eigen(random.log_uniform(3, 30) * random.direction()), {0.5, 0.5, 0});
      SceneRequest request;
      request.frame_angle_rad = std::numbers::pi;
      request.chord_px = random.log_uniform(0.1, 10);
      const ScenePlan plan = plan_scene(scene, camera, request);
      EXPECT_EQ(plan.tiles_unbounded, 0u) << "degree " << degree << ", chord " << request.chord_px;
      tiles += plan.tiles.size();
    }
  EXPECT_GT(tiles, 100u);
}

// The resolution of all tiles is what samples tell, half as much again, but of closed forms.
TEST(Scene, UniformResolutionsOfSplinesAreEstimates) {
  for (const double angle : {0.1, std::numbers::pi})
    for (const auto& [name, bounded] :
         {std::pair{"bezier-patch", false}, {"sphere", true}, {"torus", true}}) {
      const Scene scene{
          {make_surface(name)}, {{}}, {SceneInstance{0, 0, Eigen::Affine3d(Eigen::Translation3d(0, 0, -5))}}};
      SceneRequest request;
      request.frame_angle_rad = angle;
      request.chord_px = 2;
      request.skip = SceneRequest::Skip::nothing();
      const ScenePlan plan = plan_scene(scene, {}, request);
      EXPECT_EQ(plan.tiles_unbounded, bounded ? 0 : plan.tiles.size()) << name << ", angle " << angle;
    }
}

// Where in the chart, with the seams joined and poles one point.
using Key = std::pair<double, double>;
Key key_of(const SurfaceInfo& info, const Vec2<double>& uv, Status status) {
  double u = uv.x, v = uv.y;
  if (info.u == Coordinate::twisted_turn && u == 1) {
    u = 0;
    v = 1 - v;
  }
  if (info.u == Coordinate::turn && u == 1) u = 0;
  if ((info.v == Coordinate::turn || info.v == Coordinate::twisted_turn) && v == 1) v = 0;
  if (has(status, Status::dpdu_zero)) u = 0;
  return {u, v};
}

// Triangles of one instance, by the places of their corners.
struct Welded {
  std::map<Key, Vec3<double>> vertices;
  std::map<std::pair<Key, Key>, int> edges;
  std::size_t triangles = 0, gaps = 0;

  void add(const SurfaceInfo& info, const TileSamples& tile) {
    const auto key = [&](std::size_t i) { return key_of(info, tile.uv(i), tile.status(i)); };
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const Vec3<double> p = tile.vec3(Attribute::position, i);
      const auto [at, fresh] = vertices.emplace(key(i), p);
      if (norm(at->second - p) > 1e-14) ++gaps;
    }
    const auto triangles_of = tile.triangles();
    for (std::size_t i = 0; i < triangles_of.size(); i += 3) {
      const Key corners[3] = {key(triangles_of[i]), key(triangles_of[i + 1]), key(triangles_of[i + 2])};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      ++triangles;
      for (int k = 0; k < 3; ++k) ++edges[std::minmax(corners[k], corners[(k + 1) % 3])];
    }
  }
  long characteristic() const {
    return static_cast<long>(vertices.size()) - static_cast<long>(edges.size()) +
           static_cast<long>(triangles);
  }
};

// A camera next to a surface, so that tiles of many sizes meet.
ScenePlan plan_from_near(Random& random, const Scene& scene) {
  Camera camera;
  const Vec3<double> eye = random.uniform(1.5, 4) * random.direction();
  camera.pose = Camera::look_at(to_eigen(eye), {0, 0, 0}, to_eigen(random.direction()));
  camera.near_distance = 0.01;
  SceneRequest request;
  request.attributes = Attribute::position | Attribute::normal;
  request.frame_angle_rad = infinity;
  request.chord_px = random.log_uniform(0.3, 4);
  request.skip.outside_frustum = request.skip.back_facing = false;
  return plan_scene(scene, camera, request);
}

TEST(Scene, ClosedSurfacesAreWatertight) {
  Random random(3);
  const std::pair<AnySurface, long> closed[] = {{make_surface("sphere"), 2},
                                                {make_surface("torus"), 0},
                                                {make_surface("ellipsoid"), 2},
                                                {make_surface("klein-bottle:radius=1,tube_radius=0.3"), 0}};
  std::size_t stitched = 0;
  for (const auto& [surface, characteristic] : closed)
    for (int i = 0; i < 8; ++i) {
      const Scene scene{{surface}, {{}}, {{}}};
      const ScenePlan plan = plan_from_near(random, scene);
      Welded welded;
      for_each_tile(scene, plan, [&, &info = surface.info()](const TileSamples& tile) {
        welded.add(info, tile);
        stitched += !tile.patch().plain();
      });
      EXPECT_EQ(welded.gaps, 0u);
      EXPECT_EQ(welded.characteristic(), characteristic) << surface.info().name;
      for (const auto& [edge, count] : welded.edges) ASSERT_EQ(count, 2) << surface.info().name;
    }
  EXPECT_GT(stitched, 50u);
}

TEST(Scene, OpenSurfacesEndAtTheirBorderAlone) {
  Random random(4);
  for (const AnySurface& surface : all_surfaces()) {
    const SurfaceInfo& info = surface.info();
    const auto round = [](Coordinate c) { return c == Coordinate::turn || c == Coordinate::twisted_turn; };
    const Scene scene{{surface}, {{}}, {{}}};
    const ScenePlan plan = plan_from_near(random, scene);
    Welded welded;
    for_each_tile(scene, plan, [&](const TileSamples& tile) { welded.add(info, tile); });
    EXPECT_EQ(welded.gaps, 0u) << info.name;
    for (const auto& [edge, count] : welded.edges) {
      const auto& [a, b] = edge;
      const auto on_line = [](double x, double y) { return x == y && (x == 0 || x == 1); };
      const bool border =
          (!round(info.u) && on_line(a.first, b.first)) ||
          (!round(info.v) &&
           (on_line(a.second, b.second) || (info.u == Coordinate::twisted_turn && a.second + b.second == 1 &&
                                            on_line(a.second, std::round(a.second)))));
      if (border) {
        ASSERT_LE(count, 2) << info.name;
      } else {
        ASSERT_EQ(count, 2) << info.name << ' ' << a.first << ',' << a.second << ' ' << b.first << ','
                            << b.second;
      }
    }
  }
}

// Patches that are needed are the same, further samples on their edges too, whatever else is culled.
TEST(Scene, CullingDoesNotChangeWhatIsLeft) {
  Random random(7);
  using Identity =
      std::tuple<std::uint32_t, int, int, std::uint32_t, std::uint32_t, int, int, std::vector<double>>;
  const auto identities = [](const ScenePlan& plan) {
    std::set<Identity> result;
    for (const ScenePatch& p : plan.patches) {
      const auto first = plan.edge_coordinates.begin() + p.first_edge_coordinate;
      result.insert({p.surface, p.level_u, p.level_v, p.column, p.row, p.cells_u, p.cells_v,
                     std::vector<double>(first, first + p.edge_counts[0] + p.edge_counts[1] +
                                                    p.edge_counts[2] + p.edge_counts[3])});
    }
    return result;
  };
  std::size_t stitched = 0;
  for (int i = 0; i < 20; ++i) {
    const Scene scene = random_scene(random, 8);
    const Camera camera = random_camera(random);
    SceneRequest request;
    request.chord_px = 4;
    request.frame_angle_rad = 0.3;
    const ScenePlan culled = plan_scene(scene, camera, request);
    request.skip.outside_frustum = request.skip.back_facing = false;
    const std::set<Identity> all = identities(plan_scene(scene, camera, request));
    for (const Identity& patch : identities(culled)) {
      stitched += !std::get<7>(patch).empty();
      ASSERT_TRUE(all.contains(patch)) << scene.surfaces[std::get<0>(patch)].specification();
    }
  }
  EXPECT_GT(stitched, 20u);
}

TEST(Scene, NoVisibleSampleIsSkipped) {
  Random random(5);
  std::size_t visible = 0, seen = 0, all = 0;
  for (int round = 0; round < 40; ++round) {
    const Scene scene = random_scene(random, 20);
    const Camera camera = random_camera(random);
    SceneRequest request;
    request.chord_px = 8;
    request.frame_angle_rad = 0.5;
    const ScenePlan plan = plan_scene(scene, camera, request);
    std::vector<std::vector<Tile>> tiles(scene.instances.size());
    for (const PlannedTile& t : plan.tiles) tiles[t.instance].push_back(plan.patches[t.patch].tile());
    const Eigen::Vector3d eye = camera.pose.translation(), backward = camera.pose.linear().col(2);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const SceneInstance& instance = scene.instances[i];
      const SceneMaterial& material = scene.materials[instance.material];
      for (int k = 0; k < 200; ++k) {
        const double u = random.uniform(), v = random.uniform();
        const Sample<double> s = scene.surfaces[instance.surface].sample(u, v);
        if (has(s.frame.status, Status::no_frame)) continue;
        const Eigen::Vector3d p = instance.placement * to_eigen(s.jet.position),
                              n = (instance.placement.linear().inverse().transpose() * to_eigen(s.frame.n))
                                      .normalized();
        const Eigen::Vector3d to_eye =
            camera.projection == Camera::Projection::perspective ? Eigen::Vector3d(eye - p) : backward;
        const bool displaced = material.displacement > 0;
        const Eigen::Vector3d moved = p + random.uniform(-1, 1) * material.displacement * n;
        ++all;
        if (!is_in_view(camera, moved)) continue;
        if (!material.double_sided && !displaced && n.dot(to_eye) <= 0) continue;
        ++visible;
        const bool found = std::any_of(tiles[i].begin(), tiles[i].end(), [&](const Tile& t) {
          return u >= t.u0 && u <= t.u1 && v >= t.v0 && v <= t.v1;
        });
        seen += found;
        ASSERT_TRUE(found) << scene.surfaces[instance.surface].specification() << " at " << u << ' ' << v;
      }
    }
  }
  std::cout << visible << " visible of " << all << '\n';
  EXPECT_GT(visible, 5000u);
}

TEST(Scene, CamerasWithoutAFarPlaneAreMixed) {
  Camera endless;
  endless.far_distance = infinity;
  const Camera other;
  for (const auto& [from, to] : {std::pair(endless, other), std::pair(other, endless)}) {
    EXPECT_EQ(between(from, to, 0).far_distance, from.far_distance);
    EXPECT_EQ(between(from, to, 0.25).far_distance, infinity);
    EXPECT_EQ(between(from, to, 1).far_distance, to.far_distance);
  }
  EXPECT_EQ(between(endless, endless, 0.5).far_distance, infinity);
}

// Between the samples, over random points of random triangles.
TEST(Scene, BoundsHoldBetweenSamples) {
  Random random(6);
  double worst_px = 0, worst_angle = 0;
  for (int round = 0; round < 25; ++round) {
    const Scene scene = random_scene(random, 20);
    const Camera camera = random_camera(random);
    SceneRequest request;
    request.attributes = Attribute::position | Attribute::tangent | Attribute::bitangent | Attribute::normal;
    request.chord_px = round % 2 == 0 ? random.log_uniform(1, 10) : 1e4;
    request.frame_angle_rad = random.log_uniform(0.05, 0.3);
    request.skip.duplicates = false;
    request.skip.unread_attributes = false;
    const ScenePlan plan = plan_scene(scene, camera, request);
    const bool perspective = camera.projection == Camera::Projection::perspective;
    for_each_tile(scene, plan, [&](const TileSamples& tile) {
      const AnySurface& surface = scene.surfaces[tile.patch().surface];
      // Second partials without bound, between the samples of an estimate.
      if (surface.info().name == "superellipsoid") return;
      const Eigen::Affine3d& placement = scene.instances[tile.tiles()[0].instance].placement;
      const Eigen::Matrix3d by_normal = placement.linear().inverse().transpose();
      for (int k = 0; k < 5; ++k) {
        const std::size_t t = 3 * (random.bits() % (tile.triangles().size() / 3));
        const std::uint32_t* corner = tile.triangles().data() + t;
        double w[3] = {random.uniform(), random.uniform(), 0};
        if (w[0] + w[1] > 1) w[0] = 1 - w[0], w[1] = 1 - w[1];
        w[2] = 1 - w[0] - w[1];
        Vec2<double> uv{0, 0};
        Eigen::Vector3d p(0, 0, 0), tangent(0, 0, 0), normal(0, 0, 0);
        for (int c = 0; c < 3; ++c) {
          const Vec2<double> at = tile.uv(corner[c]);
          uv = {uv.x + w[c] * at.x, uv.y + w[c] * at.y};
          p += w[c] * (placement * to_eigen(tile.vec3(Attribute::position, corner[c])));
          tangent +=
              w[c] * (placement.linear() * to_eigen(tile.vec3(Attribute::tangent, corner[c]))).normalized();
          normal += w[c] * (by_normal * to_eigen(tile.vec3(Attribute::normal, corner[c]))).normalized();
        }
        const Sample<double> s = surface.sample(uv.x, uv.y);
        const Eigen::Vector3d truth = placement * to_eigen(s.jet.position);
        if (!is_in_view(camera, truth)) continue;
        const auto pixel = [&](const Eigen::Vector3d& x) {
          const Eigen::Vector3d q = camera.pose.inverse() * x;
          const double depth =
              perspective ? -q.z() * 2 * std::tan(camera.vertical_field_of_view_rad / 2) : camera.view_height;
          return Eigen::Vector2d(q.head<2>() * camera.height_px / depth);
        };
        const double px = (pixel(truth) - pixel(p)).norm() / request.chord_px;
        worst_px = std::max(worst_px, px);
        ASSERT_LE(px, 1 + 1e-9) << surface.specification() << " at " << uv.x << ' ' << uv.y;
        // Next to a pole the frame has no bound.
        if (!std::isfinite(TileBounds(surface, tile.patch().tile()).rates().frame_u)) continue;
        const Eigen::Vector3d t_truth = (placement.linear() * to_eigen(s.frame.t)).normalized(),
                              n_truth = (by_normal * to_eigen(s.frame.n)).normalized();
        for (const auto& [a, b] : {std::pair(tangent, t_truth), std::pair(normal, n_truth)}) {
          const double angle = std::atan2(a.cross(b).norm(), a.dot(b)) / request.frame_angle_rad;
          worst_angle = std::max(worst_angle, angle);
          ASSERT_LE(angle, 1 + 1e-9) << surface.specification() << " at " << uv.x << ' ' << uv.y;
        }
      }
    });
  }
  std::cout << "worst share of the bounds: " << worst_px << " of the chord, " << worst_angle
            << " of the angle\n";
  EXPECT_GT(worst_px, 0.1);
  EXPECT_GT(worst_angle, 0.1);
}

// Surfaces that bend far more than samples of a chart tell.
TEST(Scene, BoundsHoldOnUnusualSurfaces) {
  Random random(9);
  for (const char* name :
       {"helicoid:turns=64", "graph:width=0.01", "ellipsoid:semi_axis_x=1,semi_axis_y=0.9,semi_axis_z=0.01",
        "ellipsoid:semi_axis_x=1,semi_axis_y=0.05,semi_axis_z=0.05"}) {
    const AnySurface surface = make_surface(name);
    const Scene scene{{surface}, {{}}, {{}}};
    Camera camera;
    camera.pose = Camera::look_at({5, 0.3, 1}, {0, 0, 0});
    SceneRequest request;
    request.attributes = Attribute::position | Attribute::normal;
    request.chord_px = 1;
    request.frame_angle_rad = 0.3;
    std::size_t looked_at = 0;
    const ScenePlan plan = plan_scene(scene, camera, request);
    for_each_tile(scene, plan, [&](const TileSamples& tile) {
      for (int k = 0; k < 20; ++k) {
        const std::uint32_t* corner =
            tile.triangles().data() + 3 * (random.bits() % (tile.triangles().size() / 3));
        Vec2<double> uv{0, 0};
        Eigen::Vector3d p(0, 0, 0), normal(0, 0, 0);
        for (int c = 0; c < 3; ++c) {
          uv = {uv.x + tile.uv(corner[c]).x / 3, uv.y + tile.uv(corner[c]).y / 3};
          p += to_eigen(tile.vec3(Attribute::position, corner[c])) / 3;
          normal += to_eigen(tile.vec3(Attribute::normal, corner[c]));
        }
        const Sample<double> s = surface.sample(uv.x, uv.y);
        const double depth = -(camera.pose.inverse() * to_eigen(s.jet.position)).z();
        const double pixel = depth * 2 * std::tan(camera.vertical_field_of_view_rad / 2) / camera.height_px;
        ASSERT_LE((to_eigen(s.jet.position) - p).norm(), 1.01 * pixel) << name;
        if (!std::isfinite(TileBounds(surface, tile.patch().tile()).rates().normal_u)) continue;
        const Eigen::Vector3d n = to_eigen(s.frame.n);
        ASSERT_LE(std::atan2(normal.cross(n).norm(), normal.dot(n)), 0.3 * (1 + 1e-9)) << name;
        ++looked_at;
      }
    });
    EXPECT_GT(looked_at, 50u) << name;
  }
}

// Squares of some of these scales underflow or overflow.
TEST(Scene, VerySmallAndLargeInstancesAreCulledRightly) {
  for (const double scale : {1e-160, 1e-150, 1e-100, 1e100, 1e150}) {
    Scene scene{{make_surface("sphere")}, {{}}, {{}}};
    scene.instances[0].placement.linear() *= scale;
    scene.instances[0].placement.translation() = Eigen::Vector3d(0, 0, -3 * scale);
    Camera camera;
    camera.near_distance = scale;
    camera.far_distance = 5 * scale;
    const ScenePlan plan = plan_scene(scene, camera, {});
    EXPECT_EQ(plan.instances_needed, 1u) << scale;
    EXPECT_GT(plan.skipped.back_facing, 0u) << scale;
    EXPECT_EQ(plan.skipped.outside_frustum, 0u) << scale;
  }
}

// Placements that lose digits when they are inverted.
TEST(Scene, NeedlesAreCulledRightly) {
  Random random(10);
  for (const double thin : {1e-6, 1e-8, 1e-10}) {
    std::size_t visible = 0;
    for (int i = 0; i < 40; ++i) {
      Scene scene{{make_surface("sphere"), make_surface("torus")}, {{}}, {{}}};
      SceneInstance& instance = scene.instances[0];
      instance.surface = i % 2;
      const auto turn = [&] { return Eigen::AngleAxisd(random.uniform(0, 6), to_eigen(random.direction())); };
      instance.placement.linear() = turn() * Eigen::Vector3d(1, thin, thin).asDiagonal() * turn();
      Camera camera;
      camera.pose = Camera::look_at(to_eigen(3.0 * random.direction()), {0, 0, 0}, {0.1, 0.2, 1});
      SceneRequest request;
      request.attributes = Attribute::position;
      const ScenePlan plan = plan_scene(scene, camera, request);
      // The exact side, from the normal and the eye in the surface's own space.
      const SingularValues svd = singular_value_decomposition(instance.placement.linear());
      const Eigen::Vector3d eye =
          svd.v * (svd.u.transpose() * camera.pose.translation()).cwiseQuotient(svd.values);
      for (int k = 0; k < 100; ++k) {
        const double u = random.uniform(), v = random.uniform();
        const Sample<double> s = scene.surfaces[instance.surface].sample(u, v);
        const Eigen::Vector3d towards = eye - to_eigen(s.jet.position);
        if (to_eigen(s.frame.n).dot(towards) < 1e-3 * towards.norm()) continue;
        ++visible;
        const bool found = std::any_of(plan.tiles.begin(), plan.tiles.end(), [&](const PlannedTile& t) {
          const Tile tile = plan.patches[t.patch].tile();
          return u >= tile.u0 && u <= tile.u1 && v >= tile.v0 && v <= tile.v1;
        });
        ASSERT_TRUE(found) << thin;
      }
    }
    EXPECT_GT(visible, 1000u);
  }
}

// A chart is cut no finer than 2^14 cells along a side, and that is said.
TEST(Scene, WhatIsBeyondTheFinestIsCounted) {
  const Scene scene{{make_surface("sphere")},
                    {{}},
                    {SceneInstance{0, 0, Eigen::Affine3d(Eigen::Translation3d(0, 0, -1.001))}}};
  SceneRequest request;
  request.attributes = Attribute::position;
  Camera camera;
  camera.near_distance = 1e-6;
  camera.vertical_field_of_view_rad = 0.01;
  request.chord_px = 1e-5;
  const ScenePlan plan = plan_scene(scene, camera, request);
  EXPECT_GT(plan.tiles_unbounded, 0u);
  EXPECT_EQ(plan.tiles_unbounded, plan.tiles.size());
}

TEST(Scene, DuplicatesAreComputedOnce) {
  Scene scene{{make_surface("sphere")}, {{}}, {}};
  for (int i = 0; i < 10; ++i) {
    SceneInstance instance;
    instance.placement = Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitZ());
    instance.placement.pretranslate(Eigen::Vector3d(0, 0, -20));
    scene.instances.push_back(instance);
  }
  Camera camera;
  camera.near_distance = 1;
  const ScenePlan plan = plan_scene(scene, camera, {});
  EXPECT_GT(plan.skipped.duplicates, 3 * plan.tiles_needed);
  SceneRequest each;
  each.skip.duplicates = false;
  const ScenePlan apart = plan_scene(scene, camera, each);
  EXPECT_EQ(apart.tiles_needed, plan.tiles.size());
}

// Every surface of the catalogue, wholly beside and behind the view.
TEST(Scene, WhatIsOutsideIsSkippedWhateverItIs) {
  for (const AnySurface& surface : all_surfaces())
    for (const Eigen::Vector3d& at : {Eigen::Vector3d(300, 0, -100), Eigen::Vector3d(0, 0, 100)}) {
      const Scene scene{{surface}, {{}}, {SceneInstance{0, 0, Eigen::Affine3d(Eigen::Translation3d(at))}}};
      const ScenePlan plan = plan_scene(scene, {}, {});
      EXPECT_EQ(plan.skipped.outside_frustum, plan.tiles_all) << surface.info().name;
    }
}

TEST(Scene, OnlyWhatMaterialsReadIsEvaluated) {
  Scene scene{{make_surface("sphere")}, {{.name = "plain"}, {.name = "bumpy", .normal_map = true}}, {}};
  for (std::uint32_t i = 0; i < 2; ++i) {
    scene.instances.push_back({0, i, Eigen::Affine3d(Eigen::Translation3d(2.5 * i, 0, -20))});
  }
  const ScenePlan plan = plan_scene(scene, {}, {});
  const auto samples = [&](Attribute a) { return plan.attribute_samples[static_cast<std::size_t>(a)]; };
  EXPECT_EQ(samples(Attribute::position), plan.samples_needed);
  EXPECT_EQ(samples(Attribute::normal), plan.samples_needed);
  EXPECT_LT(samples(Attribute::tangent4), plan.samples_needed);
  EXPECT_GT(samples(Attribute::tangent4), 0u);
  for_each_tile(scene, plan, [&](const TileSamples& tile) {
    const bool bumpy = scene.instances[tile.tiles()[0].instance].material == 1;
    EXPECT_EQ(tile(Attribute::tangent4, 0).empty(), !bumpy);
  });
}

TEST(Scene, RefusesWhatMakesNoSense) {
  const Scene scene{{make_surface("sphere")}, {{}}, {{}}};
  const auto refusal = [&](auto change) {
    Scene s = scene;
    Camera camera;
    SceneRequest request;
    change(s, camera, request);
    return refusal_of([&] { plan_scene(s, camera, request); });
  };
  using S = Scene;
  using C = Camera;
  using R = SceneRequest;
  EXPECT_EQ(refusal([](S&, C& c, R&) { c.vertical_field_of_view_rad = 0; }),
            "field of view: expected more than 0 and less than 180 degrees, got 0.0 degrees");
  EXPECT_EQ(refusal([](S&, C& c, R&) { c.vertical_field_of_view_rad = std::numbers::pi; }),
            "field of view: expected more than 0 and less than 180 degrees, got 180.0 degrees");
  EXPECT_EQ(refusal([](S&, C& c, R&) { c.near_distance = 2000; }),
            "camera: expected near < far, got near 2000.0, far 1000.0");
  EXPECT_EQ(refusal([](S&, C& c, R&) { c.near_distance = 0; }), "camera: expected near > 0, got near 0.0");
  EXPECT_EQ(refusal([](S&, C& c, R&) { c.width_px = 0; }),
            "image size: expected at least 1 x 1 pixel, got 0 x 720");
  EXPECT_EQ(refusal([](S&, C& c, R&) { c.pose.linear() *= 2; }),
            "camera pose: expected a rotation and a translation, got another matrix");
  EXPECT_EQ(refusal([](S&, C&, R& r) { r.chord_px = 0; }), "chord_px: expected a bound > 0, got 0.000000");
  EXPECT_EQ(refusal([](S&, C&, R& r) { r.frame_angle_rad = -1; }),
            "frame_angle_rad: expected a bound > 0, got -1.000000");
  EXPECT_EQ(refusal([](S& s, C&, R&) { s.instances[0].placement.linear().setZero(); }),
            "instance 0: expected a placement that is finite and invertible, got a singular one");
  for (int k = 0; k < 3; ++k)  // whose square overflows
    EXPECT_EQ(refusal([k](S& s, C&, R&) { s.instances[0].placement.linear()(k, k) = 1e200; }),
              "instance 0: expected a placement that is finite and invertible, got a singular one");
  EXPECT_EQ(refusal([](S& s, C&, R&) { s.instances[0].placement.translation()[1] = NAN; }),
            "instance 0: expected a placement that is finite and invertible, got one that is not finite");
  EXPECT_EQ(refusal([](S& s, C&, R&) { s.instances[0].surface = 1; }),
            "instance 0: expected a surface below 1 and a material below 1, got 1 and 0");
  EXPECT_EQ(refusal_of([] {
              Camera::look_at({1, 1, 1}, {1, 1, 1});
            }),
            "camera target: expected a point other than the eye, got the eye");
  EXPECT_EQ(refusal_of([] {
              Camera::look_at({1, 1, 1}, {1, 1, 2});
            }),
            "camera up: expected a direction that is not along the view, got one along it");
}

// More tiles than a plan has at most are refused while it is made, whichever part asks for them: many tiles
// of one surface, or few each of many instances.
TEST(Scene, RefusesMoreTilesThanAPlanHas) {
  SceneRequest request;
  request.skip.outside_frustum = request.skip.back_facing = false;
  request.frame_angle_rad = std::numbers::pi;
  request.chord = 1e-5;
  Scene scene{{make_surface("sphere")}, {{}}, {{}}};
  const std::size_t tiles = plan_scene(scene, {}, request).tiles.size();
  ASSERT_GT(tiles, 1000u);
  constexpr std::size_t most = std::size_t{1} << 24;
  scene.instances.resize(most / tiles + 1);
  EXPECT_EQ(
      refusal_of([&] { plan_scene(scene, {}, request); }),
      "scene: expected bounds that at most 16777216 tiles keep, got smaller ones: ask for a larger chord "
      "or angle");
  // Of one surface.
  scene.instances.resize(1);
  request.chord = 1e-9;
  EXPECT_EQ(refusal_of([&] { plan_scene(scene, {}, request); }),
            "scene: expected bounds that at most 262144 tiles of a surface keep, got smaller ones: ask for a "
            "larger chord or angle");
}

}  // namespace
}  // namespace darboux::test::scene_test
