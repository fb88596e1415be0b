#include "accessor.h"

#include <algorithm>
#include <type_traits>

namespace darboux::io {
namespace {

struct Shape {
  const char* type;
  std::size_t columns, rows;
};
constexpr Shape shapes[] = {{"SCALAR", 1, 1}, {"VEC2", 1, 2}, {"VEC3", 1, 3}, {"VEC4", 1, 4},
                            {"MAT2", 2, 2},   {"MAT3", 3, 3}, {"MAT4", 4, 4}};

constexpr std::size_t round_up_4(std::size_t n) {
  return (n + 3) / 4 * 4;
}

std::size_t component_bytes(const JsonCursor& component_type) {
  switch (component_type.integer()) {
    case component_i8:
    case component_u8:
      return 1;
    case component_i16:
    case component_u16:
      return 2;
    case component_u32:
    case component_f32:
      return 4;
    default:
      component_type.fail("5120, 5121, 5122, 5123, 5125 or 5126");
  }
}

/// The bytes of a bufferView and its stride; 0 if the elements are tightly packed.
struct View {
  std::string_view bytes;
  std::size_t stride = 0;
};

View read_view(const GltfFile& file, const JsonCursor& index) {
  const JsonCursor view = file.element("bufferViews", index);
  const std::size_t stride = view.has("byteStride") ? view.at("byteStride").integer(4, 252) : 0;
  return {file.view_bytes(view), stride};
}

/// `count` > 0 elements of `size` bytes at a place that names a bufferView and a byteOffset, including the
/// bytes between them. The bounds are checked in an order that cannot overflow.
View find_elements(const GltfFile& file, const JsonCursor& place, std::uint64_t count, std::size_t size) {
  const View view = read_view(file, place.at("bufferView"));
  const std::uint64_t offset = place.integer_or("byteOffset", 0);
  const std::size_t stride = view.stride == 0 ? size : view.stride;
  if (stride < size)
    place.fail(
        "elements of at most the " + std::to_string(stride) + " bytes of the byteStride of its bufferView",
        std::to_string(size) + " bytes");
  if (offset > view.bytes.size() || size > view.bytes.size() - offset ||
      count - 1 > (view.bytes.size() - offset - size) / stride)
    place.fail("elements within the " + std::to_string(view.bytes.size()) + " bytes of its bufferView",
               std::to_string(count) + " elements of " + std::to_string(size) + " bytes from byte " +
                   std::to_string(offset));
  return {view.bytes.substr(offset, (count - 1) * stride + size), stride};
}

/// A copy of them, tightly packed.
std::string read_elements(const GltfFile& file, const JsonCursor& place, std::uint64_t count,
                          std::size_t size) {
  const View there = find_elements(file, place, count, size);
  if (there.stride == size) return std::string(there.bytes);
  std::string bytes(count * size, '\0');
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(bytes.data() + i * size, there.bytes.data() + i * there.stride, size);
  return bytes;
}

std::string zeros(const GltfFile& file, const JsonCursor& accessor, std::uint64_t count, std::size_t size) {
  std::uint64_t most = std::uint64_t{1} << 20;
  for (const auto& buffer : file.buffers) most += buffer ? 4 * buffer->size() : 0;
  if (count > most / size)
    accessor.fail("at most " + std::to_string(most) + " bytes without a bufferView for a file of this size",
                  std::to_string(count) + " elements of " + std::to_string(size) + " bytes");
  return std::string(count * size, '\0');
}

void overlay_sparse(const GltfFile& file, const JsonCursor& sparse, Accessor& accessor) {
  Accessor indices;
  indices.count = sparse.at("count").integer(1, accessor.count);
  indices.components = 1;
  const JsonCursor places = sparse.at("indices");
  const JsonCursor type = places.at("componentType");
  indices.component_type = type.integer();
  indices.element_bytes = component_bytes(type);
  if (indices.component_type != component_u8 && indices.component_type != component_u16 &&
      indices.component_type != component_u32)
    type.fail("5121, 5123 or 5125");
  indices.bytes = read_elements(file, places, indices.count, indices.element_bytes);
  const std::string values = read_elements(file, sparse.at("values"), indices.count, accessor.element_bytes);
  const std::vector<std::uint32_t> elements = unsigned_integers(indices);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (elements[i] >= accessor.count)
      places.fail("elements below " + std::to_string(accessor.count), std::to_string(elements[i]));
    std::memcpy(accessor.bytes.data() + elements[i] * accessor.element_bytes,
                values.data() + i * accessor.element_bytes, accessor.element_bytes);
  }
}

}  // namespace

Accessor accessor_layout(const JsonCursor& place) {
  const JsonCursor component_type = place.at("componentType");
  const std::size_t size = component_bytes(component_type);
  const JsonCursor type = place.at("type");
  const auto* shape = std::find_if(std::begin(shapes), std::end(shapes),
                                   [&](const Shape& s) { return type.text() == s.type; });
  if (shape == std::end(shapes)) type.fail("SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");

  Accessor accessor;
  accessor.type = shape->type;
  accessor.component_type = component_type.integer();
  accessor.components = shape->columns * shape->rows;
  accessor.normalized = place.has("normalized") && place.at("normalized").boolean();
  accessor.count = place.at("count").integer(1);
  // Columns of a matrix are aligned to 4 bytes.
  accessor.element_bytes =
      shape->columns == 1 ? shape->rows * size : shape->columns * round_up_4(shape->rows * size);
  return accessor;
}

Accessor read_accessor(const GltfFile& file, const JsonCursor& index) {
  const JsonCursor place = file.element("accessors", index);
  Accessor accessor = accessor_layout(place);
  accessor.bytes = place.has("bufferView")
                       ? read_elements(file, place, accessor.count, accessor.element_bytes)
                       : zeros(file, place, accessor.count, accessor.element_bytes);
  if (place.has("sparse")) overlay_sparse(file, place.at("sparse"), accessor);
  return accessor;
}

std::string_view elements_in_place(const GltfFile& file, const JsonCursor& index, const Accessor& layout) {
  const JsonCursor place = file.element("accessors", index);
  if (!place.has("bufferView") || place.has("sparse")) return {};
  const View there = find_elements(file, place, layout.count, layout.element_bytes);
  return there.stride == layout.element_bytes ? there.bytes : std::string_view();
}

void numbers(const Accessor& accessor, std::span<double> values) {
  with_component(accessor.component_type, [&](auto zero) {
    using T = decltype(zero);
    const bool scaled = accessor.normalized && sizeof(T) < 4;
    const double largest = scaled ? static_cast<double>(std::numeric_limits<T>::max()) : 1.0;
    for (std::size_t i = 0, element = 0; element < accessor.count; ++element)
      for (std::size_t k = 0; k < accessor.components; ++k, ++i) {
        values[i] = static_cast<double>(raw_component<T>(accessor, element, k));
        // The most negative integer also stands for -1.
        if (scaled) values[i] = std::max(values[i] / largest, -1.0);
      }
  });
}

std::vector<std::uint32_t> unsigned_integers(const Accessor& accessor) {
  std::vector<std::uint32_t> values(accessor.count);
  with_component(accessor.component_type, [&](auto zero) {
    using T = decltype(zero);
    if constexpr (std::is_unsigned_v<T>)
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = raw_component<T>(accessor, i, 0);
  });
  return values;
}

}  // namespace darboux::io
