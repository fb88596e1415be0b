// Points as text: tables and OBJ.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include <darboux/error.h>

#include "base/text.h"
#include "files.h"
#include "points.h"

namespace darboux::io {
namespace {

// Whether the first non-empty field is a name; a misspelt number is not.
bool is_header(const std::vector<std::string_view>& fields) {
  const auto first =
      std::find_if(fields.begin(), fields.end(), [](std::string_view field) { return !field.empty(); });
  return first != fields.end() &&
         std::string_view("0123456789+-.").find(first->front()) == std::string_view::npos &&
         !parse_number(*first);
}

constexpr std::string_view opening = "[({", closing = "])}", brackets = "[({])}";

// The names of a header, or of a comment that may be one. A unit is not part of a name, be it "x [mm]",
// "x[mm]" or between blanks; nor are other brackets, as in "[nx ny nz]". If another column has the same name
// without a unit, the unit is kept in the name.
std::vector<std::string> names_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  split_row(line, separator, fields);
  const auto in_brackets = [](std::string_view field) {
    return field.size() > 2 && opening.find(field.front()) != std::string_view::npos &&
           closing.find(field.back()) != std::string_view::npos;
  };
  // Each of x, y and z has a unit, and none stands alone.
  std::size_t units = 0, alone = 0;
  for (std::size_t k = 0; k < fields.size(); ++k)
    if (in_brackets(fields[k])) ++(k > 0 && !in_brackets(fields[k - 1]) ? units : alone);
  if (separator == ' ' && units >= 3 && alone == 0) std::erase_if(fields, in_brackets);
  std::vector<std::string> names;
  for (const std::string_view field : fields) {
    const std::string_view open =
        trimmed(field.substr(std::min(field.find_first_not_of(opening), field.size())));
    const std::string_view name = trimmed(open.substr(0, open.find_first_of(brackets)));
    const bool taken = std::any_of(fields.begin(), fields.end(), [&](std::string_view other) {
      return other != field && lower(other) == lower(name);
    });
    names.emplace_back(taken ? field : name);
  }
  return names;
}

PointColumns named_columns(std::string_view line, char separator, const PointReader& reader,
                           const Lines& lines) {
  return PointColumns::named(names_of(line, separator), reader.path() + ":" + std::to_string(lines.number()));
}

// Numbers that cannot be a normal may be a colour; zeros and non-finite numbers stand for an unknown normal.
bool may_be_normal(const PointNumbers& p) {
  const double square = p[3] * p[3] + p[4] * p[4] + p[5] * p[5];
  return !std::isfinite(square) || square == 0 || (square > 0.81 && square < 1.21);
}

// The columns of a table without a header, by their number: other numbers mean positions followed by other
// data, such as a scanner's intensities.
std::optional<PointColumns> counted_columns(std::size_t count) {
  if (count == 5) return PointColumns{{0, 1, 2, 6, 7}, false, true};
  if (count == 6) return PointColumns{{0, 1, 2, 3, 4, 5}, true, false};
  if (count == 8) return PointColumns{{0, 1, 2, 3, 4, 5, 6, 7}, true, true};
  if (count < 3) return std::nullopt;
  PointColumns result{std::vector<int>(count, -1), false, false};
  for (const int k : {0, 1, 2}) result.slots[static_cast<std::size_t>(k)] = k;
  return result;
}
// Whether x increases by one from point to point: a column of row numbers.
bool counts_rows(const std::vector<Vec3<double>>& points) {
  constexpr std::size_t enough = 3;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i].x != points[i - 1].x + 1) return false;
  return points.size() >= enough && (points.front().x == 0 || points.front().x == 1);
}

}  // namespace

PointFile read_table(PointReader& reader) {
  const std::string expected =
      "rows of 3 numbers x y z, 5 with u v, 6 with nx ny nz, 8 with both, or a header of these names";
  Lines lines(reader.bytes(), expected);
  std::vector<std::string_view> fields;
  PointColumns columns, commented;
  char separator = ' ';
  bool without_header = false;
  std::optional<std::uint64_t> announced;  // the number of points, as a first line of .pts
  std::string no_normals, left;            // notes
  while (lines.next(columns.slots.empty())) {
    const bool first = columns.slots.empty();
    if (first && (lines.text().starts_with("#") || lines.text().starts_with("//"))) {
      const std::string_view text =
          lines.text().substr(std::min(lines.text().find_first_not_of("#/"), lines.text().size()));
      try {
        commented = named_columns(text, separator_of(text), reader, lines);
      } catch (const FileError&) {  // a comment of other words
      }
      continue;
    }
    if (first) separator = separator_of(lines.text());
    split_row(lines.text(), separator, fields);
    if (first && !announced && fields.size() == 1 && !fields[0].empty() &&
        fields[0].find_first_not_of("0123456789") == std::string_view::npos && fields[0].size() < 19) {
      announced = std::stoull(std::string(fields[0]));
      continue;
    }
    if (first && is_header(fields)) {
      columns = named_columns(lines.text(), separator, reader, lines);
      continue;
    }
    if (first && commented.slots.size() == fields.size()) {
      columns = commented;
    } else if (first) {
      const auto counted = counted_columns(fields.size());
      if (!counted) lines.fail("a row of " + std::to_string(fields.size()) + " columns without a header");
      columns = *counted;
      without_header = true;
      if (fields.size() > 3 && columns.slots.back() < 0)
        left = "line " + std::to_string(lines.number()) + ": of " + std::to_string(fields.size()) +
               " columns without a header those after the third are passed over";
    }
    if (fields.size() != columns.slots.size())
      lines.fail("a row of " + std::to_string(fields.size()) + " columns after " +
                 std::to_string(columns.slots.size()) + " in the first line");
    PointNumbers point{};
    for (std::size_t k = 0; k < fields.size(); ++k)
      if (columns.slots[k] >= 0)
        point[static_cast<std::size_t>(columns.slots[k])] = number_of(fields[k], lines);
    if (without_header && columns.normals && no_normals.empty() && !may_be_normal(point))
      no_normals = "line " + std::to_string(lines.number()) +
                   ": columns 4 to 6 are not unit normals; without a header the columns after the third "
                   "are passed over";
    reader.add(columns, point, "line ", lines.number());
  }
  PointFile result = reader.finish();
  if (announced && *announced != result.cloud.positions.size())
    throw FileError(reader.path(),
                    expected_got(std::to_string(*announced) + " points, as its first line says",
                                 std::to_string(result.cloud.positions.size())));
  result.note = left;
  if (!left.empty() && counts_rows(result.cloud.positions))
    throw FileError(reader.path(), expected_got(expected, "row numbers in the first of " +
                                                              std::to_string(columns.slots.size()) +
                                                              " columns without a header"));
  if (!no_normals.empty()) {
    result.cloud.normals.clear();
    result.cloud.uvs.clear();
    result.note = no_normals;
  }
  return result;
}

namespace {

// A corner of an OBJ face: "7", "7/2", "7//3" or "7/2/3", each counted from 1, or backwards from the last if
// negative. Indices from 0; none if omitted.
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
  const bool faces = std::find(used.begin(), used.end(), true) != used.end();
  if (!faces) {  // attributes go with the vertices where there are as many
    used.assign(n[0], true);
    for (std::uint32_t i = 0; i < n[0]; ++i)
      of_first_corner.push_back({n[1] == n[0] ? i : none, n[2] == n[0] ? i : none});
  }
  used.resize(n[0]);  // vertices after the last face
  of_first_corner.resize(n[0], {none, none});
  PointColumns columns{{}, true, true};
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) {
      columns.uvs = columns.uvs && of_first_corner[i][0] != none;
      columns.normals = columns.normals && of_first_corner[i][1] != none;
    }
  for (std::size_t i = 0; i < used.size(); ++i) {
    PointNumbers point;
    point.fill(std::numeric_limits<double>::quiet_NaN());  // unused vertices may have no attributes
    const auto take = [&](std::size_t k, std::uint32_t index) {
      if (index == none) return;
      std::copy_n(values[k].begin() + static_cast<std::ptrdiff_t>(index * width[k]), width[k],
                  point.begin() + first_slot[k]);
    };
    take(0, static_cast<std::uint32_t>(i));
    if (columns.uvs) take(1, of_first_corner[i][0]);
    if (columns.normals) take(2, of_first_corner[i][1]);
    reader.add(columns, point, "vertex ", i);
  }
  PointFile result = reader.finish();
  if (faces) find_places(result, used);
  return result;
}

}  // namespace darboux::io
