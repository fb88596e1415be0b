// What is known about a mesh before its corners are judged.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accurate.h"
#include "averages.h"
#include "mesh_under_test.h"
#include "signs.h"
#include "smooth.h"

namespace darboux {

// The answers of all references, per vertex.
struct Answers {
  // \param truth of the surface at each vertex; if empty, no surface is known
  Answers(const MeshUnderTest& mesh_under_test, std::span<const Truth> truth, Basis basis,
          const ValidateOptions& validate_options);
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;

  bool is_pole(std::uint32_t v) const { return classes.of_vertex[v] == VertexClass::pole; }
  // Whether no triangle with area uses it.
  bool is_hidden(std::uint32_t v) const { return !mesh.normals.empty() && !under_test.normals.drawn[v]; }
  // Whether no triangle with area, or none with uv area, uses it: its tangent then has no visible effect.
  bool is_unseen(std::uint32_t v) const {
    return is_hidden(v) || (!mesh.uvs.empty() && !under_test.has_uv_area[v]);
  }
  double limit_of(std::uint32_t v) const {
    return darboux::limit_of(classes.of_vertex[v], options.max_angle_deg);
  }
  // The reference for the statistics: the surface, else the neighbours.
  std::span<const Truth> statistics_truth() const {
    return accurate.known() ? accurate.truths() : std::span<const Truth>(under_test.local);
  }
  Angles statistics_angles(std::uint32_t v) const;

  const MeshUnderTest& under_test;
  const Mesh& mesh;
  const MeshClasses& classes;
  const ValidateOptions& options;
  std::vector<VertexChecks> checks;
  std::vector<std::uint32_t> corners_of;  // number of corners per vertex
  Signs signs;
  Accurate accurate;
  // Empty where the surface is declared or unknown: vertices that share a triangle with a pole, and those
  // whose tangent may be the author's intention.
  std::vector<bool> is_beside_pole, authored;
  Averages averages;
  Smooth smooth;
};

}  // namespace darboux
