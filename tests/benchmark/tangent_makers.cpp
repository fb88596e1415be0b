#include "tangent_makers.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <time.h>

#include <darboux/mikktspace.h>

#include "assimp_mesh.h"
#include "torus_file.h"

namespace darboux::bench {
namespace {

// The largest size that this process has had in memory since the last reset, where Linux lets one reset it.
double peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      double kibibytes = 0;
      status >> kibibytes;
      return 1024 * kibibytes;
    }
  throw std::runtime_error("/proc/self/status: no VmHWM");
}
void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

// Time and memory of the first call; then calls until half a second has passed in all, then those that are
// timed, for a fifth of one. call() returns the seconds that count; output_bytes are those that a call itself
// allocates for its results.
template <class Call>
Sample sample(double output_bytes, Call&& call) {
  reset_peak();
  const double before = peak_bytes();
  const double first = call();
  Sample result{0, first, peak_bytes() - before - output_bytes};
  for (double passed = first; passed < 0.5;) passed += call();
  int calls = 0;
  for (; result.seconds < 0.2; ++calls) result.seconds += call();
  result.seconds /= calls;
  return result;
}

double clock_seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
// Of one thread its processor's time, which other work on the machine changes little; else the clock's.
template <class F>
double seconds(F&& f, int threads = 1) {
  const clockid_t clock = threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
  const double from = clock_seconds(clock);
  f();
  return clock_seconds(clock) - from;
}

Sample measure_darboux(const MeshArrays& arrays, int threads, bool keep_memory,
                       std::vector<float>& tangent4) {
  const MikkMesh mesh{arrays.positions, arrays.normals, arrays.uvs, arrays.corners, {}};
  tangent4.assign(4 * arrays.corner_count(), 0);
  MikkMemory memory;
  const MikkOptions options{.threads = threads, .memory = keep_memory ? &memory : nullptr};
  return sample(0, [&] { return seconds([&] { mikktspace(mesh, tangent4, options); }, threads); });
}

Sample measure_assimp(const MeshArrays& arrays, std::vector<float>& tangent4) {
  AssimpMesh mesh(arrays);
  // Both tangents and bitangents of each vertex.
  const Sample result = sample(2.0 * 3 * sizeof(float) * static_cast<double>(arrays.vertex_count()), [&] {
    mesh.drop_tangents();
    return seconds([&] { mesh.make_tangents(); });
  });
  tangent4 = mesh.tangents();
  return result;
}

}  // namespace

Sample measure_maker(const std::string& maker, const std::filesystem::path& mesh,
                     const std::filesystem::path& tangents) {
  const MeshArrays arrays = read_mesh_arrays(mesh);
  std::vector<float> tangent4;
  Sample result{};
  if (maker == "assimp")
    result = measure_assimp(arrays, tangent4);
  else if (maker == "darboux-1" || maker == "darboux-2")
    result = measure_darboux(arrays, maker.back() - '0', false, tangent4);
  else if (maker == "darboux-kept")
    result = measure_darboux(arrays, 1, true, tangent4);
  else
    throw std::runtime_error("no maker " + maker);
  if (!tangents.empty()) write_floats(tangent4, tangents);
  return result;
}

}  // namespace darboux::bench
