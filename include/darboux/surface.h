/// \file surface.h
/// What a parametric surface is: a position with its partials, a frame, a status, and the concept that a
/// surface type fulfils. A surface knows no engine.
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

/// How a coordinate in [0, 1] runs, and in which form the formula receives it.
enum class Coordinate {
  linear,        ///< as it is; not periodic
  turn,          ///< sin 2πu, cos 2πu; periodic, period 1
  half_turn,     ///< sin πv, cos πv; pole to pole, not periodic
  twisted_turn,  ///< sin πu, cos πu; period 2, and P(u + 1, v) = P(u, 1 - v)
};

/// What evaluation has to say about a point. Bits of one mask, for frames, batches, meshes and validation
/// alike.
enum class Status : std::uint32_t {
  regular = 0,
  dpdu_zero = 1u << 0,          ///< dpdu vanishes (a pole of the chart)
  dpdv_zero = 1u << 1,          ///< dpdv vanishes
  parallel = 1u << 2,           ///< dpdu and dpdv are parallel: no normal from the partials
  limit_frame = 1u << 3,        ///< the frame is the limit along the given u (or v)
  no_frame = 1u << 4,           ///< no frame exists, nor a limit up to third order: the vectors are NaN
  self_intersecting = 1u << 5,  ///< the surface passes through itself here, or this is its inner part
  crease = 1u << 6,             ///< the frame jumps here; one side's is given
  umbilic = 1u << 7,            ///< both principal curvatures are equal: principal directions are arbitrary
  outside_domain = 1u << 8,     ///< a non-periodic coordinate outside [0, 1]: the analytic extension is given
  non_finite_input = 1u << 9,   ///< u, v or a parameter is NaN or infinite: the vectors are NaN
  overflow = 1u << 10,          ///< a position or partial is not finite: beyond the scalar's range, or NaN
  ill_conditioned = 1u << 11,   ///< the frame is known to fewer than half the digits
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
/// handedness = sign of det(dpdu, dpdv, n): handedness · b leans towards dpdv. Outside the domain, beyond a
/// pole, frame and handedness are the analytic continuation instead, so that they do not jump at it.
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

/// The unit vectors along the coordinate curves, t = dpdu/|dpdu| and b = dpdv/|dpdv|, with the unit normal.
/// Not orthogonal where the chart is not; handedness as in Frame.
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

/// Throws the ParameterError of checked() and of every other place where a named value leaves its range.
[[noreturn]] void throw_out_of_range(std::string_view subject, std::string_view name, double value,
                                     const Range& permitted);

/// "0 < radius < inf", for messages and tables.
std::string describe(const Range& permitted, std::string_view name);

/// The magnitudes of a parameter for which the stated error bounds are proven. (Any permitted value may be
/// used.)
struct Magnitudes {
  double smallest = 1e-150, largest = 1e150;
};

/// One parameter of a surface type; its default is the member's initialiser.
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

/// What a surface type says of itself.
struct SurfaceInfo {
  std::string_view name;     ///< as on the command line, e.g. "torus"
  std::string_view summary;  ///< one line for people
  Coordinate u, v;
  std::array<std::string_view, 4>
      singular{};  ///< where the chart is singular, e.g. "v=0"; unused entries empty
  bool orientable = true;
  std::optional<int> euler_characteristic{};  ///< of a closed surface
  bool own_orientation = false;  ///< n is stated by the surface and may oppose dpdu × dpdv (a spindle torus)
  double frame_error =
      4;  ///< bound of the closed-form frame's components, in roundings times (1 + condition)
};

/// A coordinate in the form its kind hands to formulas: x itself, or a Turn.
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

// Whether a prepared coordinate is at or beyond the upper end of its domain, and whether it is within, beside
// no end.
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

// The k-th variable at a prepared coordinate, over the dual numbers D on its scalar; the same as a constant.
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
// A variable whose first, second and third derivatives are carried.
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

// Whether a surface type is made of a curve along u (0) or v (1) that can be evaluated for itself.
template <class X, int along>
concept HasCurveAlong = requires {
  X::curve_along;
}
&&X::curve_along == along;
// The surface as it is at a place, of which partials to an order are wanted: its curve is evaluated there.
template <int order, class X, class PU, class PV>
decltype(auto) at_place(const X& surface, const PU& u, const PV& v) {
  if constexpr (HasCurveAlong<X, 0>)
    return surface.template with_curve_at<order>(u);
  else if constexpr (HasCurveAlong<X, 1>)
    return surface.template with_curve_at<order>(v);
  else
    return (surface);
}
// The jet of a surface, of which partials to an order are wanted: no others are computed where it offers
// that.
template <int order, class X, class PU, class PV>
auto jet_to(const X& surface, const PU& u, const PV& v) {
  if constexpr (requires { surface.template jet_to<order>(u, v); })
    return surface.template jet_to<order>(u, v);
  else
    return surface.jet(u, v);
}

// Whether gaussian_curvature and mean_curvature run over SIMD lanes: unless the surface says no.
template <class X>
constexpr bool curvature_in_lanes = [] {
  if constexpr (requires { X::curvature_in_lanes; })
    return X::curvature_in_lanes;
  else
    return true;
}();

}  // namespace detail

/// A surface type: `info`, and jet(u, v) on prepared coordinates of any scalar. It may add
///   static constexpr auto parameters()    names, members, permitted ranges: an array of Parameter
///   std::string refusal()                 what is wrong with the parameters together, empty when nothing is
///   Frame<S> frame(u, v)                  a closed-form frame, with the limit at singular points
///   Status singular(u, v)                 the bits of Status that hold at this point
///   Jet2<S> jet_to<order>(u, v)           jet(), the same bits, but partials beyond the order (0, 1, 2) may
///                                         be anything: for surfaces whose partials are costly
///   S partials_condition(u, v)            without a closed frame: by how many roundings dpdu and dpdv may
///                                         err, if that is cheap to tell: see Status::ill_conditioned
///   bool tangent_depends_on_u_alone()     whether t and handedness are the same at all v but the poles, with
///                                         no status: batches that ask for nothing else then compute no
///                                         sines of v
///   static constexpr int curve_along      if it is made of a curve: 0 if that runs along u, 1 along v; with
///   with_curve_at<order>(u or v)          the same surface, for points at this place only: its curve is
///                                         evaluated once, with derivatives to that order. A derived type
///                                         that hides jet() or frame() hides these two as well
///   static constexpr bool curvature_in_lanes  false where the next two facts cannot run over SIMD lanes
/// and independent facts, at least one, each from another source than jet():
///   S implicit(Vec3<S>)                   the signed distance to first order: zero on the surface, its
///                                         gradient n there (n or -n where the surface has one side)
///   S gaussian_curvature(u, v)            K in closed form; curvature() takes it and H where terms cancel
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

// Does not compile, and names the member that X lacks to be a surface.
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

/// The same surface over another scalar, e.g. rebind<float>(Torus{1.0, 0.4}): parameters are lifted. A type
/// that holds more than its parameters has a member rebind<To>() for it; one that is no template over its
/// scalar is returned as it is.
template <class To, class X>
auto rebind(const X& surface) {
  if constexpr (requires { surface.template rebind<To>(); })
    return surface.template rebind<To>();
  else
    return detail::Rebound<X>::template make<To>(surface);
}

/// Throws the ParameterError of a surface whose parameters do not go together.
[[noreturn]] void throw_refused(std::string_view subject, std::string_view why);

/// Returns the surface itself, checked. This is the one place where parameters out of range are refused;
/// AnySurface and the command line call it too. Surface types are plain structs that take any numbers, and
/// evaluation never throws: for parameters out of range it gives what the formula gives. In a program built
/// without NDEBUG, frame(), sample() and evaluate() end the program with this message, if all parameters are
/// finite and of type double. For parameters from outside write frame(checked(Torus{R, r}), u, v). \throws
/// ParameterError naming surface and parameter, its range and its value
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

// Calls f(number) for each parameter, and for each number of an adaptor and its base.
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

// Ends a program built without NDEBUG that evaluates a surface whose parameters checked() refuses, with its
// message, as assert does; nothing with NDEBUG. Numbers that are not finite have their status.
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
