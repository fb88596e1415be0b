#include "eval_attributes.h"

#include <algorithm>

#include <darboux/christoffel.h>
#include <darboux/forms.h>
#include <darboux/shape_operator.h>

namespace darboux {
namespace {

std::vector<std::string_view> columns_of(Attribute a) {
  if (a == Attribute::principal_curvatures) return {"_1", "_2"};
  if (a == Attribute::principal_directions) return {"_1_x", "_1_y", "_1_z", "_2_x", "_2_y", "_2_z"};
  if (info_of(a).components == 1) return {""};
  std::vector<std::string_view> names{"_x", "_y", "_z", "_w"};
  names.resize(info_of(a).components);
  return names;
}

void put(const Vec3<double>& a, double* to) {
  std::copy_n(std::array{a.x, a.y, a.z}.begin(), 3, to);
}

constexpr auto dndu = [](const AnySurface& surface, const Sample<double>& s, double* to) {
  put(normal_derivatives(surface, s.u, s.v, s.jet, s.frame).dndu, to);
};
constexpr auto dndv = [](const AnySurface& surface, const Sample<double>& s, double* to) {
  put(normal_derivatives(surface, s.u, s.v, s.jet, s.frame).dndv, to);
};
constexpr auto first = [](const AnySurface&, const Sample<double>& s, double* to) {
  const auto [E, F, G] = first_form(s.jet);
  put({E, F, G}, to);
};
constexpr auto second = [](const AnySurface& surface, const Sample<double>& s, double* to) {
  const auto [L, M, N] = second_form(surface, s.u, s.v, s.jet, s.frame);
  put({L, M, N}, to);
};
constexpr auto symbols = [](const AnySurface& surface, const Sample<double>& s, double* to) {
  const Christoffel<double> symbols = christoffel(surface, s.u, s.v, s.jet, s.frame);
  std::copy_n(symbols.u, 3, to);
  std::copy_n(symbols.v, 3, to + 3);
};
constexpr auto condition = [](const AnySurface&, const Sample<double>& s, double* to) {
  *to = 1 / norm(accurate_cross(unit(s.jet.dpdu), unit(s.jet.dpdv)));
};

}  // namespace

std::span<const EvalAttribute> eval_attributes() {
  static const std::vector<EvalAttribute> all = [] {
    std::vector<EvalAttribute> result;
    for (std::size_t k = 0; k < attribute_count; ++k) {
      const auto a = static_cast<Attribute>(k);
      result.push_back({info_of(a).name, info_of(a).components, columns_of(a),
                        a == Attribute::principal_directions ? std::size_t{3} : 0, a, nullptr});
    }
    const std::vector<std::string_view> xyz{"_x", "_y", "_z"};
    result.push_back({"dndu", 3, xyz, 0, {}, dndu});
    result.push_back({"dndv", 3, xyz, 0, {}, dndv});
    result.push_back({"first_form", 3, {"_E", "_F", "_G"}, 0, {}, first});
    result.push_back({"second_form", 3, {"_L", "_M", "_N"}, 0, {}, second});
    result.push_back(
        {"christoffel", 6, {"_u_uu", "_u_uv", "_u_vv", "_v_uu", "_v_uv", "_v_vv"}, 3, {}, symbols});
    result.push_back({"condition", 1, {""}, 0, {}, condition});
    return result;
  }();
  return all;
}

}  // namespace darboux
