// The record that describes a primitive: a surface that is found in points without a guess, by formulas of
// its own. Each has one file, and one line in list.h. The skeleton (prepare, search, refine, select, report)
// knows primitives only by this record.
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

// A primitive by its geometric parameters. z of `axes` is the axis; a primitive may define its direction.
struct GeometricParameters {
  Vector3d centre = Vector3d::Zero();
  Matrix3d axes = Matrix3d::Identity();
  std::array<double, 3> lengths{};
};

// A primitive in the form in which it is estimated: x = origin + rotation * local, with its own parameters s.
// Most have a surface point at (0, 0, rho), with z along the inward normal and x along a principal direction.
// Their parameters are curvatures, not radii, so that a sphere may pass through a plane into a sphere on the
// other side [Lukacs1998].
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

// robust: the weights are fixed. score: the gradient is that of the likelihood. Its root can be found to the
// last digits, where differences of the likelihood would drown in rounding.
enum class Phase { robust, score };

// The part of the estimate that the sums over the points need.
struct Weighting {
  Phase phase;
  const Mixture& mixture;
  const std::vector<double>& weights;  // in the robust phase
  bool convex = false;                 // weighted squares in place of the likelihood, which may be non-convex
};

// The functions that depend on the formula of the distance, over all points. distance_model.h makes them from
// a class with that formula.
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
  // Derivatives of the distances with respect to (rotation vector, parameters), a row per point.
  void (*jacobian)(const Eigen::Matrix3Xd& cloud, const LocalModel& model, Eigen::MatrixXd& to);
  // As `measure`, and the sums over (rotation vector, parameters).
  void (*accumulate)(const Eigen::Matrix3Xd& cloud, const LocalModel& model, const Weighting& weighting,
                     PointStates& states, NormalEquations& sums);
};

// Two coordinates of a surface point, and the area of a unit of them.
struct SupportCoordinates {
  double a, b, area;
};

// Coordinates over the whole surface, used to find its support.
struct SupportChart {
  // The frame of the coordinates, made from the surface and the points' mean and scatter, so that a turned
  // cloud gets the same cells.
  GeometricParameters (*frame)(const GeometricParameters&, const Vector3d& mean, const Matrix3d& scatter);
  SupportCoordinates (*coordinates)(const GeometricParameters& frame, const Vector3d& point_in_frame);
  double range_a, range_b;           // the whole range of a coordinate that has one; 0 for a length
  bool b_begins_at_a_point = false;  // as at a vertex: no edge
};

// The extent of the inliers along a direction, about the centre.
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

// Which of a primitive's axes the points can determine.
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
  bool slides_along_axis = false;         // into itself
  bool radius_about_axis = false;         // its parallels bound its curvature
  bool has_apex = false;                  // a point without normal
  bool only_where_lengths_agree = false;  // other surfaces have this name: fits by name use the catalogue
  int lengths = 0;                        // how many are lengths, not angles
  std::array<std::string_view, 3> length_names{};

  // The surface that fits a sample best by linear equations; none if they do not determine one.
  std::optional<GeometricParameters> (*start)(const OrientedPoints& sample);
  // Further starts, by equations without normals: neighbours in a grid may lie on one curve and give no
  // normal.
  std::vector<GeometricParameters> (*starts_by_equation)(const Eigen::Matrix3Xd& sample) = nullptr;
  // Surfaces from the scored points without normals, for many outliers: normals carry little information
  // about a tube that is thin compared with the noise.
  std::vector<GeometricParameters> (*starts_among_outliers)(const Eigen::Matrix3Xd& points,
                                                            std::mt19937_64& random) = nullptr;
  // The local model at the surface point nearest to `at`; an inverse of geometric(). Not finite where there
  // is no such point.
  LocalModel (*localise)(const GeometricParameters&, const Vector3d& at);
  GeometricParameters (*geometric)(const LocalModel&);
  SupportChart support;
  CatalogueSurface (*to_catalogue)(const GeometricParameters&, double scale, const ExtentAlong&);
  // Converts from the axes and origin of the catalogue's surface, and its parameters over the scale.
  GeometricParameters (*from_catalogue)(const GeometricParameters& placed);
  // The (u, v) of the point nearest to p; none for other surfaces.
  std::optional<Vec2<double>> (*foot)(const AnySurface&, const Vec3<double>& p);

  // Why it cannot be distinguished from its limits, as a text to follow "is"; empty if it can.
  std::string_view (*at_limit)(const GeometricParameters&, double deviation_of_first) = nullptr;
  // Surfaces of its kind that agree with another surface about one point to second order; each may be a
  // separate maximum.
  std::vector<GeometricParameters> (*osculating)(const Osculation&) = nullptr;
  // Whether it crosses itself, and so has two sheets near almost any point.
  bool (*crosses_itself)(const GeometricParameters&) = nullptr;
  // For a surface that crosses itself: the distances of a point from both sheets, the nearer first.
  std::array<double, 2> (*sheets)(const GeometricParameters&, const Vector3d& point) = nullptr;
};

// The approximate radius of the surface's tightest curve. \param at a point on it
double least_radius(const Primitive& primitive, const GeometricParameters& surface, const Vector3d& at);

// Whether most points on it also have its other sheet within the noise. Then noise about one sheet is divided
// between both, which explain the points too well.
bool doubles_itself(const Primitive& primitive, const GeometricParameters& surface,
                    const Eigen::Matrix3Xd& cloud, double sigma);

}  // namespace darboux::fit
