#include "scene_of_gltf.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"
#include "io/accessor.h"
#include "io/budget.h"
#include "io/files.h"
#include "io/gltf_file.h"
#include "io/tangent_space.h"

namespace darboux {
namespace {

using io::JsonCursor;

io::NamedCamera camera_of_node(const GltfFile& file, const JsonCursor& node, const Eigen::Matrix4d& world) {
  const JsonCursor place = file.element("cameras", node.at("camera"));
  io::NamedCamera result;
  Camera& camera = result.camera;
  for (const JsonCursor& named : {node, place})
    if (named.has("name") && named.at("name").json().is_string()) result.name = named.at("name").text();
  const bool perspective = place.at("type").text() == "perspective";
  double aspect = double(camera.width_px) / camera.height_px;
  if (perspective) {
    const JsonCursor lens = place.at("perspective");
    camera.vertical_field_of_view_rad = lens.at("yfov").number();
    camera.near_distance = lens.at("znear").number();
    camera.far_distance =
        lens.has("zfar") ? lens.at("zfar").number() : std::numeric_limits<double>::infinity();
    if (lens.has("aspectRatio")) aspect = lens.at("aspectRatio").number();
  } else if (place.at("type").text() == "orthographic") {
    const JsonCursor lens = place.at("orthographic");
    camera.projection = Camera::Projection::orthographic;
    camera.view_height = 2 * lens.at("ymag").number();
    camera.near_distance = lens.at("znear").number();
    camera.far_distance = lens.at("zfar").number();
    aspect = lens.at("xmag").number() / lens.at("ymag").number();
  } else {
    place.at("type").fail("perspective or orthographic");
  }
  if (!(aspect > 1e-3 && aspect < 1e3))
    place.fail("a width over height from 0.001 to 1000", shortest(aspect));
  camera.height_px = std::max(1, static_cast<int>(std::lround(camera.width_px / aspect)));
  // The picture shows at least the file's view: if whole pixels make it too high, a little more above and
  // below.
  const double more = std::fmax(1, aspect * camera.height_px / camera.width_px);
  if (more > 1 && camera.projection == Camera::Projection::perspective)
    camera.vertical_field_of_view_rad = 2 * std::atan(more * std::tan(camera.vertical_field_of_view_rad / 2));
  camera.view_height *= more;
  // The scale of a node does not affect its camera.
  camera.pose.linear() = world.topLeftCorner<3, 3>().colwise().normalized();
  camera.pose.translation() = world.topRightCorner<3, 1>();
  try {
    camera.check();
  } catch (const ParameterError& error) {
    place.refuse(error.what());
  }
  return result;
}

// Whether objects behind a material are visible: it blends, has holes, or transmits light without scattering
// it. A factor of 0 may be animated.
bool is_see_through(const JsonCursor& material) {
  return (material.has("alphaMode") && material.at("alphaMode").text() != "OPAQUE") ||
         material.extension("KHR_materials_transmission").has_value();
}

// The transforms that EXT_mesh_gpu_instancing gives a node; without it, the identity.
std::vector<Eigen::Matrix4d> gpu_instances(const GltfFile& file, const JsonCursor& node) {
  const auto extension = node.extension("EXT_mesh_gpu_instancing");
  if (!extension) return {Eigen::Matrix4d::Identity()};
  const JsonCursor attributes = extension->at("attributes");
  std::optional<std::size_t> count;
  const auto read = [&](const char* key, std::size_t components) -> std::vector<double> {
    if (!attributes.has(key)) return {};
    const JsonCursor index = attributes.at(key);
    const io::Accessor accessor = io::read_accessor(file, index);
    if (accessor.components != components)
      index.fail("an accessor of " + std::to_string(components) + " components", accessor.type);
    if (count && *count != accessor.count)
      index.fail("an accessor of as many elements as the others, " + std::to_string(*count),
                 std::to_string(accessor.count));
    count = accessor.count;
    std::vector<double> values(accessor.count * components);
    io::numbers(accessor, values);
    return values;
  };
  const std::vector<double> t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
  if (!count) attributes.fail("TRANSLATION, ROTATION or SCALE", "none");
  std::vector<Eigen::Matrix4d> result;
  for (std::size_t i = 0; i < *count; ++i) {
    Eigen::Affine3d m = Eigen::Affine3d::Identity();
    if (!t.empty()) m.translate(Eigen::Vector3d(t[3 * i], t[3 * i + 1], t[3 * i + 2]));
    if (!r.empty())
      m.rotate(Eigen::Quaterniond(r[4 * i + 3], r[4 * i], r[4 * i + 1], r[4 * i + 2]).normalized());
    if (!s.empty()) m.scale(Eigen::Vector3d(s[3 * i], s[3 * i + 1], s[3 * i + 2]));
    result.push_back(m.matrix());
  }
  return result;
}

}  // namespace

// Most files have no camera: this one sees the whole scene, from the front, above and to the right.
static io::NamedCamera camera_before(const Scene& scene) {
  Eigen::AlignedBox3d all;
  for (const SceneMeshInstance& i : scene.mesh_instances)
    for (const SceneMeshPart& part : scene.meshes[i.mesh].parts) {
      const Eigen::AlignedBox3d& box = part.box;
      if (box.isEmpty() || !box.min().allFinite() || !box.max().allFinite()) continue;
      for (int k = 0; k < 8; ++k)
        all.extend(i.placement * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)));
    }
  if (all.isEmpty()) all.extend(Eigen::Vector3d::Zero());
  const double radius = std::fmax(all.diagonal().norm() / 2, 1e-6 * (1 + all.center().norm()));
  io::NamedCamera result{"before the scene", {}};
  Camera& camera = result.camera;
  const Eigen::Vector3d towards_us = Eigen::Vector3d(0.5, 0.35, 1).normalized();
  const double distance = 1.05 * radius / std::sin(camera.vertical_field_of_view_rad / 2);
  camera.pose = Camera::look_at(all.center() + distance * towards_us, all.center(), {0, 1, 0});
  camera.near_distance = (distance - radius) / 2;
  camera.far_distance = distance + 2 * radius;
  return result;
}

GltfScene scene_of_gltf(const std::string& path, const ReadOptions& options, bool with_motion) {
  const GltfFile file = io::load_gltf(path, io::map_file(path), options);
  const JsonCursor root = file.root();
  GltfScene result;
  Scene& scene = result.scene;
  if (root.has("meshes")) scene.meshes.resize(root.at("meshes").size());
  for (const Primitive& p : io::read_gltf(file).primitives) {
    const JsonCursor place = root.at("meshes").at(p.mesh).at("primitives").at(p.primitive);
    SceneMaterial material;
    // Any of the variants may be shown.
    for (const std::size_t index : io::materials_of(file, place)) {
      const JsonCursor stored = root.at("materials").at(index);
      material.double_sided =
          material.double_sided || (stored.has("doubleSided") && stored.at("doubleSided").boolean());
      material.see_through = material.see_through || is_see_through(stored);
    }
    material.normal_map = p.needs_tangents.value_or(false);  // or whatever else reads them
    SceneMeshPart part = SceneMeshPart::of(p.data, static_cast<std::uint32_t>(scene.materials.size()));
    part.moves = part.moves || place.has("targets");
    scene.materials.push_back(material);
    scene.meshes[p.mesh].parts.push_back(part);
  }
  io::Budget budget(file);
  std::size_t decoded = 0;
  const std::vector<io::ShownNode> all_shown = io::shown_nodes(file);
  const std::optional<std::size_t> moved =
      with_motion ? CameraMotion::first_moved(file, all_shown) : std::nullopt;
  for (std::size_t at = 0; at < all_shown.size(); ++at) {
    const io::ShownNode& shown = all_shown[at];
    const JsonCursor node = root.at("nodes").at(shown.node);
    if (node.has("camera")) {
      result.cameras.push_back(camera_of_node(file, node, shown.world));
      if (at == moved) {
        result.moving_camera = result.cameras.size() - 1;
        result.motion = CameraMotion::of(file, all_shown, at, result.cameras.back().camera);
      }
    }
    if (!node.has("mesh")) continue;
    const std::size_t mesh = node.at("mesh").integer();
    const std::size_t primitives = scene.meshes[mesh].parts.size();
    const std::vector<Eigen::Matrix4d> instances = gpu_instances(file, node);
    decoded += instances.size();
    result.primitive_instances += instances.size() * primitives;
    if (std::max(decoded, result.primitive_instances) > io::most_scene_instances)
      node.fail("at most " + std::to_string(io::most_scene_instances) + " instances up to here", "more");
    if (primitives == 0) continue;
    // Half as much again while the list grows, and more.
    budget.take(3 * instances.size() * sizeof(SceneMeshInstance), node, "its instances");
    for (const Eigen::Matrix4d& instance : instances) {
      const Eigen::Affine3d placement(shown.world * instance);
      if (!placement.matrix().allFinite()) node.fail("transforms that are finite", "others");
      scene.mesh_instances.push_back(
          {static_cast<std::uint32_t>(mesh), node.has("skin") || shown.moves, placement});
    }
  }
  if (result.cameras.empty()) result.cameras.push_back(camera_before(scene));
  return result;
}

}  // namespace darboux
