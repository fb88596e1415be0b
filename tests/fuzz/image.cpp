// Images as normal maps have them: PNG, TGA and EXR.
#include "io/image_formats.h"
#include "io/read_png.h"
#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  fuzz::may_refuse([&] {
    const std::string_view bytes = fuzz::text_of(data, size);
    const ReadImageOptions any{.drop_colour_tags = true};
    const Image image = io::is_png(bytes)   ? io::image_of_png("memory.png", bytes, any)
                        : io::is_exr(bytes) ? io::image_of_exr("memory.exr", bytes, any)
                                            : io::image_of_tga("memory.tga", bytes, any);
    const std::size_t samples = std::visit([](const auto& s) { return s.size(); }, image.samples);
    fuzz::expect(image.channels == 3 || image.channels == 4, "three or four channels");
    fuzz::expect(samples == image.texels() * static_cast<std::size_t>(image.channels), "all texels");
  });
  return 0;
}
