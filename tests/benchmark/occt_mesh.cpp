#include "occt_mesh.h"

#ifdef DARBOUX_BENCHMARK_OCCT_MESH

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>
#include <vector>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <TopoDS_Face.hxx>

namespace darboux::bench {
namespace {

constexpr double pi = 3.14159265358979323846;

struct Patch {
  Handle(Geom_Surface) surface;
  double u1, v0, v1;
};
Patch patch_of(const std::string& name) {
  const gp_Ax3 axes;
  if (name == "sphere") return {new Geom_SphericalSurface(axes, 1), 2 * pi, -pi / 2, pi / 2};
  if (name == "torus") return {new Geom_ToroidalSurface(axes, 1, 0.25), 2 * pi, 0, 2 * pi};
  if (name == "cylinder") return {new Geom_CylindricalSurface(axes, 1), 2 * pi, 0, 1};
  // OCCT's v of a cone runs along its side.
  return {new Geom_ConicalSurface(axes, -pi / 4, 1), 2 * pi, 0, std::sqrt(2.0)};
}

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

std::optional<OcctMesh> occt_mesh(const std::string& name, double chord, int rounds) {
  const Patch patch = patch_of(name);
  IMeshTools_Parameters asked;
  asked.Deflection = chord;
  asked.Angle = 10;  // radians: no bound
  asked.MinSize = 1e-9;
  asked.Relative = false;
  asked.InParallel = false;
  OcctMesh result;
  std::vector<double> times;
  Handle(Poly_Triangulation) mesh;
  for (int i = 0; i < rounds; ++i) {
    const TopoDS_Face face = BRepBuilderAPI_MakeFace(patch.surface, 0, patch.u1, patch.v0, patch.v1, 1e-9);
    const double start = cpu_seconds();
    BRepMesh_IncrementalMesh mesher(face, asked);
    times.push_back(cpu_seconds() - start);
    TopLoc_Location location;
    mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull()) return std::nullopt;
  }
  std::nth_element(times.begin(), times.begin() + rounds / 2, times.end());
  result.seconds = times[static_cast<std::size_t>(rounds / 2)];
  result.samples = static_cast<std::size_t>(mesh->NbNodes());
  result.triangles = static_cast<std::size_t>(mesh->NbTriangles());

  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform;
  for (int i = 0; i < 200000; ++i) {
    int node[3];
    mesh->Triangle(1 + static_cast<int>(random() % result.triangles)).Get(node[0], node[1], node[2]);
    double w[3] = {uniform(random), uniform(random), 0}, corners[3][3];
    if (w[0] + w[1] > 1) w[0] = 1 - w[0], w[1] = 1 - w[1];
    w[2] = 1 - w[0] - w[1];
    for (int k = 0; k < 3; ++k) mesh->Node(node[k]).Coord(corners[k][0], corners[k][1], corners[k][2]);
    result.errors.add(name, corners, w);
  }
  return result;
}

}  // namespace darboux::bench

#else

namespace darboux::bench {

std::optional<OcctMesh> occt_mesh(const std::string&, double, int) {
  return std::nullopt;
}

}  // namespace darboux::bench

#endif
