#include "colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace darboux {
namespace {

// Of sRGB, constant term first.
constexpr Vec3<double> coefficients[] = {{0.2777273272234177, 0.005407344544966578, 0.3340998053353061},
                                         {0.1050930431085774, 1.404613529898575, 1.384590162594685},
                                         {-0.3308618287255563, 0.214847559468213, 0.09509516302823659},
                                         {-4.634230498983486, -5.799100973351585, -19.33244095627987},
                                         {6.228269936347081, 14.17993336680509, 56.69055260068105},
                                         {4.776384997670288, -13.74514537774601, -65.35303263337234},
                                         {-5.435455855934631, 4.645852612178535, 26.3124352495832}};

double to_linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}
unsigned srgb_byte(double linear) {
  const double srgb = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<unsigned>(std::lround(255 * std::clamp(srgb, 0.0, 1.0)));
}

ColourMap make_viridis() {
  ColourMap map;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(map.size() - 1);
    Vec3<double> srgb{};
    for (std::size_t k = std::size(coefficients); k-- > 0;) srgb = t * srgb + coefficients[k];
    map[i] = {static_cast<float>(to_linear(srgb.x)), static_cast<float>(to_linear(srgb.y)),
              static_cast<float>(to_linear(srgb.z))};
  }
  return map;
}

}  // namespace

const ColourMap& viridis() {
  static const ColourMap map = make_viridis();
  return map;
}

Vec3<float> colour_of(float error, double limit) {
  if (std::isnan(error)) return not_compared;
  const ColourMap& map = viridis();
  const double at = std::min(error / limit, 1.0) * static_cast<double>(map.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), map.size() - 2);
  const auto t = static_cast<float>(at - static_cast<double>(i));
  return (1 - t) * map[i] + t * map[i + 1];
}

std::string css_colour(const Vec3<float>& linear) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", srgb_byte(linear.x), srgb_byte(linear.y),
                srgb_byte(linear.z));
  return text;
}

}  // namespace darboux
