// Chooses the reader for a mesh file.
#include <array>
#include <cmath>
#include <fstream>

#include <darboux/error.h>

#include "base/extension.h"
#include "base/text.h"
#include "files.h"
#include "gltf_file.h"
#include "mesh/stored_rounding.h"
#include "mesh_files.h"
#include "points.h"

namespace darboux {

std::span<const std::string_view> asset_extensions() {
  static constexpr std::array<std::string_view, 7> list{".glb", ".gltf", ".obj", ".fbx",
                                                        ".dae", ".ply",  ".stl"};
  return list;
}

namespace {

// Half a step of unit vectors written with two to four decimals, such as "0.577 0.577 0.577"; 0 if there are
// more or fewer: one decimal is exact.
template <class Vector>
double half_step_of_decimals(const std::vector<Vector>& directions) {
  int most = 0;
  for (const Vector& d : directions)
    for (const double x : {d.x, d.y, d.z}) {
      if (!(std::fabs(x) <= 1.001)) return 0;  // no unit vector
      double tens = std::pow(10, most);
      while (std::fabs(x * tens - std::round(x * tens)) > tens * 0x1p-23) {
        if (++most > 4) return 0;
        tens *= 10;
      }
    }
  return most < 2 ? 0 : 0.5 * std::pow(10, -most);
}

// Lengths that rounding explains are kept, to the bit.
void make_unit(std::vector<Vec3<double>>& normals, double half_step) {
  for (Vec3<double>& n : normals)
    if (!is_unit(n, half_step) && detail::finite(n) && n != Vec3<double>{}) n = unit(n);
}

// Whether the file contains decimals: OBJ, Collada, ASCII PLY and ASCII STL. Other formats round as their
// number types do.
bool is_text(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == ".obj" || extension == ".dae") return true;
  std::string begin(1024, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(stream.gcount()));
  if (extension == ".ply") return begin.find("format ascii") != std::string::npos;
  return extension == ".stl" && lower(begin.substr(0, 5)) == "solid" && begin.find('\0') == std::string::npos;
}

Asset read_any(const std::string& path, const ReadOptions& options) {
  const std::string extension = extension_of(path);
  if (io::is_gltf(path)) return io::read_gltf(io::load_gltf(path, io::map_file(path), options));
  if (extension == ".ply") return io::read_ply(path, options);
  if (extension == ".stl") return io::read_stl(path);
  if (extension == ".dae") return io::read_collada(path, io::read_file(path), options);
  if (extension == ".obj" || extension == ".fbx")
    return io::read_with_assimp(path, io::read_file(path),
                                extension == ".obj" ? io::AssimpFormat::obj : io::AssimpFormat::fbx, options);
  throw FileError(
      path,
      expected_got("a GLB by its content, or one of the extensions " +
                       joined({asset_extensions().begin(), asset_extensions().end()}),
                   io::in_quotes(extension) +
                       (io::is_of_points(extension) ? ", which holds points: darboux fit reads them" : "")));
}

}  // namespace

bool io::is_gltf(const std::string& path) {
  io::expect_regular_file(path);
  std::string magic(4, '\0');
  std::ifstream(path, std::ios::binary).read(magic.data(), 4);
  const std::string extension = extension_of(path);
  return magic == "glTF" || extension == ".glb" || extension == ".gltf";
}

Asset read_asset(const std::string& path, const ReadOptions& options) {
  Asset asset = read_any(path, options);
  const bool text = is_text(path);
  const std::string extension = extension_of(path);
  for (Primitive& p : asset.primitives) {
    HalfSteps& steps = p.data.half_steps;
    if (text && steps.normal == 0) steps.normal = half_step_of_decimals(p.data.normals);
    if (text && steps.tangent == 0) steps.tangent = half_step_of_decimals(p.data.tangents);
    if (extension == ".obj" || extension == ".ply") make_unit(p.data.normals, steps.normal);
  }
  return asset;
}

}  // namespace darboux
