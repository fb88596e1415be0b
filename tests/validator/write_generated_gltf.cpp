// write_generated_gltf OUT.glb: the file of generated_gltf.h.
#include "generated_gltf.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  darboux::test::write_bytes(argv[1], darboux::test::generated_gltf().glb());
  return 0;
}
