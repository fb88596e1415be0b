// Surfaces by name and parameters: "torus:major_radius=1". What is made names itself so that it is made
// again.
#include <darboux/any_surface.h>

#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  fuzz::may_refuse([&] {
    const AnySurface surface = make_surface(fuzz::text_of(data, size));
    const std::string text = surface.specification();
    fuzz::expect(make_surface(text).specification() == text, "a specification makes the same surface");
    static_cast<void>(surface.sample(0.3, 0.7));
  });
  return 0;
}
