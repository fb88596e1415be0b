// `scene` against its contract.
#include <set>

#include "cli.h"

namespace darboux::test::scene_test {
namespace {

constexpr const char* examples = DARBOUX_SOURCE "/docs/examples/";

class SceneCli : public Cli {
 protected:
  SceneCli() {
    for (const char* name : {"scene.json", "asteroids.json"})
      fs::copy_file(std::string(examples) + name, path(name));
  }

  // A copy of scene.json with another value somewhere.
  void write_other(const std::string& pointer, const Json& value) const {
    Json json = Json::parse(read_bytes(path("scene.json")));
    json[Json::json_pointer(pointer)] = value;
    write_bytes(path("other.json"), json.dump());
  }
  void refused_with(const std::string& pointer, const Json& value,
                    const std::vector<std::string>& parts) const {
    write_other(pointer, value);
    refused("darboux scene other.json --render other.png -o other.glb", parts);
    EXPECT_FALSE(fs::exists(path("other.png")));
    EXPECT_FALSE(fs::exists(path("other.glb")));
  }
};

TEST_F(SceneCli, SaysWhatIsNeededAndWhatWasSkipped) {
  const Json report = json("darboux scene scene.json --json");
  EXPECT_EQ(keys(report),
            (std::vector<std::string>{"file", "camera", "instances", "needed", "skipped", "tiles_unbounded",
                                      "samples_full", "samples_evaluated", "seconds", "bounds"}));
  EXPECT_EQ(report["camera"]["name"], "standing");
  EXPECT_EQ(report["instances"], 10);
  const Json& needed = report["needed"];
  EXPECT_EQ(needed["instances"], 8) << "two are out of view";
  EXPECT_GT(needed["tiles"], 8);
  EXPECT_EQ(needed["samples"], report["samples_evaluated"]);
  EXPECT_EQ(needed["attributes"]["position"], needed["samples"]);
  EXPECT_EQ(keys(needed["attributes"]), (std::vector<std::string>{"position", "normal", "tangent4"}));
  EXPECT_LT(needed["attributes"]["tangent4"], needed["samples"]) << "plain materials read none";
  EXPECT_GT(needed["attributes"]["tangent4"], 0);
  EXPECT_EQ(keys(report["skipped"]),
            (std::vector<std::string>{"no_normal_map", "outside_frustum", "back_facing", "occluded",
                                      "below_error", "duplicates"}));
  EXPECT_GT(report["skipped"]["outside_frustum"], 0);
  EXPECT_GT(report["skipped"]["back_facing"], 0);
  EXPECT_LT(report["samples_evaluated"], report["samples_full"]);
  EXPECT_TRUE(report["seconds"]["full"].is_null());
  EXPECT_GT(report["seconds"]["plan"], 0);
  EXPECT_TRUE(report["bounds"]["chord"].is_null());
  EXPECT_EQ(report["bounds"]["chord_px"], 0.1);
  EXPECT_NEAR(report["bounds"]["angle_deg"].get<double>(), 2, 1e-12);

  // The same numbers for people.
  const std::string text = good("darboux scene scene.json");
  EXPECT_NE(text.find("camera 0 (standing), 960 x 540 pixels: 8 of 10 instances are needed"),
            std::string::npos);
  EXPECT_NE(text.find(needed["tiles"].dump() + " "), std::string::npos) << text;
  EXPECT_NE(text.find("facing away"), std::string::npos) << text;
  EXPECT_EQ(good("darboux scene scene.json --quiet"), "");
}

TEST_F(SceneCli, OptionsStandInForTheFilesBounds) {
  const auto samples = [&](const std::string& options) {
    return json("darboux scene scene.json --json " + options)["samples_evaluated"].get<int>();
  };
  EXPECT_LT(samples("--chord 4px --angle 20"), samples("--chord 1px --angle 20deg"));
  EXPECT_LT(samples("--chord 0.1 --angle 20deg"), samples("--chord 0.001 --angle 20deg"));
  EXPECT_LT(samples("--chord 99px --angle 20deg"), samples("--chord 99px --angle 1deg"));
  const Json bounds = json("darboux scene scene.json --json --chord 0.01 --angle 3deg")["bounds"];
  EXPECT_EQ(bounds["chord"], 0.01);
  EXPECT_TRUE(bounds["chord_px"].is_null());
  EXPECT_NEAR(bounds["angle_deg"].get<double>(), 3, 1e-12);
  EXPECT_EQ(json("darboux scene scene.json --camera 1 --json")["camera"]["projection"], "orthographic");
}

TEST_F(SceneCli, TheAsteroidsNeedATwentiethOfTheSamples) {
  const Json report = json("darboux scene asteroids.json --json");
  EXPECT_EQ(report["instances"], 1000);
  EXPECT_LT(18 * report["samples_evaluated"].get<double>(), report["samples_full"].get<double>());
}

// The picture is the proof.
TEST_F(SceneCli, ThePictureIsTheSameWithAndWithoutWhatIsSkipped) {
  for (const std::string camera : {"0", "1"}) {
    const std::string start = "darboux scene scene.json --camera " + camera;
    const Json culled = json(start + " --render culled.png --json");
    const Json all = json(start + " --no-cull --render all.png --json");
    EXPECT_EQ(all["needed"], culled["needed"]);
    EXPECT_LT(culled["samples_evaluated"], all["samples_evaluated"]);
    const std::string png = read_bytes(path("culled.png"));
    EXPECT_EQ(png.substr(1, 3), "PNG");
    EXPECT_EQ(png, read_bytes(path("all.png"))) << "camera " << camera;
  }
  const Json full = json("darboux scene scene.json --no-skip --json");
  EXPECT_GE(full["samples_evaluated"], full["samples_full"]) << "tiles share their edges";
  EXPECT_GT(full["seconds"]["full"], 0);
}

TEST_F(SceneCli, DrawsWhatWasSkipped) {
  good("darboux scene scene.json --render-skipped skipped.png --quiet");
  EXPECT_EQ(read_bytes(path("skipped.png")).substr(1, 3), "PNG");
}

TEST_F(SceneCli, WritesWhatMaterialsLetSee) {
  write_other("/materials/thin/see_through", true);
  good("darboux scene other.json -o tiles.glb --quiet");
  const Json file = split_glb(read_bytes(path("tiles.glb"))).json;
  std::set<std::string> names;
  for (const Json& material : file["materials"]) {
    const std::string name = material["name"];
    names.insert(name);
    EXPECT_EQ(material.contains("doubleSided"), name == "thin");
    EXPECT_EQ(material.value("alphaMode", "OPAQUE"), name == "thin" ? "BLEND" : "OPAQUE");
  }
  EXPECT_EQ(names, (std::set<std::string>{"plain", "bumpy", "thin"}));
}

TEST_F(SceneCli, WritesTheTilesThatAreNeeded) {
  const Json report = json("darboux scene scene.json -o tiles.glb --json");
  const Json file = split_glb(read_bytes(path("tiles.glb"))).json;
  EXPECT_EQ(file["meshes"].size(), report["needed"]["tiles"]) << "one material per surface here, and tile";
  EXPECT_GE(file["nodes"].size(), file["meshes"].size());
  std::size_t vertices = 0;
  for (const Json& mesh : file["meshes"]) {
    const Json& primitive = mesh["primitives"][0];
    const Json& attributes = primitive["attributes"];
    expect_keys(attributes, {"POSITION", "NORMAL", "TEXCOORD_0"});
    const bool bumpy = file["materials"][primitive["material"].get<std::size_t>()]["name"] == "bumpy";
    EXPECT_EQ(attributes.contains("TANGENT"), bumpy);
    vertices += file["accessors"][attributes["POSITION"].get<std::size_t>()]["count"].get<std::size_t>();
  }
  EXPECT_EQ(vertices, report["needed"]["samples"]);
  // Without culling, the others too, and each once.
  good("darboux scene scene.json --no-skip -o all.glb --quiet");
  const Json all = split_glb(read_bytes(path("all.glb"))).json;
  EXPECT_GE(all["nodes"].size(), report["instances"]) << "every instance, seen or not";
  EXPECT_EQ(all["nodes"].size(), all["meshes"].size()) << "no duplicates are looked for";
  std::set<std::string> placed;
  for (const Json& node : all["nodes"])
    placed.insert(node["name"].get<std::string>() + " " +
                  all["meshes"][node["mesh"].get<std::size_t>()]["name"].get<std::string>());
  EXPECT_EQ(placed.size(), all["nodes"].size());
  // What was written is read, and its frames are what `validate` knows of each surface.
  good("darboux plan tiles.glb");
  EXPECT_EQ(good("darboux scene scene.json -o - | cmp - tiles.glb"), "");
}

// A path of cameras is what its cameras are one by one, and evaluates what the one before had not.
TEST_F(SceneCli, PlansAPathOfCameras) {
  Json scene = Json::parse(read_bytes(path("asteroids.json")));
  Json second = scene["cameras"][0];
  second["eye"] = {0.4, 0, 0};
  second["target"] = {1.4, 0.1, 0};
  scene["cameras"].push_back(second);
  write_bytes(path("path.json"), scene.dump());
  const Json along = json("darboux scene path.json --path 5 --json");
  ASSERT_EQ(along["path"].size(), 5u);
  const Json first = json("darboux scene path.json --json"),
             last = json("darboux scene path.json --camera 1 --json");
  std::uint64_t tiles = 0, samples = 0, fresh = 0;
  for (const Json& frame : along["path"]) {
    tiles += frame["tiles"].get<std::uint64_t>();
    samples += frame["samples"].get<std::uint64_t>();
    fresh += frame["samples_new"].get<std::uint64_t>();
  }
  for (const auto& [report, frame] : {std::pair(first, along["path"][0]), std::pair(last, along["path"][4])})
    for (const char* key : {"instances", "tiles", "samples"})
      EXPECT_EQ(report["needed"][key], frame[key]) << key;
  EXPECT_EQ(along["path"][0]["samples_new"], first["samples_evaluated"]);
  EXPECT_EQ(along["needed"]["tiles"], tiles);
  EXPECT_EQ(along["needed"]["samples"], samples);
  EXPECT_EQ(along["samples_evaluated"], fresh);
  EXPECT_LT(fresh, samples / 2) << "most is kept";
  EXPECT_NE(good("darboux scene path.json --path 5").find("5 cameras of a path"), std::string::npos);

  refused("darboux scene path.json --path 1", {"--path", "at least 2 cameras", "got 1"});
  refused("darboux scene path.json --path 0", {"--path", "at least 2 cameras", "got 0"});
  refused("darboux scene path.json --path 3 --render a.png", {"--path", "--render"});
  refused("darboux scene asteroids.json --path 3", {"--path", "at least two cameras", "got one"});
  refused("darboux scene scene.json --path 3", {"camera path", "cameras of one projection"});
}

TEST_F(SceneCli, PlansThePrimitivesOfAGltf) {
  Builder b = one_triangle();
  b.json["cameras"] =
      Json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}});
  b.json["nodes"] = Json::array({{{"camera", 0}, {"translation", {0, 0, 5}}},
                                 {{"mesh", 0}},
                                 {{"mesh", 0}, {"translation", {0, 0, 9}}},
                                 {{"mesh", 0}, {"rotation", {0, 1, 0, 0}}}});
  b.json["scenes"] = Json::array({{{"nodes", {0, 1, 2, 3}}}});
  write_bytes(path("made.glb"), b.glb());
  const Json report = json("darboux scene made.glb --json");
  EXPECT_EQ(keys(report), keys(json("darboux scene scene.json --json")));
  EXPECT_EQ(report["needed"]["tiles"], 1);
  EXPECT_EQ(report["skipped"]["outside_frustum"], 1) << "behind the camera";
  EXPECT_EQ(report["skipped"]["back_facing"], 1);
  EXPECT_EQ(report["samples_full"], 9);
  EXPECT_EQ(report["needed"]["attributes"]["tangent4"], 0);
  EXPECT_TRUE(report["seconds"]["needed"].is_null());
  EXPECT_NE(good("darboux scene made.glb").find("1 of 3 instances are needed"), std::string::npos);
  refused("darboux scene made.glb --render a.png", {"--render", "JSON"});
  refused("darboux scene made.glb --camera 1", {"--camera"});
  refused("darboux scene made.glb --path 3",
          {"--path", "at least two cameras, or a glTF with one that an animation moves, got one"});
  EXPECT_NE(good("darboux scene data/torus_016.none.glb").find("before the scene"), std::string::npos);
  // A path to a second camera, from which the triangle behind the first is seen.
  Builder two = b;
  two.json["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 15}}});
  two.json["scenes"][0]["nodes"].push_back(4);
  write_bytes(path("two.glb"), two.glb());
  const Json along = json("darboux scene two.glb --path 3 --json");
  ASSERT_EQ(along["path"].size(), 3u);
  EXPECT_EQ(along["path"][0]["instances"], 1);
  EXPECT_EQ(along["path"][2]["instances"], 2);
  EXPECT_EQ(along["path"][2]["samples_new"], 0);
  EXPECT_EQ(along["needed"]["tiles"], 3);
  EXPECT_EQ(along["samples_full"], 27);
  EXPECT_TRUE(along["seconds"]["needed"].is_null());
  EXPECT_EQ(good("darboux scene two.glb --path 3").find("evaluated"), std::string::npos);
  // The first without a far plane: it ends where the second is.
  two.json["cameras"].push_back(two.json["cameras"][0]);
  two.json["cameras"][1]["perspective"]["zfar"] = 100;
  two.json["nodes"][4]["camera"] = 1;
  write_bytes(path("far.glb"), two.glb());
  EXPECT_EQ(json("darboux scene far.glb --path 3 --json")["needed"], along["needed"]);
  // One camera that an animation moves there and further.
  Builder moving = b;
  const std::size_t times = moving.packed<float>("SCALAR", 5126, 2, {0, 1}),
                    places = moving.packed<float>("VEC3", 5126, 2, {0, 0, 5, 0, 0, 15});
  moving.json["animations"] = Json::array(
      {{{"samplers", Json::array({{{"input", times}, {"output", places}}})},
        {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})}}});
  write_bytes(path("moving.glb"), moving.glb());
  EXPECT_EQ(json("darboux scene moving.glb --path 3 --json")["needed"], along["needed"]);
  // One before it that stays. The report names the one that moves.
  moving.json["nodes"][0]["name"] = "rider";
  moving.json["nodes"].push_back({{"camera", 0}, {"name", "post"}, {"translation", {0, 0, 5}}});
  moving.json["scenes"][0]["nodes"] = {4, 0, 1, 2, 3};
  write_bytes(path("second.glb"), moving.glb());
  const Json second = json("darboux scene second.glb --path 3 --json");
  EXPECT_EQ(second["needed"], along["needed"]);
  EXPECT_EQ(second["camera"]["index"], 1);
  EXPECT_EQ(second["camera"]["name"], "rider");
  // Scaled to nothing at its end, where it has no axes.
  Builder shrinking = moving;
  const std::size_t scales = shrinking.packed<float>("VEC3", 5126, 2, {1, 1, 1, 0, 0, 0});
  shrinking.json["animations"][0]["samplers"][0]["output"] = scales;
  shrinking.json["animations"][0]["channels"][0]["target"]["path"] = "scale";
  write_bytes(path("shrinking.glb"), shrinking.glb());
  refused("darboux scene shrinking.glb --path 3",
          {"shrinking.glb: camera 2 of the path: camera pose: expected finite numbers"});
  b.json["nodes"][1]["children"] = {1};
  write_bytes(path("cyclic.glb"), b.glb());
  refused("darboux scene cyclic.glb", {"cyclic.glb", "its own ancestor"});
}

TEST_F(SceneCli, RefusesBadScenes) {
  refused_with("/instances/3/scale", 0, {"other.json: /instances/3/scale: expected", "got 0"});
  refused_with("/instances/3/scael", 1, {"other.json: /instances/3/scael: expected one of the keys"});
  refused_with("/surfaces/ring", "tarus", {"/surfaces/ring: ", "tarus", "torus"});
  refused_with("/cameras/0/perspective/vertical_field_of_view_deg", 180,
               {"/vertical_field_of_view_deg: expected"});
  refused_with("/cameras/0/perspective/vertical_field_of_view_deg", 0,
               {"/vertical_field_of_view_deg: expected"});
  refused_with("/cameras/0/perspective/near", 100,
               {"/cameras/0/perspective/far: expected a number above 100"});
  refused_with("/cameras/0/width_px", 0, {"/cameras/0/width_px: expected an integer from 1"});
  refused_with("/request/chord_px", 0, {"/request/chord_px: expected a number above 0, got 0"});
  refused_with("/request/angle_deg", -1, {"/request/angle_deg: expected a number above 0, got -1"});
  refused_with("/scatter", {{"count", 10000000}, {"nearest_radii", 1}, {"farthest_radii", 2}},
               {"/scatter/count: expected at most 10000000 instances in all, got 10000010"});
  // On the equator of the ball, whose centre it is 0.6 from, and within it.
  refused_with("/cameras/0/eye", {3.2, 0.5, 0.2},
               {"other.json: /cameras/0/eye: expected", "on instance 5, a sphere"});
  refused_with("/cameras/0/eye", {2.7, 0.5, 0.2},
               {"other.json: /cameras/0/eye: expected", "inside instance 5, a sphere"});
}

TEST_F(SceneCli, RefusesBadArguments) {
  refused("darboux scene", {"FILE"});
  refused("darboux scene none.json", {"none.json"});
  refused("darboux scene scene.json --camera 2", {"--camera", "2 cameras"});
  for (const char* chord : {"0", "-1px", "px", "1em", "inf", "nan"})
    refused(std::string("darboux scene scene.json --chord=") + chord, {"--chord"});
  for (const char* angle : {"0", "-1deg", "deg", "1rad"})
    refused(std::string("darboux scene scene.json --angle=") + angle, {"--angle"});
  refused("darboux scene scene.json -o tiles.gltf", {"tiles.gltf"});
  refused("darboux scene scene.json --no-skip --no-cull");
  refused("darboux scene scene.json --render - --json", {"standard output"});
  refused("darboux scene scene.json --render a.png --render-skipped a.png", {"a.png"});
  // What is read is not written to, and nothing is left of a run that fails.
  const std::string before = read_bytes(path("scene.json"));
  refused("darboux scene scene.json --render scene.json", {"scene.json"});
  EXPECT_EQ(read_bytes(path("scene.json")), before);
  refused("darboux scene scene.json --render a.png -o none/tiles.glb", {"none/tiles.glb"});
  EXPECT_FALSE(fs::exists(path("a.png")));
}

}  // namespace
}  // namespace darboux::test::scene_test
