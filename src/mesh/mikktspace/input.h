/// \file input.h
// / Checks of the input and options.
#pragma once

#include <darboux/mikktspace.h>

namespace darboux::mikk {

// Whether products of positions and uvs and their squares may leave the range of float.
struct Range {
  bool scale;  // scale each triangle by powers of two; within the range this changes no bit
  bool shrink_positions, shrink_uvs;  // even differences may leave the range: multiply by a quarter first
};

// Throws as mikktspace() does.
Range check(const MikkMesh& mesh, const MikkOptions& options);

}  // namespace darboux::mikk
