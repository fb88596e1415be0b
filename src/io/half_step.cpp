#include "half_step.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

namespace darboux::io {
namespace {

// Without the sign bit.
constexpr int bits_of_a_byte = 7;
constexpr int most_bits_of_floats = 11;  // steps of more are within the length that floats are allowed

// The magnitudes that give evidence of a step, each once: those that are 0 or 1 up to `error` fit every step.
template <class T>
std::vector<double> magnitudes(const Accessor& accessor, double largest, double error) {
  constexpr std::size_t enough = 4096;
  std::vector<double> result;
  const std::size_t stride = std::max<std::size_t>(1, accessor.count / enough);
  for (std::size_t i = 0; i < accessor.count; i += stride)
    for (std::size_t k = 0; k < accessor.components; ++k) {
      const double x = std::fabs(static_cast<double>(raw_component<T>(accessor, i, k))) / largest;
      if (x > error && std::fabs(1 - x) > error && std::isfinite(x)) result.push_back(x);
    }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// The fewest bits for which all numbers, known up to `error`, are multiples of 1 / (2^bits - 1); 0 if that
// takes more than `most_bits`, or if they are likely to be such multiples by chance. \param least_surprise
// the probability of chance is at most 2^-least_surprise
int fewest_bits(const std::vector<double>& numbers, int most_bits, double error, double least_surprise) {
  for (int bits = bits_of_a_byte; bits <= most_bits; ++bits) {
    const double steps = std::ldexp(1.0, bits) - 1, apart = error * steps;
    if (-std::log2(2 * apart) * static_cast<double>(numbers.size()) < least_surprise) continue;
    if (std::all_of(numbers.begin(), numbers.end(),
                    [&](double x) { return std::fabs(x * steps - std::round(x * steps)) <= apart; }))
      return bits;
  }
  return 0;
}

// Whether all numbers are half floats: of 11 significant bits, or of fewer below 2^-14. The probability that
// a number of 24 bits is one is 2^-13.
bool are_half_floats(const std::vector<double>& numbers, double least_surprise) {
  if (13 * static_cast<double>(numbers.size()) < least_surprise) return false;
  return std::all_of(numbers.begin(), numbers.end(), [](double x) {
    const double last = std::ldexp(1.0, std::max(std::ilogb(x), -14) - 10);
    return std::fmod(x, last) == 0;
  });
}

// Whether all numbers are odd multiples of 1 / (2^bits - 1): of unsigned integers whose middle is 0. \pre
// They are multiples
bool are_odd(const std::vector<double>& numbers, int bits) {
  const double steps = std::ldexp(1.0, bits) - 1;
  return std::all_of(numbers.begin(), numbers.end(),
                     [&](double x) { return std::fmod(std::round(x * steps), 2) == 1; });
}

}  // namespace

double half_step(const Accessor& accessor) {
  double result = 0;
  with_component(accessor.component_type, [&](auto zero) {
    using T = decltype(zero);
    if constexpr (!std::is_floating_point_v<T>)
      result =
          0.5 /
          (accessor.normalized && sizeof(T) < 4 ? static_cast<double>(std::numeric_limits<T>::max()) : 1);
  });
  return result;
}

double half_step_of_directions(const Accessor& accessor) {
  int bits = 0;
  double of_half_floats = 0;
  with_component(accessor.component_type, [&](auto zero) {
    using T = decltype(zero);
    if constexpr (std::is_floating_point_v<T>) {
      // 0.6 and 0.8 are multiples of 1 / 255.
      constexpr double error = 0x1.01p-24, least_surprise = 50;
      const std::vector<double> numbers = magnitudes<T>(accessor, 1, error);
      bits = fewest_bits(numbers, most_bits_of_floats, error, least_surprise);
      // x * (2 / 255) - 1 rounds three times.
      constexpr double of_products = 0x1.4p-23;
      const int spread =
          bits > 0 ? bits : fewest_bits(numbers, most_bits_of_floats, of_products, least_surprise);
      if (spread > bits_of_a_byte && are_odd(numbers, spread)) bits = spread - 1;
      if (bits == 0 && are_half_floats(numbers, least_surprise)) of_half_floats = 0x1p-12;
    } else if (accessor.normalized && sizeof(T) < 4) {
      // Tools round to the nearest integer, or fill the low bits by repeating the high ones, which is off by
      // less than one. A box has only one magnitude as evidence. If it is taken for a step by chance, a wrong
      // length of 1 % is accepted.
      constexpr double largest = std::numeric_limits<T>::max(), error = 1.001 / largest, least_surprise = 2;
      bits = fewest_bits(magnitudes<T>(accessor, largest, error), std::numeric_limits<T>::digits - 1, error,
                         least_surprise);
    }
  });
  if (of_half_floats > 0) return of_half_floats;
  return bits > 0 ? 0.5 / (std::ldexp(1.0, bits) - 1) : half_step(accessor);
}

}  // namespace darboux::io
