// PCD files.
#include <algorithm>
#include <optional>
#include <span>

#include <darboux/error.h>

#include "files.h"
#include "rows.h"

namespace darboux::io {
namespace {

Type pcd_type(std::string_view kind, std::uint64_t bytes, const Lines& lines) {
  for (const auto& [name, type] : {std::pair{"I1", Type::i8},
                                   {"U1", Type::u8},
                                   {"I2", Type::i16},
                                   {"U2", Type::u16},
                                   {"I4", Type::i32},
                                   {"U4", Type::u32},
                                   {"I8", Type::i64},
                                   {"U8", Type::u64},
                                   {"F4", Type::f32},
                                   {"F8", Type::f64}})
    if (std::string(kind) + std::to_string(bytes) == name) return type;
  lines.fail("TYPE " + in_quotes(kind) + " of SIZE " + std::to_string(bytes) + " is no type of PCD");
}

}  // namespace

PointFile read_pcd_points(PointReader& reader) {
  Lines lines(reader.bytes(),
              "the lines of a PCD file: VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, "
              "POINTS, DATA ascii or DATA binary, then rows as the header has them");
  std::vector<std::string> names, kinds;
  std::vector<std::uint64_t> sizes, counts;
  Table table{"point", 0, {}};
  std::uint64_t height = 1;
  std::optional<std::uint64_t> width, points;
  std::optional<Encoding> encoding;
  std::vector<std::string_view> words;
  while (!encoding) {
    if (!lines.next()) throw FileError(reader.path(), "ends within its header, permitted is a PCD file");
    split_fields(lines.text(), ' ', words);
    const std::string_view key = words[0];
    const auto number = [&] {
      if (words.size() != 2) lines.fail("the header has " + in_quotes(lines.text()));
      return count_of(words[1], lines);
    };
    const std::span<const std::string_view> rest = std::span(words).subspan(1);
    if (key == "VERSION" || key == "VIEWPOINT") {
      continue;
    } else if (key == "FIELDS") {
      names.assign(rest.begin(), rest.end());
    } else if (key == "TYPE") {
      kinds.assign(rest.begin(), rest.end());
    } else if (key == "SIZE" || key == "COUNT") {
      for (const std::string_view word : rest)
        (key == "SIZE" ? sizes : counts).push_back(count_of(word, lines));
    } else if (key == "WIDTH") {
      width = number();
    } else if (key == "HEIGHT") {
      height = number();
    } else if (key == "POINTS") {
      points = number();
    } else if (key == "DATA" && words.size() == 2) {
      if (words[1] == "binary_compressed")
        lines.fail("the data are compressed (pcl_convert_pcd_ascii_binary IN.pcd OUT.pcd 1 undoes it)");
      if (words[1] == "ascii") encoding = Encoding::ascii;
      if (words[1] == "binary") encoding = Encoding::little;
      if (!encoding) lines.fail("the header has " + in_quotes(lines.text()));
    } else {
      lines.fail("the header has " + in_quotes(lines.text()));
    }
  }
  if (counts.empty()) counts.assign(names.size(), 1);
  if (sizes.size() != names.size() || kinds.size() != names.size() || counts.size() != names.size())
    lines.fail("FIELDS, SIZE, TYPE and COUNT of " + std::to_string(names.size()) + ", " +
               std::to_string(sizes.size()) + ", " + std::to_string(kinds.size()) + " and " +
               std::to_string(counts.size()) + " entries");
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (counts[k] > 65536) lines.fail("COUNT " + std::to_string(counts[k]) + ", above 65536");
    for (std::uint64_t j = 0; j < counts[k]; ++j)
      table.fields.push_back({counts[k] == 1 ? names[k] : "", pcd_type(kinds[k], sizes[k], lines)});
  }
  if (!points && !width) lines.fail("a header without POINTS and WIDTH");
  if (width && height != 0 && *width > UINT64_MAX / height) lines.fail("WIDTH times HEIGHT beyond 64 bits");
  if (width && points && *width * height != *points)
    lines.fail("WIDTH " + std::to_string(*width) + " times HEIGHT " + std::to_string(height) +
               ", but POINTS " + std::to_string(*points));
  table.rows = points ? *points : *width * height;
  RowReader rows(reader.bytes(), lines, *encoding);
  const PointColumns columns = point_columns(table, reader.path());
  for (std::uint64_t i = 0; i < table.rows; ++i)
    reader.add(columns, rows.read_point(table, i, columns), "point ", i);
  rows.expect_end(table);
  return reader.finish();
}

}  // namespace darboux::io
