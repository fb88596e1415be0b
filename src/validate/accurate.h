// Question 3, accurate: are normals and tangents those of a known surface?
//
// What it may claim. A corner farther from the surface's frame than the limit, by more than three standard
// deviations of the truth, is wrong where the surface was declared. Where it was only recognised, the surface
// may be the wrong one: a corner is an error only where at least 80 % of the part agree with the surface
// (normals and tangents counted apart), or where a named mistake explains the rest; else it is a warning, and
// question 2 decides. Nor is it an error that a coarse mesh does not follow a recognised surface: a tangent
// that is an average of its own triangles' dpdu, and a normal that is a common average of theirs, or follows
// one rather than the surface, are warnings; so is what may be authored (authored.h). From what evidence: the
// surface's truth at each vertex. At poles, where no direction is right for every texture, and of faceted
// normals on a recognised surface, nothing is claimed.
#pragma once

#include <span>
#include <vector>

#include "angles.h"
#include "claim.h"
#include "mesh_under_test.h"

namespace darboux {

inline constexpr double certain = 3;  // standard deviations

// An angle that is known to a standard deviation against its limit; negative: nothing is compared.
Claim claim_of(double angle, double deviation, double limit);

class Accurate {
 public:
  Accurate() = default;
  // \param truth of the surface at each vertex; empty: none is known, and nothing is claimed
  Accurate(const MeshUnderTest& under_test, std::span<const VertexChecks> checks,
           std::span<const std::uint32_t> corners_of, std::span<const Truth> truth, Basis basis, bool raw,
           double max_angle_deg);

  bool known() const { return !truth_.empty(); }
  bool declared() const { return basis_ == Basis::declared; }
  bool has_sides() const { return basis_ != Basis::recognised_unsided; }
  const Truth& truth(std::uint32_t v) const { return truth_[v]; }
  std::span<const Truth> truths() const { return truth_; }
  const Angles& angles(std::uint32_t v) const { return angles_[v]; }
  // Whether a normal is compared with the surface's inward one.
  bool inward(std::uint32_t v) const { return inward_[v]; }
  Claim normal(std::uint32_t v) const { return normals_[v]; }
  Claim tangent(std::uint32_t v) const { return tangents_[v]; }

  // The share of corners that agree, of those compared; 1 where none is.
  double normals_agree() const { return normals_agree_; }
  double tangents_agree() const { return tangents_agree_; }
  // Whether angles beyond the limit are errors. \param diagnosed as one named mistake
  bool decides(double agree, bool diagnosed) const { return declared() || diagnosed || agree >= enough; }
  static constexpr double enough = 0.8;  // where fewer agree, one mistake is looked for (diagnose.h)

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

// Three times as far at seams, pole rings, creases and borders as in the interior.
double limit_of(VertexClass vertex_class, double max_angle_deg);

}  // namespace darboux
