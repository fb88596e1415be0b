#include <cstdint>
#include <cstdio>

#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/fit_mesh.h>
#include <darboux/io.h>
#include <darboux/torus.h>

namespace {

darboux::Mesh sampled(const darboux::Torus<double>& torus, std::uint32_t n) {
  darboux::Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const darboux::Vec2<double> uv{1.0 * i / n, 1.0 * k / n};
      mesh.uvs.push_back(uv);
      mesh.positions.push_back(jet(torus, uv.x, uv.y).position);
      if (i > 0 && k > 0) mesh.triangles.push_back({i * n + k, i * n + k - 1, (i - 1) * n + k});
    }
  return mesh;
}

}  // namespace

// 0 where the fit finds the torus it was given and a missing file is refused by name.
int uses_fit_and_io() {
  const darboux::MeshFit fit = darboux::fit_surface(sampled({1.0, 0.4}, 8), {"torus", {}});
  std::printf("rms distance %g after %d iterations\n", fit.rms, fit.iterations);
  try {
    darboux::read_asset("no_such_file.glb");
    return 1;
  } catch (const darboux::FileError& error) {
    std::puts(error.what());
  }
  return fit.fits ? 0 : 1;
}
