// A surface of one's own, not in the catalogue: its formula once, its laws checked, then used like any other.
#include <cstdio>

#include <darboux/testing.h>

/// Plücker's conoid: a line that turns once about the z axis while it rises and falls twice.
///   P(u, v) = (ρ cos 2πu, ρ sin 2πu, h cos 4πu), ρ = r v
/// u runs round the axis in turns, v outward from the axis (0) to the rim (1). All lines meet the axis, where
/// the surface passes through itself; at the quarter turns of u dpdu vanishes there too.
template <class T = double>
struct PluckerConoid {
  T radius{1}, height{0.25};

  static constexpr darboux::SurfaceInfo info{"plucker-conoid",
                                             "line turning about z, rising and falling twice",
                                             darboux::Coordinate::turn,
                                             darboux::Coordinate::linear,
                                             {"v=0"}};
  static constexpr auto parameters() {
    return std::array{darboux::parameter<&PluckerConoid::radius>("radius", darboux::Range::positive(),
                                                                 "length of the line"),
                      darboux::parameter<&PluckerConoid::height>("height", darboux::Range::positive(),
                                                                 "how far it rises and falls")};
  }

  template <class S>
  constexpr darboux::Jet2<S> jet(const darboux::Turn<S>& u, const S& v) const {
    const S r = darboux::lift<S>(radius), h = darboux::lift<S>(height), zero = darboux::lift<S>(0.0);
    const S tau = darboux::two_pi<S>(), four = darboux::lift<S>(4.0);
    const S rho = r * v, z = h * (u.cos * u.cos - u.sin * u.sin);
    const S slope = -(four * (h * (u.sin * u.cos)));  // dz/d(2πu)
    return {.position = {rho * u.cos, rho * u.sin, z},
            .dpdu = {-(tau * (rho * u.sin)), tau * (rho * u.cos), tau * slope},
            .dpdv = {r * u.cos, r * u.sin, zero},
            .d2pdu2 = {-(tau * (tau * (rho * u.cos))), -(tau * (tau * (rho * u.sin))),
                       -(tau * (tau * (four * z)))},
            .d2pduv = {-(tau * (r * u.sin)), tau * (r * u.cos), zero},
            .d2pdv2 = {zero, zero, zero}};
  }

  /// On the axis the surface meets itself; the tangent along u is lost where the line turns over.
  template <class S>
  constexpr darboux::Status singular(const darboux::Turn<S>& u, const S& v) const {
    const S zero = darboux::lift<S>(0.0);
    if (!(v == zero)) return darboux::Status::regular;
    return u.sin * u.cos == zero ? darboux::Status::self_intersecting | darboux::Status::dpdu_zero
                                 : darboux::Status::self_intersecting;
  }

  /// (h (x² - y²)/d² - z) / sqrt(1 + (4 h x y/d³)²), d the distance from the axis: the depth below the
  /// surface over the length of its gradient
  template <class S>
  S implicit(const darboux::Vec3<S>& p) const {
    const S h = darboux::lift<S>(height), one = darboux::lift<S>(1.0), four = darboux::lift<S>(4.0);
    const S d = norm(darboux::Vec2<S>{p.x, p.y}), x = p.x / d, y = p.y / d;
    return (h * (x * x - y * y) - p.z) / norm(darboux::Vec2<S>{one, four * (h * (x * y)) / d});
  }

  /// K = -(s / (ρ² + s²))², s = dz/d(2πu) = -2 h sin 4πu
  template <class S>
  constexpr S gaussian_curvature(const darboux::Turn<S>& u, const S& v) const {
    const S rho = darboux::lift<S>(radius) * v;
    const S s = -(darboux::lift<S>(4.0) * (darboux::lift<S>(height) * (u.sin * u.cos)));
    const S k = s / (rho * rho + s * s);
    return -(k * k);
  }
};

int main() {
  const PluckerConoid<double> conoid{2.0, 0.5};
  const std::string broken = darboux::broken_laws(conoid);
  std::printf("%s", broken.empty() ? "every law holds\n" : broken.c_str());

  // The laws, one by one: what was compared, and what does not apply.
  for (const darboux::Check& c :
       darboux::check_surface(conoid, {.routes = {"implicit", "curvature", "gauss_bonnet"}}))
    std::printf("%-12s %-20s %s\n", std::string(c.route).c_str(), std::string(c.quantity).c_str(),
                c.skipped.empty() ? "holds" : c.skipped.c_str());

  const darboux::AnySurface surface = conoid;
  const darboux::Sample<double> s = surface.sample(0.125, 0.5);
  std::printf("\n%s\n", surface.specification().c_str());
  std::printf("n at (0.125, 0.5): %.16g %.16g %.16g\n", s.frame.n.x, s.frame.n.y, s.frame.n.z);
  const bool lost = has(surface.frame(0, 0).status, darboux::Status::no_frame);
  std::printf("frame at (0, 0): %s\n", lost ? "none" : "there is one");
  return broken.empty() ? 0 : 1;
}
