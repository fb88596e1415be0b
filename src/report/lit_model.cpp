#include "lit_model.h"

#include <cmath>
#include <numeric>
#include <string>

#include <darboux/error.h>

#include "base/bounds.h"
#include "base/text.h"
#include "normal_map/corners.h"
#include "normal_map/covered.h"
#include "normal_map/sampler.h"
#include "scene_picture.h"

namespace darboux {
namespace {

void check(const MapPiece& piece, const LitModelOptions& options) {
  const std::string name = normal_map::name_of(piece);
  const Mesh& mesh = piece.mesh;
  check_consistent(mesh, name);
  check_finite(mesh, name);
  const auto need = [&](bool there, const char* what) {
    if (!there) throw MeshError(name, expected_got(what, "none"));
  };
  need(!mesh.uvs.empty(), "uvs");
  need(!mesh.normals.empty(), "normals");
  need(options.space == MapSpace::object || options.basis == MapBasis::mikktspace || !mesh.tangents.empty(),
       "tangents, or --basis mikktspace to make them");
}

// A vertex for each corner: tangents of corners differ.
std::vector<PictureVertex> vertices_of(const MapPiece& piece, const LitModelOptions& options) {
  const bool framed = options.space == MapSpace::tangent;
  const normal_map::Corners corners(piece, framed ? options.basis : MapBasis::stored, options.threads);
  std::vector<PictureVertex> result;
  for (std::size_t i = 0; i < piece.mesh.triangles.size(); ++i) {
    std::array<normal_map::Corner, 3> of;
    if (framed) of = corners.of(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = piece.mesh.triangles[i][k];
      PictureVertex vertex{piece.mesh.positions[v], piece.mesh.normals[v], {}, piece.mesh.uvs[v]};
      if (framed) vertex.tangent = {of[k].t.x, of[k].t.y, of[k].t.z, of[k].w};
      result.push_back(vertex);
    }
  }
  return result;
}

Camera camera_of(std::span<const MapPiece> pieces, const LitModelOptions& options) {
  const Eigen::Matrix3d axes = Camera::look_at({0.5, 0.6, 1}, Eigen::Vector3d::Zero(), {0, 1, 0}).linear();
  Bounds box;
  for (const MapPiece& piece : pieces)
    for (const Vec3<double>& position : piece.mesh.positions)
      box.add(from_eigen(axes.transpose() * to_eigen(position)));
  Camera pixels;
  pixels.width_px = options.width;
  pixels.height_px = options.height;
  box.high.z += 1e-3 * box.diagonal();  // a flat model has a depth too
  return view_along(axes, box.low, box.high, pixels);
}

}  // namespace

Picture lit_model(const Image& map, std::span<const MapPiece> pieces, const LitModelOptions& options) {
  for (const MapPiece& piece : pieces) check(piece, options);
  Rasteriser rasteriser(camera_of(pieces, options));
  for (const MapPiece& piece : pieces) {
    const bool object = options.space == MapSpace::object;
    const normal_map::Sampler sampler(map, piece, options.signed_floats,
                                      object ? MapGreen::opengl : options.green);
    const PictureMaterial material{.colour = {0.8, 0.8, 0.8},
                                   .normal_map =
                                       [&](const Vec2<double>& uv) {
                                         const Vec3<double> x = sampler.at(uv);
                                         const double scale = object ? 1 : piece.scale;
                                         return Vec3<double>{scale * x.x, scale * x.y, x.z};
                                       },
                                   .object_space = object,
                                   .double_sided = true};
    const std::vector<PictureVertex> vertices = vertices_of(piece, options);
    std::vector<std::uint32_t> indices(vertices.size());
    std::iota(indices.begin(), indices.end(), 0u);
    rasteriser.add(vertices, indices, material);
  }
  return rasteriser.picture();
}

}  // namespace darboux
