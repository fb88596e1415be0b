#include <cstdio>

#include <darboux/any_surface.h>
#include <darboux/evaluate.h>
#include <darboux/torus.h>

int uses_fit_and_io();

int main() {
  const darboux::Torus torus{1.0, 0.4};
  const darboux::Frame<double> f = frame(torus, 0.25, 0.0);
  std::printf("t = (%g, %g, %g), n = (%g, %g, %g)\n", f.t.x, f.t.y, f.t.z, f.n.x, f.n.y, f.n.z);
  const bool right = f.t == darboux::Vec3<double>{-1, 0, 0} && f.n == darboux::Vec3<double>{0, 1, 0};
  const bool known = darboux::make_surface("torus:minor_radius=0.4").frame(0.25, 0).n == f.n;
  return right && known ? uses_fit_and_io() : 1;
}
