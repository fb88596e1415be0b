// The routes: the ways to evaluate a quantity at (u, v).
#include <cmath>
#include <iterator>
#include <numbers>

#include <darboux/differentiate.h>
#include <darboux/error.h>
#include <darboux/forms.h>
#include <darboux/mesh_frames.h>
#include <darboux/stability.h>

#include "base/text.h"
#include "laws/exact.h"

namespace darboux {
namespace {

using laws::rounded;

void say_partials(StabilityAnswer& answer, const Jet2<double>& j) {
  for (int k = 0; k < 6; ++k) answer.partials[static_cast<std::size_t>(k)] = laws::partial(j, k);
}

StabilityAnswer in_double(const StabilityPoint& p) {
  StabilityAnswer answer;
  const Sample<double> sample = p.surface.sample(p.u, p.v);
  say_partials(answer, sample.jet);
  answer.frame = sample.frame;
  if (sample.frame.status == Status::regular) answer.forms = laws::form_numbers(p.surface, sample);
  return answer;
}

StabilityAnswer in_float(const StabilityPoint& p) {
  StabilityAnswer answer;
  const Sample<float> s = p.surface.sample_in_float(static_cast<float>(p.u), static_cast<float>(p.v));
  for (int k = 0; k < 6; ++k) answer.partials[static_cast<std::size_t>(k)] = rounded(laws::partial(s.jet, k));
  answer.frame = Frame<double>{rounded(s.frame.t), rounded(s.frame.b), rounded(s.frame.n), s.frame.handedness,
                               s.frame.status};
  return answer;
}

// ---- as textbooks write it --------------------------------------------------------------------------------

// The coordinate whose angle is 2πx rounded to double: libm's sine of that angle, up to its own rounding.
Multiprecision by_rounded_angle(double x, Coordinate kind) {
  if (kind == Coordinate::linear) return x;
  const double per_unit = kind == Coordinate::turn ? 2 * std::numbers::pi : std::numbers::pi;
  const double angle = per_unit * x;
  const Multiprecision pi = Multiprecision::pi();
  return Multiprecision(angle) / (kind == Coordinate::turn ? Multiprecision(2.0) * pi : pi);
}

Vec3<double> plain_unit(const Vec3<double>& a) {
  return a / std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
}
Vec3<double> plain_cross(const Vec3<double>& a, const Vec3<double>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// [doCarmo2016, sec. 3-3 and 4-3]
std::array<std::vector<double>, 9> textbook_forms(const Jet2<double>& j, const Vec3<double>& n) {
  const auto [E, F, G] = first_form(j);
  const auto [L, M, N] = second_form(j, n);
  const double area = E * G - F * F;
  const double K = (L * N - M * M) / area, H = (E * N - 2 * F * M + G * L) / (2 * area);
  const double apart = std::sqrt(H * H - K);
  const Vec3<double> dndu = ((M * F - L * G) * j.dpdu + (L * F - M * E) * j.dpdv) / area;
  const Vec3<double> dndv = ((N * F - M * G) * j.dpdu + (M * F - N * E) * j.dpdv) / area;
  std::vector<double> of_u, of_v;
  for (const Vec3<double>* second : {&j.d2pdu2, &j.d2pduv, &j.d2pdv2}) {
    const double a = dot(*second, j.dpdu), b = dot(*second, j.dpdv);
    of_u.push_back((G * a - F * b) / area);
    of_v.push_back((E * b - F * a) / area);
  }
  of_u.insert(of_u.end(), of_v.begin(), of_v.end());
  return {std::vector<double>{K},
          {H},
          {H + apart, H - apart},
          {},
          {dndu.x, dndu.y, dndu.z},
          {dndv.x, dndv.y, dndv.z},
          {E, F, G},
          {L, M, N},
          of_u};
}

StabilityAnswer naive(const StabilityPoint& p) {
  StabilityAnswer answer;
  const SurfaceInfo& info = p.surface.info();
  const Jet2<Multiprecision> exact =
      p.surface.jet(by_rounded_angle(p.u, info.u), by_rounded_angle(p.v, info.v));
  const Jet2<double> j{rounded(exact.position), rounded(exact.dpdu),   rounded(exact.dpdv),
                       rounded(exact.d2pdu2),   rounded(exact.d2pduv), rounded(exact.d2pdv2)};
  say_partials(answer, j);
  Frame<double> f;
  f.handedness = p.surface.frame(p.u, p.v).handedness;
  f.t = plain_unit(j.dpdu);
  f.n = f.handedness * plain_unit(plain_cross(j.dpdu, j.dpdv));
  f.b = plain_cross(f.n, f.t);
  answer.frame = f;
  answer.forms = textbook_forms(j, f.n);
  return answer;
}

// ---- derivatives of the position --------------------------------------------------------------------------

void say_frame(StabilityAnswer& answer, const StabilityPoint& p) {
  const Frame<double> f = frame_from_partials(*answer.partials[1], *answer.partials[2]);
  if (has(f.status, Status::no_frame)) return;  // these partials give none, and it says so
  const double side = p.surface.frame(p.u, p.v).handedness;
  answer.frame = Frame<double>{f.t, side * f.b, side * f.n, side, f.status};
}

StabilityAnswer dual(const StabilityPoint& p) {
  StabilityAnswer answer;
  using D = DualUV;
  const auto variable = [](double x, int k) {
    NestedDualUV result(D::variable(x, k));
    result.derivative[static_cast<std::size_t>(k)] = D(1.0);
    return result;
  };
  const Vec3<NestedDualUV> position = p.surface.jet(variable(p.u, 0), variable(p.v, 1)).position;
  const auto part = [&](auto of) { return Vec3<double>{of(position.x), of(position.y), of(position.z)}; };
  for (const std::size_t k : {0u, 1u})
    answer.partials[1 + k] = part([k](const NestedDualUV& x) { return x.value.derivative[k]; });
  for (const auto& [is, i, k] : {std::array<std::size_t, 3>{3, 0, 0}, {4, 0, 1}, {5, 1, 1}})
    answer.partials[is] =
        part([i = i, k = k](const NestedDualUV& x) { return x.derivative[i].derivative[k]; });
  say_frame(answer, p);
  return answer;
}

// \param differentiate  f, x, length over which f varies like a whole turn: a DerivativeEstimate
template <class Differentiate>
StabilityAnswer by_differences(const StabilityPoint& p, Differentiate differentiate) {
  StabilityAnswer answer;
  for (const std::size_t along : {0u, 1u}) {
    const auto position = [&](double x) {
      return along == 0 ? p.surface.jet(x, p.v).position : p.surface.jet(p.u, x).position;
    };
    const DerivativeEstimate<> d = differentiate(position, along == 0 ? p.u : p.v, p.length[along]);
    answer.partials[1 + along] = d.value;
    answer.estimate[1 + along] = d.error;
  }
  say_frame(answer, p);
  return answer;
}
template <int order>
StabilityAnswer central(const StabilityPoint& p) {
  return by_differences(p, [](const auto& f, double x, double length) {
    return central_difference<order>(f, x, central_step<order>(length));
  });
}
StabilityAnswer by_ridders(const StabilityPoint& p) {
  return by_differences(p, [](const auto& f, double x, double length) { return ridders(f, x, length / 8); });
}

constexpr double of_double = 0x1p-53, of_float = 0x1p-24;
constexpr StabilityRoute routes_of_evaluation[] = {
    {"double", "Darboux in double: partials, closed-form frames, curvatures and forms",
     StabilityBound::stated, of_double, in_double},
    {"float", "Darboux in float, of the point and parameters that float holds", StabilityBound::stated,
     of_float, in_float},
    {"naive", "libm's sine of 2*pi*u, cross product, division by the length, the textbook's K and H",
     StabilityBound::none, of_double, naive},
    {"dual", "dual numbers through the position", StabilityBound::dual, of_double, dual},
    {"central2", "central differences of order 2 of the position", StabilityBound::estimate, of_double,
     central<2>},
    {"central4", "of order 4", StabilityBound::estimate, of_double, central<4>},
    {"central6", "of order 6", StabilityBound::estimate, of_double, central<6>},
    {"central8", "of order 8", StabilityBound::estimate, of_double, central<8>},
    {"ridders", "Ridders' extrapolation of central differences", StabilityBound::estimate, of_double,
     by_ridders},
};

}  // namespace

std::span<const StabilityRoute> stability_routes() {
  static const std::vector<StabilityRoute> all = [] {
    std::vector<StabilityRoute> list(std::begin(routes_of_evaluation), std::end(routes_of_evaluation));
    for (const FrameMethod& method : frame_methods())
      list.push_back(
          {method.name, method.summary, StabilityBound::stated, of_double, nullptr, StabilityDomain::meshes});
    list.push_back({"fit", "surfaces fitted to points by fit_points()", StabilityBound::stated, of_double,
                    nullptr, StabilityDomain::fits});
    return list;
  }();
  return all;
}

const StabilityRoute& find_stability_route(std::string_view name) {
  std::vector<std::string> known;
  for (const StabilityRoute& route : stability_routes()) {
    if (route.name == name) return route;
    known.emplace_back(route.name);
  }
  throw ParameterError("route '" + std::string(name) + "'", "unknown, known are " + joined(known));
}

}  // namespace darboux
