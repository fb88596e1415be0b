// Scenes of surfaces as JSON.
#include "io/scene_file.h"

#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  if (fuzz::text_of(data, size).find("scatter") != std::string_view::npos)
    return 0;  // 10^7 instances are no finding
  fuzz::may_refuse([&] { io::read_scene_file(fuzz::in_file(fuzz::text_of(data, size), ".json")); });
  return 0;
}
