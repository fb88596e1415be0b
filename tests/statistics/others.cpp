#include "others.h"

#ifdef DARBOUX_STATISTICS_CGAL
#include <CGAL/PortableRandom.h>
#include <CGAL/Shape_detection/Efficient_RANSAC.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/property_map.h>
#endif
#ifdef DARBOUX_STATISTICS_PCL
#include <pcl/features/normal_3d.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_cone.h>
#include <pcl/sample_consensus/sac_model_cylinder.h>
#include <pcl/sample_consensus/sac_model_plane.h>
#include <pcl/sample_consensus/sac_model_sphere.h>
#endif

namespace darboux {
namespace {

#if defined(DARBOUX_STATISTICS_CGAL) || defined(DARBOUX_STATISTICS_PCL)

PlacedSurface placed(const SurfaceSpecification& surface, const Eigen::Vector3d& origin,
                     const Eigen::Vector3d& axis) {
  PlacedSurface result{make_surface(surface)};
  result.placement.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).matrix();
  result.placement.translation() = origin;
  return result;
}

PlacedSurface plane_near(const Eigen::Vector3d& mean, const Eigen::Vector3d& on_it,
                         const Eigen::Vector3d& n) {
  return placed({"plane", {}}, mean - n.dot(mean - on_it) * n, n);
}

// Our axis points from the base to the apex.
PlacedSurface cone_of(const Eigen::Vector3d& mean, const Eigen::Vector3d& apex, const Eigen::Vector3d& axis,
                      double half_angle) {
  const Eigen::Vector3d up = axis.dot(apex - mean) < 0 ? -axis : axis;
  return placed({"cone", {{"radius", std::tan(std::abs(half_angle))}, {"height", 1}}}, apex - up, up);
}

Eigen::Vector3d mean_of(const PointCloud& cloud) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : cloud.positions) mean += to_eigen(p) / static_cast<double>(cloud.positions.size());
  return mean;
}

#endif

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

std::optional<PlacedSurface> surface_of(Ransac::Shape& shape, const Eigen::Vector3d& mean) {
  using namespace CGAL::Shape_detection;
  if (const auto* plane = dynamic_cast<Plane<Traits>*>(&shape)) {
    return plane_near(mean, eigen(Kernel::Plane_3(*plane).point()),
                      eigen(plane->plane_normal()).normalized());
  }
  if (const auto* sphere = dynamic_cast<Sphere<Traits>*>(&shape))
    return placed({"sphere", {{"radius", sphere->radius()}}}, eigen(sphere->center()),
                  Eigen::Vector3d::UnitZ());
  if (const auto* cylinder = dynamic_cast<Cylinder<Traits>*>(&shape))
    return placed({"cylinder", {{"radius", cylinder->radius()}}}, eigen(cylinder->axis().point(0)),
                  eigen(cylinder->axis().to_vector()).normalized());
  if (const auto* cone = dynamic_cast<Cone<Traits>*>(&shape)) {
    return cone_of(mean, eigen(cone->apex()), eigen(cone->axis()).normalized(), cone->angle());
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
  const Eigen::Vector3d mean = mean_of(cloud);
  for (const auto& p : cloud.positions)
    points.emplace_back(Kernel::Point_3(p.x, p.y, p.z), Kernel::Vector_3(0, 0, 0));
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

#ifdef DARBOUX_STATISTICS_PCL

// RANSAC, then the model's own refinement over its inliers. PCL keeps floats: the points are centred for it.
std::optional<PlacedSurface> pcl_ransac(const PointCloud& cloud, std::string_view kind, double sigma) {
  using Points = pcl::PointCloud<pcl::PointXYZ>;
  const Points::Ptr points(new Points);
  const Eigen::Vector3d mean = mean_of(cloud);
  for (const auto& p : cloud.positions) {
    const Eigen::Vector3f x = (to_eigen(p) - mean).cast<float>();
    points->emplace_back(x.x(), x.y(), x.z());
  }
  const auto found = [&](const auto& model) -> std::optional<Eigen::VectorXd> {
    pcl::RandomSampleConsensus<pcl::PointXYZ> ransac(model, 3 * sigma);
    ransac.setMaxIterations(10000);
    if (!ransac.computeModel()) return std::nullopt;
    Eigen::VectorXf rough, fine;
    pcl::Indices inliers;
    ransac.getModelCoefficients(rough);
    ransac.getInliers(inliers);
    model->optimizeModelCoefficients(inliers, rough, fine);
    return fine.cast<double>();
  };
  const auto with_normals = [&](auto* model) {
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    const pcl::PointCloud<pcl::Normal>::Ptr normals(new pcl::PointCloud<pcl::Normal>);
    estimation.setInputCloud(points);
    estimation.setKSearch(40);
    estimation.compute(*normals);
    model->setInputNormals(normals);
    model->setNormalDistanceWeight(0.05);
    return found(typename std::remove_pointer_t<decltype(model)>::Ptr(model));
  };
  std::optional<Eigen::VectorXd> c;
  const auto at = [&](Eigen::Index k) { return Eigen::Vector3d(c->segment<3>(k)); };
  if (kind == "plane") {
    c = found(pcl::SampleConsensusModelPlane<pcl::PointXYZ>::Ptr(
        new pcl::SampleConsensusModelPlane<pcl::PointXYZ>(points)));
    if (!c) return std::nullopt;
    const double length = at(0).norm();
    const Eigen::Vector3d n = at(0) / length;
    return plane_near(mean, mean - (*c)[3] / length * n, n);
  }
  if (kind == "sphere") {
    c = found(pcl::SampleConsensusModelSphere<pcl::PointXYZ>::Ptr(
        new pcl::SampleConsensusModelSphere<pcl::PointXYZ>(points)));
    if (!c) return std::nullopt;
    return placed({"sphere", {{"radius", std::abs((*c)[3])}}}, mean + at(0), Eigen::Vector3d::UnitZ());
  }
  if (kind == "cylinder") {
    c = with_normals(new pcl::SampleConsensusModelCylinder<pcl::PointXYZ, pcl::Normal>(points));
    if (!c) return std::nullopt;
    return placed({"cylinder", {{"radius", std::abs((*c)[6])}}}, mean + at(0), at(3).normalized());
  }
  c = with_normals(new pcl::SampleConsensusModelCone<pcl::PointXYZ, pcl::Normal>(points));
  if (!c) return std::nullopt;
  return cone_of(mean, mean + at(0), at(3).normalized(), (*c)[6]);
}

#endif

}  // namespace

std::vector<OtherFitter> other_fitters() {
  std::vector<OtherFitter> list;
#ifdef DARBOUX_STATISTICS_CGAL
  list.push_back(
      {"CGAL Efficient_RANSAC", {"plane", "sphere", "cylinder", "cone", "torus"}, efficient_ransac});
#endif
#ifdef DARBOUX_STATISTICS_PCL
  list.push_back(
      {"PCL " PCL_VERSION_PRETTY " sample consensus", {"plane", "sphere", "cylinder", "cone"}, pcl_ransac});
#endif
  return list;
}

std::vector<std::string> missing_fitters() {
  std::vector<std::string> list;
#ifndef DARBOUX_STATISTICS_CGAL
  list.push_back("CGAL's Efficient_RANSAC was not compared: libcgal-dev is not there.");
#endif
#ifndef DARBOUX_STATISTICS_PCL
  list.push_back(
      "PCL's sample consensus was not compared: libpcl-dev is not there (1.1 GB, and in no list of ours).");
#endif
  return list;
}

}  // namespace darboux
