#include "eval_input.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <istream>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include <darboux/error.h>

#include "base/extension.h"
#include "base/text.h"
#include "command.h"
#include "io/input.h"
#include "io/json_cursor.h"

namespace darboux {
namespace {

static_assert(std::endian::native == std::endian::little, "binary points are copied as they are");

// ---- csv --------------------------------------------------------------------------------------------------

class CsvInput final : public PointInput {
 public:
  explicit CsvInput(const std::string& path) : bytes_(path, "CSV file of u,v") {}
  std::optional<double> share() const override { return bytes_.share(); }

  void read(PointBlocks& points) override {
    io::Lines lines(bytes_, "lines like 0.25,0.5");
    std::size_t u_column = 0, v_column = 1;
    std::optional<char> separator;
    std::vector<std::string_view> fields;
    while (lines.next()) {
      const bool first = !separator;
      if (first) separator = io::separator_of(lines.text());
      io::split_row(lines.text(), *separator, fields);
      if (first && !fields.empty() && !io::parse_number(fields[0])) {
        const auto column = [&](const char* name) {
          const auto found = std::find(fields.begin(), fields.end(), name);
          if (found == fields.end())
            throw FileError(bytes_.path() + ":" + std::to_string(lines.number()),
                            expected_got("two numbers such as 0.25,0.5, or a header with the columns u and v",
                                         std::string("a line without '") + name + "'"));
          return static_cast<std::size_t>(found - fields.begin());
        };
        u_column = column("u");
        v_column = column("v");
        continue;
      }
      const auto number = [&](std::size_t k) {
        return k < fields.size() ? io::parse_number(fields[k]) : std::optional<double>();
      };
      const std::optional<double> u = number(u_column), v = number(v_column);
      if (!u || !v)
        lines.fail("'" + std::string(lines.text().substr(0, 60)) + "'" +
                   (*separator == ';' && lines.text().find(',') != std::string_view::npos
                        ? ", with decimal commas; write decimal points"
                        : ""));
      points.add(*u, *v);
    }
    bytes_.finish();
    points.pass_on();
  }

 private:
  io::InputBytes bytes_;
};

// ---- json -------------------------------------------------------------------------------------------------

// A SAX listener that passes on the u and v of each sample. It remembers only its position in the document.
class SampleListener final : public nlohmann::json_sax<Json> {
 public:
  SampleListener(const io::InputBytes& bytes, PointBlocks& points) : bytes_(bytes), points_(points) {}

  bool null() override { return number_is(std::numeric_limits<double>::quiet_NaN()); }
  bool boolean(bool) override { return other(); }
  bool number_integer(number_integer_t x) override {
    return number_is(x == 0 ? -0.0 : static_cast<double>(x));  // 0 without a sign is unsigned
  }
  bool number_unsigned(number_unsigned_t x) override { return number_is(static_cast<double>(x)); }
  bool number_float(number_float_t x, const string_t&) override { return number_is(x); }
  bool string(string_t&) override { return other(); }
  bool binary(binary_t&) override { return other(); }

  bool key(string_t& name) override {
    if (depth_ == 1 && in_object_) samples_next_ = name == "samples";
    if (in_sample()) wanted_ = name == "u" ? &u_ : name == "v" ? &v_ : nullptr;
    return true;
  }
  bool start_object(std::size_t) override {
    if (depth_ == 0) in_object_ = true;
    if (at_sample())
      u_ = v_ = std::nullopt;
    else
      other();
    ++depth_;
    return true;
  }
  bool end_object() override {
    --depth_;
    if (at_sample()) {
      if (!u_ || !v_) fail("one without u or v");
      points_.add(*u_, *v_);
      ++sample_;
    }
    wanted_ = nullptr;
    return true;
  }
  bool start_array(std::size_t) override {
    const bool list = depth_ == 0 || (depth_ == 1 && in_object_ && samples_next_);
    if (!list) other();
    ++depth_;
    if (list) {
      samples_depth_ = depth_;
      found_ = true;
    }
    return true;
  }
  bool end_array() override {
    if (depth_ == samples_depth_) samples_depth_ = 0;
    --depth_;
    wanted_ = nullptr;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) override {
    io::refuse_json(bytes_.path(), error);
  }

  void finish() const {
    if (!found_) throw FileError(bytes_.path(), expected_got(samples_form, "no samples"));
  }

 private:
  static constexpr const char* samples_form =
      "an array of objects with numbers u and v, or an object with that array as its samples";
  [[noreturn]] void fail(const std::string& got) const {
    throw FileError(bytes_.path(),
                    "sample " + std::to_string(sample_) + ": " + expected_got(samples_form, got));
  }
  bool at_sample() const { return samples_depth_ > 0 && depth_ == samples_depth_; }
  bool in_sample() const { return samples_depth_ > 0 && depth_ == samples_depth_ + 1; }
  bool number_is(double x) {
    if (!in_sample() || wanted_ == nullptr) return other();
    *wanted_ = x;
    wanted_ = nullptr;
    return true;
  }
  // A value that is not u or v of a sample, and must not be taken for one.
  bool other() const {
    if (at_sample()) fail("what is no object");
    if (in_sample() && wanted_ != nullptr) fail("a u or v that is no number");
    return true;
  }

  const io::InputBytes& bytes_;
  PointBlocks& points_;
  std::size_t depth_ = 0, samples_depth_ = 0;  // of open levels: all, up to the array of samples
  bool in_object_ = false, samples_next_ = false, found_ = false;
  std::optional<double>* wanted_ = nullptr;
  std::optional<double> u_, v_;
  std::uint64_t sample_ = 0;
};

class JsonInput final : public PointInput {
 public:
  explicit JsonInput(const std::string& path) : bytes_(path, "JSON file of samples") {}
  std::optional<double> share() const override { return bytes_.share(); }

  void read(PointBlocks& points) override {
    std::istream in(&bytes_);
    SampleListener listener(bytes_, points);
    Json::sax_parse(in, &listener);
    bytes_.finish();
    listener.finish();
    points.pass_on();
  }

 private:
  io::InputBytes bytes_;
};

// ---- pairs of numbers -------------------------------------------------------------------------------------

// The subset of Python literals in a .npy header: a dictionary of strings, booleans and tuples of whole
// numbers.
class NpyHeader {
 public:
  std::string descr;
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;

  // Whether it is such a dictionary with these three keys.
  bool parse(std::string_view text) {
    rest_ = text;
    unsigned seen = 0;
    if (!take('{')) return false;
    while (!take('}')) {
      std::string key;
      if (!string(key) || !take(':')) return false;
      if (key == "descr" && string(descr))
        seen |= 1;
      else if (key == "fortran_order" && boolean(fortran_order))
        seen |= 2;
      else if (key == "shape" && tuple(shape))
        seen |= 4;
      else
        return false;
      if (!take(',') && !next_is('}')) return false;
    }
    skip();
    return rest_.empty() && seen == 7;
  }

 private:
  void skip() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }
  bool next_is(char c) {
    skip();
    return rest_.starts_with(c);
  }
  bool take(char c) {
    if (!next_is(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool word(std::string_view text) {
    skip();
    if (!rest_.starts_with(text)) return false;
    rest_.remove_prefix(text.size());
    return true;
  }
  bool string(std::string& value) {
    const char quote = next_is('\'') ? '\'' : '"';
    if (!take(quote)) return false;
    const std::size_t end = rest_.find(quote);
    if (end == std::string_view::npos) return false;
    value = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return true;
  }
  bool boolean(bool& value) {
    value = word("True");
    return value || word("False");
  }
  bool tuple(std::vector<std::uint64_t>& values) {
    if (!take('(')) return false;
    while (!take(')')) {
      skip();
      std::uint64_t value = 0;
      const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
      if (error != std::errc{}) return false;
      rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
      values.push_back(value);
      if (!take(',') && !next_is(')')) return false;
    }
    return true;
  }

  std::string_view rest_;
};

std::string shape_text(const std::vector<std::uint64_t>& shape) {
  std::string text;
  for (const std::uint64_t n : shape) text += (text.empty() ? "" : ", ") + std::to_string(n);
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

// f32, f64 and npy.
class BinaryInput final : public PointInput {
 public:
  BinaryInput(const std::string& path, PointFormat format)
      : bytes_(path,
               std::string(point_format_names[static_cast<std::size_t>(format)]) + " file of pairs u, v"),
        number_bytes_(format == PointFormat::f32 ? 4 : 8) {
    if (format == PointFormat::npy) read_npy_header();
    if (const auto size = bytes_.size()) {
      const std::uint64_t left = *size - bytes_.taken();
      if (count_ ? left != *count_ * pair_bytes() : left % pair_bytes() != 0) wrong_size(left);
      count_ = left / pair_bytes();
    }
  }
  std::optional<std::uint64_t> count() const override { return count_; }
  std::optional<double> share() const override { return bytes_.share(); }

  void read(PointBlocks& points) override {
    if (number_bytes_ == 4)
      read_as<float>(points);
    else
      read_as<double>(points);
  }

 private:
  std::uint64_t pair_bytes() const { return 2 * number_bytes_; }

  [[noreturn]] void wrong_size(std::uint64_t bytes) const {
    throw FileError(bytes_.path(),
                    expected_got((count_ ? "the " + std::to_string(*count_ * pair_bytes()) +
                                               " bytes of numbers that its header announces"
                                         : "a multiple of " + std::to_string(pair_bytes()) + " bytes, " +
                                               std::to_string(number_bytes_) + " each for u and v"),
                                 std::to_string(bytes) + " bytes"));
  }

  void read_npy_header() {
    const auto fail = [&](const std::string& got) {
      throw FileError(
          bytes_.path(),
          "header: " + expected_got(".npy version 1 or 2 with '<f4' or '<f8', C order, shape (n, 2)", got));
    };
    std::array<unsigned char, 8> start{};
    if (bytes_.take(reinterpret_cast<char*>(start.data()), 8) != 8 ||
        std::memcmp(start.data(), "\x93NUMPY", 6) != 0)
      fail("another beginning");
    if (start[6] != 1 && start[6] != 2) fail("version " + std::to_string(start[6]));
    const std::size_t length_bytes = start[6] == 1 ? 2 : 4;
    std::array<unsigned char, 4> length{};
    const bool whole = bytes_.take(reinterpret_cast<char*>(length.data()), length_bytes) == length_bytes;
    std::size_t size = 0;
    for (std::size_t k = 0; k < length_bytes; ++k) size |= static_cast<std::size_t>(length[k]) << (8 * k);
    constexpr std::size_t most = 1 << 16;
    if (size > most) fail(std::to_string(size) + " bytes");
    std::string text(size, '\0');
    if (!whole || bytes_.take(text.data(), size) != size) fail("one that is cut off");
    NpyHeader header;
    if (!header.parse(text)) fail("no dictionary of descr, fortran_order and shape");
    if (header.descr != "<f4" && header.descr != "<f8") fail("descr '" + header.descr.substr(0, 20) + "'");
    if (header.shape.size() != 2 || header.shape[1] != 2) fail("shape " + shape_text(header.shape));
    if (header.fortran_order && header.shape[0] > 1) fail("Fortran order");
    number_bytes_ = header.descr == "<f4" ? 4 : 8;
    if (header.shape[0] > std::numeric_limits<std::uint64_t>::max() / pair_bytes())
      fail("shape " + shape_text(header.shape));
    count_ = header.shape[0];
  }

  template <class T>
  void read_as(PointBlocks& points) {
    std::vector<T> pairs(8192);
    std::uint64_t read = 0;  // bytes
    while (true) {
      const std::size_t bytes = bytes_.take(reinterpret_cast<char*>(pairs.data()), pairs.size() * sizeof(T));
      read += bytes;
      if (count_ && read > *count_ * pair_bytes()) wrong_size(read);
      for (std::size_t i = 0; i + 1 < bytes / sizeof(T); i += 2)
        points.add(static_cast<double>(pairs[i]), static_cast<double>(pairs[i + 1]));
      if (bytes < pairs.size() * sizeof(T)) break;
    }
    bytes_.finish();
    if (count_ ? read != *count_ * pair_bytes() : read % pair_bytes() != 0) wrong_size(read);
    points.pass_on();
  }

  io::InputBytes bytes_;
  std::uint64_t number_bytes_;
  std::optional<std::uint64_t> count_;
};

// ---- points counted first ---------------------------------------------------------------------------------

class KeptInput final : public PointInput {
 public:
  KeptInput(PointInput& from, Progress& progress) {
    name_ = (std::filesystem::temp_directory_path() / ".darboux-points-XXXXXX").string();
    descriptor_.value = ::mkstemp(name_.data());
    if (descriptor_.value < 0) fail();
    ::unlink(name_.c_str());
    std::vector<double> pairs;
    PointBlocks blocks(8192, [&](std::span<const double> u, std::span<const double> v) {
      pairs.resize(2 * u.size());
      for (std::size_t i = 0; i < u.size(); ++i) {
        pairs[2 * i] = u[i];
        pairs[2 * i + 1] = v[i];
      }
      write(pairs);
      count_ += u.size();
      if (const auto share = from.share()) progress.update(*share);
    });
    from.read(blocks);
  }

  std::optional<std::uint64_t> count() const override { return count_; }
  std::optional<double> share() const override {
    return count_ == 0 ? 1.0 : static_cast<double>(done_) / static_cast<double>(count_);
  }
  void read(PointBlocks& points) override {
    std::vector<double> pairs(16384);
    const std::uint64_t all = count_ * 2 * sizeof(double);
    for (std::uint64_t at = 0; at < all;) {
      const std::size_t wanted = std::min<std::uint64_t>(pairs.size() * sizeof(double), all - at);
      std::size_t got = 0;
      while (got < wanted) {
        const ssize_t n = ::pread(descriptor_.value, reinterpret_cast<char*>(pairs.data()) + got,
                                  wanted - got, static_cast<off_t>(at + got));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) fail();
        got += static_cast<std::size_t>(n);
      }
      at += wanted;
      done_ = at / (2 * sizeof(double));
      for (std::size_t i = 0; i < wanted / sizeof(double); i += 2) points.add(pairs[i], pairs[i + 1]);
    }
    points.pass_on();
  }

 private:
  [[noreturn]] void fail() const {
    throw FileError(name_,
                    expected_got("a writable folder with 16 bytes per point free", std::strerror(errno)));
  }
  void write(std::span<const double> numbers) {
    const char* from = reinterpret_cast<const char*>(numbers.data());
    for (std::size_t left = numbers.size_bytes(); left > 0;) {
      const ssize_t n = ::write(descriptor_.value, from, left);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail();
      from += n;
      left -= static_cast<std::size_t>(n);
    }
  }

  std::string name_;
  io::Descriptor descriptor_;
  std::uint64_t count_ = 0, done_ = 0;
};

}  // namespace

PointFormat point_format_of(const std::string& path) {
  if (path == "-") return PointFormat::csv;
  const std::string extension = extension_of(path);
  if (extension == ".txt" || extension == ".tsv") return PointFormat::csv;
  std::string known;
  for (std::size_t k = 0; k < point_format_names.size(); ++k) {
    if (extension == std::string(".") + point_format_names[k]) return static_cast<PointFormat>(k);
    known += (known.empty() ? "." : ", .") + std::string(point_format_names[k]);
  }
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw FileError(path, expected_got("a file of points: " + known, "a folder"));
  throw FileError(path,
                  expected_got("one of the extensions " + known + ", or --input-format with one of them",
                               "'" + extension + "'"));
}

std::unique_ptr<PointInput> open_points(const std::string& path, PointFormat format) {
  if (format == PointFormat::csv) return std::make_unique<CsvInput>(path);
  if (format == PointFormat::json) return std::make_unique<JsonInput>(path);
  return std::make_unique<BinaryInput>(path, format);
}

std::unique_ptr<PointInput> counted(std::unique_ptr<PointInput> points, Progress& progress) {
  if (points->count()) return points;
  return std::make_unique<KeptInput>(*points, progress);
}

}  // namespace darboux
