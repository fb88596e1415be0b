#include <algorithm>
#include <charconv>

#include <darboux/any_surface.h>
#include <darboux/catalogue.h>
#include <darboux/error.h>

#include "text.h"

namespace darboux {
namespace {

template <class Range, class Name>
std::string join(const Range& range, Name name) {
  std::string text;
  for (const auto& item : range) text += (text.empty() ? "" : ", ") + std::string(name(item));
  return text.empty() ? "none" : text;
}

const AnySurface& find_surface(const std::string& name) {
  for (const AnySurface& surface : all_surfaces())
    if (surface.info().name == name) return surface;
  throw ParameterError(name.empty() ? "surface" : name,
                       "unknown surface, known are " +
                           join(all_surfaces(), [](const AnySurface& s) { return s.info().name; }));
}

double parse_number(const std::string& subject, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty())
    throw ParameterError(
        subject, "'" + std::string(text) + "' is not a number, permitted are decimal numbers like 0.25");
  return value;
}

}  // namespace

std::string AnySurface::specification(int digits) const {
  std::string text(info().name);
  char separator = ':';
  for (const ParameterValue& p : parameters()) {
    text +=
        separator + std::string(p.name) + "=" + (digits > 0 ? rounded(p.value, digits) : shortest(p.value));
    separator = ',';
  }
  return text;
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
    if (std::none_of(parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == name; }))
      throw ParameterError(result.name, "unknown parameter '" + name + "', known are " +
                                            join(parameters, [](const ParameterValue& p) { return p.name; }));
    if (equals == std::string_view::npos)
      throw ParameterError(result.name, "parameter '" + name + "' has no value, write " + name + "=number");
    if (std::any_of(result.parameters.begin(), result.parameters.end(),
                    [&](const auto& p) { return p.first == name; }))
      throw ParameterError(result.name, "parameter '" + name + "' is given twice, permitted is once");
    result.parameters.emplace_back(name, parse_number(result.name + ": " + name, item.substr(equals + 1)));
    if (comma == std::string_view::npos) return result;
    rest = rest.substr(comma + 1);
  }
}

AnySurface make_surface(const SurfaceSpecification& specification) {
  find_surface(specification.name);  // throws for an unknown one
  std::optional<AnySurface> result;
  Catalogue::for_each([&](auto surface) {
    using X = decltype(surface);
    if (X::info.name != specification.name) return;
    for (const auto& [name, value] : specification.parameters) {
      bool known = false;
      for_each_parameter<X>([&, &name = name, &value = value](const auto& p) {
        if (p.name != name) return;
        p.of(surface) = value;
        known = true;
      });
      if (!known) parse_specification(specification.name + ":" + name + "=0");  // throws with the known ones
    }
    result.emplace(surface);
  });
  return *result;
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
