// What planning a scene costs and saves, as the tables of docs/reports/scene.md, for scene.sh:
//   benchmark_scene [--quick]
// Seconds of one thread, medians of rounds in turns.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

#include <darboux/blocks.h>
#include <darboux/error.h>
#include <darboux/scene.h>

#include "io/scene_file.h"
#include "scene_contest.h"
#include "scene_timing.h"

namespace darboux::bench {
namespace {

double seconds(const std::function<void()>& f) {
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  const double start = now();
  f();
  return now() - start;
}

}  // namespace

std::vector<double> medians(int rounds, const std::vector<std::function<void()>>& things) {
  std::vector<std::vector<double>> times(things.size());
  for (int i = 0; i < rounds; ++i)
    for (std::size_t k = 0; k < things.size(); ++k) times[k].push_back(seconds(things[k]));
  std::vector<double> result;
  for (std::vector<double>& t : times) {
    std::nth_element(t.begin(), t.begin() + t.size() / 2, t.end());
    result.push_back(t[t.size() / 2]);
  }
  return result;
}

void evaluate(const Scene& scene, const ScenePlan& plan) {
  for_each_tile(scene, plan, [](const TileSamples&) {});
}

Scene scattered(std::size_t count) {
  Scene scene;
  for (const char* name : {"sphere", "torus:major_radius=0.7,minor_radius=0.25", "cylinder", "cone"})
    scene.surfaces.push_back(make_surface(name));
  scene.materials = {{}, {.name = "bumpy", .normal_map = true}, {}};
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(std::log(2), std::log(200));
  for (std::size_t i = 0; i < count; ++i) {
    SceneInstance instance{static_cast<std::uint32_t>(i % 4), static_cast<std::uint32_t>(i % 3), {}};
    const auto direction = [&] {
      return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
    };
    instance.placement = Eigen::AngleAxisd(normal(random), direction());
    instance.placement.pretranslate(std::exp(uniform(random)) * direction());
    scene.instances.push_back(instance);
  }
  return scene;
}

namespace {

// Every instance uniformly, through the kernels' own grids: nothing that tiles cost.
void evaluate_uniformly(const Scene& scene, const ScenePlan& uniform, Attributes asked) {
  std::vector<double> memory;
  for (std::size_t i = 0; i < uniform.patches.size();) {
    // The tiles of an instance, as one grid.
    const ScenePatch& first = uniform.patches[i];
    const std::size_t columns = std::size_t{first.cells_u} << first.level_u,
                      rows = std::size_t{first.cells_v} << first.level_v;
    i += std::size_t{1} << (first.level_u + first.level_v);
    const AnySurface& surface = scene.surfaces[first.surface];
    for_each_block(surface, Points<double>::grid(columns, rows), asked, [](const Block<double>&) {});
  }
}

// A camera that goes on a hundredth of a radius and turns by a milliradian, about a pixel, at a time.
class Walk {
 public:
  Walk(const Scene& scene, const Camera& camera, const SceneRequest& request)
      : planner_(scene, request), camera_(camera) {
    planner_.plan(camera_);
  }
  void step() {
    camera_.pose.translate(Eigen::Vector3d(1e-2, 0, 0));
    camera_.pose.rotate(Eigen::AngleAxisd(1e-3, Eigen::Vector3d::UnitY()));
    planner_.plan(camera_);
  }

 private:
  ScenePlanner planner_;
  Camera camera_;
};

void asteroids(int rounds) {
  const io::SceneFile file = io::read_scene_file("docs/examples/asteroids.json");
  const Camera& camera = file.cameras[0].camera;
  SceneRequest everything = file.request;
  everything.skip = SceneRequest::Skip::nothing();
  const ScenePlan uniform = plan_scene(file.scene, camera, everything);
  ScenePlan plan;
  Walk walk(file.scene, camera, file.request);
  const std::vector<double> s =
      medians(rounds, {[&] { evaluate_uniformly(file.scene, uniform, file.request.attributes); },
                       [&] { plan = plan_scene(file.scene, camera, file.request); },
                       [&] { evaluate(file.scene, plan); }, [&] { walk.step(); }});
  std::printf(
      "\n### 1000 instances, docs/examples/asteroids.json\n\n"
      "| | samples | ms |\n|---|---:|---:|\n"
      "| every instance uniformly, at the resolution of its nearest point | %llu | %.2f |\n"
      "| planning | | %.2f |\n"
      "| planning for the next camera of a path | | %.2f |\n"
      "| what is needed | %llu | %.2f |\n"
      "| times fewer, times less with planning | %.1f | %.1f |\n"
      "| the same on a path | | %.1f |\n",
      static_cast<unsigned long long>(plan.samples_full), 1e3 * s[0], 1e3 * s[1], 1e3 * s[3],
      static_cast<unsigned long long>(plan.samples_needed), 1e3 * s[2],
      double(plan.samples_full) / double(plan.samples_needed), s[0] / (s[1] + s[2]), s[0] / (s[3] + s[2]));
  std::printf(
      "\nOf %llu tiles %llu are needed. Skipped: %llu outside the frustum, %llu back-facing, %llu below the "
      "error, %llu duplicates.\n",
      static_cast<unsigned long long>(plan.tiles_all), static_cast<unsigned long long>(plan.tiles_needed),
      static_cast<unsigned long long>(plan.skipped.outside_frustum),
      static_cast<unsigned long long>(plan.skipped.back_facing),
      static_cast<unsigned long long>(plan.skipped.below_error),
      static_cast<unsigned long long>(plan.skipped.duplicates));
}

// Instances in a cone about the camera's axis.
Scene in_view(Scene scene) {
  for (SceneInstance& instance : scene.instances) {
    const Eigen::Vector3d at = instance.placement.translation();
    const double distance = at.norm();
    instance.placement.translation() =
        distance * Eigen::Vector3d(0.35 * at.x() / distance, 0.35 * at.y() / distance, -1).normalized();
  }
  return scene;
}

void growth(int rounds, bool quick) {
  std::printf(
      "\n### Planning alone\n\n60 degrees, 1 px, no bound on the angle; instances 2 to 200 radii from the "
      "eye, all round it or all in view. The next camera is a hundredth of a radius and a milliradian "
      "further.\n\n"
      "| instances | all round, ms | µs each | the next camera, ms | all in view, ms | µs each | the next "
      "camera, "
      "ms |\n|---:|---:|---:|---:|---:|---:|---:|\n");
  SceneRequest request;
  request.chord_px = 1;
  request.frame_angle_rad = std::numbers::pi;
  Camera camera;
  camera.vertical_field_of_view_rad = std::numbers::pi / 3;
  for (const std::size_t n :
       {std::size_t{1000}, std::size_t{10000}, std::size_t{100000}, std::size_t{1000000}}) {
    if (quick && n > 100000) break;
    const Scene round = scattered(n);
    const Scene before = in_view(round);
    Walk round_walk(round, camera, request), walk(before, camera, request);
    const std::vector<double> s = medians(
        n > 100000 ? 1 : rounds, {[&] { plan_scene(round, camera, request); }, [&] { round_walk.step(); },
                                  [&] { plan_scene(before, camera, request); }, [&] { walk.step(); }});
    std::printf("| %zu | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", n, 1e3 * s[0], 1e6 * s[0] / double(n),
                1e3 * s[1], 1e3 * s[2], 1e6 * s[2] / double(n), 1e3 * s[3]);
  }
}

// What skip.occluded costs and saves.
void hidden(int rounds) {
  std::printf(
      "\n### Hidden behind others\n\nWithout `skip.occluded`, and with it: the file's scene, and those of "
      "the "
      "table above. Tiles that are drawn; samples, of which instances of a surface share many.\n\n"
      "| | tiles | hidden | samples, thousands | | planning, ms | | the next camera, ms | | evaluation, ms | "
      "|\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  const io::SceneFile file = io::read_scene_file("docs/examples/asteroids.json");
  Camera camera;
  camera.vertical_field_of_view_rad = std::numbers::pi / 3;
  struct Case {
    const char* name;
    Scene scene;
    Camera camera;
  };
  for (const Case& c : {Case{"asteroids.json", file.scene, file.cameras[0].camera},
                        Case{"10000 all round", scattered(10000), camera},
                        Case{"10000 in view", in_view(scattered(10000)), camera},
                        Case{"100000 all round", scattered(100000), camera},
                        Case{"100000 in view", in_view(scattered(100000)), camera}}) {
    SceneRequest without, with;
    without.chord_px = with.chord_px = 1;
    without.frame_angle_rad = with.frame_angle_rad = std::numbers::pi;
    with.skip.occluded = true;
    ScenePlan all, shown;
    Walk walk_without(c.scene, c.camera, without), walk_with(c.scene, c.camera, with);
    const std::vector<double> s = medians(
        rounds, {[&] { all = plan_scene(c.scene, c.camera, without); }, [&] { evaluate(c.scene, all); },
                 [&] { walk_without.step(); }, [&] { shown = plan_scene(c.scene, c.camera, with); },
                 [&] { evaluate(c.scene, shown); }, [&] { walk_with.step(); }});
    std::printf("| %s | %zu | %llu | %.0f | %.0f | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", c.name,
                all.tiles.size(), static_cast<unsigned long long>(shown.skipped.occluded),
                1e-3 * double(all.samples_needed), 1e-3 * double(shown.samples_needed), 1e3 * s[0],
                1e3 * s[3], 1e3 * s[2], 1e3 * s[5], 1e3 * s[1], 1e3 * s[4]);
  }
}

// Nothing to skip: double-sided surfaces of one distance, all in view.
void overhead(int rounds) {
  std::printf(
      "\n### Nothing to skip\n\n100 double-sided surfaces in view, 20 radii away, without looking for "
      "duplicates. Uniformly: each as one grid. Of a sphere, tiles at the poles are coarser all the same.\n\n"
      "| | asked for | million samples | planning, ms | evaluation, ms | planning more | uniformly, million "
      "samples "
      "| ms |\n|---|---|---:|---:|---:|---:|---:|---:|\n");
  for (const char* name : {"torus", "sphere"}) {
    Scene scene{{make_surface(name)}, {{.name = "glass", .normal_map = true, .double_sided = true}}, {}};
    for (int i = 0; i < 100; ++i) {
      SceneInstance instance;
      const double angle = 0.2 * i / 100, turn = i;
      instance.placement = Eigen::AngleAxisd(turn, Eigen::Vector3d(1, 2, 3).normalized());
      instance.placement.pretranslate(20 * Eigen::Vector3d(std::sin(angle) * std::cos(turn),
                                                           std::sin(angle) * std::sin(turn),
                                                           -std::cos(angle)));
      scene.instances.push_back(instance);
    }
    SceneRequest usual, fine;
    fine.attributes = partial_attributes | frame_attributes;
    fine.chord_px = 0.005;
    fine.frame_angle_rad = std::numbers::pi;
    for (SceneRequest* request : {&usual, &fine}) {
      request->skip.duplicates = false;
      SceneRequest everything = *request;
      everything.skip = SceneRequest::Skip::nothing();
      const ScenePlan uniform = plan_scene(scene, {}, everything);
      ScenePlan plan;
      const std::vector<double> s =
          medians(rounds, {[&] { plan = plan_scene(scene, {}, *request); }, [&] { evaluate(scene, plan); },
                           [&] { evaluate_uniformly(scene, uniform, request->attributes); }});
      std::printf(
          "| %s | %s | %.2f | %.2f | %.2f | %.1f %% | %.2f | %.2f |\n", name,
          request == &usual ? "position, normal, tangents; 0.5 px, 1 degree" : "partials and frame; 0.005 px",
          1e-6 * double(plan.samples_needed), 1e3 * s[0], 1e3 * s[1], 100 * s[0] / s[1],
          1e-6 * double(uniform.samples_full), 1e3 * s[2]);
    }
  }
}

}  // namespace
}  // namespace darboux::bench

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
  const int rounds = quick ? 3 : 9;
  try {
    darboux::bench::asteroids(rounds);
    darboux::bench::growth(rounds, quick);
    darboux::bench::hidden(quick ? 3 : 5);
    darboux::bench::overhead(rounds);
    darboux::bench::contest_of_scenes(rounds);
  } catch (const darboux::Error& error) {
    std::fprintf(stderr, "benchmark_scene: %s\n", error.what());
    return 2;
  }
}
