/// \file converge.h
/// Orders of convergence of mesh frames towards the truth, and error against run time.
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

/// A family of meshes over a surface, one for every resolution.
struct MeshFamily {
  std::string_view name, summary;
  double shear = 0;   ///< K: stored uvs are (u + K v, v)
  double jitter = 0;  ///< interior vertices move by up to ± this share of a cell
  bool random_diagonals = false;
  bool mirror = false;  ///< stored u is 1 - |2u - 1|: the second half's uvs are those of the first, mirrored
  double grading = 0;   ///< SampleMeshOptions::grading
  MeshTopology topology = MeshTopology::grid;
  PolePlacement pole = PolePlacement::per_column;

  /// Whether there is another mesh for each seed.
  bool is_random() const { return jitter > 0 || random_diagonals; }
};
/// regular, sheared (K = 0.5), jittered (0.15 of a cell: no triangle is inverted), jittered-diagonals,
/// mirrored, graded (0.5: cells from half to one and a half times the average); and three on which much does
/// not converge, so that no order is expected (for shared-poles: none on surfaces with poles):
///   inverted      jittered by 0.35 of a cell
///   shared-poles  all triangles at a pole share one vertex, which has one u
///   lantern       Schwarz's, with n rows and 2 sqrt(n) columns, as many as n/m² = 1/4 takes, at least 3; of
///                 tubes without poles
std::span<const MeshFamily> mesh_families();
/// \throws ParameterError listing the known names
const MeshFamily& find_mesh_family(std::string_view name);
/// The mesh of a family with so many rows and, but for the lantern, twice as many columns, for sample_mesh().
SampleMeshOptions mesh_options(const MeshFamily& family, int rows, std::uint64_t seed, double v_first = 0,
                               double v_last = 1);

/// What became of the order that was expected.
enum class OrderVerdict : std::uint8_t {
  as_expected,        ///< the expected order lies within 0.15 of the 95 % interval
  faster,             ///< the whole interval lies more than 0.15 above it
  slower,             ///< the whole interval lies more than 0.15 below it
  does_not_converge,  ///< the order is below 0.15, and none was expected or the whole interval lies below
  at_the_floor,       ///< fewer than three resolutions above what rounding alone may cause: no order
};
inline constexpr std::array<std::string_view, 5> order_verdict_names{"as expected", "faster", "slower",
                                                                     "does not converge", "at the floor"};

/// The errors at one resolution, in degrees over the triangle corners of the study's class. Of several random
/// meshes together: h, p95_deg and seconds are means, max_deg and floor_deg the largest.
struct Level {
  int resolution;  ///< n: n rows, 2n columns
  double h;        ///< mesh width: the mean length of the triangles' edges
  double max_deg, rms_deg, p95_deg;
  /// What rounding alone may cause: 16u |P|max / (shortest edge), u = 2^-53. A position errs by about 4u |P|,
  /// an edge by twice that, and a tangent is made of two edges. Stored uvs are rounded too: where (largest
  /// uv) / (shortest edge in uv) is greater, that takes the place of the quotient.
  double floor_deg;
  double seconds;                 ///< of the method on the whole mesh: the best of several runs, one thread
  std::size_t corners, fallback;  ///< corners of the class; those that no triangle serves, which are left out
  bool used;                      ///< enters the fit of the order
  std::vector<double> rms_of_mesh{}, max_of_mesh{};  ///< of each random mesh, by seed; one of others
};

inline constexpr double least_order = 0.15;  ///< below it nothing converges

/// One question: how does one error fall with the mesh width, for one surface, family, method, class of
/// vertex and quantity.
struct Study {
  std::string surface;  ///< as AnySurface::specification() writes it
  double v_first = 0, v_last = 1;
  std::string_view mesh, method;
  VertexClass vertex_class;
  /// "tangent": against dpdu by the stored u; "bitangent": the method's b against dpdv by the stored v;
  /// "normal", for methods that make their own: against n.
  std::string_view quantity;
  std::vector<Level> levels;  ///< coarse to fine
  /// estimate_order() of the rms, over the levels at which the rms of every mesh exceeds ten times the floor.
  /// NaN if there are fewer than three such levels.
  double order, order_low, order_high;
  double max_order;  ///< the same of the largest errors
  /// 0: not expected to converge. This holds for any surface whose partials are zero, parallel or infinite
  /// along a line. Such a line is looked for at multiples of 1/16 in u and v only.
  double expected_order;
  OrderVerdict verdict;

  /// Whether the largest error falls. (The rms may fall merely because wrong corners become rare.)
  bool max_converges() const { return !(max_order < least_order); }
  /// Whether it does at least what was expected.
  bool holds() const {
    return verdict != OrderVerdict::slower &&
           (verdict != OrderVerdict::does_not_converge || expected_order == 0);
  }
};

/// What a study may measure.
inline constexpr std::array<std::string_view, 3> study_quantities{"tangent", "bitangent", "normal"};

inline constexpr int finest_repeated = 256;

/// What to run: every combination of surface, family and method.
struct ConvergeOptions {
  std::vector<AnySurface> surfaces;
  std::vector<const FrameMethod*> methods;
  std::vector<const MeshFamily*> families;
  std::vector<int> resolutions{8, 16, 32, 64, 128, 256};  ///< at least three, rising, each at least 2
  std::uint64_t seed = 1;                                 ///< of the first random mesh
  /// Meshes of each random family at each resolution, with seeds seed, seed + 1, ...; at least 1. With more
  /// than finest_repeated rows there is only one mesh, as its errors scatter less.
  int seeds = 3;
  double v_first = 0, v_last = 1;  ///< the part of the surface that is meshed
};

/// Runs every combination; classes without corners give no study. The orders expected, per class:
///   interior          the method's own, FrameMethod::direction; half an order less where the method uses
///                     vertices two edges away, which are missing next to a border
///   border, seam      the method's on irregular meshes
///   pole_ring         FrameMethod::at_poles
///   pole              the same, at most 1; 0 for t and n of methods that use vertices two edges away
/// On a mesh with poles the other classes converge more slowly, since the rows next to a pole are a share h
/// of all. Methods that use one triangle at a time: at most half an order faster than pole_ring. Other
/// methods: the interior is at most half an order faster than pole_ring; on irregular meshes at most a
/// quarter faster if pole_ring is below 1, and no faster if it is 0. Seam and border: half an order less than
/// 2 or 3, as measured, and on irregular meshes at most half an order faster than pole_ring. On graded meshes
/// with poles, polynomials are expected to have no higher order in the interior than on irregular meshes. The
/// order is 0 if the method is not made for the chart, if nothing is expected of the family, or if the
/// surface is singular along a line. A family's shear vanishes at the poles: pole and pole_ring go by the
/// chart without shear, with an order of at most 1 if the method is not made for the sheared chart. \param
/// progress called with the share done, in [0, 1] \throws ParameterError when the resolutions or the range of
/// v are not as above, a family or method is a null pointer, or a surface has no such mesh
std::vector<Study> converge(const ConvergeOptions& options, const std::function<void(double)>& progress = {});

/// The pieces that converge() is made of, for those who run them elsewhere: one mesh of one surface each.
struct ConvergeJob {
  std::size_t surface, family;  ///< places in the options
  int resolution;
  int mesh = 0;  ///< of a random family, from 0
};
/// All jobs of the options, the finest meshes first. \throws ParameterError as converge()
std::vector<ConvergeJob> converge_jobs(const ConvergeOptions& options);

/// What one job measured of one method, class and quantity.
struct LevelSample {
  std::string_view method;  ///< FrameMethod::name
  VertexClass vertex_class;
  std::string_view quantity;  ///< one of study_quantities
  Level level;                ///< errors in degrees, time in seconds
  double expected_order;      ///< by the chart as this mesh shows it; the finest mesh decides
};
/// The samples of one mesh. Depends on the options' methods, seed and range of v, and on the job alone; jobs
/// may run on several threads at once, which disturbs `seconds`.
std::vector<LevelSample> run_converge_job(const ConvergeOptions& options, const ConvergeJob& job);

/// The studies of all samples, of_job[i] being those of jobs[i]: what converge() returns. Those with fewer
/// than three levels are left out, so that part of the jobs gives part of the studies. The samples are of the
/// options' methods. \throws ParameterError where of_job is not one per job
std::vector<Study> conclude_studies(const ConvergeOptions& options, const std::vector<ConvergeJob>& jobs,
                                    const std::vector<std::vector<LevelSample>>& of_job);

}  // namespace darboux
