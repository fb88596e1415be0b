// The work of one thread on a Placed surface whose base has kernels.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <span>

#include "call.h"
#include "statuses.h"

namespace darboux::evaluation {

// The attributes of the base that the kernels place.
inline constexpr std::array placed_vectors{Attribute::position, Attribute::dpdu,   Attribute::dpdv,
                                           Attribute::d2pdu2,   Attribute::d2pduv, Attribute::d2pdv2};

// Evaluates blocks of the base and places them. Points with a status, and those beyond the range of numbers,
// go through the single-point functions.
template <class T>
class PlacedWorker {
 public:
  using Place = void (*)(const kernels::PlacedBlock<T>&);

  // The kernel that places the points of a call, if there is one.
  static Place kernel_for(const detail::ErasedSurface<T>& surface, const Outputs<T>& outputs,
                          const EvaluateOptions& options) {
    if (surface.base == nullptr || outputs.attributes().has_any(curvature_attributes)) return nullptr;
    const detail::ErasedSurface<T> base = surface.base(surface.surface);
    if (const Place of_base = kernel_for(base, outputs, options)) return of_base;
    const auto found = kernels::find_kernels<T>(*base.type, options.instruction_set);
    if (!base.proven || found.kernels == nullptr) return nullptr;
    if constexpr (std::same_as<T, double>)
      return found.set->place_double;
    else
      return found.set->place_float;
  }

  PlacedWorker(Place place, const detail::ErasedSurface<T>& surface, const Points<T>& points,
               const Outputs<T>& outputs, const EvaluateOptions& options)
      : place_(place),
        surface_(surface),
        base_(surface.base(surface.surface)),
        normals_(surface.map.template of_normals<T>()),
        points_(points),
        outputs_(outputs),
        options_(options),
        statuses_(outputs, kernels::placed_points) {
    options_.threads = 1;
    options_.stores = Stores::cached;
    block_.map = &surface.map;
    block_.normals = &normals_;
    block_.frames = outputs.attributes().has_any(frame_attributes);
    block_.vectors = 0;
    block_.rows = rows_.data();
    block_.left = left_.data();
    for (std::size_t k = 0; k < placed_vectors.size(); ++k)
      if (outputs.attributes().has(placed_vectors[k])) block_.vectors |= 1u << k;
    for_each_given([&](Attribute a, std::size_t row) {
      std::array<std::span<T>, 3> components;
      const std::size_t n = info_of(a).components;
      for (std::size_t c = 0; c < n; ++c) components[c] = {rows_[row + c].data(), kernels::placed_points};
      base_outputs_.separate(a, std::span<const std::span<T>>(components.data(), n));
    });
    base_outputs_.status(base_statuses_);
  }
  PlacedWorker(const PlacedWorker&) = delete;
  PlacedWorker& operator=(const PlacedWorker&) = delete;

  // Points `first` to `last` of the call.
  StatusSummary run(std::size_t first, std::size_t last) {
    for (std::size_t at = first; at < last; at += block_.count) {
      block_.count = std::min(kernels::placed_points, last - at);
      const StatusSummary of_base =
          detail::evaluate(base_, points_.part(at, block_.count), base_outputs_, options_);
      left_.fill(false);
      if (!of_base.all_regular())
        for (std::size_t i = 0; i < block_.count; ++i) left_[i] = base_statuses_[i] != Status::regular;
      complete_registers();
      place_(block_);
      write_rows(at);
      std::size_t points_left = 0;
      for (std::size_t i = 0; i < block_.count; ++i)
        if (left_[i]) ++points_left, write_point(at, i);
      statuses_.note(at, block_.count, points_left > 0);
      statuses_.summary.point_by_point += std::max(of_base.point_by_point, points_left);
      statuses_.summary.points += block_.count;
    }
    return statuses_.summary;
  }

 private:
  // Calls f(attribute, its first row) for what the base writes.
  template <class F>
  void for_each_given(F f) const {
    if (block_.frames) {
      f(Attribute::tangent, kernels::tangent_row);
      f(Attribute::normal, kernels::normal_row);
      f(Attribute::handedness, kernels::handedness_row);
    }
    for (std::size_t k = 0; k < placed_vectors.size(); ++k)
      if ((block_.vectors >> k & 1u) != 0) f(placed_vectors[k], kernels::first_vector_row + 3 * k);
  }

  // Repeats the last point to the end of a register: lanes without a value would diverge.
  void complete_registers() {
    const std::size_t n = block_.count, in_last = n % batch_size<T>;
    if (in_last == 0) return;
    for_each_given([&](Attribute a, std::size_t row) {
      for (std::size_t r = row; r < row + info_of(a).components; ++r)
        std::fill_n(&rows_[r][n], batch_size<T> - in_last, rows_[r][n - 1]);
    });
  }

  void write(Attribute a, std::size_t component, std::size_t at, const T* values, std::size_t count) const {
    const OutputPlace<T>& place = outputs_.place(a);
    char* to =
        reinterpret_cast<char*>(place.component[component]) + place.stride * static_cast<std::ptrdiff_t>(at);
    if (place.stride == sizeof(T))
      std::copy_n(values, count, reinterpret_cast<T*>(to));
    else
      for (std::size_t i = 0; i < count; ++i, to += place.stride) *reinterpret_cast<T*>(to) = values[i];
  }

  void write_rows(std::size_t at) {
    const auto asked = [&](Attribute a) { return outputs_.attributes().has(a); };
    const auto rows = [&](Attribute a, std::size_t row, std::size_t count) {
      for (std::size_t c = 0; c < count; ++c) write(a, c, at, rows_[row + c].data(), block_.count);
    };
    for (std::size_t k = 0; k < placed_vectors.size(); ++k)
      if (asked(placed_vectors[k])) rows(placed_vectors[k], kernels::first_vector_row + 3 * k, 3);
    if (asked(Attribute::tangent)) rows(Attribute::tangent, kernels::tangent_row, 3);
    if (asked(Attribute::bitangent)) rows(Attribute::bitangent, kernels::bitangent_row, 3);
    if (asked(Attribute::normal)) rows(Attribute::normal, kernels::normal_row, 3);
    if (asked(Attribute::handedness)) rows(Attribute::handedness, kernels::handedness_row, 1);
    if (asked(Attribute::tangent4)) {
      rows(Attribute::tangent4, kernels::tangent_row, 3);
      auto& w = rows_[kernels::handedness_row];  // written already
      if (options_.sign != SignConvention::raw)
        for (std::size_t i = 0; i < block_.count; ++i) w[i] = -w[i];
      write(Attribute::tangent4, 3, at, w.data(), block_.count);
    }
  }

  void write_point(std::size_t at, std::size_t i) {
    const auto [u, v] = points_[at + i];
    surface_.point(surface_.surface, u, v, outputs_.attributes(), options_.sign, values_);
    for (std::size_t a = 0; a < attribute_count; ++a)
      if (const auto attribute = static_cast<Attribute>(a); outputs_.attributes().has(attribute))
        for (std::size_t c = 0; c < info_of(attribute).components; ++c)
          write(attribute, c, at + i, &values_.values[a][c], 1);
    statuses_.set(i, values_.status);
  }

  Place place_;
  const detail::ErasedSurface<T>& surface_;
  detail::ErasedSurface<T> base_;
  typename AffineMap<T>::template NormalMap<T> normals_;
  const Points<T>& points_;
  const Outputs<T>& outputs_;
  EvaluateOptions options_;
  Outputs<T> base_outputs_;
  kernels::PlacedBlock<T> block_{};
  Statuses<T> statuses_;
  detail::PointValues<T> values_;
  std::array<Status, kernels::placed_points> base_statuses_{};
  std::array<bool, kernels::placed_points + batch_size<T>> left_{};
  alignas(line) std::array<std::array<T, kernels::placed_points + batch_size<T>>, kernels::placed_rows> rows_;
};

}  // namespace darboux::evaluation
