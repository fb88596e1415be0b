/// \file input.h
/// What is asked for, checked, and in the range of float.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include <darboux/mikktspace.h>

namespace darboux::mikk {

// The mesh with positions and uvs each multiplied by a power of two where products of them and their squares might leave the
// range of float. Within it that changes no bit of a direction.
class Input {
 public:
  // Throws as mikktspace() does.
  Input(const MikkMesh& mesh, const MikkOptions& options);
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  const MikkMesh& mesh() const { return mesh_; }
  // Lengths are those of positions by uvs.
  float length(float of_scaled) const { return std::ldexp(of_scaled, position_exponent_ - uv_exponent_); }

 private:
  MikkMesh mesh_;
  std::vector<float> positions_, uvs_;  // where they are not the mesh's own
  int position_exponent_, uv_exponent_;
};

}  // namespace darboux::mikk
