#include <algorithm>
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

// The options as given; missing ones come from the study file or the preset.
struct ConvergeArguments {
  std::vector<std::string> named;  // surfaces as arguments, in addition to --surfaces
  std::optional<std::vector<std::string>> surfaces, methods, meshes;
  std::optional<std::string> resolutions, v_range;
  std::optional<std::uint64_t> seed;
  std::optional<int> seeds;
  ReportArguments report;
  std::string picture;
};

// Splits "torus:major_radius=1,minor_radius=0.4,sphere", also at ';': a piece "name=value" belongs to the
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

// Options override the study file, which overrides the preset.
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
  if (!arguments.named.empty() && !arguments.surfaces) choices.surfaces.clear();
  choices.surfaces.insert(choices.surfaces.begin(), arguments.named.begin(), arguments.named.end());
  replace(choices.methods, arguments.methods, at_commas);
  replace(choices.meshes, arguments.meshes, at_commas);
  if (arguments.resolutions) choices.resolutions = parse_resolutions(*arguments.resolutions, finest_rows);
  if (arguments.v_range) {
    const std::vector<std::string> range = split(*arguments.v_range, ',');
    if (range.size() != 2)
      throw ParameterError("--v-range",
                           expected_got("two numbers such as 0.2,0.8", "'" + *arguments.v_range + "'"));
    choices.v_first = parse_finite("--v-range", range[0]);
    choices.v_last = parse_finite("--v-range", range[1]);
  }
  if (arguments.seed) choices.seed = *arguments.seed;
  if (arguments.seeds) choices.seeds = *arguments.seeds;
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
  options.seeds = choices.seeds;
  return options;
}

// The command line that repeats this run, with every choice spelt out.
std::string command_line(const ConvergeOptions& options, const ConvergeArguments& arguments) {
  const auto list = [](const auto& items, auto text) {
    std::string result;
    for (const auto& item : items) result += (result.empty() ? "" : ",") + std::string(text(item));
    return result;
  };
  const auto name = [](const auto* item) { return item->name; };
  // Between two semicolons there may be commas.
  std::string surfaces;
  for (const AnySurface& surface : options.surfaces)
    surfaces += (surfaces.empty() ? "" : ";") + surface.specification();
  return "darboux converge --surfaces " + shell_quoted(surfaces) + " --methods " +
         list(options.methods, name) + " --meshes " + list(options.families, name) + " --resolutions " +
         list(options.resolutions, [](int n) { return std::to_string(n); }) + " --v-range " +
         shortest(options.v_first) + ',' + shortest(options.v_last) + " --seed " +
         std::to_string(options.seed) + " --seeds " + std::to_string(options.seeds) +
         command_line_of(arguments.report, {{"--picture", arguments.picture}});
}

// For a terminal: the orders, unless a report has them, and what differs from expectation.
std::string text_of(const std::vector<Study>& studies, bool with_orders,
                    const std::vector<int>& resolutions) {
  std::string text = (with_orders ? orders_text(studies) : std::string()) + verdict_summary(studies) + '\n';
  for (const std::string& line : unexpected(studies)) text += line + '\n';
  const bool slower = std::any_of(studies.begin(), studies.end(),
                                  [](const Study& s) { return s.verdict == OrderVerdict::slower; });
  // From the third finest mesh to one twice as fine as the finest: an order holds on fine meshes.
  if (const int first = resolutions.back() / 4; slower && first >= 2 && 8 * first <= finest_rows)
    text += "hint: finer meshes may show the expected order: --resolutions " + std::to_string(first) + ".." +
            std::to_string(8 * first) + '\n';
  return text;
}

void run_converge(const ConvergeArguments& arguments, Common& common) {
  known_extension("--picture", arguments.picture, {".svg"});
  const ConvergeOptions options = parse(arguments);
  const std::string first = std::to_string(options.seed);
  const bool random = std::any_of(options.families.begin(), options.families.end(),
                                  [](const MeshFamily* family) { return family->is_random(); });
  run_report(
      arguments.report,
      {.command = "converge",
       .command_line = command_line(options, arguments),
       .seed = options.seed,
       .seeds =
           random && options.seeds > 1
               ? first + " to " + std::to_string(options.seed + static_cast<std::uint64_t>(options.seeds) - 1)
               : first,
       .identity = converge_identity(options),
       .other = {"--picture", "picture", arguments.picture},
       .run =
           [&](const auto& identity, const auto& study_options, auto& jobs, const auto& progress) {
             const auto studies = std::make_shared<std::vector<Study>>(
                 run_converge_study(options, identity, study_options, jobs, progress));
             const auto picture = [&options, studies] { return convergence_picture(options, *studies); };
             return Report{
                 .holds =
                     std::all_of(studies->begin(), studies->end(), [](const Study& s) { return s.holds(); }),
                 .results = {{"studies", studies_json(*studies)}},
                 .page = [studies](const Provenance& p) { return converge_page(*studies, p); },
                 .markdown = [studies](const Provenance& p) { return converge_markdown(*studies, p); },
                 .picture = picture,
                 .csv = [studies] { return studies_csv(*studies); },
                 .other = picture,
                 .text = text_of(*studies, arguments.report.output.empty(), options.resolutions),
                 .summary = verdict_summary(*studies)};
           }},
      common);
}

}  // namespace

void add_converge(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "converge", "Measure orders of convergence of mesh frames to the truth, and error against run time");
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
  sub.add_option("SURFACE", arguments->named,
                 std::string(surface_help) + " [torus:major_radius=1,minor_radius=0.4 sphere cylinder]");
  list("--surfaces", arguments->surfaces,
       "surfaces, separated by commas, in addition to positional ones; either replaces the default");
  list("--methods", arguments->methods, "some of " + methods + " [all]");
  list("--meshes", arguments->meshes, "some of " + meshes + " [jittered,regular,sheared]");
  sub.add_option("--resolutions", arguments->resolutions,
                 "rows of the meshes, with twice as many columns (lantern: 2 sqrt(rows)): 8..256 (doubling) "
                 "or 8,16,32; at least three" +
                     default_text(ConvergeChoices{}.resolutions));
  sub.add_option("--v-range", arguments->v_range, "mesh only this range of v: FIRST,LAST in [0, 1] [0,1]");
  sub.add_option("--seed", arguments->seed, "seed of the first random mesh [1]")->check(whole_number);
  sub.add_option("--seeds", arguments->seeds,
                 "random meshes per resolution (one above 256 rows); their spread widens the intervals" +
                     default_text(ConvergeChoices{}.seeds))
      ->check(whole_number_between(1, most_seeds));
  add_report_options(
      sub, arguments->report,
      "quick (the defaults), standard (6 surfaces, 6 families of meshes, 16..512), full (8..1024)");
  add_output_options(sub, arguments->report, "the picture of --picture", "all levels of all studies");
  sub.add_option("--picture", arguments->picture,
                 "write to this SVG file the first surface's mesh, coloured by the tangent error of the "
                 "first method, beside the convergence of all methods");
  add_common(sub, common, "darboux converge torus sphere --resolutions 8..64 -o report.html");
  sub.callback([arguments, &common] { run_converge(*arguments, common); });
}

}  // namespace darboux
