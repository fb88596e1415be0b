// Counts of corners in a validation, and the texts about them.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "answers.h"
#include "findings.h"
#include "judge.h"

namespace darboux {

// How many corners of a code there are, and the worst of them.
struct Beyond {
  std::size_t by_surface = 0, by_triangles = 0, in_all = 0;
  double worst = 0;
  std::size_t counted() const { return by_surface + by_triangles; }
};

// The range of lengths that are not 1.
class Lengths {
 public:
  void add(double length);
  // " (lengths 0.5 to 2)"
  std::string text() const;
  bool hold_zero() const { return least_ == 0; }
  bool are_zero() const { return most_ == 0; }

 private:
  double least_ = std::numeric_limits<double>::infinity(), most_ = 0;
};

// Corners by finding.
struct CornerCounts {
  std::array<std::size_t, corner_errors> of_error{};
  Beyond tangents, normals, chord_tangents, local_tangents, local_normals, poles;
  std::array<Beyond, excuses> excused_tangents{}, excused_normals{};  // by Excuse
  std::size_t leaning = 0, lit_otherwise = 0, departing = 0;
  Lengths tangent_lengths, normal_lengths;
  // Tangents that are not perpendicular to the normal: the largest lean, and the corners where the tangent is
  // twice as near to the plane of its triangles.
  double most_along_normal = 0;
  std::size_t in_plane = 0;
  TrianglesReport triangles;
  std::vector<Vec3<double>> planes;  // of each vertex, once needed

  // Whether only the triangles show these errors, at so few corners that slivers may be the cause.
  bool are_few(Code code, std::size_t corners, double limit_deg) const;
};

CornerCounts count_corners(const Answers& answers, const Judge& judge);

// Adds errors with the reference that decided, and says where other corners beyond the limit are counted;
// then what is no error, as warnings.
void add_findings(const CornerCounts& counts, const Answers& answers, const Judge& judge, MeshReport& report);

// " (worst 3.1 deg, limit 1 in the interior, 3 elsewhere)"
std::string worst_text(double limit_deg, double worst_deg, const std::string& more = {});

}  // namespace darboux
