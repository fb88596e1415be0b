// Counts of corners in a validation, and the texts about them.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "findings.h"

namespace darboux {

// Why a deviation is no error, and what to do then; empty: what its kind says.
struct Reason {
  std::string_view why, to_do;
};
// The warning with the reason's `why` appended to its message.
Finding warning(Code code, std::size_t count, const std::string& more, const Reason& reason);

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

 private:
  double least_ = std::numeric_limits<double>::infinity(), most_ = 0;
};

// Corners by finding.
struct CornerCounts {
  std::array<std::size_t, corner_errors> of_error{};
  Beyond tangents, normals, surface_tangents, surface_normals, authored_tangents, authored_normals,
      coarse_tangents, coarse_normals, chord_tangents, local_tangents, local_normals, poles;
  std::size_t leaning = 0, lit_otherwise = 0, departing = 0;
  Lengths tangent_lengths, normal_lengths;
  // Tangents that are not perpendicular to the normal: the largest lean, and the corners where the tangent is
  // twice as near to the plane of its triangles.
  double most_along_normal = 0;
  std::size_t in_plane = 0;
  std::vector<Vec3<double>> planes;  // of each vertex, once needed

  // Whether only the triangles show these errors, at so few corners that slivers may be the cause.
  bool are_few(Code code, std::size_t corners, double limit_deg) const;
};

namespace reasons {

inline constexpr Reason unsure{
    "; by the recognised surface, with which too few corners agree to call that an error",
    "nothing, if the mesh is not that surface; otherwise declare it (--surface), and correct what is off"},
    edge{
        "; at borders, seams and creases of the recognised surface, or blended from there, where they may be "
        "authored: the corners' own triangles do not speak against them",
        "nothing, where they are authored; else recompute them"},
    coarse{
        "; averages of their own triangles', or near these: the mesh is too coarse for the recognised "
        "surface, or leaves it",
        "nothing, or refine the mesh there"},
    chords{
        "; outside the cone of their own triangles, which are too coarse to tell: neighbouring vertices "
        "allow it",
        "nothing, or refine the mesh there"},
    few{"; few corners, told by their own triangles alone, which may have been cut, subdivided or "
        "simplified since",
        "nothing, if triangles were cut, subdivided, simplified or quantised after tangents were computed; "
        "else "
        "recompute tangents"},
    nearby{"; told by neighbouring vertices alone, so only what is beyond three times the limit counts", ""},
    lit_otherwise{
        "; more than 80 deg from their own triangles, at borders, at slivers or where normals are smooth, "
        "which "
        "may be meant",
        "nothing, where cards, skirts or crowns are lit as the ground or the whole is, or at slivers; else "
        "recompute normals"},
    departing{"; more than 60 deg from their own triangles, and no average of these",
              "nothing, where they are authored; else recompute normals"};

}  // namespace reasons

}  // namespace darboux
