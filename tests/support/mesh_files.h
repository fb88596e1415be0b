/// \file mesh_files.h
/// Meshes as PLY, STL and COLLADA, written here and nowhere else.
#pragma once

#include <algorithm>
#include <bit>
#include <charconv>
#include <string>
#include <vector>

#include <darboux/mesh.h>

#include "io_files.h"

namespace darboux::test {

/// The shortest text that reads back to the same double.
inline std::string digits(double x) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr};
}

inline std::vector<double> flat(const std::vector<Vec3<double>>& vectors) {
  std::vector<double> result;
  for (const auto& a : vectors) result.insert(result.end(), {a.x, a.y, a.z});
  return result;
}
inline std::vector<double> flat(const std::vector<Vec2<double>>& vectors) {
  std::vector<double> result;
  for (const auto& a : vectors) result.insert(result.end(), {a.x, a.y});
  return result;
}

inline std::string list(const std::vector<double>& numbers, const char* separator = " ") {
  std::string text;
  for (const double x : numbers) text += (text.empty() ? "" : separator) + digits(x);
  return text;
}

inline std::vector<Vec3<double>> directions(const std::vector<Vec4<double>>& tangents) {
  std::vector<Vec3<double>> result;
  for (const auto& t : tangents) result.push_back(t.xyz());
  return result;
}
inline std::vector<Vec3<double>> bitangents(const Mesh& mesh) {
  std::vector<Vec3<double>> result;
  for (std::size_t i = 0; i < mesh.tangents.size(); ++i)
    result.push_back(mesh.tangents[i].w * cross(mesh.normals[i], mesh.tangents[i].xyz()));
  return result;
}

inline std::string ply_header(const Mesh& mesh, const std::string& format,
                              const std::string& type = "double") {
  std::string header = "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " +
                       std::to_string(mesh.positions.size()) + "\n";
  std::vector<std::string> names{"x", "y", "z"};
  if (!mesh.normals.empty()) names.insert(names.end(), {"nx", "ny", "nz"});
  if (!mesh.uvs.empty()) names.insert(names.end(), {"s", "t"});
  for (const std::string& name : names) header += "property " + type + " " + name + "\n";
  return header + "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

inline std::vector<double> ply_row(const Mesh& mesh, std::size_t i) {
  std::vector<double> row = flat(std::vector{mesh.positions[i]});
  const auto add = [&](const std::vector<double>& more) { row.insert(row.end(), more.begin(), more.end()); };
  if (!mesh.normals.empty()) add(flat(std::vector{mesh.normals[i]}));
  if (!mesh.uvs.empty()) add(flat(std::vector{mesh.uvs[i]}));
  return row;
}

inline std::string ply_text(const Mesh& mesh) {
  std::string text = ply_header(mesh, "ascii");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) text += list(ply_row(mesh, i)) + "\n";
  for (const auto& [a, b, c] : mesh.triangles)
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  return text;
}

inline std::string ply_binary(const Mesh& mesh, bool big) {
  std::string bytes = ply_header(mesh, big ? "binary_big_endian" : "binary_little_endian");
  const auto add = [&](auto x) {
    std::string number = pack({x});
    if (big) std::reverse(number.begin(), number.end());
    bytes += number;
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    for (const double x : ply_row(mesh, i)) add(x);
  for (const Triangle& t : mesh.triangles) {
    bytes += '\3';
    for (const std::uint32_t i : t) add(static_cast<std::int32_t>(i));
  }
  return bytes;
}

inline std::string stl_text(const Mesh& mesh, const std::string& name) {
  std::string text = "solid " + name + "\n";
  for (const Triangle& t : mesh.triangles) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const std::uint32_t i : t) text += "  vertex " + list(flat(std::vector{mesh.positions[i]})) + "\n";
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

inline std::string stl_binary(const Mesh& mesh) {
  std::string bytes =
      "solid in name only" + std::string(62, ' ') + pack({static_cast<std::uint32_t>(mesh.triangles.size())});
  for (const Triangle& t : mesh.triangles) {
    bytes += std::string(12, '\0');
    for (const std::uint32_t i : t)
      for (const double x : flat(std::vector{mesh.positions[i]})) bytes += pack({static_cast<float>(x)});
    bytes += std::string(2, '\0');
  }
  return bytes;
}

inline std::string collada_source(const std::string& id, const std::vector<double>& values,
                                  std::size_t width) {
  std::string params;
  for (std::size_t k = 0; k < width; ++k)
    params += std::string("<param name=\"") + (width == 3 ? "XYZ" : "ST")[k] + "\" type=\"float\"/>";
  return "<source id=\"" + id + "\"><float_array id=\"" + id + "-array\" count=\"" +
         std::to_string(values.size()) + "\">" + list(values) +
         "</float_array><technique_common><accessor source=\"#" + id + "-array\" count=\"" +
         std::to_string(values.size() / width) + "\" stride=\"" + std::to_string(width) + "\">" + params +
         "</accessor></technique_common></source>\n";
}

/// What stands around the geometries and nodes of a COLLADA file.
inline std::string collada(const std::string& geometries, const std::string& nodes) {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<COLLADA "
         "xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\">\n<asset><unit name=\"inch\" meter=\"0.0254\"/><up_axis>Z_UP</up_axis></asset>\n"
         "<library_geometries>" +
         geometries + "</library_geometries>\n<library_visual_scenes><visual_scene id=\"scene\">" + nodes +
         "</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene "
         "url=\"#scene\"/></scene></COLLADA>\n";
}

/// \param more uv sets, numbered from 1
inline std::string collada_geometry(const Mesh& mesh, const std::string& id,
                                    const std::vector<std::vector<Vec2<double>>>& more = {}) {
  std::string sources = collada_source(id + "-position", flat(mesh.positions), 3), inputs;
  std::size_t offset = 0;
  const auto add = [&](const char* semantic, const std::string& name, const std::vector<double>& values,
                       std::size_t width, const std::string& set = "") {
    if (values.empty()) return;
    sources += collada_source(id + "-" + name, values, width);
    inputs += "<input semantic=\"" + std::string(semantic) + "\" source=\"#" + id + "-" + name +
              "\" offset=\"" + std::to_string(++offset) + "\"" + set + "/>";
  };
  add("NORMAL", "normal", flat(mesh.normals), 3);
  add("TEXCOORD", "uv", flat(mesh.uvs), 2, " set=\"0\"");
  for (std::size_t i = 0; i < more.size(); ++i)
    add("TEXCOORD", "uv" + std::to_string(i + 1), flat(more[i]), 2, " set=\"" + std::to_string(i + 1) + "\"");
  add("TEXTANGENT", "tangent", flat(directions(mesh.tangents)), 3, " set=\"0\"");
  add("TEXBINORMAL", "bitangent", flat(bitangents(mesh)), 3, " set=\"0\"");
  std::string p;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t i : t)
      for (std::size_t k = 0; k <= offset; ++k) p += std::to_string(i) + " ";
  return "<geometry id=\"" + id + "\" name=\"the " + id + "\"><mesh>\n" + sources + "<vertices id=\"" + id +
         "-vertices\"><input semantic=\"POSITION\" source=\"#" + id +
         "-position\"/></vertices>\n<triangles count=\"" + std::to_string(mesh.triangles.size()) +
         "\"><input semantic=\"VERTEX\" source=\"#" + id + "-vertices\" offset=\"0\"/>" + inputs + "<p>" + p +
         "</p></triangles></mesh></geometry>";
}

inline std::string dae_text(const Mesh& mesh, const std::vector<std::vector<Vec2<double>>>& more = {}) {
  return collada(collada_geometry(mesh, "mesh", more), "<node><instance_geometry url=\"#mesh\"/></node>");
}

/// The values of each corner, one after the other.
template <class Vector>
std::vector<Vector> of_corners(const Mesh& mesh, const std::vector<Vector>& of_vertices) {
  std::vector<Vector> result;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t i : t) result.push_back(of_vertices[i]);
  return result;
}

}  // namespace darboux::test
