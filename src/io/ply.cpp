// PLY files: their vertices as points, with their faces as a mesh.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

#include <darboux/error.h>

#include "base/text.h"
#include "budget.h"
#include "files.h"
#include "mesh_files.h"
#include "rows.h"

namespace darboux::io {
namespace {

constexpr const char* ply_lines =
    "the lines of a PLY file: ply, format, comment, element, property, end_header, then rows as the header "
    "has them";

struct PlyHeader {
  Encoding encoding;
  std::vector<Table> tables;

  std::vector<Table>::const_iterator table(std::string_view name) const {
    return std::find_if(tables.begin(), tables.end(), [&](const Table& t) { return t.name == name; });
  }
  /// \throws FileError if there are none
  std::vector<Table>::const_iterator vertices(const std::string& path) const {
    const auto found = table("vertex");
    if (found == tables.end())
      throw FileError(path, expected_got("a PLY file with vertices", "one without the element vertex"));
    return found;
  }
};

Type ply_type(std::string_view word, const Lines& lines) {
  constexpr std::array<std::pair<std::string_view, Type>, 16> names{{{"char", Type::i8},
                                                                     {"int8", Type::i8},
                                                                     {"uchar", Type::u8},
                                                                     {"uint8", Type::u8},
                                                                     {"short", Type::i16},
                                                                     {"int16", Type::i16},
                                                                     {"ushort", Type::u16},
                                                                     {"uint16", Type::u16},
                                                                     {"int", Type::i32},
                                                                     {"int32", Type::i32},
                                                                     {"uint", Type::u32},
                                                                     {"uint32", Type::u32},
                                                                     {"float", Type::f32},
                                                                     {"float32", Type::f32},
                                                                     {"double", Type::f64},
                                                                     {"float64", Type::f64}}};
  for (const auto& [name, type] : names)
    if (word == name) return type;
  lines.fail(in_quotes(word) + ", which is not a PLY type");
}

PlyHeader read_header(Lines& lines, const std::string& path) {
  if (!lines.next() || lines.text() != "ply")
    throw FileError(path, expected_got("a PLY file, which begins with ply", "another beginning"));
  std::optional<Encoding> encoding;
  std::vector<Table> tables;
  std::vector<std::string_view> words;
  while (true) {
    if (!lines.next()) throw FileError(path, expected_got("a PLY file", "one that ends within its header"));
    split_fields(lines.text(), ' ', words);
    if (words[0] == "end_header") break;
    if (words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "format" && words.size() == 3) {
      constexpr std::array<std::string_view, 3> names{"ascii", "binary_little_endian", "binary_big_endian"};
      const auto found = std::find(names.begin(), names.end(), words[1]);
      if (found == names.end()) lines.fail("the format " + in_quotes(words[1]));
      encoding = static_cast<Encoding>(found - names.begin());
    } else if (words[0] == "element" && words.size() == 3) {
      tables.push_back({std::string(words[1]), count_of(words[2], lines), {}});
    } else if (words[0] == "property" && words.size() == 3 && !tables.empty()) {
      tables.back().fields.push_back({std::string(words[2]), ply_type(words[1], lines)});
    } else if (words[0] == "property" && words.size() == 5 && words[1] == "list" && !tables.empty()) {
      const Type count = ply_type(words[2], lines);
      if (count == Type::f32 || count == Type::f64)
        lines.fail("a list whose length is of type " + in_quotes(words[2]));
      tables.back().fields.push_back({std::string(words[4]), ply_type(words[3], lines), count});
    } else {
      lines.fail(in_quotes(lines.text()) + " in the header");
    }
  }
  if (!encoding) throw FileError(path, expected_got("a PLY file", "one without a format in its header"));
  return {*encoding, std::move(tables)};
}

// The field that is a list with one of these names, else the number of fields.
std::size_t list_named(const Table& table, std::initializer_list<std::string_view> names) {
  std::size_t k = 0;
  while (k < table.fields.size() &&
         (!table.fields[k].list_count ||
          std::find(names.begin(), names.end(), table.fields[k].name) == names.end()))
    ++k;
  return k;
}

void read_vertices(RowReader& rows, const Table& table, const std::string& path, Mesh& mesh) {
  const PointColumns columns = point_columns(table, path);
  for (std::uint64_t i = 0; i < table.rows; ++i) {
    const PointNumbers p = rows.read_point(table, i, columns);
    mesh.positions.push_back({p[0], p[1], p[2]});
    if (columns.normals) mesh.normals.push_back({p[3], p[4], p[5]});
    if (columns.uvs) mesh.uvs.push_back({p[6], p[7]});
  }
}

// A face, for messages.
struct FacePlace {
  const std::string& path;
  std::uint64_t number;
  [[noreturn]] void fail(const std::string& expected, const std::string& got) const {
    throw FileError(path, "face " + std::to_string(number) + ": " + expected_got(expected, got));
  }
};

// \param corner_uvs receives those of the triangles' corners, if faces have their own
void read_faces(RowReader& rows, const Table& table, const std::string& path, std::uint64_t vertices,
                Budget& budget, Mesh& mesh, std::vector<Vec2<double>>& corner_uvs) {
  const std::size_t corners_at = list_named(table, {"vertex_indices", "vertex_index"}),
                    uvs_at = list_named(table, {"texcoord"});
  const bool with_uvs = uvs_at != table.fields.size();
  if (corners_at == table.fields.size())
    throw FileError(path, expected_got("faces with a list vertex_indices", "faces without corners"));
  // Corners with uvs of their own become vertices.
  const std::uint64_t corner_bytes = with_uvs ? sizeof mesh.positions[0] + sizeof mesh.uvs[0] +
                                                    (mesh.normals.empty() ? 0 : sizeof mesh.normals[0])
                                              : 0;
  std::vector<double> corners, uvs;
  for (std::uint64_t i = 0; i < table.rows; ++i) {
    corners.clear();
    uvs.clear();
    rows.read_row(table, i, [&](std::size_t field, double value) {
      if (field == corners_at) corners.push_back(value);
      if (field == uvs_at) uvs.push_back(value);
    });
    const FacePlace face{path, i};
    for (const double c : corners)
      if (!(c >= 0 && c < static_cast<double>(vertices)) || c != std::floor(c))
        face.fail("corners that are whole numbers below its " + std::to_string(vertices) + " vertices",
                  shortest(c));
    if (with_uvs && uvs.size() != 2 * corners.size())
      face.fail("a texcoord of two numbers for each of its " + std::to_string(corners.size()) + " corners",
                std::to_string(uvs.size()));
    if (corners.size() > 2)
      budget.take((corners.size() - 2) * (triangle_bytes + 3 * corner_bytes), face,
                  "its " + std::to_string(corners.size() - 2) + " triangles");
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      Triangle triangle;
      for (std::size_t j = 0; j < 3; ++j) {
        const std::size_t at = j == 0 ? 0 : k + j - 1;
        triangle[j] = static_cast<std::uint32_t>(corners[at]);
        if (with_uvs) corner_uvs.push_back({uvs[2 * at], uvs[2 * at + 1]});
      }
      mesh.triangles.push_back(triangle);
    }
  }
}

// A mesh with one vertex per corner, so that each has its own uv.
Mesh with_corner_uvs(const Mesh& mesh, std::vector<Vec2<double>> corner_uvs) {
  Mesh result;
  for (const Triangle& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(result.positions.size());
    result.triangles.push_back({first, first + 1, first + 2});
    for (const std::uint32_t v : triangle) {
      result.positions.push_back(mesh.positions[v]);
      if (!mesh.normals.empty()) result.normals.push_back(mesh.normals[v]);
    }
  }
  result.uvs = std::move(corner_uvs);
  return result;
}

}  // namespace

PointFile read_ply_points(PointReader& reader) {
  Lines lines(reader.bytes(), ply_lines);
  const PlyHeader header = read_header(lines, reader.path());
  const auto vertices = header.vertices(reader.path()), faces = header.table("face");
  RowReader rows(reader.bytes(), lines, header.encoding);
  for (auto t = header.tables.begin(); t != vertices; ++t) rows.pass_over(*t);
  const PointColumns columns = point_columns(*vertices, reader.path());
  for (std::uint64_t i = 0; i < vertices->rows; ++i)
    reader.add(columns, rows.read_point(*vertices, i, columns), "vertex ", i);
  if (vertices + 1 == header.tables.end()) rows.expect_end(*vertices);
  PointFile result = reader.finish();
  if (faces != header.tables.end() && faces->rows > 0)
    find_places(result, std::vector<bool>(result.cloud.positions.size(), true));
  return result;
}

Asset read_ply(const std::string& path, const ReadOptions& options) {
  InputBytes bytes(path, "PLY file");
  Lines lines(bytes, ply_lines);
  const PlyHeader header = read_header(lines, path);
  const auto vertices = header.vertices(path), faces = header.table("face");
  if (vertices->rows > UINT32_MAX)
    throw FileError(path, expected_got("at most 4294967295 vertices", std::to_string(vertices->rows)));
  RowReader rows(bytes, lines, header.encoding);
  Budget budget(options, bytes.size().value_or(0));
  Primitive primitive;
  std::vector<Vec2<double>> corner_uvs;
  for (auto t = header.tables.begin(); t != header.tables.end(); ++t)
    if (t == vertices)
      read_vertices(rows, *t, path, primitive.data);
    else if (t == faces)
      read_faces(rows, *t, path, vertices->rows, budget, primitive.data, corner_uvs);
    else
      rows.pass_over(*t);
  rows.expect_end(header.tables.back());
  bytes.finish();
  if (primitive.data.triangles.empty())
    return {
        {},
        {{0, 0,
          faces != header.tables.end() ? "its faces have no triangles"
          : header.table("tristrips") != header.tables.end()
              ? "its triangles are strips (element tristrips), which are not read: expected an element face"
              : "points without faces have no triangles"}}};
  if (!corner_uvs.empty() && primitive.data.uvs.empty())
    primitive.data = with_corner_uvs(primitive.data, std::move(corner_uvs));
  primitive.texcoord = primitive.data.uvs.empty() ? -1 : 0;
  primitive.instances = std::vector{Eigen::Matrix4d::Identity().eval()};
  Asset asset;
  asset.primitives.push_back(std::move(primitive));
  return asset;
}

}  // namespace darboux::io
