/// \file scene_picture.h
/// Tiles of a scene as triangles of a picture.
#pragma once

#include <functional>

#include <darboux/scene.h>

#include "rasterise.h"

namespace darboux {

/// Draws the samples of a patch once for each of its tiles, placed: positions and tangents by the placement,
/// normals by its inverse transpose. They have position and normal, and tangent4 where a material reads it.
/// \param material of a tile
void draw_tiles(Rasteriser& picture, const Scene& scene, const TileSamples& samples,
                const std::function<PictureMaterial(const PlannedTile&)>& material);

/// A colour for a material of a scene, each of the first eight another, with bumps where it has a normal map.
PictureMaterial picture_material(const Scene& scene, const PlannedTile& tile);

/// The outcome for a tile.
enum class TileFate { needed, back_facing, outside_frustum, occluded };
inline constexpr int tile_fates = 4;
/// A double-sided material in the colour of the outcome: green, orange, grey, blue.
PictureMaterial picture_material(TileFate fate);

/// The axes of a view from beside another camera, from its right and a little above.
Eigen::Matrix3d axes_beside(const Camera& camera);
/// An orthographic camera along these axes, with as many pixels as another, that sees all between two corners
/// of a box in these axes.
Camera view_along(const Eigen::Matrix3d& axes, const Vec3<double>& least, const Vec3<double>& greatest,
                  const Camera& with_pixels_of);

}  // namespace darboux
