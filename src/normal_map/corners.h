/// \file corners.h
/// The corners of a piece's triangles.
#pragma once

#include <array>
#include <cstddef>

#include <darboux/mesh_frames.h>
#include <darboux/normal_map.h>

#include "normal_map/frames.h"

namespace darboux::normal_map {

class Corners {
 public:
  /// \param piece outlives it, and has what the basis needs
  Corners(const MapPiece& piece, MapBasis basis, int threads) : piece_(&piece), basis_(basis) {
    if (basis == MapBasis::mikktspace)
      frames_ = mesh_frames(piece.mesh, find_frame_method("mikktspace"), threads);
  }

  std::array<Corner, 3> of(std::size_t triangle) const {
    std::array<Corner, 3> result;
    const Mesh& mesh = piece_->mesh;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles[triangle][k];
      result[k].n = mesh.normals[vertex];
      if (basis_ == MapBasis::stored) {
        result[k].t = mesh.tangents[vertex].xyz();
        result[k].w = mesh.tangents[vertex].w;
      } else {
        const CornerFrame& frame = frames_.corner(3 * triangle + k);
        result[k].t = frame.t;
        result[k].w = piece_->v_up ? frame.sign : -frame.sign;
      }
    }
    return result;
  }

 private:
  const MapPiece* piece_;
  MapBasis basis_;
  MeshFrames frames_;  // if they are recomputed
};

}  // namespace darboux::normal_map
