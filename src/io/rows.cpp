#include "rows.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

#include <darboux/error.h>

#include "base/text.h"
#include "files.h"

namespace darboux::io {

std::size_t bytes_of(Type type) {
  return std::array<std::size_t, 10>{1, 1, 2, 2, 4, 4, 8, 8, 4, 8}[static_cast<std::size_t>(type)];
}

namespace {

template <class T>
double number_as(const char* at, Encoding encoding) {
  std::array<char, sizeof(T)> bytes;
  std::copy_n(at, sizeof(T), bytes.begin());
  const auto order = encoding == Encoding::big ? std::endian::big : std::endian::little;
  if (order != std::endian::native) std::reverse(bytes.begin(), bytes.end());
  return static_cast<double>(std::bit_cast<T>(bytes));
}

}  // namespace

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

void RowReader::expect_end(const Table& last) {
  const bool more =
      encoding_ == Encoding::ascii ? lines_.next() : bytes_.sgetc() != InputBytes::traits_type::eof();
  if (more)
    throw FileError(bytes_.path(), expected_got("the " + std::to_string(last.rows) + " rows of " + last.name +
                                                    " that its header announces",
                                                "more after them"));
}

void RowReader::cut_off(const Table& table, std::uint64_t row) const {
  throw FileError(bytes_.path(), expected_got("the " + std::to_string(table.rows) + " rows of " + table.name +
                                                  " that its header announces",
                                              "an end at " + table.name + " " + std::to_string(row)));
}

std::uint64_t RowReader::list_length(const Table& table, std::uint64_t row, double number) const {
  if (!(number >= 0 && number <= 0x1p53) || number != std::floor(number))
    throw FileError(bytes_.path(), table.name + " " + std::to_string(row) + ": " +
                                       expected_got("a list whose length is a whole number from 0 to 2^53",
                                                    shortest(number)));
  return static_cast<std::uint64_t>(number);
}

PointColumns point_columns(const Table& table, const std::string& path) {
  std::vector<std::string> names;
  for (const Field& f : table.fields) names.push_back(f.list_count ? "" : f.name);
  return PointColumns::named(names, path);
}

std::uint64_t count_of(std::string_view word, const Lines& lines) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size())
    lines.fail(in_quotes(word) + ", which is no whole number");
  return value;
}

}  // namespace darboux::io
