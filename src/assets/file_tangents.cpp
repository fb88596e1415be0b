#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <darboux/file_tangents.h>
#include <darboux/split_vertices.h>

#include "assets/texture_uvs.h"
#include "io/float_mesh.h"
#include "io/gltf_file.h"
#include "mesh/frames/mikktspace_frames.h"
#include "mesh/mikktspace/buffer.h"
#include "mesh/vertex_split.h"

namespace darboux {
namespace {

template <class Vector>
void add(std::vector<Vector>& values, const std::vector<Vector>& deltas) {
  for (std::size_t i = 0; i < deltas.size(); ++i) values[i] = values[i] + deltas[i];
}

// The mesh with a target applied at weight 1.
Mesh morphed(const Mesh& mesh, const MorphTarget& target) {
  Mesh result = mesh;
  add(result.positions, target.positions);
  add(result.uvs, target.uvs);
  add(result.normals, target.normals);
  if (!target.normals.empty())
    for (auto& n : result.normals)
      if (const double length = norm(n); length > 0) n = n / length;
  return result;
}

Vec3<float> to_float(const Vec3<double>& a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

// The values of all corners of a primitive: x, y, z, w of the tangent, then x, y, z of each target's delta.
class CornerTangents {
 public:
  CornerTangents(std::size_t corners, std::size_t targets)
      : width_(4 + 3 * targets), values_(corners * width_) {
    if (targets > 0) std::fill_n(values_.data(), values_.size(), 0.0F);
  }

  void set_base(std::size_t corner, const Vec3<float>& t, float w) {
    float* p = values_.data() + corner * width_;
    std::tie(p[0], p[1], p[2], p[3]) = std::tie(t.x, t.y, t.z, w);
  }
  Vec4<float> base(std::size_t corner) const {
    const float* p = values_.data() + corner * width_;
    return {p[0], p[1], p[2], p[3]};
  }
  void set_delta(std::size_t corner, std::size_t target, const Vec3<float>& delta) {
    float* p = values_.data() + corner * width_ + 4 + 3 * target;
    std::tie(p[0], p[1], p[2]) = std::tie(delta.x, delta.y, delta.z);
  }
  Vec3<float> delta(std::size_t corner, std::size_t target) const {
    const float* p = values_.data() + corner * width_ + 4 + 3 * target;
    return {p[0], p[1], p[2]};
  }
  std::span<const float> values() const { return {values_.data(), values_.size()}; }

 private:
  std::size_t width_;
  mikk::Buffer<float> values_;
};

// Perpendicular to the stored normal, if any, as readers of the file expect. Polynomials and some fragment
// methods have their own normal.
Vec3<double> perpendicular_to_stored(const Mesh& mesh, std::uint32_t v, const Vec3<double>& t) {
  if (mesh.normals.empty()) return t;
  const Vec3<double>& n = mesh.normals[v];
  constexpr double rounding = 1e-6;
  if (!(std::fabs(dot(t, n)) > rounding * norm(t) * norm(n))) return t;
  const Vec3<double> s = t - (dot(t, n) / dot(n, n)) * n;
  constexpr double least = 1e-3;  // along the normal there is no direction
  return norm(s) > least * norm(t) ? s / norm(s) : t;
}

// A vertex that no corner uses gets a valid direction, which nothing reads.
constexpr Vec4<float> unused{1, 0, 0, 1};

template <class T>
io::Piece as_piece(mikk::Buffer<T> values) {
  const auto kept = std::make_shared<const mikk::Buffer<T>>(std::move(values));
  return {{reinterpret_cast<const char*>(kept->data()), kept->size() * sizeof(T)}, kept};
}

// of(corner) at each vertex.
template <class T, class Of>
mikk::Buffer<T> by_vertex(const SplitVertices& split, const T& without_corner, const Of& of) {
  mikk::Buffer<T> values(split.source.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = split.corner[i] == SplitVertices::no_corner ? without_corner : of(split.corner[i]);
  return values;
}

void store(GltfDocument& document, const Primitive& p, std::size_t old_vertices, const SplitVertices& split,
           mikk::Buffer<Vec4<float>> base, const std::vector<io::Piece>& deltas = {}) {
  if (split.source.size() > old_vertices)
    document.remap_vertices(p.mesh, p.primitive, split.source, split.indices, true);
  document.file().set_tangents(p.mesh, p.primitive, as_piece(std::move(base)), deltas);
}

void flip_signs(mikk::VertexTangents& tangents) {
  for (mikk::Buffer<Vec4<float>>* const values : {&tangents.of_vertices, &tangents.of_corners})
    for (std::size_t i = 0; i < values->size(); ++i) (*values)[i].w *= -1;
  for (mikk::CornerTangent& other : tangents.others) other.tangent.w *= -1;
}

// The number of vertices.
std::size_t store_by_vertex(GltfDocument& document, const Primitive& p,
                            std::span<const std::uint32_t> corners, mikk::VertexTangents tangents) {
  mikk::Buffer<Vec4<float>>& base = tangents.of_vertices;
  const std::size_t vertices = base.size();
  for (std::size_t v = 0; v < vertices; ++v)
    if (base[v].w == 0) base[v] = unused;
  SplitVertices split;
  if (!tangents.others.empty()) {
    split.source.resize(vertices);
    std::iota(split.source.begin(), split.source.end(), 0U);
    split.corner.assign(vertices, SplitVertices::no_corner);  // not read
    split.indices.assign(corners.begin(), corners.end());
    std::vector<std::uint32_t> others;
    for (const mikk::CornerTangent& other : tangents.others) others.push_back(other.corner);
    const auto of_corner = [&](std::uint32_t corner) -> const Vec4<float>& {
      return std::ranges::lower_bound(tangents.others, corner, {}, &mikk::CornerTangent::corner)->tangent;
    };
    split_off(split, corners, std::move(others), [&](std::uint32_t a, std::uint32_t b) {
      return std::memcmp(&of_corner(a), &of_corner(b), sizeof(Vec4<float>));
    });
    mikk::Buffer<Vec4<float>> all(split.source.size());
    std::copy_n(base.data(), vertices, all.data());
    for (std::size_t v = vertices; v < all.size(); ++v) all[v] = of_corner(split.corner[v]);
    base = std::move(all);
  }
  const std::size_t count = base.size();
  store(document, p, vertices, split, std::move(base));
  return count;
}

// For a primitive whose floats are used in place: only what is written is copied.
PrimitiveTangents give_tangents(GltfDocument& document, const Primitive& p, const io::FloatMesh& mesh,
                                const FileTangentOptions& options) {
  const std::size_t corners = 3 * mesh.triangles;
  const bool in_order = mesh.corners.span().empty();
  const std::size_t vertices = in_order ? corners : mesh.vertices;
  const std::span<const std::uint32_t> indices =
      in_order ? mesh.corners.span() : mesh.corners.span().first(corners);
  MikktspaceTangents tangents = mikktspace_tangents({mesh.positions.span().first(3 * vertices),
                                                     mesh.normals.span().first(3 * vertices),
                                                     mesh.uvs.span().first(2 * vertices),
                                                     indices,
                                                     {}},
                                                    options.threads);
  if (options.sign == SignConvention::gltf) flip_signs(tangents);

  PrimitiveTangents result{.mesh = p.mesh,
                           .primitive = p.primitive,
                           .name = p.name,
                           .corners = corners,
                           .old_vertices = mesh.vertices,
                           .vertices = mesh.vertices,
                           .degenerate_triangles = tangents.counts.degenerate_triangles,
                           .degenerate_uv_triangles = tangents.counts.degenerate_uv_triangles,
                           .fallback_corners = tangents.counts.fallback_corners};
  if (in_order && corners == mesh.vertices) {
    document.file().set_tangents(p.mesh, p.primitive, as_piece(std::move(tangents.of_corners)), {});
  } else if (in_order) {
    mikk::Buffer<Vec4<float>> base(mesh.vertices);
    std::copy_n(tangents.of_corners.data(), corners, base.data());
    std::fill_n(base.data() + corners, mesh.vertices - corners, unused);
    document.file().set_tangents(p.mesh, p.primitive, as_piece(std::move(base)), {});
  } else if (!tangents.of_corners.empty()) {
    const std::span<const float> values(&tangents.of_corners.data()->x, 4 * corners);
    const SplitVertices split = split_vertices(mesh.vertices, indices, values);
    store(document, p, mesh.vertices, split,
          by_vertex(split, unused, [&](std::size_t corner) { return tangents.of_corners[corner]; }));
    result.vertices = split.source.size();
  } else {
    result.vertices = store_by_vertex(document, p, indices, std::move(tangents));
  }
  return result;
}

PrimitiveTangents give_tangents(GltfDocument& document, const Primitive& p,
                                const FileTangentOptions& options) {
  const FrameMethod& method = find_frame_method(options.method);
  const std::string name = document.path() + ": meshes[" + std::to_string(p.mesh) + "].primitives[" +
                           std::to_string(p.primitive) + "]";
  check_finite(p.data, name);
  Mesh mesh = p.data;
  transform_uvs(mesh, p);
  check_finite(mesh, name + " after KHR_texture_transform");
  const std::vector<MorphTarget> targets = document.morph_targets(p);

  const MeshFrames frames = mesh_frames(mesh, method, options.threads);
  CornerTangents tangents(mesh.corners(), targets.size());
  const float to_stored = options.sign == SignConvention::raw ? 1.0f : -1.0f;
  for (std::size_t c = 0; c < mesh.corners(); ++c)
    tangents.set_base(
        c, to_float(perpendicular_to_stored(mesh, mesh.triangles[c / 3][c % 3], frames.corner(c).t)),
        to_stored * static_cast<float>(frames.corner(c).sign));
  for (std::size_t k = 0; k < targets.size(); ++k) {
    Mesh moved = morphed(p.data, targets[k]);
    transform_uvs(moved, p);
    check_finite(moved, name + " with targets[" + std::to_string(k) + "]");
    const MeshFrames moved_frames = mesh_frames(moved, method, options.threads);
    for (std::size_t c = 0; c < mesh.corners(); ++c)
      if (const CornerFrame& frame = moved_frames.corner(c); !frame.fallback)
        tangents.set_delta(c, k,
                           to_float(perpendicular_to_stored(moved, moved.triangles[c / 3][c % 3], frame.t)) -
                               tangents.base(c).xyz());
  }

  std::span<const std::uint32_t> corners;
  if (!mesh.triangles.empty()) corners = {mesh.triangles.front().data(), mesh.corners()};
  const SplitVertices split = split_vertices(mesh.positions.size(), corners, tangents.values());
  std::vector<io::Piece> deltas;
  for (std::size_t k = 0; k < targets.size(); ++k)
    deltas.push_back(as_piece(
        by_vertex(split, Vec3<float>{}, [&](std::size_t corner) { return tangents.delta(corner, k); })));
  store(document, p, mesh.positions.size(), split,
        by_vertex(split, unused, [&](std::size_t corner) { return tangents.base(corner); }), deltas);
  return {.mesh = p.mesh,
          .primitive = p.primitive,
          .name = p.name,
          .corners = mesh.corners(),
          .old_vertices = mesh.positions.size(),
          .vertices = split.source.size(),
          .morph_targets = targets.size(),
          .degenerate_triangles = frames.degenerate_triangles,
          .degenerate_uv_triangles = frames.degenerate_uv_triangles,
          .fallback_corners = frames.fallback_corners};
}

}  // namespace

FileTangents add_tangents(GltfDocument& document, const FileTangentOptions& options) {
  find_frame_method(options.method);  // unknown names are refused in files without primitives too
  // MikkTSpace works on floats and needs no doubles.
  std::vector<std::optional<io::FloatMesh>> floats;
  const Asset asset = io::read_gltf(document.file(), options.method == "mikktspace" ? &floats : nullptr);
  floats.resize(asset.primitives.size());
  FileTangents result;
  result.skipped = asset.skipped;
  for (std::size_t i = 0; i < asset.primitives.size(); ++i) {
    const Primitive& p = asset.primitives[i];
    const std::optional<io::FloatMesh>& mesh = floats[i];
    const auto skip = [&](const char* reason) { result.skipped.push_back({p.mesh, p.primitive, reason}); };
    if (options.only_needed && !p.needs_tangents.value_or(true)) {
      skip("its material reads no tangents");
    } else if (mesh) {
      result.primitives.push_back(give_tangents(document, p, *mesh, options));
    } else if (p.data.uvs.empty() || p.data.normals.empty()) {
      skip(p.data.uvs.empty() ? "has no uvs" : "has no normals");
      ++result.incapable;
    } else {
      result.primitives.push_back(give_tangents(document, p, options));
    }
    if (options.progress)
      options.progress(static_cast<double>(i + 1) / static_cast<double>(asset.primitives.size()));
  }
  std::sort(result.skipped.begin(), result.skipped.end(), [](const auto& a, const auto& b) {
    return std::pair(a.mesh, a.primitive) < std::pair(b.mesh, b.primitive);
  });
  return result;
}

}  // namespace darboux
