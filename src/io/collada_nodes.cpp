// Nodes of a COLLADA document.
#include <numbers>

#include <Eigen/Geometry>

#include <darboux/error.h>

#include "collada.h"
#include "files.h"

namespace darboux::io {
namespace {

std::vector<double> numbers_of(const Collada& file, const pugi::xml_node& element, std::size_t wanted) {
  std::vector<double> result = file.numbers(element);
  if (result.size() != wanted)
    file.fail(element, std::to_string(wanted) + " numbers", std::to_string(result.size()));
  return result;
}

Eigen::Matrix4d look_at(const std::vector<double>& n) {
  const Eigen::Map<const Eigen::Vector3d> eye(n.data()), interest(n.data() + 3), up(n.data() + 6);
  const Eigen::Vector3d back = (eye - interest).normalized(), right = up.cross(back).normalized();
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  result.block<3, 1>(0, 0) = right;
  result.block<3, 1>(0, 1) = back.cross(right);
  result.block<3, 1>(0, 2) = back;
  result.block<3, 1>(0, 3) = eye;
  return result;
}

// The product of its transforms, in their order.
Eigen::Matrix4d local_matrix(const Collada& file, const pugi::xml_node& node) {
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  for (const pugi::xml_node element : node.children()) {
    const std::string_view kind = element.name();
    if (kind == "matrix") {
      const std::vector<double> m = numbers_of(file, element, 16);
      transform.matrix() *= Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
    } else if (kind == "translate") {
      transform.translate(Eigen::Vector3d(numbers_of(file, element, 3).data()));
    } else if (kind == "rotate") {
      const std::vector<double> r = numbers_of(file, element, 4);
      transform.rotate(
          Eigen::AngleAxisd(r[3] * std::numbers::pi / 180, Eigen::Vector3d(r.data()).normalized()));
    } else if (kind == "scale") {
      transform.scale(Eigen::Vector3d(numbers_of(file, element, 3).data()));
    } else if (kind == "lookat") {
      transform.matrix() *= look_at(numbers_of(file, element, 9));
    } else if (kind == "skew") {
      file.fail(element, "matrix, translate, rotate, scale or lookat", "skew");
    }
  }
  return transform.matrix();
}

// The <geometry> that an instance shows: its own, or that of its controller's skin or morph.
pugi::xml_node geometry_of(const Collada& file, const pugi::xml_node& instance) {
  constexpr int most = 16;  // controllers of controllers
  pugi::xml_node shown = file.find(instance, "url");
  for (int i = 0; i < most && std::string_view(shown.name()) == "controller"; ++i) {
    const pugi::xml_node skin = shown.child("skin");
    shown = file.find(skin ? skin : shown.child("morph"), "source");
  }
  if (std::string_view(shown.name()) != "geometry")
    file.fail(instance, "the #ID of a <geometry>, or of a controller of one",
              in_quotes(instance.attribute("url").value()));
  return shown;
}

}  // namespace

std::vector<std::vector<Eigen::Matrix4d>> read_instances(const Collada& file,
                                                         const std::vector<pugi::xml_node>& geometries) {
  std::vector<std::vector<Eigen::Matrix4d>> instances(geometries.size());
  std::unordered_map<const void*, std::size_t> number;
  for (const pugi::xml_node geometry : geometries) number.emplace(geometry.internal_object(), number.size());
  const pugi::xml_node shown = file.root().child("scene").child("instance_visual_scene");
  const pugi::xml_node scene = shown ? file.target(shown, "url", "visual_scene")
                                     : file.root().child("library_visual_scenes").child("visual_scene");
  struct Visit {
    pugi::xml_node node;
    Eigen::Matrix4d parent;
  };
  // Nodes may reference others, even in cycles, so all visits are counted.
  constexpr std::size_t most_looks = 1000000;
  std::size_t looks = 0;
  std::vector<Visit> visits;
  std::unordered_map<const void*, Eigen::Matrix4d> local;
  for (const pugi::xml_node node : scene.children("node"))
    visits.push_back({node, Eigen::Matrix4d::Identity()});
  for (std::size_t i = 0; i < visits.size(); ++i) {
    const pugi::xml_node node = visits[i].node;
    const auto [matrix, is_new] = local.try_emplace(node.internal_object());
    if (is_new) matrix->second = local_matrix(file, node);
    const Eigen::Matrix4d world = visits[i].parent * matrix->second;
    for (const pugi::xml_node child : node.children()) {
      if (++looks > most_looks)
        file.fail(node, "nodes of at most 1000000 elements in all, none within itself", "more");
      const std::string_view kind = child.name();
      if (kind == "node") visits.push_back({child, world});
      if (kind == "instance_node") visits.push_back({file.target(child, "url", "node"), world});
      if (kind != "instance_geometry" && kind != "instance_controller") continue;
      const auto found = number.find(geometry_of(file, child).internal_object());
      if (found != number.end()) instances[found->second].push_back(world);
    }
  }
  return instances;
}

}  // namespace darboux::io
