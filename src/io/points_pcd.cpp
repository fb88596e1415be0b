// PCD files.
#include <algorithm>
#include <array>
#include <optional>
#include <span>

extern "C" {
#include <liblzf/lzf.h>
}

#include <darboux/error.h>

#include "base/text.h"
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
  lines.fail("TYPE " + in_quotes(kind) + " of SIZE " + std::to_string(bytes) + ", which is not a PCD type");
}

// Data that PCL compressed with LZF: two byte counts, followed for each field by its numbers of all points.
std::string decompressed(PointReader& reader, std::uint64_t expected) {
  InputBytes& bytes = reader.bytes();
  std::array<unsigned char, 8> head{};
  const auto cut_off = [&](std::uint64_t got, std::uint64_t asked) {
    throw FileError(reader.path(), "ends within its compressed data: expected " + std::to_string(asked) +
                                       " bytes, got " + std::to_string(got));
  };
  if (const std::size_t n = bytes.take(reinterpret_cast<char*>(head.data()), 8); n != 8) cut_off(n, 8);
  const auto count = [&](std::size_t at) {
    return std::uint64_t{head[at]} | std::uint64_t{head[at + 1]} << 8 | std::uint64_t{head[at + 2]} << 16 |
           std::uint64_t{head[at + 3]} << 24;
  };
  const std::uint64_t packed = count(0), whole = count(4);
  if (whole != expected)
    throw FileError(reader.path(), "expected " + std::to_string(expected) + " bytes of points, got " +
                                       std::to_string(whole));
  // Three bytes expand to at most 264.
  if (whole / 88 > packed)
    throw FileError(reader.path(), "expected at least " + std::to_string(whole / 88) +
                                       " compressed bytes for " + std::to_string(whole) + ", got " +
                                       std::to_string(packed));
  if (bytes.size() && packed > *bytes.size() - bytes.taken()) cut_off(*bytes.size() - bytes.taken(), packed);
  std::string from(packed, '\0'), to(whole, '\0');
  if (const std::size_t n = bytes.take(from.data(), packed); n != packed) cut_off(n, packed);
  if (whole > 0 && lzf_decompress(from.data(), static_cast<unsigned>(packed), to.data(),
                                  static_cast<unsigned>(whole)) != whole)
    throw FileError(reader.path(), "expected data compressed with LZF, got something else");
  return to;
}

struct PcdHeader {
  Table table{"point", 0, {}};
  std::vector<std::uint64_t> sizes, counts;  // per field
  Encoding encoding;
  bool compressed = false;
};

// The lines of a header as read, before validation.
struct PcdLines {
  std::vector<std::string> names, kinds;
  std::vector<std::uint64_t> sizes, counts;
  std::uint64_t height = 1;
  std::optional<std::uint64_t> width, points;
  std::optional<Encoding> encoding;
  bool compressed = false;

  void read(std::span<const std::string_view> words, const Lines& lines) {
    const auto refuse = [&] { lines.fail(in_quotes(lines.text()) + " in the header"); };
    const auto number = [&] {
      if (words.size() != 2) refuse();
      return count_of(words[1], lines);
    };
    const std::string_view key = words[0];
    const std::span<const std::string_view> rest = words.subspan(1);
    if (key == "VERSION" || key == "VIEWPOINT") return;
    if (key == "FIELDS") {
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
      compressed = words[1] == "binary_compressed";
      if (compressed || words[1] == "binary") encoding = Encoding::little;
      if (words[1] == "ascii") encoding = Encoding::ascii;
      if (!encoding) refuse();
    } else {
      refuse();
    }
  }
};

PcdHeader read_header(PointReader& reader, Lines& lines) {
  PcdLines header;
  std::vector<std::string_view> words;
  while (!header.encoding) {
    if (!lines.next())
      throw FileError(reader.path(), expected_got("a PCD file", "one that ends within its header"));
    split_fields(lines.text(), ' ', words);
    header.read(words, lines);
  }
  const auto& [names, kinds, sizes, counts, height, width, points, encoding, compressed] = header;
  PcdHeader result;
  result.sizes = sizes;
  result.counts = counts.empty() ? std::vector<std::uint64_t>(names.size(), 1) : counts;
  result.encoding = *encoding;
  result.compressed = compressed;
  if (sizes.size() != names.size() || kinds.size() != names.size() || result.counts.size() != names.size())
    lines.fail("FIELDS, SIZE, TYPE and COUNT of " + std::to_string(names.size()) + ", " +
               std::to_string(sizes.size()) + ", " + std::to_string(kinds.size()) + " and " +
               std::to_string(result.counts.size()) + " entries");
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::uint64_t count = result.counts[k];
    if (count > 65536) lines.fail("COUNT " + std::to_string(count) + ", above 65536");
    for (std::uint64_t j = 0; j < count; ++j)
      result.table.fields.push_back({count == 1 ? names[k] : "", pcd_type(kinds[k], sizes[k], lines)});
  }
  if (!points && !width) lines.fail("a header without POINTS and WIDTH");
  if (width && height != 0 && *width > UINT64_MAX / height) lines.fail("WIDTH times HEIGHT beyond 64 bits");
  if (width && points && *width * height != *points)
    lines.fail("WIDTH " + std::to_string(*width) + " times HEIGHT " + std::to_string(height) +
               ", but POINTS " + std::to_string(*points));
  result.table.rows = points ? *points : *width * height;
  return result;
}

// For each field the numbers of all points, one field after the other.
void read_compressed(PointReader& reader, const Lines& lines, const PcdHeader& header,
                     const PointColumns& columns) {
  const auto& [table, sizes, counts, encoding, compressed] = header;
  std::uint64_t row_bytes = 0;
  for (std::size_t k = 0; k < sizes.size(); ++k) row_bytes += sizes[k] * counts[k];
  if (row_bytes == 0 || table.rows > UINT32_MAX / row_bytes)
    lines.fail("points beyond the 4 GiB of compressed data");
  const std::string data = decompressed(reader, table.rows * row_bytes);
  for (std::uint64_t i = 0; i < table.rows; ++i) {
    PointNumbers point{};
    std::uint64_t begin = 0;
    for (std::size_t k = 0, field = 0; k < sizes.size(); ++k) {
      for (std::uint64_t j = 0; j < counts[k]; ++j, ++field)
        if (const int slot = columns.slots[field]; slot >= 0)
          point[static_cast<std::size_t>(slot)] = decode(
              table.fields[field].type, data.data() + begin + (i * counts[k] + j) * sizes[k], encoding);
      begin += table.rows * counts[k] * sizes[k];
    }
    reader.add(columns, point, "point ", i);
  }
}

}  // namespace

PointFile read_pcd_points(PointReader& reader) {
  Lines lines(reader.bytes(),
              "the lines of a PCD file: VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, "
              "POINTS, DATA ascii, binary or binary_compressed, then rows as the header has them");
  const PcdHeader header = read_header(reader, lines);
  const Table& table = header.table;
  const PointColumns columns = point_columns(table, reader.path());
  if (header.compressed) {
    read_compressed(reader, lines, header, columns);
    return reader.finish();
  }
  RowReader rows(reader.bytes(), lines, header.encoding);
  for (std::uint64_t i = 0; i < table.rows; ++i)
    reader.add(columns, rows.read_point(table, i, columns), "point ", i);
  rows.expect_end(table);
  return reader.finish();
}

}  // namespace darboux::io
