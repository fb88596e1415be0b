#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include <darboux/io.h>

#include "base/text.h"
#include "command.h"
#include "report/surface_pages.h"

namespace darboux {
namespace {

// The facts by their names in JSON, which are older than those of the members: second_formula is
// position_again there.
std::vector<std::string_view> fact_names(const AnySurface& surface) {
  std::vector<std::string_view> names = surface.facts();
  std::replace(names.begin(), names.end(), std::string_view("second_formula"),
               std::string_view("position_again"));
  return names;
}

bool periodic(Coordinate kind) {
  return kind == Coordinate::turn || kind == Coordinate::twisted_turn;
}

// \param names empty: the whole catalogue
void list_surfaces(const std::vector<std::string>& names, const Common& common) {
  std::vector<AnySurface> surfaces;
  for (const std::string& name : names) surfaces.push_back(make_surface(SurfaceSpecification{name, {}}));
  if (names.empty()) surfaces = all_surfaces();
  Json all = Json::array();
  for (const AnySurface& surface : surfaces) {
    const SurfaceInfo& info = surface.info();
    Json parameters = Json::array(), singular = Json::array();
    for (const ParameterValue& p : surface.parameters())
      parameters.push_back({{"name", p.name},
                            {"default", number(p.default_value)},
                            {"minimum", number(p.permitted.minimum)},
                            {"maximum", number(p.permitted.maximum)},
                            {"minimum_included", p.permitted.minimum_included},
                            {"meaning", p.meaning}});
    for (const std::string_view set : info.singular)
      if (!set.empty()) singular.push_back(set);
    all.push_back({{"name", info.name},
                   {"summary", info.summary},
                   {"parameters", parameters},
                   {"periodic_u", periodic(info.u)},
                   {"periodic_v", periodic(info.v)},
                   {"orientable", info.orientable},
                   {"singular", singular},
                   {"facts", fact_names(surface)}});
  }
  if (common.json) return print_json({{"surfaces", all}});
  for (const AnySurface& surface : surfaces) {
    const SurfaceInfo& info = surface.info();
    std::cout << info.name << ": " << info.summary << '\n';
    for (const ParameterValue& p : surface.parameters())
      std::cout << "    " << p.name << " = " << shortest(p.default_value) << "    " << p.meaning << "; "
                << describe(p.permitted, p.name) << '\n';
    for (const std::string_view set : info.singular)
      if (!set.empty()) std::cout << "    singular at " << set << '\n';
  }
}

void write_pages(const std::string& folder, const Common& common) {
  const std::vector<PageFile> files = surface_pages();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError(folder, expected_got("a folder that can be written to", error.message()));
  Json names = Json::array();
  for (const PageFile& file : files) {
    const std::string path = (std::filesystem::path(folder) / file.name).string();
    write_file(path, file.content);
    names.push_back(path);
  }
  if (common.json) return print_json({{"files", names}});
  if (!common.quiet) std::cout << files.size() << " files written to " << one_line(folder) << '\n';
}

}  // namespace

void add_surfaces(CLI::App& app, Common& common) {
  CLI::App& sub =
      *app.add_subcommand("surfaces", "List the surfaces: names, parameters, defaults, singular points");
  add_common(sub, common, "darboux surfaces torus --json");
  auto names = std::make_shared<std::vector<std::string>>();
  sub.add_option("NAME", *names, "only these surfaces");
  auto pages = std::make_shared<std::string>();
  sub.add_option(
      "--pages", *pages,
      "write a page and a picture of each surface to this folder instead, each file whole or not at all");
  sub.callback([names, pages, &common] {
    if (!pages->empty() && !names->empty())
      throw ParameterError("--pages", expected_got("no names of surfaces beside it", names->front()));
    pages->empty() ? list_surfaces(*names, common) : write_pages(*pages, common);
  });
}

}  // namespace darboux
