#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <darboux/converge.h>
#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/sample_mesh.h>
#include <darboux/statistics.h>

#include "base/degrees.h"
#include "base/text.h"

namespace darboux {
namespace {

constexpr MeshFamily families[] = {
    {"regular", "a grid, every cell cut along the same diagonal", 0, 0, false},
    {"sheared", "the same grid, its uvs sheared: u + v/2 is stored in place of u", 0.5, 0, false},
    {"jittered", "a grid whose inner vertices are moved at random by up to 0.15 of a cell", 0, 0.15, false},
    {"jittered-diagonals", "the same, every cell cut along a diagonal chosen at random", 0, 0.15, true},
    {"mirrored", "a grid whose second half has the uvs of the first, mirrored: 1 - |2u - 1| is stored", 0, 0,
     false, true},
    {"graded",
     "a grid whose cells grow smoothly from half the average in the middle to one and a half at the ends", 0,
     0, false, false, 0.5},
    {"inverted",
     "a grid whose inner vertices are moved at random by up to 0.35 of a cell: triangles turn over", 0, 0.35,
     false},
    {"shared-poles", "a grid all whose triangles at a pole share one vertex, which has one u", 0, 0, false,
     false, 0, MeshTopology::grid, PolePlacement::shared},
    {"lantern", "Schwarz's: as many rows as a quarter of the columns squared, every second one turned", 0, 0,
     false, false, 0, MeshTopology::lantern},
};

constexpr double above_floor = 10;    // a level is used where its rms is this many times its floor
constexpr std::size_t fit_least = 3;  // levels without which there is no order
constexpr double tolerance = 0.15;    // of an order
constexpr double orthogonal_below =
    // Tolerance for |cos| of the angle between dpdu and dpdv, and for the difference of their lengths: far
    // above rounding.
    1e-9;
// Positions and uvs rounded once to float: an edge errs by 2^-24 |P|, a tangent by twice that over the edge.
constexpr double single_precision_floor = 0x1p26;

constexpr auto& quantities = study_quantities;
enum Quantity : std::size_t { tangent, bitangent, normal };

double degrees(double radians) {
  return radians * degrees_per_radian;
}

// Whether the triangles of the family are so badly shaped that no order is expected.
bool promises_nothing(const MeshFamily& family, bool has_pole) {
  return family.jitter > 0.25 || family.topology == MeshTopology::lantern ||
         (has_pole && family.pole == PolePlacement::shared);
}

// A mesh with the exact frames at its vertices.
struct Reference {
  struct Truth {
    std::array<Vec3<double>, 3> of_quantity;  // directions, of any length
    bool exists;
  };
  Mesh mesh;
  std::vector<VertexClass> vertex_class;
  std::vector<Truth> truth;
  double h, floor_deg;
  Chart chart = Chart::conformal;            // the narrowest kind that holds everywhere, by the stored uvs
  Chart unsheared_chart = Chart::conformal;  // the same by u and v themselves
  bool has_pole = false;
  bool has_singular_line = false;
};

double floor_deg(const Mesh& mesh) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  double shortest = inf, shortest_uv = inf, largest = 0, largest_uv = 0;
  for (const Triangle& triangle : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      shortest = std::min(shortest, norm(mesh.positions[b] - mesh.positions[a]));
      shortest_uv =
          std::min(shortest_uv, std::hypot(mesh.uvs[b].x - mesh.uvs[a].x, mesh.uvs[b].y - mesh.uvs[a].y));
      largest = std::max(largest, norm(mesh.positions[a]));
      largest_uv = std::max(largest_uv, std::hypot(mesh.uvs[a].x, mesh.uvs[a].y));
    }
  return degrees(16 * 0x1p-53 * std::max(largest / shortest, largest_uv / shortest_uv));
}

double mean_edge(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& triangle : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      sum += norm(mesh.positions[triangle[(k + 1) % 3]] - mesh.positions[triangle[k]]) /
             static_cast<double>(mesh.corners());
  return sum;
}

Chart chart_at(const Sample<double>& sample, double du_dstored, const Vec3<double>& along_v) {
  if (std::fabs(dot(sample.frame.t, unit(along_v))) > orthogonal_below) return Chart::any;
  const double along_u = std::fabs(du_dstored) * norm(sample.jet.dpdu);
  return std::fabs(norm(along_v) / along_u - 1) > orthogonal_below ? Chart::orthogonal : Chart::conformal;
}

// Whether partials are infinite, zero or parallel along a line: at two neighbouring points, with different
// positions, of the grid of multiples of 1/16 in u and v. Rows outside the range are replaced by those at its
// ends.
bool has_singular_line(const AnySurface& surface, double v_first, double v_last) {
  constexpr int n = 16;
  constexpr double same_place = 1e-9;  // of the farthest point's distance from the origin: far above rounding
  std::array<std::optional<Vec3<double>>, n + 1> below, row;  // positions where it is singular
  double farthest = 0, apart = 0;
  const auto compare = [&](const auto& a, const auto& b) {
    if (a && b) apart = std::fmax(apart, norm(*a - *b));
  };
  for (int j = 0; j <= n; ++j) {
    const double v = std::clamp(j / double{n}, v_first, v_last);
    for (int i = 0; i <= n; ++i) {
      const Sample<double> s = surface.sample(i / double{n}, v);
      const bool finite = detail::finite(s.jet.dpdu) && detail::finite(s.jet.dpdv);
      const bool singular =
          !finite || has(s.frame.status, Status::dpdu_zero | Status::dpdv_zero | Status::parallel);
      row[i].reset();
      if (!detail::finite(s.jet.position)) continue;
      farthest = std::fmax(farthest, norm(s.jet.position));
      if (!singular) continue;
      row[i] = s.jet.position;
      compare(row[i], below[i]);
      if (i > 0) compare(row[i], row[i - 1]);
    }
    below = row;
  }
  return apart > same_place * farthest;
}

// The sample at a vertex of a mirrored mesh, and the derivative of u by the stored u. The stored u does not
// distinguish the two halves; the sign of the stored tangent does.
std::pair<Sample<double>, double> unmirrored(const AnySurface& surface, const Mesh& mesh,
                                             std::size_t vertex) {
  const auto [stored, v] = mesh.uvs[vertex];
  const Sample<double> first = surface.sample(stored / 2, v);
  if (tangent4(first.frame).w == mesh.tangents[vertex].w) return {first, 0.5};
  return {surface.sample(1 - stored / 2, v), -0.5};
}

Reference make_reference(const ConvergeOptions& options, const ConvergeJob& job) {
  const AnySurface& surface = options.surfaces[job.surface];
  const MeshFamily& family = *options.families[job.family];
  Reference r;
  r.mesh = sample_mesh(
      surface, mesh_options(family, job.resolution, options.seed + static_cast<std::uint64_t>(job.mesh),
                            options.v_first, options.v_last));
  std::vector<bool> is_pole;
  for (std::size_t i = 0; i < r.mesh.uvs.size(); ++i) {
    const Vec2<double>& stored = r.mesh.uvs[i];
    const auto [sample, du_dstored] =
        family.mirror ? unmirrored(surface, r.mesh, i)
                      : std::pair{surface.sample(stored.x - family.shear * stored.y, stored.y), 1.0};
    const Status status = sample.frame.status;
    // By the stored (u + K v, v): d/du is dpdu, d/dv is dpdv - K dpdu. t is along dpdu, also in the limit,
    // and opposite to it where the uvs are mirrored.
    const Vec3<double> along_v = sample.jet.dpdv - family.shear * sample.jet.dpdu;
    r.truth.push_back(
        {{du_dstored < 0 ? -sample.frame.t : sample.frame.t, along_v, sample.frame.n},
         !has(status, Status::no_frame | Status::non_finite_input | Status::overflow | Status::dpdv_zero)});
    is_pole.push_back(has(status, Status::dpdu_zero | Status::dpdv_zero | Status::parallel));
    r.has_pole = r.has_pole || is_pole.back();
    if (is_pole.back()) continue;
    r.chart = std::min(r.chart, chart_at(sample, du_dstored, along_v));
    r.unsheared_chart = std::min(r.unsheared_chart, chart_at(sample, du_dstored, sample.jet.dpdv));
  }
  r.has_singular_line = has_singular_line(surface, options.v_first, options.v_last);
  r.vertex_class = classify(r.mesh, is_pole).of_vertex;
  r.floor_deg = floor_deg(r.mesh);
  r.h = mean_edge(r.mesh);
  return r;
}

// Runs a method until 2 ms have passed, three times if that takes less than 20 ms. `seconds` receives the
// time of the best run.
MeshFrames timed_frames(const Mesh& mesh, const FrameMethod& method, double& seconds) {
  using Clock = std::chrono::steady_clock;
  seconds = std::numeric_limits<double>::infinity();
  MeshFrames frames;
  double total = 0;
  int runs = 0;
  do {
    const auto start = Clock::now();
    frames = mesh_frames(mesh, method);
    const double once = std::chrono::duration<double>(Clock::now() - start).count();
    seconds = std::min(seconds, once);
    total += once;
    ++runs;
  } while (total < 2e-3 || (runs < 3 && total < 2e-2));
  return frames;
}

bool answers(const FrameMethod& method, std::size_t quantity) {
  return quantity != normal || !method.needs_normals;  // the others return the normals of the mesh
}

double expected_order(const FrameMethod& method, const MeshFamily& family, VertexClass vertex_class,
                      std::size_t quantity, const Reference& reference) {
  if (promises_nothing(family, reference.has_pole) || reference.has_singular_line) return 0;
  const bool irregular = family.is_random();
  const auto of_family = [&](const ExpectedOrders& orders) {
    return irregular ? orders.jittered : orders.regular;
  };
  const Chart needed = quantity == normal      ? Chart::any
                       : quantity == bitangent ? method.bitangent_chart
                                               : method.tangent_chart;
  const bool suits = reference.chart >= needed;
  const ExpectedOrders& at_poles = quantity == normal      ? method.at_poles.normal
                                   : quantity == bitangent ? method.at_poles.bitangent
                                                           : method.at_poles.tangent;
  const double beside_poles = of_family(at_poles);
  if (vertex_class == VertexClass::pole || vertex_class == VertexClass::pole_ring) {
    if (reference.unsheared_chart < needed) return 0;
    // Towards a pole dpdu vanishes, and with it the obliqueness that a shear causes: like h.
    const double order = suits ? beside_poles : std::min(beside_poles, 1.0);
    if (vertex_class == VertexClass::pole_ring) return order;
    // The triangles of a pole lie on one side of it. Where dpdu = 0, the derivative of a polynomial has an
    // arbitrary direction.
    if (method.reach > 1) return quantity == bitangent ? order : 0;
    return std::min(order, 1.0);
  }
  if (!suits) return 0;
  double order = method.direction.jittered;
  if (vertex_class == VertexClass::interior && !irregular) {
    order = method.direction.regular;
    // The stencils of vertices next to a border are one-sided; the share of these vertices decreases like h.
    if (method.reach > 1) order = std::min(order, method.direction.jittered + 0.5);
  }
  if (!reference.has_pole) return order;
  // The direction of a single triangle is wrong only next to a pole: a share h of all.
  if (method.reach == 0) return std::min(order, beside_poles + 0.5);
  // Seams and borders that end in poles: one-sided stencils lose half an order there.
  const bool one_sided = vertex_class != VertexClass::interior;
  if (one_sided && order > 1) order -= 0.5;
  if (beside_poles == 0) return 0;
  // If cells are widest at a seam that ends in poles, this affects the interior: the stencils of a share h
  // reach it.
  if (family.grading > 0 && method.reach > 1) order = std::min(order, method.direction.jittered);
  // Vertices next to a pole have an effect, too, with the order of irregular meshes.
  if (one_sided) return std::min(order, std::min(beside_poles, at_poles.jittered) + 0.5);
  return std::min(order, beside_poles + (irregular && beside_poles < 1 ? 0.25 : 0.5));
}

OrderVerdict judge_order(const Study& study) {
  if (std::isnan(study.order)) return OrderVerdict::at_the_floor;
  const double expected = study.expected_order;
  const bool falls = study.order >= least_order;
  if (expected == 0 && !falls) return OrderVerdict::does_not_converge;
  if (study.order_high < expected - tolerance)
    return falls ? OrderVerdict::slower : OrderVerdict::does_not_converge;
  if (study.order_low > expected + tolerance) return OrderVerdict::faster;
  return OrderVerdict::as_expected;
}

// Chooses the levels, fits the orders and judges them.
void conclude(Study& study) {
  std::vector<ErrorsAtWidth> rms, max;
  std::vector<Level*> of_width;
  for (Level& level : study.levels) {
    level.used = *std::min_element(level.rms_of_mesh.begin(), level.rms_of_mesh.end()) >
                     above_floor * level.floor_deg &&
                 (rms.empty() || level.h < rms.back().h);
    if (!level.used) continue;
    rms.push_back({level.h, level.rms_of_mesh});
    max.push_back({level.h, level.max_of_mesh});
    of_width.push_back(&level);
  }
  const OrderEstimate estimate = estimate_order(rms);
  for (std::size_t i = 0; i < estimate.first; ++i) of_width[i]->used = false;
  study.order = estimate.order;
  study.order_low = estimate.low;
  study.order_high = estimate.high;
  study.max_order = estimate_order(max).order;
  study.verdict = judge_order(study);
}

// Combines several random meshes of one resolution into one level.
Level pooled(const std::vector<Level>& meshes) {
  Level all = meshes.front();
  const auto count = static_cast<double>(meshes.size());
  double squares = 0;
  all.h = all.p95_deg = all.seconds = 0;
  all.corners = all.fallback = 0;
  for (const Level& mesh : meshes) {
    all.h += mesh.h / count;
    all.p95_deg += mesh.p95_deg / count;
    all.seconds += mesh.seconds / count;
    all.max_deg = std::max(all.max_deg, mesh.max_deg);
    all.floor_deg = std::max(all.floor_deg, mesh.floor_deg);
    all.corners += mesh.corners;
    all.fallback += mesh.fallback;
    squares += mesh.rms_deg * mesh.rms_deg * static_cast<double>(mesh.corners - mesh.fallback);
    all.rms_of_mesh.push_back(mesh.rms_deg);
    all.max_of_mesh.push_back(mesh.max_deg);
  }
  if (meshes.size() > 1) all.rms_deg = std::sqrt(squares / static_cast<double>(all.corners - all.fallback));
  return all;
}

// Adds a sample per class and quantity with corners.
void measure(const Reference& reference, const FrameMethod& method, const MeshFamily& family, int n,
             std::vector<LevelSample>& samples) {
  double seconds;
  const MeshFrames frames = timed_frames(reference.mesh, method, seconds);
  struct Errors {
    std::array<std::vector<double>, quantities.size()> deg;
    std::size_t corners = 0, fallback = 0;
  };
  std::array<Errors, vertex_class_names.size()> of_class;
  // Averages give one frame per vertex: its errors are reused for the other corners of the vertex.
  std::vector<std::uint32_t> vertex_of_frame(frames.frames.size(), static_cast<std::uint32_t>(-1));
  std::vector<std::array<double, quantities.size()>> error_of_frame(frames.frames.size());
  for (std::size_t c = 0; c < reference.mesh.corners(); ++c) {
    const std::uint32_t vertex = reference.mesh.triangles[c / 3][c % 3], index = frames.of_corner[c];
    const Reference::Truth& truth = reference.truth[vertex];
    if (!truth.exists) continue;
    Errors& errors = of_class[static_cast<std::size_t>(reference.vertex_class[vertex])];
    ++errors.corners;
    const CornerFrame& frame = frames.frames[index];
    if (frame.fallback) {
      ++errors.fallback;
      continue;
    }
    const std::array<Vec3<double>, quantities.size()> found{frame.t, frame.b, frame.n};
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      if (!answers(method, q)) continue;
      double& error = error_of_frame[index][q];
      if (vertex_of_frame[index] != vertex) error = degrees(angle_between(found[q], truth.of_quantity[q]));
      errors.deg[q].push_back(error);
    }
    vertex_of_frame[index] = vertex;
  }
  for (std::size_t k = 0; k < of_class.size(); ++k)
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      Errors& errors = of_class[k];
      if (errors.deg[q].empty()) continue;
      const Statistics s = summarise(errors.deg[q]);
      const double floor_deg =
          method.single_precision ? single_precision_floor * reference.floor_deg : reference.floor_deg;
      const auto vertex_class = static_cast<VertexClass>(k);
      samples.push_back(
          {method.name,
           vertex_class,
           quantities[q],
           {n, reference.h, s.max, s.rms, s.p95, floor_deg, seconds, errors.corners, errors.fallback, false},
           expected_order(method, family, vertex_class, q, reference)});
    }
}

void check(const ConvergeOptions& o) {
  if (o.resolutions.size() < fit_least)
    throw ParameterError("resolutions",
                         expected_got("at least 3, to fit an order", std::to_string(o.resolutions.size())));
  for (std::size_t i = 0; i < o.resolutions.size(); ++i)
    if (o.resolutions[i] < (i == 0 ? 2 : o.resolutions[i - 1] + 1))
      throw ParameterError(
          "resolutions", expected_got("increasing numbers from 2",
                                      std::to_string(o.resolutions[i]) +
                                          (i == 0 ? "" : " after " + std::to_string(o.resolutions[i - 1]))));
  if (o.seeds < 1) throw ParameterError("seeds", expected_got("at least 1", std::to_string(o.seeds)));
  if (std::count(o.families.begin(), o.families.end(), nullptr) > 0)
    throw ParameterError("families", expected_got("pointers into mesh_families()", "a null pointer"));
  if (std::count(o.methods.begin(), o.methods.end(), nullptr) > 0)
    throw ParameterError("methods", expected_got("pointers into frame_methods()", "a null pointer"));
  for (const MeshFamily* family : o.families)
    if (family->topology != MeshTopology::grid || family->pole != PolePlacement::per_column)
      for (const AnySurface& surface : o.surfaces) try {
          sample_mesh(surface, mesh_options(*family, o.resolutions.front(), o.seed, o.v_first, o.v_last));
        } catch (const ParameterError& e) {
          throw ParameterError("meshes", std::string(family->name) + ": " + e.what());
        }
}

}  // namespace

std::span<const MeshFamily> mesh_families() {
  return families;
}

const MeshFamily& find_mesh_family(std::string_view name) {
  std::string known;
  for (const MeshFamily& family : families) {
    if (family.name == name) return family;
    known += (known.empty() ? "" : ", ") + std::string(family.name);
  }
  throw ParameterError("meshes", expected_got("one of " + known, "'" + std::string(name) + "'"));
}

SampleMeshOptions mesh_options(const MeshFamily& family, int rows, std::uint64_t seed, double v_first,
                               double v_last) {
  const bool lantern = family.topology == MeshTopology::lantern;
  return {.topology = family.topology,
          .columns = lantern ? std::max(3, static_cast<int>(std::lround(2 * std::sqrt(rows)))) : 2 * rows,
          .rows = rows,
          .pole = family.pole,
          .jitter = family.jitter,
          .random_diagonals = family.random_diagonals,
          .grading = family.grading,
          .seed = seed,
          .shear = family.shear,
          .mirror = family.mirror,
          .v_first = v_first,
          .v_last = v_last};
}

std::vector<ConvergeJob> converge_jobs(const ConvergeOptions& options) {
  check(options);
  std::vector<ConvergeJob> jobs;
  for (auto n = options.resolutions.rbegin(); n != options.resolutions.rend(); ++n)
    for (std::size_t s = 0; s < options.surfaces.size(); ++s)
      for (std::size_t f = 0; f < options.families.size(); ++f) {
        const int meshes = options.families[f]->is_random() && *n <= finest_repeated ? options.seeds : 1;
        for (int mesh = 0; mesh < meshes; ++mesh) jobs.push_back({s, f, *n, mesh});
      }
  return jobs;
}

std::vector<LevelSample> run_converge_job(const ConvergeOptions& options, const ConvergeJob& job) {
  const MeshFamily& family = *options.families[job.family];
  const Reference reference = make_reference(options, job);
  std::vector<LevelSample> samples;
  for (const FrameMethod* method : options.methods)
    measure(reference, *method, family, job.resolution, samples);
  return samples;
}

std::vector<Study> conclude_studies(const ConvergeOptions& options, const std::vector<ConvergeJob>& jobs,
                                    const std::vector<std::vector<LevelSample>>& of_job) {
  if (of_job.size() != jobs.size())
    throw ParameterError(
        "of_job", expected_got("one per job, " + std::to_string(jobs.size()), std::to_string(of_job.size())));
  // By surface, family, method, class and quantity, in the order of the options.
  using Key = std::array<std::size_t, 5>;
  std::map<Key, Study> studies;
  std::map<Key, std::map<int, std::vector<Level>>> levels;  // by resolution
  std::map<Key, int> finest;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (const LevelSample& sample : of_job[i]) {
      const auto method = std::find_if(options.methods.begin(), options.methods.end(),
                                       [&](const FrameMethod* m) { return m->name == sample.method; });
      const Key key{
          jobs[i].surface, jobs[i].family, static_cast<std::size_t>(method - options.methods.begin()),
          static_cast<std::size_t>(sample.vertex_class),
          static_cast<std::size_t>(std::find(quantities.begin(), quantities.end(), sample.quantity) -
                                   quantities.begin())};
      Study& study = studies[key];
      study.surface = options.surfaces[jobs[i].surface].specification();
      study.v_first = options.v_first;
      study.v_last = options.v_last;
      study.mesh = options.families[jobs[i].family]->name;
      study.method = sample.method;
      study.vertex_class = sample.vertex_class;
      study.quantity = sample.quantity;
      levels[key][sample.level.resolution].push_back(sample.level);
      if (int& n = finest[key]; sample.level.resolution > n) {  // the kind of chart is determined best there
        n = sample.level.resolution;
        study.expected_order = sample.expected_order;
      }
    }
  std::vector<Study> result;
  for (auto& [key, study] : studies) {
    for (const auto& [resolution, meshes] : levels[key]) study.levels.push_back(pooled(meshes));
    if (study.levels.size() < fit_least) continue;  // two meshes do not determine an order
    conclude(study);
    result.push_back(std::move(study));
  }
  return result;
}

std::vector<Study> converge(const ConvergeOptions& options, const std::function<void(double)>& progress) {
  const std::vector<ConvergeJob> jobs = converge_jobs(options);
  std::vector<std::vector<LevelSample>> of_job;
  const auto cells = [](const ConvergeJob& job) { return 2.0 * job.resolution * job.resolution; };
  double work = 0, done = 0;
  for (const ConvergeJob& job : jobs) work += cells(job);
  for (const ConvergeJob& job : jobs) {
    of_job.push_back(run_converge_job(options, job));
    done += cells(job);
    if (progress) progress(done / work);
  }
  return conclude_studies(options, jobs, of_job);
}

}  // namespace darboux
