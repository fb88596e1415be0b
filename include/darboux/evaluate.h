/// \file evaluate.h
/// Evaluates a surface at many (u, v). Writes the requested attributes into the caller's memory, in the
/// requested layout.
///   darboux::Outputs<float> out;
///   out.packed(Attribute::position, positions).packed(Attribute::tangent4, tangents);
///   evaluate(Torus{1.0, 0.4}, Points<float>::interleaved(uvs), out);
/// Single points: point.h, which this header includes.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <typeinfo>

#include <darboux/affine_map.h>
#include <darboux/attributes.h>
#include <darboux/curvature.h>
#include <darboux/error.h>
#include <darboux/instruction_set.h>
#include <darboux/point.h>

namespace darboux {

namespace detail {

template <class T>
constexpr bool evaluates = std::same_as<T, float> || std::same_as<T, double>;

}  // namespace detail

/// The (u, v) to evaluate. A view: the arrays are not copied, and must outlive the call that uses them.
template <std::floating_point T>
class Points {
  static_assert(detail::evaluates<T>, "expected Points of float or double");

 public:
  /// Point i is (u[i], v[i]). \throws ParameterError if the lengths differ
  static Points arrays(std::span<const T> u, std::span<const T> v);
  /// Pairs without gaps: u, v, u, v, ... \throws ParameterError if the number of values is odd
  static Points interleaved(std::span<const T> uv);
  /// Strided pairs: `points` of them, each `stride` bytes after the previous one.
  /// \throws ParameterError if the stride is smaller than a pair, or not a multiple of the alignment of T
  static Points interleaved(const T* uv, std::size_t points, std::ptrdiff_t stride);
  /// The (columns + 1) × (rows + 1) vertices of a grid of columns × rows cells: u = i/columns, v = j/rows,
  /// computed in double and rounded to T. u varies fastest. Sines and cosines are computed once per row and
  /// once per column. \param first, count the rows of points to take: `count` rows, starting at row `first`;
  /// all by default. \throws ParameterError unless columns and rows are 1 to 2^31 and `first` is 0 to rows
  static Points grid(std::size_t columns, std::size_t rows, std::size_t first = 0,
                     std::size_t count = std::numeric_limits<std::size_t>::max());
  /// The vertices of a block of cells_u × cells_v cells of that grid. The block starts at cell
  /// (first_column, first_row). Coordinates are bit-identical to those of grid(). \throws ParameterError if
  /// the block is empty or extends beyond the grid
  static Points part_of_grid(std::size_t columns, std::size_t rows, std::size_t first_column,
                             std::size_t cells_u, std::size_t first_row, std::size_t cells_v);

  /// A subrange: `count` points, starting at index `first`. \throws ParameterError if there are fewer
  Points part(std::size_t first, std::size_t count) const;

  /// The number of points.
  std::size_t size() const { return size_; }
  /// (u, v) of point i.
  Vec2<T> operator[](std::size_t i) const {
    if (columns_ > 0) return {column((offset_ + i) % (columns_ + 1)), row((offset_ + i) / (columns_ + 1))};
    const auto at = [&](const T* x) {
      return *reinterpret_cast<const T*>(reinterpret_cast<const char*>(x) +
                                         stride_ * static_cast<std::ptrdiff_t>(i));
    };
    return {at(u_), at(v_)};
  }

  bool is_grid() const { return columns_ > 0; }
  std::size_t columns() const { return columns_; }  ///< of the grid, in cells; 0: no grid
  std::size_t offset() const { return offset_; }    ///< for a part: its first point's index in the rows taken
  /// For a grid: u of column i, v of row j, both counted from the first one taken.
  T column(std::size_t i) const {
    return static_cast<T>(static_cast<double>(first_column_ + i) / static_cast<double>(all_columns_));
  }
  T row(std::size_t j) const {
    return static_cast<T>(static_cast<double>(first_row_ + j) / static_cast<double>(rows_));
  }
  const T* u() const { return u_; }
  const T* v() const { return v_; }
  std::ptrdiff_t stride() const { return stride_; }  ///< bytes from one u (or v) to the next

 private:
  const T *u_ = nullptr, *v_ = nullptr;
  std::ptrdiff_t stride_ = sizeof(T);
  std::size_t size_ = 0, columns_ = 0, all_columns_ = 0, rows_ = 0, first_column_ = 0, first_row_ = 0,
              offset_ = 0;
};

/// Where an attribute is written: per component the address of the first point's value, and the stride from
/// point to point, in bytes.
template <class T>
struct OutputPlace {
  std::array<T*, most_components> component{};
  std::ptrdiff_t stride = 0;
  std::size_t points = 0;  ///< capacity, in points
};

/// The attributes requested, and the memory they are written to.
template <std::floating_point T>
class Outputs {
  static_assert(detail::evaluates<T>, "expected Outputs of float or double");

 public:
  /// One array per component, in the order of attributes.h. \throws ParameterError (as do all functions
  /// below), naming the attribute, if it was already requested; the number of components is wrong; a pointer
  /// is null or not aligned to T; or the stride is smaller than the vector or not a multiple of the alignment
  /// of T
  Outputs& separate(Attribute a, std::span<const std::span<T>> components);
  Outputs& separate(Attribute a, std::initializer_list<std::span<T>> components) {
    return separate(a, std::span<const std::span<T>>(components.begin(), components.size()));
  }
  /// One array of vectors without gaps. Its size must be a multiple of the number of components.
  Outputs& packed(Attribute a, std::span<T> values);
  /// One member of each struct in an array of structs. \param first the first component of that member in the
  /// first struct \param points number of structs \param stride size of a struct, in bytes
  Outputs& member(Attribute a, T* first, std::size_t points, std::ptrdiff_t stride);
  /// The status of each point.
  Outputs& status(std::span<Status> values) { return status(values.data(), values.size(), sizeof(Status)); }
  Outputs& status(Status* first, std::size_t points, std::ptrdiff_t stride);

  Attributes attributes() const { return asked_; }
  const OutputPlace<T>& place(Attribute a) const { return places_[static_cast<std::size_t>(a)]; }
  Status* status_place() const { return status_; }
  std::ptrdiff_t status_stride() const { return status_stride_; }
  std::size_t status_points() const { return status_points_; }

 private:
  Outputs& add(Attribute a, const OutputPlace<T>& place, std::size_t consecutive);
  std::array<OutputPlace<T>, attribute_count> places_{};
  Attributes asked_;
  Status* status_ = nullptr;
  std::ptrdiff_t status_stride_ = 0;
  std::size_t status_points_ = 0;
};

/// Whether results are written past the caches (non-temporal stores): about 1.5 times as fast if the results
/// exceed the caches, about 1.5 times as slow otherwise. automatic: chosen by size.
enum class Stores : std::uint8_t { automatic, cached, past_caches };

struct EvaluateOptions {
  int threads = 1;                             ///< 0: all hardware threads; results do not depend on it
  SignConvention sign = SignConvention::gltf;  ///< of tangent4
  Stores stores = Stores::automatic;
  InstructionSet instruction_set = InstructionSet::automatic;
};

/// How many points have each status bit of sample().
struct StatusSummary {
  std::size_t points = 0;
  std::size_t point_by_point =
      0;  ///< of these, evaluated by the single-point functions instead of SIMD lanes
  std::array<std::size_t, status_names.size()> count{};  ///< points with each bit
  std::array<std::size_t, status_names.size()>
      first{};  ///< index of the first such point; 0 where count is 0
  bool all_regular() const {
    for (const std::size_t n : count)
      if (n > 0) return false;
    return true;
  }
  /// Appends the summary of the points that follow these.
  StatusSummary& operator+=(const StatusSummary& next);
};

namespace detail {

// All values at one point, indexed by Attribute.
template <class T>
struct PointValues {
  std::array<std::array<T, most_components>, attribute_count> values{};
  Status status = Status::regular;
  void set(Attribute a, const Vec3<T>& x) { values[static_cast<std::size_t>(a)] = {x.x, x.y, x.z}; }
  void set(Attribute a, T x) { values[static_cast<std::size_t>(a)] = {x}; }
};

// A type-erased surface over T.
template <class T>
struct ErasedSurface {
  const void* surface;
  const std::type_info* type;
  Coordinate u, v;
  bool tangent_depends_on_u_alone;
  bool proven;  // parameters so sized that lanes need not check each result for overflow
  void (*point)(const void*, T u, T v, Attributes, SignConvention, PointValues<T>&);
  ErasedSurface (*base)(const void* placed) = nullptr;  // of a Placed surface
  AffineMap<T> map{};                                   // of its base
};

template <class X, class T>
void evaluate_point(const void* erased, T u, T v, Attributes asked, SignConvention sign,
                    PointValues<T>& result) {
  const X& surface = *static_cast<const X*>(erased);
  const auto pu = prepare<X::info.u>(u);
  const auto pv = prepare<X::info.v>(v);
  // The status needs the frame, whatever is requested.
  const bool curved = asked.has_any(curvature_attributes);
  const bool partials = !HasClosedFrame<X> || curved || asked.has_any(partial_attributes);
  Jet2<T> j{};
  Frame<T> frame;
  if (std::isfinite(u) && std::isfinite(v)) {
    const auto& here = at_place<3>(surface, pu, pv);
    if (partials) j = here.jet(pu, pv);
    frame = frame_at<T>(here, pu, pv, status_at(here, u, v, pu, pv), j);
  } else {
    if (partials) j = surface.jet(pu, pv);
    frame = frame_at<T>(surface, pu, pv, Status::non_finite_input, j);
  }
  result.status = frame.status;
  result.set(Attribute::tangent, frame.t);
  result.set(Attribute::bitangent, frame.b);
  result.set(Attribute::normal, frame.n);
  result.set(Attribute::handedness, frame.handedness);
  const Vec4<T> stored = tangent4(frame, sign);
  result.values[static_cast<std::size_t>(Attribute::tangent4)] = {stored.x, stored.y, stored.z, stored.w};
  const auto partial = [&](Attribute a, const Vec3<T>& x) {
    result.set(a, x);
    if (asked.has(a) && !finite(x) && !has(frame.status, Status::non_finite_input))
      result.status |= Status::overflow;
  };
  partial(Attribute::position, j.position);
  partial(Attribute::dpdu, j.dpdu);
  partial(Attribute::dpdv, j.dpdv);
  partial(Attribute::d2pdu2, j.d2pdu2);
  partial(Attribute::d2pduv, j.d2pduv);
  partial(Attribute::d2pdv2, j.d2pdv2);
  if (!curved) return;
  const Curvature<T> c = [&] {
    using N = Dual<Dual<T, 2>, 2>;  // needed at poles; a user's formula may not compile with it
    if constexpr (requires(const Prepared<X::info.u, N>& nu, const Prepared<X::info.v, N>& nv) {
                    surface.jet(nu, nv);
                  })
      return curvature(surface, u, v, j, frame);
    else
      return curvature(j, frame);
  }();
  result.set(Attribute::gaussian_curvature, c.gaussian);
  result.set(Attribute::mean_curvature, c.mean);
  result.values[static_cast<std::size_t>(Attribute::principal_curvatures)] = {c.principal[0], c.principal[1]};
  const Vec3<T>&d = c.directions[0], &e = c.directions[1];
  result.values[static_cast<std::size_t>(Attribute::principal_directions)] = {d.x, d.y, d.z, e.x, e.y, e.z};
  if (asked.has(Attribute::principal_directions)) result.status |= c.status & Status::umbilic;
}

// Whether the parameters exclude overflow inside the domain: each is zero or of proven magnitude, in float
// also within 1e±12.
template <class T, class X>
bool sizes_are_proven(const X& surface) {
  bool proven = true;
  for_each_parameter<X>([&](const auto& p) {
    const double size = std::fabs(static_cast<double>(p.of(surface)));
    const double limit = std::same_as<T, float> ? 1e12 : 1e150;
    proven = proven && (size == 0 || (size >= std::fmax(p.proven.smallest, 1 / limit) &&
                                      size <= std::fmin(p.proven.largest, limit)));
  });
  return proven;
}

template <class X, class T>
concept TakesScalar = requires(const X& x, const Prepared<X::info.u, T>& u, const Prepared<X::info.v, T>& v) {
  { x.jet(u, v) } -> std::same_as<Jet2<T>>;
};

template <class T, class X>
ErasedSurface<T> erase(const X& surface) {
  bool of_u_alone = false;
  if constexpr (requires { surface.tangent_depends_on_u_alone(); })
    of_u_alone = surface.tangent_depends_on_u_alone();
  ErasedSurface<T> result{&surface,
                          &typeid(X),
                          X::info.u,
                          X::info.v,
                          of_u_alone,
                          sizes_are_proven<T>(surface),
                          &evaluate_point<X, T>};
  if constexpr (requires {
                  { surface.affine_map() } -> std::same_as<AffineMap<T>>;
                }) {
    result.base = [](const void* placed) { return erase<T>(static_cast<const X*>(placed)->base); };
    result.map = surface.affine_map();
  }
  return result;
}

StatusSummary evaluate(const ErasedSurface<double>&, const Points<double>&, const Outputs<double>&,
                       const EvaluateOptions&);
StatusSummary evaluate(const ErasedSurface<float>&, const Points<float>&, const Outputs<float>&,
                       const EvaluateOptions&);

}  // namespace detail

/// Evaluates a surface at all points. Surfaces of the catalogue run in SIMD lanes where their formulas allow
/// it, and so do Placed ones of these unless curvatures are requested; all others run point by point. Values
/// and statuses are bit for bit those of sample() and curvature(), whatever the instruction set, memory
/// layout, number of threads and position in the batch. Where no frame exists, vectors are NaN. The status
/// has overflow only for partials that were requested, and umbilic only if principal directions were.
///
/// Only requested attributes are computed, with two exceptions: the frame, because the status needs it; and
/// higher derivatives of splines, if points run one by one or the surface has no closed-form frame. Outputs
/// must not overlap one another or the points. Memory is allocated only by the first call and for threads.
///
/// In float, u, v and the parameters are rounded to float first, which alone may cost hundreds of ulps. For
/// correctly rounded floats, evaluate in double and round. Cost: about 5 ns per point for position, dpdu,
/// dpdv, t, b, n of a torus in double; measurements: docs/reports/evaluation.md. \throws ParameterError if an
/// output is too small for the points, the number of threads is negative, or the instruction set (given or
/// named by DARBOUX_ISA) is not one of instruction_sets(). Nothing is written in that case. Exceptions thrown
/// by a user's surface propagate.
template <ParametricSurface X, std::floating_point T>
StatusSummary evaluate(const X& surface, const Points<T>& points, const Outputs<T>& outputs,
                       const EvaluateOptions& options = {}) {
  detail::assert_permitted(surface);
  const auto& over = [&]() -> decltype(auto) {
    if constexpr (std::same_as<T, double>)
      return (surface);
    else
      return rebind<T>(surface);
  }();
  static_assert(detail::TakesScalar<std::remove_cvref_t<decltype(over)>, T>,
                "expected template <class S> jet(u, v) of any scalar S; got one that does not take float");
  return detail::evaluate(detail::erase<T>(over), points, outputs, options);
}

}  // namespace darboux
