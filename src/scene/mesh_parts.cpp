#include "mesh_parts.h"

#include <cmath>
#include <string>
#include <vector>

#include <darboux/error.h>

namespace darboux {
namespace {

constexpr double rounding = 0x1p-40;

}  // namespace

bool is_outside(const SceneMeshPart& part, const Eigen::Affine3d& placement, double displacement,
                const View& view) {
  for (const Plane3& plane : view.planes()) {
    if (!std::isfinite(plane.offset)) continue;
    const Eigen::Vector3d n = placement.linear().transpose() * plane.normal;
    const Eigen::Vector3d farthest =
        (n.array() < 0).select(part.box.min().array(), part.box.max().array()).matrix();
    const double along = plane.normal.dot(placement.translation());
    const double size = n.cwiseAbs().dot(farthest.cwiseAbs()) + std::fabs(along) + std::fabs(plane.offset);
    if (n.dot(farthest) + along - plane.offset + displacement < -rounding * size) return true;
  }
  return false;
}

// n · (eye - p) is at most |eye - c| cos(φ - θ) + r: φ is the angle to the axis of the cone of half-angle
// θ, c and r are the centre and radius of the box. A mirroring placement flips both the winding and the
// visible side: in the mesh's own space nothing changes.
bool faces_away(const SceneMeshPart& part, const Eigen::Affine3d& placement, const View& view) {
  const Eigen::Matrix3d m = placement.linear();
  if (!(std::fabs(m.determinant()) > 1e-3 * m.colwise().norm().prod())) return false;
  const Eigen::Matrix3d inverse = m.inverse();
  const bool perspective = view.perspective();
  const Eigen::Vector3d towards =
      perspective ? Eigen::Vector3d(inverse * (view.eye() - placement.translation()) - part.box.center())
                  : Eigen::Vector3d(inverse * view.backward());
  const double angle = std::atan2(part.axis.cross(towards).norm(), part.axis.dot(towards));
  const double radius = perspective ? part.box.diagonal().norm() / 2 : 0;
  const double size = towards.norm() + radius + part.box.center().norm();
  return towards.norm() * std::cos(std::fmax(0, angle - part.half_angle_rad)) + radius < -rounding * size;
}

namespace {

class MeshPlanner {
 public:
  MeshPlanner(const Scene& scene, const SceneRequest& request, const TileCulling& tests,
              const Occlusion& occlusion, ScenePlan& plan)
      : scene_(scene), request_(request), tests_(tests), occlusion_(occlusion), plan_(plan) {}

  // \param known of its mesh, whether an instance before needs a part already
  void add(std::uint32_t instance, std::uint32_t part, std::vector<bool>& known);

 private:
  bool skip(const SceneMeshInstance& instance, const SceneMeshPart& part);

  const Scene& scene_;
  const SceneRequest& request_;
  const TileCulling& tests_;
  const Occlusion& occlusion_;
  ScenePlan& plan_;
};

// Whether it is skipped; if so, counts it.
bool MeshPlanner::skip(const SceneMeshInstance& instance, const SceneMeshPart& part) {
  const SceneMaterial& material = scene_.materials[part.material];
  const SceneRequest::Skip& skip = request_.skip;
  const Eigen::Affine3d& placement = instance.placement;
  SkippedTiles& skipped = plan_.skipped;
  if (skip.unread_attributes && !material.reads_tangents() && tests_.without_tangents().empty()) {
    ++skipped.no_normal_map;
    return true;
  }
  if (part.moves || instance.moves) return false;  // without bounds
  if (skip.outside_frustum && is_outside(part, placement, material.displacement, tests_.view())) {
    ++skipped.outside_frustum;
    return true;
  }
  if (material.displacement > 0) return false;
  if (skip.back_facing && !material.double_sided && faces_away(part, placement, tests_.view())) {
    ++skipped.back_facing;
    return true;
  }
  if (skip.occluded && !occlusion_.empty() && !part.box.isEmpty() &&
      occlusion_.hides({occlusion_, placement}, from_eigen(part.box.min()), from_eigen(part.box.max()))) {
    ++skipped.occluded;
    return true;
  }
  return false;
}

void MeshPlanner::add(std::uint32_t index, std::uint32_t number, std::vector<bool>& known) {
  const SceneMeshInstance& instance = scene_.mesh_instances[index];
  const SceneMeshPart& part = scene_.meshes[instance.mesh].parts[number];
  ++plan_.tiles_all;
  plan_.samples_full += part.vertices;
  if (skip(instance, part)) return;
  ++plan_.instances_needed;
  plan_.tiles_unbounded += part.moves || instance.moves;
  plan_.parts.push_back({index, number});
  if (request_.skip.duplicates && known[number]) {
    ++plan_.skipped.duplicates;
    return;
  }
  known[number] = true;
  ++plan_.tiles_needed;
  plan_.samples_needed += part.vertices;
  const bool all = !request_.skip.unread_attributes || scene_.materials[part.material].reads_tangents();
  for (std::size_t a = 0; a < attribute_count; ++a)
    if ((all ? request_.attributes : tests_.without_tangents()).has(static_cast<Attribute>(a)))
      plan_.attribute_samples[a] += part.vertices;
}

}  // namespace

void plan_mesh_parts(const Scene& scene, const SceneRequest& request, const TileCulling& tests,
                     const Occlusion& occlusion, ScenePlan& plan) {
  MeshPlanner planner(scene, request, tests, occlusion, plan);
  std::vector<std::vector<bool>> known(scene.meshes.size());
  for (std::uint32_t i = 0; i < scene.mesh_instances.size(); ++i) {
    const SceneMeshInstance& instance = scene.mesh_instances[i];
    const auto refuse = [&](const char* expected, const std::string& got) {
      throw ParameterError("mesh instance " + std::to_string(i),
                           std::string("expected ") + expected + ", got " + got);
    };
    if (instance.mesh >= scene.meshes.size()) refuse("a mesh of the scene", std::to_string(instance.mesh));
    if (!instance.placement.matrix().allFinite()) refuse("a placement that is finite", "another");
    const std::vector<SceneMeshPart>& parts = scene.meshes[instance.mesh].parts;
    known[instance.mesh].resize(parts.size());
    for (std::uint32_t k = 0; k < parts.size(); ++k) {
      if (parts[k].material >= scene.materials.size())
        refuse("materials of the scene", std::to_string(parts[k].material));
      planner.add(i, k, known[instance.mesh]);
    }
  }
}

}  // namespace darboux
