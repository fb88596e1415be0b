#include "consistent.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "angles.h"
#include "baked_scale.h"
#include "base/degrees.h"
#include "corner_cones.h"
#include "mikktspace_comparison.h"

namespace darboux {
namespace {

constexpr double most_scaled = 0.03;  // share of a mesh's tangents that a baked scale may explain: a choice
// No scale was baked in where more of the tangents that it would move are MikkTSpace's: of those that are
// told, and of few that may be explained.
constexpr double most_unmoved = 0.95, most_unmoved_of_few = 0.5;

// The least turn of turned tangents. On a prism with three sides and normals between those of its facets,
// making dpdu perpendicular to the normal turns it by 25 degrees; with more sides, by less.
constexpr double foreshortened_deg = 30;
constexpr double nearly_all = 0.9;
constexpr std::size_t least_turned = 8;  // corners of vertices

}  // namespace

Vec3<double> direction_of_dpdu(const Mesh& mesh, const Triangle& t, int sign) {
  const auto& [a, b, c] = t;
  const double s = sign, dv1 = s * (mesh.uvs[b].y - mesh.uvs[a].y), dv2 = s * (mesh.uvs[c].y - mesh.uvs[a].y);
  const Vec3<double> along =
      dv2 * (mesh.positions[b] - mesh.positions[a]) - dv1 * (mesh.positions[c] - mesh.positions[a]);
  return along / std::fmax(std::fabs(along.x), std::fmax(std::fabs(along.y), std::fabs(along.z)));
}

Cones::Cones(const Mesh& mesh, std::span<const signed char> raw_sign, const std::vector<bool>& has_area,
             const VertexJoins& joins, const MikktspaceReference& mikktspace,
             std::span<const double> limit_deg, double max_angle_deg) {
  assess(mesh, raw_sign, has_area, joins, mikktspace, limit_deg, max_angle_deg);
  hold_if_turned(max_angle_deg);
  const auto beyond = count(Claim::beyond);
  if (turn_ || beyond == 0 || share_unmoved(mesh, raw_sign, mikktspace) > most_unmoved) return;
  if (const auto unscaled = before_baked_scale(mesh, raw_sign, has_area, max_angle_deg)) {
    Cones before;
    before.assess(*unscaled, raw_sign, has_area, joins, {}, limit_deg, max_angle_deg);
    if (before.count(Claim::beyond) < beyond) *this = std::move(before);
  }
}

std::ptrdiff_t Cones::count(Claim claim) const {
  return std::count(claims_.begin(), claims_.end(), claim);
}

void Cones::assess(const Mesh& mesh, std::span<const signed char> raw_sign, const std::vector<bool>& has_area,
                   const VertexJoins& joins, const MikktspaceReference& mikktspace,
                   std::span<const double> limit_deg, double max_angle_deg) {
  const std::size_t n = mesh.positions.size();
  claims_.assign(2 * n, Claim::none);
  std::vector<bool> asked(2 * n, false), vertices(n, false);
  bool any = false;
  double limit_of_cosine = 0, cosine = 1;  // cached: nearly all vertices have the same limit
  // Quick test: most tangents lie within the limit of the direction of some triangle of their vertex, so they
  // are inside the widened cone.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (raw_sign[t] == 0 || !has_area[t]) continue;
    const Triangle& triangle = mesh.triangles[t];
    const Vec3<double> along = direction_of_dpdu(mesh, triangle, raw_sign[t]);
    for (const std::uint32_t v : triangle) {
      const std::size_t place = signed_index(v, raw_sign[t]);
      if (claims_[place] == Claim::within) continue;
      asked[place] = true;
      const Vec3<double>&n = mesh.normals[v], a = square_to(along, n),
            b = square_to(mesh.tangents[v].xyz(), n);
      if (limit_deg[v] != limit_of_cosine) {
        limit_of_cosine = limit_deg[v];
        cosine = std::cos(std::fmin(limit_of_cosine, 90) / degrees_per_radian);
      }
      const double product = dot(a, b);
      if (product > 0 && product * product > cosine * cosine * dot(a, a) * dot(b, b))
        claims_[place] = Claim::within;
    }
  }
  for (std::uint32_t v = 0; v < n; ++v)
    for (const int sign : {-1, 1})
      if (const std::size_t place = signed_index(v, sign); asked[place] && claims_[place] != Claim::within)
        vertices[v] = any = true;
  if (!any) return;
  CornerCones corner_cones(mesh, raw_sign, joins, vertices, max_angle_deg);
  std::vector<std::size_t> scaled;  // places
  for (std::uint32_t v = 0; v < n; ++v)
    for (const int sign : {-1, 1}) {
      const std::size_t place = signed_index(v, sign);
      if (!asked[place] || claims_[place] == Claim::within) continue;
      const auto [claim, left, by_scale] = corner_cones.assess(v, sign, limit_deg[v]);
      claims_[place] = claim;
      if (by_scale) scaled.push_back(place);
      if (left)
        outside_.push_back({static_cast<std::uint32_t>(place),
                            static_cast<float>(corner_cones.outside_deg(v, *left)),
                            static_cast<float>(std::remainder(degrees_per_radian * left->middle, 360)),
                            static_cast<float>(degrees_per_radian * left->half)});
    }
  leave_out_mikktspaces(mesh, raw_sign, mikktspace, limit_deg);
  const auto beyond = count(Claim::beyond), within = count(Claim::within);
  if (!scaled.empty() && static_cast<double>(beyond) <= most_scaled * static_cast<double>(beyond + within) &&
      share_unmoved(mesh, raw_sign, mikktspace) < most_unmoved_of_few)
    for (const std::size_t place : scaled) claims_[place] = Claim::none;
}

void Cones::leave_out_mikktspaces(const Mesh& mesh, std::span<const signed char> raw_sign,
                                  const MikktspaceReference& mikktspace, std::span<const double> limit_deg) {
  std::vector<bool> beyond(claims_.size());
  for (std::size_t place = 0; place < claims_.size(); ++place)
    beyond[place] = claims_[place] == Claim::beyond;
  const std::vector<bool> out = are_mikktspaces(mesh, raw_sign, mikktspace, beyond, limit_deg);
  for (std::size_t place = 0; place < claims_.size(); ++place)
    if (out[place]) claims_[place] = Claim::none;
  std::erase_if(outside_, [&](const Outside& o) { return out[o.place]; });
}

void Cones::hold_if_turned(double max_angle_deg) {
  turn_.reset();
  auto within = count(Claim::within);
  for (const Outside& o : outside_) within -= claims_[o.place] == Claim::within ? 1 : 0;
  const double known = static_cast<double>(within) + static_cast<double>(outside_.size());
  if (outside_.size() < least_turned || static_cast<double>(outside_.size()) < nearly_all * known) return;
  // All turn the same way, or the opposite way where uvs are mirrored, as with bitangents in place of
  // tangents.
  for (const bool by_sign : {false, true}) {
    const auto middle = [&](const Outside& o) {
      return by_sign && o.place % 2 == 0 ? -double{o.middle} : double{o.middle};
    };
    double x = 0, y = 0;
    for (const Outside& o : outside_)
      x += std::cos(middle(o) / degrees_per_radian), y += std::sin(middle(o) / degrees_per_radian);
    const double turn = degrees_per_radian * std::atan2(y, x);
    if (!(std::fabs(turn) >= foreshortened_deg)) continue;
    const auto is_turned = [&](const Outside& o) {
      return std::fabs(std::remainder(middle(o) - turn, 360)) - o.half <= max_angle_deg;
    };
    const auto turned = std::count_if(outside_.begin(), outside_.end(), is_turned);
    if (static_cast<double>(turned) < nearly_all * known) continue;
    turn_ = Turn{-turn, by_sign};
    for (const Outside& o : outside_)
      if (is_turned(o)) claims_[o.place] = Claim::beyond;
    return;
  }
}

OwnDirections own_directions(const Mesh& mesh, std::span<const signed char> raw_sign,
                             const VertexJoins& joins, const std::vector<bool>& vertices) {
  CornerCones corner_cones(mesh, raw_sign, joins, vertices, 0);
  const std::size_t n = 2 * vertices.size();
  OwnDirections result{std::vector<bool>(n, false), std::vector<bool>(n, false)};
  for (std::uint32_t v = 0; v < vertices.size(); ++v)
    for (const int sign : {-1, 1}) {
      if (!vertices[v]) continue;
      const auto [average, all_round] = corner_cones.direction(v, sign);
      result.average[signed_index(v, sign)] = average;
      result.all_round[signed_index(v, sign)] = all_round;
    }
  return result;
}

Claim Cones::claim(std::uint32_t v, int sign) const {
  if (sign != 0) return claims_[signed_index(v, sign)];
  const Claim a = claims_[signed_index(v, -1)], b = claims_[signed_index(v, 1)];
  if (a == Claim::within || b == Claim::within) return Claim::within;
  return a == Claim::beyond || b == Claim::beyond ? Claim::beyond : Claim::none;
}

const Cones::Outside* Cones::outside_at(std::uint32_t place) const {
  const auto at = std::lower_bound(outside_.begin(), outside_.end(), place,
                                   [](const Outside& o, std::uint32_t p) { return o.place < p; });
  return at == outside_.end() || at->place != place ? nullptr : &*at;
}

double Cones::outside_deg(std::uint32_t v, int sign) const {
  const auto of = [&](int s) {
    const auto place = static_cast<std::uint32_t>(signed_index(v, s));
    if (claims_[place] != Claim::beyond) return 0.0;
    return double{outside_at(place)->deg};
  };
  if (sign != 0) return of(sign);
  if (claim(v, 0) != Claim::beyond) return 0;
  const double a = of(-1), b = of(1);
  return a == 0 ? b : b == 0 ? a : std::fmin(a, b);
}

Cones Cones::restricted_to(std::span<const std::uint32_t> vertices, double max_angle_deg) const {
  Cones result;
  if (empty()) return result;
  result.claims_.reserve(2 * vertices.size());
  for (std::uint32_t i = 0; i < vertices.size(); ++i)
    for (const int sign : {-1, 1}) {
      const auto place = static_cast<std::uint32_t>(signed_index(vertices[i], sign));
      result.claims_.push_back(claims_[place]);
      const Outside* at = outside_at(place);
      // Where all seams of a part lie on one side of it, averages at the seams all deviate the same way: no
      // evidence of a turn.
      if (at == nullptr || claims_[place] == Claim::within) continue;
      result.outside_.push_back(*at);
      result.outside_.back().place = static_cast<std::uint32_t>(signed_index(i, sign));
    }
  result.hold_if_turned(max_angle_deg);
  return result;
}

}  // namespace darboux
