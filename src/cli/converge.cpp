#include <algorithm>
#include <charconv>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include <darboux/converge.h>
#include <darboux/io.h>

#include "base/text.h"
#include "command.h"
#include "converge_study.h"
#include "report/converge_report.h"
#include "report/convergence_picture.h"
#include "report_command.h"

namespace darboux {
namespace {

// As given; what is not given comes from the study file or the preset.
struct ConvergeArguments {
  std::optional<std::vector<std::string>> surfaces, methods, meshes;
  std::optional<std::string> resolutions, v_range;
  std::optional<std::uint64_t> seed;
  ReportArguments report;
  std::string picture;
};

// "torus:major_radius=1,minor_radius=0.4,sphere" or with ';' in between: a piece "name=value" belongs to the
// surface before it.
std::vector<std::string> split_surfaces(const std::string& text) {
  std::vector<std::string> result;
  for (const std::string& part : split(text, ';')) {
    bool first = true;
    for (const std::string& piece : split(part, ',')) {
      const std::size_t equals = piece.find('=');
      if (!first && equals != std::string::npos && equals < piece.find(':'))
        result.back() += ',' + piece;
      else
        result.push_back(piece);
      first = false;
    }
  }
  return result;
}

int parse_resolution(std::string_view text) {
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc{} || end != text.data() + text.size() || n < 2 || n > finest_rows)
    throw ParameterError("--resolutions", expected_got("numbers from 2 to " + std::to_string(finest_rows) +
                                                           ", as 8..256 (doubling) or 8,16,32",
                                                       "'" + std::string(text) + "'"));
  return n;
}

std::vector<int> parse_resolutions(const std::string& text) {
  std::vector<int> result;
  if (const std::size_t dots = text.find(".."); dots != std::string::npos) {
    const int last = parse_resolution(std::string_view(text).substr(dots + 2));
    for (int n = parse_resolution(std::string_view(text).substr(0, dots)); n <= last; n *= 2)
      result.push_back(n);
  } else {
    for (const std::string& piece : split(text, ',')) result.push_back(parse_resolution(piece));
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// What is given wins over the study file, and that over the preset.
ConvergeChoices choose(const ConvergeArguments& arguments) {
  const auto preset = preset_named(arguments.report.preset);
  if (!preset)
    throw ParameterError("--preset", expected_got(preset_names, "'" + arguments.report.preset + "'"));
  ConvergeChoices choices = *preset;
  if (!arguments.report.study.empty()) read_converge_study(arguments.report.study, choices);
  const auto replace = [](std::vector<std::string>& names, const auto& given, auto pieces) {
    if (!given) return;
    names.clear();
    for (const std::string& text : *given)
      for (const std::string& piece : pieces(text)) names.push_back(piece);
  };
  const auto at_commas = [](const std::string& text) { return split(text, ','); };
  replace(choices.surfaces, arguments.surfaces, split_surfaces);
  replace(choices.methods, arguments.methods, at_commas);
  replace(choices.meshes, arguments.meshes, at_commas);
  if (arguments.resolutions) choices.resolutions = parse_resolutions(*arguments.resolutions);
  if (arguments.v_range) {
    const std::vector<std::string> range = split(*arguments.v_range, ',');
    if (range.size() != 2)
      throw ParameterError("--v-range",
                           expected_got("two numbers such as 0.2,0.8", "'" + *arguments.v_range + "'"));
    choices.v_first = parse_finite("--v-range", range[0]);
    choices.v_last = parse_finite("--v-range", range[1]);
  }
  if (arguments.seed) choices.seed = *arguments.seed;
  return choices;
}

ConvergeOptions parse(const ConvergeArguments& arguments) {
  const ConvergeChoices choices = choose(arguments);
  ConvergeOptions options;
  for (const std::string& name : choices.surfaces) options.surfaces.push_back(surface_argument(name));
  for (const std::string& name : choices.methods) options.methods.push_back(&find_frame_method(name));
  if (choices.methods.empty())
    for (const FrameMethod& method : frame_methods()) options.methods.push_back(&method);
  for (const std::string& name : choices.meshes) options.families.push_back(&find_mesh_family(name));
  options.resolutions = choices.resolutions;
  options.v_first = choices.v_first;
  options.v_last = choices.v_last;
  options.seed = choices.seed;
  return options;
}

// The line that runs the same again, every choice spelt out.
std::string command_line(const ConvergeOptions& options, const ConvergeArguments& arguments) {
  const auto list = [](const auto& items, auto text) {
    std::string result;
    for (const auto& item : items) result += (result.empty() ? "" : ",") + std::string(text(item));
    return result;
  };
  const auto name = [](const auto* item) { return item->name; };
  return "darboux converge --surfaces " +
         list(options.surfaces, [](const AnySurface& s) { return s.specification(); }) + " --methods " +
         list(options.methods, name) + " --meshes " + list(options.families, name) + " --resolutions " +
         list(options.resolutions, [](int n) { return std::to_string(n); }) + " --v-range " +
         shortest(options.v_first) + ',' + shortest(options.v_last) + " --seed " +
         std::to_string(options.seed) + command_line_of(arguments.report);
}

// Orders of the tangents: a block for every surface and mesh, a row per method, a column per class.
void print_orders(const std::vector<Study>& studies) {
  std::puts("Order of convergence of the tangents, with its 95 % interval:");
  for (auto begin = studies.begin(); begin != studies.end();) {
    const auto end = std::find_if(begin, studies.end(), [&](const Study& s) {
      return s.surface != begin->surface || s.mesh != begin->mesh;
    });
    std::vector<std::string_view> methods;
    std::map<VertexClass, std::map<std::string_view, const Study*>, std::greater<>> columns;
    for (auto s = begin; s != end; ++s) {
      if (s->quantity != "tangent") continue;
      if (std::find(methods.begin(), methods.end(), s->method) == methods.end()) methods.push_back(s->method);
      columns[s->vertex_class][s->method] = &*s;
    }
    std::printf("\n%s, %s\n  %-18s", begin->surface.c_str(), std::string(begin->mesh).c_str(), "");
    for (const auto& [vertex_class, column] : columns)
      std::printf(" %-20s", std::string(name_in(vertex_class_names, vertex_class)).c_str());
    for (const std::string_view method : methods) {
      std::printf("\n  %-18s", std::string(method).c_str());
      for (const auto& [vertex_class, column] : columns) {
        const auto found = column.find(method);
        char cell[32] = "";
        if (found != column.end() && found->second->verdict == OrderVerdict::at_the_floor)
          std::snprintf(cell, sizeof cell, "at the floor");
        else if (found != column.end())
          std::snprintf(cell, sizeof cell, "%.2f [%.2f, %.2f]%s", found->second->order,
                        found->second->order_low, found->second->order_high,
                        found->second->holds() ? "" : " !");
        std::printf(" %-20s", cell);
      }
    }
    std::puts("");
    begin = end;
  }
  std::puts("");
}

void print_summary(const std::vector<Study>& studies) {
  std::printf("%s\n", verdict_summary(studies).c_str());
  for (const Study& s : studies)
    if (!s.holds())
      std::printf("%s: %s, %s mesh, %s, %s of the %s: order %.2f [%.2f, %.2f], expected %g\n",
                  std::string(name_in(order_verdict_names, s.verdict)).c_str(), s.surface.c_str(),
                  std::string(s.mesh).c_str(), std::string(s.method).c_str(), std::string(s.quantity).c_str(),
                  std::string(name_in(vertex_class_names, s.vertex_class)).c_str(), s.order, s.order_low,
                  s.order_high, s.expected_order);
}

void run_converge(const ConvergeArguments& arguments, Common& common) {
  const ReportArguments& to = arguments.report;
  check(to, common, {{"--picture", arguments.picture}});
  const ConvergeOptions options = parse(arguments);
  // Opened before the work, so that a folder that cannot be written is reported at once.
  std::optional<OutputFile> report, csv, picture;
  if (!to.output.empty()) report.emplace(to.output);
  if (!to.csv.empty()) csv.emplace(to.csv);
  if (!arguments.picture.empty()) picture.emplace(arguments.picture);
  const Provenance origin = provenance(DARBOUX_VERSION, command_line(options, arguments));
  const StudyIdentity identity{"converge", DARBOUX_VERSION, converge_identity(options),
                               provenance_json(origin, common.threads)};
  std::size_t jobs = 0;
  std::vector<Study> studies;
  {
    Progress progress("converge", common);
    studies = run_converge_study(options, identity, to.study_options(common.threads), jobs,
                                 [&](double share) { progress.update(share); });
  }
  if (!to.shard.empty()) return print_shard(to, jobs, common);
  if (report) {
    report->write(converge_page(studies, origin));
    report->commit();
  }
  if (csv) {
    csv->write(studies_csv(studies));
    csv->commit();
  }
  if (picture) {
    picture->write(convergence_picture(options, studies));
    picture->commit();
  }
  const bool holds = std::all_of(studies.begin(), studies.end(), [](const Study& s) { return s.holds(); });
  common.exit_status = holds ? 0 : 1;
  if (common.json)
    return print_json({{"studies", studies_json(studies)},
                       {"seed", options.seed},
                       {"study", identity.study},
                       {"provenance", identity.provenance}});
  // A page or CSV on standard output stands alone there.
  if (is_standard_output(to.output) || is_standard_output(to.csv) || is_standard_output(arguments.picture))
    return;
  if (to.output.empty()) print_orders(studies);
  print_summary(studies);
  if (!to.output.empty()) std::printf("report: %s\n", to.output.c_str());
  if (!to.csv.empty()) std::printf("CSV: %s\n", to.csv.c_str());
  if (!arguments.picture.empty()) std::printf("picture: %s\n", arguments.picture.c_str());
}

}  // namespace

void add_converge(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "converge",
      "Measure how fast mesh frames approach the truth: orders of convergence, error against run time");
  auto arguments = std::make_shared<ConvergeArguments>();
  std::string methods, meshes;
  for (const FrameMethod& method : frame_methods())
    methods += (methods.empty() ? "" : ", ") + std::string(method.name);
  for (const MeshFamily& family : mesh_families())
    meshes += (meshes.empty() ? "" : ", ") + std::string(family.name);
  const auto list = [&](const char* name, std::optional<std::vector<std::string>>& values,
                        const std::string& help) {
    sub.add_option_function<std::vector<std::string>>(
           name, [&values](const std::vector<std::string>& given) { values = given; }, help)
        ->allow_extra_args(false);
  };
  list("--surfaces", arguments->surfaces,
       "SURFACE,SURFACE,... [torus:major_radius=1,minor_radius=0.4,sphere,cylinder]");
  list("--methods", arguments->methods, "some of " + methods + " [all]");
  list("--meshes", arguments->meshes, "some of " + meshes + " [jittered,regular,sheared]");
  sub.add_option("--resolutions", arguments->resolutions,
                 "rows of the meshes, twice as many columns: 8..256 (doubling) or 8,16,32; at least three "
                 "[8..128]");
  sub.add_option("--v-range", arguments->v_range,
                 "the part of the surface that is meshed: FIRST,LAST in [0, 1] [0,1]");
  sub.add_option("--seed", arguments->seed, "of random meshes [1]")->check(whole_number);
  add_report_options(sub, arguments->report,
                     "quick (the defaults), standard (6 surfaces, all meshes, 16..512), full (8..1024)");
  sub.add_option("-o,--output", arguments->report.output, "write an HTML report to this file");
  sub.add_option("--csv", arguments->report.csv, "write all levels of all studies to this file");
  sub.add_option(
      "--picture", arguments->picture,
      "write the first surface's mesh, coloured by the first method's tangent error, beside the convergence "
      "of all methods to this file, SVG");
  add_common(sub, common, "darboux converge --surfaces torus,sphere --resolutions 8..64 -o report.html");
  sub.callback([arguments, &common] { run_converge(*arguments, common); });
}

}  // namespace darboux
