// The plan of docs/examples/asteroids.json against the surfaces themselves, at every pixel.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/ellipsoid.h>
#include <darboux/scene.h>
#include <darboux/sphere.h>

#include "io/scene_file.h"

namespace darboux::test::asteroids_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// What the triangles of a plan show at the centre of a pixel.
struct Pixel {
  double depth = infinity;
  std::uint32_t instance = 0;
  Vec2<double> uv{};
};

class Asteroids : public ::testing::Test {
 protected:
  Asteroids() {
    request_.skip.occluded = true;
    plan_ = plan_scene(scene_, camera_, request_);
    for_each_tile(scene_, plan_, [&](const TileSamples& samples) {
      for (const PlannedTile& tile : samples.tiles())
        for (std::size_t i = 0; i < samples.triangles().size(); i += 3)
          draw(samples, tile.instance, samples.triangles().subspan(i, 3));
    });
  }

  Eigen::Vector3d in_camera(const Eigen::Vector3d& p) const { return to_camera_ * p; }
  // In pixels from the left and from below; a length at depth 1 is so many.
  Eigen::Vector2d seen(const Eigen::Vector3d& q) const {
    return {0.5 * width_ - scale_ * q.x() / q.z(), 0.5 * height_ - scale_ * q.y() / q.z()};
  }
  Pixel& at(int x, int y) { return pixels_[static_cast<std::size_t>(y * width_ + x)]; }
  // Calls f(x, y) for the pixels whose centres may lie in a rectangle.
  template <class F>
  void for_pixels(const Eigen::AlignedBox2d& box, F f) {
    const auto range = [](double lo, double hi, int size) {
      return std::pair(std::max(0, static_cast<int>(std::floor(lo))),
                       std::min(size, static_cast<int>(std::ceil(hi)) + 1));
    };
    const auto [x0, x1] = range(box.min().x(), box.max().x(), width_);
    const auto [y0, y1] = range(box.min().y(), box.max().y(), height_);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) f(x, y);
  }

  void draw(const TileSamples& samples, std::uint32_t instance, std::span<const std::uint32_t> corners) {
    Eigen::Vector3d q[3];
    Eigen::Vector2d p[3];
    Eigen::AlignedBox2d box;
    for (int k = 0; k < 3; ++k) {
      q[k] = in_camera(scene_.instances[instance].placement *
                       to_eigen(samples.vec3(Attribute::position, corners[k])));
      if (!(-q[k].z() > camera_.near_distance)) return;
      box.extend(p[k] = seen(q[k]));
    }
    const auto twice_area = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
      return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    };
    const double area = twice_area(p[0], p[1], p[2]);
    if (area == 0) return;
    for_pixels(box, [&](int x, int y) {
      const Eigen::Vector2d centre(x + 0.5, y + 0.5);
      double w[3], sum = 0;
      for (int k = 0; k < 3; ++k) {
        w[k] = twice_area(centre, p[(k + 1) % 3], p[(k + 2) % 3]) / area;
        if (w[k] < 0) return;
        sum += w[k] /= -q[k].z();  // linear in space, not in the picture
      }
      Pixel& pixel = at(x, y);
      if (!(1 / sum < pixel.depth)) return;
      pixel = {1 / sum, instance, {}};
      for (int k = 0; k < 3; ++k) pixel.uv = pixel.uv + (w[k] / sum) * samples.uv(corners[k]);
    });
  }

  const io::SceneFile file_ = io::read_scene_file(DARBOUX_SOURCE "/docs/examples/asteroids.json");
  const Scene& scene_ = file_.scene;
  const Camera camera_ = file_.cameras[0].camera;
  SceneRequest request_ = file_.request;
  const int width_ = camera_.width_px, height_ = camera_.height_px;
  const double scale_ = height_ / 2.0 / std::tan(camera_.vertical_field_of_view_rad / 2);
  const Eigen::Isometry3d to_camera_ = camera_.pose.inverse();
  ScenePlan plan_;
  std::vector<Pixel> pixels_ = std::vector<Pixel>(static_cast<std::size_t>(width_ * height_));
};

// Where the triangles show a point of a surface, that point itself is seen within the bound.
TEST_F(Asteroids, ChordsAreWithinTheirBoundAtEveryPixel) {
  std::size_t covered = 0;
  double worst = 0;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Pixel& pixel = at(x, y);
      if (pixel.depth == infinity) continue;
      ++covered;
      const SceneInstance& instance = scene_.instances[pixel.instance];
      const Vec3<double> truth =
          scene_.surfaces[instance.surface].sample(pixel.uv.x, pixel.uv.y).jet.position;
      const Eigen::Vector2d there = seen(in_camera(instance.placement * to_eigen(truth)));
      const double off = (there - Eigen::Vector2d(x + 0.5, y + 0.5)).norm() / request_.chord_px;
      worst = std::max(worst, off);
      ASSERT_LE(off, 1 + 1e-9) << "pixel " << x << ' ' << y << ", instance " << pixel.instance;
    }
  std::cout << covered << " pixels, worst " << worst << " of the bound\n";
  EXPECT_GT(covered, 50000u);
  EXPECT_GT(worst, 0.1);
}

// Where a ray through a pixel meets a ball or an ellipsoid, not at a grazing angle, the triangles show that
// or something nearer: within a pixel of there, as chords are, and as deep as that, on a slope of at most 5.
TEST_F(Asteroids, NothingThatARayMeetsIsMissing) {
  std::size_t met = 0, missing = 0;
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const SceneInstance& instance = scene_.instances[i];
    const AnySurface& surface = scene_.surfaces[instance.surface];
    Eigen::Vector3d axes;
    if (const auto* sphere = surface.get<Sphere<>>())
      axes.setConstant(sphere->radius);
    else if (const auto* e = surface.get<Ellipsoid<>>())
      axes = {e->semi_axis_x, e->semi_axis_y, e->semi_axis_z};
    else
      continue;
    // From the camera's space to that in which it is a unit ball.
    const Eigen::Affine3d to_ball =
        (to_camera_ * instance.placement * Eigen::Affine3d(Eigen::Scaling(axes))).inverse();
    const Eigen::Vector3d eye = to_ball * Eigen::Vector3d::Zero();
    const Eigen::Vector3d middle = in_camera(instance.placement.translation());
    const double radius = (instance.placement.linear() * axes.asDiagonal()).norm();
    if (!(-middle.z() - radius > camera_.near_distance)) continue;
    Eigen::AlignedBox2d box;
    for (int k = 0; k < 8; ++k) {
      const auto corner =
          Eigen::AlignedBox3d(Eigen::Vector3d::Constant(-radius), Eigen::Vector3d::Constant(radius))
              .corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
      box.extend(seen(middle + corner));
    }
    for_pixels(box, [&](int x, int y) {
      const Eigen::Vector3d ray((x + 0.5 - 0.5 * width_) / scale_, (y + 0.5 - 0.5 * height_) / scale_, -1);
      const Eigen::Vector3d d = to_ball.linear() * ray;
      const double half = eye.dot(d), square = d.squaredNorm(),
                   under = half * half - square * (eye.squaredNorm() - 1);
      if (under <= 0) return;
      const double depth = (-half - std::sqrt(under)) / square;
      const Eigen::Vector3d normal = (to_ball.linear().transpose() * (eye + depth * d)).normalized();
      if (-normal.dot(ray.normalized()) < 0.2) return;
      if (x < 1 || y < 1 || x + 1 >= width_ || y + 1 >= height_) return;
      ++met;
      double shown = infinity;
      for (int b = y - 1; b <= y + 1; ++b)
        for (int a = x - 1; a <= x + 1; ++a) shown = std::min(shown, at(a, b).depth);
      // Of the 2 pixels between a neighbour and what it may show, each 1/scale_ of the depth.
      missing += !(shown <= depth * (1 + 5 * 3 / scale_));
    });
  }
  std::cout << met << " pixels\n";
  EXPECT_EQ(missing, 0u);
  EXPECT_GT(met, 30000u);
}

}  // namespace
}  // namespace darboux::test::asteroids_test
