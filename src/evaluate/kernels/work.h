/// \file work.h
/// The interface between evaluate.cpp, which knows requests, layouts and threads, and the kernels, which are
/// compiled once per instruction set and know formulas. Plain data only: nothing here may be compiled
/// differently in the two.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <darboux/affine_map.h>
#include <darboux/attributes.h>

namespace darboux::kernels {

/// The destination of the components of one attribute.
enum class Arrangement : std::uint8_t {
  absent,    ///< not requested
  separate,  ///< one array per component
  packed,    ///< one array of vectors
  tiled,     ///< rows of the tile, from which the structs are written
};
template <class T>
struct Slot {
  Arrangement arrangement = Arrangement::absent;
  std::array<T*, most_components> component{};  ///< of the first point; packed: the first only
  std::size_t row = 0;                          ///< tiled: of the first component
};

/// Consecutive rows of the tile that are consecutive numbers of a struct.
template <class T>
struct Run {
  std::size_t row, count;
  T* first;               ///< of the first point
  std::ptrdiff_t stride;  ///< in bytes
};

inline constexpr std::size_t line = 64;  ///< bytes that go to memory at once
/// A line of numbers; no kernel takes more points at once.
template <class T>
inline constexpr std::size_t batch_size = line / sizeof(T);
/// Points whose sines are computed at once, before their formulas run: few, so that the processor can work on
/// both. A group with a coordinate that is not finite or outside the domain is evaluated point by point.
template <class T>
inline constexpr std::size_t group_size = 2 * batch_size<T>;

/// Coordinates of points.
template <class T>
struct Source {
  const T* values = nullptr;  ///< may be read to the end of the last group
  /// Already prepared; else null and the kernel does so. For a linear coordinate the values are.
  const T *sine = nullptr, *cosine = nullptr;
  std::size_t step = 1;  ///< 0: the same group for all points, prepared

  Source from(std::size_t point) const {
    const std::size_t by = point * step;
    return {values + by, sine != nullptr ? sine + by : nullptr, cosine != nullptr ? cosine + by : nullptr,
            step};
  }
};

/// Some points of a surface, and the destinations of their attributes.
template <class T>
struct Work {
  const void* surface = nullptr;  ///< the surface type over T that the kernel was made for
  Source<T> u, v;
  bool in_domain = false;   ///< known to be, no check needed; both coordinates are prepared
  bool v_is_needed = true;  ///< false: everything requested depends on u alone
  std::size_t count = 0;    ///< of points, at least batch_size
  std::array<Slot<T>, attribute_count> slots{};
  T* tile = nullptr;  ///< batch_size numbers per row, aligned to lines
  const Run<T>* runs = nullptr;
  std::size_t run_count = 0;
  bool raw_sign = false;  ///< tangent4 in the raw sign convention
  bool past_caches =
      false;  ///< separate and packed results go past them: the first point's are aligned to lines
  std::uint32_t* status = nullptr;  ///< of every point; zero is written by the caller, others by the kernel
  void (*scalar_fallback)(void* context, std::size_t first,
                          std::size_t count) = nullptr;  ///< does these points by themselves
  void* context = nullptr;
};

/// Computes the work's attributes.
template <class T>
struct Kernel {
  bool (*run)(const Work<T>&) = nullptr;  ///< whether a status other than zero was written
  bool writes_lines = false;              ///< whether it can pass the caches
  bool by_rows = false;                   ///< whether points of one v are worth a call of their own
};

/// The kernels compiled for a surface: by the attributes that may be requested.
enum class Variant : std::uint8_t {
  frames,      ///< tangent, bitangent, normal, handedness, tangent4
  first,       ///< those, position, dpdu, dpdv
  everything,  ///< all
};

/// Sines and cosines of the values x of a coordinate, `count` rounded up to whole registers.
template <class T>
using Prepare = void (*)(const T* x, std::size_t count, T* sine, T* cosine);

inline constexpr std::size_t most_surfaces = 64;

/// Of one surface, by Variant; without a function: point by point.
struct SurfaceKernels {
  std::array<Kernel<double>, 3> in_double;
  std::array<Kernel<float>, 3> in_float;
};

/// Rows of numbers, one per attribute's component, of some points.
enum PlacedRow : std::uint8_t {
  tangent_row = 0,
  bitangent_row = 3,
  normal_row = 6,
  handedness_row = 9,
  first_vector_row = 10,  ///< position; then dpdu, dpdv, d2pdu2, d2pduv, d2pdv2
  placed_rows = 28,
};
inline constexpr std::size_t placed_points = 256;  ///< of a block: its rows fit into the caches

/// Points of a surface that are to be placed, in place.
template <class T>
struct PlacedBlock {
  const AffineMap<T>* map;
  const typename AffineMap<T>::template NormalMap<T>* normals;
  std::size_t count;      ///< of points; rows are read to the end of the last batch
  bool frames;            ///< tangent, normal and handedness are given, and moved; the bitangent is computed
  std::uint32_t vectors;  ///< bit k: row first_vector_row + 3 k is given
  std::array<T, placed_points + batch_size<T>>* rows;
  bool* left;  ///< of each point, to be set where it is left to the single-point functions
};

/// The kernels of one instruction set.
struct Kernels {
  std::array<Prepare<double>, 4> prepare_double;  ///< by Coordinate
  std::array<Prepare<float>, 4> prepare_float;
  std::array<const SurfaceKernels*, most_surfaces> surface;  ///< by the catalogue's order
  void (*place_double)(const PlacedBlock<double>&);
  void (*place_float)(const PlacedBlock<float>&);
  bool pass_caches;  ///< whether stream_lines can
  /// Copies whole lines past the caches; both addresses are aligned to them.
  void (*stream_lines)(char* to, const char* from, std::size_t lines);
  /// Orders streamed data before subsequent writes of this thread.
  void (*fence)();
};

}  // namespace darboux::kernels
