#include "parameter_jet.h"

#include <concepts>

#include <darboux/catalogue.h>

#include "base/flatten.h"

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

// The jet at prepared coordinates, and its derivatives. Flattened, so that unused derivatives of the second
// partials are not computed.
template <class X, class U, class V>
DARBOUX_FLATTEN Jet2<double> fill(const X& surface, U u, V v, ParameterJet& by) {
  constexpr int n = parameter_count<X>;
  using D = Dual<double, n>;
  auto dual = rebind<D>(surface);
  constexpr auto parameters = decltype(dual)::parameters();
  for (int k = 0; k < n; ++k) parameters[static_cast<std::size_t>(k)].of(dual).derivative[k] = 1;
  const Jet2<D> j = dual.jet(detail::as_constant<D>(u), detail::as_constant<D>(v));
  by.count = n;
  const auto derivative = [](const Vec3<D>& a, int k) {
    return Vec3<double>{a.x.derivative[k], a.y.derivative[k], a.z.derivative[k]};
  };
  for (int k = 0; k < n; ++k) {
    by.position[k] = derivative(j.position, k);
    by.dpdu[k] = derivative(j.dpdu, k);
    by.dpdv[k] = derivative(j.dpdv, k);
  }
  const auto value = [](const Vec3<D>& a) { return Vec3<double>{a.x.value, a.y.value, a.z.value}; };
  return {value(j.position), value(j.dpdu), value(j.dpdv), value(j.d2pdu2), value(j.d2pduv), value(j.d2pdv2)};
}

template <class X>
Sample<double> sample_of(const void* erased, const Vec2<double>& uv, ParameterJet& by) {
  const X& surface = *static_cast<const X*>(erased);
  const auto u = prepare<X::info.u>(uv.x);
  const auto v = prepare<X::info.v>(uv.y);
  const Jet2<double> j = fill(surface, u, v, by);
  const Status at = detail::status_of_point(surface, uv.x, uv.y, u, v);
  return make_sample(uv.x, uv.y, j, detail::frame_at<double>(surface, u, v, at, j));
}

Sample<double> sample_of_any(const void* erased, const Vec2<double>& uv, ParameterJet&) {
  return static_cast<const AnySurface*>(erased)->sample(uv.x, uv.y);
}

// Calls f(the surface as its type), unless the type is not in the catalogue or not differentiable.
template <class F, class... Surfaces>
void visit(const AnySurface& surface, SurfaceList<Surfaces...>, F f) {
  const auto is = [&]<class X>(const X*) {
    if constexpr (differentiable<X>) {
      // The types of the catalogue are distinguished by the addresses of their infos; only the match is cast.
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
  visit(surface, Catalogue{},
        [&]<class X>(const X& x) { fill(x, prepare<X::info.u>(uv.x), prepare<X::info.v>(uv.y), result); });
  return result;
}

SurfaceWithParameters::SurfaceWithParameters(const AnySurface& surface)
    : surface_(&surface), sample_(&sample_of_any) {
  visit(surface, Catalogue{}, [&]<class X>(const X& x) {
    surface_ = &x;
    parameters_ = parameter_count<X>;
    sample_ = &sample_of<X>;
  });
}

}  // namespace darboux
