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
#include "scene/view.h"

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
  // Whole pixels show no less than the file's view: where they are too high, a little more above and below.
  const double more = std::fmax(1, aspect * camera.height_px / camera.width_px);
  if (more > 1 && camera.projection == Camera::Projection::perspective)
    camera.vertical_field_of_view_rad = 2 * std::atan(more * std::tan(camera.vertical_field_of_view_rad / 2));
  camera.view_height *= more;
  // The scale of a node is none of its camera.
  camera.pose.linear() = world.topLeftCorner<3, 3>().colwise().normalized();
  camera.pose.translation() = world.topRightCorner<3, 1>();
  try {
    camera.check();
  } catch (const ParameterError& error) {
    place.refuse(error.what());
  }
  return result;
}

// The axis that the normals of the triangles lie around, and how far.
void bound_normals(const Mesh& mesh, ScenePrimitive& primitive) {
  std::vector<Eigen::Vector3d> normals;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) { return to_eigen(mesh.positions[t[i]]); };
    const Eigen::Vector3d n = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    if (!n.allFinite()) return;
    if (n.norm() == 0) continue;  // it covers nothing
    normals.push_back(n.normalized());
    sum += normals.back();
  }
  if (!(sum.norm() > 0)) return;
  const Eigen::Vector3d axis = sum.normalized();
  double half_angle = 0;
  for (const Eigen::Vector3d& n : normals)
    half_angle = std::fmax(half_angle, std::atan2(axis.cross(n).norm(), axis.dot(n)));
  primitive.axis = axis;
  primitive.half_angle_rad = half_angle;
}

// The transforms that EXT_mesh_gpu_instancing gives a node, the identity without.
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

// Most files have no camera: one that sees all of a scene, from the front, above and to the right.
static io::NamedCamera camera_before(const GltfScene& scene) {
  Eigen::AlignedBox3d all;
  for (const SceneMeshInstance& i : scene.instances)
    for (const std::uint32_t p : scene.primitives_of_mesh[i.mesh]) {
      const Eigen::AlignedBox3d& box = scene.primitives[p].box;
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

GltfScene scene_of_gltf(const std::string& path, const ReadOptions& options) {
  const GltfFile file = io::load_gltf(path, io::map_file(path), options);
  const JsonCursor root = file.root();
  GltfScene scene;
  if (root.has("meshes")) scene.primitives_of_mesh.resize(root.at("meshes").size());
  for (const Primitive& p : io::read_gltf(file).primitives) {
    const JsonCursor place = root.at("meshes").at(p.mesh).at("primitives").at(p.primitive);
    ScenePrimitive primitive;
    bool finite = true;
    for (const Vec3<double>& position : p.data.positions) {
      primitive.box.extend(to_eigen(position));
      finite = finite && to_eigen(position).allFinite();
    }
    bound_normals(p.data, primitive);
    if (place.has("material")) {
      const JsonCursor material = file.element("materials", place.at("material"));
      primitive.double_sided = material.has("doubleSided") && material.at("doubleSided").boolean();
    }
    // Materials of variants may be double-sided.
    primitive.double_sided = primitive.double_sided || io::materials_of(file, place).size() > 1;
    primitive.moves = place.has("targets") || !finite;
    primitive.needs_tangents = p.needs_tangents.value_or(false);
    primitive.vertices = p.data.positions.size();
    scene.primitives_of_mesh[p.mesh].push_back(static_cast<std::uint32_t>(scene.primitives.size()));
    scene.primitives.push_back(primitive);
  }
  io::Budget budget(file);
  std::size_t decoded = 0;
  for (const io::ShownNode& shown : io::shown_nodes(file)) {
    const JsonCursor node = root.at("nodes").at(shown.node);
    if (node.has("camera")) scene.cameras.push_back(camera_of_node(file, node, shown.world));
    if (!node.has("mesh")) continue;
    const std::size_t mesh = node.at("mesh").integer();
    const std::size_t primitives = scene.primitives_of_mesh[mesh].size();
    const std::vector<Eigen::Matrix4d> instances = gpu_instances(file, node);
    decoded += instances.size();
    scene.primitive_instances += instances.size() * primitives;
    if (std::max(decoded, scene.primitive_instances) > io::most_scene_instances)
      node.fail("at most " + std::to_string(io::most_scene_instances) + " instances up to here", "more");
    if (primitives == 0) continue;
    budget.take(instances.size() * sizeof(SceneMeshInstance), node, "its instances");
    for (const Eigen::Matrix4d& instance : instances) {
      const Eigen::Affine3d placement(shown.world * instance);
      if (!placement.matrix().allFinite()) node.fail("transforms that are finite", "others");
      scene.instances.push_back({mesh, node.has("skin") || shown.moves, placement});
    }
  }
  if (scene.cameras.empty()) scene.cameras.push_back(camera_before(scene));
  return scene;
}

ScenePlan plan_primitives(const GltfScene& scene, const Camera& camera) {
  camera.check();
  const View view(camera);
  constexpr double rounding = 0x1p-40;
  const auto outside = [&](const ScenePrimitive& p, const Eigen::Affine3d& placement) {
    for (const Plane3& plane : view.planes()) {
      if (!std::isfinite(plane.offset)) continue;
      const Eigen::Vector3d n = placement.linear().transpose() * plane.normal;
      const Eigen::Vector3d farthest =
          (n.array() < 0).select(p.box.min().array(), p.box.max().array()).matrix();
      const double along = plane.normal.dot(placement.translation());
      const double size = n.cwiseAbs().dot(farthest.cwiseAbs()) + std::fabs(along) + std::fabs(plane.offset);
      if (n.dot(farthest) + along - plane.offset < -rounding * size) return true;
    }
    return false;
  };
  // n · (eye - p) is at most |eye - c| cos(φ - θ) + r: φ the angle to the axis of the cone of θ, c and r
  // the centre and radius of the box. A mirror turns the winding and the side that it shows: in the mesh's
  // own space nothing changes.
  const auto faces_away = [&](const ScenePrimitive& p, const Eigen::Affine3d& placement) {
    const Eigen::Matrix3d m = placement.linear();
    // Of what is flat, or nearly so, the side is not known.
    if (!(std::fabs(m.determinant()) > 1e-3 * m.colwise().norm().prod())) return false;
    const Eigen::Matrix3d inverse = m.inverse();
    const bool perspective = view.perspective();
    const Eigen::Vector3d towards =
        perspective ? Eigen::Vector3d(inverse * (view.eye() - placement.translation()) - p.box.center())
                    : Eigen::Vector3d(inverse * view.backward());
    const double angle = std::atan2(p.axis.cross(towards).norm(), p.axis.dot(towards));
    const double radius = perspective ? p.box.diagonal().norm() / 2 : 0;
    const double size = towards.norm() + radius + p.box.center().norm();
    return towards.norm() * std::cos(std::fmax(0, angle - p.half_angle_rad)) + radius < -rounding * size;
  };
  ScenePlan plan;
  std::vector<bool> known(scene.primitives.size(), false);
  const auto count = [&](Attribute a, std::size_t n) {
    plan.attribute_samples[static_cast<std::size_t>(a)] += n;
  };
  const auto plan_one = [&](std::uint32_t number, const SceneMeshInstance& instance) {
    const ScenePrimitive& p = scene.primitives[number];
    const bool bounded = !p.moves && !instance.moves;
    ++plan.tiles_all;
    plan.samples_full += p.vertices;
    if (bounded && outside(p, instance.placement)) {
      ++plan.skipped.outside_frustum;
      return;
    }
    if (bounded && !p.double_sided && faces_away(p, instance.placement)) {
      ++plan.skipped.back_facing;
      return;
    }
    ++plan.instances_needed;
    plan.tiles_unbounded += !bounded;
    if (known[number]) {
      ++plan.skipped.duplicates;
      return;
    }
    known[number] = true;
    ++plan.tiles_needed;
    plan.samples_needed += p.vertices;
    count(Attribute::position, p.vertices);
    count(Attribute::normal, p.vertices);
    if (p.needs_tangents) count(Attribute::tangent4, p.vertices);
  };
  for (const SceneMeshInstance& instance : scene.instances)
    for (const std::uint32_t p : scene.primitives_of_mesh[instance.mesh]) plan_one(p, instance);
  return plan;
}

}  // namespace darboux
