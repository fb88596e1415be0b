/// \file image.h
/// Images as arrays of numbers, as stored in files. Colours are not converted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace darboux {

/// The type of a channel of a texel.
enum class SampleType : std::uint8_t {
  u8,   ///< codes 0 to 255
  u16,  ///< codes 0 to 65535
  f32   ///< numbers
};

/// Texels, row by row from the top. Channels: red, green, blue and, if there are four, alpha.
struct Image {
  using Samples = std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>, std::vector<float>>;

  int width = 0, height = 0;
  int channels = 3;  ///< 3 or 4
  Samples samples;   ///< width * height * channels of them; their type in the order of SampleType

  Image() = default;
  /// All zero.
  Image(int w, int h, int c, SampleType type) : width(w), height(h), channels(c) {
    const std::size_t count = texels() * static_cast<std::size_t>(c);
    if (type == SampleType::u8)
      samples.emplace<0>(count);
    else if (type == SampleType::u16)
      samples.emplace<1>(count);
    else
      samples.emplace<2>(count);
  }

  SampleType type() const { return static_cast<SampleType>(samples.index()); }
  std::size_t bytes() const {
    return std::visit([](const auto& s) { return s.size() * sizeof s[0]; }, samples);
  }
  std::size_t texels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

}  // namespace darboux
