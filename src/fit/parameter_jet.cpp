#include "parameter_jet.h"

#include <concepts>

#include <darboux/catalogue.h>

namespace darboux {
namespace {

template <class X>
constexpr int parameter_count = [] {
  if constexpr (HasParameters<X>)
    return static_cast<int>(X::parameters().size());
  else
    return 0;
}();

template <class X>
constexpr bool differentiable =
    0 < parameter_count<X>&& parameter_count<X> <= most_parameters && !std::same_as<X, Superellipsoid<>>;

template <class X>
void fill(const X& surface, const Vec2<double>& uv, ParameterJet& result) {
  constexpr int n = parameter_count<X>;
  using D = Dual<double, n>;
  auto dual = rebind<D>(surface);
  constexpr auto parameters = decltype(dual)::parameters();
  for (int k = 0; k < n; ++k) parameters[static_cast<std::size_t>(k)].of(dual).derivative[k] = 1;
  const Jet2<D> j = dual.jet(detail::as_constant<D>(prepare<X::info.u>(uv.x)),
                             detail::as_constant<D>(prepare<X::info.v>(uv.y)));
  result.count = n;
  const auto derivative = [](const Vec3<D>& a, int k) {
    return Vec3<double>{a.x.derivative[k], a.y.derivative[k], a.z.derivative[k]};
  };
  for (int k = 0; k < n; ++k) {
    result.position[k] = derivative(j.position, k);
    result.dpdu[k] = derivative(j.dpdu, k);
    result.dpdv[k] = derivative(j.dpdv, k);
  }
}

// Calls f(the surface as its type), not where that is not of the catalogue or not differentiable.
template <class F, class... Surfaces>
void visit(const AnySurface& surface, SurfaceList<Surfaces...>, F f) {
  const auto is = [&]<class X>(const X*) {
    if constexpr (differentiable<X>) {
      // The types of the catalogue are told apart by the addresses of their infos; only the match is cast.
      if (&surface.info() != &X::info) return false;
      const X* held = surface.get<X>();
      if (held) f(*held);
      return held != nullptr;
    }
    return false;
  };
  (is(static_cast<const Surfaces*>(nullptr)) || ...);
}

}  // namespace

const void* address(const AnySurface& surface) {
  const void* result = nullptr;
  visit(surface, Catalogue{}, [&](const auto& x) { result = &x; });
  return result;
}

ParameterJet parameter_jet(const AnySurface& surface, const Vec2<double>& uv) {
  ParameterJet result;
  visit(surface, Catalogue{}, [&](const auto& x) { fill(x, uv, result); });
  return result;
}

}  // namespace darboux
