// The derivatives of a surface of the catalogue by its parameters.
#pragma once

#include <array>

#include <darboux/any_surface.h>

namespace darboux {

constexpr int most_parameters = 12;

// Position and first partials, and their derivatives by each parameter.
struct ParameterJet {
  int count = 0;
  std::array<Vec3<double>, most_parameters> position, dpdu, dpdv;
};

// The address of the surface held, where its parameters are plain numbers by which the formula can be differentiated: all
// of the catalogue but superellipsoid (dual numbers do not carry an exponent) and those without parameters. Null for others.
const void* address(const AnySurface& surface);

// For surfaces that have such an address.
ParameterJet parameter_jet(const AnySurface& surface, const Vec2<double>& uv);

}  // namespace darboux
