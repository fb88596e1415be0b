#include "law.h"

#include <random>

namespace darboux::laws {

Points::Points(const AnySurface& surface, const CheckOptions& options) : name(surface.info().name) {
  std::mt19937_64 random(options.seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < options.points; ++i) {
    const double u = uniform(random), v = uniform(random);
    list.push_back({u, v, surface.jet(u, v), surface.frame(u, v)});
    for (int k = 0; k < 6; ++k) {
      const double size = norm(partial(list.back().j, k));
      if (!(size <= scale[k])) scale[k] = size;
      if (std::isnan(size)) not_a_number = {u, v};
    }
    const Jet2<DualUV> d = surface.jet(DualUV::variable(u, 0), DualUV::variable(v, 1));
    third[0] = std::fmax(third[0], norm(derivative(d.d2pdu2, 0)));
    third[1] = std::fmax(third[1], norm(derivative(d.d2pdv2, 1)));
  }
  for (std::size_t k = 0; k < 6; ++k) {
    double& s = scale[k];
    vanishes[k] = s == 0;
    if (vanishes[k]) s = scale[0];
    representable = representable && s < 1e300 && s > 1e-290;
  }
  if (!representable) return;
  const std::vector<ParameterValue> parameters = surface.parameters();
  for (Point& p : list) {
    const Inputs inputs(p.u, p.v, parameters);
    const Jet2<Multiprecision> exact = multiprecision_jet(surface, inputs);
    for_each_neighbour(surface, inputs, [&](const Jet2<Multiprecision>& moved) {
      for (int k = 0; k < 6; ++k)
        p.condition[k] += norm(rounded(partial(moved, k) - partial(exact, k))) / relative_change / scale[k];
    });
  }
}

double frame_condition(const Points& points, const Point& p, const Vec3<double>& dpdu,
                       const Vec3<double>& dpdv) {
  const double sine = norm(cross(unit(dpdu), unit(dpdv)));
  return (points.scale[1] / norm(dpdu) * (1 + p.condition[1]) +
          points.scale[2] / norm(dpdv) * (1 + p.condition[2])) /
         sine;
}

}  // namespace darboux::laws
