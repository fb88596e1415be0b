// A surface chosen at run time as the base of an adaptor.
#pragma once

#include <concepts>
#include <limits>
#include <vector>

#include <darboux/any_surface.h>

namespace darboux {

/// A surface type over AnySurface, both coordinates as they are: for Placed and Reparametrised.
template <bool closed_frame>
struct Held {
  AnySurface surface = all_surfaces().front();

  static constexpr SurfaceInfo info{.name = "surface",
                                    .summary = "a surface chosen at run time",
                                    .u = Coordinate::linear,
                                    .v = Coordinate::linear,
                                    .own_orientation = true,
                                    .frame_error = 8};

  // Scalar types that AnySurface does not support give NaN.
  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    if constexpr (std::same_as<S, float>) {
      return surface.sample_in_float(u, v).jet;
    } else if constexpr (std::same_as<S, double> || std::same_as<S, DualUV> ||
                         std::same_as<S, NestedDualUV> || std::same_as<S, Multiprecision>) {
      return surface.jet(u, v);
    } else {
      const S nan = lift<S>(std::numeric_limits<double>::quiet_NaN());
      const Vec3<S> none{nan, nan, nan};
      return {none, none, none, none, none, none};
    }
  }
  template <std::floating_point S>
  Frame<S> frame(const S& u, const S& v) const requires closed_frame {
    if constexpr (std::same_as<S, float>)
      return surface.sample_in_float(u, v).frame;
    else
      return surface.frame(u, v);
  }
  template <std::floating_point S>
  Status singular(const S& u, const S& v) const {
    return surface.frame(u, v).status & (Status::dpdu_zero | Status::dpdv_zero | Status::parallel);
  }
  // Defined because, for surfaces with parameters, cancelling sums are recomputed in 40 digits; this one
  // needs that too.
  std::vector<ParameterValue> parameter_values() const { return surface.parameters(); }
};

}  // namespace darboux
