/// \file attributes.h
/// The attributes that can be evaluated at a point, and the number of components of each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace darboux {

/// An attribute of a point, named as on the command line; formulas and signs: docs/conventions.md.
enum class Attribute : std::uint8_t {
  position,  ///< a length
  dpdu,      ///< a length, as are all partials: u and v have no unit
  dpdv,
  d2pdu2,
  d2pduv,
  d2pdv2,
  tangent,               ///< unit, along dpdu
  bitangent,             ///< unit, n × t
  normal,                ///< unit
  handedness,            ///< +1 or -1, the sign of det(dpdu, dpdv, n)
  tangent4,              ///< tangent and sign w, in the requested convention
  gaussian_curvature,    ///< 1 / length²
  mean_curvature,        ///< 1 / length; negative on a sphere whose n points outward
  principal_curvatures,  ///< κ1 >= κ2, 1 / length; same sign convention
  principal_directions,  ///< two unit vectors
};
inline constexpr std::size_t attribute_count = 15;

struct AttributeInfo {
  std::string_view name;
  std::size_t components;
};
/// Indexed by Attribute.
inline constexpr std::array<AttributeInfo, attribute_count> attribute_infos{{{"position", 3},
                                                                             {"dpdu", 3},
                                                                             {"dpdv", 3},
                                                                             {"d2pdu2", 3},
                                                                             {"d2pduv", 3},
                                                                             {"d2pdv2", 3},
                                                                             {"tangent", 3},
                                                                             {"bitangent", 3},
                                                                             {"normal", 3},
                                                                             {"handedness", 1},
                                                                             {"tangent4", 4},
                                                                             {"gaussian_curvature", 1},
                                                                             {"mean_curvature", 1},
                                                                             {"principal_curvatures", 2},
                                                                             {"principal_directions", 6}}};
inline constexpr std::size_t most_components = 6;
/// The total number of components of all attributes.
inline constexpr std::size_t all_components = [] {
  std::size_t sum = 0;
  for (const AttributeInfo& a : attribute_infos) sum += a.components;
  return sum;
}();

constexpr const AttributeInfo& info_of(Attribute a) {
  return attribute_infos[static_cast<std::size_t>(a)];
}

/// A set of attributes.
class Attributes {
 public:
  constexpr Attributes() = default;
  constexpr Attributes(Attribute a) : bits_(1u << static_cast<unsigned>(a)) {}  // NOLINT: converting
  constexpr bool has(Attribute a) const { return (bits_ >> static_cast<unsigned>(a) & 1u) != 0; }
  constexpr bool has_any(Attributes of) const { return (bits_ & of.bits_) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  friend constexpr Attributes operator|(Attributes a, Attributes b) {
    a.bits_ |= b.bits_;
    return a;
  }
  constexpr Attributes& operator|=(Attributes b) { return *this = *this | b; }
  friend constexpr bool operator==(Attributes, Attributes) = default;

 private:
  std::uint32_t bits_ = 0;
};
constexpr Attributes operator|(Attribute a, Attribute b) {
  return Attributes(a) | Attributes(b);
}

/// The attributes grouped by what they require: the partials; the frame; at most the first partials and the
/// frame; the curvatures.
inline constexpr Attributes partial_attributes = Attribute::position | Attribute::dpdu | Attribute::dpdv |
                                                 Attribute::d2pdu2 | Attribute::d2pduv | Attribute::d2pdv2;
inline constexpr Attributes frame_attributes = Attribute::tangent | Attribute::bitangent | Attribute::normal |
                                               Attribute::handedness | Attribute::tangent4;
inline constexpr Attributes first_attributes =
    Attribute::position | Attribute::dpdu | Attribute::dpdv | frame_attributes;
inline constexpr Attributes curvature_attributes = Attribute::gaussian_curvature | Attribute::mean_curvature |
                                                   Attribute::principal_curvatures |
                                                   Attribute::principal_directions;

}  // namespace darboux
