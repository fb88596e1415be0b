// How many corners of the first pieces of two files have the same tangent.
#include <cstdio>

#include <darboux/compare.h>
#include <darboux/error.h>
#include <darboux/io.h>

int main(int argc, char** argv) try {
  if (argc != 3) throw darboux::ParameterError("compare_meshes", "needs A.glb and B.glb");
  const darboux::Asset a = darboux::read_asset(argv[1]), b = darboux::read_asset(argv[2]);
  const darboux::MeshComparison c = compare(a.primitives.at(0).data, b.primitives.at(0).data);
  std::printf("%zu of %zu corners matched, %zu with the same tangent to the bit\n", c.matched, c.corners_a,
              c.equal_bits);
  if (c.worst) std::printf("vertices %u and %u differ most\n", c.worst->vertex_a, c.worst->vertex_b);
  return 0;
} catch (const darboux::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
