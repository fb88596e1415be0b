// PNG images.
#include "io/read_png.h"
#include "support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace darboux;
  fuzz::may_refuse([&] {
    std::size_t rows = 0;
    io::read_png("memory.png", "image", fuzz::text_of(data, size),
                 [&](std::span<const std::uint16_t> rgb, int bits) {
                   fuzz::expect(rgb.size() % 3 == 0 && (bits == 8 || bits == 16), "texels of three numbers");
                   for (const std::uint16_t x : rgb) fuzz::expect(x < (1u << bits), "numbers of the bits");
                   return ++rows < 1000;
                 });
  });
  return 0;
}
