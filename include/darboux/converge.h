/// \file converge.h
/// Measures the orders of convergence of mesh frames towards the exact frames, and error against run time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/any_surface.h>
#include <darboux/mesh_classes.h>
#include <darboux/mesh_frames.h>
#include <darboux/order_of_convergence.h>
#include <darboux/sample_mesh.h>

namespace darboux {

/// A family of meshes of a surface, one per resolution.
struct MeshFamily {
  std::string_view name, summary;
  double shear = 0;   ///< K: stored uvs are (u + K v, v)
  double jitter = 0;  ///< interior vertices are displaced by up to ± this share of a cell
  bool random_diagonals = false;
  bool mirror = false;  ///< stored u is 1 - |2u - 1|: the second half's uvs are those of the first, mirrored
  double grading = 0;   ///< SampleMeshOptions::grading
  MeshTopology topology = MeshTopology::grid;
  PolePlacement pole = PolePlacement::per_column;

  /// Whether the mesh depends on the seed.
  bool is_random() const { return jitter > 0 || random_diagonals; }
};
/// regular, sheared (K = 0.5), jittered (0.15 of a cell: no triangle is inverted), jittered-diagonals,
/// mirrored, graded (0.5: cells from half to one and a half times the average); and three on which much does
/// not converge, so no order is expected (shared-poles: on surfaces with poles):
///   inverted      jittered by 0.35 of a cell
///   shared-poles  all triangles at a pole share one vertex, which has one u
///   lantern       Schwarz's lantern with n rows and m = 2 sqrt(n) columns, so that n/m² = 1/4, at least 3;
///                 for tubular surfaces without poles
std::span<const MeshFamily> mesh_families();
/// \throws ParameterError listing the known names
const MeshFamily& find_mesh_family(std::string_view name);
/// The options for sample_mesh() that give the mesh of a family: `rows` rows and, except for the lantern,
/// twice as many columns.
SampleMeshOptions mesh_options(const MeshFamily& family, int rows, std::uint64_t seed, double v_first = 0,
                               double v_last = 1);

/// How the measured order compares with the expected one.
enum class OrderVerdict : std::uint8_t {
  as_expected,  ///< the expected order is within 0.15 of the 95 % interval
  faster,       ///< the whole interval lies more than 0.15 above it
  slower,       ///< the whole interval lies more than 0.15 below it
  /// The order is below 0.15, and either none was expected or the whole interval is below.
  does_not_converge,
  at_the_floor,  ///< fewer than three resolutions with errors above rounding: no order
};
inline constexpr std::array<std::string_view, 5> order_verdict_names{"as expected", "faster", "slower",
                                                                     "does not converge", "at the floor"};

/// The errors at one resolution, in degrees, over the triangle corners of the study's class. For several
/// random meshes, h, p95_deg and seconds are means; max_deg and floor_deg are maxima.
struct Level {
  int resolution;  ///< n: n rows, 2n columns
  double h;        ///< mesh width: the mean edge length
  double max_deg, rms_deg, p95_deg;
  /// The error that rounding alone may cause: 16u |P|max / (shortest edge), u = 2^-53. A position errs by
  /// about 4u |P|, an edge by twice that, and a tangent depends on two edges. Stored uvs are rounded too:
  /// (largest uv) / (shortest edge in uv) replaces the quotient if it is larger.
  double floor_deg;
  /// Run time of the method on the whole mesh, in one thread: the best of several runs.
  double seconds;
  /// Corners of the class; those without a usable triangle, which are excluded.
  std::size_t corners, fallback;
  bool used;  ///< used in the fit of the order
  /// Per random mesh, by seed; one entry for other families.
  std::vector<double> rms_of_mesh{}, max_of_mesh{};
};

inline constexpr double least_order = 0.15;  ///< lower orders count as no convergence

/// How one error decreases with the mesh width, for one surface, mesh family, method, vertex class and
/// quantity.
struct Study {
  std::string surface;  ///< as AnySurface::specification() writes it
  double v_first = 0, v_last = 1;
  std::string_view mesh, method;
  VertexClass vertex_class;
  /// What is compared. "tangent": t with the derivative by the stored u. "bitangent": the method's b with the
  /// derivative by the stored v. "normal": the method's n with that of the surface, for methods that compute
  /// n.
  std::string_view quantity;
  std::vector<Level> levels;  ///< coarse to fine
  /// estimate_order() of the rms, over the levels at which the rms of every mesh exceeds ten times the floor.
  /// NaN if there are fewer than three such levels.
  double order, order_low, order_high;
  double max_order;  ///< the same for the largest errors
  /// 0: not expected to converge, as for any surface whose partials are zero, parallel or infinite along a
  /// line. Such lines are searched for only at multiples of 1/16 in u and v.
  double expected_order;
  OrderVerdict verdict;

  /// Whether the largest error decreases. (The rms may decrease merely because wrong corners become rare.)
  bool max_converges() const { return !(max_order < least_order); }
  /// Whether the order is at least the expected one.
  bool holds() const {
    return verdict != OrderVerdict::slower &&
           (verdict != OrderVerdict::does_not_converge || expected_order == 0);
  }
};

/// The quantities that a study can measure.
inline constexpr std::array<std::string_view, 3> study_quantities{"tangent", "bitangent", "normal"};

inline constexpr int finest_repeated = 256;

/// The combinations to run: every surface with every family and every method.
struct ConvergeOptions {
  std::vector<AnySurface> surfaces;
  std::vector<const FrameMethod*> methods;
  std::vector<const MeshFamily*> families;
  std::vector<int> resolutions{8, 16, 32, 64, 128, 256};  ///< at least three, increasing, each at least 2
  std::uint64_t seed = 1;                                 ///< of the first random mesh
  /// Number of meshes per random family and resolution, with seeds seed, seed + 1, ...; at least 1. Above
  /// finest_repeated rows only one mesh is used, as its errors scatter less.
  int seeds = 3;
  double v_first = 0, v_last = 1;  ///< the part of the surface that is meshed
};

/// Runs every combination. Classes without corners give no study. Expected orders, per class:
///   interior          FrameMethod::direction; half an order less if the method uses vertices two edges away,
///                     since these are missing next to a border
///   border, seam      that of the method on irregular meshes
///   pole_ring         FrameMethod::at_poles
///   pole              as pole_ring, but at most 1; 0 for t and n of methods that use vertices two edges away
/// On a mesh with poles the other classes converge more slowly, since the rows next to a pole are a share h
/// of all rows. For methods that use one triangle at a time, their order exceeds that of pole_ring by at most
/// one half. For other methods, the order in the interior exceeds that of pole_ring by at most one half; on
/// irregular meshes by at most a quarter if pole_ring is below 1, and not at all if it is 0. Seam and border:
/// half an order less than 2 or 3, as measured; on irregular meshes at most one half above pole_ring. On
/// graded meshes with poles, polynomial methods are expected to have no higher order in the interior than on
/// irregular meshes. The expected order is 0 if the method does not converge on the chart, if no order is
/// expected of the family, or if the surface is singular along a line. The shear of a family vanishes at the
/// poles: pole and pole_ring are judged by the chart without shear, with an order of at most 1 if the method
/// does not converge on the sheared chart. \param progress called with the fraction done, in [0, 1] \throws
/// ParameterError if the resolutions or the range of v are not as above, a family or method is a null
/// pointer, or a surface has no such mesh
std::vector<Study> converge(const ConvergeOptions& options, const std::function<void(double)>& progress = {});

/// The unit of work of converge(), for callers with their own scheduling: one mesh of one surface.
struct ConvergeJob {
  std::size_t surface, family;  ///< indices into the options
  int resolution;
  int mesh = 0;  ///< index within a random family, from 0
};
/// All jobs of these options, the finest meshes first. \throws ParameterError as converge()
std::vector<ConvergeJob> converge_jobs(const ConvergeOptions& options);

/// The result of one job for one method, class and quantity.
struct LevelSample {
  std::string_view method;  ///< FrameMethod::name
  VertexClass vertex_class;
  std::string_view quantity;  ///< one of study_quantities
  Level level;                ///< errors in degrees, time in seconds
  double expected_order;      ///< for the chart as found on this mesh; the finest mesh decides
};
/// Runs one job. The result depends only on the job and on the methods, seed and range of v in the options.
/// Jobs may run concurrently in several threads, which disturbs `seconds`.
std::vector<LevelSample> run_converge_job(const ConvergeOptions& options, const ConvergeJob& job);

/// Combines the samples of all jobs into the studies that converge() returns; of_job[i] holds the samples of
/// jobs[i]. Studies with fewer than three levels are omitted, so a subset of the jobs gives a subset of the
/// studies. The samples must be of the methods in the options. \throws ParameterError unless of_job has one
/// entry per job
std::vector<Study> conclude_studies(const ConvergeOptions& options, const std::vector<ConvergeJob>& jobs,
                                    const std::vector<std::vector<LevelSample>>& of_job);

}  // namespace darboux
