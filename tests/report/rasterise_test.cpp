#include "report/rasterise.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <darboux/error.h>

#include "io/read_png.h"

namespace darboux::test::rasterise_test {
namespace {

using Vertices = std::vector<PictureVertex>;
using Indices = std::vector<std::uint32_t>;

const PictureMaterial plain{.colour = {0.5, 0.5, 0.5}};
const PictureMaterial both_sides{.colour = {0.5, 0.5, 0.5}, .double_sided = true};

// In the origin, along -z. Its tangent of half the field of view is 1/2: pixels have round coordinates.
Camera camera_of(int width, int height) {
  Camera camera;
  camera.width_px = width;
  camera.height_px = height;
  camera.vertical_field_of_view_rad = 2 * std::atan(0.5);
  return camera;
}

Camera orthographic(int width, int height) {
  Camera camera = camera_of(width, height);
  camera.projection = Camera::Projection::orthographic;
  camera.view_height = height;  // a pixel is a unit
  return camera;
}

Vertices facing_us(std::initializer_list<Vec3<double>> positions) {
  Vertices result;
  for (const Vec3<double>& p : positions) result.push_back({p, {0, 0, 1}});
  return result;
}

// How often each pixel is covered.
std::vector<int> coverage(const Camera& camera, const Vertices& vertices, const Indices& indices) {
  std::vector<int> counts(static_cast<std::size_t>(camera.width_px * camera.height_px));
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    Rasteriser one(camera);
    one.add(vertices, std::span(indices).subspan(i, 3), both_sides);
    for (int y = 0; y < camera.height_px; ++y)
      for (int x = 0; x < camera.width_px; ++x)
        counts[static_cast<std::size_t>(y * camera.width_px + x)] += std::isfinite(one.depth(x, y));
  }
  return counts;
}

void expect_all_once(const std::vector<int>& counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) ASSERT_EQ(counts[i], 1) << "pixel " << i;
}

// A grid over the whole picture and more, its inner corners shaken.
struct Grid {
  Vertices vertices;
  Indices indices;
};
template <class Place>
Grid grid(int cells, Place&& place) {
  Grid g;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) g.vertices.push_back({place(i, j), {0, 0, 1}});
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (cells + 1) + i); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i)
      for (const std::uint32_t k :
           {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)})
        g.indices.push_back(k);
  return g;
}

TEST(Rasteriser, TrianglesThatShareEdgesCoverEachPixelOnce) {
  constexpr int size = 17, cells = 6;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shake(-0.4, 0.4);
  for (const Camera& camera : {orthographic(size, size), camera_of(size, size)}) {
    const bool perspective = camera.projection == Camera::Projection::perspective;
    for (int round = 0; round < 20; ++round) {
      const Grid g = grid(cells, [&](int i, int j) {
        const bool inner = i > 0 && j > 0 && i < cells && j < cells;
        double x = 4.0 * i - 12 + (inner ? shake(random) : 0), y = 4.0 * j - 12 + (inner ? shake(random) : 0);
        // Every other time vertices and edges pass through centres of pixels, which are whole numbers.
        if (round % 2 == 0) x = std::round(x), y = std::round(y);
        const double depth = perspective ? 20 + 3 * shake(random) : 20;
        const double unit = perspective ? depth / size : 1;
        return Vec3<double>{unit * x, unit * y, -depth};
      });
      expect_all_once(coverage(camera, g.vertices, g.indices));
    }
  }
}

// Corners so near to each other that rounded edge functions know no sign: of the fans round points beside a
// centre by the last bits exactly one triangle covers it.
TEST(Rasteriser, SignsAreExactWhereRoundingHasNone) {
  const Camera camera = camera_of(9, 9);
  std::mt19937 random(6);
  for (int round = 0; round < 300; ++round) {
    const auto bits = [&] { return static_cast<double>(static_cast<int>(random() % 17) - 8) * 0x1p-55; };
    Vertices v = facing_us({{bits(), bits(), -1.0 / 3}});
    Indices indices;
    constexpr std::uint32_t blades = 7;
    for (std::uint32_t k = 0; k < blades; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.1 * round) / blades;
      v.push_back({{30 * std::cos(angle), 30 * std::sin(angle), -7 - 0.3 * k}, {0, 0, 1}});
      for (const std::uint32_t i : {0u, 1 + k, 1 + (k + 1) % blades}) indices.push_back(i);
    }
    expect_all_once(coverage(camera, v, indices));
  }
}

// A floor that goes on behind the eye.
TEST(Rasteriser, AFloorThroughTheEyesPlaneIsDrawnFromNearToFar) {
  Camera camera = camera_of(40, 30);
  camera.near_distance = 1.5;
  camera.far_distance = 9;
  Rasteriser picture(camera);
  const Vec3<double> up{0, 1, 0};
  const Vec4<double> along_x{1, 0, 0, -1};
  // u = x / 8, v = z / 8.
  const auto vertex = [&](double x, double z) {
    return PictureVertex{{x, -0.6, z}, up, along_x, {x / 8, z / 8}};
  };
  const PictureMaterial bumps{.colour = {0.8, 0.4, 0.2}, .normal_map = bump};
  picture.add(Vertices{vertex(-1000, 1000), vertex(1000, 1000), vertex(0, -3000)}, Indices{0, 1, 2}, bumps);
  int drawn = 0;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const double sx = (x + 0.5 - 20) / 30, sy = -(y + 0.5 - 15) / 30;  // of the ray, per distance
      const double depth = -0.6 / sy;
      if (sy >= 0 || depth < 1.5 || depth > 9) {
        EXPECT_EQ(picture.depth(x, y), std::numeric_limits<double>::infinity()) << x << ' ' << y;
        continue;
      }
      ++drawn;
      // Edge functions of coordinates up to 3000 * 30 pixels lose 5 of 16 digits.
      EXPECT_NEAR(picture.depth(x, y), depth, 1e-10 * depth);
      // b = w n × t = -(0, 0, -1): the texel's y goes along +z.
      const Vec3<double> texel = bump({sx * depth / 8, -depth / 8});
      Vec3<double> light{-1, 2, 3};
      light = light / std::sqrt(14.0);
      const Vec3<double> n{texel.x, texel.z, texel.y};
      const double shade = 0.12 + 0.88 * std::fmax(0, dot(n, light));
      const std::uint8_t* rgb = picture.picture().rgb.data() + 3 * (y * 40 + x);
      EXPECT_NEAR(rgb[0], 255 * std::sqrt(0.8 * shade), 0.5 + 1e-6) << x << ' ' << y;
      EXPECT_NEAR(rgb[1], 255 * std::sqrt(0.4 * shade), 0.5 + 1e-6);
      EXPECT_NEAR(rgb[2], 255 * std::sqrt(0.2 * shade), 0.5 + 1e-6);
    }
  EXPECT_GT(drawn, 300);
}

TEST(Rasteriser, DepthsAreThoseOfTheRays) {
  const Camera camera = camera_of(64, 48);
  Rasteriser picture(camera);
  const Vec3<double> a{-3, -2, -4}, b{5, -1, -11}, c{0, 4, -7};
  picture.add(facing_us({a, b, c}), Indices{0, 1, 2}, both_sides);
  const Vec3<double> n = cross(b - a, c - a);
  int drawn = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      if (!std::isfinite(picture.depth(x, y))) continue;
      ++drawn;
      const Vec3<double> ray{(x + 0.5 - 32) / 48, -(y + 0.5 - 24) / 48, -1};
      // A few roundings of products of pixels, 1000 times smaller than the triangle's area.
      EXPECT_NEAR(picture.depth(x, y), dot(n, a) / dot(n, ray), 1e-13 * 11);
    }
  EXPECT_GT(drawn, 400);
}

TEST(Rasteriser, OfEqualDepthsTheLowerOrderWins) {
  const Camera camera = camera_of(8, 8);
  const Vertices v = facing_us({{-9, -9, -3}, {9, -9, -3}, {0, 20, -3}});
  const PictureMaterial red{.colour = {1, 0, 0}}, green{.colour = {0, 1, 0}};
  Rasteriser one(camera), other(camera);
  one.add(v, Indices{0, 1, 2}, red, 2);
  one.add(v, Indices{0, 1, 2}, green, 1);
  other.add(v, Indices{0, 1, 2}, green, 1);
  other.add(v, Indices{0, 1, 2}, red, 2);
  EXPECT_EQ(one.picture().rgb, other.picture().rgb);
  EXPECT_EQ(one.picture().rgb[0], 0);
}

TEST(Rasteriser, OfEqualDepthsTheFirstWins) {
  const Camera camera = camera_of(8, 8);
  const Vertices v = facing_us({{-9, -9, -3}, {9, -9, -3}, {0, 20, -3}});
  const PictureMaterial red{.colour = {1, 0, 0}}, green{.colour = {0, 1, 0}};
  Rasteriser picture(camera), only_red(camera);
  picture.add(v, Indices{0, 1, 2}, red);
  only_red.add(v, Indices{0, 1, 2}, red);
  picture.add(v, Indices{0, 1, 2}, green);
  EXPECT_EQ(picture.picture().rgb, only_red.picture().rgb);
  EXPECT_EQ(picture.picture().rgb[1], 0);
}

TEST(Rasteriser, WhatIsNotSeenChangesNothing) {
  const Camera camera = camera_of(64, 48);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-1, 1);
  const auto triangles = [&](int count, double size, double z) {
    Vertices v;
    for (int i = 0; i < 3 * count; ++i)
      v.push_back(
          {{size * at(random), size * at(random), z + at(random)}, {0.2 * at(random), 0.2 * at(random), 1}});
    return v;
  };
  const auto all = [](const Vertices& v) {
    Indices indices;
    for (std::uint32_t i = 0; i < v.size(); ++i) indices.push_back(i);
    return indices;
  };
  const Vertices seen = triangles(40, 4, -8), behind_wall = triangles(40, 9, -30), near = triangles(40, 4, 3),
                 far = triangles(40, 4, -1200);
  Vertices beside = triangles(40, 4, -8), away = triangles(40, 4, -4);
  for (PictureVertex& v : beside) v.position.x += 12;
  for (PictureVertex& v : away) v.normal = -v.normal;
  const Vertices wall = facing_us({{-99, -99, -20}, {99, -99, -20}, {0, 150, -20}});
  Rasteriser picture(camera), with_all(camera);
  picture.add(seen, all(seen), plain);
  picture.add(wall, all(wall), plain);
  for (const Vertices& v : {beside, near, far, away, seen, behind_wall, wall, away, behind_wall})
    with_all.add(v, all(v), plain);
  EXPECT_EQ(picture.picture().rgb, with_all.picture().rgb);
}

// n · (eye - P) = 0 in the middle of the picture: a contour within a triangle.
TEST(Rasteriser, AContourIsThatOfTheInterpolatedNormals) {
  const Camera camera = orthographic(8, 8);
  Vertices v = facing_us({{-90, -90, -3}, {90, -90, -3}, {0, 90, -3}});
  for (PictureVertex& p : v) p.normal = {1, 0, 0.01 + p.position.x};
  Rasteriser picture(camera);
  picture.add(v, Indices{0, 1, 2}, plain);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(std::isfinite(picture.depth(x, 4)), x >= 4) << x;
}

// By the normals: not by the order of the corners, nor by which way the triangle faces.
TEST(Rasteriser, FacingIsThatOfTheNormals) {
  const Camera camera = camera_of(8, 8);
  const auto drawn = [&](Vertices v, const PictureMaterial& material) {
    Rasteriser picture(camera);
    picture.add(v, Indices{0, 1, 2}, material);
    return std::isfinite(picture.depth(4, 4));
  };
  const Vertices v = facing_us({{-9, -9, -3}, {9, -9, -3}, {0, 20, -3}});
  Vertices turned = v, away = v, unknown = v;
  std::swap(turned[0], turned[1]);
  for (PictureVertex& p : away) p.normal = {0, 0, -1};
  for (PictureVertex& p : unknown) p.normal = {0, 0, 0};
  EXPECT_TRUE(drawn(v, plain));
  EXPECT_TRUE(drawn(turned, plain));
  EXPECT_FALSE(drawn(away, plain));
  EXPECT_TRUE(drawn(away, both_sides));
  EXPECT_TRUE(drawn(unknown, plain)) << "the triangle's own side";
  std::swap(unknown[0], unknown[1]);
  EXPECT_FALSE(drawn(unknown, plain));
  away[0].normal = {std::nan(""), 0, 0};
  EXPECT_FALSE(drawn(away, plain)) << "the other corners know";
}

TEST(Rasteriser, PicturesComeBackFromPng) {
  const Camera camera = camera_of(31, 17);
  Rasteriser picture(camera);
  picture.add(facing_us({{-3, -2, -4}, {5, -1, -11}, {0, 4, -7}}), Indices{0, 1, 2}, both_sides);
  const std::string bytes = png_of(picture.picture());
  EXPECT_TRUE(io::is_png(bytes));
  std::vector<std::uint8_t> read;
  io::read_png("memory", "the picture", bytes, [&](std::span<const std::uint16_t> row, int bits) {
    EXPECT_EQ(bits, 8);
    EXPECT_EQ(row.size(), 3u * 31);
    read.insert(read.end(), row.begin(), row.end());
    return true;
  });
  EXPECT_EQ(read, picture.picture().rgb);
}

TEST(Rasteriser, RefusesPicturesThatNoMemoryHolds) {
  EXPECT_THROW(Rasteriser(camera_of(100000, 100000)), ParameterError);
  EXPECT_THROW(Rasteriser(camera_of(0, 10)), ParameterError);
}

}  // namespace
}  // namespace darboux::test::rasterise_test
