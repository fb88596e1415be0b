#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include <darboux/forms.h>
#include <darboux/io.h>

#include "command.h"

namespace darboux {
namespace {

// A sample with everything that may be asked of it.
struct Evaluated {
  Sample<double> sample;
  Curvature<double> curvature;
  Status status;
};

struct Attribute {
  std::string_view name;
  std::vector<std::string_view> columns;  // what follows the name in a CSV header, "" for a scalar
  std::function<void(const Evaluated&, std::vector<double>&)> values;
};

void append(std::vector<double>& out, const Vec3<double>& a) {
  out.insert(out.end(), {a.x, a.y, a.z});
}

const std::vector<Attribute>& attributes() {
  using Out = std::vector<double>;
  static const auto partial = [](std::string_view name, Vec3<double> Jet2<double>::*member) {
    return Attribute{
        name, {"_x", "_y", "_z"}, [member](const Evaluated& e, Out& o) { append(o, e.sample.jet.*member); }};
  };
  static const auto vector = [](std::string_view name, Vec3<double> Frame<double>::*member) {
    return Attribute{name, {"_x", "_y", "_z"}, [member](const Evaluated& e, Out& o) {
                       append(o, e.sample.frame.*member);
                     }};
  };
  static const std::vector<Attribute> list{
      partial("position", &Jet2<double>::position),
      partial("dpdu", &Jet2<double>::dpdu),
      partial("dpdv", &Jet2<double>::dpdv),
      partial("d2pdu2", &Jet2<double>::d2pdu2),
      partial("d2pduv", &Jet2<double>::d2pduv),
      partial("d2pdv2", &Jet2<double>::d2pdv2),
      vector("tangent", &Frame<double>::t),
      vector("bitangent", &Frame<double>::b),
      vector("normal", &Frame<double>::n),
      {"handedness", {""}, [](const Evaluated& e, Out& o) { o.push_back(e.sample.frame.handedness); }},
      {"tangent4",
       {"_x", "_y", "_z", "_w"},
       [](const Evaluated& e, Out& o) {
         const Vec4<double> t = tangent4(e.sample.frame);
         o.insert(o.end(), {t.x, t.y, t.z, t.w});
       }},
      {"gaussian_curvature", {""}, [](const Evaluated& e, Out& o) { o.push_back(e.curvature.gaussian); }},
      {"mean_curvature", {""}, [](const Evaluated& e, Out& o) { o.push_back(e.curvature.mean); }},
      {"principal_curvatures",
       {"_1", "_2"},
       [](const Evaluated& e, Out& o) {
         o.insert(o.end(), {e.curvature.principal[0], e.curvature.principal[1]});
       }},
      {"principal_directions",
       {"_1_x", "_1_y", "_1_z", "_2_x", "_2_y", "_2_z"},
       [](const Evaluated& e, Out& o) {
         append(o, e.curvature.directions[0]);
         append(o, e.curvature.directions[1]);
       }},
  };
  return list;
}

struct Arguments {
  std::string surface;
  std::vector<std::string> at;
  std::string grid, input, attributes, format = "table", output;
};

std::vector<std::string> status_list(Status status) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < status_names.size(); ++k)
    if (has(status, static_cast<Status>(1u << k))) names.emplace_back(status_names[k]);
  if (names.empty()) names.emplace_back("regular");
  return names;
}

// Writes samples one after the other, so that nothing grows with their number.
class Writer {
 public:
  Writer(OutputFile& file, const std::string& format, const AnySurface& surface,
         std::vector<const Attribute*> chosen)
      : file_(file), format_(format), surface_(surface), chosen_(std::move(chosen)) {
    if (format_ == "json")
      out_ << "{\"surface\": " << surface_json(surface_).dump(-1, ' ', false, Json::error_handler_t::replace)
           << ",\n \"samples\": [";
    else if (format_ == "csv") {
      out_ << "u,v";
      for (const Attribute* a : chosen_)
        for (const std::string_view column : a->columns) out_ << ',' << a->name << column;
      out_ << ",status\n";
    }
    pass_on();
  }

  void write(double u, double v) {
    const Sample<double> s = surface_.sample(u, v);
    Evaluated e{s, curvature(surface_, u, v, s.jet, s.frame), s.frame.status};
    for (const Attribute* a : chosen_)
      if (a->name == "principal_directions") e.status |= e.curvature.status & Status::umbilic;
    if (format_ == "json")
      write_json(u, v, e);
    else if (format_ == "csv")
      write_csv(u, v, e);
    else
      write_table(u, v, e);
    first_ = false;
    pass_on();
  }

  void finish() {
    if (format_ == "json") out_ << "]}\n";
    pass_on();
  }

 private:
  static std::string joined_status(Status status) {
    std::string text;
    for (const std::string& name : status_list(status)) text += (text.empty() ? "" : "|") + name;
    return text;
  }

  void write_json(double u, double v, const Evaluated& e) {
    Json sample{{"u", number(u)}, {"v", number(v)}, {"status", status_list(e.status)}};
    for (const Attribute* a : chosen_) {
      const std::string name(a->name);
      if (name == "principal_directions") {
        sample[name] = {array(e.curvature.directions[0]), array(e.curvature.directions[1])};
        continue;
      }
      std::vector<double> values;
      a->values(e, values);
      if (a->columns.size() == 1) {
        sample[name] = number(values[0]);
      } else {
        sample[name] = Json::array();
        for (const double x : values) sample[name].push_back(number(x));
      }
    }
    out_ << (first_ ? "\n  " : ",\n  ") << sample.dump();
  }

  void write_csv(double u, double v, const Evaluated& e) {
    std::vector<double> values;
    for (const Attribute* a : chosen_) a->values(e, values);
    out_ << shortest(u) << ',' << shortest(v);
    for (const double x : values) out_ << ',' << shortest(x);
    out_ << ',' << joined_status(e.status) << '\n';
  }

  void write_table(double u, double v, const Evaluated& e) {
    out_ << "u = " << shortest(u) << ", v = " << shortest(v) << "    " << joined_status(e.status) << '\n';
    for (const Attribute* a : chosen_) {
      std::vector<double> values;
      a->values(e, values);
      out_ << "    " << std::string(a->name) << std::string(22 - a->name.size(), ' ');
      for (const double x : values) {
        char text[32];
        std::snprintf(text, sizeof text, " %12.8g", x);
        out_ << text;
      }
      out_ << '\n';
    }
  }

  // Hands on what has been written so far.
  void pass_on() {
    file_.write(out_.view());
    out_.str({});
  }

  OutputFile& file_;
  std::ostringstream out_;
  std::string format_;
  const AnySurface& surface_;
  std::vector<const Attribute*> chosen_;
  bool first_ = true;
};

std::vector<const Attribute*> choose(const std::string& names, const std::string& format) {
  std::vector<const Attribute*> chosen;
  std::vector<std::string> known;
  for (const Attribute& a : attributes()) known.emplace_back(a.name);
  std::vector<std::string> asked = split(names, ',');
  if (names.empty()) {
    asked = known;
    if (format == "table") asked = {"position", "tangent", "bitangent", "normal", "handedness"};
    if (format == "json") std::erase(asked, "tangent4");
  }
  for (const std::string& name : asked) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw ParameterError("--attributes", "unknown attribute '" + name + "', known are " + join(known));
    if (std::any_of(chosen.begin(), chosen.end(), [&](const Attribute* a) { return a->name == name; }))
      throw ParameterError("--attributes", "'" + name + "' is asked for twice, permitted is once");
    chosen.push_back(&attributes()[static_cast<std::size_t>(found - known.begin())]);
  }
  return chosen;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

// A field of a CSV line as a double; NaN and infinities are numbers here, their samples carry a status.
std::optional<double> parse_field(std::string_view field) {
  const std::string_view text = trimmed(field);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Streams (u, v) from a CSV file: its columns u and v where the first line names them, else its first two.
void read_csv(const std::string& path, const std::function<void(double, double)>& use) {
  std::ifstream file;
  if (path != "-") {
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
      throw FileError(path, "is a folder, permitted is a CSV file");
    file.open(path);
    if (!file) throw FileError(path, "cannot be opened, permitted is a readable CSV file of u,v");
  }
  std::istream& in = path == "-" ? std::cin : file;
  std::string line;
  std::size_t u_column = 0, v_column = 1, line_number = 0;
  bool first = true;
  while (std::getline(in, line)) {
    ++line_number;
    if (line_number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // byte order mark
    if (line.empty() || line == "\r" || line[0] == '#') continue;
    const std::vector<std::string> fields = split(line, ',');
    const auto field = [&](std::size_t k) {
      return k < fields.size() ? parse_field(fields[k]) : std::nullopt;
    };
    if (std::exchange(first, false) && !field(0)) {
      const auto column = [&](const std::string& name) {
        for (std::size_t k = 0; k < fields.size(); ++k)
          if (trimmed(fields[k]) == name) return k;
        throw FileError(
            path + ":" + std::to_string(line_number),
            "the header has no column '" + name + "', permitted is a header with u and v or none");
      };
      u_column = column("u");
      v_column = column("v");
      continue;
    }
    const auto u = field(u_column), v = field(v_column);
    if (!u || !v)
      throw FileError(
          path + ":" + std::to_string(line_number),
          "'" + line.substr(0, 60) + "' does not hold two numbers u,v, permitted are lines like 0.25,0.5");
    use(*u, *v);
  }
  if (in.bad()) throw FileError(path, "cannot be read to its end, permitted is a readable CSV file of u,v");
}

void run(Arguments arguments, const Common& common) {
  if (common.json) arguments.format = "json";
  const AnySurface surface = surface_argument(arguments.surface);
  const auto chosen = choose(arguments.attributes, arguments.format);
  std::vector<Vec2<double>> points;
  for (const std::string& text : arguments.at) {
    const auto parts = split(text, ',');
    if (parts.size() != 2)
      throw ParameterError("--at", "'" + text + "' is no point, permitted is U,V such as 0.3,0.7");
    points.push_back({parse_finite("--at", parts[0]), parse_finite("--at", parts[1])});
  }
  const int sources = !points.empty() + !arguments.grid.empty() + !arguments.input.empty();
  if (sources != 1) throw ParameterError("eval", "needs exactly one of --at, --grid, --input");

  OutputFile file(arguments.output.empty() ? "-" : arguments.output);
  Progress progress("eval", common);
  Writer writer(file, arguments.format, surface, chosen);
  for (const auto& [u, v] : points) writer.write(u, v);
  if (!arguments.grid.empty()) {
    const auto [columns, rows] = parse_grid("--grid", arguments.grid);
    for (int j = 0; j <= rows; ++j) {
      for (int i = 0; i <= columns; ++i)
        writer.write(static_cast<double>(i) / columns, static_cast<double>(j) / rows);
      progress.update(static_cast<double>(j) / rows);
    }
  }
  if (!arguments.input.empty()) read_csv(arguments.input, [&](double u, double v) { writer.write(u, v); });
  writer.finish();
  file.commit();
}

}  // namespace

void add_eval(CLI::App& app, Common& common) {
  CLI::App& sub =
      *app.add_subcommand("eval", "Evaluate positions, partials, frames and curvatures at (u, v)");
  auto arguments = std::make_shared<Arguments>();
  sub.add_option("SURFACE", arguments->surface, surface_help)->required();
  sub.add_option("--at", arguments->at, "U,V: a point; may be repeated")
      ->type_size(1)
      ->allow_extra_args(false);
  sub.add_option("--grid", arguments->grid,
                 "NxM segments: u = i/N, v = j/M, ends included, v the outer loop");
  sub.add_option("--input", arguments->input, "CSV file of u,v (- for standard input)");
  std::vector<std::string> names;
  for (const Attribute& a : attributes()) names.emplace_back(a.name);
  sub.add_option("--attributes", arguments->attributes, "comma-separated, of: " + join(names));
  sub.add_option("--format", arguments->format, "table, json or csv")
      ->capture_default_str()
      ->check(CLI::IsMember({"table", "json", "csv"}));
  sub.add_option("-o,--output", arguments->output, "file to write, whole or not at all");
  add_common(sub, common, "darboux eval sphere --grid 4x2 --attributes position,tangent4 --format csv");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
