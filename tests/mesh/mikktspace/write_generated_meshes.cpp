// write_generated_meshes FILE: all meshes of generated_meshes.h, each as its number of corners and the
// corners.
#include <cstdio>

#include "generated_meshes.h"

int main(int argc, char** argv) {
  std::FILE* file = argc == 2 ? std::fopen(argv[1], "wb") : nullptr;
  if (file == nullptr) return std::fprintf(stderr, "usage: write_generated_meshes FILE\n"), 2;
  for (std::uint32_t k = 0; k < darboux::test::generated_meshes; ++k) {
    const darboux::test::Soup soup = darboux::test::generated_mesh(k);
    const auto corners = static_cast<std::uint32_t>(soup.size());
    std::fwrite(&corners, sizeof corners, 1, file);
    std::fwrite(soup.data(), sizeof soup[0], soup.size(), file);
  }
  return std::fclose(file) == 0 ? 0 : 1;
}
