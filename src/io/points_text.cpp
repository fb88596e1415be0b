// Points as text: tables, OBJ, and STL, whose ASCII form is lines too.
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>

#include <darboux/error.h>

#include "files.h"
#include "points.h"

namespace darboux::io {
namespace {

// Whether the first field of a table is a name; a number that is misspelt is none.
bool begins_header(std::string_view field) {
  return !field.empty() && (std::isalpha(static_cast<unsigned char>(field[0])) || field[0] == '"') &&
         !parse_number(field);
}

// The columns of a table without a header.
std::optional<PointColumns> counted_columns(std::size_t count) {
  if (count == 3) return PointColumns{{0, 1, 2}, false, false};
  if (count == 5) return PointColumns{{0, 1, 2, 6, 7}, false, true};
  if (count == 6) return PointColumns{{0, 1, 2, 3, 4, 5}, true, false};
  if (count == 8) return PointColumns{{0, 1, 2, 3, 4, 5, 6, 7}, true, true};
  return std::nullopt;
}

}  // namespace

PointFile read_table(PointReader& reader) {
  Lines lines(
      reader.bytes(),
      "rows of 3 numbers x y z, 5 with u v, 6 with nx ny nz, 8 with both, or a header of these names");
  std::vector<std::string_view> fields;
  PointColumns columns;
  char separator = ' ';
  while (lines.next()) {
    const bool first = columns.slots.empty();
    if (first)
      for (const char c : {',', ';'})
        if (lines.text().find(c) != std::string_view::npos) separator = c;
    split_fields(lines.text(), separator, fields);
    if (first && begins_header(fields[0])) {
      std::vector<std::string> names;
      for (std::string_view name : fields) {
        if (name.size() > 1 && name.front() == '"' && name.back() == '"')
          name = name.substr(1, name.size() - 2);
        names.emplace_back(name);
      }
      columns = PointColumns::named(names, reader.path() + ":" + std::to_string(lines.number()));
      continue;
    }
    if (first) {
      const auto counted = counted_columns(fields.size());
      if (!counted) lines.fail("a row of " + std::to_string(fields.size()) + " columns without a header");
      columns = *counted;
    }
    if (fields.size() != columns.slots.size())
      lines.fail("a row of " + std::to_string(fields.size()) + " columns after " +
                 std::to_string(columns.slots.size()) + " in the first line");
    PointNumbers point{};
    for (std::size_t k = 0; k < fields.size(); ++k)
      if (columns.slots[k] >= 0)
        point[static_cast<std::size_t>(columns.slots[k])] = number_of(fields[k], lines);
    reader.add(columns, point, "line ", lines.number());
  }
  return reader.finish();
}

namespace {

// A corner of an OBJ's face: "7", "7/2", "7//3" or "7/2/3", each counted from 1, or from the last with a minus. Indices
// from 0; none where it is left out.
struct ObjCorner {
  std::array<std::optional<std::size_t>, 3> index;
};
ObjCorner obj_corner(std::string_view text, const std::array<std::size_t, 3>& counts, const Lines& lines) {
  ObjCorner corner;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t end = std::min(text.find('/'), text.size());
    if (end > 0) {
      std::int64_t value = 0;
      const auto [last, error] = std::from_chars(text.data(), text.data() + end, value);
      const auto count = static_cast<std::int64_t>(counts[k]);
      const std::int64_t index = value < 0 ? count + value : value - 1;
      if (error != std::errc{} || last != text.data() + end || index < 0 || index >= count)
        lines.fail("a face with the index " + in_quotes(text.substr(0, end)) + " after " +
                   std::to_string(counts[k]) +
                   (k == 0   ? " v"
                    : k == 1 ? " vt"
                             : " vn") +
                   " lines");
      corner.index[k] = static_cast<std::size_t>(index);
    }
    if (end == text.size()) break;
    text.remove_prefix(end + 1);
  }
  if (!corner.index[0]) lines.fail("a face without the index of a vertex");
  return corner;
}

}  // namespace

PointFile read_obj_points(PointReader& reader) {
  Lines lines(reader.bytes(), "v X Y Z, vt U V, vn X Y Z, and f with indices of lines before it");
  std::array<std::vector<double>, 3> values;  // of v, vt and vn
  constexpr std::array<std::size_t, 3> width{3, 2, 3}, first_slot{0, 6, 3};
  const auto counts = [&] {
    std::array<std::size_t, 3> n{};
    for (std::size_t k = 0; k < 3; ++k) n[k] = values[k].size() / width[k];
    return n;
  };
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::array<std::uint32_t, 2>> of_first_corner;  // vt and vn of each v that a face uses
  std::vector<bool> used;
  std::vector<std::string_view> fields;
  while (lines.next()) {
    split_fields(lines.text(), ' ', fields);
    for (std::size_t k = 0; k < 3; ++k) {
      if (fields[0] != std::array{"v", "vt", "vn"}[k]) continue;
      if (fields.size() <= width[k])
        lines.fail(std::string(fields[0]) + " with " + std::to_string(fields.size() - 1) + " numbers");
      for (std::size_t j = 1; j <= width[k]; ++j) values[k].push_back(number_of(fields[j], lines));
    }
    if (fields[0] != "f") continue;
    const auto n = counts();
    used.resize(n[0]);
    of_first_corner.resize(n[0], {none, none});
    for (std::size_t j = 1; j < fields.size(); ++j) {
      const auto [v, vt, vn] = obj_corner(fields[j], n, lines).index;
      if (used[*v]) continue;
      used[*v] = true;
      of_first_corner[*v] = {vt ? static_cast<std::uint32_t>(*vt) : none,
                             vn ? static_cast<std::uint32_t>(*vn) : none};
    }
  }
  const auto n = counts();
  const bool faces = !used.empty();
  if (!faces) {  // attributes go with the vertices where there are as many
    used.assign(n[0], true);
    for (std::uint32_t i = 0; i < n[0]; ++i)
      of_first_corner.push_back({n[1] == n[0] ? i : none, n[2] == n[0] ? i : none});
  }
  PointColumns columns{{}, true, true};
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) {
      columns.uvs = columns.uvs && of_first_corner[i][0] != none;
      columns.normals = columns.normals && of_first_corner[i][1] != none;
    }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    PointNumbers point{};
    const auto take = [&](std::size_t k, std::size_t index) {
      std::copy_n(values[k].begin() + static_cast<std::ptrdiff_t>(index * width[k]), width[k],
                  point.begin() + first_slot[k]);
    };
    take(0, i);
    if (columns.uvs) take(1, of_first_corner[i][0]);
    if (columns.normals) take(2, of_first_corner[i][1]);
    reader.add(columns, point, "vertex ", i);
  }
  PointFile result = reader.finish();
  if (faces) keep_distinct(result.cloud);
  return result;
}

PointFile read_stl_points(PointReader& reader) {
  static_assert(std::endian::native == std::endian::little, "binary numbers are copied as they are");
  InputBytes& bytes = reader.bytes();
  const PointColumns columns{{0, 1, 2}, false, false};
  const std::uint64_t size = bytes.size().value_or(0);
  std::array<char, 84> start{};
  std::uint32_t triangles = 0;
  std::ifstream peek(reader.path(), std::ios::binary);
  const bool whole = static_cast<bool>(peek.read(start.data(), start.size()));
  std::memcpy(&triangles, start.data() + 80, sizeof triangles);
  // Binary files may begin with "solid" too: their size tells.
  if (whole && size == 84 + std::uint64_t{50} * triangles) {
    bytes.take(start.data(), start.size());
    std::array<char, 50> record{};
    for (std::uint64_t t = 0; t < triangles && bytes.take(record.data(), 50) == 50; ++t)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        std::array<float, 3> p{};
        std::memcpy(p.data(), record.data() + 12 + 12 * corner, sizeof p);
        reader.add(columns, {p[0], p[1], p[2]}, "triangle ", t);
      }
  } else if (std::string_view(start.data(), start.size()).starts_with("solid")) {
    Lines lines(bytes, "lines like vertex 0 0.5 1");
    std::vector<std::string_view> fields;
    bool ended = false;
    while (lines.next()) {
      split_fields(lines.text(), ' ', fields);
      ended = fields[0] == "endsolid";
      if (fields[0] != "vertex") continue;
      if (fields.size() != 4) lines.fail("a vertex of " + std::to_string(fields.size() - 1) + " numbers");
      reader.add(columns,
                 {number_of(fields[1], lines), number_of(fields[2], lines), number_of(fields[3], lines)},
                 "line ", lines.number());
    }
    if (!ended) throw FileError(reader.path(), "ends before its endsolid, permitted is a whole STL file");
  } else {
    throw FileError(
        reader.path(),
        "is no STL file, permitted are ASCII, which begins with solid, and binary: 84 bytes and 50 for "
        "each triangle that they count" +
            (whole
                 ? ", here " + std::to_string(triangles) + " triangles in " + std::to_string(size) + " bytes"
                 : std::string()));
  }
  PointFile result = reader.finish();
  keep_distinct(result.cloud);
  return result;
}

}  // namespace darboux::io
