// `validate`, `compare` and `tangents` on FBX, COLLADA, PLY and STL, and on a glTF of two uv sets.
#include <darboux/io.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>

#include "cli.h"
#include "fbx_files.h"
#include "random_meshes.h"

namespace darboux::test::mesh_files_test {
namespace {

Mesh torus() {
  return sample_mesh(make_surface("torus"), {.columns = 32, .rows = 16});
}

class MeshFiles : public Cli {
 protected:
  void write(const std::string& name, const std::string& bytes) const { write_bytes(path(name), bytes); }
};

TEST_F(MeshFiles, ValidateAssessesEachFormat) {
  const Mesh mesh = torus();
  write("torus.fbx", FbxBinary::of(fbx_text(mesh), 7400));
  write("torus.dae", dae_text(mesh));
  write("torus.ply", ply_binary(mesh, true));
  for (const std::string name : {"torus.fbx", "torus.dae", "torus.ply"}) {
    SCOPED_TRACE(name);
    const Json assessed = only_mesh(json("darboux validate " + name + " --surface torus --json"));
    EXPECT_EQ(assessed["verdict"], "pass");
    EXPECT_EQ(assessed["corners"], mesh.corners());
    EXPECT_EQ(assessed["uv"]["convention"], "as stored");
    EXPECT_EQ(has_finding(assessed, "TANGENT_MISSING"), name == "torus.ply");
    EXPECT_EQ(assessed["handedness"]["convention"], name == "torus.ply" ? "none" : "gltf");
    EXPECT_LT(assessed["classes"]["interior"]["normal_deg"]["max"].get<double>(), 1e-4);
  }
  write("torus.stl", stl_binary(mesh));
  const Json stl = only_mesh(json("darboux validate torus.stl --json"));
  EXPECT_EQ(stl["verdict"], "nothing");
  EXPECT_EQ(stl["surface"]["name"], "torus");
  EXPECT_TRUE(has_finding(stl, "NORMAL_MISSING"));
  // A folder of them all.
  const Json all = json("darboux validate . --json");
  std::vector<std::string> names;
  for (const Json& file : all["files"]) names.push_back(fs::path(file["file"].get<std::string>()).filename());
  for (const char* name : {"torus.dae", "torus.fbx", "torus.ply", "torus.stl"})
    EXPECT_TRUE(std::find(names.begin(), names.end(), name) != names.end()) << name;
}

TEST_F(MeshFiles, NodesAndMissingFacesAreTold) {
  write("mirrored.fbx",
        fbx(fbx_geometry(torus(), "torus", 10) +
                fbx_model(20, "node", "P: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",1,1,-1\n"),
            "C: \"OO\",10,20\nC: \"OO\",20,0\n"));
  write("mirrored.dae", collada(collada_geometry(torus(), "torus"),
                                "<node><scale>1 1 -1</scale><instance_geometry url=\"#torus\"/></node>"));
  for (const std::string name : {"mirrored.fbx", "mirrored.dae"}) {
    const Json assessed = only_mesh(json("darboux validate " + name + " --json"));
    EXPECT_TRUE(has_finding(assessed, "NODE_MIRRORED")) << name;
    EXPECT_FALSE(has_finding(assessed, "NODE_SCALE_NOT_UNIFORM")) << name;
  }
  Mesh points = torus();
  points.triangles.clear();
  write("points.ply", ply_text(points));
  const std::string out = good("darboux validate points.ply");
  EXPECT_NE(out.find("holds no triangles to judge"), std::string::npos) << out;
  EXPECT_NE(out.find("its faces have no triangles"), std::string::npos) << out;
}

TEST_F(MeshFiles, CompareAndTangents) {
  const Mesh mesh = torus();
  write("a.fbx", fbx_text(mesh));
  write("b.dae", dae_text(mesh));
  write("c.ply", ply_text(mesh));
  const Json compared = json("darboux compare a.fbx b.dae --max-angle 0.001 --json");
  EXPECT_EQ(compared["same"], true);
  EXPECT_EQ(compared["pairs"][0]["matched"], mesh.corners());
  EXPECT_NE(good("darboux compare b.dae c.ply", 1).find("b has no tangents"), std::string::npos);
  for (const std::string name : {"a.fbx", "b.dae", "c.ply"})
    refused("darboux tangents " + name + " -o x.glb", {name, "glTF"});
  for (const std::string command : {"validate", "compare"})
    for (const std::string_view extension : asset_extensions())
      EXPECT_NE(good("darboux " + command + " --help").find(extension), std::string::npos) << extension;
}

TEST_F(MeshFiles, BrokenOnesAreRefusedInALine) {
  write("a.ply", ply_text(torus()).substr(0, 5000));
  write("a.stl", stl_binary(torus()).substr(0, 5000));
  write("a.dae", dae_text(torus()).substr(0, 5000));
  write("a.fbx", fbx_text(torus()).substr(0, 5000));
  // Nodes within each other, on which assimp ends its stack.
  write("b.fbx", fbx(fbx_geometry(torus(), "torus", 10) + fbx_model(20, "node"),
                     "C: \"OO\",10,20\nC: \"OO\",20,0\nC: \"OO\",20,20\n"));
  for (const std::string name : {"a.ply", "a.stl", "a.dae", "a.fbx", "b.fbx"})
    refused("darboux compare " + name + " data/torus_016.obj", {name, "expected"});
}

// Tangents along TEXCOORD_1 where the normal texture reads TEXCOORD_0.
TEST_F(MeshFiles, TangentsOfAnotherUvSetAreToldSo) {
  Mesh mesh = torus(), turned = mesh;
  for (Vec2<double>& uv : turned.uvs) uv = {0.7 * uv.x - 0.7 * uv.y, 0.7 * uv.x + 0.7 * uv.y};
  const MeshFrames frames = mesh_frames(turned, find_frame_method("mikktspace"));
  for (std::size_t c = 0; c < mesh.corners(); ++c) {
    const CornerFrame& f = frames.corner(c);
    mesh.tangents[mesh.triangles[c / 3][c % 3]] = {f.t.x, f.t.y, f.t.z, -f.sign};
  }
  write_glb(path("a.glb"), mesh, "torus");
  Glb glb = split_glb(read_bytes(path("a.glb")));
  const std::size_t begin = glb.bin.size();
  for (const Vec2<double>& uv : turned.uvs)
    glb.bin += pack({static_cast<float>(uv.x), static_cast<float>(uv.y)});
  glb.json["buffers"][0]["byteLength"] = glb.bin.size();
  glb.json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", glb.bin.size() - begin}});
  glb.json["accessors"].push_back({{"bufferView", glb.json["bufferViews"].size() - 1},
                                   {"componentType", 5126},
                                   {"count", mesh.uvs.size()},
                                   {"type", "VEC2"}});
  glb.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = glb.json["accessors"].size() - 1;
  // Without a material that names a set, tangents may follow any.
  write("a.glb", make_glb(glb.json.dump(), glb.bin));
  const Json any = only_mesh(json("darboux validate a.glb --json"));
  EXPECT_EQ(any["uv"]["texcoord"], 1);
  EXPECT_TRUE(has_finding(any, "TANGENT_UV_SET_USED"));
  glb.json["materials"] = {{{"normalTexture", {{"index", 0}}}}};
  glb.json["meshes"][0]["primitives"][0]["material"] = 0;
  write("a.glb", make_glb(glb.json.dump(), glb.bin));
  const Json assessed = only_mesh(json("darboux validate a.glb --json", 1));
  EXPECT_EQ(assessed["verdict"], "fail");
  EXPECT_TRUE(has_finding(assessed, "TANGENT_UV_SET"));
  EXPECT_NE(good("darboux validate a.glb", 1).find("MikkTSpace's of TEXCOORD_1"), std::string::npos);
}

TEST_F(MeshFiles, NormalMapsAtMissingUvSetsAreNamed) {
  write_glb(path("a.glb"), torus(), "torus");
  Glb glb = split_glb(read_bytes(path("a.glb")));
  glb.json["meshes"][0]["primitives"][0]["material"] = 0;
  for (const int set : {0, 2}) {
    glb.json["materials"] = {{{"normalTexture", {{"index", 0}, {"texCoord", set}}}}};
    write("a.glb", make_glb(glb.json.dump(), glb.bin));
    const Json assessed = only_mesh(json("darboux validate a.glb --json"));
    EXPECT_EQ(assessed["verdict"], "pass");
    EXPECT_EQ(has_finding(assessed, "UV_SET_MISSING"), set == 2);
  }
  EXPECT_NE(good("darboux validate a.glb").find("TEXCOORD_2"), std::string::npos);
}

TEST_F(MeshFiles, MorphTargetsAreNotJudged) {
  write_glb(path("a.glb"), torus(), "torus");
  EXPECT_FALSE(has_finding(only_mesh(json("darboux validate a.glb --json")), "MORPH_TARGETS_NOT_JUDGED"));
  Glb glb = split_glb(read_bytes(path("a.glb")));
  Json& primitive = glb.json["meshes"][0]["primitives"][0];
  const Json target{{"POSITION", primitive["attributes"]["POSITION"]}};
  primitive["targets"] = {target, target, target};
  write("a.glb", make_glb(glb.json.dump(), glb.bin));
  const Json assessed = only_mesh(json("darboux validate a.glb --json"));
  EXPECT_EQ(assessed["verdict"], "pass");
  std::size_t targets = 0;
  for (const Json& f : assessed["findings"])
    if (f["code"] == "MORPH_TARGETS_NOT_JUDGED") targets = f["count"];
  EXPECT_EQ(targets, 3u);
}

// A pass tells little of normals that there is nothing to compare with, and says so; not where the surface is
// known, where they are averages, or where there are none that can be seen.
TEST_F(MeshFiles, NormalsThatNothingIsKnownOfAreTold) {
  const auto is_told = [&](const Mesh& mesh, const std::string& options = "") {
    write_glb(path("mesh.glb"), mesh, "mesh");
    const Result r = sh("darboux validate mesh.glb " + options);
    return r.out.find("normals: at " + std::to_string(mesh.corners()) + " of ") != std::string::npos;
  };
  Mesh averages;
  test::add_grid(averages, 6, 1, [](double u, double v) { return test::on_ring(1, u, 3 * v); });
  averages = test::with_averaged_normals(averages);
  test::bake(averages);
  Mesh ring = averages, bare = averages, zero = averages;
  for (Vec3<double>& n : ring.normals) n = unit(Vec3<double>{n.x, 3 * n.y, n.z + 0.5});
  EXPECT_TRUE(is_told(ring));
  EXPECT_TRUE(is_told(ring, "--reference triangles"));
  EXPECT_TRUE(is_told(ring, "--reference mikktspace"));
  EXPECT_FALSE(is_told(ring, "--surface cylinder:radius=1,height=3"));
  EXPECT_FALSE(is_told(averages));
  bare.normals.clear();
  bare.tangents.clear();
  EXPECT_FALSE(is_told(bare));
  EXPECT_FALSE(is_told(bare, "--ignore NORMAL_MISSING"));
  zero.normals.assign(zero.normals.size(), {0, 0, 0});
  EXPECT_FALSE(is_told(zero));
  EXPECT_FALSE(is_told(torus()));
}

// One code may have another remedy in another case: each is told, and how many corners the triangles leave
// open.
TEST_F(MeshFiles, RemediesAndOpenCornersAreTold) {
  Mesh ring;  // of one row, so that all corners lie at borders; shaded smooth, and all tangents turned
  test::add_grid(ring, 6, 1, [](double u, double v) { return test::on_ring(1, u, 3 * v); });
  ring = test::with_averaged_normals(ring);
  test::bake(ring);
  for (std::size_t v = 0; v < ring.positions.size(); ++v) {
    const Vec3<double> t = ring.tangents[v].xyz(), b = cross(ring.normals[v], t), d = unit(t + b);
    ring.tangents[v] = {d.x, d.y, d.z, ring.tangents[v].w};
  }
  write_glb(path("ring.glb"), ring, "ring");
  const std::string open = "triangles: they cannot judge " + std::to_string(ring.corners()) + " corners";
  EXPECT_NE(good("darboux validate ring.glb --reference triangles", 1).find(open), std::string::npos);
  Mesh card, wedge;
  test::add_grid(card, 1, 1, [](double u, double v) { return Vec3<double>{u, 0, v}; });
  card.normals.assign(card.positions.size(), {0, 0, 1});
  write_glb(path("card.glb"), card, "card");
  test::add_grid(wedge, 4, 4, [](double u, double v) { return Vec3<double>{u, v, 0}; });
  wedge = test::with_averaged_normals(wedge);
  wedge.normals[12] = -wedge.normals[12];
  write_glb(path("wedge.glb"), wedge, "wedge");
  const std::string text = good("darboux validate card.glb wedge.glb --reference triangles", 1);
  EXPECT_NE(text.find("warning NORMAL_ANGLE: 6 in 1 file. To do: nothing, where cards"), std::string::npos)
      << text;
  EXPECT_NE(text.find("error NORMAL_ANGLE: 6 in 1 file. To do: transform normals"), std::string::npos)
      << text;
}

}  // namespace
}  // namespace darboux::test::mesh_files_test
