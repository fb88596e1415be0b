// Files of meshes and points that are read as a whole: DARBOUX_FUZZ_EXTENSIONS; the first byte picks among
// several.
#include <algorithm>
#include <array>

#include <darboux/io.h>

#include "support.h"

namespace {

using namespace darboux;

const std::array extensions{DARBOUX_FUZZ_EXTENSIONS};

bool is_mesh(std::string_view extension) {
  const auto all = asset_extensions();
  return extension != ".obj" && std::find(all.begin(), all.end(), extension) != all.end();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view bytes = fuzz::text_of(data, size);
  std::size_t which = 0;
  if (extensions.size() > 1) {
    if (bytes.empty()) return 0;
    which = static_cast<unsigned char>(bytes[0]) % extensions.size();
    bytes.remove_prefix(1);
  }
  const std::string path = fuzz::in_file(bytes, extensions[which]);
  if (is_mesh(extensions[which]))
    fuzz::may_refuse([&] {
      const Asset asset = read_asset(path);
      for (const Primitive& p : asset.primitives) check_consistent(p.data, path);
    });
  if (extensions[which] != std::string_view(".dae"))
    fuzz::may_refuse([&] {
      const PointFile file = read_points(path);
      const std::size_t n = file.cloud.positions.size();
      fuzz::expect(n > 0, "a file without points is refused");
      fuzz::expect(file.cloud.normals.empty() || file.cloud.normals.size() == n, "a normal per point");
      fuzz::expect(file.cloud.uvs.empty() || file.cloud.uvs.size() == n, "a uv per point");
    });
  return 0;
}
