// Gives a glTF file tangents, as `darboux tangents` does, and says what became of each primitive.
#include <cstdio>

#include <darboux/error.h>
#include <darboux/file_tangents.h>

int main(int argc, char** argv) try {
  if (argc != 3) throw darboux::ParameterError("write_tangents", "needs IN.glb and OUT.glb");
  darboux::GltfDocument document = darboux::GltfDocument::load(argv[1]);
  darboux::FileTangentOptions options;
  options.only_needed = false;  // true: only primitives with a normal map or anisotropy
  options.threads = 2;
  const darboux::FileTangents done = add_tangents(document, options);
  document.save_glb(argv[2]);
  for (const darboux::PrimitiveTangents& p : done.primitives)
    std::printf("mesh %zu primitive %zu: %zu vertices, %zu before\n", p.mesh, p.primitive, p.vertices,
                p.old_vertices);
  for (const darboux::SkippedPrimitive& s : done.skipped)
    std::printf("mesh %zu primitive %zu: %s\n", s.mesh, s.primitive, s.reason.c_str());
  return 0;
} catch (const darboux::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
