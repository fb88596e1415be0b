#include "assets/scene_of_gltf.h"

#include "io_files.h"
#include "refusal_of.h"

namespace darboux::test::scene_of_gltf_test {
namespace {

// A square of normal +z about the origin, and a camera at z = 5 that sees 2 x 2 there.
class GltfScenes : public ::testing::Test {
 protected:
  GltfScenes() {
    const std::size_t positions = b_.positions({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0});
    const std::size_t indices = b_.packed<std::uint16_t>("SCALAR", 5123, 6, {0, 1, 2, 0, 2, 3});
    b_.primitive({{"POSITION", positions}}, {{"indices", indices}});
    b_.json.update(Json::parse(R"({
      "materials": [{}],
      "cameras": [{"type": "perspective",
                   "perspective": {"yfov": 0.39479111969976155, "aspectRatio": 2, "znear": 0.1}},
                  {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 100}}],
      "nodes": [{"camera": 0, "name": "eye", "translation": [0, 0, 5]}, {"mesh": 0}],
      "scenes": [{"nodes": [0, 1]}]})"));
  }

  std::string path() const { return folder_ / "scene.glb"; }
  GltfScene scene(bool with_motion = false) const {
    write_bytes(path(), b_.glb());
    return scene_of_gltf(path(), {}, with_motion);
  }
  ScenePlan plan(std::size_t camera = 0) const {
    const GltfScene s = scene();
    return plan_scene(s.scene, s.cameras.at(camera).camera, {});
  }
  // What becomes of the square, moved or turned.
  std::string fate(const Json& placement, std::size_t camera = 0) {
    Json& node = b_.json["nodes"][1];
    node = {{"mesh", 0}};
    node.update(placement);
    const ScenePlan p = plan(camera);
    EXPECT_EQ(p.tiles_all, 1u);
    return p.tiles_needed == 1              ? "needed"
           : p.skipped.outside_frustum == 1 ? "outside"
           : p.skipped.back_facing == 1     ? "back"
                                            : "nothing";
  }

  Builder b_;
  TempFolder folder_;
};

TEST_F(GltfScenes, CamerasAreThoseOfTheNodes) {
  b_.json["nodes"][0]["children"] = {2};
  b_.json["nodes"].push_back({{"camera", 1}, {"scale", {2, 2, 2}}, {"rotation", {0, 1, 0, 0}}});
  const GltfScene s = scene();
  ASSERT_EQ(s.cameras.size(), 2u);
  const Camera &a = s.cameras[0].camera, &b = s.cameras[1].camera;
  EXPECT_EQ(s.cameras[0].name, "eye");
  EXPECT_EQ(a.width_px, 1280);
  EXPECT_EQ(a.height_px, 640);
  EXPECT_EQ(a.far_distance, std::numeric_limits<double>::infinity());
  EXPECT_EQ(a.pose.translation(), Eigen::Vector3d(0, 0, 5));
  EXPECT_EQ(b.projection, Camera::Projection::orthographic);
  EXPECT_EQ(b.view_height, 2);
  EXPECT_EQ(b.height_px, 1280);
  EXPECT_LT((b.pose.linear().col(2) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-15)
      << "turned about y, not scaled";
}

TEST_F(GltfScenes, PrimitivesAreSkippedAsAWhole) {
  EXPECT_EQ(fate({{"translation", {0, 0, 0}}}), "needed");
  // At z = 0 the view reaches to x = ±2, y = ±1.
  EXPECT_EQ(fate({{"translation", {2.99, 0, 0}}}), "needed");
  EXPECT_EQ(fate({{"translation", {3.01, 0, 0}}}), "outside");
  EXPECT_EQ(fate({{"translation", {0, -2.01, 0}}}), "outside");
  EXPECT_EQ(fate({{"translation", {0, 0, 4.91}}}), "outside") << "before the near plane";
  EXPECT_EQ(fate({{"rotation", {0, 1, 0, 0}}}), "back");
  EXPECT_EQ(fate({{"scale", {-1, 1, 1}}}), "needed") << "mirrored it shows the same side";
  EXPECT_EQ(fate({{"scale", {1, 1, -1}}}), "back") << "turned inside out";
  EXPECT_EQ(fate({{"scale", {1, 1, 0}}}), "needed") << "flat, its side is not known";
  // Turned to face +x, away from the eye. The ball about its box, of radius √2, decides.
  const Json quarter{0, 0.7071067811865476, 0, 0.7071067811865476};
  EXPECT_EQ(fate({{"rotation", quarter}, {"translation", {1.5, 0, 0}}}), "back");
  EXPECT_EQ(fate({{"rotation", quarter}, {"translation", {1.3, 0, 0}}}), "needed");
  EXPECT_EQ(fate({{"rotation", quarter}, {"translation", {-1.5, 0, 0}}}), "needed");
}

TEST_F(GltfScenes, FacingAlongParallelRays) {
  b_.json["nodes"][0]["camera"] = 1;
  EXPECT_EQ(fate(Json::object()), "needed");
  EXPECT_EQ(fate({{"rotation", {0, 1, 0, 0}}}), "back");
  EXPECT_EQ(fate({{"translation", {2.01, 0, 0}}}), "outside");
}

TEST_F(GltfScenes, WhatIsSeenFromBehindOrMovesIsKept) {
  const Json turned{{"rotation", {0, 1, 0, 0}}};
  Json& primitive = b_.json["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  EXPECT_EQ(fate(turned), "back");
  b_.json["materials"][0]["doubleSided"] = true;
  EXPECT_EQ(fate(turned), "needed");
  b_.json["materials"][0]["doubleSided"] = false;
  primitive["targets"] = Json::array({{{"POSITION", primitive["attributes"]["POSITION"]}}});
  EXPECT_EQ(fate(turned), "needed");
  EXPECT_EQ(fate({{"translation", {9, 0, 0}}}), "needed");
  EXPECT_EQ(plan().tiles_unbounded, 1u);
}

TEST_F(GltfScenes, MaterialsThatAreSeenThrough) {
  b_.json["meshes"][0]["primitives"][0]["material"] = 0;
  const auto material = [&](const char* json) {
    b_.json["materials"][0] = Json::parse(json);
    return scene().scene.materials.at(0);
  };
  EXPECT_FALSE(material("{}").see_through);
  EXPECT_FALSE(material(R"({"alphaMode": "OPAQUE"})").see_through);
  EXPECT_TRUE(material(R"({"alphaMode": "MASK"})").see_through);
  EXPECT_TRUE(material(R"({"alphaMode": "BLEND"})").see_through);
  b_.json["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_volume",
                               "KHR_materials_variants"};
  EXPECT_TRUE(
      material(R"({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0}}})").see_through)
      << "a factor may be animated";
  EXPECT_FALSE(material(R"({"extensions": {"KHR_materials_volume": {}}})").see_through);
  // Of variants any may be shown.
  b_.json["materials"].push_back({{"alphaMode", "BLEND"}});
  b_.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "glass"}}};
  b_.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}};
  EXPECT_TRUE(material("{}").see_through);
  EXPECT_FALSE(material("{}").double_sided);
  b_.json["materials"][1]["doubleSided"] = true;
  EXPECT_TRUE(material("{}").double_sided);
}

TEST_F(GltfScenes, WithoutACameraOneSeesAll) {
  b_.json["nodes"][0].erase("camera");
  b_.json["scenes"][0]["nodes"] = {1};
  const GltfScene s = scene();
  ASSERT_EQ(s.cameras.size(), 1u);
  EXPECT_EQ(s.cameras[0].name, "before the scene");
  EXPECT_EQ(fate({{"translation", {1e3, -50, 7}}}), "needed");
  EXPECT_EQ(fate({{"scale", {1e-5, 1e-5, 1e-5}}}), "needed");
}

// Whole pixels are never of a narrower view than the file's.
TEST_F(GltfScenes, NothingAtTheBorderOfTheViewIsLost) {
  for (const double aspect : {1.3, 1.7777778, 0.77, 800.0, 123.4}) {
    b_.json["cameras"][0]["perspective"]["aspectRatio"] = aspect;
    // At z = 0 the view reaches to x = ±aspect; the square's left side is one less.
    EXPECT_EQ(fate({{"translation", {1 + 0.9999 * aspect, 0, 0}}}), "needed") << aspect;
  }
}

TEST_F(GltfScenes, WhatAnAnimationMovesIsKept) {
  b_.json["animations"] =
      Json::parse(R"([{"channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
                                           "samplers": [{"input": 0, "output": 0}]}])");
  EXPECT_EQ(fate({{"translation", {500, 0, 0}}}), "needed");
  b_.json["animations"][0]["channels"][0]["target"]["node"] = 0;
  EXPECT_EQ(fate({{"translation", {500, 0, 0}}}), "outside");
}

TEST_F(GltfScenes, InstancesOfTheExtensionAreInstances) {
  Json& node = b_.json["nodes"][1];
  const std::size_t translations = b_.packed<float>("VEC3", 5126, 3, {0, 0, 0, 0.5f, 0, -1, 50, 0, 0});
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", translations}};
  b_.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  b_.json["materials"][0]["normalTexture"] = {{"index", 0}};
  b_.json["textures"] = Json::array({Json::object()});
  b_.json["meshes"][0]["primitives"][0]["material"] = 0;
  const ScenePlan p = plan();
  EXPECT_EQ(p.tiles_all, 3u);
  EXPECT_EQ(p.instances_needed, 2u);
  EXPECT_EQ(p.tiles_needed, 1u);
  EXPECT_EQ(p.skipped.duplicates, 1u);
  EXPECT_EQ(p.skipped.outside_frustum, 1u);
  EXPECT_EQ(p.samples_full, 12u);
  EXPECT_EQ(p.samples_needed, 4u);
  EXPECT_EQ(p.attribute_samples[static_cast<std::size_t>(Attribute::tangent4)], 4u);
  // Of different counts.
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = b_.positions({1, 1, 1});
  EXPECT_NE(refusal_of<FileError>([&] { scene(); }).find("expected an accessor of as many elements"),
            std::string::npos);
}

TEST_F(GltfScenes, ScenesThatNothingCanSeeAreRefused) {
  const auto expect = [&](const std::string& words) {
    const std::string message = refusal_of<FileError>([&] { scene(); });
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  const Builder good = b_;
  b_.json["nodes"][1]["children"] = {1};
  expect("expected trees of nodes");
  for (const double angle : {0.0, 3.2}) {
    b_ = good;
    b_.json["cameras"][0]["perspective"]["yfov"] = angle;
    expect("cameras[0]: field of view: expected");
  }
  b_ = good;
  b_.json["cameras"][0]["perspective"]["zfar"] = 0.1;
  expect("cameras[0]: camera: expected near < far");
  b_.json["cameras"][0]["perspective"]["aspectRatio"] = 0;
  expect("cameras[0]: expected a width over height");
}

// A node above the camera is moved in steps of all kinds, the camera's own turns.
TEST_F(GltfScenes, AnimationsMoveCameras) {
  EXPECT_FALSE(scene(true).motion);
  const auto add = [&](const char* type, std::size_t count, std::initializer_list<float> x) {
    return b_.packed<float>(type, 5126, count, x);
  };
  const std::size_t two = add("SCALAR", 2, {1, 3}), three = add("SCALAR", 3, {1, 2, 3});
  const std::size_t line = add("VEC3", 2, {0, 0, 0, 4, 0, 0});
  const std::size_t turn = add("VEC4", 2, {0, 0, 0, 1, 0, 1, 0, 0});
  const std::size_t steps = add("VEC3", 3, {0, 1, 0, 0, 2, 0, 0, 3, 0});
  // From 0 to 1 with a tangent of 1, as long as the step of 2: x = 2 (s³ - 2 s² + s) + 3 s² - 2 s³.
  const std::size_t curve = add("VEC3", 6, {9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 9, 9, 9});
  b_.json["nodes"][0].erase("translation");
  b_.json["nodes"].push_back({{"children", {0}}, {"translation", {0, 0, 5}}});
  b_.json["scenes"][0]["nodes"] = {2, 1};
  const auto motion = [&](std::size_t input, std::size_t output, const char* interpolation) {
    b_.json["animations"] =
        Json::array({{{"samplers",
                       {{{"input", two}, {"output", turn}},
                        {{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                      {"channels",
                       {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}},
                        {{"sampler", 1}, {"target", {{"node", 2}, {"path", "translation"}}}}}}}});
    const GltfScene s = scene(true);
    return s.motion.value();
  };
  const auto expect_at = [](const CameraMotion& m, double share, double x, double y, double z) {
    EXPECT_LT((m.at(share).pose.translation() - Eigen::Vector3d(x, y, z)).norm(), 1e-12)
        << share << ": " << m.at(share).pose.translation().transpose();
  };
  const CameraMotion linear = motion(two, line, "LINEAR");
  expect_at(linear, 0, 0, 0, 0);
  expect_at(linear, 0.25, 1, 0, 0);
  expect_at(linear, 1, 4, 0, 0);
  // Half a turn about y, after its half a quarter.
  const Eigen::Vector3d back = linear.at(0.5).pose.linear().col(2);
  EXPECT_LT((back - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12) << back.transpose();
  linear.at(0.5).check();
  EXPECT_EQ(linear.at(0.5).height_px, 640) << "the lens stays";
  const CameraMotion stepped = motion(three, steps, "STEP");
  expect_at(stepped, 0.49, 0, 1, 0);
  expect_at(stepped, 0.5, 0, 2, 0);
  expect_at(stepped, 1, 0, 3, 0);
  const CameraMotion cubic = motion(two, curve, "CUBICSPLINE");
  expect_at(cubic, 0.5, 2 * (0.125 - 0.5 + 0.5) + 0.75 - 0.25, 0, 0);
  expect_at(cubic, 0, 0, 0, 0);
  expect_at(cubic, 1, 1, 0, 0);
  const auto refused = [&](std::size_t input, std::size_t output, const char* interpolation) {
    return refusal_of<FileError>([&] { motion(input, output, interpolation); });
  };
  EXPECT_NE(refused(two, steps, "LINEAR").find("expected 2 elements for these keys, got 3"),
            std::string::npos);
  EXPECT_NE(refused(two, line, "BEZIER").find("expected LINEAR, STEP or CUBICSPLINE"), std::string::npos);
  EXPECT_NE(refused(two, turn, "LINEAR").find("expected an accessor of 3 components"), std::string::npos);
  EXPECT_NE(refused(add("SCALAR", 2, {3, 1}), line, "LINEAR").find("expected times that rise"),
            std::string::npos);
  EXPECT_NE(refused(add("SCALAR", 2, {1, 1}), line, "LINEAR").find("expected times that rise"),
            std::string::npos);
}

// What no scene reaches may be anything: it is nowhere above a camera.
TEST_F(GltfScenes, NodesThatNoSceneReachesMoveNoCamera) {
  const std::size_t times = b_.packed<float>("SCALAR", 5126, 2, {0, 1}),
                    line = b_.packed<float>("VEC3", 5126, 2, {0, 0, 5, 4, 0, 5});
  const auto keys_of = [&](int node) {
    b_.json["animations"] = Json::array(
        {{{"samplers", Json::array({{{"input", times}, {"output", line}}})},
          {"channels",
           Json::array({{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}})}}});
  };
  const Builder rest = b_;
  for (const char* others : {R"([{"children": [400000000]}])", R"([{"children": [3, 0]}, {"children": [2]}])",
                             R"([{"children": [0], "translation": [9, 9, 9]}])"}) {
    b_.json = rest.json;
    for (const Json& node : Json::parse(others)) b_.json["nodes"].push_back(node);
    keys_of(0);
    const GltfScene s = scene(true);
    ASSERT_TRUE(s.motion) << others;
    EXPECT_EQ(s.motion->at(1).pose.translation(), Eigen::Vector3d(4, 0, 5)) << others;
    keys_of(2);
    EXPECT_FALSE(scene(true).motion) << others;
  }
}

// Keys of the second camera, and a pointer that may move both.
TEST_F(GltfScenes, TheCameraThatMovesIsNamed) {
  const std::size_t times = b_.packed<float>("SCALAR", 5126, 2, {0, 1}),
                    line = b_.packed<float>("VEC3", 5126, 2, {0, 0, 5, 4, 0, 5});
  b_.json["nodes"].push_back({{"camera", 1}});
  b_.json["scenes"][0]["nodes"].push_back(2);
  const auto animations = [&](const char* channels) {
    b_.json["animations"] = Json::array({{{"samplers", Json::array({{{"input", times}, {"output", line}}})},
                                          {"channels", Json::parse(channels)}}});
  };
  const std::string pointer =
      R"({"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer":
         {"pointer": "/nodes/0/translation"}}}})";
  animations(("[" + pointer + "]").c_str());
  EXPECT_FALSE(scene(true).motion);
  animations(("[" + pointer + R"(, {"sampler": 0, "target": {"node": 2, "path": "translation"}}])").c_str());
  const GltfScene s = scene(true);
  ASSERT_TRUE(s.motion);
  EXPECT_EQ(s.moving_camera, 1u);
  EXPECT_EQ(s.motion->at(0).projection, Camera::Projection::orthographic);
}

}  // namespace
}  // namespace darboux::test::scene_of_gltf_test
