// How libpng's errors leave it, in reading and in writing.
#pragma once

#include <csetjmp>
#include <cstring>

#include <png.h>

namespace darboux::io {

// The target of libpng's error pointer. No exception passes through libpng, whose errors are longjmps.
struct PngFailure {
  std::jmp_buf jump;
  char message[128] = "";
};

[[noreturn]] inline void on_png_error(png_structp png, png_const_charp message) {
  PngFailure& failure = *static_cast<PngFailure*>(png_get_error_ptr(png));
  std::strncpy(failure.message, message, sizeof failure.message - 1);
  std::longjmp(failure.jump, 1);
}

inline void on_png_warning(png_structp, png_const_charp) {}

}  // namespace darboux::io
