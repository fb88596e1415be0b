// What a primitive states of itself. A primitive is a surface that is found in points without a guess, by
// formulas of its own: one file, and one line in list.h. The skeleton (prepare, search, refine, select,
// report) knows primitives by this record alone.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <random>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <darboux/any_surface.h>

#include "point_states.h"
#include "prepare.h"

namespace darboux::fit {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A primitive as people describe it. z of `axes` is the axis, which a primitive may direct.
struct GeometricParameters {
  Vector3d centre = Vector3d::Zero();
  Matrix3d axes = Matrix3d::Identity();
  std::array<double, 3> lengths{};
};

// A primitive as it is estimated: x = origin + rotation * local, and its own parameters s there. Most have
// one of their points at (0, 0, rho), with z along the inward normal and x along a principal direction.
// Curvatures, not radii, are their parameters, so that a sphere may pass through the plane into the sphere of
// the other side [Lukacs1998].
struct LocalModel {
  static constexpr std::size_t most_parameters = 6;
  Vector3d origin = Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  std::array<double, most_parameters> s{};
};

struct NormalEquations {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  double squares = 0;
};

// robust: the weights are fixed.
// score: the gradient is that of the likelihood: a root, found to the last digits, where differences of the
// likelihood would drown in its rounding.
enum class Phase { robust, score };

// What the sums over the points take from the estimate.
struct Weighting {
  Phase phase;
  const Mixture& mixture;
  const std::vector<double>& weights;  // in the robust phase
  bool convex = false;  // the weighted squares in place of the likelihood, which may curve the wrong way
};

// What depends on the formula of the distance, over all points. See distance_model.h, which makes these of a
// class with that formula.
struct DistanceFunctions {
  int parameters;  // of the local model
  // Whether there is a surface with these parameters.
  bool (*in_range)(const double* s);
  // Distances, those of `rough_distance` where the class has it.
  void (*rough_distances)(const Eigen::Matrix3Xd& cloud, const LocalModel& model, std::vector<double>& to);
  // Sets distance, curvature and regularity of all points.
  void (*measure)(const Eigen::Matrix3Xd& cloud, const LocalModel& model, PointStates& states);
  // The points of the surface nearest to the cloud's, in the model's own coordinates.
  void (*foot_points)(const Eigen::Matrix3Xd& cloud, const LocalModel& model, Eigen::Matrix3Xd& to);
  // Derivatives of the distances by (rotation vector, parameters), a row per point.
  void (*jacobian)(const Eigen::Matrix3Xd& cloud, const LocalModel& model, Eigen::MatrixXd& to);
  // As `measure`, and the sums over (rotation vector, parameters).
  void (*accumulate)(const Eigen::Matrix3Xd& cloud, const LocalModel& model, const Weighting& weighting,
                     PointStates& states, NormalEquations& sums);
};

// Two coordinates of a surface point, and the area of a unit of them.
struct SupportCoordinates {
  double a, b, area;
};

// Coordinates over the whole surface, in which its support is sought.
struct SupportChart {
  // The frame of the coordinates from the surface and the points' mean and scatter, so that a turned cloud
  // gets the same cells.
  GeometricParameters (*frame)(const GeometricParameters&, const Vector3d& mean, const Matrix3d& scatter);
  SupportCoordinates (*coordinates)(const GeometricParameters& frame, const Vector3d& point_in_frame);
  double range_a, range_b;  // the whole range of a coordinate that has one; 0 for a length
};

// Of the inliers along a direction, about the centre.
struct Extent {
  double low, high;
};
using ExtentAlong = std::function<Extent(const Vector3d& direction)>;

// The primitive as a surface of the catalogue at (frame, origin). Lengths that only bound the patch enclose
// the inliers.
struct CatalogueSurface {
  AnySurface surface;
  Matrix3d frame;
  Vector3d origin;
  Eigen::MatrixXd by_lengths;  // derivatives of the parameters by GeometricParameters::lengths
};

// What of a primitive's axes the points can show.
enum class Orientation { none, axis, frame };

struct Osculation;  // osculation.h

struct Primitive {
  std::string_view name;  // of its surface in the catalogue
  int unknowns;           // that points can determine, the pose included
  int sample_size;        // of the smallest sample worth trying
  DistanceFunctions distance;
  bool second_parameter_is_curvature = false;
  Orientation orientation = Orientation::axis;
  bool is_plane = false;
  bool slides_along_axis = false;  // into itself
  bool radius_about_axis = false;  // its parallels bound its curvature
  bool has_apex = false;           // a point without normal
  bool only_where_lengths_agree =
      false;        // other surfaces of this name exist: a fit by name is the catalogue's
  int lengths = 0;  // how many are lengths, not angles
  std::array<std::string_view, 3> length_names{};

  // The surface that fits a sample best in the sense of linear equations; nothing where they determine none.
  std::optional<GeometricParameters> (*start)(const OrientedPoints& sample);
  // As well, by equations that need no normals: neighbours in a grid may lie on one curve, and have none.
  std::vector<GeometricParameters> (*starts_by_equation)(const Eigen::Matrix3Xd& sample) = nullptr;
  // Surfaces from the points that are scored, where many are outliers, without normals: those tell little of
  // a tube that is thin beside the noise.
  std::vector<GeometricParameters> (*starts_among_outliers)(const Eigen::Matrix3Xd& points,
                                                            std::mt19937_64& random) = nullptr;
  // The local model at the surface point nearest to `at`; an inverse of geometric(). Not finite where there
  // is no such point.
  LocalModel (*localise)(const GeometricParameters&, const Vector3d& at);
  GeometricParameters (*geometric)(const LocalModel&);
  SupportChart support;
  CatalogueSurface (*to_catalogue)(const GeometricParameters&, double scale, const ExtentAlong&);
  // From the axes and origin of the catalogue's surface, and its parameters over the scale.
  GeometricParameters (*from_catalogue)(const GeometricParameters& placed);
  // The (u, v) of the point nearest to p; nothing for other surfaces.
  std::optional<Vec2<double>> (*foot)(const AnySurface&, const Vec3<double>& p);

  // Why it is not told from its limits, going on after "is"; empty where it is.
  std::string_view (*at_limit)(const GeometricParameters&, double deviation_of_first) = nullptr;
  // Surfaces of its kind that are like another about one point, to second order; each may be a maximum of its
  // own.
  std::vector<GeometricParameters> (*osculating)(const Osculation&) = nullptr;
  // Whether it crosses itself, and so has two sheets near almost any point.
  bool (*crosses_itself)(const GeometricParameters&) = nullptr;
  // How far a point is from either sheet, the nearer first, of a surface that crosses itself.
  std::array<double, 2> (*sheets)(const GeometricParameters&, const Vector3d& point) = nullptr;
};

// The radius of the surface's tightest curve, about. \param at a point on it
double least_radius(const Primitive& primitive, const GeometricParameters& surface, const Vector3d& at);

// Whether most points on it have its other sheet within the noise as well: then the sheets share out what is
// noise about one, and explain the points too well.
bool doubles_itself(const Primitive& primitive, const GeometricParameters& surface,
                    const Eigen::Matrix3Xd& cloud, double sigma);

}  // namespace darboux::fit
