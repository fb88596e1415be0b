// Question 3, accurate: are normals and tangents those of a known surface?
//
// What it may claim. A corner farther from the surface's frame than the limit, by more than three standard
// deviations of the truth, is wrong where the surface was declared. Where it was only recognised, the surface
// may be the wrong one: a corner is an error only where at least 80 % of the part agree with the surface
// (normals and tangents counted apart), or where a named mistake explains the rest; else it is a warning, and
// question 2 decides. A coarse mesh cannot follow a recognised surface, so these are warnings, too: a tangent
// that is an average of its own triangles' dpdu; a normal that is an average of theirs by a usual weighting,
// or at most half as far from one as from the surface's; a deviation that may be the author's intention
// (authored.h). Nothing is claimed at poles, where no direction is right for every texture, nor of faceted
// normals on a recognised surface.
//
// Evidence: the surface's truth at each vertex.
#pragma once

#include <span>
#include <vector>

#include "angles.h"
#include "claim.h"
#include "mesh_under_test.h"

namespace darboux {

inline constexpr double certain = 3;  // standard deviations

// Compares an angle, known to a standard deviation, with its limit. Negative angle: nothing to compare.
Claim claim_of(double angle, double deviation, double limit);

class Accurate {
 public:
  Accurate() = default;
  // \param truth of the surface at each vertex; if empty, none is known and nothing is claimed
  Accurate(const MeshUnderTest& under_test, std::span<const VertexChecks> checks,
           std::span<const std::uint32_t> corners_of, std::span<const Truth> truth, Basis basis, bool raw,
           double max_angle_deg);

  bool known() const { return !truth_.empty(); }
  bool declared() const { return basis_ == Basis::declared; }
  bool has_sides() const { return basis_ != Basis::recognised_unsided; }
  const Truth& truth(std::uint32_t v) const { return truth_[v]; }
  std::span<const Truth> truths() const { return truth_; }
  const Angles& angles(std::uint32_t v) const { return angles_[v]; }
  // Whether the normal of v is compared with the surface's inward normal.
  bool inward(std::uint32_t v) const { return inward_[v]; }
  Claim normal(std::uint32_t v) const { return normals_[v]; }
  Claim tangent(std::uint32_t v) const { return tangents_[v]; }

  // The share of compared corners that agree; 1 if none is compared.
  double normals_agree() const { return normals_agree_; }
  double tangents_agree() const { return tangents_agree_; }
  // Whether angles beyond the limit are errors. \param diagnosed whether one named mistake explains them
  bool decides(double agree, bool diagnosed) const { return declared() || diagnosed || agree >= enough; }
  static constexpr double enough = 0.8;  // if fewer agree, diagnose_normals.h looks for one mistake

 private:
  void find_sides(const Mesh& mesh, std::span<const signed char> side,
                  std::span<const std::uint32_t> corners_of);

  std::span<const Truth> truth_;
  Basis basis_ = Basis::declared;
  std::vector<bool> inward_;
  std::vector<Angles> angles_;
  std::vector<Claim> normals_, tangents_;
  double normals_agree_ = 1, tangents_agree_ = 1;
};

// At seams, pole rings, creases and borders three times the limit of the interior.
double limit_of(VertexClass vertex_class, double max_angle_deg);

}  // namespace darboux
