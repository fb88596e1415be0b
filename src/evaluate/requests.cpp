// What evaluate() is asked for: points and outputs, and what is refused of them.
#include <algorithm>
#include <cstdint>
#include <string>

#include <darboux/error.h>
#include <darboux/evaluate.h>

namespace darboux {
namespace {

[[noreturn]] void refuse(Attribute a, const std::string& why) {
  throw ParameterError(std::string(info_of(a).name), why);
}

template <class T>
bool aligned_to_own_size(const T* p) {
  return reinterpret_cast<std::uintptr_t>(p) % alignof(T) == 0;
}

}  // namespace

template <std::floating_point T>
Points<T> Points<T>::arrays(std::span<const T> u, std::span<const T> v) {
  if (u.size() != v.size())
    throw ParameterError("points", std::to_string(u.size()) + " values of u and " + std::to_string(v.size()) +
                                       " of v, permitted are as many");
  if (!aligned_to_own_size(u.data()) || !aligned_to_own_size(v.data()))
    throw ParameterError("points", "u or v is not aligned to its numbers, permitted are multiples of " +
                                       std::to_string(alignof(T)) + " bytes");
  Points result;
  result.u_ = u.data();
  result.v_ = v.data();
  result.size_ = u.size();
  return result;
}

template <std::floating_point T>
Points<T> Points<T>::interleaved(std::span<const T> uv) {
  if (uv.size() % 2 != 0)
    throw ParameterError("points",
                         std::to_string(uv.size()) + " interleaved values, permitted is an even number");
  return interleaved(uv.data(), uv.size() / 2, 2 * sizeof(T));
}

template <std::floating_point T>
Points<T> Points<T>::interleaved(const T* uv, std::size_t points, std::ptrdiff_t stride) {
  if (uv == nullptr && points > 0)
    throw ParameterError("points", "uv is null, permitted is an array of pairs");
  if (stride < static_cast<std::ptrdiff_t>(2 * sizeof(T)) ||
      stride % static_cast<std::ptrdiff_t>(alignof(T)) != 0)
    throw ParameterError("points", "a stride of " + std::to_string(stride) +
                                       " bytes, permitted are multiples of " + std::to_string(alignof(T)) +
                                       " from " + std::to_string(2 * sizeof(T)) + " on");
  if (!aligned_to_own_size(uv))
    throw ParameterError("points", "uv is not aligned to its numbers, permitted are multiples of " +
                                       std::to_string(alignof(T)) + " bytes");
  Points result;
  result.u_ = uv;
  result.v_ = uv == nullptr ? nullptr : uv + 1;
  result.stride_ = stride;
  result.size_ = points;
  return result;
}

template <std::floating_point T>
Points<T> Points<T>::grid(std::size_t columns, std::size_t rows, std::size_t first, std::size_t count) {
  constexpr std::size_t most = std::size_t{1} << 31;
  if (columns < 1 || rows < 1 || columns > most || rows > most)
    throw ParameterError("grid", std::to_string(columns) + " columns and " + std::to_string(rows) +
                                     " rows, permitted are 1 to " + std::to_string(most) + " of each");
  if (first > rows)
    throw ParameterError(
        "grid", "row of points " + std::to_string(first) + ", permitted are 0 to " + std::to_string(rows));
  Points result;
  result.columns_ = columns;
  result.rows_ = rows;
  result.first_row_ = first;
  result.size_ = std::min(count, rows + 1 - first) * (columns + 1);
  return result;
}

template <std::floating_point T>
Points<T> Points<T>::part(std::size_t first, std::size_t count) const {
  if (first > size_ || count > size_ - first)
    throw ParameterError("points", std::to_string(count) + " points from " + std::to_string(first) +
                                       " on, permitted are parts of the " + std::to_string(size_) +
                                       " there are");
  Points result = *this;
  result.size_ = count;
  if (is_grid()) {
    result.offset_ += first;
  } else {
    const auto moved = [&](const T* x) {
      return reinterpret_cast<const T*>(reinterpret_cast<const char*>(x) +
                                        stride_ * static_cast<std::ptrdiff_t>(first));
    };
    result.u_ = moved(u_);
    result.v_ = moved(v_);
  }
  return result;
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::add(Attribute a, const OutputPlace<T>& place, std::size_t consecutive) {
  if (asked_.has(a)) refuse(a, "is asked for twice, permitted is once");
  for (std::size_t c = 0; c < info_of(a).components; ++c) {
    if (place.component[c] == nullptr && place.points > 0)
      refuse(a, "its array is null, permitted is the caller's memory");
    if (!aligned_to_own_size(place.component[c]))
      refuse(a, "its array is not aligned to its numbers, permitted are multiples of " +
                    std::to_string(alignof(T)) + " bytes");
  }
  if (place.stride < static_cast<std::ptrdiff_t>(consecutive * sizeof(T)) ||
      place.stride % static_cast<std::ptrdiff_t>(alignof(T)) != 0)
    refuse(a, "a stride of " + std::to_string(place.stride) + " bytes, permitted are multiples of " +
                  std::to_string(alignof(T)) + " from " + std::to_string(consecutive * sizeof(T)) + " on");
  asked_ |= a;
  places_[static_cast<std::size_t>(a)] = place;
  return *this;
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::separate(Attribute a, std::span<const std::span<T>> components) {
  if (components.size() != info_of(a).components)
    refuse(a, std::to_string(components.size()) + " arrays, permitted are its " +
                  std::to_string(info_of(a).components) + " components");
  OutputPlace<T> place;
  place.stride = sizeof(T);
  place.points = components[0].size();
  for (std::size_t c = 0; c < components.size(); ++c) {
    place.component[c] = components[c].data();
    place.points = std::min(place.points, components[c].size());
  }
  return add(a, place, 1);
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::packed(Attribute a, std::span<T> values) {
  const std::size_t n = info_of(a).components;
  return member(a, values.data(), values.size() / n, static_cast<std::ptrdiff_t>(n * sizeof(T)));
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::member(Attribute a, T* first, std::size_t points, std::ptrdiff_t stride) {
  OutputPlace<T> place;
  const std::size_t n = info_of(a).components;
  for (std::size_t c = 0; c < n; ++c) place.component[c] = first == nullptr ? nullptr : first + c;
  place.stride = stride;
  place.points = points;
  return add(a, place, n);
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::status(Status* first, std::size_t points, std::ptrdiff_t stride) {
  if (status_ != nullptr) throw ParameterError("status", "is asked for twice, permitted is once");
  if (first == nullptr && points > 0)
    throw ParameterError("status", "its array is null, permitted is the caller's memory");
  if (stride < static_cast<std::ptrdiff_t>(sizeof(Status)) ||
      stride % static_cast<std::ptrdiff_t>(alignof(Status)) != 0 || !aligned_to_own_size(first))
    throw ParameterError(
        "status", (aligned_to_own_size(first) ? "a stride of " + std::to_string(stride) + " bytes"
                                              : std::string("its array is not aligned to its values")) +
                      ", permitted are multiples of " + std::to_string(sizeof(Status)) + " bytes");
  status_ = first;
  status_points_ = points;
  status_stride_ = stride;
  return *this;
}

template class Points<double>;
template class Points<float>;
template class Outputs<double>;
template class Outputs<float>;

}  // namespace darboux
