// OBJ files: every corner as the text has it, objects apart, and what holds no triangles said.
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/io.h>

#include "io_files.h"

namespace darboux::obj_test {
namespace {

using test::TempFolder;
using test::write_bytes;

const std::string data = DARBOUX_TEST_DATA "/";

/// The corners of an OBJ whose faces are triangles with v/vt/vn, read by the C library's correctly rounded
/// strtof.
struct PlainObj {
  std::vector<std::array<float, 3>> v, vn;
  std::vector<std::array<float, 2>> vt;
  std::vector<std::array<std::size_t, 3>> corners;

  explicit PlainObj(const std::string& path) {
    std::ifstream stream(path);
    for (std::string line; std::getline(stream, line);) {
      std::istringstream words(line);
      std::string kind, a, b, c;
      words >> kind >> a >> b >> c;
      const auto f = [](const std::string& s) { return std::strtof(s.c_str(), nullptr); };
      if (kind == "v") v.push_back({f(a), f(b), f(c)});
      if (kind == "vn") vn.push_back({f(a), f(b), f(c)});
      if (kind == "vt") vt.push_back({f(a), f(b)});
      if (kind == "f")
        for (const std::string& corner : {a, b, c}) {
          std::array<std::size_t, 3> index{};
          EXPECT_EQ(std::sscanf(corner.c_str(), "%zu/%zu/%zu", &index[0], &index[1], &index[2]), 3) << corner;
          corners.push_back({index[0] - 1, index[1] - 1, index[2] - 1});
        }
    }
  }
};

TEST(ReadObj, EveryCornerIsTheTexts) {
  for (const char* name : {"torus_016.obj", "sphere_016.obj"}) {
    SCOPED_TRACE(name);
    const PlainObj plain(data + name);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const Asset asset = read_asset(data + name);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ASSERT_EQ(asset.primitives.size(), 1u);
    const Mesh& mesh = asset.primitives[0].data;
    ASSERT_EQ(mesh.corners(), plain.corners.size());
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    EXPECT_EQ(asset.primitives[0].texcoord, 0);
    ASSERT_EQ(asset.primitives[0].instances.size(), 1u);
    // assimp rounds the digits behind the point to float, then the sum with those before it, and with an
    // exponent their product with a power of ten: measured 1 unit in the last place, 2 are left for other
    // compilers' pow. place.
    int worst = 0;
    const auto compare = [&](double read, float exact) {
      const auto ordered = [](float x) {
        const auto i = std::bit_cast<std::int32_t>(x);
        return i < 0 ? INT32_MIN - i : i;
      };
      worst = std::max(worst, std::abs(ordered(static_cast<float>(read)) - ordered(exact)));
    };
    for (std::size_t i = 0; i < plain.corners.size(); ++i) {
      const std::uint32_t vertex = mesh.triangles[i / 3][i % 3];
      const auto [v, vt, vn] = plain.corners[i];
      compare(mesh.positions[vertex].x, plain.v[v][0]);
      compare(mesh.positions[vertex].y, plain.v[v][1]);
      compare(mesh.positions[vertex].z, plain.v[v][2]);
      compare(mesh.uvs[vertex].x, plain.vt[vt][0]);
      compare(mesh.uvs[vertex].y, plain.vt[vt][1]);
      compare(mesh.normals[vertex].x, plain.vn[vn][0]);
      compare(mesh.normals[vertex].y, plain.vn[vn][1]);
      compare(mesh.normals[vertex].z, plain.vn[vn][2]);
    }
    RecordProperty("worst_ulp", worst);
    EXPECT_LE(worst, 2);
  }
}

// The format promises no length, and tools write sums. Decimals stay as they are.
TEST(ReadObj, NormalsOfAnyLengthAreMadeUnit) {
  TempFolder folder;
  const std::string faces = "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1/1 2/2/2 3/3/3\n",
                    points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto normals_of = [&](const std::string& name, const std::string& text) {
    write_bytes(folder / name, text);
    return read_asset(folder / name).primitives.at(0).data.normals;
  };
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 6.25\n1 0 0 3 0 4\n0 1 0 0 0 0\n3 0 1 "
      "2\n";
  for (const auto& normals : {normals_of("long.obj", points + "vn 0 0 6.25\nvn 3 0 4\nvn 0 0 0\n" + faces),
                              normals_of("long.ply", ply)}) {
    ASSERT_EQ(normals.size(), 3u);
    EXPECT_EQ(normals[0], (Vec3<double>{0, 0, 1}));
    EXPECT_NEAR(normals[1].x, 0.6, 1e-15);
    EXPECT_NEAR(normals[1].z, 0.8, 1e-15);
    EXPECT_EQ(normals[2], (Vec3<double>{}));
  }
  const auto rounded =
      normals_of("short.obj", points + "vn 0.577 0.577 0.577\nvn 0 0.707 0.707\nvn 0 0 1\n" + faces);
  EXPECT_EQ(static_cast<float>(rounded[0].x), 0.577f);
  EXPECT_EQ(static_cast<float>(rounded[1].y), 0.707f);
  // Decimals that are no roundings of unit vectors; and a length that rounding to floats does not explain.
  const auto sums = normals_of("sums.obj", points + "vn 0 0 0.25\nvn 0.03 0 0.04\nvn 0 0 1.00035\n" + faces);
  EXPECT_NEAR(sums[1].x, 0.6, 1e-7);
  for (const Vec3<double>& n : sums) EXPECT_NEAR(norm(n), 1, 1e-7);
}

// As C's printf does not write them, but other programs do.
TEST(ReadObj, NumbersMayBeginWithAPoint) {
  const TempFolder folder;
  const std::string path = folder / "m.obj";
  test::write_bytes(path,
                    "v .5 -.25 +.125\nv\t1 .5 .75e1\nv 0 1 .0\n# .5\no .5\nvt .5 .25\nvn .0 .6 .8\n"
                    "f 1/1/1 2/1/1 3/1/1\n");
  const Asset asset = read_asset(path);
  ASSERT_EQ(asset.primitives.size(), 1u);
  const Mesh& mesh = asset.primitives[0].data;
  EXPECT_EQ(asset.primitives[0].name, ".5");
  const std::vector<Vec3<double>> positions{{.5, -.25, .125}, {1, .5, 7.5}, {0, 1, 0}};
  EXPECT_EQ(mesh.positions, positions);
  ASSERT_EQ(mesh.uvs.size(), 3u);
  EXPECT_EQ(mesh.uvs[0], (Vec2<double>{.5, .25}));
  ASSERT_EQ(mesh.normals.size(), 3u);
  EXPECT_EQ(mesh.normals[0].y, double{.6f});
}

// Of merged models: what has no normals has none of zeros either.
TEST(ReadObj, FacesWithoutNormalsBesideOthers) {
  const TempFolder folder;
  const std::string vertices = "o both\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n";
  const auto read = [&](const std::string& faces) {
    return read_asset(write_bytes(folder / "m.obj", vertices + faces));
  };
  const Asset asset = read("f 1//1 2//1 3//1\nf 1 3 4\n");
  ASSERT_EQ(asset.primitives.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(asset.primitives[i].mesh, 0u);
    EXPECT_EQ(asset.primitives[i].primitive, i);
    EXPECT_EQ(asset.primitives[i].name, "both");
    ASSERT_EQ(asset.primitives[i].data.triangles.size(), 1u);
  }
  const Mesh &with = asset.primitives[0].data, &without = asset.primitives[1].data;
  EXPECT_EQ(with.normals, (std::vector<Vec3<double>>(3, {0, 0, 1})));
  EXPECT_TRUE(without.normals.empty());
  EXPECT_EQ(without.positions[without.triangles[0][2]], (Vec3<double>{0, 1, 0}));
  // A stored normal of zeros is one.
  const Asset zero = read("vn 0 0 0\nf 1//2 2//1 3//1\n");
  ASSERT_EQ(zero.primitives.size(), 1u);
  EXPECT_EQ(zero.primitives[0].data.normals.size(), 3u);
}

TEST(ReadObj, PolygonsLinesAndSeveralObjects) {
  const TempFolder folder;
  const std::string path =
      test::write_bytes(folder / "many.OBJ",
                        "mtllib /dev/zero\n"
                        "o square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
                        "o triangle\nv 0 0 1\nv 1 0 1\nv 0 1 1\nvt 0.5 0.25\nf -3/1 -2/1 -1/1\n"
                        "o wire\nv 0 0 2\nv 1 0 2\nl 8 9\n");
  const Asset asset = read_asset(path);
  ASSERT_EQ(asset.primitives.size(), 2u);
  EXPECT_EQ(asset.primitives[0].name, "square");
  EXPECT_EQ(asset.primitives[0].data.triangles.size(), 2u);
  EXPECT_EQ(asset.primitives[0].texcoord, -1);
  EXPECT_TRUE(asset.primitives[0].data.normals.empty());
  EXPECT_EQ(asset.primitives[1].name, "triangle");
  ASSERT_EQ(asset.primitives[1].data.triangles.size(), 1u);
  EXPECT_EQ(asset.primitives[1].data.positions[asset.primitives[1].data.triangles[0][1]],
            (Vec3<double>{1, 0, 1}));
  EXPECT_EQ(asset.primitives[1].data.uvs.at(0), (Vec2<double>{0.5, 0.25}));
  ASSERT_EQ(asset.skipped.size(), 1u);
  EXPECT_EQ(asset.skipped[0].reason, "points and lines have no triangles");
}

}  // namespace
}  // namespace darboux::obj_test
