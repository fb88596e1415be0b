#include "kinds.h"

namespace darboux::fit {

std::string with_article(std::string_view kind) {
  const bool vowel = std::string_view("aeiou").find(kind.front()) != std::string_view::npos;
  return (vowel && !kind.starts_with("one") ? "an " : "a ") + std::string(kind);
}

bool may_be_zero(std::string_view kind, const ParameterValue& parameter) {
  const bool sphere = kind == "torus" && parameter.name == "major_radius";
  const bool disk = kind == "helicoid" && parameter.name == "pitch";
  return parameter.permitted.contains(0) && !sphere && !disk;
}

}  // namespace darboux::fit
