// How far are tangents averaged over triangles from the truth? On a grid, and on a mesh that follows no
// coordinate line.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <darboux/mesh_frames.h>
#include <darboux/sample_mesh.h>
#include <darboux/sphere.h>

// The largest angle between a method's tangent and the stored, exact one, in degrees, poles and their
// neighbours left out.
double worst_angle(const darboux::Mesh& mesh) {
  const darboux::MeshFrames frames = mesh_frames(mesh, darboux::find_frame_method("angle"));
  double worst = 0;
  for (std::size_t corner = 0; corner < mesh.corners(); ++corner) {
    const std::uint32_t v = mesh.triangles[corner / 3][corner % 3];
    if (std::fabs(mesh.uvs[v].y - 0.5) > 0.25 || std::fabs(mesh.uvs[v].x - 0.5) > 0.25) continue;
    worst = std::max(worst, darboux::angle_between(frames.corner(corner).t, mesh.tangents[v].xyz()));
  }
  return worst * 180 / std::numbers::pi;
}

int main() {
  const darboux::AnySurface sphere = darboux::Sphere{1.0};
  for (const int n : {16, 32, 64}) {
    const darboux::Mesh grid = sample_mesh(sphere, {.columns = 4 * n, .rows = 2 * n});
    const darboux::Mesh icosphere =
        sample_mesh(sphere, {.topology = darboux::MeshTopology::icosphere, .subdivisions = n});
    std::printf("n = %2d   grid %8.1e   icosphere %6.4f\n", n, worst_angle(grid), worst_angle(icosphere));
  }
}
