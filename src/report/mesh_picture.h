/// \file mesh_picture.h
/// A mesh with its errors, encoded for the script of a page.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include <darboux/mesh.h>

namespace darboux {

/// The part of a mesh to be drawn.
struct PictureOf {
  std::span<const std::uint32_t> triangles;  ///< of the mesh; none at all: every one
  std::span<const float> errors_deg;         ///< at their corners
  double limit_deg;                          ///< that has the last colour
  std::size_t step;                          ///< every step-th triangle is drawn
};

/// Arrays in base64: positions and uvs in 16 bits of their ranges, the error of a vertex (the largest of its
/// corners) as 0 to 254 on the scale to the limit, 255 if nothing is compared. Triangles whose positions are
/// not finite are omitted; uvs that are not finite are 0xffff.
nlohmann::ordered_json mesh_picture(const Mesh& mesh, const PictureOf& of);

/// The step for each picture such that at most `most` triangles are drawn in total. The largest pictures are
/// thinned first.
std::vector<std::size_t> picture_steps(const std::vector<std::size_t>& triangles, std::size_t most);

}  // namespace darboux
