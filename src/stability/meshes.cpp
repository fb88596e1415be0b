// Meshes: what rounding of positions, uvs and normals, jitter and thin triangles do to the methods' frames.
#include <algorithm>
#include <cmath>
#include <limits>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>

#include "base/bounds.h"
#include "measure.h"

namespace darboux::sweeps {
namespace {

constexpr double not_stated = std::numeric_limits<double>::quiet_NaN();
constexpr int columns = 16, rows = 8;
constexpr std::size_t tangents_quantity = 6, normals_quantity = 7;
// A position errs by a unit in each coordinate, an edge by twice that, and a tangent depends on two edges. No
// bound is stated for polynomials through many vertices.
constexpr double times_condition = 16;

// Excludes poles, near which tangents turn within a cell.
Mesh mesh_of(const AnySurface& surface, double jitter, double strip, std::uint64_t seed) {
  return sample_mesh(surface, {.columns = columns,
                               .rows = rows,
                               .jitter = jitter,
                               .seed = seed,
                               .v_first = 0.5 - 0.35 * strip,
                               .v_last = 0.5 + 0.35 * strip});
}

// ---- rounding ---------------------------------------------------------------------------------------------

double stepped(double x, double step) {
  return std::nearbyint(x / step) * step;
}
double in_float(double x) {
  const volatile float result = static_cast<float>(x);
  return result;
}

// A unit vector folded onto the square [-1, 1]², its coordinates rounded, and unfolded. [Cigolle2014]
Vec3<double> octahedral(const Vec3<double>& n, double step) {
  const double sum = std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z);
  const auto sign = [](double x) { return x < 0 ? -1.0 : 1.0; };
  double x = n.x / sum, y = n.y / sum;
  if (n.z < 0) {
    const double folded = (1 - std::fabs(y)) * sign(x);
    y = (1 - std::fabs(x)) * sign(y);
    x = folded;
  }
  x = stepped(x, step);
  y = stepped(y, step);
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z >= 0) return unit(Vec3<double>{x, y, z});
  return unit(Vec3<double>{(1 - std::fabs(y)) * sign(x), (1 - std::fabs(x)) * sign(y), z});
}

// The lowest altitude of a triangle.
double altitude_in_space(const Mesh& mesh) {
  double lowest = laws::infinity;
  for (const Triangle& t : mesh.triangles) {
    const Vec3<double> a = mesh.positions[t[1]] - mesh.positions[t[0]],
                       b = mesh.positions[t[2]] - mesh.positions[t[0]];
    const double longest = std::fmax(norm(a), std::fmax(norm(b), norm(b - a)));
    lowest = std::fmin(lowest, norm(cross(a, b)) / longest);
  }
  return lowest;
}

// The factor by which an error of the uvs turns T or B of a triangle, or a plane fitted to positions over
// uvs: one over the altitude in uv, times the ratio of the singular values of the map from uv to space. An
// error adds a share of the longer direction to the shorter.
double condition_of_uvs(const Mesh& mesh) {
  double largest = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3<double> a = mesh.positions[t[1]] - mesh.positions[t[0]],
                       b = mesh.positions[t[2]] - mesh.positions[t[0]];
    const Vec2<double> p = mesh.uvs[t[1]] - mesh.uvs[t[0]], q = mesh.uvs[t[2]] - mesh.uvs[t[0]];
    const double twice_area = std::fabs(p.x * q.y - p.y * q.x),
                 longest = std::fmax(norm(p), std::fmax(norm(q), norm(q - p)));
    const Vec3<double> T = q.y * a - p.y * b, B = p.x * b - q.x * a;  // times twice the uv area
    const double E = dot(T, T), F = dot(T, B), G = dot(B, B);
    // The larger eigenvalue of [[E, F], [F, G]] over the root of the product of both, |T x B|.
    const double stretch = (E + G + std::hypot(E - G, 2 * F)) / 2 / norm(cross(T, B));
    largest = std::fmax(largest, stretch * longest / twice_area);
  }
  return largest;
}

// The least cosine between a triangle's normal and those stored at its corners: T is projected along them, or
// solved for with them.
double least_cosine(const Mesh& mesh) {
  double least = 1;
  for (const Triangle& t : mesh.triangles) {
    const Vec3<double> a = mesh.positions[t[1]] - mesh.positions[t[0]],
                       b = mesh.positions[t[2]] - mesh.positions[t[0]];
    for (const std::uint32_t corner : t)
      least = std::fmin(least, dot(unit(cross(a, b)), mesh.normals[corner]));
  }
  return std::fmax(least, 0);
}

// The mesh as stored, half the rounding step, and the largest factor by which an error of that size turns a
// tangent.
struct Stored {
  Mesh mesh;
  double half_step, condition;
  bool needs_normals = false;  // else no method sees a difference
};

Stored stored(const Mesh& exact, std::string_view sweep, double x) {
  Stored result{exact, x / 2, 1};
  Mesh& mesh = result.mesh;
  Bounds box;
  for (const Vec3<double>& p : mesh.positions) box.add(p);
  const Vec3<double>& low = box.low;
  const double size = box.longest_side();
  if (sweep == "float_offset") {
    double largest = 0;
    for (Vec3<double>& p : mesh.positions) {
      p = {in_float(p.x + x), in_float(p.y - x), in_float(p.z + x / 2)};
      largest = std::fmax(largest, norm(p));
    }
    result.half_step = 0x1p-24;
    result.condition = largest / altitude_in_space(exact);
  } else if (sweep == "quantisation") {
    const double step = x * size;
    for (Vec3<double>& p : mesh.positions)
      p = low +
          Vec3<double>{stepped(p.x - low.x, step), stepped(p.y - low.y, step), stepped(p.z - low.z, step)};
    result.condition = size / altitude_in_space(exact);
  } else if (sweep == "uv_quantisation") {
    for (Vec2<double>& uv : mesh.uvs) uv = {stepped(uv.x, x), stepped(uv.y, x)};
    result.condition = condition_of_uvs(exact);
  } else {
    for (Vec3<double>& n : mesh.normals) n = octahedral(n, x);
    result.needs_normals = true;
  }
  return result;
}

// ---- comparison -------------------------------------------------------------------------------------------

// The largest angle between two frames of the same corner, and its location.
struct Largest {
  double angle = 0;
  std::size_t corner = 0;
  void note(double a, std::size_t c) {
    if (a <= angle) return;
    angle = a;
    corner = c;
  }
};

class Measure {
 public:
  Measure(const StabilityOptions& options, const StabilitySweep& sweep, const AnySurface& surface)
      : options_(options), sweep_(sweep), surface_(surface) {}

  std::vector<Measurement> run() {
    const bool rounding = sweep_.name != "jitter" && sweep_.name != "slivers";
    const Mesh exact = rounding ? mesh_of(surface_, 0.1, 1, options_.seed) : Mesh{};
    cosine_ = least_cosine(exact);
    for (std::size_t r = 0; r < options_.routes.size(); ++r) {
      if (options_.routes[r]->domain != StabilityDomain::meshes) continue;
      const FrameMethod& method = find_frame_method(options_.routes[r]->name);
      const MeshFrames of_exact = rounding ? mesh_frames(exact, method) : MeshFrames{};
      for (const double x : values_of_x(options_, sweep_)) {
        if (rounding)
          compare_rounded(r, method, exact, of_exact, x);
        else
          compare_with_truth(r, method, x);
      }
    }
    return std::move(result_);
  }

 private:
  void add(std::size_t route, double x, std::size_t quantity, const Largest& largest, const Mesh& mesh,
           double unit, double bound, double condition) {
    const Vec2<double>& uv = mesh.uvs[mesh.triangles[largest.corner / 3][largest.corner % 3]];
    result_.push_back(
        {route,
         x,
         {quantity, quantity == tangents_quantity ? "tangent" : "normal", {largest.angle, bound, condition}},
         unit,
         uv.x,
         uv.y,
         surface_.specification()});
  }

  void compare_rounded(std::size_t r, const FrameMethod& method, const Mesh& exact,
                       const MeshFrames& of_exact, double x) {
    const Stored s = stored(exact, sweep_.name, x);
    if (s.needs_normals && !method.needs_normals) return;
    // The method's own rounding to float counts as rounding of the data.
    double unit = s.half_step;
    if (method.single_precision) unit = std::fmax(unit, 0x1p-24);
    double condition =
        method.single_precision ? std::fmax(s.condition, condition_of_uvs(exact)) : s.condition;
    if (method.needs_normals) condition /= cosine_ * cosine_;
    // A perturbation as large as the triangles has no bound.
    if (!(condition * unit < 0.05)) return;
    const MeshFrames found = mesh_frames(s.mesh, method);
    Largest t, n;
    for (std::size_t c = 0; c < exact.corners(); ++c) {
      const CornerFrame &a = of_exact.corner(c), &b = found.corner(c);
      if (a.fallback || b.fallback) continue;
      t.note(angle_between(a.t, b.t), c);
      n.note(angle_between(a.n, b.n), c);
    }
    const double bound = method.reach > 1 ? not_stated : times_condition * condition * unit;
    add(r, x, tangents_quantity, t, exact, unit, bound, condition);
    if (!method.needs_normals) add(r, x, normals_quantity, n, exact, unit, bound, condition);
  }

  void compare_with_truth(std::size_t r, const FrameMethod& method, double x) {
    const bool thin = sweep_.name == "slivers";
    const Mesh mesh = mesh_of(surface_, thin ? 0 : x, thin ? x : 1, options_.seed);
    const MeshFrames found = mesh_frames(mesh, method);
    Largest t;
    for (std::size_t c = 0; c < mesh.corners(); ++c) {
      const Vec4<double>& truth = mesh.tangents[mesh.triangles[c / 3][c % 3]];
      if (!found.corner(c).fallback) t.note(angle_between(found.corner(c).t, {truth.x, truth.y, truth.z}), c);
    }
    add(r, x, tangents_quantity, t, mesh, 1.0 / rows, not_stated, 1);
  }

  const StabilityOptions& options_;
  const StabilitySweep& sweep_;
  const AnySurface& surface_;
  std::vector<Measurement> result_;
  double cosine_ = 1;  // between triangles and stored normals, the least
};

}  // namespace

std::vector<Measurement> measure_meshes(const StabilityOptions& options, const StabilitySweep& sweep,
                                        const AnySurface& surface) {
  try {
    return Measure(options, sweep, surface).run();
  } catch (const Error&) {
    return {};  // it cannot be meshed
  }
}

}  // namespace darboux::sweeps
