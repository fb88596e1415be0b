// Mesh frames by every method over arbitrary triangles: t, b and n are unit, also of fallbacks.
#include <cmath>

#include <darboux/mesh_frames.h>

#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  fuzz::Bytes bytes(data, size);
  Mesh mesh;
  const std::size_t vertices = 3 + bytes.take<std::uint8_t>() % 12,
                    triangles = 1 + bytes.take<std::uint8_t>() % 12;
  for (std::size_t i = 0; i < triangles; ++i) {
    Triangle t;
    for (std::uint32_t& v : t) v = static_cast<std::uint32_t>(bytes.take<std::uint8_t>() % vertices);
    mesh.triangles.push_back(t);
  }
  const bool small = bytes.take<std::uint8_t>() % 2 == 0;
  const auto number = [&] {
    return small ? 0.25 * (bytes.take<std::int8_t>() % 5) : static_cast<double>(bytes.take<float>());
  };
  for (std::size_t i = 0; i < vertices; ++i) {
    const double x = number(), y = number(), z = number(), u = number(), v = number();
    mesh.positions.push_back({x, y, z});
    mesh.uvs.push_back({u, v});
    Vec3<double> n{number(), number(), number()};
    const double length = std::sqrt(dot(n, n));
    if (!(length > 1e-3 && length < 1e3))
      n = {0, 0, 1};
    else
      n = n * (1 / length);
    mesh.normals.push_back(n);
  }
  for (const FrameMethod& method : frame_methods())
    fuzz::may_refuse([&] {
      const MeshFrames frames = mesh_frames(mesh, method);
      fuzz::expect(frames.of_corner.size() == mesh.corners(), "a frame per corner");
      for (std::size_t c = 0; c < mesh.corners(); ++c) {
        const CornerFrame& f = frames.corner(c);
        fuzz::expect(f.sign == 1 || f.sign == -1, "signs are 1 or -1");
        const double tolerance = method.single_precision ? 3e-7 : 1e-14;
        for (const Vec3<double>& a : {f.t, f.b, f.n})
          if (!(std::fabs(norm(a) - 1) < tolerance))
            fuzz::found("unit vectors: " + std::string(method.name) + " gives " + std::to_string(a.x) + ' ' +
                        std::to_string(a.y) + ' ' + std::to_string(a.z));
      }
    });
  return 0;
}
