// Surfaces by control points; the first byte picks the kind.
#include <darboux/io.h>

#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  if (size == 0) return 0;
  const auto& kinds = surface_file_kinds();
  fuzz::may_refuse([&] {
    const AnySurface surface = read_surface_file(kinds[data[0] % kinds.size()],
                                                 fuzz::in_file(fuzz::text_of(data + 1, size - 1), ".json"));
    for (const double u : {0.0, 0.3, 1.0}) static_cast<void>(surface.sample(u, 1 - u));
  });
  return 0;
}
