/// \file accessor.h
/// Reads glTF accessors: bytes of a buffer as typed numbers.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "gltf_file.h"

namespace darboux::io {

static_assert(std::endian::native == std::endian::little,
              "glTF buffers are little-endian and copied as they are");

/// The elements of an accessor, tightly packed, with sparse values applied.
struct Accessor {
  std::string type;  ///< "SCALAR", "VEC2", ... "MAT4"
  std::uint64_t component_type = component_f32;
  std::size_t components = 0;  ///< numbers per element
  bool normalized = false;
  std::size_t count = 0;          ///< elements
  std::size_t element_bytes = 0;  ///< size of one element, with the padding of matrix columns
  std::string bytes;              ///< count * element_bytes of them
};

/// Calls f with a zero of the C++ type that corresponds to a glTF component type.
template <class F>
void with_component(std::uint64_t component_type, F&& f) {
  switch (component_type) {
    case component_i8:
      return f(std::int8_t{});
    case component_u8:
      return f(std::uint8_t{});
    case component_i16:
      return f(std::int16_t{});
    case component_u16:
      return f(std::uint16_t{});
    case component_u32:
      return f(std::uint32_t{});
    default:
      return f(float{});
  }
}

/// Component `component` of element `element`, of the type T that with_component gave.
template <class T>
T raw_component(const Accessor& accessor, std::size_t element, std::size_t component) {
  T value;
  std::memcpy(&value, accessor.bytes.data() + element * accessor.element_bytes + component * sizeof(T),
              sizeof(T));
  return value;
}

/// The type and layout of the elements of an accessor, without their values. \throws FileError
Accessor accessor_layout(const JsonCursor& accessor);

/// Reads the accessor with the given index. Its size is checked against the available bytes before
/// allocation. An accessor without a bufferView is all zeros, limited to 1 MiB plus four times the size of
/// the file's buffers: an attribute takes at most 16 bytes per vertex, and the other data of a vertex rarely
/// less than 4. \throws FileError
Accessor read_accessor(const GltfFile& file, const JsonCursor& index);

/// A view of the elements in the buffer, checked as by read_accessor(). Empty if they must be copied: for
/// sparse accessors, accessors without a bufferView, and strided elements. \param layout accessor_layout() of
/// the accessor
/// \throws FileError
std::string_view elements_in_place(const GltfFile& file, const JsonCursor& index, const Accessor& layout);

/// The numbers of a SCALAR or VEC accessor, in order, with normalised integers dequantised. \param values
/// receives count * components numbers
void numbers(const Accessor& accessor, std::span<double> values);

/// Unsigned integers of a SCALAR accessor.
std::vector<std::uint32_t> unsigned_integers(const Accessor& accessor);

}  // namespace darboux::io
