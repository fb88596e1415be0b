#include "uv_kinds.h"

#include <algorithm>
#include <cmath>

#include <darboux/catalogue.h>

#include "any_surface/all_compiled_models.h"
#include "base/flatten.h"
#include "base/text.h"
#include "fit/common/kinds.h"

namespace darboux {
namespace {

// Flattened, so that unused second derivatives are not computed.
template <template <class> class Surface>
DARBOUX_FLATTEN void evaluate(const double* parameters, std::span<const Vec2<double>> uvs, UvBlock& block) {
  constexpr auto info = Surface<double>::info;
  constexpr int N = static_cast<int>(Surface<double>::parameters().size());
  using D = Dual<double, N>;
  constexpr auto list = Surface<D>::parameters();
  Surface<D> surface;
  Surface<double> plain;
  for (int k = 0; k < N; ++k) {
    list[k].of(surface) = D::variable(parameters[k], k);
    Surface<double>::parameters()[k].of(plain) = parameters[k];
  }
  const bool by_parameter = block.by_parameter.rows() > 0, partials = block.by_uv.rows() > 0;
  for (std::size_t i = 0; i < uvs.size(); ++i) {
    const auto u = prepare<info.u>(uvs[i].x);
    const auto v = prepare<info.v>(uvs[i].y);
    const auto row = static_cast<Eigen::Index>(3 * i);
    if (!by_parameter) {
      block.position.segment<3>(row) = to_eigen(plain.jet(u, v).position);
      continue;
    }
    const Vec3<D> p = surface.jet(detail::as_constant<D>(u), detail::as_constant<D>(v)).position;
    block.position.segment<3>(row) << p.x.value, p.y.value, p.z.value;
    for (int k = 0; k < N; ++k)
      block.by_parameter.block<3, 1>(row, k) << p.x.derivative[k], p.y.derivative[k], p.z.derivative[k];
    if (!partials) continue;
    const Jet2<double> jet = plain.jet(u, v);
    block.by_uv.block<3, 1>(row, 0) = to_eigen(jet.dpdu);
    block.by_uv.block<3, 1>(row, 1) = to_eigen(jet.dpdv);
  }
}

// A parameter that is not a length, with the values at which a fit starts; or a length that depends on
// another.
struct Shape {
  std::string_view name;
  std::vector<double> starts;
  std::string_view tied_to{};
};

template <template <class> class Surface>
UvKind kind(const std::vector<Shape>& shapes = {}) {
  const AnySurface surface{Surface<double>{}};
  UvKind result{surface.info().name, surface.parameters(), {}, {{}}, &evaluate<Surface>};
  result.coordinates = {surface.info().u, surface.info().v};
  for (const ParameterValue& p : result.parameters) {
    const auto shape =
        std::find_if(shapes.begin(), shapes.end(), [&](const Shape& s) { return s.name == p.name; });
    const bool listed = shape != shapes.end();
    result.length.push_back(!listed || !shape->tied_to.empty());
    const std::string_view tied_to = listed && !shape->tied_to.empty() ? shape->tied_to : p.name;
    const auto partner = std::find_if(result.parameters.begin(), result.parameters.end(),
                                      [&](const ParameterValue& other) { return other.name == tied_to; });
    result.tied_to.push_back(static_cast<int>(partner - result.parameters.begin()));
    result.may_be_zero.push_back(fit::may_be_zero(surface, result.may_be_zero.size()));
    const std::vector<double> values = listed ? shape->starts : std::vector{p.default_value};
    std::vector<std::vector<double>> product;
    for (const auto& begun : result.starts)
      for (const double value : values) {
        product.push_back(begun);
        product.back().push_back(value);
      }
    result.starts = std::move(product);
  }
  return result;
}

}  // namespace

bool UvKind::linear() const {
  for (int k = 0; k < parameter_count(); ++k)
    if (const auto i = static_cast<std::size_t>(k); !length[i] || tied_to[i] != k) return false;
  return true;
}

bool UvKind::vanishes(int k, double value, double rounding) const {
  const auto i = static_cast<std::size_t>(k);
  return !may_be_zero[i] && std::fabs(value) < std::fmax(1e-6, length[i] ? rounding : 0);
}

const std::vector<UvKind>& uv_kinds() {
  static const std::vector<UvKind> kinds{
      kind<Plane>(),
      kind<Disk>(),
      kind<Sphere>(),
      kind<Cylinder>(),
      kind<Cone>(),
      kind<Torus>(),
      kind<Ellipsoid>(),
      kind<EllipticParaboloid>(),
      kind<HyperbolicParaboloid>(),
      kind<OneSheetHyperboloid>({{"semi_axis_z", {0.15, 0.4, 1, 2.5}, "height"}}),
      kind<TwoSheetHyperboloid>({{"extent", {0.5, 1, 2, 4}}}),
      kind<Helicoid>({{"turns", {0.25, 0.5, 1, 1.5, 2, 3}}}),
      kind<Catenoid>({{"extent", {0.25, 0.5, 1, 2, 4}}}),
      kind<MoebiusStrip>(),
      kind<KleinBottle>(),
      kind<Enneper>({{"extent", {0.25, 0.5, 1, 2}}}),
  };
  return kinds;
}

std::string uv_kind_names() {
  std::vector<std::string> names;
  for (const UvKind& k : uv_kinds()) names.emplace_back(k.name);
  return joined(names);
}

UvKind rigid_kind(const AnySurface& surface) {
  UvKind result{surface.info().name, {{"size", 1, 1, Range::positive(), "", {}}}, {true}, {{1}}, {}};
  result.tied_to = {0};
  result.may_be_zero = {false};
  result.coordinates = {surface.info().u, surface.info().v};
  result.evaluate = [surface](const double* parameters, std::span<const Vec2<double>> uvs, UvBlock& block) {
    for (std::size_t i = 0; i < uvs.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(3 * i);
      const Jet2<double> jet = surface.jet(uvs[i].x, uvs[i].y);
      const Eigen::Vector3d p = to_eigen(jet.position);
      block.position.segment<3>(row) = *parameters * p;
      if (block.by_parameter.rows() > 0) block.by_parameter.col(0).segment<3>(row) = p;
      if (block.by_uv.rows() == 0) continue;
      // If partials are infinite, as on a superellipsoid's edges, a point gives no information about the uv
      // map.
      for (const auto& [column, partial] : {std::pair{0, jet.dpdu}, {1, jet.dpdv}})
        block.by_uv.block<3, 1>(row, column) = detail::finite(partial)
                                                   ? Eigen::Vector3d(*parameters * to_eigen(partial))
                                                   : Eigen::Vector3d::Zero();
    }
  };
  return result;
}

const UvKind* find_uv_kind(std::string_view name) {
  for (const UvKind& k : uv_kinds())
    if (k.name == name) return &k;
  return nullptr;
}

}  // namespace darboux
