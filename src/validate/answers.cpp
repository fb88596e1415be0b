#include "answers.h"

#include <algorithm>

#include "authored.h"

namespace darboux {
namespace {

std::vector<VertexChecks> checks_of(const Mesh& mesh) {
  std::vector<VertexChecks> checks(mesh.positions.size());
  for (std::uint32_t v = 0; v < checks.size(); ++v) checks[v] = check_vertex(mesh, v);
  return checks;
}

std::vector<std::uint32_t> corners_of_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> corners(mesh.positions.size(), 0);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) ++corners[v];
  return corners;
}

}  // namespace

Answers::Answers(const MeshUnderTest& mesh_under_test, std::span<const Truth> truth, Basis basis,
                 const ValidateOptions& validate_options)
    : under_test(mesh_under_test),
      mesh(mesh_under_test.mesh),
      classes(mesh_under_test.classes),
      options(validate_options),
      checks(checks_of(mesh)),
      corners_of(corners_of_vertices(mesh)),
      signs(under_test, checks),
      accurate(under_test, checks, corners_of, truth, basis, signs.raw(), options.max_angle_deg) {
  if (accurate.known() && !accurate.declared()) {
    authored = may_be_authored(under_test, accurate);
    is_beside_pole.assign(mesh.positions.size(), false);
    for (const Triangle& triangle : mesh.triangles)
      if (std::any_of(triangle.begin(), triangle.end(), [&](std::uint32_t v) { return is_pole(v); }))
        for (const std::uint32_t v : triangle) is_beside_pole[v] = true;
  }
  averages = Averages(under_test, accurate, checks, corners_of);
  if (!under_test.local.empty())
    smooth = check_smooth(under_test, accurate, checks, signs.raw(), options.max_angle_deg);
}

Angles Answers::statistics_angles(std::uint32_t v) const {
  if (corners_of[v] == 0) return {};
  if (accurate.known()) return accurate.angles(v);
  return smooth.known() ? smooth.angles[v] : Angles{};
}

}  // namespace darboux
