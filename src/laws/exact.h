// A point of a surface in 40 digits, and how far the stated bounds let double and float differ from it.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "law.h"

namespace darboux::laws {

struct ExactFrame {
  Vec3<Multiprecision> t, b, n;
};
// From the partials; n on the side of `handedness` times their cross product.
ExactFrame exact_frame(const Jet2<Multiprecision>& j, double handedness);

// The jet at a point, and those with each input moved: see for_each_neighbour.
struct Exact {
  Vec2<double> uv;
  Jet2<Multiprecision> jet;
  std::vector<Jet2<Multiprecision>> neighbours;

  Exact(const AnySurface& surface, double u, double v);
};

// Error, bound and condition, relative to the quantity's scale; the bound counts roundings with the
// condition.
struct Comparison {
  double error, bound, condition;
};

// The largest component of a - b; infinity if a is not a number.
double largest_difference(const Vec3<Multiprecision>& a, const Vec3<Multiprecision>& b);
template <class S>
double largest_difference(const Vec3<S>& a, const Vec3<Multiprecision>& b) {
  return largest_difference(
      Vec3<Multiprecision>{Multiprecision(a.x), Multiprecision(a.y), Multiprecision(a.z)}, b);
}

// Scales and conditions of the partials at a point.
struct PartialScales {
  std::array<double, 6> scale;      // the given one, or the partial's own size if larger
  std::array<double, 6> condition;  // relative to scale
};
PartialScales partial_scales(const Exact& exact, const std::array<double, 6>& scale);

// A partial of a sample in double or float. None if its scale is beyond the range of S, so that nothing can
// be compared, or if the surface reports that it is beyond the sizes for which it is proven.
template <class S>
std::optional<Comparison> compare_partial(const Exact& exact, const PartialScales& scales,
                                          const Sample<S>& sample, int k);

// t, b, n of a sample. A limit is compared with the nearest one that 40 digits show; none if they show none.
// \param closed whether it is in closed form, or made of partials
template <class S>
std::optional<std::array<Comparison, 3>> compare_frame(const AnySurface& surface, const Exact& exact,
                                                       const PartialScales& scales, const Sample<S>& sample,
                                                       bool closed);

// The factor by which errors of dpdu and dpdv, roundings times (1 + condition) of their scale, are magnified
// in t and n made of them.
double magnified(const Exact& exact, const PartialScales& scales);

// ---- curvatures and forms ---------------------------------------------------------------------------------

// The numbers of a quantity; its error and condition are relative to their 2-norm.
template <class S>
using Numbers = std::vector<S>;
constexpr std::array<std::string_view, 9> form_names{
    "gaussian_curvature", "mean_curvature", "principal_curvatures", "principal_directions", "dndu", "dndv",
    "first_form",         "second_form",    "christoffel"};
constexpr std::size_t k_gaussian = 0, k_mean = 1, k_principal = 2, k_directions = 3;
template <class S>
using AllNumbers = std::array<Numbers<S>, form_names.size()>;

// As computed by the library.
AllNumbers<double> form_numbers(const AnySurface& surface, const Sample<double>& sample);

// Compares with 40 digits at a point where the surface is regular and n lies on the side of `normal`. None
// for numbers that are not given, and for those that vanish, or nearly so, so that 40 digits give no
// condition: they have no relative error. \param partials if given, the error of partials that err as far as
// compare_partial permits is added to the bound
std::array<std::optional<Comparison>, form_names.size()> compare_forms(
    const AnySurface& surface, const Exact& exact, const Vec3<double>& normal, const AllNumbers<double>& own,
    const PartialScales* partials = nullptr);

}  // namespace darboux::laws
