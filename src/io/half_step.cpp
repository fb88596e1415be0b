#include "half_step.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace darboux::io {
namespace {

constexpr int least_bits = 7;  // of what is quantised: with its sign a byte

// The magnitudes that tell of steps: each once, without 0 and 1, which every number of bits has. Enough of
// them.
template <class T>
std::vector<double> magnitudes(const Accessor& accessor, double most) {
  constexpr std::size_t enough = 4096;
  std::vector<double> result;
  const std::size_t stride = std::max<std::size_t>(1, accessor.count / enough);
  for (std::size_t i = 0; i < accessor.count; i += stride)
    for (std::size_t k = 0; k < accessor.components; ++k) {
      const double x = std::fabs(static_cast<double>(raw_component<T>(accessor, i, k))) / most;
      if (x != 0 && x != 1 && std::isfinite(x)) result.push_back(x);
    }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// The fewest bits, at most `most_bits`, with which all numbers are multiples of 1 / (2^bits - 1), and by
// chance are so with this logarithm of its probability to base 2 at most; 0 where there are none. \param
// error of the numbers as stored
int fewest_bits(const std::vector<double>& numbers, int most_bits, double error, double chance) {
  for (int bits = least_bits; bits <= most_bits; ++bits) {
    const double steps = std::ldexp(1.0, bits) - 1, apart = 1.001 * error * steps;
    if (static_cast<double>(numbers.size()) * std::log2(2 * apart) > chance) continue;
    if (std::all_of(numbers.begin(), numbers.end(),
                    [&](double x) { return std::fabs(x * steps - std::round(x * steps)) <= apart; }))
      return bits;
  }
  return 0;
}

}  // namespace

double half_step(const Accessor& accessor, bool directions) {
  constexpr double unlikely = -30;
  double result = 0;
  with_component(accessor.component_type, [&](auto zero) {
    using T = decltype(zero);
    if constexpr (std::is_floating_point_v<T>) {
      constexpr int most_bits = 11;  // more are within the length that floats are allowed
      if (!directions) return;
      const int bits = fewest_bits(magnitudes<T>(accessor, 1), most_bits, 0x1p-24, unlikely);
      if (bits > 0) result = 0.5 / (std::ldexp(1.0, bits) - 1);
    } else if (accessor.normalized && sizeof(T) < 4) {
      constexpr double most = std::numeric_limits<T>::max();
      // Tools round to the nearest integer, or repeat the bits below themselves, which is less than one off.
      // That directions are such multiples by chance harms little: longer steps excuse more, and find
      // nothing.
      const int bits = fewest_bits(magnitudes<T>(accessor, most), std::numeric_limits<T>::digits - 1,
                                   1 / most, directions ? 0.3 * unlikely : unlikely);
      result = 0.5 / (bits > 0 ? std::ldexp(1.0, bits) - 1 : most);
    } else {
      result = 0.5;
    }
  });
  return result;
}

}  // namespace darboux::io
