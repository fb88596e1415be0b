// Times the bounds of tiles, each call by itself: the figures of tile_bounds.h.
//   benchmark_tile_bounds [Google Benchmark's options]    e.g. --benchmark_filter=torus
// One tile of 1/16 × 1/16 after another of every kind of surface with bounds.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <darboux/any_surface.h>
#include <darboux/tile_bounds.h>

namespace darboux::bench {
namespace {

std::vector<Tile> tiles() {
  std::vector<Tile> list;
  for (int i = 0; i < 16; ++i)
    for (int k = 0; k < 16; ++k) list.push_back({i / 16.0, (i + 1) / 16.0, k / 16.0, (k + 1) / 16.0});
  return list;
}

template <class F>
void time_calls(const std::string& name, F call) {
  ::benchmark::RegisterBenchmark(name.c_str(), [call](::benchmark::State& state) {
    std::size_t k = 0;
    for (auto _ : state) ::benchmark::DoNotOptimize(call(k++ % 256));
  });
}

void register_surface(const AnySurface& surface) {
  if (!TileBounds(surface, {0.3, 0.4, 0.3, 0.4}).known()) return;
  const std::string name = std::string(surface.info().name) + '/';
  const std::vector<Tile> all = tiles();
  std::vector<TileBounds> bounds;
  std::vector<TileRates> rates;
  for (const Tile& tile : all) {
    bounds.emplace_back(surface, tile, TileOrder::second);
    rates.push_back(bounds.back().rates());
  }
  const Vec3<double> eye{3, 2, 1};
  time_calls(name + "construction", [=](std::size_t k) { return TileBounds(surface, all[k]).known(); });
  time_calls(name + "construction, second order",
             [=](std::size_t k) { return TileBounds(surface, all[k], TileOrder::second).known(); });
  time_calls(name + "support", [=](std::size_t k) { return bounds[k].support(eye); });
  time_calls(name + "facing", [=](std::size_t k) { return bounds[k].facing(eye); });
  time_calls(name + "rates", [=](std::size_t k) { return bounds[k].rates().frame_u; });
  time_calls(name + "frame_interpolation_angle",
             [=](std::size_t k) { return rates[k].frame_interpolation_angle(0.01, 0.01); });
}

}  // namespace
}  // namespace darboux::bench

int main(int argc, char** argv) {
  ::benchmark::Initialize(&argc, argv);
  if (::benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const darboux::AnySurface& surface : darboux::all_surfaces())
    darboux::bench::register_surface(surface);
  ::benchmark::RunSpecifiedBenchmarks();
  ::benchmark::Shutdown();
}
