/// \file mesh.h
/// A triangle mesh as stored in files. Independent of any parametric surface.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <darboux/vector.h>

namespace darboux {

/// Three vertex indices, in the winding order of the file.
using Triangle = std::array<std::uint32_t, 3>;

/// Half the quantisation step of each attribute, in the units of that attribute: the true value of a
/// component differs from the stored one by at most this much. 0: rounded to single precision only.
struct HalfSteps {
  double position = 0, normal = 0, uv = 0, tangent = 0;
};

/// Vertices with their attributes, and triangles over them. An attribute has one entry per vertex, or is
/// empty if the mesh lacks it. Attributes are stored as double, so every float of a file keeps its value.
struct Mesh {
  std::vector<Vec3<double>> positions;  ///< in the local space and unit of length of the mesh
  std::vector<Vec3<double>> normals;    ///< as stored; should be unit
  std::vector<Vec2<double>> uvs;        ///< as stored, unflipped
  std::vector<Vec4<double>> tangents;   ///< x, y, z and the sign w, as stored; should be unit and ±1
  std::vector<Triangle> triangles;
  HalfSteps half_steps{};

  std::size_t corners() const { return 3 * triangles.size(); }
};

/// Checks that each attribute is empty or as long as positions, that every index refers to a vertex, and that
/// the number of corners fits in 32 bits. \param name the mesh's name in error messages \throws MeshError
/// naming the first condition that fails
void check_consistent(const Mesh& mesh, const std::string& name);

/// Checks that positions, normals and uvs (not tangents) are finite. \param name the mesh's name in error
/// messages \throws MeshError naming the first value that is NaN or infinite
void check_finite(const Mesh& mesh, const std::string& name);

}  // namespace darboux
