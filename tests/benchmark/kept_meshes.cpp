#include <algorithm>
#include <cstddef>
#include <map>
#include <ostream>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include <darboux/io.h>

#include "tool_accuracy.h"
#include "tools.h"
#include "torus_file.h"

namespace darboux::bench {

void beside_kept(const std::filesystem::path& work, int n, const std::filesystem::path& folder,
                 std::ostream& out) {
  const std::map<std::string, std::string> tool_of{
      {"none", ""}, {"three", "three"}, {"mikk", "gltf-transform"}, {"assimp", "assimp"}};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    std::smatch parts;
    const std::string name = file.filename().string();
    if (!std::regex_match(name, parts, std::regex("([a-z]+)_([0-9]+)\\.([a-z]+)\\.glb"))) continue;
    const std::string shape = parts[1], kind = parts[3];
    if (std::stoi(parts[2]) != n || std::ranges::find(shapes(), shape) == shapes().end() ||
        !tool_of.contains(kind))
      continue;
    const Mesh kept = read_asset(file.string()).primitives.at(0).data;
    const MeshArrays made = unindexed(read_mesh_arrays(work / shape / "mesh"));
    if (kept.corners() != made.corner_count()) throw std::runtime_error(name + ": another number of corners");
    const std::string& tool = tool_of.at(kind);
    const std::vector<float> tangents = tool.empty() ? std::vector<float>() : tangents_by(tool, work, shape);
    std::size_t same_mesh = 0, same_tangent = 0, c = 0;
    for (const Triangle& triangle : kept.triangles)
      for (const std::uint32_t v : triangle) {
        const float *p = &made.positions[3 * c], *m = &made.normals[3 * c], *uv = &made.uvs[2 * c];
        same_mesh += kept.positions[v] == Vec3<double>{p[0], p[1], p[2]} &&
                     kept.normals[v] == Vec3<double>{m[0], m[1], m[2]} &&
                     kept.uvs[v] == Vec2<double>{uv[0], uv[1]};
        if (!tool.empty()) {
          const float* t = &tangents[4 * c];
          same_tangent += kept.tangents[v].xyz() == Vec3<double>{t[0], t[1], t[2]};
        }
        ++c;
      }
    out << "| " << name << " | " << kept.corners() << " | " << same_mesh << " | "
        << (tool.empty() ? "" : std::to_string(same_tangent)) << " |\n";
  }
}

}  // namespace darboux::bench
