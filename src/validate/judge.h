// Which error a corner has, by all references together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "answers.h"
#include "diagnose_normals.h"
#include "findings.h"

namespace darboux {

// Corners of one vertex with the same assessment.
struct CornerGroup {
  std::uint32_t vertex;
  std::int8_t sign;  // of their triangles, 0 without uv area
  bool wrong_sign;   // w differs from their island's
  std::uint32_t corners;
};
// Calls f(group). Nearly all corners of a vertex are alike, and one group; each of the others is a group of
// its own.
template <class F>
void for_each_corner_group(const Answers& answers, F f) {
  const Mesh& mesh = answers.mesh;
  std::vector<CornerGroup> others;
  std::vector<std::int8_t> first(mesh.positions.size(), -1);  // the properties of a corner, as a number
  std::vector<std::uint32_t> alike = answers.corners_of;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      const auto sign = static_cast<std::int8_t>(answers.under_test.raw_sign[t]);
      const bool wrong = !mesh.tangents.empty() && answers.signs.wrong(t, v);
      const auto key = static_cast<std::int8_t>(2 * (sign + 1) + (wrong ? 1 : 0));
      if (first[v] < 0) first[v] = key;
      if (first[v] == key) continue;
      others.push_back({v, sign, wrong, 1});
      --alike[v];
    }
  for (std::uint32_t v = 0; v < alike.size(); ++v)
    if (alike[v] > 0)
      f(CornerGroup{v, static_cast<std::int8_t>(first[v] / 2 - 1), first[v] % 2 == 1, alike[v]});
  for (const CornerGroup& group : others) f(group);
}

// The one mistake that explains most tangents, or normals, if any.
struct Mistakes {
  bool tangents = false;
  NormalMistake normals = NormalMistake::none;
};

// Why a deviation from a surface is no error.
enum class Excuse : std::uint8_t { surface_undecided, authored, average };
inline constexpr std::size_t excuses = 3;

class Judge {
 public:
  static constexpr auto no_code = static_cast<Code>(corner_errors);
  // Which reference makes a tangent an error.
  enum class Decider : std::uint8_t { nobody, surface, triangles };
  // \param answers must outlive the judge
  Judge(const Answers& answers, const Mistakes& mistakes) : answers_(answers), mistakes_(mistakes) {}

  // The first error that fits, or no_code.
  Code error_of(const CornerGroup& group) const;
  Decider tangent_error(const CornerGroup& group) const;
  bool normal_error(std::uint32_t v) const;
  // For deviations beyond the limit that are no errors.
  Excuse tangent_excuse(const CornerGroup& group) const;
  Excuse normal_excuse(std::uint32_t v) const;

  NormalMistake normal_mistake() const { return mistakes_.normals; }
  // Whether the normal is more than 80 degrees from its own triangles.
  bool is_unsupported(std::uint32_t v) const {
    return !answers_.mesh.normals.empty() && answers_.under_test.normals.unsupported[v];
  }
  // Leaves and grass on cards are lit like the crown or the ground.
  bool may_be_lit_otherwise(std::uint32_t v) const {
    return !answers_.accurate.known() && (answers_.classes.of_vertex[v] == VertexClass::border ||
                                          answers_.under_test.normals.may_be_meant[v]);
  }

 private:
  // Whether the tangent is in the cone of its triangles. At a seam beside a pole one of the two that give it
  // may have no area: they cannot judge it.
  bool may_follow_triangles(std::uint32_t v, int sign) const;
  // At the boundary of a recognised surface, artists blend its normals into the adjacent surface, and
  // tangents follow.
  bool may_be_authored(std::uint32_t v) const { return !answers_.authored.empty() && answers_.authored[v]; }
  bool is_average_tangent(std::uint32_t v, int sign) const {
    return !mistakes_.tangents && answers_.averages.tangent(v, answers_.under_test.followed_sign(v, sign));
  }
  bool normals_diagnosed() const { return mistakes_.normals != NormalMistake::none; }
  bool may_be_exact(std::uint32_t v) const;

  const Answers& answers_;
  Mistakes mistakes_;
};

}  // namespace darboux
