// Surfaces by formula, and what they give where they are evaluated.
#include <darboux/io.h>

#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  fuzz::may_refuse([&] {
    const AnySurface surface = read_formula_surface(fuzz::in_file(fuzz::text_of(data, size), ".surface"));
    for (const double u : {0.0, 0.3, 1.0}) static_cast<void>(surface.sample(u, 1 - u));
    static_cast<void>(surface.specification());
  });
  return 0;
}
