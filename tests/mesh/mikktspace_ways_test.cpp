// MikkTSpace has the same bits by every way to them: on any number of threads, by any instruction set, in
// memory kept from other meshes, in full or four numbers, by corner or by vertex.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/instruction_set.h>
#include <darboux/mikktspace.h>

#include "mesh/mikktspace/connectivity.h"
#include "mesh/mikktspace/vertex_tangents.h"
#include "mikktspace/arrays.h"
#include "mikktspace/generated_meshes.h"
#include "refusal_of.h"

namespace darboux::test::mikktspace_ways_test {
namespace {

// All generated meshes in one, several times: soups large enough that threads share every step, with
// degenerate triangles, uvs without area, zeros of either sign and faces of three and four corners.
TEST(MikkTSpace, ThreadsGiveTheSameBits) {
  Arrays all;
  for (int copy = 0; copy < 6; ++copy)
    for (std::uint32_t k = 0; k < generated_meshes; ++k)
      for (Corner x : generated_mesh(k)) {
        x[0] += static_cast<float>(copy % 2);  // half of them lie on others
        all.add(x);
      }
  Arrays zeros = all;
  for (std::size_t i = 0; i < zeros.positions.size(); i += 7)
    if (zeros.positions[i] == 0) zeros.positions[i] = -0.0F;
  Arrays quads = all;
  const std::size_t corners = quads.mesh().corner_count();
  for (std::size_t left = corners, k = 0; left > 0; left -= quads.face_sizes.back(), ++k) {
    const bool four =
        left == 4 || left == 8 || (k % 5 < 2 && left != 6 && left != 9);  // so that none of 1, 2, 5 are left
    quads.face_sizes.push_back(four ? 4 : 3);
  }
  ASSERT_GT(corners, 100000U);
  for (const Arrays* arrays : {&all, &zeros, &quads})
    for (const bool sorted : {false, true}) {
      const std::vector<float> one = arrays->tangents({.sort_all_edges = sorted});
      for (const int threads : {0, 2, 3, 8})
        EXPECT_TRUE(same_bits(arrays->tangents({.sort_all_edges = sorted, .threads = threads}), one))
            << threads;
    }
  // The smaller one is welded by threads, and its triangles and vertices are shared out.
  for (const auto& [columns, rows] : {std::pair{200, 100}, {40, 30}}) {
    const Arrays torus(torus_soup(columns, rows));
    const std::vector<float> one = torus.tangents();
    for (const int threads : {2, 5}) EXPECT_TRUE(same_bits(torus.tangents({.threads = threads}), one));
  }
}

// Names the instruction set until it goes.
class Instructions {
 public:
  explicit Instructions(const std::string& name) {
    if (const char* value = std::getenv(variable)) before_ = value;
    ::setenv(variable, name.c_str(), 1);
  }
  ~Instructions() {
    if (before_)
      ::setenv(variable, before_->c_str(), 1);
    else
      ::unsetenv(variable);
  }
  Instructions(const Instructions&) = delete;
  Instructions& operator=(const Instructions&) = delete;

 private:
  static constexpr const char* variable = "DARBOUX_ISA";
  std::optional<std::string> before_;
};

TEST(MikkTSpace, EveryInstructionSetGivesTheSameBits) {
  std::vector<const mikk::LaneKernels*> tables;
  for (const InstructionSet set : instruction_sets())
    if (tables.empty() || tables.back() != &mikk::lanes_of(set)) tables.push_back(&mikk::lanes_of(set));
  if (tables.size() < 2) GTEST_SKIP() << "this build and machine have one table of lanes only";
  Arrays plain;
  for (std::uint32_t k = 0; k < generated_meshes; ++k)
    for (const Corner& x : generated_mesh(k)) plain.add(x);
  // Powers of two: as they are, and where triangles are scaled because squares leave the range of float.
  for (const auto& [position, uv] :
       {std::pair{0, 0}, {70, 0}, {-70, 0}, {0, -70}, {0, 60}, {70, -70}, {-70, 60}})
    for (const bool quads : {false, true}) {
      Arrays arrays = plain;
      for (float& x : arrays.positions) x = std::ldexp(x, position);
      for (float& x : arrays.uvs) x = std::ldexp(x, uv);
      if (quads) {
        arrays.face_sizes.assign(arrays.mesh().corner_count() / 12 * 3, 4);
        arrays.face_sizes.resize(arrays.face_sizes.size() + arrays.mesh().corner_count() % 12 / 3,
                                 std::uint8_t{3});
      }
      std::vector<float> tangents;
      std::vector<MikkTangent> full;
      for (const InstructionSet set : instruction_sets()) {
        const Instructions named{std::string(name_of(set))};
        const std::vector<float> here = arrays.tangents();
        const std::vector<MikkTangent> full_here = mikktspace(arrays.mesh());
        if (tangents.empty()) tangents = here, full = full_here;
        EXPECT_TRUE(same_bits(here, tangents)) << name_of(set);
        ASSERT_EQ(full_here.size(), full.size());
        for (std::size_t c = 0; c < full.size(); ++c)
          ASSERT_TRUE(same_bits(full_here[c], full[c])) << name_of(set) << ", corner " << c << ", 2^"
                                                        << position << ", 2^" << uv << ", quads " << quads;
      }
    }
}

TEST(MikkTSpace, AnUnknownInstructionSetIsRefusedBeforeAnythingIsWritten) {
  const Instructions named("altivec");
  for (const bool quad : {false, true}) {
    Arrays arrays;
    for (const auto& [u, v] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {1.F, 1.F}, {0.F, 1.F}})
      if (quad || v <= u) arrays.add({u, v, 0, 0, 0, 1, u, v});
    if (quad) arrays.face_sizes = {4};
    std::vector<float> tangents(4 * arrays.mesh().corner_count(), 7);
    EXPECT_REFUSED(mikktspace(arrays.mesh(), tangents),
                   "DARBOUX_ISA: expected one that this machine and build have (points");
    EXPECT_EQ(tangents, std::vector<float>(tangents.size(), 7));
    EXPECT_REFUSED(mikktspace(arrays.mesh()), "DARBOUX_ISA");
  }
}

// Places that welding looks at in vain for a vertex, on average, all being different.
double steps_of_welding(const Arrays& arrays) {
  const MikkMesh mesh = arrays.mesh();
  std::vector<bool> taken(mikk::weld_places(mesh.vertex_count()));
  std::size_t steps = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    std::size_t at = mikk::weld_hash(mesh, v) % taken.size();
    for (; taken[at]; at = (at + 1) % taken.size()) ++steps;
    taken[at] = true;
  }
  return static_cast<double>(steps) / static_cast<double>(mesh.vertex_count());
}

// Numbers of few bits, as flat grids and cubes have. The table is at most two thirds full: searches that
// begin at random places take (1 / (1 - 2/3) - 1) / 2 = 1 step on average [Knuth, Sorting and
// Searching, 6.4].
TEST(MikkTSpace, WeldingOfGridsTakesFewSteps) {
  constexpr double most = 1.5;
  const auto flat = [](int columns, int rows, float step, std::size_t axis, bool with_uvs) {
    Arrays grid;
    for (int i = 0; i < columns; ++i)
      for (int j = 0; j < rows; ++j) {
        const float x = step * static_cast<float>(i), y = step * static_cast<float>(j);
        Corner corner{};
        corner[(axis + 1) % 3] = x, corner[(axis + 2) % 3] = y, corner[3 + axis] = 1;
        if (with_uvs) corner[6] = x, corner[7] = y;
        grid.add(corner);
      }
    return grid;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool with_uvs : {false, true})
      for (const float step : {1.F, 0x1p-7F, 0x1p-40F, 1000.F, 0.1F})
        for (const auto& [columns, rows] : {std::pair{2, 4096}, {4096, 2}, {128, 128}, {37, 300}})
          EXPECT_LT(steps_of_welding(flat(columns, rows, step, axis, with_uvs)), most)
              << columns << " x " << rows << ", step " << step << ", across axis " << axis << ", uvs "
              << with_uvs;
  Arrays cube;  // six grids
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const float side : {-1.F, 1.F})
      for (int i = -16; i <= 16; ++i)
        for (int j = -16; j <= 16; ++j) {
          const float x = static_cast<float>(i) / 16, y = static_cast<float>(j) / 16;
          Corner corner{};
          corner[axis] = corner[3 + axis] = side;
          corner[(axis + 1) % 3] = x, corner[(axis + 2) % 3] = y;
          corner[6] = (x + 1) / 2, corner[7] = (y + 1) / 2;
          cube.add(corner);
        }
  EXPECT_LT(steps_of_welding(cube), most);
}

// Lanes take the arc cosine by a polynomial, and ask the C library where that does not tell which float.
TEST(MikkTSpace, AnglesAreThoseOfTheLibraryToTheBit) {
  static int asked;
  const auto exactly = [](float x) {
    ++asked;
    return static_cast<float>(std::acos(static_cast<double>(x)));
  };
  std::vector<float> cosines{0, 1, -1, 0.5F, -0.5F, std::nextafter(0.5F, 1.0F), std::nextafter(-0.5F, -1.0F)};
  constexpr std::uint32_t one = 0x3f800000, step = 2039;  // bits of floats
  for (std::uint32_t bits = one; bits > one / 2; bits -= step)
    for (const std::uint32_t sign : {0U, 0x80000000U}) cosines.push_back(std::bit_cast<float>(bits | sign));
  cosines.resize(cosines.size() / 16 * 16);
  std::vector<float> angles(cosines.size());
  for (const InstructionSet set : instruction_sets()) {
    asked = 0;
    mikk::lanes_of(set).arc_cosines(cosines.data(), cosines.size(), exactly, angles.data());
    EXPECT_GT(asked, 0);
    EXPECT_LT(static_cast<std::size_t>(asked), cosines.size() / 1000);
    for (std::size_t i = 0; i < cosines.size(); ++i)
      ASSERT_EQ(angles[i], exactly(cosines[i])) << name_of(set) << ": arc cosine of " << cosines[i];
  }
}

// Large meshes, small ones after them, quads, degenerate triangles, zeros of either sign: what a call finds
// in the memory matters to none.
TEST(MikkTSpace, KeptMemoryChangesNoBit) {
  const auto same = [](const Arrays& arrays, MikkMemory& memory) {
    const MikkOptions kept{.memory = &memory};
    if (!same_bits(arrays.tangents(kept), arrays.tangents())) return false;
    const std::vector<MikkTangent> a = mikktspace(arrays.mesh(), kept), b = mikktspace(arrays.mesh());
    return std::ranges::equal(a, b, [](const auto& x, const auto& y) { return same_bits(x, y); });
  };
  MikkMemory memory;
  EXPECT_EQ(memory.bytes(), 0U);
  const Arrays large(torus_soup(200, 100)), small(torus_soup(20, 10));
  EXPECT_TRUE(same(small, memory));
  const std::size_t of_small = memory.bytes();
  EXPECT_TRUE(same(large, memory));
  const std::size_t of_large = memory.bytes();
  EXPECT_GT(of_large, of_small);
  EXPECT_TRUE(same(small, memory));
  EXPECT_TRUE(same(Arrays(), memory));
  EXPECT_TRUE(same(large, memory));
  EXPECT_EQ(memory.bytes(), of_large);
  for (std::uint32_t k = 0; k < generated_meshes; ++k) {
    Arrays arrays(generated_mesh(k));
    EXPECT_TRUE(same(arrays, memory)) << "mesh " << k;
    if (arrays.positions.size() > 30) arrays.positions[30] = -0.0F;
    arrays.face_sizes.assign(arrays.mesh().corner_count() / 12 * 3, 4);
    arrays.face_sizes.resize(arrays.face_sizes.size() + arrays.mesh().corner_count() % 12 / 3,
                             std::uint8_t{3});
    EXPECT_TRUE(same(arrays, memory)) << "mesh " << k << ", quads";
  }
  memory.release();
  EXPECT_EQ(memory.bytes(), 0U);
  EXPECT_TRUE(same(small, memory));
}

TEST(MikkTSpace, KeptMemoryCanBeMovedAndUsedAfterARefusal) {
  const Arrays good(torus_soup(20, 10));
  const std::vector<float> expected = good.tangents();
  Arrays bad = good;
  bad.uvs[3] = std::numeric_limits<float>::quiet_NaN();
  MikkMemory memory;
  const auto works = [&](MikkMemory& x) { return same_bits(good.tangents({.memory = &x}), expected); };
  EXPECT_TRUE(works(memory));
  EXPECT_NE(refusal_of<MeshError>([&] { bad.tangents({.memory = &memory}); }).find("got nan in the uv"),
            std::string::npos);
  EXPECT_TRUE(works(memory));
  const std::size_t kept = memory.bytes();
  MikkMemory other(std::move(memory));
  EXPECT_EQ(other.bytes(), kept);
  EXPECT_EQ(memory.bytes(), 0U);  // NOLINT(bugprone-use-after-move): as a new one
  EXPECT_TRUE(works(memory) && works(other));
  other = std::move(memory);
  EXPECT_TRUE(works(memory) && works(other));
}

// A grid whose uvs are mirrored at the middle column, some of its triangles turned over: vertices have one
// tangent or several.
Arrays mirrored_grid(int columns, int rows) {
  Arrays grid;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const auto x = static_cast<float>(i), y = static_cast<float>(j);
      grid.add({x, y, 0.1F * x * y, 0, 0, 1, std::fabs(x - static_cast<float>(columns / 2)), y});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      std::array<std::uint32_t, 6> two{at(i, j), at(i + 1, j),     at(i + 1, j + 1),
                                       at(i, j), at(i + 1, j + 1), at(i, j + 1)};
      if ((i + 3 * j) % 7 == 0) std::swap(two[1], two[2]);
      grid.corners.insert(grid.corners.end(), two.begin(), two.end());
    }
  return grid;
}

TEST(MikkTSpace, ByVertexIsAsByCorner) {
  std::size_t others = 0, by_vertex = 0, by_corner = 0;
  const auto expect_same = [&](const Arrays& arrays) {
    const std::vector<float> expected = arrays.tangents();
    for (const int threads : {1, 3}) {
      const mikk::VertexTangents x = mikk::vertex_tangents(arrays.mesh(), {.threads = threads});
      std::vector<Vec4<float>> found(arrays.corners.size());
      std::vector<bool> used(arrays.mesh().vertex_count());
      for (std::size_t c = 0; c < found.size(); ++c) {
        const std::uint32_t v = arrays.corners[c];
        used[v] = true;
        found[c] = x.of_corners.empty() ? x.of_vertices[v] : x.of_corners[c];
      }
      for (const mikk::CornerTangent& other : x.others) {
        Vec4<float>& at = found[other.corner];
        EXPECT_NE(std::memcmp(&at, &other.tangent, sizeof at), 0);
        at = other.tangent;
      }
      EXPECT_EQ(std::memcmp(found.data(), expected.data(), expected.size() * sizeof(float)), 0);
      EXPECT_TRUE(std::ranges::is_sorted(x.others, {}, &mikk::CornerTangent::corner));
      for (std::size_t v = 0; v < x.of_vertices.size(); ++v)
        if (!used[v]) {
          EXPECT_EQ(x.of_vertices[v].w, 0);
        }
      // What a vertex has is what its first corner has.
      std::vector<bool> met(used.size());
      for (std::size_t c = 0; c < found.size() && !x.of_vertices.empty(); ++c) {
        if (!met[arrays.corners[c]]) {
          EXPECT_EQ(std::memcmp(&found[c], &x.of_vertices[arrays.corners[c]], sizeof found[c]), 0);
        }
        met[arrays.corners[c]] = true;
      }
      others += x.others.size();
      ++(x.of_corners.empty() ? by_vertex : by_corner);
    }
  };
  // That of 40 x 40 is welded by one thread, and the rest is shared out.
  for (const auto& [columns, rows] : {std::pair{6, 5}, {1, 1}, {40, 40}, {200, 90}})
    for (const bool doubled : {false, true}) {  // every vertex twice: the second is used by odd triangles
      Arrays grid = mirrored_grid(columns, rows);
      if (doubled) {
        const auto vertices = static_cast<std::uint32_t>(grid.mesh().vertex_count());
        for (std::vector<float>* x : {&grid.positions, &grid.normals, &grid.uvs}) {
          const std::vector<float> once = *x;
          x->insert(x->end(), once.begin(), once.end());
        }
        for (std::size_t c = 0; c < grid.corners.size(); ++c)
          if (c / 3 % 2 == 1) grid.corners[c] += vertices;
      }
      expect_same(grid);
    }
  EXPECT_GE(by_vertex, 10U);
  EXPECT_GT(others, 1000U);
  for (std::uint32_t k = 0; k < generated_meshes; ++k) {
    Arrays arrays(generated_mesh(k));
    for (std::size_t c = 0; c < arrays.mesh().vertex_count(); ++c)
      arrays.corners.push_back(static_cast<std::uint32_t>(c));
    expect_same(arrays);
  }
  EXPECT_GE(by_corner, 10U);
}

TEST(MikkTSpace, IndexedIsAsUnindexed) {
  for (std::uint32_t k = 0; k < generated_meshes; ++k) {
    const Soup soup = generated_mesh(k);
    Arrays indexed;
    std::vector<Corner> vertices;
    for (const Corner& x : soup) {
      std::size_t v = 0;
      while (v < vertices.size() && std::memcmp(&vertices[v], &x, sizeof x) != 0) ++v;
      if (v == vertices.size()) vertices.push_back(x), indexed.add(x);
      indexed.corners.push_back(static_cast<std::uint32_t>(v));
    }
    EXPECT_TRUE(same_bits(indexed.tangents(), Arrays(soup).tangents())) << "mesh " << k;
  }
}

// Tangents in full are served vertex by vertex, and four numbers in lanes: about a vertex whose edges are
// passed by several triangles in either direction, all of one orientation. A triangle far away keeps the last
// edges of the original's order, which are served one by one, from the others.
TEST(MikkTSpace, FullTangentsAreThoseInFour) {
  std::size_t groups_of_all = 0, parted = 0;
  const auto expect_same = [&](const Arrays& arrays, const std::string& which) {
    const std::vector<MikkTangent> full = mikktspace(arrays.mesh());
    const std::vector<float> four = arrays.tangents();
    std::vector<float> of_full;
    for (const MikkTangent& x : full) of_full.insert(of_full.end(), {x.t[0], x.t[1], x.t[2], x.sign});
    ASSERT_TRUE(same_bits(of_full, four)) << which;
    bool alike = true;
    for (std::size_t c = 3; c + 3 < full.size(); c += 3)
      alike = alike && std::equal(&four[4 * c], &four[4 * c] + 3, &four[0]);
    ++(alike ? groups_of_all : parted);
  };
  for (std::uint32_t k = 0; k < generated_meshes; ++k)
    expect_same(Arrays(generated_mesh(k)), "generated mesh " + std::to_string(k));
  constexpr unsigned seed = 41;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(-1, 1);
  for (int k = 0; k < 40000; ++k) {
    Arrays arrays;
    const std::uint32_t vertices = 4 + random() % 3, triangles = 2 + random() % 5;
    for (std::uint32_t v = 0; v < vertices; ++v) {
      const float u = number(random), w = number(random);  // tangents are near each other
      arrays.add({u + number(random) / 9, w + number(random) / 9, number(random), 0, 0, 1, u, w});
    }
    for (const auto& [x, y] : {std::pair{9.F, 9.F}, {10.F, 9.F}, {9.F, 10.F}})
      arrays.add({x, y, 9, 0, 0, 1, x, y});
    const auto uv = [&](std::uint32_t v, std::size_t i) { return arrays.uvs[2 * v + i] - arrays.uvs[i]; };
    for (std::uint32_t t = 0; t < triangles; ++t) {
      std::uint32_t a = 1 + random() % (vertices - 1),
                    b = 1 + (a + random() % (vertices - 2)) % (vertices - 1);
      if (uv(a, 0) * uv(b, 1) < uv(a, 1) * uv(b, 0)) std::swap(a, b);
      arrays.corners.insert(arrays.corners.end(), {0, a, b});
    }
    arrays.corners.insert(arrays.corners.end(), {vertices, vertices + 1, vertices + 2});
    expect_same(arrays, "seed " + std::to_string(seed) + ", mesh " + std::to_string(k));
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(groups_of_all, 1000U);
  EXPECT_GT(parted, 1000U);
}

// A fan of three triangles with a fourth, a fin, on one of its edges, in every order: of the two that pass
// the edge in one direction the first has the neighbour. Is it the fan's, the fan is closed and the fin a
// group of its own; is it the fin, all four are a path.
TEST(MikkTSpace, AFinOnAFanIsAGroupOfItsOwn) {
  Arrays points;
  const auto round = [](float degrees, float turn) {
    const float angle = (degrees + turn) * static_cast<float>(M_PI) / 180;
    return std::pair{std::cos(angle), std::sin(angle)};
  };
  points.add({0, 0, 0, 0, 0, 1, 0, 0});
  for (const float degrees : {0.F, -120.F, 120.F}) {
    const auto [x, y] = round(degrees, 0);
    const auto [u, v] = round(degrees, 30);
    points.add({x, y, 0, 0, 0, 1, u, v});
  }
  points.add({0.5F, -0.6F, 0.8F, 0, 0, 1, 1.2F, -0.1F});
  for (const auto& [x, y] : {std::pair{9.F, 9.F}, {10.F, 9.F}, {9.F, 10.F}})
    points.add({x, y, 0, 0, 0, 1, x, y});
  const std::array<std::array<std::uint32_t, 3>, 4> triangles{{{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {0, 4, 1}}};
  std::array<std::uint32_t, 4> order{0, 1, 2, 3};
  do {
    Arrays mesh = points;
    for (const std::uint32_t t : order)
      mesh.corners.insert(mesh.corners.end(), triangles[t].begin(), triangles[t].end());
    mesh.corners.insert(mesh.corners.end(), {5, 6, 7});
    const std::vector<float> tangents = mesh.tangents();
    const auto of = [&](std::uint32_t triangle) {
      const auto at = static_cast<std::size_t>(std::ranges::find(order, triangle) - order.begin());
      return std::vector<float>(&tangents[12 * at], &tangents[12 * at] + 3);
    };
    EXPECT_EQ(of(0), of(1)) << ::testing::PrintToString(order);
    EXPECT_EQ(of(0), of(2)) << ::testing::PrintToString(order);
    const bool fan_is_closed = std::ranges::find(order, 0U) < std::ranges::find(order, 3U);
    EXPECT_EQ(of(0) != of(3), fan_is_closed) << ::testing::PrintToString(order);
  } while (std::next_permutation(order.begin(), order.end()));
}

}  // namespace
}  // namespace darboux::test::mikktspace_ways_test
