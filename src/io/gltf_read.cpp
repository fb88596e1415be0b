// Meshes and nodes of a glTF document as an Asset.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <type_traits>

#include <Eigen/Geometry>

#include <darboux/error.h>

#include "accessor.h"
#include "budget.h"
#include "float_mesh.h"
#include "half_step.h"
#include "mesh_files.h"
#include "tangent_space.h"

namespace darboux::io {
namespace {

constexpr std::array mode_names = {"points",    "lines",          "line loop",   "line strip",
                                   "triangles", "triangle strip", "triangle fan"};

void check_attribute(const Accessor& accessor, const JsonCursor& index, const char* type,
                     std::uint64_t vertices) {
  if (accessor.type != type) index.fail(std::string("an accessor of type ") + type, accessor.type);
  if (vertices != 0 && accessor.count != vertices)
    index.fail("an accessor of as many elements as POSITION's, " + std::to_string(vertices),
               std::to_string(accessor.count));
}

Accessor read_attribute(const GltfFile& file, const JsonCursor& attributes, const std::string& name,
                        const char* type, std::uint64_t vertices) {
  const JsonCursor index = attributes.at(name.c_str());
  Accessor accessor = read_accessor(file, index);
  check_attribute(accessor, index, type, vertices);
  return accessor;
}

// Elements in place, as numbers of type T; none if they have to be copied.
template <class T>
std::span<const T> numbers_in_place(const GltfFile& file, const JsonCursor& index, const Accessor& layout) {
  const std::string_view bytes = elements_in_place(file, index, layout);
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(T) != 0) return {};
  return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

InPlace<std::uint32_t> read_indices(const GltfFile& file, const JsonCursor& primitive,
                                    std::uint64_t vertices) {
  const JsonCursor index = primitive.at("indices");
  const Accessor layout = accessor_layout(file.element("accessors", index));
  const std::uint64_t type = layout.component_type;
  const bool are_indices =
      layout.type == "SCALAR" && (type == component_u8 || type == component_u16 || type == component_u32);
  std::span<const std::uint32_t> there;
  if (are_indices && type == component_u32) there = numbers_in_place<std::uint32_t>(file, index, layout);
  Accessor accessor;
  if (there.empty()) accessor = read_accessor(file, index);
  if (!are_indices)
    index.fail("an accessor of type SCALAR and componentType 5121, 5123 or 5125",
               layout.type + " and " + std::to_string(type));
  auto indices = there.empty() ? InPlace<std::uint32_t>(unsigned_integers(accessor)) : InPlace(there);
  const std::span<const std::uint32_t> corners = indices.span();
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (corners[i] >= vertices)
      index.fail("indices below " + std::to_string(vertices),
                 std::to_string(corners[i]) + " at place " + std::to_string(i));
  return indices;
}

/// Triangles in glTF's winding (section 3.7.2.1): a strip reverses every other triangle, a fan ends with its
/// hub.
/// \param leftover receives the number of corners at the end that make no whole triangle
std::vector<Triangle> make_triangles(std::uint64_t mode, std::span<const std::uint32_t> corners,
                                     std::size_t& leftover) {
  const std::size_t n = corners.size();
  std::vector<Triangle> result;
  if (mode == triangles) {
    leftover = n % 3;
    result.reserve(n / 3);
    for (std::size_t i = 0; i + 2 < n; i += 3) result.push_back({corners[i], corners[i + 1], corners[i + 2]});
    return result;
  }
  leftover = n < 3 ? n : 0;
  if (n < 3) return result;
  result.reserve(n - 2);
  for (std::size_t i = 0; i + 2 < n; ++i) {
    if (mode == triangle_strip)
      result.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    else
      result.push_back({corners[i + 1], corners[i + 2], corners[0]});
  }
  return result;
}

template <class Vector>
std::vector<Vector> gather(const Accessor& accessor) {
  std::vector<Vector> vectors(accessor.count);
  if (!vectors.empty()) numbers(accessor, {&vectors[0].x, accessor.count * sizeof(Vector) / sizeof(double)});
  return vectors;
}

std::string uv_name(int set) {
  return "TEXCOORD_" + std::to_string(set);
}

/// The uvs that tangents follow: those that its materials name, else the first set.
void choose_uvs(const GltfFile& file, const JsonCursor& place, Primitive& primitive) {
  const TangentSpace space = tangent_space(file, place);
  primitive.needs_tangents = space.needed;
  for (const std::uint64_t set : {space.texcoord, std::uint64_t{0}}) {
    if (primitive.texcoord >= 0 || !place.at("attributes").has("TEXCOORD_" + std::to_string(set))) continue;
    primitive.texcoord = static_cast<int>(set);
    primitive.names_uv_set = space.names && set == space.texcoord;
    if (primitive.names_uv_set) primitive.texture_transform = space.transform;
  }
  if (space.names && !primitive.names_uv_set) primitive.missing_texcoord = space.texcoord;
}

/// The other uv sets that stored tangents may follow.
std::vector<int> other_uv_sets(const JsonCursor& attributes, const Primitive& primitive) {
  std::vector<int> sets;
  for (int set = 0; set < most_uv_sets && primitive.texcoord >= 0; ++set)
    if (set != primitive.texcoord && attributes.has(uv_name(set))) sets.push_back(set);
  return sets;
}

void read_triangles(const GltfFile& file, const JsonCursor& place, std::uint64_t mode, Primitive& primitive) {
  const JsonCursor attributes = place.at("attributes");
  Mesh& mesh = primitive.data;
  const auto read = [&](const std::string& name, const char* type, std::size_t count, auto& values,
                        double& step) {
    const Accessor accessor = read_attribute(file, attributes, name, type, count);
    values = gather<typename std::remove_reference_t<decltype(values)>::value_type>(accessor);
    const auto decoded = file.half_steps.find(attributes.at(name.c_str()).integer());
    const bool directions = name == "NORMAL" || name == "TANGENT";
    step = decoded != file.half_steps.end() ? decoded->second
           : directions                     ? half_step_of_directions(accessor)
                                            : half_step(accessor);
  };
  read("POSITION", "VEC3", 0, mesh.positions, mesh.half_steps.position);
  const std::size_t vertices = mesh.positions.size();
  if (attributes.has("NORMAL")) read("NORMAL", "VEC3", vertices, mesh.normals, mesh.half_steps.normal);
  if (attributes.has("TANGENT")) read("TANGENT", "VEC4", vertices, mesh.tangents, mesh.half_steps.tangent);
  choose_uvs(file, place, primitive);
  if (primitive.texcoord >= 0)
    read(uv_name(primitive.texcoord), "VEC2", vertices, mesh.uvs, mesh.half_steps.uv);
  if (!mesh.tangents.empty())
    for (const int set : other_uv_sets(attributes, primitive))
      primitive.other_uvs.emplace_back(
          set, gather<Vec2<double>>(read_attribute(file, attributes, uv_name(set), "VEC2", vertices)));
  if (place.has("targets") && place.at("targets").is_array())
    primitive.morph_targets = place.at("targets").size();
  if (place.has("indices")) {
    const InPlace<std::uint32_t> corners = read_indices(file, place, vertices);
    mesh.triangles = make_triangles(mode, corners.span(), primitive.leftover_indices);
  } else {
    std::vector<std::uint32_t> corners(vertices);
    std::iota(corners.begin(), corners.end(), std::uint32_t{0});
    mesh.triangles = make_triangles(mode, corners, primitive.leftover_indices);
  }
}

// Whether positions, normals and uvs are stored as floats that tangents use unchanged.
bool stored_as_floats(const GltfFile& file, const JsonCursor& place, std::uint64_t mode,
                      const Primitive& primitive) {
  const JsonCursor attributes = place.at("attributes");
  if (mode != triangles || place.has("targets") || primitive.texcoord < 0 || primitive.texture_transform ||
      !attributes.has("NORMAL"))
    return false;
  for (const std::string& name :
       {std::string("POSITION"), std::string("NORMAL"), uv_name(primitive.texcoord)})
    if (accessor_layout(file.element("accessors", attributes.at(name))).component_type != component_f32)
      return false;
  return true;
}

// Finite, and at full precision: not all below 2^-100.
bool are_ordinary(std::span<const float> values, bool any_scale) {
  std::uint32_t greatest = 0;
  for (const float x : values) greatest = std::max(greatest, std::bit_cast<std::uint32_t>(x) & 0x7fffffffU);
  const float size = std::bit_cast<float>(greatest);
  return std::isfinite(size) && (any_scale || size == 0 || size >= 0x1p-100F);
}

}  // namespace

std::optional<FloatMesh> read_float_mesh(const GltfFile& file, const JsonCursor& place, std::uint64_t mode,
                                         Primitive& primitive) {
  Primitive found;
  choose_uvs(file, place, found);
  if (!stored_as_floats(file, place, mode, found)) return std::nullopt;
  FloatMesh mesh;
  const JsonCursor attributes = place.at("attributes");
  const auto read = [&](const std::string& name, const char* type) {
    const JsonCursor index = attributes.at(name);
    const Accessor layout = accessor_layout(file.element("accessors", index));
    const std::span<const float> there = numbers_in_place<float>(file, index, layout);
    Accessor accessor;
    if (there.empty()) accessor = read_accessor(file, index);
    check_attribute(layout, index, type, mesh.vertices);
    mesh.vertices = layout.count;
    if (!there.empty()) return InPlace<float>(there);
    std::vector<float> copy(accessor.bytes.size() / sizeof(float));
    std::memcpy(copy.data(), accessor.bytes.data(), accessor.bytes.size());
    return InPlace<float>(std::move(copy));
  };
  mesh.positions = read("POSITION", "VEC3");
  mesh.normals = read("NORMAL", "VEC3");
  const auto check = [&](const std::string& name, const char* type) {
    const JsonCursor index = attributes.at(name);
    const Accessor layout = accessor_layout(file.element("accessors", index));
    if (elements_in_place(file, index, layout).empty()) read_accessor(file, index);
    check_attribute(layout, index, type, mesh.vertices);
  };
  if (attributes.has("TANGENT")) check("TANGENT", "VEC4");
  mesh.uvs = read(uv_name(found.texcoord), "VEC2");
  if (attributes.has("TANGENT"))
    for (const int set : other_uv_sets(attributes, found)) check(uv_name(set), "VEC2");
  if (place.has("indices")) mesh.corners = read_indices(file, place, mesh.vertices);
  const std::size_t corners = place.has("indices") ? mesh.corners.span().size() : mesh.vertices;
  mesh.triangles = corners / 3;
  if (mesh.triangles == 0 || !are_ordinary(mesh.positions.span(), false) ||
      !are_ordinary(mesh.normals.span(), true) || !are_ordinary(mesh.uvs.span(), false))
    return std::nullopt;
  primitive.needs_tangents = found.needs_tangents;
  primitive.texcoord = found.texcoord;
  primitive.names_uv_set = found.names_uv_set;
  primitive.leftover_indices = corners % 3;
  return mesh;
}

namespace {

template <std::size_t N>
std::array<double, N> read_numbers(const JsonCursor& place) {
  if (place.size() != N) place.fail(std::to_string(N) + " numbers", std::to_string(place.size()));
  std::array<double, N> values;
  for (std::size_t i = 0; i < N; ++i) values[i] = place.at(i).number();
  return values;
}

Eigen::Matrix4d local_matrix(const JsonCursor& node) {
  if (node.has("matrix"))
    return Eigen::Map<const Eigen::Matrix4d>(read_numbers<16>(node.at("matrix")).data());
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (node.has("translation")) {
    const auto t = read_numbers<3>(node.at("translation"));
    transform.translate(Eigen::Vector3d(t[0], t[1], t[2]));
  }
  if (node.has("rotation")) {
    const auto q = read_numbers<4>(node.at("rotation"));
    transform.rotate(Eigen::Quaterniond(q[3], q[0], q[1], q[2]));
  }
  if (node.has("scale")) {
    const auto s = read_numbers<3>(node.at("scale"));
    transform.scale(Eigen::Vector3d(s[0], s[1], s[2]));
  }
  return transform.matrix();
}

/// Lists of node indices: each element of the array under `key`, checked.
void append_nodes(const GltfFile& file, const JsonCursor& owner, const char* key,
                  std::vector<std::size_t>& nodes) {
  if (!owner.has(key)) return;
  const JsonCursor list = owner.at(key);
  for (std::size_t i = 0; i < list.size(); ++i) {
    file.element("nodes", list.at(i));
    nodes.push_back(list.at(i).integer());
  }
}

}  // namespace

// Whether an animation moves each node directly.
static std::vector<bool> animated_nodes(const JsonCursor& root, std::size_t nodes) {
  std::vector<bool> result(nodes, false);
  if (!root.has("animations")) return result;
  const JsonCursor animations = root.at("animations");
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const JsonCursor channels = animations.at(a).at("channels");
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const JsonCursor target = channels.at(c).at("target");
      // A pointer may refer to any of them.
      if (target.extension("KHR_animation_pointer")) result.assign(nodes, true);
      if (!target.has("node")) continue;
      const std::uint64_t node = target.at("node").integer();
      if (node < nodes) result[node] = true;
    }
  }
  return result;
}

std::vector<ShownNode> shown_nodes(const GltfFile& file) {
  const JsonCursor root = file.root();
  if (!root.has("nodes")) return {};
  const JsonCursor nodes = root.at("nodes");
  const std::size_t count = nodes.size();
  std::vector<ShownNode> shown;

  const bool has_scenes = root.has("scenes") && root.at("scenes").size() > 0;
  std::vector<std::size_t> roots;
  if (has_scenes) {
    append_nodes(
        file,
        root.has("scene") ? file.element("scenes", root.at("scene")) : root.at("scenes").at(std::size_t{0}),
        "nodes", roots);
  } else {
    std::vector<std::size_t> children;
    for (std::size_t i = 0; i < count; ++i) append_nodes(file, nodes.at(i), "children", children);
    std::vector<bool> is_child(count, false);
    for (const std::size_t child : children) is_child[child] = true;
    for (std::size_t i = 0; i < count; ++i)
      if (!is_child[i]) roots.push_back(i);
  }

  struct Visit {
    std::size_t node;
    Eigen::Matrix4d parent;
    bool moves;
    std::size_t above;  // of those shown
  };
  const std::vector<bool> animated = animated_nodes(root, count);
  std::vector<Visit> stack;
  for (auto node = roots.rbegin(); node != roots.rend(); ++node)
    stack.push_back({*node, Eigen::Matrix4d::Identity(), false, count});
  std::vector<bool> visited(count, false);
  std::size_t visits = 0;
  const auto refuse = [&](std::size_t node) {
    nodes.at(node).fail("trees of nodes", "a node that is its own ancestor or has two parents");
  };
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    if (visited[visit.node]) refuse(visit.node);
    visited[visit.node] = true;
    ++visits;
    const JsonCursor node = nodes.at(visit.node);
    const Eigen::Matrix4d world = visit.parent * local_matrix(node);
    const bool moves = visit.moves || animated[visit.node];
    const std::size_t here = shown.size();
    shown.push_back({visit.node, world, moves, std::min(visit.above, here)});
    std::vector<std::size_t> children;
    append_nodes(file, node, "children", children);
    for (auto child = children.rbegin(); child != children.rend(); ++child)
      stack.push_back({*child, world, moves, here});
  }
  // Without scenes every node descends from a root, unless it is on a cycle.
  if (!has_scenes && visits != count)
    for (std::size_t i = 0; i < count; ++i)
      if (!visited[i]) refuse(i);
  return shown;
}

namespace {

/// World matrices of the nodes that reference each mesh.
std::vector<std::vector<Eigen::Matrix4d>> read_instances(const GltfFile& file, std::size_t mesh_count) {
  std::vector<std::vector<Eigen::Matrix4d>> instances(mesh_count);
  for (const ShownNode& shown : shown_nodes(file)) {
    const JsonCursor node = file.root().at("nodes").at(shown.node);
    if (!node.has("mesh")) continue;
    file.element("meshes", node.at("mesh"));
    instances[node.at("mesh").integer()].push_back(shown.world);
  }
  return instances;
}

}  // namespace

namespace {

/// Size in bytes, including the memory for judging it. A single primitive takes at most a few times the size
/// of the file, but many may share that.
std::uint64_t size_of(const Primitive& primitive, const std::optional<FloatMesh>& floats) {
  const auto bytes = [](const auto& values) { return values.size() * sizeof(values[0]); };
  if (floats)  // as doubles, so that one limit suits all commands
    return floats->vertices * (2 * sizeof(Vec3<double>) + sizeof(Vec2<double>)) +
           triangle_bytes * floats->triangles;
  const Mesh& mesh = primitive.data;
  std::uint64_t sum = bytes(mesh.positions) + bytes(mesh.normals) + bytes(mesh.uvs) + bytes(mesh.tangents) +
                      triangle_bytes * mesh.triangles.size();
  for (const auto& [set, uvs] : primitive.other_uvs) sum += bytes(uvs);
  return sum;
}

}  // namespace

Asset read_gltf(const GltfFile& file, std::vector<std::optional<FloatMesh>>* floats) {
  Budget budget(file);
  Asset asset;
  const JsonCursor root = file.root();
  const std::size_t mesh_count = root.has("meshes") ? root.at("meshes").size() : 0;
  auto instances_of_mesh = read_instances(file, mesh_count);
  for (std::size_t m = 0; m < mesh_count; ++m) {
    const JsonCursor mesh = root.at("meshes").at(m);
    budget.take(instances_of_mesh[m].size() * sizeof(Eigen::Matrix4d), mesh, "its instances");
    const Instances instances = std::move(instances_of_mesh[m]);
    const JsonCursor primitives = mesh.at("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const JsonCursor place = primitives.at(p);
      const std::uint64_t mode = place.has("mode") ? place.at("mode").integer(0, triangle_fan) : triangles;
      if (mode < triangles) {
        asset.skipped.push_back(
            {m, p, "mode " + std::to_string(mode) + " (" + mode_names[mode] + ") has no triangles"});
        continue;
      }
      if (!place.has("attributes") || !place.at("attributes").has("POSITION")) {
        asset.skipped.push_back({m, p, "it has no POSITION"});
        continue;
      }
      Primitive& primitive = asset.primitives.emplace_back();
      primitive.mesh = m;
      primitive.primitive = p;
      if (mesh.has("name")) primitive.name = mesh.at("name").text();
      std::optional<FloatMesh> as_floats;
      if (floats != nullptr) as_floats = read_float_mesh(file, place, mode, primitive);
      if (!as_floats) read_triangles(file, place, mode, primitive);
      budget.take(size_of(primitive, as_floats), place, "its vertices and triangles");
      if (floats != nullptr) floats->push_back(std::move(as_floats));
      primitive.instances = instances;
    }
  }
  return asset;
}

std::vector<MorphTarget> read_targets(const GltfFile& file, const JsonCursor& primitive, int texcoord,
                                      std::size_t vertices) {
  if (!primitive.has("targets")) return {};
  const JsonCursor targets = primitive.at("targets");
  Budget budget(file);
  std::vector<MorphTarget> result(targets.size());
  const std::string uvs = "TEXCOORD_" + std::to_string(texcoord);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const JsonCursor target = targets.at(i);
    // Positions, normals and uvs, and the tangents computed from them, twice.
    budget.take(vertices * 4 * sizeof(Vec3<double>), target, "a morph target");
    const auto read = [&](const std::string& name, const char* type, auto& into) {
      if (target.has(name.c_str()))
        into = gather<typename std::remove_reference_t<decltype(into)>::value_type>(
            read_attribute(file, target, name, type, vertices));
    };
    read("POSITION", "VEC3", result[i].positions);
    read("NORMAL", "VEC3", result[i].normals);
    read(uvs, "VEC2", result[i].uvs);
  }
  return result;
}

}  // namespace darboux::io
