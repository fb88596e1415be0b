// Detects flat normal maps, which need no frame.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tuple>

#include "io/gltf_file.h"
#include "io/tangent_space.h"

namespace darboux {

// Examines the images of a document, each once per way of reading it. A map is flat if every texel, with x
// and y multiplied by the scale of the texture, is (0, 0, 1) to within 8 bits: |x|, |y| <= 1/255 and z >= 1 -
// 2/255. Only lossless images (PNG) are examined.
class FlatNormalMaps {
 public:
  explicit FlatNormalMaps(const GltfFile& file) : file_(file) {}

  struct Answer {
    bool flat = false;
    std::string note{};  // why the answer is unknown
  };
  // \param reader a normal map; all images that it may be drawn with must be flat
  Answer of(const io::FrameReader& reader);

 private:
  const Answer& of_image(const io::JsonCursor& index, bool two_channels, double scale);

  const GltfFile& file_;
  io::ReadBuffers buffers_;
  // By the source of the bytes, whether there are two channels, and scale.
  std::map<std::tuple<std::string, bool, double>, Answer> known_;
};

}  // namespace darboux
