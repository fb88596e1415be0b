#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include <darboux/frame.h>
#include <darboux/io.h>
#include <darboux/mikktspace.h>
#include <darboux/statistics.h>

#include "tools.h"

namespace darboux::bench {
namespace {

// The stored tangents of a file.
struct Stored {
  std::size_t corners = 0, opposite = 0;  // opposite: whose w is MikkTSpace's raw sign, negated
  std::size_t leaning = 0;                // |t·n| > 0.01
  bool no_uvs = false;
  std::vector<double> angles;  // to MikkTSpace's, degrees
};

std::vector<float> floats_of(const std::vector<Vec3<double>>& vertices,
                             const std::vector<Triangle>& triangles) {
  std::vector<float> floats;
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t v : triangle)
      for (const double x : {vertices[v].x, vertices[v].y, vertices[v].z})
        floats.push_back(static_cast<float>(x));
  return floats;
}
std::vector<float> floats_of(const std::vector<Vec2<double>>& vertices,
                             const std::vector<Triangle>& triangles) {
  std::vector<float> floats;
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t v : triangle)
      for (const double x : {vertices[v].x, vertices[v].y}) floats.push_back(static_cast<float>(x));
  return floats;
}

void add(const Mesh& mesh, Stored& stored) {
  if (mesh.tangents.empty() || mesh.normals.empty()) return;
  stored.corners += mesh.corners();
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      stored.leaning += std::fabs(dot(mesh.tangents[v].xyz(), mesh.normals[v])) > 0.01;
  if (mesh.uvs.empty()) {
    stored.no_uvs = true;
    return;
  }
  const std::vector<float> positions = floats_of(mesh.positions, mesh.triangles),
                           normals = floats_of(mesh.normals, mesh.triangles),
                           uvs = floats_of(mesh.uvs, mesh.triangles);
  std::vector<float> made(4 * mesh.corners());
  mikktspace({positions, normals, uvs, {}, {}}, made);
  const float* m = made.data();
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) {
      const Vec4<double>& t = mesh.tangents[v];
      stored.angles.push_back(angle_between(t.xyz(), Vec3<double>{m[0], m[1], m[2]}) * 180 /
                              std::numbers::pi);
      stored.opposite += t.w == -m[3];
      m += 4;
    }
}

}  // namespace

void sample_models(const std::filesystem::path& folder, const std::vector<Line>& earlier, Tally& tally,
                   std::ostream& out) {
  if (!std::filesystem::is_directory(folder)) {
    std::cerr << "SKIPPED: " << folder.string() << " is not here: sample models are not compared\n";
    out << "Not compared: the folder of the models, " << folder.string() << ", was not there.\n";
    return;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".glb") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  out << "| model | corners | median | p95 | max | rms | w = -raw | abs(t·n) > 0.01 | measured earlier |\n"
         "|---|---:|---:|---:|---:|---:|---:|---:|---|\n";
  for (const std::filesystem::path& file : files) {
    const std::string model = file.stem().string();
    Stored stored;
    for (const Primitive& primitive : read_asset(file.string()).primitives) add(primitive.data, stored);
    out << "| " << model << " | ";
    if (stored.corners == 0) {
      out << "no TANGENT | | | | | | | |\n";
      continue;
    }
    const double corners = static_cast<double>(stored.corners);
    const std::string leaning = significant(100 * static_cast<double>(stored.leaning) / corners, 3) + " %";
    if (stored.no_uvs) {
      out << stored.corners << " | no uv | | | | | " << leaning << " | |\n";
      continue;
    }
    std::vector<double>& angles = stored.angles;
    std::sort(angles.begin(), angles.end());
    const double median = angles[angles.size() / 2];
    const Statistics s = summarise(angles);
    const double sign = static_cast<double>(stored.opposite) / corners;
    out << stored.corners << " | " << significant(median, 2) << " | " << significant(s.p95, 2) << " | "
        << significant(s.max, 3) << " | " << significant(s.rms, 3) << " | " << significant(sign, 4) << " | "
        << leaning << " | ";
    std::string missed;
    bool known = false;
    for (const Line& line : earlier) {
      if (line.at("model") != model) continue;
      known = true;
      for (const auto& [name, now] : {std::pair<std::string, double>{"corners", corners},
                                      {"median", median},
                                      {"p95", s.p95},
                                      {"max", s.max},
                                      {"rms", s.rms},
                                      {"sign", sign}}) {
        const bool met = reproduces(line.at(name), now);
        ++(met ? tally.met : tally.missed);
        if (!met) missed += (missed.empty() ? "" : ", ") + name + " " + line.at(name);
      }
    }
    out << (!known ? "" : missed.empty() ? "met" : "**missed**: " + missed) << " |\n";
  }
}

}  // namespace darboux::bench
