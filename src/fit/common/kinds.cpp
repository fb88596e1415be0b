#include "kinds.h"

#include <darboux/helicoid.h>
#include <darboux/torus.h>

namespace darboux::fit {
namespace {

// Whether that is the k-th parameter of the surface.
template <class Surface>
bool is_parameter(const AnySurface& surface, std::size_t k, double Surface::*member) {
  const auto* held = surface.get<Surface>();
  return held && &Surface::parameters()[k].of(*held) == &(held->*member);
}

}  // namespace

std::string with_article(std::string_view kind) {
  const bool vowel = std::string_view("aeiou").find(kind.front()) != std::string_view::npos;
  return (vowel && !kind.starts_with("one") ? "an " : "a ") + std::string(kind);
}

bool may_be_zero(const AnySurface& surface, std::size_t k) {
  const bool sphere = is_parameter(surface, k, &Torus<>::major_radius);
  const bool disk = is_parameter(surface, k, &Helicoid<>::pitch);
  return surface.parameters()[k].permitted.contains(0) && !sphere && !disk;
}

}  // namespace darboux::fit
