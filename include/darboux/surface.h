/// \file surface.h
/// Parametric surfaces: position with partial derivatives, frame, status, and the concept that a surface type
/// satisfies. Independent of any rendering engine.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <darboux/scalar.h>
#include <darboux/vector.h>

namespace darboux {

/// The kind of a coordinate in [0, 1]: its period, and the form in which the formula receives it.
enum class Coordinate {
  linear,        ///< the number itself; not periodic
  turn,          ///< sin 2πu, cos 2πu; periodic, period 1
  half_turn,     ///< sin πv, cos πv; pole to pole, not periodic
  twisted_turn,  ///< sin πu, cos πu; period 2, and P(u + 1, v) = P(u, 1 - v)
};

/// What is special about a point. A bit mask, shared by frames, batches, meshes and validation.
enum class Status : std::uint32_t {
  regular = 0,
  dpdu_zero = 1u << 0,          ///< dpdu vanishes (a pole of the chart)
  dpdv_zero = 1u << 1,          ///< dpdv vanishes
  parallel = 1u << 2,           ///< dpdu and dpdv are parallel: no normal from the partials
  limit_frame = 1u << 3,        ///< the frame is the limit along the given u (or v)
  no_frame = 1u << 4,           ///< no frame exists, nor a limit up to third order: the vectors are NaN
  self_intersecting = 1u << 5,  ///< the surface passes through itself here, or this is its inner part
  crease = 1u << 6,             ///< the frame is discontinuous here; that of one side is given
  umbilic = 1u << 7,            ///< both principal curvatures are equal: principal directions are arbitrary
  outside_domain = 1u << 8,     ///< a non-periodic coordinate outside [0, 1]: the analytic extension is given
  non_finite_input = 1u << 9,   ///< u, v or a parameter is NaN or infinite: the vectors are NaN
  overflow = 1u << 10,          ///< a position or partial is not finite: beyond the scalar's range, or NaN
  ill_conditioned = 1u << 11,   ///< the frame is accurate to fewer than half the digits
};
constexpr Status operator|(Status a, Status b) {
  return static_cast<Status>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr Status operator&(Status a, Status b) {
  return static_cast<Status>(static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(b));
}
constexpr Status& operator|=(Status& a, Status b) {
  return a = a | b;
}
constexpr bool has(Status mask, Status bits) {
  return (mask & bits) != Status::regular;
}

namespace detail {
constexpr Status without(Status mask, Status bits) {
  return static_cast<Status>(static_cast<std::uint32_t>(mask) & ~static_cast<std::uint32_t>(bits));
}
}  // namespace detail

/// The name of every status bit, lowest bit first.
inline constexpr std::array<std::string_view, 12> status_names{
    "dpdu_zero", "dpdv_zero", "parallel",       "limit_frame",      "no_frame", "self_intersecting",
    "crease",    "umbilic",   "outside_domain", "non_finite_input", "overflow", "ill_conditioned"};

/// Position and partial derivatives to second order with respect to u and v in [0, 1], factors 2π included.
template <class S>
struct Jet2 {
  Vec3<S> position, dpdu, dpdv, d2pdu2, d2pduv, d2pdv2;
};

/// An orthonormal right-handed frame: t = dpdu/|dpdu|, n the unit normal, b = n × t.
/// handedness = sign of det(dpdu, dpdv, n), so dpdv · (handedness b) > 0. Outside the domain, frame and
/// handedness are continued analytically instead: they do not jump at a pole.
template <class S>
struct Frame {
  Vec3<S> t, b, n;
  S handedness = lift<S>(1.0);
  Status status = Status::regular;
};

namespace detail {
template <class S>
Frame<S> no_frame() {
  return {nan_vector<S>(), nan_vector<S>(), nan_vector<S>(), lift<S>(1.0), Status::no_frame};
}
}  // namespace detail

/// The unit tangents of the coordinate curves, t = dpdu/|dpdu| and b = dpdv/|dpdv|, and the unit normal. t
/// and b are orthogonal only where the chart is. handedness as in Frame.
template <class S>
struct ParametricFrame {
  Vec3<S> t, b, n;
  S handedness = lift<S>(1.0);
  Status status = Status::regular;
};

/// An interval of permitted values.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool minimum_included = false;

  constexpr bool contains(double x) const {
    return (minimum < x || (minimum_included && minimum == x)) && x < maximum;
  }
  static constexpr Range positive() { return {.minimum = 0}; }
  static constexpr Range not_negative() { return {.minimum = 0, .minimum_included = true}; }
};

/// Throws the ParameterError for a named value outside its range, as checked() does.
[[noreturn]] void throw_out_of_range(std::string_view subject, std::string_view name, double value,
                                     const Range& permitted);

/// "0 < radius < inf", for messages and tables.
std::string describe(const Range& permitted, std::string_view name);

/// The magnitudes of a parameter for which the stated error bounds are proven. Other permitted values may be
/// used, without that guarantee.
struct Magnitudes {
  double smallest = 1e-150, largest = 1e150;
};

/// One parameter of a surface type. Its default value is the initialiser of the member.
template <class Surface, class T>
struct Parameter {
  std::string_view name;
  T& (*reach)(Surface&);
  Range permitted;
  std::string_view meaning;
  Magnitudes proven;

  constexpr T& of(Surface& surface) const { return reach(surface); }
  constexpr const T& of(const Surface& surface) const { return reach(const_cast<Surface&>(surface)); }
};

namespace detail {

template <class Surface, class T, auto... path>
constexpr T& reach(Surface& surface) {
  return (surface.*....*path);
}
template <class Surface, class T>
Surface surface_of(T Surface::*);

}  // namespace detail

/// Describes a parameter that is a member, or a member of a member:
///   parameter<&Torus::major_radius>("major_radius", ...)
///   parameter<&BilinearPatch::p00, &Vec3<T>::x>("p00_x", ...)
template <auto first, auto... rest>
constexpr auto parameter(std::string_view name, Range permitted, std::string_view meaning,
                         Magnitudes proven = {}) {
  using Surface = decltype(detail::surface_of(first));
  using T = std::remove_cvref_t<decltype(((std::declval<Surface&>().*first).*....*rest))>;
  return Parameter<Surface, T>{name, &detail::reach<Surface, T, first, rest...>, permitted, meaning, proven};
}

/// Static properties of a surface type.
struct SurfaceInfo {
  std::string_view name;     ///< as on the command line, e.g. "torus"
  std::string_view summary;  ///< one line of text
  Coordinate u, v;
  std::array<std::string_view, 4>
      singular{};  ///< where the chart is singular, e.g. "v=0"; unused entries empty
  bool orientable = true;
  std::optional<int> euler_characteristic{};  ///< for a closed surface
  bool own_orientation = false;  ///< the surface chooses n, which may oppose dpdu × dpdv (spindle torus)
  double frame_error =
      4;  ///< error bound of the components of the closed-form frame, in roundings times (1 + condition)
};

/// A coordinate in the form that formulas receive: x itself if linear, otherwise a Turn (sine and cosine).
template <Coordinate kind, class S>
auto prepare(const S& x) {
  if constexpr (kind == Coordinate::linear)
    return x;
  else if constexpr (kind == Coordinate::turn)
    return sincos_turns(x);
  else
    return sincos_half_turns(x);
}

/// The type of a prepared coordinate.
template <Coordinate kind, class S>
using Prepared = decltype(prepare<kind>(std::declval<S>()));

namespace detail {

// Whether a prepared coordinate is at or beyond the upper end of its domain; whether it is strictly inside.
template <Coordinate kind, class P>
bool at_upper_end(const P& x) {
  if constexpr (kind == Coordinate::linear)
    return !(x < lift<P>(1.0));
  else if constexpr (kind == Coordinate::half_turn)
    return x.cos < lift<decltype(x.cos)>(0.0) && !(lift<decltype(x.sin)>(0.0) < x.sin);
  else
    return false;
}
template <Coordinate kind, class P>
bool within(const P& x) {
  if constexpr (kind == Coordinate::linear)
    return lift<P>(0.0) < x && x < lift<P>(1.0);
  else if constexpr (kind == Coordinate::half_turn)
    return lift<decltype(x.sin)>(0.0) < x.sin;
  else
    return true;
}

// A prepared coordinate over the dual numbers D: as the k-th variable, or as a constant.
template <class D, class S>
D as_variable(const S& x, int k, Coordinate) {
  return D::variable(x, k);
}
template <class D, class S>
Turn<D> as_variable(const Turn<S>& x, int k, Coordinate kind) {
  const S omega = kind == Coordinate::turn ? two_pi<S>() : pi<S>();
  Turn<D> result{D(x.sin), D(x.cos)};
  result.sin.derivative[static_cast<std::size_t>(k)] = omega * x.cos;
  result.cos.derivative[static_cast<std::size_t>(k)] = -(omega * x.sin);
  return result;
}
// A variable that carries derivatives up to third order.
template <class S>
using ThreeTimesDual = Dual<Dual<Dual<S, 1>, 1>, 1>;
template <class S, class P>
auto three_times(const P& x, Coordinate kind) {
  const auto once = as_variable<Dual<S, 1>>(x, 0, kind);
  return as_variable<ThreeTimesDual<S>>(as_variable<Dual<Dual<S, 1>, 1>>(once, 0, kind), 0, kind);
}
template <class S>
auto three_times_variable(const S& x, Coordinate kind) {
  return three_times<S>(x, kind);
}
template <class S>
auto three_times_variable(const Turn<S>& x, Coordinate kind) {
  return three_times<S>(x, kind);
}
template <class D, class S>
D as_constant(const S& x) {
  return D(lift<D>(x));
}
template <class D, class S>
Turn<D> as_constant(const Turn<S>& x) {
  return {lift<D>(x.sin), lift<D>(x.cos)};
}

}  // namespace detail

namespace detail {

// Whether a surface type is built from a curve along u (0) or v (1) that can be evaluated on its own.
template <class X, int along>
concept HasCurveAlong = requires {
  X::curve_along;
}
&&X::curve_along == along;
// The surface restricted to one u or v: its curve is evaluated there once, with derivatives up to `order`.
template <int order, class X, class PU, class PV>
decltype(auto) at_place(const X& surface, const PU& u, const PV& v) {
  if constexpr (HasCurveAlong<X, 0>)
    return surface.template with_curve_at<order>(u);
  else if constexpr (HasCurveAlong<X, 1>)
    return surface.template with_curve_at<order>(v);
  else
    return (surface);
}
// The jet with partials up to `order`. Higher ones are skipped if the surface has jet_to().
template <int order, class X, class PU, class PV>
auto jet_to(const X& surface, const PU& u, const PV& v) {
  if constexpr (requires { surface.template jet_to<order>(u, v); })
    return surface.template jet_to<order>(u, v);
  else
    return surface.jet(u, v);
}

// Whether gaussian_curvature and mean_curvature run over SIMD lanes: true unless the surface says otherwise.
template <class X>
constexpr bool curvature_in_lanes = [] {
  if constexpr (requires { X::curvature_in_lanes; })
    return X::curvature_in_lanes;
  else
    return true;
}();

}  // namespace detail

/// A surface type has `info`, and jet(u, v) for prepared coordinates of any scalar. Optional members:
///   static constexpr auto parameters()    names, members, permitted ranges: an array of Parameter
///   std::string refusal()                 why the parameters are invalid in combination; empty if valid
///   Frame<S> frame(u, v)                  a closed-form frame, with the limit at singular points
///   Status singular(u, v)                 the bits of Status that hold at this point
///   Jet2<S> jet_to<order>(u, v)           jet(), bit for bit, but partials above the order (0, 1 or 2) are
///                                         unspecified: for surfaces with costly partials
///   S partials_condition(u, v)            for surfaces without a closed frame: the error of dpdu and dpdv in
///                                         roundings, if cheap to compute; decides Status::ill_conditioned
///   bool tangent_depends_on_u_alone()     whether t and handedness are the same for all v except at poles,
///                                         with no status bit: a batch that requests nothing else then skips
///                                         the sines of v
///   static constexpr int curve_along      for surfaces built from a curve: 0 if it runs along u, 1 if along
///                                         v; requires
///   with_curve_at<order>(u or v)          the surface restricted to this u (or v): its curve is evaluated
///                                         once, with derivatives up to that order. A derived type that hides
///                                         jet() or frame() must hide these two as well
///   static constexpr bool curvature_in_lanes  false if the curvatures below cannot run over SIMD lanes
/// and at least one independent fact, derived from another source than jet():
///   S implicit(Vec3<S>)                   the signed distance to first order: zero on the surface, where its
///                                         gradient is n (n or -n if the surface is one-sided)
///   S gaussian_curvature(u, v)            K in closed form; curvature() uses it and H where terms cancel
///   S mean_curvature(u, v)                H in closed form, for the n of the frame
///   Vec3<S> second_formula(u, v)          the position by another formula
/// docs/howto/add-a-surface.md shows one from start to end.
template <class X>
concept ParametricSurface = requires(const X& x, const Prepared<X::info.u, double>& u,
                                     const Prepared<X::info.v, double>& v) {
  { X::info } -> std::convertible_to<const SurfaceInfo&>;
  { x.jet(u, v) } -> std::same_as<Jet2<double>>;
};

namespace detail {

template <class X>
concept StatesInfo = requires {
  { X::info } -> std::convertible_to<const SurfaceInfo&>;
};

// Fails to compile, with a message that names the member that X lacks.
template <class X>
constexpr void name_missing_member() {
  static_assert(
      StatesInfo<X>,
      "a surface needs the member: static constexpr SurfaceInfo info. (An AnySurface is asked by its own "
      "members, as surface.frame(u, v).)");
  static_assert(!StatesInfo<X> || ParametricSurface<X>,
                "a surface needs the member: template <class S> Jet2<S> jet(u, v) const, with u and v as its "
                "info says");
}

}  // namespace detail

template <class X>
concept HasParameters = requires {
  X::parameters();
};
template <class X>
concept HasClosedFrame = requires(const X& x, const Prepared<X::info.u, double>& u,
                                  const Prepared<X::info.v, double>& v) {
  { x.frame(u, v) } -> std::same_as<Frame<double>>;
};
template <class X>
concept DeclaresSingularPoints = requires(const X& x, const Prepared<X::info.u, double>& u,
                                          const Prepared<X::info.v, double>& v) {
  { x.singular(u, v) } -> std::same_as<Status>;
};
template <class X>
concept StatesImplicit = requires(const X& x, const Vec3<double>& p) {
  { x.implicit(p) } -> std::same_as<double>;
};
template <class X>
concept StatesGaussianCurvature = requires(const X& x, const Prepared<X::info.u, double>& u,
                                           const Prepared<X::info.v, double>& v) {
  { x.gaussian_curvature(u, v) } -> std::same_as<double>;
};
template <class X>
concept StatesMeanCurvature = requires(const X& x, const Prepared<X::info.u, double>& u,
                                       const Prepared<X::info.v, double>& v) {
  { x.mean_curvature(u, v) } -> std::same_as<double>;
};
template <class X>
concept StatesSecondFormula = requires(const X& x, const Prepared<X::info.u, double>& u,
                                       const Prepared<X::info.v, double>& v) {
  { x.second_formula(u, v) } -> std::same_as<Vec3<double>>;
};
template <class X>
concept RefusesCombinations = requires(const X& x) {
  { x.refusal() } -> std::same_as<std::string>;
};

/// Calls f(parameter) for each parameter of the surface type, in order.
template <class X, class F>
constexpr void for_each_parameter(F&& f) {
  if constexpr (HasParameters<X>)
    for (const auto& p : X::parameters()) f(p);
}

namespace detail {

template <class X>
struct Rebound {  // not a template over its scalar: there is only this one
  template <class To>
  static X make(const X& surface) {
    return surface;
  }
};
template <template <class> class Surface, std::floating_point From>
struct Rebound<Surface<From>> {
  template <class To>
  static Surface<To> make(const Surface<From>& surface) {
    Surface<To> result;
    if constexpr (HasParameters<Surface<From>>) {
      constexpr auto from = Surface<From>::parameters();
      constexpr auto to = Surface<To>::parameters();
      for (std::size_t i = 0; i < from.size(); ++i) to[i].of(result) = lift<To>(from[i].of(surface));
    }
    return result;
  }
};

}  // namespace detail

/// The same surface over another scalar type, e.g. rebind<float>(Torus{1.0, 0.4}). Parameters are converted
/// by lift(). A type with data besides its parameters must have a member rebind<To>(). A type that is not a
/// template over its scalar is returned unchanged.
template <class To, class X>
auto rebind(const X& surface) {
  if constexpr (requires { surface.template rebind<To>(); })
    return surface.template rebind<To>();
  else
    return detail::Rebound<X>::template make<To>(surface);
}

/// Throws the ParameterError for parameters that are invalid in combination.
[[noreturn]] void throw_refused(std::string_view subject, std::string_view why);

/// Checks the parameters and returns the surface itself. No other function rejects parameters out of range;
/// AnySurface and the command line call this one. Surface types are plain structs that accept any numbers,
/// and evaluation never throws: for parameters out of range it returns what the formula gives. Without
/// NDEBUG, frame(), sample() and evaluate() terminate the program with this message if all parameters are
/// finite and of type double. For untrusted parameters write frame(checked(Torus{R, r}), u, v). \throws
/// ParameterError naming the surface, the parameter, its range and its value
template <class X>
const X& checked(const X& surface) {
  for_each_parameter<X>([&](const auto& p) {
    const double value = static_cast<double>(p.of(surface));
    if (!p.permitted.contains(value)) throw_out_of_range(X::info.name, p.name, value, p.permitted);
  });
  if constexpr (RefusesCombinations<X>)
    if (const std::string why = surface.refusal(); !why.empty()) throw_refused(X::info.name, why);
  return surface;
}

namespace detail {

// Calls f(number) for each parameter, including those of an adaptor and its base.
template <class X, class F>
void for_each_number(const X& surface, const F& f) {
  for_each_parameter<X>([&](const auto& p) { f(p.of(surface)); });
  if constexpr (requires { surface.for_each_own_number(f); }) surface.for_each_own_number(f);
  if constexpr (requires { surface.base; }) for_each_number(surface.base, f);
}

// Whether they are all finite.
template <class X>
bool parameters_are_finite(const X& surface) {
  bool finite = true;
  for_each_number(surface, [&](const auto& x) { finite = finite && std::isfinite(static_cast<double>(x)); });
  return finite;
}

// Like assert: without NDEBUG, terminates the program with the message of checked() if that rejects the
// parameters. Parameters that are not finite are reported by the status instead.
template <class X>
void assert_permitted([[maybe_unused]] const X& surface) noexcept {
#ifndef NDEBUG
  bool any = false, doubles = true;
  for_each_number(surface, [&](const auto& x) {
    any = true;
    doubles = doubles && std::same_as<std::remove_cvref_t<decltype(x)>, double>;
  });
  if (any && doubles && parameters_are_finite(surface))
    checked(surface);  // thrown out of noexcept: std::terminate
#endif
}

}  // namespace detail

}  // namespace darboux
