// `darboux scene`: evaluates what one camera of a scene needs, and reports what was skipped.
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <unordered_set>

#include <darboux/io.h>
#include <darboux/scene.h>

#include "assets/scene_of_gltf.h"
#include "base/bounds.h"
#include "base/degrees.h"
#include "base/extension.h"
#include "command.h"
#include "io/scene_file.h"
#include "io/scene_tiles.h"
#include "report/scene_picture.h"

namespace darboux {
namespace {

struct SceneArguments {
  std::string file, chord, angle, output, render, render_skipped;
  std::uint64_t camera = 0;
  std::optional<std::uint64_t> path;  // number of cameras
  bool no_skip = false, no_cull = false;
};

struct SkipReason {
  const char* key;
  std::uint64_t SkippedTiles::*count;
  const char* text;
};
constexpr std::array<SkipReason, 6> skip_reasons{
    {{"no_normal_map", &SkippedTiles::no_normal_map,
      "of materials that read none of the requested attributes"},
     {"outside_frustum", &SkippedTiles::outside_frustum, "outside the view of the camera"},
     {"back_facing", &SkippedTiles::back_facing, "facing away from the camera"},
     {"occluded", &SkippedTiles::occluded, "hidden behind others"},
     {"below_error", &SkippedTiles::below_error, "finer than the bounds require: a coarser tile is enough"},
     {"duplicates", &SkippedTiles::duplicates, "computed already for another instance"}}};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Evaluates all patches of a plan. \returns the seconds that this took, excluding those of f(samples)
template <class F>
double evaluate_patches(const Scene& scene, const ScenePlan& plan, Progress& progress, F&& f) {
  TileEvaluator evaluator(scene, plan);
  double seconds = 0;
  for (std::size_t i = 0; i < plan.patches.size(); ++i) {
    const auto start = std::chrono::steady_clock::now();
    const TileSamples& samples = evaluator.evaluate(plan.patches[i]);
    seconds += seconds_since(start);
    f(samples);
    progress.update(static_cast<double>(i + 1) / static_cast<double>(plan.patches.size()));
  }
  return seconds;
}

void set_chord(const std::string& text, SceneRequest& request) {
  constexpr double none = std::numeric_limits<double>::infinity();
  const bool in_pixels = text.ends_with("px");
  const double chord = parse_finite("--chord", std::string_view(text).substr(0, text.size() - 2 * in_pixels));
  if (!(chord > 0))
    throw ParameterError("--chord", expected_got("a length above 0, such as 0.01, or pixels, such as 0.5px",
                                                 "'" + text + "'"));
  request.chord_px = in_pixels ? chord : none;
  request.chord = in_pixels ? none : chord;
}

void set_angle(const std::string& text, SceneRequest& request) {
  const double angle = parse_finite(
      "--angle", std::string_view(text).substr(0, text.size() - (text.ends_with("deg") ? 3 : 0)));
  if (!(angle > 0))
    throw ParameterError("--angle",
                         expected_got("an angle above 0 in degrees, such as 1deg", "'" + text + "'"));
  request.frame_angle_rad = angle * (std::numbers::pi / 180);
}

// From an eye inside or on a closed surface nothing around is visible. \returns what is wrong
std::optional<std::string> refused_eye(const Scene& scene, const Camera& camera) {
  if (camera.projection != Camera::Projection::perspective) return std::nullopt;
  static const std::set<std::string_view> closed{"sphere", "ellipsoid", "torus", "superellipsoid"};
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const SceneInstance& instance = scene.instances[i];
    const AnySurface& surface = scene.surfaces[instance.surface];
    if (!closed.contains(surface.info().name)) continue;
    const Eigen::Vector3d local = instance.placement.inverse() * camera.pose.translation();
    const std::optional<double> side = surface.implicit(from_eigen(local));
    // Below the rounding error of the transformed eye, a distance is zero.
    const double rounding = 0x1p-40 * local.norm();
    const bool inside = side && *side < -rounding;
    if (!side || *side > rounding || (inside && scene.materials[instance.material].double_sided)) continue;
    return expected_got("an eye outside of all closed surfaces",
                        std::string("one ") + (inside ? "inside" : "on") + " instance " + std::to_string(i) +
                            ", a " + std::string(surface.info().name));
  }
  return std::nullopt;
}

// The tiles of a plan: instance, levels, column and row.
using TileKeys = std::set<std::array<std::uint32_t, 5>>;
std::array<std::uint32_t, 5> key_of(const ScenePatch& patch, const PlannedTile& tile) {
  return {tile.instance, patch.level_u, patch.level_v, patch.column, patch.row};
}
TileKeys keys_of(const ScenePlan& plan) {
  TileKeys keys;
  for (const PlannedTile& tile : plan.tiles) keys.insert(key_of(plan.patches[tile.patch], tile));
  return keys;
}

// All tiles at the resolution of the plan, seen from outside, coloured by why they were skipped.
Picture picture_of_fates(const Scene& scene, const Camera& camera, SceneRequest request,
                         const Common& common) {
  request.attributes = Attribute::position | Attribute::normal;
  const ScenePlan needed_plan = plan_scene(scene, camera, request);
  request.skip.occluded = false;
  const ScenePlan facing_plan = plan_scene(scene, camera, request);
  request.skip.back_facing = false;
  const ScenePlan within_plan = plan_scene(scene, camera, request);
  request.skip.outside_frustum = false;
  const ScenePlan all = plan_scene(scene, camera, request);
  const TileKeys needed = keys_of(needed_plan), facing = keys_of(facing_plan), within = keys_of(within_plan);
  const Eigen::Matrix3d axes = axes_beside(camera);
  Bounds box;
  Progress progress("picture of what was skipped", common);
  evaluate_patches(scene, all, progress, [&](const TileSamples& samples) {
    for (const PlannedTile& tile : samples.tiles())
      for (std::size_t i = 0; i < samples.size(); ++i)
        box.add(from_eigen(axes.transpose() * (scene.instances[tile.instance].placement *
                                               to_eigen(samples.vec3(Attribute::position, i)))));
  });
  Rasteriser rasteriser(view_along(axes, box.low, box.high, camera));
  evaluate_patches(scene, all, progress, [&](const TileSamples& samples) {
    draw_tiles(rasteriser, scene, samples, [&](const PlannedTile& tile) {
      const auto key = key_of(samples.patch(), tile);
      return picture_material(needed.contains(key)   ? TileFate::needed
                              : facing.contains(key) ? TileFate::occluded
                              : within.contains(key) ? TileFate::back_facing
                                                     : TileFate::outside_frustum);
    });
  });
  return rasteriser.picture();
}

// One camera of a path: what it needs, and how much of that the previous camera did not have.
struct PathCamera {
  std::uint64_t instances, tiles, samples, samples_new;
  double plan_seconds;
};

// The results of a run, for both kinds of output.
struct SceneReport {
  const SceneArguments& arguments;
  const io::NamedCamera& camera;
  const SceneRequest& request;
  const ScenePlan& plan;
  std::size_t instances;
  std::uint64_t samples_evaluated;
  double plan_seconds, needed_seconds, full_seconds;
  std::vector<PathCamera> path{};  // then all else is their sum
};

Json report_json(const SceneReport& r) {
  Json attributes = Json::object(), skipped = Json::object();
  for (std::size_t a = 0; a < attribute_count; ++a)
    if (r.request.attributes.has(static_cast<Attribute>(a)))
      attributes[std::string(attribute_infos[a].name)] = r.plan.attribute_samples[a];
  for (const SkipReason& reason : skip_reasons) skipped[reason.key] = r.plan.skipped.*reason.count;
  const Camera& camera = r.camera.camera;
  Json result = {
      {"file", utf8(r.arguments.file)},
      {"camera",
       {{"index", r.arguments.camera},
        {"name", utf8(r.camera.name)},
        {"projection", camera.projection == Camera::Projection::perspective ? "perspective" : "orthographic"},
        {"width_px", camera.width_px},
        {"height_px", camera.height_px}}},
      {"instances", r.instances},
      {"needed",
       {{"instances", r.plan.instances_needed},
        {"tiles", r.plan.tiles_needed},
        {"samples", r.plan.samples_needed},
        {"attributes", std::move(attributes)}}},
      {"skipped", std::move(skipped)},
      {"tiles_unbounded", r.plan.tiles_unbounded},
      {"samples_full", r.plan.samples_full},
      {"samples_evaluated", r.samples_evaluated},
      {"seconds",
       {{"full", number(r.full_seconds)},
        {"plan", number(r.plan_seconds)},
        {"needed", number(r.needed_seconds)}}},
      {"bounds",
       {{"chord", number(r.request.chord)},
        {"chord_px", number(r.request.chord_px)},
        {"angle_deg", number(r.request.frame_angle_rad * degrees_per_radian)}}}};
  if (!r.path.empty()) {
    Json& path = result["path"] = Json::array();
    for (const PathCamera& frame : r.path)
      path.push_back({{"instances", frame.instances},
                      {"tiles", frame.tiles},
                      {"samples", frame.samples},
                      {"samples_new", frame.samples_new},
                      {"seconds_plan", number(frame.plan_seconds)}});
  }
  return result;
}

// "  1 000 tiles  12.5 %"
std::string share_line(std::uint64_t part, std::uint64_t all, const std::string& text) {
  std::ostringstream line;
  line.exceptions(std::ios::badbit);  // else output would be lost without memory
  line << "  " << std::setw(12) << part << std::setw(7) << std::fixed << std::setprecision(1)
       << (all > 0 ? 100 * static_cast<double>(part) / static_cast<double>(all) : 0) << " %  " << text
       << '\n';
  return line.str();
}

void print_text(const SceneReport& r) {
  const Camera& camera = r.camera.camera;
  const ScenePlan& plan = r.plan;
  const std::string which = r.path.empty()
                                ? "camera " + std::to_string(r.arguments.camera) +
                                      (r.camera.name.empty() ? "" : " (" + one_line(r.camera.name) + ")")
                                : std::to_string(r.path.size()) + " cameras of a path";
  std::cout << one_line(r.arguments.file) << ", " << which << ", " << camera.width_px << " x "
            << camera.height_px << " pixels: " << plan.instances_needed << " of "
            << r.instances * std::max<std::size_t>(r.path.size(), 1) << " instances"
            << (r.path.empty() ? " are needed\n" : ", each counted for every camera, are needed\n");
  std::cout << "of " << plan.tiles_all << " tiles\n"
            << share_line(plan.tiles_needed, plan.tiles_all, "needed");
  for (const SkipReason& reason : skip_reasons)
    if (const std::uint64_t count = plan.skipped.*reason.count; count > 0)
      std::cout << share_line(count, plan.tiles_all, reason.text);
  if (plan.tiles_unbounded > 0)
    std::cout << plan.tiles_unbounded
              << (std::isnan(r.needed_seconds) ? " of the needed tiles move, so they have no bounds\n"
                                               : " of those needed have no proven bounds: their resolution "
                                                 "is an estimate, or the finest there is\n");
  const bool evaluated = !std::isnan(r.needed_seconds);  // false: existing triangles
  std::cout << "of " << plan.samples_full
            << (evaluated ? " samples, if each instance were one grid as fine as its nearest point requires"
                          : " vertices, counted once per instance")
            << '\n'
            << share_line(plan.samples_needed, plan.samples_full, "needed");
  for (std::size_t a = 0; a < attribute_count; ++a)
    if (r.request.attributes.has(static_cast<Attribute>(a)))
      std::cout << share_line(plan.attribute_samples[a], plan.samples_full,
                              std::string(attribute_infos[a].name));
  if (!r.path.empty() && evaluated)
    std::cout << share_line(r.samples_evaluated, plan.samples_full,
                            "evaluated anew; the others were kept from the camera before");
  std::vector<std::string> bounds;
  if (std::isfinite(r.request.chord_px))
    bounds.push_back(rounded(r.request.chord_px, 6) + (r.request.chord_px == 1 ? " pixel" : " pixels"));
  if (std::isfinite(r.request.chord)) bounds.push_back("a length of " + rounded(r.request.chord, 6));
  const double degrees = r.request.frame_angle_rad * degrees_per_radian;
  if (degrees < 180)  // beyond, every frame is within
    bounds.push_back("frames within " + rounded(degrees, 6) + (degrees == 1 ? " degree" : " degrees"));
  if (!bounds.empty()) std::cout << "bounds: " << joined(bounds) << '\n';
  std::cout << "seconds: " << rounded(r.plan_seconds, 2) << " to plan"
            << (r.path.empty() ? "" : ", the first camera " + rounded(r.path.front().plan_seconds, 2))
            << (evaluated ? ", " + rounded(r.needed_seconds, 2) + " to evaluate what is needed" : "")
            << (std::isnan(r.full_seconds) ? "" : ", " + rounded(r.full_seconds, 2) + " to evaluate all")
            << '\n';
}

// Checks that the output files differ from each other and from the scene, and have known extensions.
void check_outputs(const SceneArguments& arguments, const Common& common) {
  if (!arguments.output.empty()) check_glb_name(arguments.output);
  std::set<std::string> seen;
  if (common.json) seen.insert("-");
  for (const std::string& name : {arguments.output, arguments.render, arguments.render_skipped}) {
    if (name.empty()) continue;
    std::error_code none;
    if (std::filesystem::equivalent(name, arguments.file, none))
      throw ParameterError(name, expected_got("the name of another file", "that of the scene"));
    if (!seen.insert(is_standard_output(name) ? "-" : std::filesystem::weakly_canonical(name, none).string())
             .second)
      throw ParameterError(name, expected_got("a file, or standard output, for one thing", "for two"));
  }
  known_extension("--render", arguments.render, {".png"});
  known_extension("--render-skipped", arguments.render_skipped, {".png"});
}

const io::NamedCamera& chosen_camera(const SceneArguments& arguments,
                                     const std::vector<io::NamedCamera>& cameras) {
  if (arguments.camera >= cameras.size())
    throw ParameterError("--camera",
                         expected_got("one of the " + std::to_string(cameras.size()) + " cameras, from 0",
                                      std::to_string(arguments.camera)));
  return cameras[arguments.camera];
}

void print_report(const SceneReport& report, const Common& common) {
  if (common.json)
    print_json(report_json(report));
  else if (!common.quiet)
    print_text(report);
}

void add_to(ScenePlan& sum, const ScenePlan& plan) {
  for (std::uint64_t ScenePlan::*count :
       {&ScenePlan::instances_needed, &ScenePlan::tiles_all, &ScenePlan::tiles_needed,
        &ScenePlan::tiles_unbounded, &ScenePlan::samples_full, &ScenePlan::samples_needed})
    sum.*count += plan.*count;
  for (const SkipReason& reason : skip_reasons) sum.skipped.*reason.count += plan.skipped.*reason.count;
  for (std::size_t a = 0; a < attribute_count; ++a) sum.attribute_samples[a] += plan.attribute_samples[a];
}

// The camera at a share of the way through all of a file.
Camera camera_at(const std::vector<io::NamedCamera>& cameras, double share) {
  const double at = share * static_cast<double>(cameras.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), cameras.size() - 2);
  return between(cameras[i].camera, cameras[i + 1].camera, at - static_cast<double>(i));
}

// Cameras along a path: decisions are kept from one to the next, and samples too.
// \param arguments whose camera is that of the motion, if there is one
void run_path(const SceneArguments& arguments, const Scene& scene,
              const std::vector<io::NamedCamera>& cameras, const std::optional<CameraMotion>& motion,
              std::size_t instances, const SceneRequest& request, const Common& common) {
  if (!motion && cameras.size() < 2)
    throw ParameterError(
        "--path",
        expected_got("a scene of at least two cameras, or a glTF with one that an animation moves", "one"));
  const std::uint64_t frames = *arguments.path;
  if (frames < 2) throw ParameterError("--path", expected_got("at least 2 cameras", std::to_string(frames)));
  ScenePlan sum;
  SceneReport report{arguments,
                     cameras[arguments.camera],
                     request,
                     sum,
                     instances,
                     0,
                     0,
                     0,
                     std::numeric_limits<double>::quiet_NaN()};
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (scene.surfaces.empty()) report.needed_seconds = none;  // nothing is evaluated
  ScenePlanner planner(scene, request);
  std::unordered_set<std::uint64_t> had, has;
  Progress progress("scene", common);
  for (std::uint64_t i = 0; i < frames; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(frames - 1);
    const Camera camera = motion ? motion->at(share) : camera_at(cameras, share);
    const auto refuse = [&](const std::string& why) {
      throw FileError(arguments.file, "camera " + std::to_string(i) + " of the path: " + why);
    };
    try {
      camera.check();
    } catch (const ParameterError& error) {
      refuse(error.what());
    }
    if (const auto wrong = refused_eye(scene, camera)) refuse(*wrong);
    const auto start = std::chrono::steady_clock::now();
    const ScenePlan plan = planner.plan(camera);
    PathCamera frame{plan.instances_needed, plan.tiles_needed, plan.samples_needed, 0, seconds_since(start)};
    TileEvaluator evaluator(scene, plan);
    const auto evaluation = std::chrono::steady_clock::now();
    has.clear();
    for (const ScenePatch& patch : plan.patches) {
      has.insert(patch.id);
      if (!had.contains(patch.id)) frame.samples_new += evaluator.evaluate(patch).size();
    }
    std::swap(has, had);
    if (!scene.surfaces.empty()) report.needed_seconds += seconds_since(evaluation);
    report.plan_seconds += frame.plan_seconds;
    report.samples_evaluated += frame.samples_new;
    report.path.push_back(frame);
    add_to(sum, plan);
    progress.update(static_cast<double>(i + 1) / static_cast<double>(frames));
  }
  print_report(report, common);
}

// The triangles of a glTF: planned by whole primitives, without evaluation.
void run_gltf(const SceneArguments& arguments, const Common& common) {
  const std::pair<const char*, bool> of_surfaces[] = {{"--chord", !arguments.chord.empty()},
                                                      {"--angle", !arguments.angle.empty()},
                                                      {"--output", !arguments.output.empty()},
                                                      {"--render", !arguments.render.empty()},
                                                      {"--render-skipped", !arguments.render_skipped.empty()},
                                                      {"--no-skip", arguments.no_skip},
                                                      {"--no-cull", arguments.no_cull}};
  for (const auto& [option, given] : of_surfaces)
    if (given)
      throw ParameterError(option, expected_got("a scene of surfaces in JSON", "triangles of a glTF"));
  const GltfScene scene = scene_of_gltf(arguments.file, common.read, arguments.path.has_value());
  const io::NamedCamera& camera = chosen_camera(arguments, scene.cameras);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  SceneRequest request;
  request.chord_px = request.frame_angle_rad = infinity;
  if (arguments.path) {
    SceneArguments of_path = arguments;
    of_path.camera = scene.moving_camera;
    return run_path(of_path, scene.scene, scene.cameras, scene.motion, scene.primitive_instances, request,
                    common);
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const auto start = std::chrono::steady_clock::now();
  const ScenePlan plan = plan_scene(scene.scene, camera.camera, request);
  print_report(
      {arguments, camera, request, plan, scene.primitive_instances, 0, seconds_since(start), none, none},
      common);
}

void run_surfaces(const SceneArguments& arguments, const Common& common) {
  check_outputs(arguments, common);
  const io::SceneFile file = io::read_scene_file(arguments.file, surface_argument);
  const io::NamedCamera& camera = chosen_camera(arguments, file.cameras);
  const Scene& scene = file.scene;
  SceneRequest request = file.request;
  if (!arguments.chord.empty()) set_chord(arguments.chord, request);
  if (!arguments.angle.empty()) set_angle(arguments.angle, request);
  request.skip.occluded = true;
  if (arguments.path)
    return run_path(arguments, scene, file.cameras, std::nullopt, scene.instances.size(), request, common);
  if (!arguments.output.empty()) request.attributes |= Attribute::position;
  if (!arguments.render.empty())
    request.attributes |= Attribute::position | Attribute::normal | Attribute::tangent4;
  if (const auto wrong = refused_eye(scene, camera.camera))
    throw FileError(arguments.file, "/cameras/" + std::to_string(arguments.camera) + "/eye: " + *wrong);

  // An output that cannot be written is refused before the work.
  const auto opened = [](const std::string& name) {
    return name.empty() ? nullptr : std::make_unique<OutputFile>(name);
  };
  const auto glb = opened(arguments.output), png = opened(arguments.render),
             png_of_skipped = opened(arguments.render_skipped);
  std::optional<Rasteriser> rasteriser;
  if (png) rasteriser.emplace(camera.camera);
  std::optional<io::SceneTiles> tiles;
  if (glb) tiles.emplace(arguments.output, scene, file.surface_names);
  const auto write = [&](const TileSamples& samples) {
    if (tiles) tiles->add(samples);
    if (rasteriser)
      draw_tiles(*rasteriser, scene, samples,
                 [&](const PlannedTile& tile) { return picture_material(scene, tile); });
  };

  const auto start = std::chrono::steady_clock::now();
  const ScenePlan plan = plan_scene(scene, camera.camera, request);
  SceneReport report{arguments,
                     camera,
                     request,
                     plan,
                     scene.instances.size(),
                     plan.samples_needed,
                     seconds_since(start),
                     0,
                     std::numeric_limits<double>::quiet_NaN()};
  const bool other = arguments.no_skip || arguments.no_cull;
  {
    Progress progress("scene", common);
    report.needed_seconds = evaluate_patches(scene, plan, progress, [&](const TileSamples& samples) {
      if (!other) write(samples);
    });
  }
  if (other) {
    SceneRequest all = request;
    all.skip.outside_frustum = all.skip.back_facing = all.skip.occluded = false;
    if (arguments.no_skip) all.skip = SceneRequest::Skip::nothing();
    Progress progress("scene, with what is skipped", common);
    report.samples_evaluated = 0;
    report.full_seconds = evaluate_patches(scene, plan_scene(scene, camera.camera, all), progress,
                                           [&](const TileSamples& samples) {
                                             report.samples_evaluated += samples.size();
                                             write(samples);
                                           });
  }
  if (glb) glb->write(tiles->to_glb());
  if (png) png->write(png_of(rasteriser->picture()));
  if (png_of_skipped) png_of_skipped->write(png_of(picture_of_fates(scene, camera.camera, request, common)));
  for (OutputFile* output : {glb.get(), png.get(), png_of_skipped.get()})
    if (output) output->commit();
  const bool to_stdout = is_standard_output(arguments.output) || is_standard_output(arguments.render) ||
                         is_standard_output(arguments.render_skipped);
  if (!to_stdout) print_report(report, common);
}

void run(const SceneArguments& arguments, Common& common) {
  // Other mesh formats too: run_gltf() refuses them with a remedy.
  const std::string extension = extension_of(arguments.file);
  const auto meshes = asset_extensions();
  if (std::find(meshes.begin(), meshes.end(), extension) != meshes.end())
    run_gltf(arguments, common);
  else
    run_surfaces(arguments, common);
}

}  // namespace

void add_scene(CLI::App& app, Common& common) {
  CLI::App& sub = *app.add_subcommand(
      "scene", "Plan and evaluate only what a camera sees of a scene; report what was skipped");
  auto arguments = std::make_shared<SceneArguments>();
  sub.add_option("FILE", arguments->file,
                 "a scene as JSON (docs/schemas/scene.schema.json), or a .glb or .gltf, whose primitives are "
                 "planned as a whole")
      ->required();
  // Excluded below by pointers: CLI11 finds names by functions that allocate and must not throw.
  CLI::Option* camera =
      sub.add_option("--camera", arguments->camera, "number of the camera to plan for, from 0")
          ->capture_default_str()
          ->check(whole_number);
  sub.add_option("--chord", arguments->chord,
                 "largest distance of the triangles from the surface: pixels (0.5px) or a length (0.01); "
                 "overrides the file");
  sub.add_option("--angle", arguments->angle,
                 "largest angle between interpolated frames and the surface's (1deg); overrides the file");
  CLI::Option* output = sub.add_option("-o,--output", arguments->output,
                                       "write the needed tiles as a .glb; - for standard output");
  CLI::Option* render = sub.add_option("--render", arguments->render, "draw what the camera sees as a .png");
  CLI::Option* render_skipped =
      sub.add_option("--render-skipped", arguments->render_skipped,
                     "draw the scene from outside as a .png: needed tiles green, back-facing orange, hidden "
                     "blue, out of view grey");
  CLI::Option* no_skip = sub.add_flag(
      "--no-skip", arguments->no_skip,
      "also evaluate every instance in full, with all attributes, as fine as its nearest point requires; "
      "-o and --render use that");
  CLI::Option* no_cull =
      sub.add_flag(
             "--no-cull", arguments->no_cull,
             "also evaluate what is out of view, back-facing or hidden, as fine as its distance needs; the "
             "picture stays the same, bit for bit")
          ->excludes(no_skip);
  CLI::Option* path = sub.add_option("--path", arguments->path,
                                     "plan for this many cameras along the path of the first camera that a "
                                     "glTF animates, or else through all cameras of the file; what did not "
                                     "change is kept from one camera to the next, and the counts are sums")
                          ->check(whole_number_up_to(1000000));
  for (CLI::Option* other : {camera, output, render, render_skipped, no_skip, no_cull}) path->excludes(other);
  add_read_options(sub, common);
  add_common(sub, common, "darboux scene scene.json --render scene.png");
  sub.callback([arguments, &common] { run(*arguments, common); });
}

}  // namespace darboux
