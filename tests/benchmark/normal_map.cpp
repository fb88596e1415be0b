// Times normal maps between spaces.
//   benchmark_normal_map [SIZE [ROUNDS]]    a map of SIZE x SIZE texels (4096), the best of ROUNDS (3)
// On a torus of 99 856 triangles, one thread and two. The rows go into docs/howto/convert-normal-maps.md.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include <sys/resource.h>

#include <darboux/normal_map.h>
#include <darboux/sample_mesh.h>

namespace darboux::bench {
namespace {

Image waves(int size, SampleType type) {
  Image image(size, size, 3, type);
  const double most = type == SampleType::u8 ? 255 : 65535;
  std::visit(
      [&](auto& samples) {
        std::size_t i = 0;
        for (int y = 0; y < size; ++y)
          for (int x = 0; x < size; ++x) {
            const double a = 0.3 * std::sin(0.01 * x + 0.02 * y), b = 0.3 * std::cos(0.013 * x);
            for (const double n : {a, b, std::sqrt(1 - a * a - b * b)})
              samples[i++] = static_cast<typename std::remove_reference_t<decltype(samples)>::value_type>(
                  (n + 1) / 2 * most + 0.5);
          }
      },
      image.samples);
  return image;
}

double memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

int run(int size, int rounds) {
  SampleMeshOptions grid;
  grid.columns = 316;
  grid.rows = 158;
  const MapPiece piece{.mesh = sample_mesh(make_surface("torus"), grid)};
  std::printf("%zu triangles, %d x %d texels\n", piece.mesh.triangles.size(), size, size);
  std::printf(
      "| bits | from, to | basis, decode | threads | seconds | processor seconds | input + output, MB | "
      "beyond them, at most, MB "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const SampleType type : {SampleType::u8, SampleType::u16}) {
    const Image map = waves(size, type);
    const double before = memory_mb();
    for (const bool back : {false, true})
      for (const bool mikktspace : {true, false})
        for (const int threads : {1, 2}) {
          NormalMapOptions options;
          if (back) std::swap(options.from, options.to);
          options.basis = mikktspace ? MapBasis::stored : MapBasis::mikktspace;
          options.decode = mikktspace ? MapDecode::mikktspace : MapDecode::gltf_viewer;
          options.threads = threads;
          double best = 1e9, best_processor = 1e9;
          for (int r = 0; r < rounds; ++r) {
            const double processor = processor_seconds();
            const auto start = std::chrono::steady_clock::now();
            const NormalMapResult result = convert_normal_map(map, std::span(&piece, 1), options);
            best = std::fmin(best,
                             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
            best_processor = std::fmin(best_processor, processor_seconds() - processor);
            if (result.covered != map.texels()) return 1;
          }
          const double each = static_cast<double>(map.texels()) * 3 * (type == SampleType::u8 ? 1 : 2) / 1e6;
          std::printf("| %d | %s | %s | %d | %.2f | %.2f | %.0f | %.0f |\n", type == SampleType::u8 ? 8 : 16,
                      back ? "object, tangent" : "tangent, object",
                      mikktspace ? "stored, mikktspace" : "mikktspace, gltf-viewer", threads, best,
                      best_processor, 2 * each, std::fmax(0, memory_mb() - before - each * 1e6 / 1048576));
        }
  }
  return 0;
}

}  // namespace
}  // namespace darboux::bench

int main(int argc, char** argv) {
  const int size = argc > 1 ? std::atoi(argv[1]) : 4096, rounds = argc > 2 ? std::atoi(argv[2]) : 3;
  if (size < 1 || size > 16384 || rounds < 1) return 2;
  return darboux::bench::run(size, rounds);
}
