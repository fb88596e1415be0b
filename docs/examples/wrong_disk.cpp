// A surface that is deliberately wrong: a disk over its radius, with a factor 2 lost in dpdu and a sign lost
// in dpdv, as shipped renderers have had them. Its laws say so.
#include <cstdio>

#include <darboux/testing.h>

struct WrongDisk {
  static constexpr darboux::SurfaceInfo info{
      "wrong-disk", "unit disk, v inward", darboux::Coordinate::turn, darboux::Coordinate::linear, {"v=1"}};

  template <class S>
  darboux::Jet2<S> jet(const darboux::Turn<S>& u, const S& v) const {
    const S zero = darboux::lift<S>(0.0), tau = darboux::two_pi<S>(), pi = darboux::pi<S>();
    const S rho = darboux::lift<S>(1.0) - v;
    return {.position = {rho * u.cos, rho * u.sin, zero},
            .dpdu = {-(pi * (rho * u.sin)), pi * (rho * u.cos), zero},  // 2π, not π
            .dpdv = {u.cos, u.sin, zero},                               // -cos, -sin
            .d2pdu2 = {-(tau * (tau * (rho * u.cos))), -(tau * (tau * (rho * u.sin))), zero},
            .d2pduv = {tau * u.sin, -(tau * u.cos), zero},
            .d2pdv2 = {zero, zero, zero}};
  }
  template <class S>
  darboux::Status singular(const darboux::Turn<S>&, const S& v) const {
    return v == darboux::lift<S>(1.0) ? darboux::Status::dpdu_zero : darboux::Status::regular;
  }
  template <class S>
  S implicit(const darboux::Vec3<S>& p) const {
    return p.z;
  }
};

int main() {
  const std::string broken =
      darboux::broken_laws(WrongDisk{}, {.points = 100, .routes = {"dual", "central8"}});
  std::printf("%s", broken.c_str());
  return broken.empty() ? 1 : 0;
}
