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

/// Rounding of quantised attributes: the true value of a component lies within this of the stored one, in the
/// attribute's own units. 0: rounded to single precision only.
struct HalfSteps {
  double position = 0, normal = 0, uv = 0, tangent = 0;
};

/// Vertices with their attributes, and triangles over them. An attribute has one entry per vertex, or none
/// where the mesh lacks it. Attributes are double, so that every float of a file keeps its value.
struct Mesh {
  std::vector<Vec3<double>> positions;  ///< in the mesh's own space and unit of length
  std::vector<Vec3<double>> normals;    ///< as stored; should be unit
  std::vector<Vec2<double>> uvs;        ///< as stored, unflipped
  std::vector<Vec4<double>> tangents;   ///< x, y, z and the sign w, as stored; should be unit and ±1
  std::vector<Triangle> triangles;
  HalfSteps half_steps{};

  std::size_t corners() const { return 3 * triangles.size(); }
};

/// Checks that each attribute is empty or as long as positions, that every index names a vertex, and that 32
/// bits can number the corners. \param name what the message calls the mesh \throws MeshError naming the
/// first that does not hold
void check_consistent(const Mesh& mesh, const std::string& name);

/// Checks that positions, normals and uvs (not tangents) are finite. \param name what the message calls the
/// mesh \throws MeshError naming the first that is NaN or infinite
void check_finite(const Mesh& mesh, const std::string& name);

}  // namespace darboux
