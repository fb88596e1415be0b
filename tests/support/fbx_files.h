/// \file fbx_files.h
/// Meshes as FBX, in its text and in its binary form, written here and nowhere else.
#pragma once

#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "mesh_files.h"

namespace darboux::test {

inline std::string fbx_array(const std::string& name, std::size_t count, const std::string& numbers) {
  return name + ": *" + std::to_string(count) + " {\n a: " + numbers + "\n}\n";
}
inline std::string fbx_array(const std::string& name, const std::vector<double>& values) {
  return fbx_array(name, values.size(), list(values, ","));
}

/// A geometry in FBX's text, its attributes by corner. \param polygons indices, the last of a polygon as -1 -
/// index
inline std::string fbx_geometry(const std::string& name, int id, const std::vector<Vec3<double>>& positions,
                                const std::vector<int>& polygons, const std::string& layers) {
  std::string indices, used;
  for (const int i : polygons) indices += (indices.empty() ? "" : ",") + std::to_string(i);
  std::map<std::string, int> number;
  for (std::size_t at = layers.find("LayerElement"); at != std::string::npos;
       at = layers.find("LayerElement", at + 1)) {
    const std::string type = layers.substr(at, layers.find(':', at) - at);
    used += "Layer: " + std::to_string(number[type]) + " {\n LayerElement: {\n Type: \"" + type +
            "\"\n TypedIndex: " + std::to_string(number[type]) + "\n }\n}\n";
    ++number[type];
  }
  return "Geometry: " + std::to_string(id) + ", \"Geometry::" + name + "\", \"Mesh\" {\n" +
         fbx_array("Vertices", flat(positions)) + fbx_array("PolygonVertexIndex", polygons.size(), indices) +
         layers + used + "}\n";
}

inline std::string fbx_layer(const std::string& type, int index, const std::string& name,
                             const std::vector<double>& values) {
  return type + ": " + std::to_string(index) +
         " {\n Version: 101\n Name: \"\"\n MappingInformationType: \"ByPolygonVertex\"\n "
         "ReferenceInformationType: \"Direct\"\n" +
         fbx_array(name, values) + "}\n";
}

/// Objects and connections ("C: \"OO\",child,parent", 0 the root) as an FBX.
inline std::string fbx(const std::string& objects, const std::string& connections) {
  return "; FBX 7.4.0 project file\nFBXHeaderExtension: {\n FBXHeaderVersion: 1003\n FBXVersion: 7400\n}\n"
         "GlobalSettings: {\n Version: 1000\n Properties70: {\n  P: \"UpAxis\", \"int\", \"Integer\", "
         "\"\",2\n"
         "  P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",2.54\n }\n}\nObjects: {\n" +
         objects + "}\nConnections: {\n" + connections + "}\n";
}

inline std::string fbx_model(int id, const std::string& name, const std::string& properties = "") {
  return "Model: " + std::to_string(id) + ", \"Model::" + name +
         "\", \"Mesh\" {\n Version: 232\n Properties70: {\n" + properties + " }\n}\n";
}

/// \param more uv sets
inline std::string fbx_geometry(const Mesh& mesh, const std::string& name, int id,
                                const std::vector<std::vector<Vec2<double>>>& more = {},
                                bool with_bitangents = true) {
  std::vector<int> polygons;
  for (const auto& [a, b, c] : mesh.triangles)
    polygons.insert(polygons.end(), {static_cast<int>(a), static_cast<int>(b), -1 - static_cast<int>(c)});
  std::string layers;
  if (!mesh.normals.empty())
    layers += fbx_layer("LayerElementNormal", 0, "Normals", flat(of_corners(mesh, mesh.normals)));
  if (!mesh.tangents.empty()) {
    if (with_bitangents)
      layers += fbx_layer("LayerElementBinormal", 0, "Binormals", flat(of_corners(mesh, bitangents(mesh))));
    layers +=
        fbx_layer("LayerElementTangent", 0, "Tangents", flat(of_corners(mesh, directions(mesh.tangents))));
  }
  if (!mesh.uvs.empty()) layers += fbx_layer("LayerElementUV", 0, "UV", flat(of_corners(mesh, mesh.uvs)));
  for (std::size_t i = 0; i < more.size(); ++i)
    layers += fbx_layer("LayerElementUV", static_cast<int>(i) + 1, "UV", flat(of_corners(mesh, more[i])));
  return fbx_geometry(name, id, mesh.positions, polygons, layers);
}

inline std::string fbx_text(const Mesh& mesh, const std::vector<std::vector<Vec2<double>>>& more = {}) {
  return fbx(fbx_geometry(mesh, "mesh", 10, more) + fbx_model(20, "node"),
             "C: \"OO\",10,20\nC: \"OO\",20,0\n");
}

/// The text above as bytes. \param version from 7500 on, offsets have 64 bits
class FbxBinary {
 public:
  static std::string of(const std::string& text, std::uint32_t version) {
    FbxBinary writer(text, version);
    writer.bytes_ = std::string("Kaydara FBX Binary  \0\x1a\0", 23) + pack({version});
    while (writer.next()) writer.node();
    writer.null_record();
    return writer.bytes_;
  }

 private:
  FbxBinary(const std::string& text, std::uint32_t version) : lines_(text), version_(version) {}

  // The next line that says something, without blanks before it.
  bool next() {
    while (std::getline(lines_, line_)) {
      line_.erase(0, std::min(line_.find_first_not_of(' '), line_.size()));
      if (!line_.empty() && line_[0] != ';') return true;
    }
    return false;
  }
  std::string word(std::uint64_t value) const {
    return version_ >= 7500 ? pack({value}) : pack({static_cast<std::uint32_t>(value)});
  }
  void null_record() { bytes_ += std::string(version_ >= 7500 ? 25 : 13, '\0'); }

  static std::string text_property(const std::string& text) {
    std::string value = text;
    if (const std::size_t at = value.find("::"); at != std::string::npos)  // the class behind the name
      value = value.substr(at + 2) + std::string("\0\1", 2) + value.substr(0, at);
    return "S" + pack({static_cast<std::uint32_t>(value.size())}) + value;
  }
  // "*N {", whose numbers are in the next line.
  std::string array_property(bool whole) {
    next();
    std::string numbers;
    std::uint32_t count = 0;
    std::istringstream list(line_.substr(2));
    for (std::string number; std::getline(list, number, ','); ++count)
      numbers += whole ? pack({static_cast<std::int32_t>(std::stol(number))}) : pack({std::stod(number)});
    next();
    return (whole ? "i" : "d") + pack<std::uint32_t>({count, 0, static_cast<std::uint32_t>(numbers.size())}) +
           numbers;
  }

  // The line that was read, with what is between its braces.
  void node() {
    const std::string key = line_.substr(0, line_.find(':'));
    std::string values = line_.substr(key.size() + 1), properties;
    const bool open = values.ends_with('{'), array = values.find('*') != std::string::npos;
    if (open) values.pop_back();
    std::uint64_t count = 0;
    const bool identity = key == "C" || key == "Geometry" || key == "Model",
               real = key == "P" && values.find("\"int\"") == std::string::npos;
    std::istringstream list(values);
    for (std::string value; std::getline(list, value, ',');) {
      value.erase(0, std::min(value.find_first_not_of(' '), value.size()));
      value.erase(value.find_last_not_of(' ') + 1);
      if (value.empty()) continue;
      ++count;
      if (array)
        properties += array_property(key == "PolygonVertexIndex");
      else if (value[0] == '"')
        properties += text_property(value.substr(1, value.size() - 2));
      else if (real)
        properties += "D" + pack({std::stod(value)});
      else if (identity)
        properties += "L" + pack({static_cast<std::int64_t>(std::stol(value))});
      else
        properties += "I" + pack({static_cast<std::int32_t>(std::stol(value))});
    }
    const std::size_t begin = bytes_.size();
    bytes_ +=
        word(0) + word(count) + word(properties.size()) + static_cast<char>(key.size()) + key + properties;
    if (open && !array) {
      while (next() && line_ != "}") node();
      null_record();
    }
    const std::string end = word(bytes_.size());
    bytes_.replace(begin, end.size(), end);
  }

  std::istringstream lines_;
  std::string line_, bytes_;
  std::uint32_t version_;
};

}  // namespace darboux::test
