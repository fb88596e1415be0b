// Points on a known surface with noise and outliers, and the judge of what a fit makes of them: its error in
// units of the Cramér-Rao bound of the true inliers. Formulas of its own, none of the library's fit.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <darboux/placed_surface.h>
#include <darboux/point_cloud.h>

namespace darboux {

// The same numbers with every standard library, which its distributions do not promise.
class PortableRandom {
 public:
  explicit PortableRandom(std::uint64_t seed) : bits_(seed) {}

  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }  // in [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform() * static_cast<double>(n)); }
  double normal() {  // Marsaglia's polar method
    for (;;) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), s = x * x + y * y;
      if (s > 0 && s < 1) return x * std::sqrt(-2 * std::log(s) / s);
    }
  }
  Eigen::Vector3d normals() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }
  Eigen::Matrix3d rotation() {  // uniform
    const double w = normal(), x = normal(), y = normal(), z = normal();
    return Eigen::Quaterniond(w, x, y, z).normalized().matrix();
  }
  template <class T>
  void shuffle(std::vector<T>& list) {
    for (std::size_t k = list.size(); k > 1; --k) std::swap(list[k - 1], list[below(k)]);
  }

 private:
  std::mt19937_64 bits_;
};

// What of the surface the points cover. patch: 30 degrees of each turn, of a torus's tube a quarter; strip:
// half of u and a twentieth of v. Others: SyntheticOptions::coverage.
enum class Region { full, half, quarter, patch, strip };

// cluster: Gaussian, a tenth of the size wide, about a point of the box. second_surface: on a sphere of
// radius 0.7 about a point of the box, with the same noise.
enum class OutlierPattern { scattered, cluster, second_surface };
inline constexpr double second_radius = 0.7;

struct SyntheticOptions {
  std::size_t count = 10000;
  // Standard deviation of each coordinate over a size that is 1 before scaling: the radius of sphere and
  // cylinder, half the major radius of the torus, the base radius of the cone, the middle semi-axis of the
  // ellipsoid, half the shorter side of the plane.
  double sigma = 0;
  // Outliers are uniform in the box of the inliers' feet, its sides along the axes of the points' space, 1.25
  // times as long, and none shorter than a third of the longest: a plane along two axes would else have its
  // outliers within the noise.
  double outlier_share = 0;
  OutlierPattern outlier_pattern = OutlierPattern::scattered;
  // Share of the chart that the inliers cover: with equal odds its square root along both u and v, or all of
  // it along u and the whole of v; anywhere in the chart, over a seam too. Of a cone's chart only v in [0,
  // 0.8] is used.
  double coverage = 1;
  Region region = Region::full;  // patch, strip: instead of the coverage
  // false: sphere 1, cylinder of radius 1 and height 3, torus 2 and 0.6, plane 3 x 2, cone of half-angle 30
  // degrees and base 1, ellipsoid 1.5, 1, 0.7. true: the same but for the cone's half-angle, uniform in 10 to
  // 60 degrees, the torus's minor over major radius, uniform in 0.1 to 0.8, and the ellipsoid's semi-axes,
  // neighbours of which in size have ratios uniform in 1.3 to 2, in random order.
  bool random_shape = false;
  double offset = 10;  // length of the translation before scaling; its direction and the rotation are random
  double scale = 1;    // of all lengths
  bool with_uv = false;           // outliers get a uv anywhere in the covered part
  std::size_t uv_convention = 0;  // of uv_conventions()
  std::uint64_t seed = 1;
};

struct SyntheticPoints {
  PointCloud cloud;
  std::vector<bool> is_inlier;
  PlacedSurface truth;
  double sigma;  // of the cloud's coordinates
  double scale;
  std::vector<Eigen::Vector3d>
      feet;  // of the inliers, without noise, in the surface's own frame and before scaling
  // Of OutlierPattern::second_surface: the middle of the sphere, in the points' space, and the outliers'
  // feet.
  Eigen::Vector3d second_centre = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> second_feet{};
};

double parameter_of(const AnySurface& surface, std::string_view name);  // NaN where there is none

// \param kind one of found_kinds()
SyntheticPoints make_points(std::string_view kind, const SyntheticOptions& options);

// The same points with the second surface as the truth: the sphere, or an ellipsoid of three equal semi-axes.
// \param kind sphere or ellipsoid
SyntheticPoints with_second_as_truth(const SyntheticPoints& points, std::string_view kind);

// ---- the judge --------------------------------------------------------------------------------------------
// Minimal parameters of each kind about a true surface, in its own frame and before scaling, zero at the
// truth:
//   plane      tilts a, b of the normal unit(a, b, 1); height along it
//   sphere     centre; change of the radius
//   cylinder   where the axis meets z = 0; tilts; change of the radius
//   cone       displacement of the apex; tilts of the axis unit(a, b, -1) from the apex to the base; change
//              of the half-angle
//   torus      centre; tilts of the axis; changes of both radii
//   ellipsoid  centre; rotation vector; logarithms of the ratios of the semi-axes

// What of the true surface the distance needs, in the order of its parameters, before scaling.
struct TrueShape {
  std::string kind;
  std::vector<double> values;
  explicit TrueShape(const SyntheticPoints& points);
  int parameters() const;
};

// The distance of p from the surface with parameters q (of the ellipsoid: to first order near the surface),
// and its derivatives by the parameters.
std::pair<double, Eigen::VectorXd> distance_and_slope(const TrueShape& shape, const Eigen::VectorXd& q,
                                                      const Eigen::Vector3d& p);

// Fisher's information of the true inliers about the minimal parameters, for a noise of 1 before scaling.
Eigen::MatrixXd unit_information(const SyntheticPoints& points);

// The 24 turns of a cube.
std::vector<Eigen::Matrix3d> cube_turns();

// A fitted surface of the same kind in the minimal parameters. Where several descriptions are the same
// surface, the nearest to the truth is taken: either sign of an axis, any order and signs of an ellipsoid's
// axes. Infinite where the parameters cannot express it.
Eigen::VectorXd parameter_error(const SyntheticPoints& points, const PlacedSurface& fit);

// e^T I e / n with e the error of the fit in the minimal parameters and I the information of the true inliers
// at the truth: 1 on average for an estimate that knows the inliers and reaches the Cramér-Rao bound.
// Infinite for another kind and where there is no noise.
double mahalanobis_per_parameter(const SyntheticPoints& points, const PlacedSurface& fit);

// The true frame at a foot (in the surface's own frame, before scaling), as a fit names it: the sign of the
// axis and the order of an ellipsoid's axes are a convention. Columns t, b, n in the points' space; of plane
// and sphere only n means something.
Eigen::Matrix3d true_frame(const SyntheticPoints& points, const PlacedSurface& fit,
                           const Eigen::Vector3d& foot);

}  // namespace darboux
