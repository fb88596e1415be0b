// Which normal maps are flat, so that nothing needs a frame to read them.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "io/gltf_file.h"

namespace darboux {

// Reads the images of a document once each. An image is flat where every texel is (0, 0, 1) as far as 8 bits
// can tell: |x|, |y| <= 1/255 and z >= 1 - 2/255. Only what is stored without loss says so: PNG.
class FlatNormalMaps {
 public:
  explicit FlatNormalMaps(const GltfFile& file) : file_(file) {}

  struct Answer {
    bool flat = false;
    std::string note{};  // why it is not known
  };
  // \param texture an entry of "textures"; all images it may be drawn with must be flat
  // \param two_channels x and y alone are stored, in red and green
  Answer of_texture(std::size_t texture, bool two_channels);

 private:
  const Answer& of_image(const io::JsonCursor& index, bool two_channels);

  const GltfFile& file_;
  std::map<std::pair<std::size_t, bool>, Answer> known_;  // by image
};

}  // namespace darboux
