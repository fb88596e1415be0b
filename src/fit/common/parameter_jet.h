// The derivatives of a surface of the catalogue with respect to its parameters.
#pragma once

#include <array>

#include <darboux/any_surface.h>

namespace darboux {

constexpr int most_parameters = 12;

// The derivatives of position and first partials with respect to each parameter.
struct ParameterJet {
  int count = 0;
  std::array<Vec3<double>, most_parameters> position, dpdu, dpdv;
};

// The address of the held surface, if its formula can be differentiated with respect to plain numeric
// parameters: the whole catalogue except superellipsoid (dual numbers cannot be exponents) and surfaces
// without parameters. Null for others.
const void* address(const AnySurface& surface);

// Derivatives for surfaces with such an address; else none.
ParameterJet parameter_jet(const AnySurface& surface, const Vec2<double>& uv);

// A surface whose type is looked up once, for many points. Must not outlive the surface it was made from.
class SurfaceWithParameters {
 public:
  explicit SurfaceWithParameters(const AnySurface& surface);

  // The number of parameters.
  int parameters() const { return parameters_; }
  // The surface's sample(), bit for bit, and the derivatives. Further entries of `by` are not changed.
  Sample<double> sample(const Vec2<double>& uv, ParameterJet& by) const { return sample_(surface_, uv, by); }

 private:
  const void* surface_;
  int parameters_ = 0;
  Sample<double> (*sample_)(const void*, const Vec2<double>&, ParameterJet&);
};

}  // namespace darboux
