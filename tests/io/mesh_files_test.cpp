// PLY, STL, COLLADA and FBX: every corner as the file has it, and what a mesh in them is assessed to be.
#include <cctype>
#include <cmath>
#include <functional>

#include <assimp/Exporter.hpp>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/io.h>
#include <darboux/sample_mesh.h>

#include "fbx_files.h"

namespace darboux::mesh_files_test {
namespace {

using test::of_corners;
using test::TempFolder;
using test::write_bytes;

Asset read(const std::string& name, const std::string& bytes) {
  const TempFolder folder;
  return read_asset(write_bytes(folder / name, bytes));
}

struct Format {
  std::string name;  // of the file
  std::function<std::string(const Mesh&)> write;
  bool normals, uvs, tangents;  // that it keeps
  double rounding;              // relative, of the numbers
};

// Doubles are written in full. assimp rounds decimals to float within 2 units in the last place.
constexpr double exact = 0, to_float = 0x1p-24, by_assimp = 0x1p-22;

template <std::uint32_t Version>
std::string fbx_binary(const Mesh& mesh) {
  return test::FbxBinary::of(test::fbx_text(mesh), Version);
}

std::vector<Format> formats() {
  return {
      {"text.ply", test::ply_text, true, true, false, exact},
      {"little.ply", [](const Mesh& m) { return test::ply_binary(m, false); }, true, true, false, exact},
      {"big.PLY", [](const Mesh& m) { return test::ply_binary(m, true); }, true, true, false, exact},
      {"text.stl", [](const Mesh& m) { return test::stl_text(m, "a name"); }, false, false, false, exact},
      {"binary.stl", test::stl_binary, false, false, false, to_float},
      {"mesh.dae", [](const Mesh& m) { return test::dae_text(m); }, true, true, true, exact},
      {"text.fbx", [](const Mesh& m) { return test::fbx_text(m); }, true, true, true, by_assimp},
      {"binary.fbx", fbx_binary<7400>, true, true, true, to_float},
      {"larger.fbx", fbx_binary<7500>, true, true, true, to_float},
  };
}

template <class Vector>
void expect_near(const std::vector<Vector>& read, const std::vector<Vector>& written, double rounding) {
  ASSERT_EQ(read.size(), written.size());
  const std::vector<double> a = test::flat(read), b = test::flat(written);
  for (std::size_t i = 0; i < a.size(); ++i)
    // assimp adds the digits before the point to those behind it, which near zero leaves its own rounding
    // of 1.
    ASSERT_NEAR(a[i], b[i], rounding * std::max(std::fabs(b[i]), 0x1p-20)) << i;
}

void expect_same_corners(const Mesh& read, const Mesh& written, const Format& format) {
  ASSERT_EQ(read.corners(), written.corners());
  expect_near(of_corners(read, read.positions), of_corners(written, written.positions), format.rounding);
  ASSERT_EQ(!read.normals.empty(), format.normals);
  ASSERT_EQ(!read.uvs.empty(), format.uvs);
  ASSERT_EQ(!read.tangents.empty(), format.tangents);
  if (format.normals)
    expect_near(of_corners(read, read.normals), of_corners(written, written.normals), format.rounding);
  if (format.uvs) expect_near(of_corners(read, read.uvs), of_corners(written, written.uvs), format.rounding);
  if (!format.tangents) return;
  expect_near(of_corners(read, test::directions(read.tangents)),
              of_corners(written, test::directions(written.tangents)), format.rounding);
  for (std::size_t c = 0; c < read.corners(); ++c)
    ASSERT_EQ(read.tangents[read.triangles[c / 3][c % 3]].w,
              written.tangents[written.triangles[c / 3][c % 3]].w);
}

// An exact torus and sphere, under both signs of w, come back corner by corner, and pass.
TEST(MeshFiles, WhatIsWrittenIsReadAndPasses) {
  for (const char* name : {"torus:major_radius=1,minor_radius=0.3", "sphere:radius=2"})
    for (const SignConvention sign : {SignConvention::gltf, SignConvention::raw}) {
      const Mesh mesh = sample_mesh(make_surface(name), {.columns = 24, .rows = 12, .sign = sign});
      for (const Format& format : formats()) {
        SCOPED_TRACE(format.name + " " + name);
        const Asset asset = read(format.name, format.write(mesh));
        ASSERT_EQ(asset.primitives.size(), 1u);
        EXPECT_TRUE(asset.skipped.empty());
        const Primitive& primitive = asset.primitives[0];
        expect_same_corners(primitive.data, mesh, format);
        EXPECT_EQ(primitive.texcoord, format.uvs ? 0 : -1);
        EXPECT_TRUE(primitive.other_uvs.empty());
        ASSERT_EQ(primitive.instances.size(), 1u);
        EXPECT_EQ(primitive.instances[0], Eigen::Matrix4d::Identity());
        const std::vector<Assessment> assessments = assess_parts(primitive.data);
        ASSERT_EQ(assessments.size(), 1u);
        // Without normals there is nothing to compare.
        EXPECT_EQ(assessments[0].report.verdict, format.normals ? Verdict::pass : Verdict::nothing);
        EXPECT_TRUE(assessments[0].fit && assessments[0].fit->fits);
      }
    }
}

// A second hand on the same formats; its text has six digits. (Its binary FBX lacks the records between
// nodes.)
TEST(MeshFiles, WhatAssimpWritesIsRead) {
  const Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 12, .rows = 6});
  aiScene scene;
  scene.mRootNode = new aiNode("root");
  scene.mRootNode->mNumMeshes = 1;
  scene.mRootNode->mMeshes = new unsigned[1]{0};
  scene.mNumMaterials = 1;
  scene.mMaterials = new aiMaterial* [1] { new aiMaterial };
  scene.mNumMeshes = 1;
  scene.mMeshes = new aiMesh* [1] { new aiMesh };
  aiMesh& to = *scene.mMeshes[0];
  to.mName = "torus";
  to.mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  to.mNumVertices = static_cast<unsigned>(mesh.positions.size());
  to.mVertices = new aiVector3D[mesh.positions.size()];
  to.mNormals = new aiVector3D[mesh.positions.size()];
  to.mTextureCoords[0] = new aiVector3D[mesh.positions.size()];
  to.mNumUVComponents[0] = 2;
  const auto f = [](double x) { return static_cast<float>(x); };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    to.mVertices[i] = {f(mesh.positions[i].x), f(mesh.positions[i].y), f(mesh.positions[i].z)};
    to.mNormals[i] = {f(mesh.normals[i].x), f(mesh.normals[i].y), f(mesh.normals[i].z)};
    to.mTextureCoords[0][i] = {f(mesh.uvs[i].x), f(mesh.uvs[i].y), 0};
  }
  to.mNumFaces = static_cast<unsigned>(mesh.triangles.size());
  to.mFaces = new aiFace[mesh.triangles.size()];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    to.mFaces[t].mNumIndices = 3;
    to.mFaces[t].mIndices = new unsigned[3]{mesh.triangles[t][0], mesh.triangles[t][1], mesh.triangles[t][2]};
  }
  for (const auto& [id, extension, attributes] : {std::tuple{"fbxa", "fbx", true},
                                                  {"collada", "dae", true},
                                                  {"ply", "ply", true},
                                                  {"plyb", "ply", true},
                                                  {"stl", "stl", false},
                                                  {"stlb", "stl", false}}) {
    SCOPED_TRACE(id);
    Assimp::Exporter exporter;
    const TempFolder folder;
    const std::string path = folder / (std::string("by_assimp.") + extension);
    ASSERT_EQ(exporter.Export(&scene, id, path), aiReturn_SUCCESS) << exporter.GetErrorString();
    const Asset asset = read_asset(path);
    ASSERT_EQ(asset.primitives.size(), 1u);
    expect_same_corners(asset.primitives[0].data, mesh, {id, {}, attributes, attributes, false, 4e-6});
  }
}

// ---- PLY and STL ------------------------------------------------------------------------------------------

TEST(MeshFiles, PolygonsOfAPlyAreFans) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element edge 1\nproperty int vertex1\nproperty int vertex2\nelement face 3\nproperty uchar red\n";
  const std::string rows = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n0 1\n";
  for (const char* name : {"vertex_index", "vertex_indices"}) {
    const Asset asset = read("a.ply", head + "property list uchar uint " + name + "\nend_header\n" + rows +
                                          "9 4 0 1 2 3\n9 2 0 1\n9 3 0 3 4\n");
    ASSERT_EQ(asset.primitives.size(), 1u);
    EXPECT_EQ(asset.primitives[0].data.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
    EXPECT_EQ(asset.primitives[0].data.positions.size(), 5u);
    EXPECT_EQ(asset.primitives[0].texcoord, -1);
  }
}

// MeshLab's uvs of corners: a vertex for each.
TEST(MeshFiles, UvsOfAPlysCorners) {
  const Asset asset =
      read("a.ply",
           "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
           "float z\nelement face 1\nproperty list uchar int vertex_indices\nproperty list uchar "
           "float texcoord\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
           "4 0 1 2 3 8 0 0.5 0.25 0.5 0.25 1 0 1\n");
  ASSERT_EQ(asset.primitives.size(), 1u);
  const Mesh& mesh = asset.primitives[0].data;
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(mesh.positions,
            (std::vector<Vec3<double>>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.uvs,
            (std::vector<Vec2<double>>{{0, 0.5}, {0.25, 0.5}, {0.25, 1}, {0, 0.5}, {0.25, 1}, {0, 1}}));
}

TEST(MeshFiles, APlyWithoutFacesIsEmpty) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const Asset points = read("a.ply", head + "end_header\n0 0 0\n");
  EXPECT_TRUE(points.primitives.empty());
  ASSERT_EQ(points.skipped.size(), 1u);
  EXPECT_EQ(points.skipped[0].reason, "points without faces have no triangles");
  const Asset none =
      read("a.ply", head + "element face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n");
  EXPECT_TRUE(none.primitives.empty());
  EXPECT_EQ(none.skipped.at(0).reason, "its faces have no triangles");
  const Asset strips =
      read("a.ply", head +
                        "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                        "0 0 0\n3 0 0 0\n");
  EXPECT_EQ(strips.skipped.at(0).reason,
            "its triangles are strips (element tristrips), which are not read: expected an element face");
}

TEST(MeshFiles, EachSolidOfAnStlIsAMesh) {
  const Mesh torus = sample_mesh(make_surface("torus"), {.columns = 4, .rows = 3});
  const Asset asset = read("a.stl", test::stl_text(torus, "first") + "solid empty\nendsolid\n" +
                                        test::stl_text(torus, "second one"));
  ASSERT_EQ(asset.primitives.size(), 2u);
  EXPECT_EQ(asset.primitives[0].name, "first");
  EXPECT_EQ(asset.primitives[1].name, "second one");
  EXPECT_EQ(asset.primitives[1].mesh, 2u);
  EXPECT_EQ(asset.primitives[1].data.corners(), torus.corners());
  ASSERT_EQ(asset.skipped.size(), 1u);
  EXPECT_EQ(asset.skipped[0].mesh, 1u);

  std::string shouted = test::stl_text(torus, "A name");
  for (char& c : shouted) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const Asset capitals = read("b.stl", shouted);
  ASSERT_EQ(capitals.primitives.size(), 1u);
  EXPECT_EQ(capitals.primitives[0].name, "A NAME");
  EXPECT_EQ(capitals.primitives[0].data.positions, asset.primitives[0].data.positions);
}

// ---- COLLADA ----------------------------------------------------------------------------------------------

Mesh quad() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// A geometry "g" whose only input is VERTEX, with groups of polygons as given.
std::string positions_only(const std::string& groups) {
  const Mesh mesh = quad();
  std::string text = test::collada_geometry(mesh, "g");
  const std::size_t begin = text.find("<triangles"), end = text.find("</mesh>");
  return text.replace(begin, end - begin, groups);
}

TEST(MeshFiles, EveryKindOfPolygonsOfACollada) {
  const std::string vertex = "<input semantic=\"VERTEX\" source=\"#g-vertices\" offset=\"0\"/>";
  struct Case {
    std::string group;
    std::vector<std::array<int, 3>> corners;
  };
  for (const auto& [group, corners] : std::vector<Case>{
           {"<triangles count=\"1\">" + vertex + "<p>0 1 2</p></triangles>", {{0, 1, 2}}},
           {"<polylist count=\"2\">" + vertex +
                "<vcount>3 4</vcount><p>0 1 2 0 1 <!-- cut -->2 3</p></polylist>",
            {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}},
           {"<polygons count=\"2\">" + vertex + "<p>0 1 2 3</p><p>3 2 1</p></polygons>",
            {{0, 1, 2}, {0, 2, 3}, {3, 2, 1}}},
           {"<tristrips count=\"1\">" + vertex + "<p>0 1 3 2</p></tristrips>", {{0, 1, 3}, {1, 2, 3}}},
           {"<trifans count=\"2\">" + vertex + "<p>0 1 2 3</p><p>1 2 3</p></trifans>",
            {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}}}}) {
    SCOPED_TRACE(group);
    const Asset asset = read("a.dae", test::collada(positions_only(group), ""));
    ASSERT_EQ(asset.primitives.size(), 1u);
    const Mesh& mesh = asset.primitives[0].data;
    ASSERT_EQ(mesh.triangles.size(), corners.size());
    for (std::size_t c = 0; c < mesh.corners(); ++c)
      EXPECT_EQ(mesh.positions[mesh.triangles[c / 3][c % 3]],
                quad().positions[static_cast<std::size_t>(corners[c / 3][c % 3])]);
  }
  const Asset passed_over = read(
      "a.dae", test::collada(positions_only("<lines count=\"1\">" + vertex + "<p>0 1</p></lines><polygons>" +
                                            vertex + "<ph><p>0 1 2 3</p><h>0 1 2</h></ph></polygons>") +
                                 "<geometry id=\"spline\"><spline/></geometry>",
                             ""));
  EXPECT_TRUE(passed_over.primitives.empty());
  ASSERT_EQ(passed_over.skipped.size(), 3u);
  EXPECT_EQ(passed_over.skipped[0].reason, "lines have no triangles");
  EXPECT_NE(passed_over.skipped[1].reason.find("holes"), std::string::npos);
  EXPECT_EQ(passed_over.skipped[2].mesh, 1u);
}

TEST(MeshFiles, NodesOfACollada) {
  const Asset asset = read(
      "a.dae",
      test::collada(
          test::collada_geometry(quad(), "a") + test::collada_geometry(quad(), "b") +
              "</library_geometries><library_controllers><controller id=\"skinned\"><skin source=\"#b\"/>"
              "</controller></library_controllers><library_nodes><node id=\"shared\"><scale>1 1 -2</scale>"
              "<instance_geometry url=\"#a\"/></node></library_nodes><library_geometries>",
          "<node><translate>1 2 3</translate><rotate>0 0 2 90</rotate>"
          "<instance_geometry url=\"#a\"/><node><instance_node url=\"#shared\"/></node></node>"
          "<node><matrix>0 -1 0 4  1 0 0 5  0 0 1 6  0 0 0 1</matrix><instance_controller "
          "url=\"#skinned\"/></node>"
          "<node><lookat>1 2 3  1 2 2  0 1 0</lookat><instance_geometry url=\"#b\"/></node>"));
  ASSERT_EQ(asset.primitives.size(), 2u);
  EXPECT_EQ(asset.primitives[0].name, "the a");
  EXPECT_EQ(asset.primitives[1].mesh, 1u);
  const auto near = [](const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) { return (a - b).norm() < 1e-12; };
  Eigen::Matrix4d turned, mirrored, by_matrix, looking = Eigen::Matrix4d::Identity();
  turned << 0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1;
  mirrored = turned * Eigen::Vector4d(1, 1, -2, 1).asDiagonal();
  by_matrix << 0, -1, 0, 4, 1, 0, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1;
  looking.block<3, 1>(0, 3) << 1, 2, 3;
  ASSERT_EQ(asset.primitives[0].instances.size(), 2u);
  EXPECT_TRUE(near(asset.primitives[0].instances[0], turned));
  EXPECT_TRUE(near(asset.primitives[0].instances[1], mirrored));
  ASSERT_EQ(asset.primitives[1].instances.size(), 2u);
  EXPECT_TRUE(near(asset.primitives[1].instances[0], by_matrix));
  EXPECT_TRUE(near(asset.primitives[1].instances[1], looking));
}

// ---- FBX --------------------------------------------------------------------------------------------------

TEST(MeshFiles, NodesAndSharedGeometriesOfAnFbx) {
  const Asset asset =
      read("a.fbx",
           test::fbx(test::fbx_geometry(quad(), "first", 10) + test::fbx_geometry(quad(), "second", 11) +
                         test::fbx_model(20, "a",
                                         "P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",1,2,3\n"
                                         "P: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",1,1,-2\n") +
                         test::fbx_model(21, "b") + test::fbx_model(22, "c"),
                     "C: \"OO\",10,20\nC: \"OO\",10,21\nC: \"OO\",11,22\nC: \"OO\",20,0\nC: \"OO\",21,20\nC: "
                     "\"OO\",22,0\n"));
  ASSERT_EQ(asset.primitives.size(), 2u);
  for (const Primitive& p : asset.primitives) {
    const bool first = p.name.find("first") != std::string::npos;
    ASSERT_EQ(p.instances.size(), first ? 2u : 1u) << p.name;
    Eigen::Matrix4d moved = Eigen::Matrix4d::Identity();
    moved.diagonal() << 1, 1, -2, 1;
    moved.block<3, 1>(0, 3) << 1, 2, 3;
    // The file's own axes and units: no scale of an inch, no up axis.
    for (const Eigen::Matrix4d& world : p.instances)
      EXPECT_LT((world - (first ? moved : Eigen::Matrix4d::Identity())).norm(), 1e-6) << p.name;
  }
}

TEST(MeshFiles, PolygonsOfAnFbx) {
  // A quad that is concave at its second corner, which both triangles must have, and a convex pentagon.
  const std::vector<Vec3<double>> positions{{0, 0, 0}, {0.2, 0.2, 0}, {1, 0, 0},   {0, 1, 0}, {2, 0, 0},
                                            {3, 0, 0}, {3, 1, 0},     {2.5, 2, 0}, {2, 1, 0}};
  const Asset asset = read(
      "a.fbx", test::fbx(test::fbx_geometry("polygons", 10, positions, {0, 1, 2, -4, 4, 5, 6, 7, -9}, "") +
                             test::fbx_model(20, "node"),
                         "C: \"OO\",10,20\nC: \"OO\",20,0\n"));
  ASSERT_EQ(asset.primitives.size(), 1u);
  const Mesh& mesh = asset.primitives[0].data;
  ASSERT_EQ(mesh.triangles.size(), 5u);
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const double twice =
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]).z;
    EXPECT_GT(twice, 0);
    area += twice / 2;
  }
  // 0.5 less the two triangles beside (0.2, 0.2); a square and a triangle.
  EXPECT_NEAR(area, 0.5 - 0.1 + 1 + 0.5, 1e-6);
}

// Without bitangents assimp takes n x t for them.
TEST(MeshFiles, AnFbxWithoutBitangentsHasPositiveSigns) {
  const Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 6, .rows = 4});
  ASSERT_EQ(mesh.tangents[0].w, -1);
  const Asset asset =
      read("a.fbx", test::fbx(test::fbx_geometry(mesh, "torus", 10, {}, false) + test::fbx_model(20, "node"),
                              "C: \"OO\",10,20\nC: \"OO\",20,0\n"));
  for (const Vec4<double>& t : asset.primitives.at(0).data.tangents) EXPECT_EQ(t.w, 1);
}

}  // namespace
}  // namespace darboux::mesh_files_test
