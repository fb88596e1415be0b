#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include <Eigen/Geometry>

#include <darboux/compare.h>
#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/triangle.h>
#include <darboux/weld.h>

#include "base/degrees.h"
#include "base/text.h"
#include "triangle_signs.h"

namespace darboux {
namespace {

constexpr double same = 1e-6;  // of the range
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr double absent = std::numeric_limits<double>::lowest();  // marks an attribute that a mesh lacks

// Position, normal, uv.
using Attributes = std::array<double, 8>;

// Two meshes concatenated: the vertices and corners of a, then those of b.
struct Joint {
  std::vector<Attributes> vertices;
  std::vector<Vec4<double>> tangents;
  std::vector<std::uint32_t> vertex_of;  // of each corner
  std::size_t vertices_a, corners_a;

  bool of_a(std::uint32_t corner) const { return corner < corners_a; }
  const Vec4<double>& tangent(std::uint32_t corner) const { return tangents[vertex_of[corner]]; }
};

void append(Joint& joint, const Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(joint.vertices.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3<double>& p = mesh.positions[v];
    const Vec3<double> n = mesh.normals.empty() ? Vec3<double>{absent, absent, absent} : mesh.normals[v];
    const Vec2<double> uv = mesh.uvs.empty() ? Vec2<double>{absent, absent} : mesh.uvs[v];
    Attributes x{p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y};
    for (double& number : x) number += 0.0;  // -0 becomes 0
    joint.vertices.push_back(x);
    joint.tangents.push_back(mesh.tangents.empty() ? Vec4<double>{} : mesh.tangents[v]);
  }
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) joint.vertex_of.push_back(first + v);
}

Joint join(const Mesh& a, const Mesh& b) {
  Joint joint{{}, {}, {}, a.positions.size(), a.corners()};
  joint.vertices.reserve(a.positions.size() + b.positions.size());
  joint.tangents.reserve(joint.vertices.capacity());
  joint.vertex_of.reserve(a.corners() + b.corners());
  append(joint, a);
  append(joint, b);
  return joint;
}

std::uint32_t next(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}
std::uint32_t previous(std::uint32_t corner) {
  return corner % 3 == 0 ? corner + 2 : corner - 1;
}

// ---- which vertices are the same --------------------------------------------------------------------------

// Items with equal labels are the same; an item with label `none` is the same as nothing.
using Labels = std::vector<std::uint32_t>;

struct HashOfBits {
  std::size_t operator()(std::span<const double> numbers) const {
    std::uint64_t h = 0;
    for (const double x : numbers) {
      h = (h ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15ull;
      h ^= h >> 32;
    }
    return h;
  }
};

// Labels for used vertices with equal finite attributes; the label is the first such vertex.
Labels label_by_bits(const Joint& joint) {
  const auto hash = [&](std::uint32_t v) { return HashOfBits{}(joint.vertices[v]); };
  const auto equal = [&](std::uint32_t v, std::uint32_t w) { return joint.vertices[v] == joint.vertices[w]; };
  std::vector<bool> used(joint.vertices.size(), false);
  for (const std::uint32_t v : joint.vertex_of) used[v] = true;
  std::unordered_set<std::uint32_t, decltype(hash), decltype(equal)> known(joint.vertices.size(), hash,
                                                                           equal);
  Labels labels(joint.vertices.size(), none);
  for (std::uint32_t v = 0; v < labels.size(); ++v) {
    const Attributes& x = joint.vertices[v];
    if (used[v] && std::all_of(x.begin(), x.end(), [](double k) { return std::isfinite(k); }))
      labels[v] = *known.insert(v).first;
  }
  return labels;
}

// Calls f(members) for each set of items of one label, items in order.
template <class F>
void for_each_label(const Labels& labels, std::size_t label_count, F f) {
  std::vector<std::uint32_t> begin(label_count + 1, 0), items(labels.size());
  for (const std::uint32_t label : labels)
    if (label != none) ++begin[label + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> end(begin.begin(), std::prev(begin.end()));
  for (std::uint32_t i = 0; i < labels.size(); ++i)
    if (labels[i] != none) items[end[labels[i]]++] = i;
  for (std::size_t k = 0; k < label_count; ++k)
    if (begin[k] < end[k]) f(std::span<std::uint32_t>(items.data() + begin[k], items.data() + end[k]));
}

// Splits vertices of one label where one of their numbers has a gap wider than the tolerance.
void part(Labels& labels, const Joint& joint, std::size_t first, std::size_t last, double tolerance) {
  for (std::size_t k = first; k < last; ++k) {
    const auto number = [&](std::uint32_t v) { return joint.vertices[v][k]; };
    for_each_label(Labels(labels), labels.size(), [&](std::span<std::uint32_t> vertices) {
      std::sort(vertices.begin(), vertices.end(),
                [&](auto v, auto w) { return number(v) != number(w) ? number(v) < number(w) : v < w; });
      std::uint32_t label = vertices[0];
      for (std::size_t i = 1; i < vertices.size(); ++i) {
        if (number(vertices[i]) - number(vertices[i - 1]) > tolerance) label = vertices[i];
        labels[vertices[i]] = label;
      }
      labels[vertices[0]] = vertices[0];
    });
  }
}

// Labels for attributes that are the same within the tolerance.
struct NearLabels {
  Labels position, position_uv, position_normal, all;
};

NearLabels label_by_distance(const Joint& joint, const Labels& exact) {
  std::vector<Vec3<double>> points(exact.size(), detail::nan_vector<double>());
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox2d uv_box;
  for (std::uint32_t v = 0; v < exact.size(); ++v) {
    if (exact[v] != v) continue;
    const Attributes& x = joint.vertices[v];
    points[v] = {x[0], x[1], x[2]};
    box.extend(to_eigen(points[v]));
    if (x[6] != absent) uv_box.extend(Eigen::Vector2d(x[6], x[7]));
  }
  NearLabels near;
  const double tolerance = box.isEmpty() ? 0 : same * norm(from_eigen(box.sizes()));
  near.position = weld(points, tolerance);
  for (std::uint32_t v = 0; v < exact.size(); ++v)
    near.position[v] = exact[v] == none ? none : near.position[exact[v]];
  near.position_normal = near.position_uv = near.position;
  part(near.position_uv, joint, 6, 8, uv_box.isEmpty() ? 0 : same * uv_box.sizes().maxCoeff());
  part(near.position_normal, joint, 3, 6, 2 * same);
  near.all = near.position_uv;
  part(near.all, joint, 3, 6, 2 * same);
  return near;
}

// ---- which corners are the same ---------------------------------------------------------------------------

using Bits = std::array<std::uint64_t, 4>;
Bits bits(const Vec4<double>& t) {
  return std::bit_cast<Bits>(t);
}

// A corner among those of one label.
struct Entry {
  std::uint64_t neighbours;  // the labels of the next and the previous corner
  std::int64_t along;  // the tangent's component along a fixed direction, as a number that also orders NaN
  std::uint32_t corner;
};

// A direction in which no two tangents of a symmetric mesh have equal components.
std::int64_t along(const Vec4<double>& t) {
  const auto b = std::bit_cast<std::int64_t>(0.7548 * t.x + 0.5698 * t.y + 0.3247 * t.z);
  return b < 0 ? b ^ std::numeric_limits<std::int64_t>::max() : b;
}

// The matching corner of the other mesh for each corner, or none.
using Partners = std::vector<std::uint32_t>;

// Pairs corners of a and of b that are the same, both in the order of their tangents.
void pair_up(const Joint& joint, std::span<const Entry> a, std::span<const Entry> b, Partners& partners) {
  const auto pair = [&](const Entry& x, const Entry& y) {
    partners[x.corner] = y.corner;
    partners[y.corner] = x.corner;
  };
  if (a.size() == 1 && b.size() == 1) return pair(a[0], b[0]);
  std::vector<Entry> rest_a, rest_b;
  while (!a.empty() && !b.empty()) {
    const auto key = [&](const Entry& e) { return std::pair(e.along, bits(joint.tangent(e.corner))); };
    const auto order = key(a[0]) <=> key(b[0]);
    if (order == 0) pair(a[0], b[0]);
    if (order < 0) rest_a.push_back(a[0]);
    if (order > 0) rest_b.push_back(b[0]);
    if (order <= 0) a = a.subspan(1);
    if (order >= 0) b = b.subspan(1);
  }
  rest_a.insert(rest_a.end(), a.begin(), a.end());
  rest_b.insert(rest_b.end(), b.begin(), b.end());
  for (std::size_t i = 0; i < std::min(rest_a.size(), rest_b.size()); ++i) pair(rest_a[i], rest_b[i]);
}

// Matches the corners that have no partner yet.
void match(const Joint& joint, const Labels& labels, Partners& partners) {
  const auto label = [&](std::uint32_t corner) { return labels[joint.vertex_of[corner]]; };
  Labels of_corner(joint.vertex_of.size());
  for (std::uint32_t c = 0; c < of_corner.size(); ++c)
    of_corner[c] =
        partners[c] != none || label(next(c)) == none || label(previous(c)) == none ? none : label(c);
  std::vector<Entry> entries;
  for_each_label(of_corner, labels.size(), [&](std::span<const std::uint32_t> corners) {
    if (!joint.of_a(corners.front()) || joint.of_a(corners.back())) return;
    entries.clear();
    for (const std::uint32_t c : corners)
      entries.push_back(
          {std::uint64_t{label(next(c))} << 32 | label(previous(c)), along(joint.tangent(c)), c});
    std::sort(entries.begin(), entries.end(), [&](const Entry& x, const Entry& y) {
      if (x.neighbours != y.neighbours) return x.neighbours < y.neighbours;
      if (joint.of_a(x.corner) != joint.of_a(y.corner)) return joint.of_a(x.corner);
      if (x.along != y.along) return x.along < y.along;
      const Bits s = bits(joint.tangent(x.corner)), t = bits(joint.tangent(y.corner));
      return s != t ? s < t : x.corner < y.corner;
    });
    for (auto begin = entries.begin(); begin != entries.end();) {
      const auto end = std::find_if(begin, entries.end(),
                                    [&](const Entry& e) { return e.neighbours != begin->neighbours; });
      const auto middle = std::find_if(begin, end, [&](const Entry& e) { return !joint.of_a(e.corner); });
      pair_up(joint, {begin, middle}, {middle, end}, partners);
      begin = end;
    }
  });
}

struct Matching {
  Partners partners;
  Unmatched unmatched_a, unmatched_b;
};

void count_unmatched(const Joint& joint, const NearLabels& near, Matching& matching) {
  // Bit 0: a corner of a has this label; bit 1: one of b.
  const auto presence = [&](const Labels& labels) {
    std::vector<std::uint8_t> present(labels.size(), 0);
    for (std::uint32_t c = 0; c < joint.vertex_of.size(); ++c)
      if (const std::uint32_t label = labels[joint.vertex_of[c]]; label != none)
        present[label] |= joint.of_a(c) ? 1 : 2;
    return present;
  };
  const auto position = presence(near.position), uv = presence(near.position_uv),
             normal = presence(near.position_normal), all = presence(near.all);
  for (std::uint32_t c = 0; c < joint.vertex_of.size(); ++c) {
    if (matching.partners[c] != none) continue;
    Unmatched& count = joint.of_a(c) ? matching.unmatched_a : matching.unmatched_b;
    const std::uint32_t v = joint.vertex_of[c];
    const auto other_has = [&](const std::vector<std::uint8_t>& present, const Labels& labels) {
      return (present[labels[v]] & (joint.of_a(c) ? 2 : 1)) != 0;
    };
    const auto finite = [&](std::uint32_t corner) { return near.all[joint.vertex_of[corner]] != none; };
    if (!finite(c) || !finite(next(c)) || !finite(previous(c)))
      ++count.not_finite;
    else if (!other_has(position, near.position))
      ++count.position;
    else if (other_has(all, near.all))
      ++count.triangle;
    else if (other_has(normal, near.position_normal))
      ++count.uv;
    else if (other_has(uv, near.position_uv))
      ++count.normal;
    else
      ++count.uv_and_normal;
  }
}

Matching match_corners(const Joint& joint) {
  Matching result{Partners(joint.vertex_of.size(), none), {}, {}};
  const Labels exact = label_by_bits(joint);
  match(joint, exact, result.partners);
  const auto alone = [](std::uint32_t partner) { return partner == none; };
  if (std::none_of(result.partners.begin(), result.partners.end(), alone)) return result;
  const NearLabels near = label_by_distance(joint, exact);
  match(joint, near.all, result.partners);
  count_unmatched(joint, near, result);
  return result;
}

std::size_t matched_with_v_flipped(const Mesh& a, Mesh b) {
  for (Vec2<double>& uv : b.uvs) uv.y = 1 - uv.y;
  const Matching matching = match_corners(join(a, b));
  return a.corners() - matching.unmatched_a.total();
}

// ---- their tangents ---------------------------------------------------------------------------------------

bool has_direction(const Vec4<double>& t) {
  return detail::finite(t.xyz()) && t.xyz() != Vec3<double>{};
}

// 1 if the uvs of the corner's triangle run counter-clockwise, -1 if clockwise, 0 without uv area.
int raw_sign(const Joint& joint, std::uint32_t corner) {
  const auto uv = [&](std::uint32_t c) {
    const Attributes& x = joint.vertices[joint.vertex_of[c]];
    return Vec2<double>{x[6], x[7]};
  };
  const auto p = uv(corner), q = uv(next(corner)), r = uv(previous(corner));
  return triangle_sign(p, q, r);
}

void compare_tangents(const Joint& joint, const Partners& partners, double max_angle_deg,
                      MeshComparison& result) {
  std::vector<double> angles;
  std::size_t same_signs = 0, a_raw = 0, a_gltf = 0, within = 0;
  for (std::uint32_t c = 0; c < joint.corners_a; ++c) {
    if (partners[c] == none) continue;
    const Vec4<double>&s = joint.tangent(c), &t = joint.tangent(partners[c]);
    const Bits p = bits(s), q = bits(t);
    const bool equal = p == q;
    result.equal_bits += equal;
    result.equal_directions += std::equal(p.begin(), p.begin() + 3, q.begin());
    if (s.w * t.w > 0) ++same_signs;
    if (s.w * t.w < 0) {
      ++result.opposite_signs;
      const int raw = raw_sign(joint, c);
      a_raw += raw * s.w > 0;
      a_gltf += raw * s.w < 0;
    }
    if (!has_direction(s) || !has_direction(t)) {
      ++result.no_direction;
      within += equal;
      continue;
    }
    const double deg = equal ? 0 : degrees_per_radian * angle_between(s.xyz(), t.xyz());
    angles.push_back(deg);
    within += equal || (max_angle_deg > 0 && deg <= max_angle_deg && s.w == t.w);
    if (!equal && (!result.worst || deg > result.worst->deg))
      result.worst = {joint.vertex_of[c],
                      joint.vertex_of[partners[c]] - static_cast<std::uint32_t>(joint.vertices_a), deg};
  }
  if (!angles.empty()) result.tangent_deg = summarise(angles);
  if (same_signs + result.opposite_signs > 0)
    result.sign = same_signs == 0              ? SignAgreement::opposite
                  : result.opposite_signs == 0 ? SignAgreement::same
                                               : SignAgreement::mixed;
  if (result.sign == SignAgreement::opposite && (a_raw == 0) != (a_gltf == 0)) result.a_is_raw = a_raw > 0;
  result.same = result.matched > 0 && result.matched == result.corners_a &&
                result.matched == result.corners_b && within == result.matched;
}

// ---- pieces of files --------------------------------------------------------------------------------------

constexpr double agreeing = 0.01;  // of the diagonal

using Box = Eigen::AlignedBox3d;

Box box_of(const Mesh& mesh) {
  Box box;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (detail::finite(mesh.positions[v])) box.extend(to_eigen(mesh.positions[v]));
  return box;
}

// The distance between the faces of two boxes, as a share of the diagonal of the larger.
double distance(const Box& a, const Box& b) {
  if (a.isEmpty() || b.isEmpty())
    return a.isEmpty() && b.isEmpty() ? 0 : std::numeric_limits<double>::infinity();
  const double apart =
      std::max((a.min() - b.min()).cwiseAbs().maxCoeff(), (a.max() - b.max()).cwiseAbs().maxCoeff());
  return apart == 0 ? 0 : apart / std::max(a.diagonal().norm(), b.diagonal().norm());
}

}  // namespace

MeshComparison compare(const Mesh& a, const Mesh& b, const CompareOptions& options) {
  if (!(options.max_angle_deg >= 0 && options.max_angle_deg <= 180))
    throw ParameterError("max_angle_deg",
                         expected_got("0 <= degrees <= 180", shortest(options.max_angle_deg)));
  check_consistent(a, "compare: first mesh");
  check_consistent(b, "compare: second mesh");
  const Joint joint = join(a, b);
  const Matching matching = match_corners(joint);
  MeshComparison result;
  result.corners_a = a.corners();
  result.corners_b = b.corners();
  result.matched = a.corners() - matching.unmatched_a.total();
  result.unmatched_a = matching.unmatched_a;
  result.unmatched_b = matching.unmatched_b;
  result.tangents_a = !a.tangents.empty();
  result.tangents_b = !b.tangents.empty();
  const auto other_uvs = [](const Unmatched& u) { return u.uv + u.uv_and_normal > 0; };
  if ((other_uvs(result.unmatched_a) || other_uvs(result.unmatched_b)) && !a.uvs.empty() && !b.uvs.empty())
    result.matched_with_v_flipped = matched_with_v_flipped(a, b);
  if (result.tangents_a && result.tangents_b)
    compare_tangents(joint, matching.partners, options.max_angle_deg, result);
  return result;
}

MeshPairs pair_meshes(std::span<const NamedMesh> a, std::span<const NamedMesh> b) {
  for (const auto& list : {a, b})
    for (const NamedMesh& m : list)
      if (m.data == nullptr) throw MeshError(std::string(m.name), expected_got("a mesh", "a null pointer"));
  std::vector<Box> box_a, box_b;
  for (const NamedMesh& m : a) box_a.push_back(box_of(*m.data));
  for (const NamedMesh& m : b) box_b.push_back(box_of(*m.data));
  const std::size_t unpaired = b.size();
  std::vector<std::size_t> partner(a.size(), unpaired);
  std::vector<bool> taken(b.size(), false);
  const auto take = [&](std::size_t i, std::size_t j) {
    if (partner[i] != unpaired || taken[j]) return;
    partner[i] = j;
    taken[j] = true;
  };
  const auto agree = [&](std::size_t i, std::size_t j) { return distance(box_a[i], box_b[j]) <= agreeing; };

  // The indices at which each name or place occurs in the two files.
  using Found = std::array<std::vector<std::size_t>, 2>;
  std::map<std::pair<std::string_view, std::size_t>, Found> names;
  std::map<std::pair<std::size_t, std::size_t>, Found> places;
  for (const std::size_t file : {0, 1}) {
    const auto list = file == 0 ? a : b;
    for (std::size_t i = 0; i < list.size(); ++i) {
      names[{list[i].name, list[i].primitive}][file].push_back(i);
      places[{list[i].mesh, list[i].primitive}][file].push_back(i);
    }
  }
  const auto take_if = [&](const auto& found, const auto& condition) {
    for (const auto& [key, indices] : found)
      if (indices[0].size() == 1 && indices[1].size() == 1 && condition(indices[0][0], indices[1][0]))
        take(indices[0][0], indices[1][0]);
  };
  take_if(names, [&](std::size_t i, std::size_t) { return !a[i].name.empty(); });
  take_if(places, agree);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t nearest = unpaired;
    for (std::size_t j = 0; partner[i] == unpaired && j < b.size(); ++j)
      if (!taken[j] && agree(i, j) &&
          (nearest == unpaired || distance(box_a[i], box_b[j]) < distance(box_a[i], box_b[nearest])))
        nearest = j;
    if (nearest != unpaired) take(i, nearest);
  }
  take_if(places, [](std::size_t, std::size_t) { return true; });

  MeshPairs result;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (partner[i] == unpaired)
      result.only_a.push_back(i);
    else
      result.pairs.emplace_back(i, partner[i]);
  for (std::size_t j = 0; j < b.size(); ++j)
    if (!taken[j]) result.only_b.push_back(j);
  return result;
}

}  // namespace darboux
