// Files of points: every format gives the numbers that were written, to the bit, and bad files are refused in
// one line.
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "io_files.h"
#include "refusal_of.h"
#include "sanitized.h"
#include "torus_points.h"

namespace darboux::test::point_files_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();

bool same(double a, double b) {
  return std::isnan(a) ? std::isnan(b) : std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void expect_same(const PointCloud& a, const PointCloud& b) {
  const auto all = [](const auto& x, const auto& y, auto equal) {
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_TRUE(equal(x[i], y[i])) << i;
  };
  const auto same3 = [](const Vec3<double>& p, const Vec3<double>& q) {
    return same(p.x, q.x) && same(p.y, q.y) && same(p.z, q.z);
  };
  all(a.positions, b.positions, same3);
  all(a.normals, b.normals, same3);
  all(a.uvs, b.uvs,
      [](const Vec2<double>& p, const Vec2<double>& q) { return same(p.x, q.x) && same(p.y, q.y); });
}

// Doubles that float cannot hold, signs of zero, the ends of the range, and what is not finite.
const PointCloud difficult{{{0.1, 1000000.123456, -0.0}, {nan, -inf, 5e-324}, {1e308, 1.0 / 3, -7}},
                           {{0, 0, 1}, {0.6, 0, 0.8}, {nan, 0, 0}},
                           {{0.25, 1e-17}, {0.5, 1}, {-3, 0.7}}};

class PointFiles : public ::testing::Test {
 protected:
  PointFile read(const std::string& name, const std::string& bytes) const {
    return read_points(write_bytes(folder_ / name, bytes));
  }
  PointCloud distinct(const std::string& name, const std::string& bytes) const {
    return distinct_points(read(name, bytes));
  }
  // The file is refused in one line with these words.
  void refused(const std::string& name, const std::string& bytes,
               const std::vector<std::string>& words) const {
    const std::string path = write_bytes(folder_ / name, bytes);
    const std::string message = refusal_of<FileError>([&] { read_points(path); });
    EXPECT_EQ(message.rfind(path, 0), 0u) << message;
    EXPECT_NE(message.find("expected "), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << word << " in " << message;
  }
  const TempFolder folder_;
};

std::string text(double x) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.17g", x);
  return buffer;
}

// A row for each point, its parts in the order of `what`: p, n or t (uv).
std::string rows(const PointCloud& cloud, const std::string& what, const std::string& separator,
                 const std::string& end = "\n") {
  std::string result;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    std::string row;
    const auto add = [&](std::initializer_list<double> numbers) {
      for (const double x : numbers) row += (row.empty() ? "" : separator) + text(x);
    };
    const Vec3<double>& p = cloud.positions[i];
    for (const char c : what) {
      if (c == 'p') add({p.x, p.y, p.z});
      if (c == 'n') add({cloud.normals[i].x, cloud.normals[i].y, cloud.normals[i].z});
      if (c == 't') add({cloud.uvs[i].x, cloud.uvs[i].y});
    }
    result += row + end;
  }
  return result;
}

std::string reversed(std::string bytes) {
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

// The same as rows of bytes, in double; with an unsigned byte between position and normal.
std::string binary_rows(const PointCloud& cloud, bool big) {
  std::string result;
  const auto add = [&](double x) { result += big ? reversed(pack({x})) : pack({x}); };
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3<double>&p = cloud.positions[i], &n = cloud.normals[i];
    for (const double x : {p.x, p.y, p.z}) add(x);
    result += '\xC8';
    for (const double x : {n.x, n.y, n.z, cloud.uvs[i].x, cloud.uvs[i].y}) add(x);
  }
  return result;
}

std::string ply_header(const std::string& format, std::size_t vertices, const std::string& before = "",
                       const std::string& after = "") {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\n" + before + "element vertex " +
         std::to_string(vertices) +
         "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
         "property double nx\nproperty double ny\nproperty double nz\nproperty double s\nproperty double "
         "t\n" +
         after + "end_header\n";
}

std::string pcd_header(const std::string& data, std::size_t points) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z _ normal_x normal_y normal_z u v\nSIZE 8 8 8 1 8 8 8 8 8\n"
         "TYPE F F F U F F F F F\nCOUNT 1 1 1 1 1 1 1 1 1\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) +
         "\nDATA " + data + "\n";
}

// The numbers of all points, field by field, as compressed PCD files have them.
std::string by_fields(const PointCloud& cloud) {
  const std::string rows = binary_rows(cloud, false);
  constexpr std::size_t sizes[] = {8, 8, 8, 1, 8, 8, 8, 8, 8};
  const std::size_t row = rows.size() / cloud.positions.size();
  std::string result;
  for (std::size_t k = 0, at = 0; k < std::size(sizes); at += sizes[k++])
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) result += rows.substr(i * row + at, sizes[k]);
  return result;
}

// LZF that copies nothing: runs of up to 32 bytes behind a byte that counts them, less one. With both sizes
// before it.
std::string lzf_literals(const std::string& bytes) {
  std::string data;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string run = bytes.substr(at, 32);
    data += static_cast<char>(run.size() - 1);
    data += run;
  }
  std::string sizes;
  for (const std::size_t n : {data.size(), bytes.size()})
    for (int k = 0; k < 4; ++k) sizes += static_cast<char>(n >> (8 * k) & 255);
  return sizes + data;
}

// ---- what is read -----------------------------------------------------------------------------------------

TEST_F(PointFiles, TablesByCountOfColumns) {
  const PointCloud& d = difficult;
  for (const auto& [name, separator] : {std::pair{"a.xyz", " "},
                                        {"a.txt", "  \t"},
                                        {"a.csv", ","},
                                        {"a.CSV", " ; "},
                                        {"a.tsv", "\t"},
                                        {"a.asc", " "}}) {
    SCOPED_TRACE(name);
    expect_same(read(name, rows(d, "p", separator)).cloud, {d.positions, {}, {}});
    expect_same(read(name, rows(d, "pt", separator)).cloud, {d.positions, {}, d.uvs});
    expect_same(read(name, rows(d, "pn", separator)).cloud, {d.positions, d.normals, {}});
    expect_same(read(name, rows(d, "pnt", separator)).cloud, d);
  }
}

// As scanners write them: how many points follow, then x y z, an intensity and a colour.
TEST_F(PointFiles, PtsBeginsWithItsCount) {
  const std::string points = "1 2 3 -500 10 20 30\n4 5 6 -400 11 21 31\n";
  expect_same(read("a.pts", "2\r\n" + points).cloud, {{{1, 2, 3}, {4, 5, 6}}, {}, {}});
  expect_same(read("a.pts", points).cloud, {{{1, 2, 3}, {4, 5, 6}}, {}, {}});
  for (const std::string count : {"3", "1", "999999999999999999"})
    refused("a.pts", count + "\n" + points, {"expected " + count + " points, as its first line says, got 2"});
}

TEST_F(PointFiles, TablesByHeader) {
  expect_same(read("a.csv", "v,label,Z,\"Y\",x,U\n1e-17,a b,3,2,1,0.25\n0.5,,6,5,4,1\n").cloud,
              {{{1, 2, 3}, {4, 5, 6}}, {}, {{0.25, 1e-17}, {1, 0.5}}});
  // A normal that is not complete is none.
  expect_same(read("a.xyz", "x y z nx ny\n1 2 3 0 1\n").cloud, {{{1, 2, 3}}, {}, {}});
  // As `darboux eval --format csv` writes it.
  expect_same(read("a.csv",
                   "u,v,position_x,position_y,position_z,normal_x,normal_y,normal_z,status\n"
                   "0.5,0.25,1,2,3,0,0,1,regular\n")
                  .cloud,
              {{{1, 2, 3}}, {{0, 0, 1}}, {{0.5, 0.25}}});
}

// pandas writes its index without a name; quotes come from spreadsheets; CloudCompare has //X Y Z.
TEST_F(PointFiles, HeadersAndQuotesOfOtherTools) {
  const PointCloud two{{{1, 2, 3}, {4, 5, 6}}, {}, {}};
  expect_same(read("a.csv", ",x,y,z\n0,1,2,3\n1,4,5,6\n").cloud, two);
  expect_same(read("a.csv", "_id,x,y,z\n0,1,2,3\n1,4,5,6\n").cloud, two);
  expect_same(read("a.csv", "\"x\",\"y\",\"z\"\n\"1\",\"2\",\"3\"\n4,\" 5 \",6\n").cloud, two);
  expect_same(read("a.csv", "\"1\";\"2\";\"3\"\n4;5;6\n").cloud, two);
  for (const std::string header :
       {"//X Y Z\n", "//Y X Z\n", "# y x z\n", "# made by hand\n#Y,X,Z\n# in mm\n"})
    expect_same(read("a.xyz", header + (header == "//X Y Z\n" ? "1 2 3\n4 5 6\n" : "2 1 3\n5 4 6\n")).cloud,
                two);
  expect_same(read("a.txt", "//X Y Z R G B Nx Ny Nz\n1 2 3 255 0 7 0 0 1\n").cloud,
              {{{1, 2, 3}}, {{0, 0, 1}}, {}});
  for (const std::string header : {"# x y z [nx ny nz]\n", "# (x, y, z), (nx, ny, nz)\n"})
    expect_same(read("a.xyz", header + "1 2 3 0 0 1\n").cloud, {{{1, 2, 3}}, {{0, 0, 1}}, {}});
  // Units are no columns: these name three, of rows of six.
  for (const std::string header : {"# x[m] y[m] z[m]\n", "# x [m] y [m] z [m]\n"})
    expect_same(read("a.xyz", header + "1 2 3 0 0 1\n").cloud, {{{1, 2, 3}}, {{0, 0, 1}}, {}});
  for (const std::string header :
       {"# y [m] x [m] z [m]\n", "Y [mm] X [mm] Z [mm]\n", "[y] [x] [z]\n", "#Y(mm) X(mm) Z(mm)\n"})
    expect_same(read("a.xyz", header + "2 1 3\n5 4 6\n").cloud, two);
  expect_same(read("a.xyz", "x y z [r] [g] [b]\n1 2 3 255 0 7\n4 5 6 9 9 9\n").cloud, two);
  expect_same(read("a.csv", "x,y,z,x[px],y[px]\n1,2,3,4,5\n4,5,6,7,8\n").cloud, two);
  expect_same(read("a.csv", "Y [mm],X [mm],Z [mm]\n2,1,3\n5,4,6\n").cloud, two);
  expect_same(read("a.csv", "\"Y (mm)\";\"X (mm)\";\"Z (mm)\"\n2;1;3\n5;4;6\n").cloud, two);
  // A comment that happens to name columns, but not those of the rows.
  expect_same(read("a.xyz", "# the columns are x y z\n1 2 3\n4 5 6\n").cloud, two);
  expect_same(read("a.xyz", "# x y z x\n//\n1 2 3\n4 5 6\n").cloud, two);
  refused("a.xyz", "1 2 3\n//X Y Z\n", {"a.xyz:2: "});
  refused("a.csv", ",,\n1,2,3\n", {"a.csv:1: "});
}

// Colours are no normals, unless a header says so.
TEST_F(PointFiles, ColumnsWithoutAHeaderAreNormalsWhereTheyCanBe) {
  const PointFile colours = read("a.xyz", "# made by hand\n1 2 3 0 0 0\n4 5 6 255 128 0\n7 8 9 0 255 0\n");
  expect_same(colours.cloud, {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {}, {}});
  EXPECT_EQ(colours.note.rfind("line 3: columns 4 to 6", 0), 0u) << colours.note;
  expect_same(read("a.xyz", "1 2 3 9 9 9 0.5 0.25\n").cloud, {{{1, 2, 3}}, {}, {}});
  // Rounded, of no length, and not known.
  const PointFile normals = read("a.xyz", "1 2 3 0.57 0.57 0.57\n4 5 6 0 0 0\n7 8 9 nan nan nan\n");
  EXPECT_EQ(normals.cloud.normals.size(), 3u);
  EXPECT_EQ(normals.note, "");
  EXPECT_EQ(read("a.xyz", "x y z nx ny nz\n1 2 3 0 0 9\n").cloud.normals.size(), 1u);
}

// Scanners write intensities behind the positions; that row numbers stand before them is told by their
// values.
TEST_F(PointFiles, OtherColumnsWithoutAHeaderArePassedOver) {
  const PointCloud two{{{1, 2, 3}, {4, 5, 6}}, {}, {}};
  const PointFile four = read("a.xyz", "# x y z\n1 2 3 0.5\n4 5 6 word\n");
  expect_same(four.cloud, two);
  EXPECT_EQ(four.note, "line 2: of 4 columns without a header those after the third are passed over");
  expect_same(read("a.csv", "1,2,3,\n4,5,6,\n").cloud, two);
  expect_same(read("a.txt", "1 2 3 77 255 128 0\n4 5 6 78 255 0 0\n").cloud, two);
  expect_same(read("a.txt", "1 2 3 4 5 6 7 8 9\n4 5 6 4 5 6 7 8 9\n").cloud, two);
  EXPECT_EQ(read("a.xyz", "1 7 8 9\n2 8 9 7\n4 9 8 7\n").cloud.positions.size(), 3u);
  for (const std::string rows : {"1 7 8 9\n2 8 9 7\n3 9 8 7\n", "0 7 8 9\n1 8 9 7\n2 9 8 7\n3 9 9 9\n"})
    refused("a.xyz", rows, {"3 numbers x y z", "row numbers in the first of 4 columns"});
}

TEST_F(PointFiles, CommentsEmptyLinesLineEndsAndByteOrderMark) {
  const PointCloud two{{{1, 2, 3}, {4, 5, 6}}, {}, {}};
  expect_same(read("a.xyz", "\xEF\xBB\xBF# made by hand\r\n\r\n1 2 3\r\n  # more\r\n \t\r\n+4 5e0 6.").cloud,
              two);
  expect_same(read("a.csv", "\xEF\xBB\xBFx;y;z\r\n1;2;3\r\n4;5;6").cloud, two);
}

TEST_F(PointFiles, TheFirstPointThatIsNotFiniteIsNamed) {
  EXPECT_EQ(read("a.xyz", "# c\n1 2 3\n\n1 NaN 3\n1 2 inf\n").first_not_finite, "line 4");
  EXPECT_EQ(read("a.xyz", "1 2 3\n").first_not_finite, "");
  EXPECT_EQ(
      read("a.ply", ply_header("binary_little_endian", 3) + binary_rows(difficult, false)).first_not_finite,
      "vertex 1");
}

TEST_F(PointFiles, Ply) {
  for (const bool big : {false, true})
    expect_same(read("a.ply", ply_header(big ? "binary_big_endian" : "binary_little_endian", 3) +
                                  binary_rows(difficult, big))
                    .cloud,
                difficult);
  // Elements and lists before the vertices, of no length too; faces after them.
  const std::string before = "element odd 2\nproperty list uchar short a\nproperty int b\nelement none 7\n";
  const std::string after = "element face 1\nproperty list uchar int vertex_indices\n";
  expect_same(read("a.ply", ply_header("ascii", 1, before, after) +
                                "3 1 2 3 4\n0 9\n0.1 2 3 200 0 0 1 0.5 0.25\n3 0 0 0\n")
                  .cloud,
              {{{0.1, 2, 3}}, {{0, 0, 1}}, {{0.5, 0.25}}});
  expect_same(read("a.ply", ply_header("binary_little_endian", 3, before, after) + std::string("\x03", 1) +
                                std::string(6 + 4, '\1') + std::string(1 + 4, '\0') +
                                binary_rows(difficult, false) + "faces are not read")
                  .cloud,
              difficult);
  // Every type, in both byte orders.
  const std::string types =
      "element vertex 1\nproperty char x\nproperty uint16 y\nproperty float z\nproperty uint8 a\nproperty "
      "short nx\n"
      "property int ny\nproperty uint nz\nend_header\n";
  const std::string parts[] = {
      pack<std::int8_t>({-5}),           pack<std::uint16_t>({65535}), pack<float>({0.1f}),
      pack<std::uint8_t>({7}),           pack<std::int16_t>({-300}),   pack<std::int32_t>({-70000}),
      pack<std::uint32_t>({4000000000u})};
  std::string little, big;
  for (const std::string& part : parts) {
    little += part;
    big += reversed(part);
  }
  const PointCloud expected{{{-5, 65535, 0.1f}}, {{-300, -70000, 4e9}}, {}};
  expect_same(read("a.ply", "ply\r\nformat binary_little_endian 1.0\r\n" + types + little).cloud, expected);
  expect_same(read("a.ply", "ply\nformat binary_big_endian 1.0\n" + types + big).cloud, expected);
}

TEST_F(PointFiles, Pcd) {
  expect_same(read("a.pcd", pcd_header("binary", 3) + binary_rows(difficult, false)).cloud, difficult);
  expect_same(read("a.pcd", pcd_header("binary_compressed", 3) + lzf_literals(by_fields(difficult))).cloud,
              difficult);
  expect_same(read("a.pcd",
                   "VERSION .7\nFIELDS x y z fpfh\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 2\nWIDTH 1\n"
                   "HEIGHT 2\nDATA ascii\n0.1 2 3 9 9\nnan nan nan 9 9\n")
                  .cloud,
              {{{0.1, 2, 3}, {nan, nan, nan}}, {}, {}});
  // 2^53 + 2 and its like are exact in double.
  expect_same(read("a.pcd", "FIELDS x y z\nSIZE 8 8 1\nTYPE I U I\nWIDTH 1\nHEIGHT 1\nDATA binary\n" +
                                pack<std::int64_t>({-9007199254740994}) + pack<std::uint64_t>({1ULL << 63}) +
                                pack<std::int8_t>({-7}))
                  .cloud,
              {{{-9007199254740994, 0x1p63, -7}}, {}, {}});
}

TEST_F(PointFiles, Obj) {
  // Without faces every vertex is a point, however often it is there.
  expect_same(read("a.obj", "# c\no cloud\nv 0.1 1000000.123456 3\nv 1 2 3 0.5 0.5 0.5\nv 1 2 3\n").cloud,
              {{{0.1, 1000000.123456, 3}, {1, 2, 3}, {1, 2, 3}}, {}, {}});
  expect_same(read("a.obj", "v 1 2 3\nvn 0 0 1\nv 4 5 6\nvn 1 0 0\n").cloud,
              {{{1, 2, 3}, {4, 5, 6}}, {{0, 0, 1}, {1, 0, 0}}, {}});
  // With faces: those they use, one at a place, with the attributes of their first corner.
  const std::string vertices =
      "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n";
  const PointCloud three{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {{0, 0}, {1, 0}, {0, 1}}};
  expect_same(distinct("a.obj", vertices + "f 2/1/1 3/2/1 4/3/1\nf 4/3/1 -1/1/1 -4/3/1\n"), three);
  expect_same(distinct("a.obj", vertices + "f 2//1 3//1 4//1\n"), {three.positions, three.normals, {}});
  expect_same(distinct("a.obj", vertices + "f 2/1 3/2 4/3 5\n"), {three.positions, {}, {}});
  // All its vertices are there, in its order, also one after the faces.
  const PointFile all = read("a.obj", vertices + "f 2/1/1 3/2/1 4/3/1\nf 4/3/1 -1/1/1 -4/3/1\nv 7 7 7\n");
  expect_same({all.cloud.positions, {}, {}},
              {{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {7, 7, 7}}, {}, {}});
  constexpr std::uint32_t unused = PointFile::unused;
  EXPECT_EQ(all.place, (std::vector<std::uint32_t>{unused, 1, 2, 3, 2, unused}));
  EXPECT_TRUE(std::isnan(all.cloud.uvs[0].x) && std::isnan(all.cloud.normals[5].z));
  EXPECT_EQ(all.cloud.uvs[4], (Vec2<double>{0, 0}));
  EXPECT_TRUE(read("a.obj", vertices).place.empty());
}

std::string binary_stl(std::uint32_t count, std::initializer_list<float> corners) {
  std::string bytes = "solid by name only" + std::string(62, ' ') + pack({count});
  for (std::size_t i = 0; i + 9 <= corners.size(); i += 9)
    bytes += std::string(12, '\0') + pack(corners).substr(4 * i, 36) + std::string(2, '\0');
  return bytes;
}

TEST_F(PointFiles, Stl) {
  const PointCloud four{{{0, 0, 0}, {1, 0, 0}, {0, 0.1f, 0}, {1, 1, 0}}, {}, {}};
  const PointFile corners =
      read("a.stl", binary_stl(2, {0, 0, 0, 1, 0, 0, 0, 0.1f, 0, 1, -0.0f, 0, 1, 1, 0, 0, 0.1f, 0}));
  expect_same(distinct_points(corners), four);
  EXPECT_EQ(corners.place, (std::vector<std::uint32_t>{0, 1, 2, 1, 4, 2}));
  const auto facet = [](const std::string& a, const std::string& b, const std::string& c) {
    return "facet normal 0 0 1\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
           "\n endloop\nendfacet\n";
  };
  expect_same(distinct("a.stl", "solid a name\n" + facet("0 0 0", "1 0 0", "0 0.1 0") +
                                    facet("1 0 0", "1 1 0", "0 0.1 0") + "endsolid a name\n"),
              {{{0, 0, 0}, {1, 0, 0}, {0, 0.1, 0}, {1, 1, 0}}, {}, {}});
}

TEST_F(PointFiles, Gltf) {
  // Two primitives share three of their four places; a vertex that no triangle uses was not measured.
  Builder b;
  const std::size_t first = b.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 9, 9, 9}),
                    second = b.positions({1, 0, 0, 1, 1, 0, 0, 1, 0});
  const std::size_t uvs = b.packed<float>("VEC2", 5126, 3, {0.5f, 0, 1, 0, 1, 1});
  b.primitive({{"POSITION", first}}, {{"indices", b.packed<std::uint16_t>("SCALAR", 5123, 3, {0, 1, 2})}});
  b.primitive({{"POSITION", second}, {"TEXCOORD_0", uvs}});
  const PointFile two = read("a.glb", b.glb());
  expect_same(distinct_points(two), {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {}, {}});
  EXPECT_EQ(two.place, (std::vector<std::uint32_t>{0, 1, 2, PointFile::unused, 1, 5, 2}));
  EXPECT_EQ(two.cloud.positions[3], (Vec3<double>{9, 9, 9}));
  // A grid of 32 x 16 segments has 33 x 17 vertices. Those of the seams differ by rounding and are one.
  const PointFile torus = read_points(DARBOUX_TEST_DATA "/torus_016.none.glb");
  const PointCloud places = distinct_points(torus);
  EXPECT_EQ(places.uvs.size(), places.positions.size());
  EXPECT_EQ(places.normals.size(), places.positions.size());
  const Asset asset = read_asset(DARBOUX_TEST_DATA "/torus_016.none.glb");
  const Mesh& from = asset.primitives.at(0).data;
  EXPECT_EQ(from.positions.size(), 33u * 17u);
  EXPECT_EQ(torus.cloud.positions, from.positions);
  EXPECT_EQ(places.positions.size(), 32u * 16u);
  Builder points = b;
  points.json["meshes"][0]["primitives"] = Json::array();
  points.primitive({{"POSITION", first}}, {{"mode", 0}});
  refused("p.glb", points.glb(), {"mode 0"});
}

// The meshes of the same torus: the OBJ's decimal numbers stand for the GLB's floats.
TEST_F(PointFiles, ObjAndGlbOfOneMeshAgree) {
  const PointCloud obj = distinct_points(read_points(DARBOUX_TEST_DATA "/torus_016.obj")),
                   glb = distinct_points(read_points(DARBOUX_TEST_DATA "/torus_016.none.glb"));
  std::size_t near = 0;
  for (const Vec3<double>& p : obj.positions)
    for (const Vec3<double>& q : glb.positions) {
      const Vec3<double> d = p - q;
      near += dot(d, d) < 1e-12;
    }
  EXPECT_EQ(near, obj.positions.size());
  EXPECT_EQ(obj.uvs.size(), obj.positions.size());
}

TEST_F(PointFiles, TheCommittedTorusIsThatOfItsSeed) {
  const PointCloud cloud = read_points(DARBOUX_TEST_DATA "/torus_points.xyz").cloud;
  const auto made = torus_points();
  ASSERT_EQ(cloud.positions.size(), made.size());
  // 6 decimals were written; 1e-9 for another libm.
  for (std::size_t i = 0; i < made.size(); ++i) {
    const Vec3<double> d = cloud.positions[i] - made[i];
    EXPECT_LT(std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)}), 0.5e-6 + 1e-9) << i;
  }
}

// ---- what is refused --------------------------------------------------------------------------------------

TEST_F(PointFiles, RefusesWhatIsNoTableOfNumbers) {
  const std::string good = "1 2 3\n";
  for (const std::string bad : {"1 2 x", "1 2 0x1p3", "1 2 1,5", "1 2 1e", "1 2 --1", "1 2 +-1", "1 2 1_000",
                                "1 2 1e400", "1 2 -1e999", "1 2 3f"})
    refused("a.xyz", good + bad + "\n", {"a.xyz:2: "});
  refused("a.xyz", good + "1 2 1e400\n", {"1e400", "the range of double"});
  refused("a.xyz", good + std::string("1 2 \0", 5) + "3\n", {"a.xyz:2: "});
  for (const std::string bad : {"1 2", "1 2 3 4", "1", "1 2 3 4 5 6 7 8 9"})
    refused("a.xyz", good + bad + "\n", {"a.xyz:2: ", "columns", "3 numbers x y z"});
  refused("a.xyz", "\n1 2\n", {"a.xyz:2: "});
  refused("a.xyz", "\n1\n", {"expected at least one point"});  // a count, and no points
  refused("a.xyz", "1\n2\n3\n", {"a.xyz:2: ", "columns", "3 numbers x y z"});
  refused("a.csv", "1,5;2,5;3,5\n",
          {"a.csv:1: ", "\"1,5\", which is two numbers, or one with a decimal comma; write decimal points"});
  refused("a.xyz", "1,5 2,5 3,5\n", {"a.xyz:1: ", "\"5 2\", which is two numbers"});
  refused("a.csv", "x,y,w\n1,2,3\n", {"a.csv:1: ", "the columns x y z", "got 'x', 'y', 'w'"});
  refused("a.csv", "x,y,z,X\n1,2,3,4\n", {"twice"});
  refused("a.csv", "x,y,z\n1,2\n", {"a.csv:2: ", "2 columns"});
  refused("a.csv", "x,y,z\n", {"expected at least one point, got none"});
  for (const std::string nothing : {"", "\n\n", "# only\n# comments", "\xEF\xBB\xBF"})
    refused("a.xyz", nothing, {"expected at least one point, got none"});
  refused("a.xyz", std::string("\xFF\xFE\x31\0\x20\0", 6), {"UTF-16"});
  refused("a.csv", std::string("\xFE\xFF\0\x31\0\x20", 6), {"UTF-16"});
  refused("a.xyz", "1 2 3\r4 5 6\r", {"a.xyz:1: ", "carriage return"});
  refused("a.xyz", std::string(70000, '1'), {"a.xyz:1: ", "65536"});
  refused("a.xyz", std::string(1 << 20, '\0'), {"a.xyz:1: ", "65536"});
}

TEST_F(PointFiles, RefusesWhatIsNoRegularFileOfAKnownKind) {
  for (const char* name : {"a", "a.e57", "a.las", "a.xyz.gz"})
    refused(name, "1 2 3\n", {"extension", ".xyz", ".pcd"});
  std::filesystem::create_directory(folder_ / "d.xyz");
  EXPECT_NE(refusal_of<FileError>([&] { read_points(folder_ / "d.xyz"); }).find("folder"), std::string::npos);
  EXPECT_NE(
      refusal_of<FileError>([&] { read_points(folder_ / "missing.ply"); }).find("expected a readable file"),
      std::string::npos);
  ASSERT_EQ(::mkfifo((folder_ / "pipe.xyz").c_str(), 0600), 0);
  EXPECT_NE(refusal_of<FileError>([&] { read_points(folder_ / "pipe.xyz"); }).find("pipe"),
            std::string::npos);
}

TEST_F(PointFiles, RefusesBrokenPly) {
  const std::string le = "binary_little_endian";
  refused("a.ply", "", {"expected a PLY file, which begins with ply"});
  refused("a.ply", "plyx\n", {"expected a PLY file, which begins with ply"});
  refused("a.ply", "ply\nformat ascii 1.0\n", {"within its header"});
  refused("a.ply", "ply\nformat utf8 1.0\nend_header\n", {":2: ", "utf8"});
  refused("a.ply", "ply\nelement vertex 1\nend_header\n", {"one without a format in its header"});
  refused("a.ply", "ply\nformat ascii 1.0\nend_header\n", {"vertex"});
  refused("a.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n", {":3: "});
  refused("a.ply", "ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", {":3: ", "-1"});
  refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n1\n",
          {":4: ", "half"});
  refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
          {"columns x y z", "got 'x'"});
  refused("a.ply", ply_header("ascii", 0), {"expected at least one point, got none"});
  // Headers that lie about counts, upwards without an allocation to match.
  refused("a.ply", ply_header("ascii", 2) + "1 2 3 4 5 6 7 8 9\n",
          {"expected the 2 rows of vertex that its header announces, got an end at vertex 1", "the 2 rows"});
  refused("a.ply", ply_header("ascii", 1) + "1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9\n",
          {"got more after them", "the 1 rows"});
  refused("a.ply", ply_header("ascii", 1) + "1 2 3\n", {"too few"});
  refused("a.ply", ply_header("ascii", 1) + "1 2 3 4 5 6 7 8 9 10\n", {"too many"});
  refused("a.ply", ply_header("ascii", 1) + "1 2 3 4 5 6 7 8 x\n", {"\"x\""});
  refused("a.ply", ply_header(le, 18446744073709551615u) + binary_rows(difficult, false),
          {"got an end at vertex 3"});
  refused("a.ply", ply_header(le, 2) + binary_rows(difficult, false), {"got more after them"});
  refused("a.ply", ply_header(le, 3, "element odd 1\nproperty list char int a\n") + "\xFF",
          {"a list whose length is a whole number from 0 to 2^53, got -1"});
  // Lengths that are no whole numbers, or too large to count in double.
  for (const std::string type : {"float", "double"})
    refused("a.ply", ply_header("ascii", 1, "element odd 1\nproperty list " + type + " int a\n") + "inf\n",
            {":5: ", "\"" + type + "\""});
  for (const std::string length : {"inf", "nan", "1e30", "1.5"})
    refused("a.ply", ply_header("ascii", 1, "element odd 1\nproperty list uint int a\n") + length + "\n",
            {"odd 0: expected a list whose length is a whole number"});
  refused("a.ply", ply_header(le, 3, "element odd 1\nproperty list uint int a\n") + "\xFF\xFF\xFF\xFF",
          {"got an end at odd 0"});
}

TEST_F(PointFiles, RefusesBrokenPcd) {
  refused("a.pcd", "", {"within its header"});
  const std::string packed = pcd_header("binary_compressed", 3);
  refused("a.pcd", packed, {"ends within its compressed data"});
  refused("a.pcd", packed + lzf_literals(std::string(7, 'x')), {"expected 195 bytes of points, got 7"});
  std::string cut = packed + lzf_literals(by_fields(difficult));
  refused("a.pcd", cut.substr(0, cut.size() - 1), {"ends within its compressed data"});
  cut[packed.size() + 8] = '\xFF';  // a copy of bytes that are not there
  refused("a.pcd", cut, {"expected data compressed with LZF"});
  // A size that nothing could unfold to is refused before it is allocated.
  refused("a.pcd",
          pcd_header("binary_compressed", 60000000) + std::string("\x04\0\0\0\0\x47\x75\xE8", 8) + "xxxx",
          {"compressed bytes"});
  refused("a.pcd", pcd_header("zip", 3), {"zip"});
  refused("a.pcd", pcd_header("binary", 4) + binary_rows(difficult, false), {"got an end at point 3"});
  refused("a.pcd", pcd_header("binary", 2) + binary_rows(difficult, false), {"got more after them"});
  refused("a.pcd", "FIELDS x y z\nSIZE 4 4\nTYPE F F F\nDATA ascii\n", {"entries"});
  refused("a.pcd", "FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nDATA ascii\n", {"SIZE 3"});
  refused("a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 99999999999\nDATA ascii\n", {"COUNT"});
  refused("a.pcd", "NOISE 1\n", {":1: ", "NOISE"});
  const std::string xyz = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n", rows = "DATA ascii\n1 2 3\n4 5 6\n";
  refused("a.pcd", xyz + "WIDTH 7\nHEIGHT 9\nPOINTS 2\n" + rows, {"WIDTH 7", "HEIGHT 9", "POINTS 2"});
  refused("a.pcd", xyz + rows, {"WIDTH"});
  EXPECT_EQ(read("a.pcd", xyz + "POINTS 2\n" + rows).cloud.positions.size(), 2u);
}

TEST_F(PointFiles, RefusesBrokenObjAndStl) {
  refused("a.obj", "v 1 2 3\nv 0 0 zero\n", {":2: ", "zero"});
  refused("a.obj", "v 1 2\n", {":1: ", "2 numbers"});
  refused("a.obj", "o nothing\n", {"expected at least one point, got none"});
  for (const char* face :
       {"f 1 2 4", "f 1 2 0", "f 1 2 -4", "f 1 2 3/1", "f 1 2 x", "f 1 2 /3", "f 1 2 9999999999999999999"})
    refused("a.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n") + face + "\n", {":4: "});
  refused("a.stl", "", {"expected STL"});
  refused("a.stl", "solid a\nendsolid a\n", {"expected at least one point, got none"});
  refused("a.stl", "solid a\nvertex 0 0 0\n", {"endsolid"});
  refused("a.stl", "solid a\nvertex 0 0\nendsolid\n", {":2: "});
  refused("a.stl", "nothing of the kind" + std::string(100, ' '), {"expected STL"});
  // A count of 2^32 - 1 with one triangle.
  std::string lie = binary_stl(0xffffffff, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  lie[0] = 'x';
  refused("a.stl", lie, {"4294967295 triangles in 134 bytes"});
}

// A file cut off anywhere is refused, or holds a beginning of the points (text ends where it likes).
TEST_F(PointFiles, CutOffAtEveryByte) {
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.xyz", rows(difficult, "pnt", " ")},
      {"a.csv", "x,y,z\n" + rows(difficult, "p", ",")},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nf 1/1 2/1 3/1\n"},
      {"le.ply", ply_header("binary_little_endian", 3) + binary_rows(difficult, false)},
      {"be.ply", ply_header("binary_big_endian", 3) + binary_rows(difficult, true)},
      {"as.ply", ply_header("ascii", 1) + "1 2 3 4 5 6 7 8 9\n"},
      {"a.pcd", pcd_header("binary", 3) + binary_rows(difficult, false)},
      {"b.stl", binary_stl(1, {0, 0, 0, 1, 0, 0, 0, 1, 0})}};
  for (const auto& [name, bytes] : files)
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const std::string path = write_bytes(folder_ / name, bytes.substr(0, size));
      bool read = false;
      try {
        read = !read_points(path).cloud.positions.empty();
      } catch (const FileError&) {
      }
      // Of the binary ones nothing but the whole; ASCII may lack its last line end or digits.
      const bool binary = name == "le.ply" || name == "be.ply" || name == "a.pcd" || name == "b.stl";
      EXPECT_FALSE(binary && read) << name << size;
    }
}

// The most memory that a process of its own uses for f, in bytes.
std::size_t most_memory_of(const std::function<void()>& f) {
  const pid_t child = ::fork();
  if (child == 0) {
    f();
    ::_exit(0);
  }
  int status = 0;
  rusage used{};
  EXPECT_EQ(::wait4(child, &status, 0, &used), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  return static_cast<std::size_t>(used.ru_maxrss) * 1024;
}

TEST_F(PointFiles, AMillionPointsInThreeTimesTheirMemory) {
  DARBOUX_SKIP_IF_SANITIZED("what was freed is kept");
  constexpr std::size_t n = 1000000;
  std::string row, csv;
  for (std::size_t i = 0; i < n; ++i)
    csv += "0.12345678901234567 0.2345678901234567 " + std::to_string(i) + "\n";
  write_bytes(folder_ / "a.xyz", csv);
  csv = std::string();
  const std::string header = "ply\nformat binary_big_endian 1.0\nelement vertex " + std::to_string(n) +
                             "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  write_bytes(folder_ / "a.ply", header + std::string(12 * n, '\0'));
  const std::size_t nothing = most_memory_of([] {});
  for (const char* name : {"a.xyz", "a.ply"}) {
    const std::string path = folder_ / name;
    const std::size_t used = most_memory_of([&] {
      double last = 0;
      const PointFile file = read_points(path, [&](double share) { last = share; });
      if (file.cloud.positions.size() != n || !(last > 0.9 && last <= 1)) ::_exit(1);
    });
    EXPECT_LE(used - nothing, 3 * n * sizeof(Vec3<double>)) << name;
    RecordProperty(name, std::to_string(static_cast<double>(used - nothing) / (n * sizeof(Vec3<double>))));
  }
}

}  // namespace
}  // namespace darboux::test::point_files_test
