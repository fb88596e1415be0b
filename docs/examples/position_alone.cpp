// A surface given by its position alone: partials, frame and curvature come by dual numbers.
#include <cstdio>
#include <string>

#include <darboux/from_position.h>
#include <darboux/testing.h>

/// A hill on a plate: P(u, v) = (u, v, exp(-2x² - 2y²)/4), x = 2u - 1, y = 2v - 1
struct Hill {
  static constexpr darboux::SurfaceInfo info{"hill", "a hill on a plate", darboux::Coordinate::linear,
                                             darboux::Coordinate::linear};
  template <class S>
  darboux::Vec3<S> position(const S& u, const S& v) const {
    using darboux::exp;  // the same bits on every machine
    const S x = 2 * u - 1, y = 2 * v - 1, z = 0.25 * exp(-2 * (x * x + y * y));
    return {u, v, z};
  }
};

int main() {
  const darboux::FromPosition<Hill> hill;
  const darboux::Frame<double> f = darboux::frame(hill, 0.25, 0.75);
  std::printf("t %.16g %.16g %.16g\n", f.t.x, f.t.y, f.t.z);
  std::printf("n %.16g %.16g %.16g\n", f.n.x, f.n.y, f.n.z);
  const std::string broken = darboux::broken_laws(hill);
  std::printf("%s", broken.empty() ? "every law holds\n" : broken.c_str());
  return broken.empty() ? 0 : 1;
}
