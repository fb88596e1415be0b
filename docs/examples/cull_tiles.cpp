// Which tiles of a torus an eye can see, and how finely each must be sampled.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <darboux/tile_bounds.h>
#include <darboux/torus.h>

int main() {
  const darboux::AnySurface torus(darboux::Torus{1.0, 0.4});
  const darboux::Vec3<double> eye{6, 0, 1};
  constexpr int tiles = 16;
  constexpr double longest_chord = 1e-3, widest_angle = 0.05;  // a length; radians
  int culled = 0, samples = 0;
  for (int i = 0; i < tiles; ++i)
    for (int k = 0; k < tiles; ++k) {
      const darboux::TileBounds bounds(torus, {double(i) / tiles, (i + 1.0) / tiles,  //
                                               double(k) / tiles, (k + 1.0) / tiles});
      if (bounds.facing(eye) < 0) {  // all of it faces away
        ++culled;
        continue;
      }
      int cells = 1;
      for (double cell = 1.0 / tiles; cells < 256; cells *= 2, cell /= 2)
        if (bounds.chord(cell, cell) <= longest_chord && bounds.frame_angle(cell, cell) <= widest_angle)
          break;
      samples += (cells + 1) * (cells + 1);
    }
  std::printf("%d of %d tiles face away; %d samples for the others\n", culled, tiles * tiles, samples);
}
