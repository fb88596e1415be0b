#include "judge.h"

namespace darboux {

bool Judge::may_follow_triangles(std::uint32_t v, int sign) const {
  const Claim claim = answers_.under_test.cones.claim(v, sign);
  return claim == Claim::within || (claim == Claim::none && answers_.is_beside_pole[v] &&
                                    answers_.classes.of_vertex[v] == VertexClass::seam &&
                                    answers_.accurate.angles(v).projected_tangent < 90);
}

Judge::Decider Judge::tangent_error(const CornerGroup& group) const {
  const std::uint32_t v = group.vertex;
  if (answers_.is_pole(v) || !answers_.checks[v].uv_finite) return Decider::nobody;
  if (answers_.accurate.known()) {
    const Claim claim = answers_.accurate.tangent(v);
    if (claim == Claim::within) return Decider::nobody;
    if (answers_.is_hidden(v) && !answers_.accurate.declared()) return Decider::nobody;
    // At a seam every tool sees one side only: with few columns its tangents are far from the surface's.
    const bool authored = may_be_authored(v) && !mistakes_.tangents && !answers_.under_test.cones.empty() &&
                          may_follow_triangles(v, group.sign);
    if (claim == Claim::beyond &&
        answers_.accurate.decides(answers_.accurate.tangents_agree(), mistakes_.tangents))
      return authored || is_average_tangent(v, group.sign) ? Decider::nobody : Decider::surface;
  }
  const auto beyond = [&](int sign) { return answers_.under_test.cones.claim(v, sign) == Claim::beyond; };
  if (answers_.under_test.cones.empty() || !beyond(group.sign) || may_be_exact(v)) return Decider::nobody;
  const int sign = mistakes_.tangents ? group.sign : answers_.under_test.followed_sign(v, group.sign);
  return beyond(sign) ? Decider::triangles : Decider::nobody;
}

// A mistake or turn that all tangents share is not due to coarse triangles.
bool Judge::may_be_exact(std::uint32_t v) const {
  return answers_.smooth.known() && answers_.smooth.may_be_exact[v] && !mistakes_.tangents &&
         !answers_.under_test.cones.turn();
}

bool Judge::normal_error(std::uint32_t v) const {
  const bool unsupported = is_unsupported(v) && !may_be_lit_otherwise(v);
  // Either side of a plane may be its outside, so it cannot excuse a normal that its own triangles do not
  // support.
  const bool within = answers_.accurate.known() && answers_.accurate.has_sides() &&
                      answers_.accurate.normal(v) == Claim::within;
  if (unsupported && !within) return true;
  return answers_.accurate.known() && answers_.accurate.normal(v) == Claim::beyond &&
         answers_.accurate.decides(answers_.accurate.normals_agree(), normals_diagnosed()) &&
         !(((may_be_authored(v) && !normals_diagnosed()) || answers_.averages.normal(v)) &&
           !is_unsupported(v));
}

Code Judge::error_of(const CornerGroup& group) const {
  using enum Code;
  const std::uint32_t v = group.vertex;
  const VertexChecks& c = answers_.checks[v];
  if (!answers_.mesh.tangents.empty()) {
    if (!c.tangent_finite) return tangent_not_finite;
    if (c.tangent_zero && answers_.under_test.has_uv_area[v]) return tangent_zero;
    if (!c.tangent_zero && !c.tangent_unit) return tangent_not_unit;
    // A zero w has no effect where there is no uv area: the bitangents of FBX and COLLADA are zero there and
    // give no sign.
    if (!c.tangent_zero && !c.sign_valid && (!answers_.is_unseen(v) || answers_.mesh.tangents[v].w != 0))
      return tangent_invalid_sign;
    if (c.along_normal && !answers_.is_unseen(v)) return tangent_not_orthogonal;
    if (group.wrong_sign && !answers_.is_hidden(v)) return tangent_handedness;
    if (tangent_error(group) != Decider::nobody) return tangent_angle;
  }
  if (!c.normal_finite) return normal_not_finite;
  if (!c.normal_unit && (c.has_normal || answers_.under_test.normals.drawn[v])) return normal_not_unit;
  if (normal_error(v)) return normal_angle;
  if (!c.position_finite) return position_not_finite;
  if (!c.uv_finite) return uv_not_finite;
  return no_code;
}

Excuse Judge::tangent_excuse(const CornerGroup& group) const {
  if (!answers_.accurate.decides(answers_.accurate.tangents_agree(), mistakes_.tangents))
    return Excuse::surface_undecided;
  return is_average_tangent(group.vertex, group.sign) ? Excuse::average : Excuse::authored;
}

Excuse Judge::normal_excuse(std::uint32_t v) const {
  if (!answers_.accurate.decides(answers_.accurate.normals_agree(), normals_diagnosed()))
    return Excuse::surface_undecided;
  return answers_.averages.normal(v) ? Excuse::average : Excuse::authored;
}

}  // namespace darboux
