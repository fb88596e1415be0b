#include "eval_output.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <limits>

#include "base/parallel_jobs.h"
#include "command.h"
#include "csv_text.h"

namespace darboux {
namespace {

static_assert(std::endian::native == std::endian::little, "binary frames are copied as they are");

std::size_t components(const std::vector<const EvalAttribute*>& attributes) {
  std::size_t sum = 0;
  for (const EvalAttribute* a : attributes) sum += a->components;
  return sum;
}

// The attributes that batches do not have, each at its place in the first point's numbers; points are
// `stride` numbers apart.
struct PointByPoint {
  const EvalAttribute* attribute;
  double* to;
  std::size_t stride;
};
void compute(const AnySurface& surface, const Points<double>& points, const std::vector<PointByPoint>& wanted,
             int threads) {
  if (wanted.empty()) return;
  constexpr std::size_t piece = 256;
  parallel_for((points.size() + piece - 1) / piece, threads,
               [&](std::size_t k) {
                 for (std::size_t i = k * piece; i < std::min((k + 1) * piece, points.size()); ++i) {
                   const Vec2<double> at = points[i];
                   const Sample<double> sample = surface.sample(at.x, at.y);
                   for (const PointByPoint& w : wanted)
                     w.attribute->compute(surface, sample, w.to + i * w.stride);
                 }
               },
               [](double) {});
}

// ---- bare numbers -----------------------------------------------------------------------------------------

// Evaluated in double whatever the output type, so that the result belongs to the u, v and parameters given.
template <class T>
class BinaryWriter final : public FrameWriter {
 public:
  BinaryWriter(OutputFile& file, const AnySurface& surface, const FrameWriterOptions& options)
      : file_(file), surface_(surface), width_(components(options.attributes)), rows_(options.room * width_) {
    evaluate_.threads = options.threads;
    evaluate_.stores = Stores::cached;  // they are read at once
    std::size_t at = 0;
    for (const EvalAttribute* a : options.attributes) {
      if (a->batch)
        outputs_.member(*a->batch, rows_.data() + at, options.room,
                        static_cast<std::ptrdiff_t>(width_ * sizeof(double)));
      else
        point_by_point_.push_back({a, rows_.data() + at, width_});
      at += a->components;
    }
    if (options.format == FrameFormat::npy) file_.write(npy_header(options.points, width_));
  }

  void write(std::span<const double> u, std::span<const double> v) override {
    write(Points<double>::arrays(u, v));
  }
  void write_grid(std::size_t columns, std::size_t rows, std::size_t first, std::size_t count) override {
    write(Points<double>::grid(columns, rows, first, count));
  }

 private:
  void write(const Points<double>& points) {
    surface_.evaluate(points, outputs_, evaluate_);
    compute(surface_, points, point_by_point_, evaluate_.threads);
    const std::span<const double> numbers(rows_.data(), points.size() * width_);
    if constexpr (std::same_as<T, double>) {
      write(numbers);
    } else {
      stored_.assign(numbers.begin(), numbers.end());
      write(std::span<const T>(stored_));
    }
  }
  template <class Number>
  void write(std::span<const Number> numbers) {
    file_.write({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});
  }

  static std::string npy_header(std::uint64_t points, std::size_t width) {
    constexpr std::size_t size = 128;  // room for 20 digits of each
    std::string header("\x93NUMPY\x01\x00\x00\x00", 10);
    header[8] = static_cast<char>(size - header.size());
    header += "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(points) + ", " +
              std::to_string(width) + "), }";
    header.resize(size - 1, ' ');
    return header + '\n';
  }

  OutputFile& file_;
  const AnySurface& surface_;
  std::size_t width_;
  std::vector<double> rows_;
  std::vector<T> stored_;
  Outputs<double> outputs_;
  std::vector<PointByPoint> point_by_point_;
  EvaluateOptions evaluate_;
};

// ---- text -------------------------------------------------------------------------------------------------

// table, json or csv. The status is that of sample(), for which all partials are evaluated, requested or not.
class TextWriter final : public FrameWriter {
 public:
  TextWriter(OutputFile& file, const AnySurface& surface, const FrameWriterOptions& options)
      : file_(file),
        surface_(surface),
        format_(options.format == FrameFormat::json  ? &TextWriter::append_sample
                : options.format == FrameFormat::csv ? &TextWriter::append_csv
                                                     : &TextWriter::append_table),
        json_(options.format == FrameFormat::json),
        chosen_(options.attributes),
        status_(options.room),
        threads_(options.threads) {
    evaluate_.threads = options.threads;
    evaluate_.stores = Stores::cached;  // they are read at once
    const auto ask = [&](const EvalAttribute& a) {
      std::vector<double>& values = values_[place_of(a)];
      if (!values.empty()) return;
      values.resize(options.room * a.components);
      if (a.batch)
        outputs_.packed(*a.batch, values);
      else
        point_by_point_.push_back({&a, values.data(), a.components});
    };
    for (const EvalAttribute* a : chosen_) ask(*a);
    for (const EvalAttribute& a : eval_attributes())
      if (a.batch && partial_attributes.has(*a.batch)) ask(a);
    outputs_.status(status_);

    if (json_) {
      file_.write("{\"surface\": " + json_text(surface_json(surface), -1) + ",\n \"samples\": [");
    } else if (options.format == FrameFormat::csv) {
      std::string header = "u,v";
      for (const EvalAttribute* a : chosen_)
        for (const std::string_view column : a->columns) header.append(",").append(a->name).append(column);
      file_.write(header + ",status\n");
    }
  }

  void write(std::span<const double> u, std::span<const double> v) override {
    write(Points<double>::arrays(u, v));
  }
  void write_grid(std::size_t columns, std::size_t rows, std::size_t first, std::size_t count) override {
    write(Points<double>::grid(columns, rows, first, count));
  }
  void finish() override {
    if (json_) file_.write("]}\n");
  }

 private:
  static std::size_t place_of(const EvalAttribute& a) {
    return static_cast<std::size_t>(&a - eval_attributes().data());
  }

  // Pieces of a block are formatted in parallel, one thread each, and written in order.
  void write(const Points<double>& points) {
    surface_.evaluate(points, outputs_, evaluate_);
    compute(surface_, points, point_by_point_, threads_);
    constexpr std::size_t piece = 1024;
    const std::size_t pieces = (points.size() + piece - 1) / piece;
    texts_.resize(std::max(texts_.size(), pieces));
    parallel_for(
        pieces, threads_,
        [&](std::size_t k) {
          std::string& text = texts_[k];
          text.clear();
          const std::size_t end = std::min((k + 1) * piece, points.size());
          for (std::size_t i = k * piece; i < end; ++i) (this->*format_)(text, i, points[i]);
        },
        [](double) {});
    for (std::size_t k = 0; k < pieces; ++k) file_.write(texts_[k]);
    if (points.size() > 0) first_ = false;
  }

  std::span<const double> values(const EvalAttribute& a, std::size_t i) const {
    return std::span(values_[place_of(a)]).subspan(a.components * i, a.components);
  }

  static void append_json(std::string& text, std::span<const double> values) {
    const char* separator = "[";
    for (const double x : values) {
      text += separator;
      text += number(x).dump();
      separator = ",";
    }
    text += ']';
  }
  void append_sample(std::string& text, std::size_t i, const Vec2<double>& at) const {
    text += first_ && i == 0 ? "\n  " : ",\n  ";
    text.append("{\"u\":").append(number(at.x).dump()).append(",\"v\":").append(number(at.y).dump());
    const char* separator = ",\"status\":[\"";
    for_each_status(status_[i], [&](std::string_view name) {
      text += separator;
      text += name;
      separator = "\",\"";
    });
    text += "\"]";
    for (const EvalAttribute* a : chosen_) {
      text.append(",\"").append(a->name).append("\":");
      const std::span<const double> x = values(*a, i);
      if (a->row > 0) {
        for (std::size_t k = 0; k < x.size(); k += a->row) {
          text += k == 0 ? '[' : ',';
          append_json(text, x.subspan(k, a->row));
        }
        text += ']';
      } else if (x.size() == 1) {
        text += number(x[0]).dump();
      } else {
        append_json(text, x);
      }
    }
    text += '}';
  }

  void append_csv(std::string& text, std::size_t i, const Vec2<double>& at) const {
    append_shortest(text, at.x);
    text += ',';
    append_shortest(text, at.y);
    for (const EvalAttribute* a : chosen_)
      for (const double x : values(*a, i)) {
        text += ',';
        append_shortest(text, x);
      }
    text += ',';
    append_joined_status(text, status_[i]);
    text += '\n';
  }

  void append_table(std::string& text, std::size_t i, const Vec2<double>& at) const {
    text.append("u = ").append(shortest(at.x)).append(", v = ").append(shortest(at.y)).append("    ");
    append_joined_status(text, status_[i]);
    text += '\n';
    for (const EvalAttribute* a : chosen_) {
      text.append("    ").append(a->name).append(22 - a->name.size(), ' ');
      for (const double x : values(*a, i)) {
        std::array<char, 32> digits;
        std::snprintf(digits.data(), digits.size(), " %12.8g",
                      std::isnan(x) ? std::numeric_limits<double>::quiet_NaN() : x);
        text += digits.data();
      }
      text += '\n';
    }
  }

  OutputFile& file_;
  const AnySurface& surface_;
  void (TextWriter::*format_)(std::string&, std::size_t, const Vec2<double>&) const;
  bool json_, first_ = true;
  std::vector<const EvalAttribute*> chosen_;
  std::vector<PointByPoint> point_by_point_;
  std::vector<std::vector<double>> values_{eval_attributes().size()};  // by place in eval_attributes()
  std::vector<Status> status_;
  std::vector<std::string> texts_;
  Outputs<double> outputs_;
  EvaluateOptions evaluate_;
  int threads_;
};

}  // namespace

std::unique_ptr<FrameWriter> make_frame_writer(OutputFile& file, const AnySurface& surface,
                                               const FrameWriterOptions& options) {
  if (options.format == FrameFormat::f32)
    return std::make_unique<BinaryWriter<float>>(file, surface, options);
  if (options.format == FrameFormat::f64 || options.format == FrameFormat::npy)
    return std::make_unique<BinaryWriter<double>>(file, surface, options);
  return std::make_unique<TextWriter>(file, surface, options);
}

}  // namespace darboux
