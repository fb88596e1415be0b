/// \file work_precision.h
/// Work-precision measurements: the run time and the error of each method for frames, at points of a surface
/// and on meshes of it. Target darboux::fit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/converge.h>

namespace darboux {

/// What a method computes: frames at (u, v), or frames at the corners of a mesh.
enum class WorkDomain : std::uint8_t { evaluation, meshes };

/// Points and outputs: one array per component of position, dpdu, dpdv, t, b, n.
template <class T>
struct WorkBatch {
  std::span<const T> u, v;
  std::array<std::span<T>, 18> numbers;
};

/// A method that is timed.
struct WorkMethod {
  std::string_view name, family, summary;
  WorkDomain domain;
  /// Of evaluation, one of the two: whether the surface has such a method.
  bool (*in_double)(const AnySurface&, const WorkBatch<double>&) = nullptr;
  bool (*in_float)(const AnySurface&, const WorkBatch<float>&) = nullptr;
  const FrameMethod* on_meshes = nullptr;  ///< of meshes

  bool single_precision() const { return in_float || (on_meshes && on_meshes->single_precision); }
};
/// Of evaluation, in double and (-float) in float:
///   darboux-points, -baseline, -avx2, -avx512   evaluate() on every instruction set of this machine
///   naive         the type's own formula with the C++ library's sines, cross product, division by lengths
///   dual          partials by dual numbers through the position
///   differences-2, -4, -6, -8                   central differences of the position
/// in double only:
///   ridders       Ridders' extrapolation of central differences
///   many-digits   40 digits, rounded at the end
/// Of meshes: frame_methods() by their names. The loops naive, dual and differences go through the types of
/// the catalogue; other surfaces have none.
std::span<const WorkMethod> work_methods();
/// The one of that name, else those of that family. \throws ParameterError listing the known names
std::vector<const WorkMethod*> find_work_methods(std::string_view name);

/// The quantities that can be compared. Times: nanoseconds per point or corner, and seconds for all. Errors:
/// the largest and the root mean square of angles to the truth, in radians. At points they are those of the
/// orthonormal frame. On meshes they are the angles between t and dpdu, b and dpdv, and the two n, by the
/// stored uvs, over corners that are not at poles, for the vectors that the method computes. frame: the worst
/// of t, b, n at a point, t on meshes. Partials and positions: relative to the longest of each, at points.
inline constexpr std::array<std::string_view, 12> work_metrics{
    "time_ns",    "seconds",    "tangent_max", "tangent_rms", "bitangent_max", "bitangent_rms",
    "normal_max", "normal_rms", "frame_max",   "frame_rms",   "partials_max",  "position_max"};
/// Its place in work_metrics. \throws ParameterError listing the known names
std::size_t find_work_metric(std::string_view name);

/// One method on one surface or mesh.
struct WorkSample {
  std::string surface;  ///< as AnySurface::specification() writes it
  std::string method, family;
  WorkDomain domain;
  std::string mesh;                                ///< a family of meshes; empty of evaluation
  int resolution = 0;                              ///< n rows, 2n columns; 0 of evaluation
  std::size_t points = 0;                          ///< in a call: points, or corners
  std::string failure;                             ///< why there are no times and no errors; empty: there are
  std::vector<double> rounds;                      ///< nanoseconds per point, of each round
  double time_low = 0, time_high = 0;              ///< their quartiles
  std::array<double, work_metrics.size()> metric;  ///< NaN: none; time_ns is the median of the rounds
  /// on_front: no other sample of the same surface and mesh family dominates this one. best_of_family: none
  /// of the same method family does. A sample dominates another if it is at least as fast and as exact, and
  /// better in one of the two (mark_fronts()).
  bool on_front = false, best_of_family = false;

  double operator[](std::string_view name) const { return metric[find_work_metric(name)]; }
  /// Whether it did not fail, and each of its errors is a number.
  bool holds() const {
    return failure.empty() &&
           std::none_of(metric.begin(), metric.end(), [](double x) { return std::isinf(x); });
  }
};

struct WorkOptions {
  std::vector<AnySurface> surfaces;
  std::vector<const WorkMethod*> methods;
  std::vector<const MeshFamily*> families;
  std::vector<int> resolutions{8, 16, 32, 64};  ///< rising, each at least 2
  int rounds = 11;                              ///< of timing, at least 3; each times every method once
  int points = 4096;       ///< random in [0, 1)², at least 16; into memory that stays in the cache
  int checked = 1000;      ///< of them compared with the truth, at most all
  double timeout = 10;     ///< seconds that a call may take; it is not interrupted, but not called again
  std::uint64_t seed = 1;  ///< of points and meshes
};

/// A piece of the work: evaluation of one surface, or one of its families of meshes at all resolutions.
struct WorkJob {
  std::size_t surface;
  std::size_t family;  ///< of meshes; options.families.size() is evaluation
};
/// \throws ParameterError for options that are not as above
std::vector<WorkJob> work_jobs(const WorkOptions& options);
/// Its samples. Errors depend on the options and the job alone. Other threads that work meanwhile disturb the
/// times.
std::vector<WorkSample> run_work_job(const WorkOptions& options, const WorkJob& job,
                                     const std::function<void(double)>& progress = {});
/// All of it, with fronts by the default metrics. \param progress called with the share done, in [0, 1]
std::vector<WorkSample> work_precision(const WorkOptions& options,
                                       const std::function<void(double)>& progress = {});

/// What fronts are drawn by. Empty: time_ns and frame_max of evaluation, seconds and frame_rms of meshes.
struct WorkAxes {
  std::string_view x, y;

  std::string_view x_of(WorkDomain domain) const {
    return !x.empty() ? x : domain == WorkDomain::evaluation ? "time_ns" : "seconds";
  }
  std::string_view y_of(WorkDomain domain) const {
    return !y.empty() ? y : domain == WorkDomain::evaluation ? "frame_max" : "frame_rms";
  }
};
/// Sets on_front and best_of_family. Smaller is better in every metric; samples without a number in one of
/// the two are on no front.
void mark_fronts(std::vector<WorkSample>& samples, const WorkAxes& axes = {});

/// The ratio of the second run time to the first, with a 95 % confidence interval: the median of all
/// quotients of a round of one and a round of the other (Hodges-Lehmann), and the order statistics of these
/// quotients that the rank-sum test does not reject. This is valid for any distribution of the rounds, if
/// they are independent and the two distributions differ only by a factor. Three rounds or fewer of each give
/// an infinite interval. [HodgesLehmann1963]
struct TimeRatio {
  double ratio, low, high;
};
TimeRatio time_ratio(std::span<const double> first, std::span<const double> second);

/// One method in two runs.
struct WorkComparison {
  WorkSample before, after;
  TimeRatio time{1, 0, std::numeric_limits<double>::infinity()};  ///< after / before
  std::string_view worst_metric;  ///< the error that grew most; empty: none to compare
  double error_ratio = 1;         ///< after / before there
  /// "faster", "slower": the whole interval lies beyond 1 by more than the tolerance, and so does the
  /// quotient of the fastest rounds, since what else runs on a machine only adds time; "same" otherwise;
  /// "failed" now and not before; "less exact": the error grew by more than the tolerance, or is no longer
  /// there; "undetermined": three rounds or fewer, whose interval is infinite.
  std::string_view verdict;

  bool holds() const { return verdict == "same" || verdict == "faster"; }
};
/// Whether two samples measure the same thing: equal surface, method, mesh, rows and, unless one failed,
/// points.
bool same_question(const WorkSample& a, const WorkSample& b);
/// What both runs have, in the order of `after`. \param tolerance 0.1: a tenth
std::vector<WorkComparison> compare_work(const std::vector<WorkSample>& before,
                                         const std::vector<WorkSample>& after, double tolerance);

}  // namespace darboux
