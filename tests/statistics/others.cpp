#include "others.h"

#ifdef DARBOUX_STATISTICS_CGAL
#include <CGAL/Random.h>
#include <CGAL/Shape_detection/Efficient_RANSAC.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/property_map.h>
#endif

namespace darboux {
namespace {

#ifdef DARBOUX_STATISTICS_CGAL

using Kernel = CGAL::Simple_cartesian<double>;
using Point = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using Points = std::vector<Point>;
using Traits =
    CGAL::Shape_detection::Efficient_RANSAC_traits<Kernel, Points, CGAL::First_of_pair_property_map<Point>,
                                                   CGAL::Second_of_pair_property_map<Point>>;
using Ransac = CGAL::Shape_detection::Efficient_RANSAC<Traits>;

template <class V>
Eigen::Vector3d eigen(const V& v) {
  return {v.x(), v.y(), v.z()};
}

PlacedSurface placed(const SurfaceSpecification& surface, const Eigen::Vector3d& origin,
                     const Eigen::Vector3d& axis) {
  PlacedSurface result{make_surface(surface)};
  result.placement.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).matrix();
  result.placement.translation() = origin;
  return result;
}

std::optional<PlacedSurface> surface_of(Ransac::Shape& shape, const Eigen::Vector3d& mean) {
  using namespace CGAL::Shape_detection;
  if (const auto* plane = dynamic_cast<Plane<Traits>*>(&shape)) {
    const Eigen::Vector3d n = eigen(plane->plane_normal()).normalized();
    return placed({"plane", {}}, mean - n.dot(mean - eigen(Kernel::Plane_3(*plane).point())) * n, n);
  }
  if (const auto* sphere = dynamic_cast<Sphere<Traits>*>(&shape))
    return placed({"sphere", {{"radius", sphere->radius()}}}, eigen(sphere->center()),
                  Eigen::Vector3d::UnitZ());
  if (const auto* cylinder = dynamic_cast<Cylinder<Traits>*>(&shape))
    return placed({"cylinder", {{"radius", cylinder->radius()}}}, eigen(cylinder->axis().point(0)),
                  eigen(cylinder->axis().to_vector()).normalized());
  if (const auto* cone = dynamic_cast<Cone<Traits>*>(&shape)) {
    const Eigen::Vector3d apex = eigen(cone->apex());
    Eigen::Vector3d up = -eigen(cone->axis()).normalized();  // our axis points from the base to the apex
    if (up.dot(apex - mean) < 0) up = -up;
    return placed({"cone", {{"radius", std::tan(std::abs(cone->angle()))}, {"height", 1}}}, apex - up, up);
  }
  const auto* torus = dynamic_cast<Torus<Traits>*>(&shape);
  if (!torus) return std::nullopt;
  return placed(
      {"torus", {{"major_radius", std::abs(torus->major_radius())}, {"minor_radius", torus->minor_radius()}}},
      eigen(torus->center()), eigen(torus->axis()).normalized());
}

std::optional<PlacedSurface> efficient_ransac(const PointCloud& cloud, std::string_view kind, double sigma) {
  using namespace CGAL::Shape_detection;
  Points points;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : cloud.positions) {
    points.emplace_back(Kernel::Point_3(p.x, p.y, p.z), Kernel::Vector_3(0, 0, 0));
    mean += to_eigen(p) / static_cast<double>(cloud.positions.size());
  }
  CGAL::jet_estimate_normals<CGAL::Sequential_tag>(
      points, 40,
      CGAL::parameters::point_map(CGAL::First_of_pair_property_map<Point>())
          .normal_map(CGAL::Second_of_pair_property_map<Point>()));
  CGAL::get_default_random() = CGAL::Random(1);
  Ransac ransac;
  ransac.set_input(points);
  if (kind == "plane") ransac.add_shape_factory<Plane<Traits>>();
  if (kind == "sphere") ransac.add_shape_factory<Sphere<Traits>>();
  if (kind == "cylinder") ransac.add_shape_factory<Cylinder<Traits>>();
  if (kind == "cone") ransac.add_shape_factory<Cone<Traits>>();
  if (kind == "torus") ransac.add_shape_factory<Torus<Traits>>();
  Ransac::Parameters parameters;
  parameters.epsilon = 3 * sigma;
  parameters.cluster_epsilon = 30 * sigma;  // gaps between neighbours never split the surface
  parameters.normal_threshold = 0.8;
  parameters.min_points = points.size() / 5;
  parameters.probability = 1e-3;
  ransac.detect(parameters);
  std::optional<PlacedSurface> best;
  std::size_t most = 0;
  for (const auto& shape : ransac.shapes())
    if (shape->indices_of_assigned_points().size() > most) {
      try {
        best = surface_of(*shape, mean);
        most = shape->indices_of_assigned_points().size();
      } catch (const std::exception&) {  // not a surface: a radius of zero
      }
    }
  return best;
}

#endif

}  // namespace

std::vector<OtherFitter> other_fitters() {
  std::vector<OtherFitter> list;
#ifdef DARBOUX_STATISTICS_CGAL
  list.push_back(
      {"CGAL Efficient_RANSAC", {"plane", "sphere", "cylinder", "cone", "torus"}, efficient_ransac});
#endif
  return list;
}

std::vector<std::string> missing_fitters() {
  std::vector<std::string> list;
#ifndef DARBOUX_STATISTICS_CGAL
  list.push_back("CGAL's Efficient_RANSAC was not compared: libcgal-dev is not there.");
#endif
  return list;
}

}  // namespace darboux
