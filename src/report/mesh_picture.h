/// \file mesh_picture.h
/// A mesh with its errors in a form that the script of a page draws.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include <darboux/mesh.h>

namespace darboux {

/// What is drawn of a mesh.
struct PictureOf {
  std::span<const std::uint32_t> triangles;  ///< of the mesh; none at all: every one
  std::span<const float> errors_deg;         ///< at their corners
  double limit_deg;                          ///< that has the last colour
  std::size_t step;                          ///< every step-th triangle is drawn
};

/// Arrays in base64: places and uvs in 16 bits of their ranges, the error of a vertex (its corners' largest)
/// as 0 to 254 on the scale to the limit, 255 where nothing is compared. Triangles whose positions are not
/// finite are left out; uvs that are not finite are 0xffff.
nlohmann::ordered_json mesh_picture(const Mesh& mesh, const PictureOf& of);

/// How many triangles of each picture are to be drawn so that there are no more than `most` in all: for each
/// its step. The largest give way first.
std::vector<std::size_t> picture_steps(const std::vector<std::size_t>& triangles, std::size_t most);

}  // namespace darboux
