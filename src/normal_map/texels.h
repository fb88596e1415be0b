/// \file texels.h
/// Converts between texels of normal maps and vectors.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <darboux/image.h>
#include <darboux/vector.h>

namespace darboux::normal_map {

/// The largest code.
inline double most_of(SampleType type) {
  return type == SampleType::u8 ? 255 : type == SampleType::u16 ? 65535 : 1;
}

/// By how much two triangles may disagree about a channel.
inline double code_step(SampleType type) {
  return type == SampleType::f32 ? 2.0 / 65535 : 1;
}

/// Converts between codes and the numbers they represent.
class Coding {
 public:
  Coding(SampleType type, bool signed_floats, std::optional<std::uint64_t> dither = {})
      : type_(type),
        most_(most_of(type)),
        as_is_(type == SampleType::f32 && signed_floats),
        dither_(dither) {}

  double number(double code) const { return as_is_ ? code : (2 * code - most_) / most_; }
  Vec3<double> numbers(const std::array<double, 3>& codes) const {
    return {number(codes[0]), number(codes[1]), number(codes[2])};
  }

  /// \param x finite \param texel what dithering is a function of
  std::array<double, 3> codes(const Vec3<double>& x, std::size_t texel) const {
    return {code(x.x, 3 * texel), code(x.y, 3 * texel + 1), code(x.z, 3 * texel + 2)};
  }

 private:
  double code(double x, std::uint64_t place) const {
    if (as_is_) return static_cast<float>(x);
    if (type_ == SampleType::f32) return static_cast<float>((x + 1) / 2);
    const double half = most_ / 2, shift = dither_ ? noise(place) : 0.5;
    // Truncated, which is rounded down: no call of a library function.
    return static_cast<std::int32_t>(std::min(most_, std::max(0.0, x * half + (half + shift))));
  }

  // In [0, 1), from the seed and the texel: splitmix64.
  double noise(std::uint64_t place) const {
    std::uint64_t z = (*dither_ ^ 0x6a09e667f3bcc909u) + (place + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

  SampleType type_;
  double most_;
  bool as_is_;  // floats from -1 to 1
  std::optional<std::uint64_t> dither_;
};

/// The channels of texels, whatever their type.
template <class Of>
class TexelAccess {
 public:
  explicit TexelAccess(Of& image) : type_(image.type()), channels_(static_cast<std::size_t>(image.channels)) {
    u8_ = type_ == SampleType::u8 ? std::get<0>(image.samples).data() : nullptr;
    u16_ = type_ == SampleType::u16 ? std::get<1>(image.samples).data() : nullptr;
    f32_ = type_ == SampleType::f32 ? std::get<2>(image.samples).data() : nullptr;
  }
  double get(std::size_t texel, std::size_t channel) const {
    const std::size_t at = texel * channels_ + channel;
    return type_ == SampleType::u8 ? u8_[at] : type_ == SampleType::u16 ? u16_[at] : f32_[at];
  }
  std::array<double, 3> get(std::size_t texel) const { return {get(texel, 0), get(texel, 1), get(texel, 2)}; }
  void set(std::size_t texel, std::size_t channel, double code) const {
    const std::size_t at = texel * channels_ + channel;
    if (type_ == SampleType::u8)
      u8_[at] = static_cast<std::uint8_t>(code);
    else if (type_ == SampleType::u16)
      u16_[at] = static_cast<std::uint16_t>(code);
    else
      f32_[at] = static_cast<float>(code);
  }
  void set(std::size_t texel, const std::array<double, 3>& codes) const {
    for (std::size_t c = 0; c < 3; ++c) set(texel, c, codes[c]);
  }

 private:
  template <class T>
  using Pointer = std::conditional_t<std::is_const_v<Of>, const T*, T*>;
  SampleType type_;
  std::size_t channels_;
  Pointer<std::uint8_t> u8_;
  Pointer<std::uint16_t> u16_;
  Pointer<float> f32_;
};

}  // namespace darboux::normal_map
