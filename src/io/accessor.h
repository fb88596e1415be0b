/// \file accessor.h
/// The typed accessor reader: bytes of a glTF buffer as numbers.
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

/// An accessor's elements, strides removed and sparse values laid over.
struct Accessor {
  std::string type;  ///< "SCALAR", "VEC2", ... "MAT4"
  std::uint64_t component_type = component_f32;
  std::size_t components = 0;  ///< numbers per element
  bool normalized = false;
  std::size_t count = 0;          ///< elements
  std::size_t element_bytes = 0;  ///< size of one element, with the padding of matrix columns
  std::string bytes;              ///< count * element_bytes of them
};

/// Calls f with a zero of the C++ type that a glTF component type stands for.
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

/// What an accessor states of its elements, without them. \throws FileError
Accessor accessor_layout(const JsonCursor& accessor);

/// The accessor that `index` names, checked against the bytes there are before anything is allocated. One
/// without a bufferView is zeros, at most 1 MiB and four times the file's buffers of them: an attribute of a
/// vertex takes at most 16 bytes, and what else a file stores of a vertex seldom less than 4. \throws
/// FileError
Accessor read_accessor(const GltfFile& file, const JsonCursor& index);

/// Its elements where they lie, checked as read_accessor() does; nothing where they are to be read: those of
/// sparse accessors, without a bufferView, or apart from each other. \param layout accessor_layout() of it
/// \throws FileError
std::string_view elements_in_place(const GltfFile& file, const JsonCursor& index, const Accessor& layout);

/// The numbers of a SCALAR or VEC accessor, in order; normalised integers as what they stand for.
/// \param values count * components of them
void numbers(const Accessor& accessor, std::span<double> values);

/// Unsigned integers of a SCALAR accessor.
std::vector<std::uint32_t> unsigned_integers(const Accessor& accessor);

}  // namespace darboux::io
