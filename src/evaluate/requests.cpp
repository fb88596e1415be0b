// The requests of evaluate(): points and outputs, and which of them are rejected.
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

template <class T>
std::string misaligned(const std::string& what) {
  return "expected " + what + " at a multiple of " + std::to_string(alignof(T)) +
         " bytes, got another address";
}

std::string wrong_stride(std::size_t alignment, std::size_t least, std::ptrdiff_t stride) {
  return "expected a stride that is a multiple of " + std::to_string(alignment) + " bytes and at least " +
         std::to_string(least) + ", got " + std::to_string(stride);
}

}  // namespace

template <std::floating_point T>
Points<T> Points<T>::arrays(std::span<const T> u, std::span<const T> v) {
  if (u.size() != v.size())
    throw ParameterError("points", "expected as many values of v as of u, got " + std::to_string(u.size()) +
                                       " of u and " + std::to_string(v.size()) + " of v");
  if (!aligned_to_own_size(u.data()) || !aligned_to_own_size(v.data()))
    throw ParameterError("points", misaligned<T>("u or v"));
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
                         "expected an even number of interleaved values, got " + std::to_string(uv.size()));
  return interleaved(uv.data(), uv.size() / 2, 2 * sizeof(T));
}

template <std::floating_point T>
Points<T> Points<T>::interleaved(const T* uv, std::size_t points, std::ptrdiff_t stride) {
  if (uv == nullptr && points > 0) throw ParameterError("points", "expected an array of pairs, got null");
  if (stride < static_cast<std::ptrdiff_t>(2 * sizeof(T)) ||
      stride % static_cast<std::ptrdiff_t>(alignof(T)) != 0)
    throw ParameterError("points", wrong_stride(alignof(T), 2 * sizeof(T), stride));
  if (!aligned_to_own_size(uv)) throw ParameterError("points", misaligned<T>("uv"));
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
    throw ParameterError("grid", "expected 1 to " + std::to_string(most) + " columns and rows, got " +
                                     std::to_string(columns) + " columns and " + std::to_string(rows) +
                                     " rows");
  if (first > rows)
    throw ParameterError("grid", "expected a row of points from 0 to " + std::to_string(rows) + ", got " +
                                     std::to_string(first));
  Points result;
  result.columns_ = result.all_columns_ = columns;
  result.rows_ = rows;
  result.first_row_ = first;
  result.size_ = std::min(count, rows + 1 - first) * (columns + 1);
  return result;
}

template <std::floating_point T>
Points<T> Points<T>::part_of_grid(std::size_t columns, std::size_t rows, std::size_t first_column,
                                  std::size_t cells_u, std::size_t first_row, std::size_t cells_v) {
  const auto within = [](const char* what, std::size_t first, std::size_t cells, std::size_t all) {
    if (cells < 1 || first >= all || cells > all - first)
      throw ParameterError("grid", "expected some of " + std::to_string(all) + ' ' + what + ", got " +
                                       std::to_string(cells) + " from " + std::to_string(first) + " on");
  };
  Points result = grid(columns, rows);
  within("columns", first_column, cells_u, columns);
  within("rows", first_row, cells_v, rows);
  result.columns_ = cells_u;
  result.first_column_ = first_column;
  result.first_row_ = first_row;
  result.size_ = (cells_u + 1) * (cells_v + 1);
  return result;
}

template <std::floating_point T>
Points<T> Points<T>::part(std::size_t first, std::size_t count) const {
  if (first > size_ || count > size_ - first)
    throw ParameterError("points", "expected a part of the " + std::to_string(size_) + " there are, got " +
                                       std::to_string(count) + " points from " + std::to_string(first) +
                                       " on");
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
  if (asked_.has(a)) refuse(a, "is asked for twice, expected once");
  for (std::size_t c = 0; c < info_of(a).components; ++c) {
    if (place.component[c] == nullptr && place.points > 0) refuse(a, "expected an array, got null");
    if (!aligned_to_own_size(place.component[c])) refuse(a, misaligned<T>("its array"));
  }
  if (place.stride < static_cast<std::ptrdiff_t>(consecutive * sizeof(T)) ||
      place.stride % static_cast<std::ptrdiff_t>(alignof(T)) != 0)
    refuse(a, wrong_stride(alignof(T), consecutive * sizeof(T), place.stride));
  asked_ |= a;
  places_[static_cast<std::size_t>(a)] = place;
  return *this;
}

template <std::floating_point T>
Outputs<T>& Outputs<T>::separate(Attribute a, std::span<const std::span<T>> components) {
  if (components.size() != info_of(a).components)
    refuse(a, "expected an array for each of its " + std::to_string(info_of(a).components) +
                  " components, got " + std::to_string(components.size()));
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
  if (values.size() % n != 0)
    refuse(a, "expected a multiple of " + std::to_string(n) + " packed values, got " +
                  std::to_string(values.size()));
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
  if (status_ != nullptr) throw ParameterError("status", "is asked for twice, expected once");
  if (first == nullptr && points > 0) throw ParameterError("status", "expected an array, got null");
  if (stride < static_cast<std::ptrdiff_t>(sizeof(Status)) ||
      stride % static_cast<std::ptrdiff_t>(alignof(Status)) != 0 || !aligned_to_own_size(first))
    throw ParameterError("status", aligned_to_own_size(first)
                                       ? wrong_stride(alignof(Status), sizeof(Status), stride)
                                       : misaligned<Status>("its array"));
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
