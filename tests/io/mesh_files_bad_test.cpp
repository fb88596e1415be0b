// Broken and hostile PLY, STL, COLLADA and FBX: each is refused by a FileError of one line that names the
// file, what was expected and what it has, or read as something sound. No crash of assimp is one of ours.
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <darboux/sample_mesh.h>

#include "fbx_files.h"
#include "io/child.h"
#include "refusal_of.h"
#include "refused_files.h"
#include "sanitized.h"

namespace darboux::mesh_files_bad_test {
namespace {

using test::expect_bytes_refused;
using test::TempFolder;

// Whether a file is read, as something sound; else it is refused by a proper message.
bool is_read(const std::string& path) {
  try {
    for (const Primitive& p : read_asset(path).primitives) {
      check_consistent(p.data, path);
      EXPECT_FALSE(p.data.triangles.empty());
      for (const auto& [set, uvs] : p.other_uvs) EXPECT_EQ(uvs.size(), p.data.positions.size());
    }
    return true;
  } catch (const Error& error) {
    test::check_message(error.what(), path, "");
    return false;
  }
}

Mesh small() {
  return sample_mesh(make_surface("torus"), {.columns = 3, .rows = 2});
}

std::vector<std::pair<std::string, std::string>> good_files() {
  const Mesh mesh = small();
  return {{"text.ply", test::ply_text(mesh)},
          {"little.ply", test::ply_binary(mesh, false)},
          {"big.ply", test::ply_binary(mesh, true)},
          {"text.stl", test::stl_text(mesh, "name")},
          {"binary.stl", test::stl_binary(mesh)},
          {"a.dae", test::dae_text(mesh, {mesh.uvs})},
          {"a.fbx", test::fbx_text(mesh, {mesh.uvs})},
          {"binary.fbx", test::FbxBinary::of(test::fbx_text(mesh), 7400)}};
}

// The places where files are cut or changed: all of short ones, else so many spread evenly.
std::vector<std::size_t> places(std::size_t size, std::size_t most) {
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < std::min(size, most); ++k) result.push_back(size <= most ? k : k * size / most);
  return result;
}

TEST(BadMeshFiles, CutOffAnywhere) {
  const TempFolder folder;
  for (const auto& [name, bytes] : good_files()) {
    ASSERT_TRUE(is_read(test::write_bytes(folder / name, bytes))) << name;
    const bool assimp = name.ends_with(".fbx");
    for (const std::size_t size : places(bytes.size(), assimp ? 150 : 700)) {
      SCOPED_TRACE(name + " of " + std::to_string(size) + " bytes");
      const bool read = is_read(test::write_bytes(folder / name, bytes.substr(0, size)));
      // Of text the last digit or the name behind endsolid may be lost, and the line end after the last
      // brace.
      EXPECT_TRUE(!read || size + 10 >= bytes.size());
    }
  }
}

TEST(BadMeshFiles, BytesReplaced) {
  const TempFolder folder;
  constexpr unsigned seed = 20261123;
  RecordProperty("seed", static_cast<int>(seed));
  std::mt19937 random(seed);
  for (const auto& [name, bytes] : good_files())
    for (const std::size_t at : places(bytes.size(), name.ends_with(".fbx") ? 150 : 600))
      for (const int change : {0, 0xFF, int{'-'}, int{'9'}, static_cast<int>(random() % 256)}) {
        if (name.ends_with(".fbx") && change != 0xFF && change != '9') continue;
        std::string changed = bytes;
        changed[at] = static_cast<char>(change);
        SCOPED_TRACE(name + " byte " + std::to_string(at) + " = " + std::to_string(change));
        is_read(test::write_bytes(folder / name, changed));
        ASSERT_FALSE(HasFailure());
      }
}

TEST(BadMeshFiles, WhatIsNoneOfThem) {
  const TempFolder folder;
  for (const std::string extension : {"ply", "stl", "dae", "fbx"}) {
    SCOPED_TRACE(extension);
    const std::string name = "bad." + extension;
    for (const std::string& bytes :
         {std::string(), std::string("\n"), std::string("hello\n"), std::string(1000, '\0'),
          std::string(1000, '\xFF'), std::string("# only a comment\r\n"), std::string("\xFF\xFEp\0l\0y\0", 8),
          std::string(200000, 'a'), std::string(100000, '<'), std::string(100000, '{')})
      expect_bytes_refused(bytes, "expected", name);
    std::filesystem::create_directory(folder / name);
    test::expect_refused(folder / name, "got a folder");
    ASSERT_EQ(::mkfifo((folder / ("pipe." + extension)).c_str(), 0600), 0);
    test::expect_refused(folder / ("pipe." + extension), "expected a regular file, got a device or a pipe");
    test::expect_refused(folder / ("missing." + extension),
                         "expected a readable file, got no file of this name");
  }
}

// Line ends of Windows, no last line end, NaN: all as they are.
TEST(BadMeshFiles, WhatIsOnlyUnusual) {
  const TempFolder folder;
  for (auto [name, bytes] : good_files()) {
    if (name == "little.ply" || name == "big.ply" || name.starts_with("binary")) continue;
    std::string crlf;
    for (const char c : bytes) crlf += c == '\n' ? "\r\n" : std::string(1, c);
    while (crlf.ends_with('\n') || crlf.ends_with('\r')) crlf.pop_back();
    EXPECT_TRUE(is_read(test::write_bytes(folder / name, crlf))) << name;
  }
  Mesh mesh = small();
  mesh.positions[0].x = std::numeric_limits<double>::quiet_NaN();
  mesh.normals[1].y = std::numeric_limits<double>::infinity();
  for (const auto& [name, bytes] : {std::pair{"a.ply", test::ply_text(mesh)},
                                    {"b.ply", test::ply_binary(mesh, true)},
                                    {"a.stl", test::stl_text(mesh, "a")},
                                    {"b.stl", test::stl_binary(mesh)},
                                    {"a.dae", test::dae_text(mesh)}}) {
    SCOPED_TRACE(name);
    const Mesh read = read_asset(test::write_bytes(folder / name, bytes)).primitives.at(0).data;
    EXPECT_TRUE(std::any_of(read.positions.begin(), read.positions.end(),
                            [](const Vec3<double>& p) { return std::isnan(p.x) && std::isfinite(p.y); }));
    if (!read.normals.empty()) {
      EXPECT_TRUE(std::any_of(read.normals.begin(), read.normals.end(),
                              [](const Vec3<double>& n) { return std::isinf(n.y); }));
    }
  }
}

TEST(BadMeshFiles, Ply) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list char int vertex_indices\nend_header\n";
  const std::string rows = "0 0 0\n1 0 0\n0 1 0\n";
  const auto refused = [](const std::string& bytes, const std::string& part) {
    expect_bytes_refused(bytes, part, "bad.ply");
  };
  refused(head + faces + rows + "3 0 1 3\n",
          "face 0: expected corners that are whole numbers below its 3 vertices, got 3");
  refused(head + faces + rows + "3 0 1 -1\n", "whole numbers below its 3 vertices, got -1");
  refused(head + faces + rows + "3 0 1 0.5\n", "whole numbers below its 3 vertices, got 0.5");
  refused(head + faces + rows + "3 0 1 nan\n", "whole numbers below its 3 vertices, got nan");
  refused(head + faces + rows + "-3 0 1 2\n",
          "face 0: expected a list whose length is a whole number from 0 to 2^53, got -3");
  refused(head + faces + rows + "3 0 1\n", "too few");
  refused(head + faces + rows + "3 0 1 2 2\n", "too many");
  refused(head + faces + rows, "expected the 1 rows of face that its header announces, got an end at face 0");
  refused(head + faces + rows + "3 0 1 2\n3 0 1 2\n",
          "expected the 1 rows of face that its header announces, got more after them");
  refused(head + faces + "0 0 0\n1e999 0 0\n0 1 0\n3 0 1 2\n", "1e999");
  refused(head + faces + "0 0 0\n1_000 0 0\n0 1 0\n3 0 1 2\n", "1_000");
  refused(head + "element face 1\nproperty int vertex_indices\nend_header\n" + rows + "3\n",
          "faces without corners");
  refused("ply\nformat ascii 1.0\n" + faces,
          "expected a PLY file with vertices, got one without the element vertex");
  refused("ply\nformat ascii 1.0\nelement vertex 4294967296\nproperty float x\n" + faces,
          "expected at most 4294967295 vertices, got 4294967296");
  refused(
      "ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\nproperty float x\nproperty float "
      "y\nproperty float z\n" +
          faces + "123456789012",
      "got an end at vertex 1");
  refused(head +
              "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
              "end_header\n" +
              rows + "3 0 1 2 4 0 0 0 0\n",
          "face 0: expected a texcoord of two numbers for each of its 3 corners, got 4");
  // 255 corners, and none.
  std::string fan = "255";
  for (int k = 0; k < 255; ++k) fan += " " + std::to_string(k % 3);
  std::string many = head + faces;
  many.replace(many.find("face 1"), 6, "face 2");
  many.replace(many.find("list char"), 9, "list uchar");
  const TempFolder folder;
  EXPECT_EQ(read_asset(test::write_bytes(folder / "a.ply", many + rows + fan + "\n0\n"))
                .primitives.at(0)
                .data.triangles.size(),
            253u);
}

TEST(BadMeshFiles, Stl) {
  const auto refused = [](const std::string& bytes, const std::string& part) {
    expect_bytes_refused(bytes, part, "bad.stl");
  };
  refused("solidity\nvertex 0 0 0\nendsolid\n", "got a line before the first solid");
  refused("solid a\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendsolid\n",
          "got a triangle of 2 vertices");
  refused("solid a\nvertex 0 0 0\nvertex 1 0 0\nendsolid\n", "got a triangle of 2 vertices");
  refused("solid a\nvertex 0 0 0 0\nendsolid\n", "got a vertex of 4 numbers");
  refused("solid a\nvertex 0 zero 0\nendsolid\n", "got \"zero\", which is no number");
  std::string lie = test::stl_binary(small());
  std::fill_n(lie.begin() + 80, 4, '\xFF');
  lie[0] = 'x';
  refused(lie, "4294967295 triangles in");
}

TEST(BadMeshFiles, Collada) {
  const std::string good = test::dae_text(small());
  const auto with = [&](const std::string& what, const std::string& by) {
    const std::size_t at = good.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return std::string(good).replace(at, what.size(), by);
  };
  const auto refused = [](const std::string& bytes, const std::string& part) {
    expect_bytes_refused(bytes, part, "bad.dae");
  };
  refused("<COLLADA><a></COLLADA>", "what is not XML at byte");
  refused("<html/>", "expected COLLADA: XML whose first element is COLLADA");
  refused(with("<p>0", "<p>99"), "expected indices below 12 at offset 0, got 99");
  refused(with("<p>0", "<p>-1"), "expected whole numbers from 0, got \"-1\" at place 0");
  refused(with("<p>0", "<p>0 0"), "expected a multiple of 5 indices, got");
  refused(with("<p>0", "<p>1e0"), "expected whole numbers from 0, got \"1e0\"");
  refused(with("<triangles count=\"12\"", "<triangles count=\"13\""),
          "expected a count of its 12 polygons, got 13");
  refused(with("array\" count=\"36", "array\" count=\"36000000000"),
          "expected a count of its 36 numbers, got 36000000000");
  refused(with("-array\" count=\"12\" stride=\"3\"", "-array\" count=\"13\" stride=\"3\""),
          "got 13 vectors of 3 numbers, 3 apart");
  refused(with("count=\"12\" stride=\"3\"", "count=\"12\" stride=\"18446744073709551615\""),
          "got 12 vectors of");
  refused(with("count=\"12\" stride=\"3\"", "count=\"12\" stride=\"0\""), "got 12 vectors of");
  refused(with("count=\"12\" stride=\"3\"", "count=\"12\" offset=\"1\" stride=\"3\""), "got 12 vectors of");
  refused(with("count=\"12\" stride=\"3\"", "count=\"18446744073709551615\" stride=\"3\""),
          "got 18446744073709551615 vectors of");
  refused(with("<param name=\"X\"", "<param"), "expected at least 3 components, got 2");
  refused(with("source=\"#mesh-position-array\"", "source=\"#nowhere\""),
          "expected the #ID of a <float_array> of the file as its source, got \"#nowhere\"");
  refused(with("source=\"#mesh-position-array\"", "source=\"other.dae#a\""),
          "expected the #ID of a <float_array> of the file as its source, got \"other.dae#a\"");
  refused(with("\"POSITION\"", "\"PLACE\""),
          "expected an input VERTEX whose vertices have POSITION, got none");
  refused(with("url=\"#mesh\"", "url=\"#mash\""),
          "expected the #ID of a <geometry>, or of a controller of one, got \"#mash\"");
  refused(with("offset=\"1\"", "offset=\"999999999999\""),
          "expected an offset from 0 to 1000, got 999999999999");
  refused(with("offset=\"1\"", "offset=\"one\""), "expected a whole number as its offset, got \"one\"");
  refused(with("<node>", "<node><matrix>1 2 3</matrix>"), "expected 16 numbers, got 3");
  refused(with("<node>", "<node><skew>1 2 3 4 5 6 7</skew>"), "got skew");
  const std::string list = std::string(good).replace(good.find("<triangles"), 10, "<polylist"),
                    end = "</triangles>";
  const auto with_counts = [&](const std::string& counts) {
    std::string text = list;
    text.replace(text.find(end), end.size(), "</polylist>");
    return text.insert(text.find("<p>"), "<vcount>" + counts + "</vcount>");
  };
  refused(with_counts("3 3"), "expected a <vcount> that sums up to the 36 corners of its <p>");
  refused(with_counts("3 18446744073709551615"),
          "expected a <vcount> that sums up to the 36 corners of its <p>");
  refused(with_counts("3 33"), "got 12");
  // A node within itself, and one that doubles with each level.
  refused(with("<node>", "<node id=\"n\"><instance_node url=\"#n\"/>"),
          "expected nodes of at most 1000000 elements in all, none within itself");
  std::string nodes;
  for (int k = 0; k < 40; ++k)
    nodes += "<node id=\"n" + std::to_string(k) + "\">" +
             (k == 0 ? ""
                     : "<instance_node url=\"#n" + std::to_string(k - 1) + "\"/><instance_node url=\"#n" +
                           std::to_string(k - 1) + "\"/>") +
             "</node>";
  refused(with("<node>", nodes + "<node>"),
          "expected nodes of at most 1000000 elements in all, none within itself");
}

TEST(BadMeshFiles, Fbx) {
  const std::string good = test::fbx_text(small());
  const auto with = [&](const std::string& what, const std::string& by) {
    const std::size_t at = good.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return std::string(good).replace(at, what.size(), by);
  };
  const auto refused = [](const std::string& bytes, const std::string& part) {
    expect_bytes_refused(bytes, part, "bad.fbx");
  };
  refused(with("PolygonVertexIndex: *36 {\n a: 0", "PolygonVertexIndex: *36 {\n a: 99"), "out of range");
  refused(with("FBXVersion: 7400", "FBXVersion: 6100"),
          "expected FBX 7.1 (2011) or later, got 6.1: Autodesk's FBX Converter 2013");
  refused(with("C: \"OO\",10,20\n", ""), "expected an FBX with faces, got a file that has no faces");
  // Nodes within each other: assimp calls itself until its stack ends.
  refused(with("C: \"OO\",20,0\n", "C: \"OO\",20,0\nC: \"OO\",20,20\n"), "cannot be read by assimp");
  refused("Kaydara FBX Binary  " + std::string("\0\x1a\0\xe8\x1c\0\0", 7) + std::string(200, '\xFF'),
          "cannot be read by assimp");
  std::string deep = good;
  deep.insert(deep.find("Objects: {"), [] {
    std::string text;
    for (int k = 0; k < 300000; ++k) text += "a: {";
    return text;
  }());
  refused(deep, "cannot be read by assimp");
}

// ---- the process of its own -------------------------------------------------------------------------------

std::string failure_of(const std::function<std::string()>& work, io::ChildLimits limits = {1u << 30, 20}) {
  return test::refusal_of<io::ChildFailure>([&] { io::in_child(work, limits); });
}

TEST(InAChild, AnswersAndFailures) {
  const std::string large(50'000'000, 'x');
  EXPECT_EQ(io::in_child([&] { return large; }, {1u << 30, 20}), large);
  EXPECT_EQ(io::in_child([] { return std::string(); }, {1u << 30, 20}), "");
  EXPECT_EQ(failure_of([]() -> std::string { throw std::runtime_error("no"); }), "fails");
  EXPECT_EQ(failure_of([]() -> std::string { ::_exit(0); }), "fails");
  EXPECT_EQ(failure_of([]() -> std::string { std::abort(); }), "crashes (Aborted)");
  EXPECT_EQ(failure_of([]() -> std::string {
              ::raise(SIGSEGV);
              return "";
            }),
            "crashes (Segmentation fault)");
  EXPECT_EQ(failure_of(
                []() -> std::string {
                  for (volatile bool forever = true; forever;) {
                  }
                  return "";
                },
                {1u << 30, 1}),
            "takes more than 1 seconds of processor time");
  EXPECT_EQ(failure_of(
                []() -> std::string {
                  ::sleep(60);
                  return "";
                },
                {1u << 30, 1}),
            "does not answer within 12 seconds");
  EXPECT_EQ(failure_of([]() -> std::string {
              ::raise(SIGKILL);
              return "";
            }),
            "is killed, as systems do that are short of memory or time");
}

TEST(InAChild, SaysThatItAskedForTooMuch) {
  DARBOUX_SKIP_IF_SANITIZED("no limit on the address space is small");
  EXPECT_EQ(failure_of([] { return std::string(std::size_t{1} << 28, 'x'); }, {1u << 26, 20}),
            "asks for more than 64 MiB");
}

// What the process may do: compute, allocate, answer. Each of these is an error there, and none without the
// fence.
TEST(InAChild, IsConfined) {
  const std::string file = std::string(DARBOUX_SOURCE) + "/README.md";
  const auto tried = [&](int what) -> std::string {
    switch (what) {
      case 0:
        return ::open(file.c_str(), O_RDONLY) >= 0 ? "done" : std::strerror(errno);
      case 1:
        return ::socket(AF_INET, SOCK_STREAM, 0) >= 0 ? "done" : std::strerror(errno);
      case 2:
        return ::socket(AF_UNIX, SOCK_DGRAM, 0) >= 0 ? "done" : std::strerror(errno);
      case 3: {
        const pid_t child = ::fork();
        if (child == 0) ::_exit(0);
        return child > 0 ? "done" : std::strerror(errno);
      }
      case 4:
        return ::kill(::getppid(), 0) == 0 ? "done" : std::strerror(errno);
      case 5:
        return ::access(file.c_str(), R_OK) == 0 ? "done" : std::strerror(errno);
      default:
        return ::execl("/bin/true", "true", nullptr) == 0 ? "" : std::strerror(errno);
    }
  };
  for (int what = 0; what <= 6; ++what)
    EXPECT_EQ(io::in_child([&] { return tried(what); }, {1u << 30, 20}), "Operation not permitted") << what;
  for (int what = 0; what <= 5; ++what)
    EXPECT_EQ(io::in_child([&] { return tried(what); }, {1u << 30, 20, false}), "done") << what;
}

}  // namespace
}  // namespace darboux::mesh_files_bad_test
