// Files that ask for much more than they hold: refused before it is allocated, by what asked for how much.
#include <sys/resource.h>

#include "cli.h"
#include "fbx_files.h"
#include "sanitized.h"

namespace darboux::test::budget_test {
namespace {

class CliBudget : public Cli {
 protected:
  void TearDown() override {
    Cli::TearDown();
    DARBOUX_SKIP_IF_SANITIZED("all is checked but the memory");
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    EXPECT_LE(usage.ru_maxrss, 1000000) << "kB at most of all that this process started";
  }

  // So many primitives over the same accessors, of so many vertices; without bytes: of zeros.
  void write_shared(std::size_t primitives, std::size_t vertices, bool with_bytes) {
    Builder b;
    Json more = Json::object();
    if (with_bytes) more["bufferView"] = b.view(std::string(12 * vertices, '\0'));
    const std::size_t positions = b.accessor("VEC3", 5126, vertices, more);
    for (std::size_t i = 0; i < primitives; ++i) b.primitive({{"POSITION", positions}});
    if (!with_bytes) b.json.erase("buffers");
    write_bytes(path("m.glb"), b.glb());
  }

  // The command, in an address space that holds the tool and 1 GiB.
  Result within_a_gibibyte(const std::string& command) const {
    return sh((sanitized ? "darboux " : "ulimit -v 2000000; darboux ") + command);
  }

  void expect_refused_by_budget(const std::string& what) const {
    for (const std::string command :
         {"validate m.glb", "tangents m.glb -o out.glb", "compare m.glb m.glb", "fit m.glb", "scene m.glb"}) {
      SCOPED_TRACE(command);
      const Result r = within_a_gibibyte(command);
      EXPECT_EQ(r.status, 2);
      expect_one_line(r.err);
      for (const std::string& part :
           {std::string("m.glb: meshes[0].primitives["), std::string("--max-memory"), what})
        EXPECT_NE(r.err.find(part), std::string::npos) << part << " in " << r.err;
    }
  }
};

TEST_F(CliBudget, SharedAccessorsCountForEveryPrimitive) {
  write_shared(10000, 20000, true);
  expect_refused_by_budget("its vertices and triangles");
}

TEST_F(CliBudget, SoDoAccessorsWithoutBytes) {
  write_shared(3000, 87381, false);
  expect_refused_by_budget("its vertices and triangles");
}

// The list of a mesh's instances is there once, its primitives refer to it.
TEST_F(CliBudget, InstancesAreThereOncePerMesh) {
  Builder b = one_triangle();
  for (int i = 1; i < 3000; ++i) b.primitive(b.json["meshes"][0]["primitives"][0]["attributes"]);
  b.json["nodes"] = Json::array();
  for (int i = 0; i < 100000; ++i) b.json["nodes"].push_back({{"mesh", 0}});
  write_bytes(path("m.glb"), b.glb());
  for (const std::string command : {"validate m.glb", "tangents m.glb -o out.glb", "compare m.glb m.glb"}) {
    SCOPED_TRACE(command);
    const Result r = within_a_gibibyte(command);
    EXPECT_LE(r.status, 1) << r.err;
  }
  refused("darboux scene m.glb", {"m.glb: nodes[3333]: expected at most 10000000 instances"});
  refused("darboux validate m.glb --max-memory 12000000",
          {"m.glb: meshes[0]: expected at most 11.44 MiB", "12.21 MiB for its instances"});
}

// EXT_mesh_gpu_instancing: instances of what has no triangles count too.
TEST_F(CliBudget, SoDoInstancesOfTheExtension) {
  Builder b;
  const std::size_t zeros = b.accessor("VEC3", 5126, 87381, Json::object());
  b.primitive({{"POSITION", zeros}})["mode"] = 0;
  b.json.erase("buffers");
  b.json["nodes"] = Json::array();
  for (int i = 0; i < 50000; ++i)
    b.json["nodes"].push_back(
        {{"mesh", 0},
         {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", zeros}}}}}}}});
  write_bytes(path("m.glb"), b.glb());
  const Result r = sh("ulimit -t 10; darboux scene m.glb");
  EXPECT_EQ(r.status, 2);
  expect_one_line(r.err);
  EXPECT_NE(r.err.find("m.glb: nodes[114]: expected at most 10000000 instances"), std::string::npos) << r.err;
}

// Primitives that differ in their indices alone: whether two are the same is not asked of each pair.
TEST_F(CliBudget, ManyPrimitivesOverTheSameVertices) {
  constexpr std::size_t vertices = 20000;
  Builder b;
  std::string positions;
  for (std::size_t i = 0; i < vertices; ++i)
    for (const std::size_t x : {i % 141, i / 141, i * i % 7})
      positions += test::pack<float>({static_cast<float>(x)});
  const std::size_t shared = b.accessor("VEC3", 5126, vertices, {{"bufferView", b.view(positions)}});
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const std::string indices = test::pack<std::uint32_t>({i, i + 1, i + 141});
    b.primitive({{"POSITION", shared}})["indices"] =
        b.accessor("SCALAR", 5125, 3, {{"bufferView", b.view(indices)}});
  }
  write_bytes(path("m.glb"), b.glb());
  for (const std::string command : {"validate m.glb", "fit m.glb", "compare m.glb m.glb", "scene m.glb"}) {
    SCOPED_TRACE(command);
    const Result r = sh("ulimit -t 10; darboux " + command);
    EXPECT_LE(r.status, 1) << r.err;
  }
}

TEST_F(CliBudget, SoDoMorphTargets) {
  Builder b;
  Json& primitive = [&]() -> Json& {
    const std::size_t vertices =
        b.accessor("VEC3", 5126, 20000, {{"bufferView", b.view(std::string(240000, '\0'))}});
    const std::size_t uvs =
        b.accessor("VEC2", 5126, 20000, {{"bufferView", b.view(std::string(160000, '\0'))}});
    return b.primitive({{"POSITION", vertices}, {"NORMAL", vertices}, {"TEXCOORD_0", uvs}});
  }();
  primitive["targets"] = Json::array();
  for (int i = 0; i < 10000; ++i) primitive["targets"].push_back({{"POSITION", 0}});
  write_bytes(path("m.glb"), b.glb());
  const Result r = within_a_gibibyte("tangents m.glb -o out.glb");
  EXPECT_EQ(r.status, 2);
  expect_one_line(r.err);
  for (const char* part : {"meshes[0].primitives[0].targets[", "a morph target", "--max-memory"})
    EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
}

TEST_F(CliBudget, AsAreThoseOfCollada) {
  std::string nodes, groups;
  for (int i = 0; i < 100000; ++i) nodes += "<node><instance_geometry url='#g'/></node>";
  for (int i = 0; i < 100; ++i)
    groups += "<triangles><input semantic='VERTEX' source='#v' offset='0'/><p>0 1 2</p></triangles>";
  write_bytes(
      path("m.dae"),
      "<COLLADA><library_geometries><geometry id='g'><mesh><source id='s'><float_array id='a' count='9'>0 0 "
      "0 1 0 0 "
      "0 1 0</float_array><technique_common><accessor source='#a' count='3' stride='3'/></technique_common>"
      "</source><vertices id='v'><input semantic='POSITION' source='#s'/></vertices>" +
          groups + "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene>" + nodes +
          "</visual_scene></library_visual_scenes></COLLADA>");
  for (const std::string command : {"validate m.dae", "compare m.dae m.dae"}) {
    SCOPED_TRACE(command);
    const Result r = within_a_gibibyte(command);
    EXPECT_LE(r.status, 1) << r.err;
  }
  refused("darboux validate m.dae --max-memory 12000000",
          {"m.dae: <mesh> at byte ", "--max-memory", "12.21 MiB for its instances"});
}

// Two bytes of a fan are a triangle, of three vertices.
TEST_F(CliBudget, SoDoFansOfCollada) {
  std::string corners = "0 1";
  for (int i = 0; i < 4000000; ++i) corners += " 2";
  write_bytes(
      path("m.dae"),
      "<COLLADA><library_geometries><geometry id='g'><mesh><source id='s'><float_array id='a' count='9'>0 0 "
      "0 1 0 0 "
      "0 1 0</float_array><technique_common><accessor source='#a' count='3' stride='3'/></technique_common>"
      "</source><vertices id='v'><input semantic='POSITION' source='#s'/></vertices><trifans>"
      "<input semantic='VERTEX' source='#v' offset='0'/><p>" +
          corners + "</p></trifans></mesh></geometry></library_geometries></COLLADA>");
  const Result r = within_a_gibibyte("validate m.dae");
  EXPECT_EQ(r.status, 2);
  expect_one_line(r.err);
  for (const char* part :
       {"m.dae: <trifans> at byte ", "--max-memory", " for 4000000 triangles of 12000000 corners"})
    EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
}

// One face of very many corners, a byte each.
TEST_F(CliBudget, SoDoFacesOfPly) {
  const std::uint32_t corners = 9000000;
  const auto write = [&](bool with_uvs, std::uint32_t n) {
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
        "y\nproperty "
        "float z\nelement face 1\nproperty list uint uchar vertex_indices\n";
    if (with_uvs) bytes += "property list uint uchar texcoord\n";
    bytes += "end_header\n" + test::pack<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + test::pack<std::uint32_t>({n});
    for (std::uint32_t i = 0; i < n; ++i) bytes += static_cast<char>(i % 3);
    if (with_uvs) bytes += test::pack<std::uint32_t>({2 * n}) + std::string(2 * std::size_t{n}, '\1');
    write_bytes(path("m.ply"), bytes);
  };
  const auto expect = [&](const char* what) {
    for (const std::string command : {"validate m.ply", "compare m.ply m.ply"}) {
      SCOPED_TRACE(command);
      const Result r = within_a_gibibyte(command);
      EXPECT_EQ(r.status, 2);
      expect_one_line(r.err);
      for (const char* part : {"m.ply: face 0: expected at most 512 MiB", "--max-memory", what})
        EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
    }
  };
  write(false, corners);
  expect("1099 MiB for its 8999998 triangles");
  write(true, 3000000);  // corners with uvs of their own become vertices
  expect("709.5 MiB for its 2999998 triangles");
  write(false, 1000000);
  good("darboux validate m.ply");
}

// A texel in a 32nd of a byte: 128 of them in the 4 bytes of a run.
TEST_F(CliBudget, SoDoImages) {
  constexpr std::size_t size = 15000;
  std::string tga(18, '\0');
  tga[2] = 10;
  tga[12] = tga[14] = static_cast<char>(size & 255);
  tga[13] = tga[15] = static_cast<char>(size >> 8);
  tga[16] = 24;
  for (std::size_t i = 0; i < size * size; i += 128) tga += "\xff\xff\x80\x80";
  write_bytes(path("m.tga"), tga);
  good("darboux mesh torus --grid 8x4 -o m.glb --quiet");
  for (const std::string command :
       {"normalmap --check m.tga", "normalmap m.tga --from tangent --to object --mesh m.glb -o out.png"}) {
    SCOPED_TRACE(command);
    const Result r = within_a_gibibyte(command);
    EXPECT_EQ(r.status, 2);
    expect_one_line(r.err);
    for (const char* part :
         {"m.tga: expected at most 512 MiB", "--max-memory", "for an image of 15000 x 15000"})
      EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
  }
}

// Polygons are cut into triangles in a time that grows with the square of their corners.
TEST_F(CliBudget, PolygonsOfVeryManyCornersAreRefused) {
  const auto write = [&](int corners, int polygons) {
    std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    std::vector<int> fbx_corners;
    for (int k = 0; k < polygons; ++k) {
      obj += "f";
      for (int i = 0; i < corners; ++i) {
        obj += ' ' + std::to_string(i % 3 + 1);
        fbx_corners.push_back(i + 1 < corners ? i % 3 : -1 - i % 3);
      }
      obj += '\n';
    }
    write_bytes(path("m.obj"), obj);
    write_bytes(path("m.fbx"),
                fbx(fbx_geometry("mesh", 10, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, fbx_corners, "") +
                        fbx_model(20, "node"),
                    "C: \"OO\",10,20\nC: \"OO\",20,0\n"));
  };
  write(30000, 1);
  for (const std::string file : {"m.obj", "m.fbx"}) {
    for (const std::string& command : {"validate " + file, "compare " + file + " " + file})
      refused("darboux " + command,
              {file + ": expected an ", "has polygons whose corners, squared, sum to more than 25",
               ": with one of 30000 in mesh 0"});
  }
  for (const auto& [corners, polygons] : {std::pair{2000, 1}, {16, 110000}}) {
    write(corners, polygons);
    good("darboux validate m.obj");
    if (polygons == 1) good("darboux validate m.fbx");
  }
}

// Each key is looked for among those before it: time grows with the square of their number.
TEST_F(CliBudget, ObjectsOfVeryManyKeysAreRefusedByAllReaders) {
  std::string keys;
  for (int i = 0; i < 10000; ++i) keys += "\"key" + std::to_string(i) + "\": 0,";
  write_bytes(path("f.gltf"), R"({"asset": {"version": "2.0"}, "extras": {)" + keys + "\"\": 0}}");
  write_bytes(path("f.json"), "{" + keys + "\"files\": []}\n");
  for (const std::string command :
       {"validate f.gltf", "plan f.gltf", "tangents f.gltf -o out.glb", "compare f.gltf f.gltf",
        "scene f.gltf", "validate data/torus_016.three.glb --baseline f.json",
        "eval bezier-patch:file=f.json --at 0,0", "eval bspline-patch:file=f.json --at 0,0", "scene f.json",
        "converge --study f.json", "merge f.json"})
    refused("darboux " + command, {"f.", "the object at byte ", "expected at most 10000 keys, got 10001"});
  const auto in = [](std::string text, const std::string& what) {
    return text.erase(text.find(what), what.size());
  };
  write_bytes(path("f.gltf"),
              R"({"asset": {"version": "2.0"}, "extras": {)" + in(keys, "\"key7\": 0,") + "\"\": 0}}");
  good("darboux validate f.gltf");  // 10 000
}

// The arrays of a document are looked for again for each of their elements.
TEST_F(CliBudget, DocumentsOfVeryManyKeysAreRefused) {
  std::string keys, nodes = "{}";
  for (int i = 0; i < 9000; ++i) keys += "\"key" + std::to_string(i) + "\": 0,";
  for (int i = 1; i < 300000; ++i) nodes += ",{}";
  write_bytes(path("f.gltf"), "{" + keys + R"("asset": {"version": "2.0"}, "nodes": [)" + nodes + "]}");
  for (const std::string command :
       {"validate f.gltf", "plan f.gltf", "tangents f.gltf -o out.glb", "scene f.gltf"})
    refused("darboux " + command, {"f.gltf: the document", "at most 1000 keys", "got 9002"});
}

TEST_F(CliBudget, IsTheUsersToSet) {
  write_shared(10, 3000, true);  // 10 * (3000 * 24 + 1000 * 128) bytes
  good("darboux validate m.glb --max-memory 2000000");
  refused("darboux validate m.glb --max-memory 1999999", {"meshes[0].primitives[9]", "1.907 MiB of content"});
  good("darboux validate m.glb --max-memory 2MiB");
  refused("darboux validate m.glb --max-memory much", {"--max-memory"});
  refused("darboux validate m.glb --max-memory -1", {"--max-memory"});
}

}  // namespace
}  // namespace darboux::test::budget_test
