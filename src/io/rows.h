/// \file rows.h
/// PLY and PCD: a text header that describes rows of typed numbers, followed by the rows, as text or binary.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "points.h"

namespace darboux::io {

enum class Encoding { ascii, little, big };

enum class Type { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

std::size_t bytes_of(Type type);
double decode(Type type, const char* at, Encoding encoding);

struct Field {
  std::string name;
  Type type;
  std::optional<Type> list_count = std::nullopt;  // a list: a count, followed by that many numbers
};

// Rows of the same fields.
struct Table {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<Field> fields;
};

class RowReader {
 public:
  RowReader(InputBytes& bytes, Lines& lines, Encoding encoding)
      : bytes_(bytes), lines_(lines), encoding_(encoding) {}

  void pass_over(const Table& table) {
    if (table.fields.empty()) return;
    for (std::uint64_t i = 0; i < table.rows; ++i) read_row(table, i, [](std::size_t, double) {});
  }

  /// Calls use(field, number) for each number of the next row, including those of lists. \throws FileError
  template <class Use>
  void read_row(const Table& table, std::uint64_t row, Use use) {
    if (encoding_ == Encoding::ascii) {
      if (!lines_.next()) cut_off(table, row);
      split_fields(lines_.text(), ' ', words_);
      std::size_t at = 0;
      const auto word = [&] {
        if (at == words_.size()) lines_.fail("a row of " + std::to_string(at) + " numbers, too few");
        return number_of(words_[at++], lines_);
      };
      for (std::size_t k = 0; k < table.fields.size(); ++k)
        if (table.fields[k].list_count)
          for (std::uint64_t n = list_length(table, row, word()); n > 0; --n) use(k, word());
        else
          use(k, word());
      if (at != words_.size())
        lines_.fail("a row of " + std::to_string(words_.size()) + " numbers, too many");
      return;
    }
    std::array<char, 8> number{};
    const auto take = [&](Type type) {
      if (bytes_.take(number.data(), bytes_of(type)) != bytes_of(type)) cut_off(table, row);
      return decode(type, number.data(), encoding_);
    };
    for (std::size_t k = 0; k < table.fields.size(); ++k) {
      const Field& field = table.fields[k];
      if (field.list_count)
        for (std::uint64_t n = list_length(table, row, take(*field.list_count)); n > 0; --n)
          use(k, take(field.type));
      else
        use(k, take(field.type));
    }
  }

  /// The next row as a point. \param columns one per field
  PointNumbers read_point(const Table& table, std::uint64_t row, const PointColumns& columns) {
    PointNumbers point{};
    read_row(table, row, [&](std::size_t field, double value) {
      if (columns.slots[field] >= 0) point[static_cast<std::size_t>(columns.slots[field])] = value;
    });
    return point;
  }

  /// \throws FileError if anything follows the last table
  void expect_end(const Table& last);

 private:
  [[noreturn]] void cut_off(const Table& table, std::uint64_t row) const;
  std::uint64_t list_length(const Table& table, std::uint64_t row, double number) const;

  InputBytes& bytes_;
  Lines& lines_;
  Encoding encoding_;
  std::vector<std::string_view> words_;
};

/// The columns of a table that contain numbers of points; lists contain none. \throws FileError with the
/// subject `path`
PointColumns point_columns(const Table& table, const std::string& path);

/// A count in a header.
std::uint64_t count_of(std::string_view word, const Lines& lines);

}  // namespace darboux::io
