/// \file input.h
/// What is asked for, checked.
#pragma once

#include <darboux/mikktspace.h>

namespace darboux::mikk {

// Whether products of positions and uvs and their squares may leave the range of float.
struct Range {
  bool scale;  // each triangle is to be scaled by powers of two: within the range that changes no bit
  bool shrink_positions, shrink_uvs;  // even differences may: by a quarter first
};

// Throws as mikktspace() does.
Range check(const MikkMesh& mesh, const MikkOptions& options);

}  // namespace darboux::mikk
