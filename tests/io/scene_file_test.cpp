#include "io/scene_file.h"

#include <numbers>

#include "io_files.h"
#include "refusal_of.h"

namespace darboux::test::scene_file_test {
namespace {

using io::SceneFile;

class SceneFiles : public ::testing::Test {
 protected:
  SceneFile read(const std::string& text) const { return io::read_scene_file(write_bytes(path(), text)); }
  SceneFile read(const Json& json) const { return read(json.dump()); }

  // The refusal, without the name of the file that begins it.
  std::string refusal(const std::string& text) const {
    const std::string message = refusal_of<FileError>([&] { read(text); });
    const std::string start = path() + ": ";
    EXPECT_EQ(message.rfind(start, 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(std::min(message.size(), start.size()));
  }
  // The same of a small good scene, a value of which is another.
  std::string refusal(const std::string& pointer, const Json& value) const {
    Json json = small();
    json[Json::json_pointer(pointer)] = value;
    return refusal(json.dump());
  }

  static Json small() {
    return Json::parse(R"({
      "surfaces": {"ball": "sphere:radius=2", "ring": "torus"},
      "materials": {"plain": {}, "bumpy": {"normal_map": true}},
      "cameras": [{"perspective": {"vertical_field_of_view_deg": 60, "near": 0.1, "far": 100},
                   "eye": [9, 0, 0], "target": [0, 0, 0]}],
      "instances": [{"surface": "ball"}, {"surface": "ring", "material": "bumpy"}],
      "scatter": {"count": 5, "nearest_radii": 2, "farthest_radii": 200},
      "request": {}})");
  }

  std::string path() const { return folder_ / "scene.json"; }
  TempFolder folder_;
};

TEST_F(SceneFiles, MaterialsSayWhatIsSeenThrough) {
  Json json = small();
  json["materials"]["plain"]["see_through"] = true;
  const SceneFile file = read(json.dump());
  for (const SceneMaterial& m : file.scene.materials) EXPECT_EQ(m.see_through, m.name == "plain") << m.name;
  EXPECT_NE(refusal("/materials/plain/see_through", 1).find("/materials/plain/see_through"),
            std::string::npos);
}

TEST_F(SceneFiles, AreReadWhole) {
  const SceneFile file = io::read_scene_file(std::string(DARBOUX_SOURCE) + "/docs/examples/scene.json");
  ASSERT_EQ(file.surface_names, (std::vector<std::string>{"ring", "ball", "column", "shell", "floor"}));
  EXPECT_EQ(file.scene.surfaces[0].specification(), "torus:major_radius=1,minor_radius=0.4");
  ASSERT_EQ(file.scene.materials.size(), 3u);
  EXPECT_TRUE(file.scene.materials[1].normal_map);
  EXPECT_TRUE(file.scene.materials[2].double_sided);
  EXPECT_FALSE(file.scene.materials[0].reads_tangents());
  ASSERT_EQ(file.scene.instances.size(), 10u);
  // Half a turn would do: y becomes z.
  const Eigen::Affine3d& turned = file.scene.instances[2].placement;
  EXPECT_LT((turned * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(-1.5, -0.5, 2.6)).norm(), 1e-7)
      << "8 digits of √½";
  EXPECT_EQ(file.scene.instances[6].placement.linear().diagonal(), Eigen::Vector3d(0.7, 0.7, 0.7));
  ASSERT_EQ(file.cameras.size(), 2u);
  const Camera& standing = file.cameras[0].camera;
  EXPECT_EQ(file.cameras[0].name, "standing");
  EXPECT_EQ(standing.vertical_field_of_view_rad, 40 * (std::numbers::pi / 180));
  EXPECT_EQ(standing.width_px, 960);
  EXPECT_EQ(standing.pose.translation(), Eigen::Vector3d(7, -6, 3.5));
  EXPECT_EQ(file.cameras[1].camera.projection, Camera::Projection::orthographic);
  EXPECT_EQ(file.cameras[1].camera.view_height, 9);
  EXPECT_EQ(file.request.chord_px, 0.1);
  EXPECT_EQ(file.request.frame_angle_rad, 2 * (std::numbers::pi / 180));
  EXPECT_EQ(file.request.attributes, Attribute::position | Attribute::normal | Attribute::tangent4);
}

TEST_F(SceneFiles, WhatIsMissingHasDefaults) {
  Json json = small();
  SceneFile file = read(json);
  EXPECT_EQ(file.request.chord_px, 0.5);
  EXPECT_EQ(file.request.frame_angle_rad, std::numbers::pi / 180);
  EXPECT_EQ(file.cameras[0].camera.width_px, 1280);
  ASSERT_EQ(file.scene.materials.size(), 3u);
  EXPECT_EQ(file.scene.instances[0].material, 2u) << "one that reads the normal alone";
  EXPECT_EQ(file.scene.instances[1].material, 1u);
  // A length instead of pixels, unless both are asked for.
  json["request"]["chord"] = 0.01;
  file = read(json);
  EXPECT_EQ(file.request.chord, 0.01);
  EXPECT_EQ(file.request.chord_px, std::numeric_limits<double>::infinity());
  json["request"]["chord_px"] = 2;
  EXPECT_EQ(read(json).request.chord_px, 2);
}

TEST_F(SceneFiles, PlacementsAreThoseOfGltf) {
  Json json = small();
  json["instances"][0]["matrix"] = {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1};
  const Eigen::Affine3d placed = read(json).scene.instances[0].placement;
  EXPECT_EQ(placed * Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(5, 8, 7));
  // First the scale, then the rotation.
  json["instances"][1].update({{"scale", {1, 2, -3}}, {"rotation", {0, 0, 1, 0}}});
  EXPECT_EQ(read(json).scene.instances[1].placement * Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(-1, -2, -3));
}

TEST_F(SceneFiles, ScatteredInstancesAreTheSameEverywhere) {
  const SceneFile file = io::read_scene_file(std::string(DARBOUX_SOURCE) + "/docs/examples/asteroids.json");
  const auto& instances = file.scene.instances;
  ASSERT_EQ(instances.size(), 1000u);
  std::array<int, 3> of_material{}, of_surface{};
  std::array<int, 9> of_both{};
  std::array<int, 4> of_octave{};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), sum_of_turned = sum;
  for (const SceneInstance& i : instances) {
    ++of_material[i.material];
    ++of_surface[i.surface];
    ++of_both[3 * i.surface + i.material];
    const double distance = i.placement.translation().norm();
    EXPECT_GE(distance, 2 * (1 - 1e-15));
    EXPECT_LE(distance, 200 * (1 + 1e-15));
    ++of_octave[std::min(3, static_cast<int>(2 * std::log10(distance / 2)))];
    sum += i.placement.translation() / distance;
    sum_of_turned += i.placement.linear().col(0);
    EXPECT_LT((i.placement.linear() * i.placement.linear().transpose() - Eigen::Matrix3d::Identity()).norm(),
              1e-14);
    EXPECT_GT(i.placement.linear().determinant(), 0);
  }
  EXPECT_EQ(of_material, (std::array{334, 333, 333}));
  EXPECT_EQ(of_surface, (std::array{334, 333, 333}));
  for (const int n : of_both) EXPECT_NEAR(n, 111, 1);
  // Each of four shells has a quarter: 250, σ = 13.7. The mean direction has σ = √1000 in all.
  for (const int n : of_octave) EXPECT_NEAR(n, 250, 5 * 13.7);
  EXPECT_LT(sum.norm(), 5 * std::sqrt(1000.0));
  EXPECT_LT(sum_of_turned.norm(), 5 * std::sqrt(1000.0));
  // The first number of seed 7 by the published algorithm, in Python: (z ^ z >> 31) >> 11.
  EXPECT_DOUBLE_EQ(instances[0].placement.translation().norm(),
                   2 * std::pow(100, 3511274219185729 * 0x1p-53));
}

TEST_F(SceneFiles, SayWhereTheyAreWrong) {
  EXPECT_EQ(refusal("/surfaces/ball", "sphare").rfind("/surfaces/ball: sphare: unknown surface", 0), 0u)
      << refusal("/surfaces/ball", "sphare");
  EXPECT_NE(refusal("/surfaces/ball", "sphere:radius=-1").find("/surfaces/ball: sphere: radius: expected"),
            std::string::npos);
  EXPECT_EQ(refusal("/surfaces/ball", 3), "/surfaces/ball: expected a text, got 3");
  EXPECT_EQ(refusal("/surfaces", Json::object()), "/surfaces: expected at least one surface, got none");
  EXPECT_EQ(refusal("/surfaces/a~1b", "x").rfind("/surfaces/a~1b: ", 0), 0u);
  EXPECT_EQ(
      refusal("/sceen", 1),
      "/sceen: expected one of the keys $schema, surfaces, materials, cameras, instances, scatter, request, "
      "got an unknown one");
  EXPECT_EQ(
      refusal("/instances/1/scael", 1),
      "/instances/1/scael: expected one of the keys surface, material, translation, rotation, scale, matrix, "
      "got an unknown one");
  EXPECT_EQ(refusal("/instances/1/surface", "bull"),
            "/instances/1/surface: expected one of the surfaces ball, ring, got \"bull\"");
  EXPECT_EQ(refusal("/instances/1/material", "red"),
            "/instances/1/material: expected one of the materials bumpy, plain, got \"red\"");
  EXPECT_EQ(refusal("/instances/1", 5), "/instances/1: expected an object, got 5");
  EXPECT_EQ(refusal("/materials/plain/normal_map", 1),
            "/materials/plain/normal_map: expected true or false, got 1");
  EXPECT_EQ(refusal("/materials/plain/displacement", -1),
            "/materials/plain/displacement: expected a number not below 0, got -1");
}

TEST_F(SceneFiles, RefuseCamerasThatSeeNothing) {
  const std::string lens = "/cameras/0/perspective";
  for (const double angle : {0.0, 180.0, -10.0, 360.0})
    EXPECT_EQ(
        refusal(lens + "/vertical_field_of_view_deg", angle)
            .rfind(lens + "/vertical_field_of_view_deg: expected a number above 0 and below 180, got ", 0),
        0u);
  EXPECT_EQ(refusal(lens + "/near", 0), lens + "/near: expected a number above 0, got 0");
  EXPECT_EQ(refusal(lens + "/near", 100), lens + "/far: expected a number above 100, got 100");
  EXPECT_EQ(refusal("/cameras/0/width_px", 0),
            "/cameras/0/width_px: expected an integer from 1 to 65535, got 0");
  EXPECT_EQ(refusal("/cameras/0/height_px", 1.5),
            "/cameras/0/height_px: expected an integer from 1 to 65535, got 1.5");
  EXPECT_EQ(refusal("/cameras/0/target", {9, 0, 0}).rfind("/cameras/0: camera target: expected ", 0), 0u);
  EXPECT_EQ(refusal("/cameras/0/up", {1, 0, 0}).rfind("/cameras/0: camera up: expected ", 0), 0u);
  EXPECT_EQ(refusal("/cameras/0/orthographic", Json::object()),
            "/cameras/0: expected either perspective or orthographic, got both");
  EXPECT_EQ(refusal("/cameras", Json::array()), "/cameras: expected at least one camera, got none");
}

TEST_F(SceneFiles, RefusePlacementsThatCannotBeUndone) {
  const std::string at = "/instances/0";
  EXPECT_EQ(refusal(at + "/scale", 0),
            at + "/scale: expected numbers other than 0, none 1e12 times another, got 0");
  EXPECT_EQ(refusal(at + "/scale", {1, 0, 1}),
            at + "/scale: expected numbers other than 0, none 1e12 times another, got [1,0,1]");
  EXPECT_EQ(refusal(at + "/scale", "big"),
            at + "/scale: expected a number or an array of 3 numbers, got \"big\"");
  EXPECT_EQ(refusal(at + "/translation", {1, 2}),
            at + "/translation: expected an array of 3 numbers, got one of 2");
  EXPECT_EQ(refusal(at + "/translation", {1, 2, nullptr}),
            at + "/translation/2: expected a number, got null");
  EXPECT_EQ(refusal(at + "/rotation", {0, 0, 0, 2}),
            at + "/rotation: expected a quaternion x, y, z, w of length 1, got one of length 2");
  EXPECT_EQ(refusal(at + "/matrix", {1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}),
            at + "/matrix: expected an invertible matrix, got a singular one");
  EXPECT_EQ(refusal(at + "/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}),
            at + "/matrix: expected a matrix by columns, whose last row is 0 0 0 1, got another row");
  Json json = small();
  json["instances"][0]["scale"] = 2;
  json["instances"][0]["matrix"] = 1;
  EXPECT_EQ(refusal(json.dump()), at + "/scale: expected no other placement beside a matrix, got scale");
}

TEST_F(SceneFiles, RefuseBoundsThatNothingKeeps) {
  for (const char* key : {"chord_px", "chord", "angle_deg"})
    for (const double bound : {0.0, -1.0})
      EXPECT_EQ(refusal(std::string("/request/") + key, bound)
                    .rfind(std::string("/request/") + key + ": expected a number above 0, got ", 0),
                0u);
  EXPECT_EQ(refusal("/request/attributes", Json::array()),
            "/request/attributes: expected at least one attribute, got none");
  EXPECT_EQ(refusal("/request/attributes", {"colour"})
                .rfind("/request/attributes/0: expected one of the attributes position, dpdu, ", 0),
            0u);
}

TEST_F(SceneFiles, RefuseMoreInstancesThanMemoryHolds) {
  EXPECT_EQ(refusal("/scatter/count", 10000000),
            "/scatter/count: expected at most 10000000 instances in all, got 10000002");
  EXPECT_EQ(refusal("/scatter/count", 0), "/scatter/count: expected an integer not below 1, got 0");
  EXPECT_EQ(refusal("/scatter/farthest_radii", 1),
            "/scatter/farthest_radii: expected a number not below nearest_radii, 2, got 1");
  EXPECT_EQ(refusal("/scatter/surfaces", {"cube"}),
            "/scatter/surfaces/0: expected one of the surfaces ball, ring, got \"cube\"");
  Json json = small();
  json.erase("scatter");
  json.erase("instances");
  EXPECT_EQ(refusal(json.dump()), "expected instances or scatter, got neither");
  // A hole of 200 MB.
  write_bytes(path(), "{");
  std::filesystem::resize_file(path(), 200000000);
  EXPECT_NE(
      refusal_of<FileError>([&] { io::read_scene_file(path()); }).find("expected at most 128 MiB of JSON"),
      std::string::npos);
}

TEST_F(SceneFiles, RefuseWhatIsNoJson) {
  EXPECT_EQ(refusal("[]"), "expected a JSON object, got array");
  EXPECT_EQ(refusal("{\"surfaces\": ").rfind("expected JSON in UTF-8, got", 0), 0u);
  EXPECT_EQ(refusal(R"({"surfaces": 1e999})").rfind("expected JSON with numbers in the range of double", 0),
            0u);
  EXPECT_NE(refusal_of<FileError>([&] { io::read_scene_file(folder_ / "none.json"); }), "accepted");
}

}  // namespace
}  // namespace darboux::test::scene_file_test
