// PLY and PCD: a header in lines that describes rows of typed numbers, then the rows, as text or as bytes.
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

#include <darboux/error.h>

#include "../text.h"
#include "files.h"
#include "points.h"

namespace darboux::io {
namespace {

enum class Encoding { ascii, little, big };

enum class Type { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

std::size_t bytes_of(Type type) {
  return std::array<std::size_t, 10>{1, 1, 2, 2, 4, 4, 8, 8, 4, 8}[static_cast<std::size_t>(type)];
}

template <class T>
double number_as(const char* at, Encoding encoding) {
  std::array<char, sizeof(T)> bytes;
  std::copy_n(at, sizeof(T), bytes.begin());
  const auto order = encoding == Encoding::big ? std::endian::big : std::endian::little;
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return static_cast<double>(std::bit_cast<T>(bytes));
}

double decode(Type type, const char* at, Encoding encoding) {
  switch (type) {
    case Type::i8:
      return number_as<std::int8_t>(at, encoding);
    case Type::u8:
      return number_as<std::uint8_t>(at, encoding);
    case Type::i16:
      return number_as<std::int16_t>(at, encoding);
    case Type::u16:
      return number_as<std::uint16_t>(at, encoding);
    case Type::i32:
      return number_as<std::int32_t>(at, encoding);
    case Type::u32:
      return number_as<std::uint32_t>(at, encoding);
    case Type::i64:
      return number_as<std::int64_t>(at, encoding);
    case Type::u64:
      return number_as<std::uint64_t>(at, encoding);
    case Type::f32:
      return number_as<float>(at, encoding);
    case Type::f64:
      return number_as<double>(at, encoding);
  }
  return 0;
}

struct Field {
  std::string name;
  Type type;
  std::optional<Type> list_count = std::nullopt;  // a list: so many numbers after their count
};

// Rows of the same fields.
struct Table {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<Field> fields;
};

// Reads rows, and points out of them.
class RowReader {
 public:
  RowReader(PointReader& reader, Lines& lines, Encoding encoding)
      : reader_(reader), lines_(lines), encoding_(encoding) {}

  void pass_over(const Table& table) {
    if (table.fields.empty()) return;
    for (std::uint64_t i = 0; i < table.rows; ++i) read_row(table, i, [](std::size_t, double) {});
  }

  void read_points(const Table& table) {
    std::vector<std::string> names;
    for (const Field& f : table.fields) names.push_back(f.list_count ? "" : f.name);
    const auto columns = PointColumns::named(names, reader_.path());
    for (std::uint64_t i = 0; i < table.rows; ++i) {
      PointNumbers point{};
      read_row(table, i, [&](std::size_t field, double value) {
        if (columns.slots[field] >= 0) point[static_cast<std::size_t>(columns.slots[field])] = value;
      });
      reader_.add(columns, point, table.name + " ", i);
    }
  }

  void expect_end(const Table& table) {
    const bool more = encoding_ == Encoding::ascii
                          ? lines_.next()
                          : reader_.bytes().sgetc() != InputBytes::traits_type::eof();
    if (more)
      throw FileError(reader_.path(), "goes on after the last " + table.name + ", permitted are the " +
                                          std::to_string(table.rows) + " that its header announces");
  }

 private:
  // use(field, value) for each number that is not in a list.
  template <class Use>
  void read_row(const Table& table, std::uint64_t row, Use use) {
    const auto cut_off = [&] {
      throw FileError(reader_.path(), "ends at " + table.name + " " + std::to_string(row) +
                                          ", permitted are the " + std::to_string(table.rows) +
                                          " that its header announces");
    };
    const auto list_length = [&](double n) {
      if (!(n >= 0 && n <= 0x1p53) || n != std::floor(n))
        throw FileError(reader_.path(), table.name + " " + std::to_string(row) + " has a list of " +
                                            shortest(n) +
                                            " numbers, permitted are whole numbers from 0 to 2^53");
      return static_cast<std::uint64_t>(n);
    };
    if (encoding_ == Encoding::ascii) {
      if (!lines_.next()) cut_off();
      split_fields(lines_.text(), ' ', words_);
      std::size_t at = 0;
      const auto word = [&] {
        if (at == words_.size()) lines_.fail("a row of " + std::to_string(at) + " numbers, too few");
        return number_of(words_[at++], lines_);
      };
      for (std::size_t k = 0; k < table.fields.size(); ++k)
        if (table.fields[k].list_count)
          for (std::uint64_t n = list_length(word()); n > 0; --n) word();
        else
          use(k, word());
      if (at != words_.size())
        lines_.fail("a row of " + std::to_string(words_.size()) + " numbers, too many");
      return;
    }
    std::array<char, 8> number{};
    const auto take = [&](Type type) {
      if (reader_.bytes().take(number.data(), bytes_of(type)) != bytes_of(type)) cut_off();
      return decode(type, number.data(), encoding_);
    };
    for (std::size_t k = 0; k < table.fields.size(); ++k) {
      const Field& field = table.fields[k];
      if (field.list_count)
        for (std::uint64_t n = list_length(take(*field.list_count)); n > 0; --n) take(field.type);
      else
        use(k, take(field.type));
    }
  }

  PointReader& reader_;
  Lines& lines_;
  Encoding encoding_;
  std::vector<std::string_view> words_;
};

std::uint64_t count_of(std::string_view word, const Lines& lines) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size())
    lines.fail(in_quotes(word) + " is no whole number");
  return value;
}

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
  lines.fail(in_quotes(word) + " is no type of PLY");
}

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

PointFile read_ply_points(PointReader& reader) {
  Lines lines(reader.bytes(),
              "the lines of a PLY file: ply, format, comment, element, property, end_header, then rows "
              "as the header has them");
  if (!lines.next() || lines.text() != "ply")
    throw FileError(reader.path(), "does not begin with ply, permitted is a PLY file");
  std::optional<Encoding> encoding;
  std::vector<Table> tables;
  std::vector<std::string_view> words;
  while (true) {
    if (!lines.next()) throw FileError(reader.path(), "ends within its header, permitted is a PLY file");
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
      lines.fail("the header has " + in_quotes(lines.text()));
    }
  }
  if (!encoding) throw FileError(reader.path(), "its header has no format, permitted is a PLY file");
  const auto named = [&](const char* name) {
    return std::find_if(tables.begin(), tables.end(), [&](const Table& t) { return t.name == name; });
  };
  const auto vertices = named("vertex"), faces = named("face");
  if (vertices == tables.end())
    throw FileError(reader.path(), "has no element vertex, permitted is a PLY file with vertices");
  RowReader rows(reader, lines, *encoding);
  for (auto t = tables.begin(); t != vertices; ++t) rows.pass_over(*t);
  rows.read_points(*vertices);
  if (vertices + 1 == tables.end()) rows.expect_end(*vertices);
  PointFile result = reader.finish();
  if (faces != tables.end() && faces->rows > 0)
    find_places(result, std::vector<bool>(result.cloud.positions.size(), true));
  return result;
}

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
  RowReader rows(reader, lines, *encoding);
  rows.read_points(table);
  rows.expect_end(table);
  return reader.finish();
}

}  // namespace darboux::io
