// A surface of one's own from its position alone: partials, frame and curvature come by dual numbers.
#include <cstdio>

#include <darboux/from_position.h>
#include <darboux/testing.h>

/// Ripples on a plate: P(u, v) = (u, v, 0.1 exp(-r) cos 2π 3r), r = sqrt(0.01 + (u - 1/2)² + (v - 1/2)²)
struct Ripples {
  static constexpr darboux::SurfaceInfo info{"ripples", "ripples on a plate", darboux::Coordinate::linear,
                                             darboux::Coordinate::linear};
  template <class S>
  darboux::Vec3<S> position(const S& u, const S& v) const {
    using std::exp, std::sqrt;
    const S x = u - 0.5, y = v - 0.5, r = sqrt(0.01 + x * x + y * y);
    return {u, v, 0.1 * exp(-r) * darboux::sincos_turns(3 * r).cos};
  }
};

int main() {
  const darboux::FromPosition<Ripples> ripples;
  const darboux::Frame<double> f = darboux::frame(ripples, 0.25, 0.75);
  std::printf("t %.16g %.16g %.16g\n", f.t.x, f.t.y, f.t.z);
  std::printf("n %.16g %.16g %.16g\n", f.n.x, f.n.y, f.n.z);
  const std::string broken = darboux::broken_laws(ripples);
  std::printf("%s", broken.empty() ? "every law holds\n" : broken.c_str());
  return broken.empty() ? 0 : 1;
}
