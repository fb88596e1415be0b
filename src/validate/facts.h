// What is wrong with a vertex in itself, and how far its frame is from a truth.
#pragma once

#include <numbers>
#include <span>
#include <vector>

#include <darboux/placed_surface.h>
#include <darboux/validate.h>

namespace darboux {

inline constexpr double degrees_per_radian = 180 / std::numbers::pi;

// What is the same for every corner of a vertex.
struct VertexFacts {
  bool position_finite = true, uv_finite = true, normal_finite = true, normal_unit = true;
  bool has_normal = false;   // finite and not zero
  bool has_tangent = false;  // likewise
  bool tangent_finite = true, tangent_zero = false, tangent_unit = true, sign_valid = true, orthogonal = true;
};
VertexFacts stored_facts(const Mesh& mesh, std::uint32_t v);

// Degrees between what is stored and a truth; negative where there is nothing to compare.
struct Angles {
  double normal = -1, tangent = -1, bitangent = -1;
};

// \param raw the sign convention of the stored w
Angles angles(const Mesh& mesh, std::uint32_t v, const VertexFacts& facts, const Truth& truth, bool inward,
              bool raw);

// A mesh seen from inside, compared with -n: at most corners the normal and the winding both oppose the surface's n.
bool faces_inward(const Mesh& mesh, std::span<const Truth> truth);

// Statistics of angles by class. Add each vertex with the number of its corners, or each corner.
class ClassSums {
 public:
  explicit ClassSums(const Mesh& mesh) : mesh_(mesh) {}
  // \param truth whose deviations are summed up, or none
  void add(VertexClass vertex_class, std::uint32_t vertex, std::uint32_t corners, const Angles& angles,
           const Truth* truth);
  std::vector<ClassReport> reports();

 private:
  struct Sums {
    std::size_t corners = 0;
    std::vector<Counted> normal, tangent, bitangent;
    Spread normal_uncertainty, tangent_uncertainty;
    double worst = -1;
    std::uint32_t worst_vertex = 0;
  };
  const Mesh& mesh_;
  std::array<Sums, vertex_class_names.size()> sums_;
};

}  // namespace darboux
