// Files that ask for much more than they hold: refused before it is allocated, by what asked for how much.
#include "cli.h"

namespace darboux::test {
namespace {

class CliBudget : public Cli {
 protected:
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
    return sh("ulimit -v 2000000; darboux " + command);
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

TEST_F(CliBudget, SoDoInstances) {
  Builder b = one_triangle();
  for (int i = 1; i < 3000; ++i) b.primitive(b.json["meshes"][0]["primitives"][0]["attributes"]);
  b.json["nodes"] = Json::array();
  for (int i = 0; i < 100000; ++i) b.json["nodes"].push_back({{"mesh", 0}});
  write_bytes(path("m.glb"), b.glb());
  expect_refused_by_budget("its instances");
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
  write_shared(10, 3000, true);  // 10 * (3000 * 24 + 1000 * 12) bytes
  good("darboux validate m.glb --max-memory 840000");
  refused("darboux validate m.glb --max-memory 839999", {"meshes[0].primitives[9]", "0.8011 MiB of content"});
  good("darboux validate m.glb --max-memory 2MiB");
  refused("darboux validate m.glb --max-memory much", {"--max-memory"});
  refused("darboux validate m.glb --max-memory -1", {"--max-memory"});
}

}  // namespace
}  // namespace darboux::test
