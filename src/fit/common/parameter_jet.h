// The derivatives of a surface of the catalogue with respect to its parameters.
#pragma once

#include <array>

#include <darboux/any_surface.h>

namespace darboux {

constexpr int most_parameters = 12;

// The derivatives of position and first partials by each parameter.
struct ParameterJet {
  int count = 0;
  std::array<Vec3<double>, most_parameters> position, dpdu, dpdv;
};

// The address of the surface held, where its parameters are plain numbers by which the formula can be
// differentiated: all of the catalogue but superellipsoid (dual numbers do not carry an exponent) and those
// without parameters. Null for others.
const void* address(const AnySurface& surface);

// For surfaces that have such an address; else there are none.
ParameterJet parameter_jet(const AnySurface& surface, const Vec2<double>& uv);

// A surface with its type found out, for many points; it must not outlive what it was made of.
class SurfaceWithParameters {
 public:
  explicit SurfaceWithParameters(const AnySurface& surface);

  // How many there are to differentiate by.
  int parameters() const { return parameters_; }
  // The sample() of the surface to the bit, and the derivatives. What `by` holds beyond their number stays.
  Sample<double> sample(const Vec2<double>& uv, ParameterJet& by) const { return sample_(surface_, uv, by); }

 private:
  const void* surface_;
  int parameters_ = 0;
  Sample<double> (*sample_)(const void*, const Vec2<double>&, ParameterJet&);
};

}  // namespace darboux
