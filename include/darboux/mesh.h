/// \file mesh.h
/// A triangle mesh as files carry it. It knows no parametric surface.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <darboux/vector.h>

namespace darboux {

/// Three vertex indices. The winding order p0, p1, p2 is the file's.
using Triangle = std::array<std::uint32_t, 3>;

/// Half the steps by which a file rounded each component of an attribute, in the attribute's own units: the
/// true value lies within that of the stored one. 0: not rounded beyond single precision.
struct HalfSteps {
  double position = 0, normal = 0, uv = 0, tangent = 0;
};

/// Vertices with their attributes and triangles over them. Attributes are double, in which every float of a
/// file keeps its value; an attribute the mesh lacks is empty, any other has one entry per vertex.
struct Mesh {
  std::vector<Vec3<double>> positions;
  std::vector<Vec3<double>> normals;   ///< unit, as stored
  std::vector<Vec2<double>> uvs;       ///< as stored, unflipped
  std::vector<Vec4<double>> tangents;  ///< unit direction and sign w = ±1, as stored
  std::vector<Triangle> triangles;
  HalfSteps half_steps{};

  std::size_t corners() const { return 3 * triangles.size(); }
};

/// Throws MeshError unless attributes are empty or as long as positions, indices name vertices, and 32 bits
/// number the corners. \param name what the message calls the mesh
void check_consistent(const Mesh& mesh, const std::string& name);

/// Throws MeshError naming the first position, normal or uv that is NaN or infinite.
/// \param name what the message calls the mesh
void check_finite(const Mesh& mesh, const std::string& name);

}  // namespace darboux
