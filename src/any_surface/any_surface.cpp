#include <algorithm>
#include <charconv>

#include <darboux/any_surface.h>
#include <darboux/catalogue.h>
#include <darboux/error.h>

#include "base/nearest_name.h"
#include "base/text.h"
#if __has_include("kernel_list.h")  // not where this file is compiled without the build
#include "all_compiled_models.h"
#endif

namespace darboux {

namespace {

const AnySurface& find_surface(const std::string& name) {
  for (const AnySurface& surface : all_surfaces())
    if (surface.info().name == name) return surface;
  std::vector<std::string> known;
  for (const AnySurface& surface : all_surfaces()) known.emplace_back(surface.info().name);
  throw ParameterError(
      name.empty() ? "surface" : name,
      "unknown surface" + did_you_mean(name, known) + ", known are " + joined(known) +
          (name == "formula"                     ? "; in C++ io.h has read_formula_surface(), on the command "
                                                   "line it is formula:file=FILE"
           : name.find('.') != std::string::npos ? "; a file with a formula is formula:file=" + name
                                                 : ""));
}

[[noreturn]] void throw_unknown_parameter(const AnySurface& surface, const std::string& name) {
  std::vector<std::string> known;
  for (const ParameterValue& p : surface.parameters()) known.emplace_back(p.name);
  throw ParameterError(std::string(surface.info().name),
                       "unknown parameter '" + name + "'" + did_you_mean(name, known) + ", known are " +
                           (known.empty() ? "none" : joined(known)) +
                           (name == "file" ? "; io.h has read_surface_file()" : ""));
}

bool starts_a_number(std::string_view text) {
  return !text.empty() && std::string_view("0123456789+-.").find(text.front()) != std::string_view::npos;
}

// "torus:1,0.4", or a comma for the decimal point.
[[noreturn]] void throw_unnamed_value(const AnySurface& surface, const std::string& value) {
  std::string known;
  for (const ParameterValue& p : surface.parameters())
    known += (known.empty() ? "" : ", ") + std::string(p.name) + "=NUMBER";
  throw ParameterError(std::string(surface.info().name), expected_got(known.empty() ? "no parameters" : known,
                                                                      "'" + value + "' without a name"));
}

double parse_number(const std::string& subject, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty())
    throw ParameterError(subject,
                         expected_got("a decimal number such as 0.25", "'" + std::string(text) + "'"));
  return value;
}

}  // namespace

std::string AnySurface::specification(int digits) const {
  std::string text(info().name);
  char separator = ':';
  if (!file_.empty()) {
    text += ":file=" + file_;
    separator = ',';
  }
  for (const ParameterValue& p : parameters()) {
    text +=
        separator + std::string(p.name) + "=" + (digits > 0 ? rounded(p.value, digits) : shortest(p.value));
    separator = ',';
  }
  return text;
}

void AnySurface::expect_one_per_parameter(std::size_t values) const {
  const std::size_t count = parameters().size();
  if (values != count)
    throw ParameterError(
        std::string(info().name),
        expected_got("one value per parameter, " + std::to_string(count), std::to_string(values)));
}

AnySurface AnySurface::with(std::span<const double> values) const {
  expect_one_per_parameter(values.size());
  AnySurface changed = held_->with(values);
  changed.file_ = file_;
  return changed;
}

SurfaceSpecification parse_specification(std::string_view text) {
  const std::size_t colon = text.find(':');
  SurfaceSpecification result{std::string(text.substr(0, colon)), {}};
  const AnySurface& surface = find_surface(result.name);
  if (colon == std::string_view::npos) return result;
  std::string_view rest = text.substr(colon + 1);
  while (true) {
    const std::size_t comma = rest.find(',');
    const std::string_view item = rest.substr(0, comma);
    const std::size_t equals = item.find('=');
    const std::string name(item.substr(0, equals));
    const auto parameters = surface.parameters();
    if (equals == std::string_view::npos && starts_a_number(item)) throw_unnamed_value(surface, name);
    if (std::none_of(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == name; }))
      throw_unknown_parameter(surface, name);
    if (equals == std::string_view::npos)
      throw ParameterError(result.name,
                           "parameter '" + name + "': " + expected_got(name + "=number", "no value"));
    if (std::any_of(result.parameters.begin(), result.parameters.end(),
                    [&](const auto& p) { return p.first == name; }))
      throw ParameterError(result.name,
                           "parameter '" + name + "': " + expected_got("one value", "a second one"));
    result.parameters.emplace_back(name, parse_number(result.name + ": " + name, item.substr(equals + 1)));
    if (comma == std::string_view::npos) return result;
    rest = rest.substr(comma + 1);
  }
}

AnySurface make_surface(const SurfaceSpecification& specification) {
  const AnySurface& standard = find_surface(specification.name);
  const std::vector<ParameterValue> parameters = standard.parameters();
  std::vector<double> values;
  for (const ParameterValue& p : parameters) values.push_back(p.value);
  for (const auto& [name, value] : specification.parameters) {
    const auto p = std::find_if(parameters.begin(), parameters.end(),
                                [&name = name](const ParameterValue& q) { return q.name == name; });
    if (p == parameters.end()) throw_unknown_parameter(standard, name);
    values[static_cast<std::size_t>(p - parameters.begin())] = value;
  }
  return standard.with(values);
}

AnySurface make_surface(std::string_view text) {
  return make_surface(parse_specification(text));
}

const std::vector<AnySurface>& all_surfaces() {
  static const std::vector<AnySurface> surfaces = [] {
    std::vector<AnySurface> list;
    Catalogue::for_each([&](const auto& surface) { list.emplace_back(surface); });
    return list;
  }();
  return surfaces;
}

}  // namespace darboux
