// A direction taken into tangent space and back; the frame of a mirrored placement; what a vertex buffer
// stores.
#include <cstdio>

#include <darboux/evaluate.h>
#include <darboux/sphere.h>

int main() {
  const darboux::Frame<double> f = frame(darboux::Sphere{1.0}, 0.125, 0.75);

  const Eigen::Vector3d to_light(0, 0, 1);
  const Eigen::Vector3d in_tangent_space = object_to_tangent(f) * to_light;  // rows t, b, n
  const Eigen::Vector3d back = tangent_to_object(f) * in_tangent_space;      // columns t, b, n
  std::printf("light in (t, b, n): %.4f %.4f %.4f, back: %.4f %.4f %.4f\n", in_tangent_space.x(),
              in_tangent_space.y(), in_tangent_space.z(), back.x(), back.y(), back.z());

  const Eigen::Matrix3d mirror = Eigen::Vector3d(-1, 1, 1).asDiagonal();
  const darboux::Frame<double> mirrored = darboux::FrameTransform<double>(mirror)(f);
  std::printf("handedness %+g, mirrored %+g\n", f.handedness, mirrored.handedness);
  std::printf("w: gltf %+g, raw %+g\n", tangent4(f).w, tangent4(f, darboux::SignConvention::raw).w);
}
