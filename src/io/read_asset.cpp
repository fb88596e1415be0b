// Which file of a mesh is read how.
#include <array>
#include <filesystem>
#include <fstream>

#include <darboux/error.h>

#include "../text.h"
#include "files.h"
#include "gltf_file.h"
#include "mesh_files.h"

namespace darboux {

std::span<const std::string_view> asset_extensions() {
  static constexpr std::array<std::string_view, 7> list{".glb", ".gltf", ".obj", ".fbx",
                                                        ".dae", ".ply",  ".stl"};
  return list;
}

Asset read_asset(const std::string& path) {
  io::expect_regular_file(path);
  std::string magic(4, '\0');
  std::ifstream(path, std::ios::binary).read(magic.data(), 4);
  const std::string extension = lower(std::filesystem::path(path).extension().string());
  if (magic == "glTF" || extension == ".glb" || extension == ".gltf")
    return io::read_gltf(io::load_gltf(path, io::read_file(path)));
  if (extension == ".ply") return io::read_ply(path);
  if (extension == ".stl") return io::read_stl(path);
  if (extension == ".dae") return io::read_collada(path, io::read_file(path));
  if (extension == ".obj" || extension == ".fbx")
    return io::read_with_assimp(path, io::read_file(path), extension.substr(1));
  throw FileError(path, "is of no known kind, permitted are GLB by its content and by their names " +
                            joined({asset_extensions().begin(), asset_extensions().end()}));
}

}  // namespace darboux
