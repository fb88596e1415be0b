// Code shared by all readers of points, and the choice of the reader for a file.
#include "points.h"

#include <algorithm>
#include <filesystem>

#include <Eigen/Geometry>

#include <darboux/error.h>
#include <darboux/weld.h>

#include "base/extension.h"
#include "base/text.h"
#include "files.h"

namespace darboux::io {
namespace {

// Names of a group of columns, and the index of the first in PointNumbers.
struct Group {
  std::vector<std::string_view> names;
  int first;
};
const std::vector<Group> groups{{{"x", "y", "z"}, 0},
                                {{"position_x", "position_y", "position_z"}, 0},
                                {{"nx", "ny", "nz"}, 3},
                                {{"normal_x", "normal_y", "normal_z"}, 3},
                                {{"u", "v"}, 6},
                                {{"s", "t"}, 6},
                                {{"texture_u", "texture_v"}, 6}};

PointFile read_gltf_points(const std::string& path, const ReadOptions& options) {
  Asset asset = read_asset(path, options);
  PointFile result;
  bool normals = true, uvs = true;
  std::size_t vertices = 0;
  for (const Primitive& p : asset.primitives) {
    normals = normals && !p.data.normals.empty();
    uvs = uvs && !p.data.uvs.empty();
    vertices += p.data.positions.size();
  }
  std::vector<bool> used;
  result.cloud.positions.reserve(vertices);
  if (normals) result.cloud.normals.reserve(vertices);
  if (uvs) result.cloud.uvs.reserve(vertices);
  for (Primitive& p : asset.primitives) {
    const std::size_t first = used.size();
    used.resize(first + p.data.positions.size());
    for (const Triangle& t : p.data.triangles)
      for (const std::uint32_t i : t) used[first + i] = true;
    for (std::size_t i = 0; i < p.data.positions.size(); ++i) {
      result.cloud.positions.push_back(p.data.positions[i]);
      if (normals) result.cloud.normals.push_back(p.data.normals[i]);
      if (uvs) result.cloud.uvs.push_back(p.data.uvs[i]);
      if (result.first_not_finite.empty() && !detail::finite(p.data.positions[i]))
        result.first_not_finite = "mesh " + std::to_string(p.mesh) + " primitive " +
                                  std::to_string(p.primitive) + " vertex " + std::to_string(i);
    }
    p = {};  // its vertices are copied
  }
  if (std::find(used.begin(), used.end(), true) == used.end())
    throw FileError(
        path,
        expected_got("a glTF whose triangles use its vertices",
                     "no triangles" + (asset.skipped.empty() ? "" : " (" + asset.skipped[0].reason + ")")));
  find_places(result, used);
  return result;
}

struct Format {
  std::vector<std::string_view> extensions;
  const char* kind;
  PointFile (*read)(PointReader&);
};
const std::vector<Format>& formats() {
  static const std::vector<Format> list{
      {{".xyz", ".txt", ".csv", ".tsv", ".asc", ".pts"}, "text with a point per line", read_table},
      {{".obj"}, "OBJ file", read_obj_points},
      {{".ply"}, "PLY file", read_ply_points},
      {{".pcd"}, "PCD file", read_pcd_points},
      {{".stl"}, "STL file", read_stl_points}};
  return list;
}

}  // namespace

PointColumns PointColumns::named(std::span<const std::string> names, const std::string& where) {
  PointColumns columns;
  columns.slots.assign(names.size(), -1);
  std::array<bool, 8> taken{};
  for (const Group& group : groups) {
    if (taken[static_cast<std::size_t>(group.first)]) continue;
    std::vector<std::size_t> found;
    for (const std::string_view wanted : group.names)
      for (std::size_t k = 0; k < names.size(); ++k)
        if (lower(names[k]) == wanted) {
          if (found.size() > 0 && lower(names[found.back()]) == wanted)
            throw FileError(where, expected_got("each column once", "'" + std::string(wanted) + "' twice"));
          found.push_back(k);
        }
    if (found.size() != group.names.size()) continue;
    taken[static_cast<std::size_t>(group.first)] = true;
    for (std::size_t k = 0; k < found.size(); ++k)
      columns.slots[found[k]] = group.first + static_cast<int>(k);
  }
  if (!taken[0])
    throw FileError(where, expected_got("the columns x y z, with nx ny nz, u v and others",
                                        "'" + joined({names.begin(), names.end()}, "', '") + "'"));
  columns.normals = taken[3];
  columns.uvs = taken[6];
  return columns;
}

PointReader::PointReader(const std::string& path, const std::string& kind,
                         const std::function<void(double)>& progress)
    : bytes_((expect_regular_file(path), path), kind), progress_(progress) {}

void PointReader::add(const PointColumns& columns, const PointNumbers& point, std::string_view where,
                      std::uint64_t number) {
  PointCloud& cloud = result_.cloud;
  cloud.positions.push_back({point[0], point[1], point[2]});
  if (columns.normals) cloud.normals.push_back({point[3], point[4], point[5]});
  if (columns.uvs) cloud.uvs.push_back({point[6], point[7]});
  if (result_.first_not_finite.empty() && !detail::finite(cloud.positions.back()))
    result_.first_not_finite = std::string(where) + std::to_string(number);
  if (progress_ && cloud.positions.size() % 65536 == 0) progress_(bytes_.share().value_or(0));
}

PointFile PointReader::finish() {
  bytes_.finish();
  if (result_.cloud.positions.empty()) throw FileError(path(), expected_got("at least one point", "none"));
  return std::move(result_);
}

double number_of(std::string_view field, const Lines& lines) {
  const auto value = parse_number(field);
  if (value) return *value;
  const auto between = field.find_first_of(", \t");  // of "1,5", or of "5 2" in "1,5 2,5"
  if (between != std::string_view::npos && parse_number(field.substr(0, between)) &&
      parse_number(trimmed(field.substr(between + 1))))
    lines.fail(in_quotes(field) +
               ", which is two numbers, or one with a decimal comma; write decimal points");
  lines.fail(in_quotes(field) + ", which is no number within the range of double");
}

void find_places(PointFile& file, const std::vector<bool>& used) {
  constexpr double same = 1e-6;  // of the diagonal, as in mesh_classes.h
  Eigen::AlignedBox3d box;
  std::vector<std::uint32_t> index;
  std::vector<Vec3<double>> positions;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    index.push_back(static_cast<std::uint32_t>(i));
    positions.push_back(file.cloud.positions[i]);
    if (detail::finite(positions.back())) box.extend(to_eigen(positions.back()));
  }
  const std::vector<std::uint32_t> first = weld(positions, box.isEmpty() ? 0 : same * box.diagonal().norm());
  file.place.assign(used.size(), PointFile::unused);
  for (std::size_t k = 0; k < index.size(); ++k) file.place[index[k]] = index[first[k]];
}

bool is_of_points(std::string_view extension) {
  return std::any_of(formats().begin(), formats().end(), [&](const Format& f) {
    return std::find(f.extensions.begin(), f.extensions.end(), extension) != f.extensions.end();
  });
}

}  // namespace darboux::io

namespace darboux {

PointCloud distinct_points(const PointFile& file) {
  if (file.place.empty()) return file.cloud;
  const auto kept = [&]<class T>(const std::vector<T>& values) {
    std::vector<T> result;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (file.place[i] == i) result.push_back(values[i]);
    return result;
  };
  return {kept(file.cloud.positions), kept(file.cloud.normals), kept(file.cloud.uvs)};
}

PointFile read_points(const std::string& path, const std::function<void(double)>& progress,
                      const ReadOptions& options) {
  const std::string extension = extension_of(path);
  if (extension == ".glb" || extension == ".gltf") return io::read_gltf_points(path, options);
  for (const io::Format& format : io::formats())
    if (std::find(format.extensions.begin(), format.extensions.end(), extension) != format.extensions.end()) {
      io::PointReader reader(path, format.kind, progress);
      return format.read(reader);
    }
  io::expect_regular_file(path);
  throw FileError(
      path,
      expected_got(
          "one of the extensions .xyz, .txt, .csv, .tsv, .asc, .pts, .ply, .pcd, .obj, .stl, .glb and .gltf",
          io::in_quotes(std::filesystem::path(path).extension().string())));
}

}  // namespace darboux
