// What `darboux validate` costs, as the tables of docs/reports/validate.md, for validate.sh:
//   benchmark_validate WORK [--quick]
// WORK is an empty folder. Each measurement is a process of its own: reading, the verdict, the processor's
// time, the peak of memory.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <darboux/assess.h>
#include <darboux/catalogue.h>
#include <darboux/io.h>
#include <darboux/mikktspace.h>
#include <darboux/sample_mesh.h>

#include "base/keep_freed_memory.h"
#include "measure.h"

namespace darboux::bench {
namespace {

// Of one process.
struct Cost {
  double reading = 0, rest = 0;  // seconds of one core
  double peak = 0;               // bytes
};

double processor_seconds() {
  rusage use;
  getrusage(RUSAGE_SELF, &use);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(use.ru_utime) + seconds(use.ru_stime);
}

// f() in a child, which hands back what it returns.
template <class Result>
Result in_a_process(const std::function<Result()>& f) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    const Result result = f();
    _exit(write(ends[1], &result, sizeof result) == sizeof result ? 0 : 1);
  }
  close(ends[1]);
  Result result;
  const bool read_all = read(ends[0], &result, sizeof result) == sizeof result;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!read_all || status != 0) throw std::runtime_error("a measurement failed");
  return result;
}

using Assessed = std::function<void(const Mesh&)>;

Cost cost_of(const std::string& file, const Assessed& assessed) {
  return in_a_process<Cost>([&] {
    Cost cost;
    const double start = processor_seconds();
    const Asset asset = read_asset(file);
    cost.reading = processor_seconds() - start;
    for (const Primitive& primitive : asset.primitives) assessed(primitive.data);
    cost.rest = processor_seconds() - start - cost.reading;
    rusage use;
    getrusage(RUSAGE_SELF, &use);
    cost.peak = 1024.0 * static_cast<double>(use.ru_maxrss);
    return cost;
  });
}

struct Measured {
  std::string file;
  Assessed assessed;
};
// The medians of several processes each, every number by itself. All take turns, as a machine can be slow for
// a while.
std::vector<Cost> typical(const std::vector<Measured>& measured, int rounds) {
  std::vector<std::array<std::vector<double>, 3>> costs(measured.size());
  for (int i = 0; i < rounds; ++i)
    for (std::size_t k = 0; k < measured.size(); ++k) {
      const Cost cost = cost_of(measured[k].file, measured[k].assessed);
      costs[k][0].push_back(cost.reading), costs[k][1].push_back(cost.rest), costs[k][2].push_back(cost.peak);
    }
  std::vector<Cost> result;
  for (const auto& [reading, rest, peak] : costs)
    result.push_back({median(reading), median(rest), median(peak)});
  return result;
}

void write_mesh(const std::string& file, const AnySurface& surface, const SampleMeshOptions& options,
                bool bent) {
  in_a_process<int>([&] {
    Mesh mesh = sample_mesh(surface, options);
    if (bent)
      for (Vec3<double>& p : mesh.positions)
        p = (1 + 0.2 * std::sin(3 * p.x + 2 * p.y) + 0.1 * std::cos(5 * p.z + p.x)) * p;
    write_glb(file, mesh, "mesh");
    return 0;
  });
}

void mikktspace_of(const Mesh& mesh) {
  std::vector<float> positions, normals, uvs;
  std::vector<std::uint32_t> corners;
  const auto to_float = [](double x) { return static_cast<float>(x); };
  for (const Vec3<double>& p : mesh.positions)
    positions.insert(positions.end(), {to_float(p.x), to_float(p.y), to_float(p.z)});
  for (const Vec3<double>& n : mesh.normals)
    normals.insert(normals.end(), {to_float(n.x), to_float(n.y), to_float(n.z)});
  for (const Vec2<double>& uv : mesh.uvs) uvs.insert(uvs.end(), {to_float(uv.x), to_float(uv.y)});
  for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  std::vector<float> tangents(4 * corners.size());
  mikktspace(MikkMesh{positions, normals, uvs, corners, {}}, tangents);
}

// Seconds until two processes have read and assessed the files, each every other.
double seconds_for(const std::vector<std::string>& files) {
  const auto start = std::chrono::steady_clock::now();
  pid_t children[2];
  for (std::size_t k = 0; k < 2; ++k) {
    children[k] = fork();
    if (children[k] < 0) throw std::runtime_error("no process");
    if (children[k] != 0) continue;
    for (std::size_t i = k; i < files.size(); i += 2)
      for (const Primitive& primitive : read_asset(files[i]).primitives) assess_parts(primitive.data);
    _exit(0);
  }
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    if (status != 0) throw std::runtime_error("a measurement failed");
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void row(const char* what, const char* required, double measured, const char* unit, bool met) {
  std::printf("| %s | %s | %.3g%s | %s |\n", what, required, measured, unit, met ? "met" : "**missed**");
}

void run(const std::string& work, bool quick) {
  const int columns = quick ? 250 : 1000, rows = quick ? 200 : 500, rounds = quick ? 3 : 7;
  const double triangles = 2.0 * columns * rows, millions = 1e-6 * triangles;
  const std::string torus = work + "/torus.glb", bent = work + "/bent.glb";
  const AnySurface surface = make_surface("torus:major_radius=1,minor_radius=0.4");
  write_mesh(torus, surface, {.columns = columns, .rows = rows}, false);
  write_mesh(bent, surface, {.columns = columns / 4, .rows = rows / 4}, true);

  AssessOptions all, analytic, unknown;
  analytic.surface = parse_specification("torus");
  analytic.references = {.analytic = true, .mikktspace = false, .local = false, .triangles = false};
  unknown.references = analytic.references;
  const auto assessed = [](const AssessOptions& options) {
    return [&options](const Mesh& mesh) { assess_parts(mesh, options); };
  };
  const std::vector<Cost> costs = typical({{torus, [](const Mesh&) {}},
                                           {torus, mikktspace_of},
                                           {torus, assessed(analytic)},
                                           {torus, assessed(all)},
                                           {bent, assessed(unknown)}},
                                          rounds);
  const Cost &reading = costs[0], &mikk = costs[1], &declared = costs[2], &every = costs[3], &none = costs[4];

  std::vector<std::string> files;
  for (const char* name : {"sphere", "torus", "cylinder", "cone"}) {
    files.push_back(work + "/" + name + ".glb");
    write_mesh(files.back(), make_surface(name), {.columns = 16, .rows = 8}, false);
  }
  for (std::size_t i = 0; files.size() < 1000; ++i) files.push_back(files[i]);
  std::vector<double> small;
  for (int i = 0; i < rounds; ++i) small.push_back(static_cast<double>(files.size()) / seconds_for(files));

  // Buffers of the file: vertices of 48 bytes, indices of 12 a triangle.
  const double buffers = 48.0 * (columns + 1) * (rows + 1) / triangles + 12, permitted = 3 * buffers + 200;
  char memory[64];
  std::snprintf(memory, sizeof memory, "<= %.0f bytes", permitted);

  std::printf("\n### Targets\n\n| what | required | measured | |\n|---|---|---:|---|\n");
  row("declared surface alone, 10^6 triangles, beyond reading", "<= 0.5 s", declared.rest / millions, " s",
      declared.rest <= 0.5 * millions);
  row("all references, 10^6 triangles, with reading", "<= 1.6 s", (every.reading + every.rest) / millions,
      " s", every.reading + every.rest <= 1.6 * millions);
  row("peak of memory per triangle, all references: 3 × the file's buffers and 200 bytes", memory,
      every.peak / triangles, " bytes", every.peak <= permitted * triangles);
  row("files of 256 triangles, two processes", ">= 200 a second", median(small), " a second",
      median(small) >= 200);

  std::printf("\n### Of %.3g triangles\n\n", triangles);
  std::printf(
      "Seconds of one core; × MikkTSpace is what that is beside `mikktspace()` on the same mesh, conversion "
      "to floats "
      "included.\n\n| what | s | × MikkTSpace | peak, bytes a triangle |\n|---|---:|---:|---:|\n");
  const auto line = [&](const char* what, double seconds, double peak, double of) {
    std::printf("| %s | %.3g | %.2f | %.0f |\n", what, seconds, seconds / mikk.rest, peak / of);
  };
  line("reading the file", reading.reading, reading.peak, triangles);
  line("MikkTSpace's tangents", mikk.rest, mikk.peak, triangles);
  line("declared surface, `--surface torus --reference analytic`", declared.rest, declared.peak, triangles);
  line("all references, surface recognised", every.rest, every.peak, triangles);
  line("no surface fits, a sixteenth of the triangles, `--reference analytic`", none.rest, none.peak,
       triangles / 16);
}

}  // namespace
}  // namespace darboux::bench

int main(int argc, char** argv) {
  darboux::keep_freed_memory();  // as the tool does
  const bool quick = argc == 3 && std::string_view(argv[2]) == "--quick";
  if (argc != 2 && !quick) {
    std::fprintf(stderr, "usage: %s WORK [--quick]\n", argv[0]);
    return 2;
  }
  try {
    darboux::bench::run(argv[1], quick);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", argv[0], e.what());
    return 1;
  }
}
