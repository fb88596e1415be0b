// Angles between stored normals or tangents and a truth, and their statistics by class.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <darboux/placed_surface.h>
#include <darboux/validate.h>

#include "sound.h"

namespace darboux {

// The part of a vector that is perpendicular to n.
inline Vec3<double> square_to(const Vec3<double>& a, const Vec3<double>& n) {
  return a - (dot(a, n) / dot(n, n)) * n;
}

inline bool has_direction(const Vec3<double>& a) {
  return detail::finite(a) && !(a == Vec3<double>{});
}

// Degrees between stored vectors and a truth; negative where there is nothing to compare.
struct Angles {
  double normal = -1, tangent = -1, bitangent = -1;
  double projected_tangent = -1;  // of the tangent made perpendicular to the stored normal, as readers do
};

// \param inward whether to compare with -n \param raw the sign convention of the stored w
Angles angles(const Mesh& mesh, std::uint32_t v, const VertexChecks& checks, const Truth& truth, bool inward,
              bool raw);

// Vertices seen from inside, to be compared with -n: the normal and the winding both oppose the surface's n
// at most of their corners. On a plate with two sides, each side is compared with its own n.
std::vector<bool> inward_vertices(const Mesh& mesh, std::span<const Truth> truth);

// Vertices whose normal opposes the surface's n, whatever the winding.
std::vector<bool> opposed_vertices(const Mesh& mesh, std::span<const Truth> truth);

// Statistics of angles by class. Add each vertex with the number of its corners, or each corner.
class ClassSums {
 public:
  ClassSums(const Mesh& mesh, std::span<const VertexClass> of_vertex);
  // \param truth its standard deviations are summed up; may be none
  void add(VertexClass vertex_class, std::uint32_t vertex, std::uint32_t corners, const Angles& angles,
           const Truth* truth);
  std::vector<ClassReport> reports();

 private:
  struct Sums {
    std::size_t corners = 0;
    std::size_t vertices = 0;  // of the class: capacity for what is added
    std::vector<Counted> normal, tangent, bitangent;
    Spread normal_uncertainty, tangent_uncertainty;
    double worst = -1;
    std::uint32_t worst_vertex = 0;
  };
  const Mesh& mesh_;
  std::array<Sums, vertex_class_names.size()> sums_;
};

}  // namespace darboux
