#include <cstdio>

#include <darboux/evaluate.h>
#include <darboux/torus.h>

int main() {
  const darboux::Torus torus{1.0, 0.4};                     // radius of the ring, radius of the tube
  const darboux::Frame<double> f = frame(torus, 0.3, 0.7);  // u round the ring, v round the tube, in turns
  for (const auto& [name, a] : {std::pair{"t", f.t}, {"b", f.b}, {"n", f.n}})
    std::printf("%s %19.16f %19.16f %19.16f\n", name, a.x, a.y, a.z);
  std::printf("handedness %+g\n", f.handedness);
}
