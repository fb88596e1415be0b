#include "baselines.h"

#include <cmath>
#include <type_traits>
#include <utility>

#include <darboux/catalogue.h>
#include <darboux/point.h>

#include "work_precision/loops.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif
#if defined(DARBOUX_BENCHMARK_OCCT)
#include <Geom_SphericalSurface.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <gp_Ax3.hxx>
#endif

namespace darboux::bench {
namespace {

using namespace loops;

// f(u, v) at all points. What is not wanted is not computed: the compiler sees that nobody reads it.
template <Layout layout, Wanted wanted, class T, class F>
void loop(const F& f, const T* u, const T* v, std::size_t n, const Destination& to) {
  constexpr std::size_t numbers = numbers_of(wanted);
  constexpr std::size_t step = layout == Layout::separate ? 1 : layout == Layout::vectors ? 3 : numbers;
  std::array<T*, numbers> out;
  for (std::size_t k = 0; k < numbers; ++k) out[k] = number_at<T>(layout, wanted, to, k, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const Numbers<T> x = f(u[i], v[i]);
    const auto put = [&](std::size_t k, const Vector<T>& a) {
      for (std::size_t c = 0; c < 3; ++c) out[k + c][i * step] = a[static_cast<Eigen::Index>(c)];
    };
    if constexpr (wanted == Wanted::all) {
      put(0, x.position);
      put(3, x.dpdu);
      put(6, x.dpdv);
      put(9, x.t);
      put(12, x.b);
      put(15, x.n);
    } else if constexpr (wanted == Wanted::position) {
      put(0, x.position);
    } else if constexpr (wanted == Wanted::frame) {
      put(0, x.t);
      put(3, x.b);
      put(6, x.n);
    } else {
      put(0, x.t);
      out[3][i * step] = x.b.dot(x.dpdv) > 0 ? T(-1) : T(1);  // glTF: its v runs the other way
    }
  }
}

// ---- by hand ----------------------------------------------------------------------------------------------

template <class T>
struct TorusByHand {
  static constexpr T R = 1, r = T(0.25), tau = T(2 * M_PI);
  static constexpr T du = tau, dv = tau;
  static Torus<T> catalogued() { return {R, r}; }

  static Numbers<T> naive(T u, T v) {
    const T su = std::sin(tau * u), cu = std::cos(tau * u), sv = std::sin(tau * v), cv = std::cos(tau * v);
    return with_frame<T>({(R + r * cv) * cu, (R + r * cv) * su, r * sv},
                         {-tau * (R + r * cv) * su, tau * (R + r * cv) * cu, 0},
                         {-tau * r * sv * cu, -tau * r * sv * su, tau * r * cv});
  }
  static Numbers<T> closed_form(T u, T v) {
    const T su = std::sin(tau * u), cu = std::cos(tau * u), sv = std::sin(tau * v), cv = std::cos(tau * v);
    const T rho = R + r * cv, full = tau * rho, tube = tau * r;
    return {{rho * cu, rho * su, r * sv},
            {-full * su, full * cu, 0},
            {-tube * sv * cu, -tube * sv * su, tube * cv},
            {-su, cu, 0},
            {-sv * cu, -sv * su, cv},
            {cv * cu, cv * su, sv}};
  }
  template <class S>
  static Vec3<S> position(const S& u, const S& v) {
    const Turn<S> a = sincos_turns(u), b = sincos_turns(v);
    const S rho = lift<S>(R) + lift<S>(r) * b.cos;
    return {rho * a.cos, rho * a.sin, lift<S>(r) * b.sin};
  }
  static Vector<T> position_at(T u, T v) {
    const T rho = R + r * std::cos(tau * v);
    return {rho * std::cos(tau * u), rho * std::sin(tau * u), r * std::sin(tau * v)};
  }
#if defined(DARBOUX_BENCHMARK_OCCT)
  static Handle(Geom_Surface) occt() {
    return new Geom_ToroidalSurface(gp_Ax3(), R, r);
  }
  static double occt_v(double v) {
    return 2 * M_PI * v;
  }
#endif
};

template <class T>
struct SphereByHand {
  static constexpr T r = 1, tau = T(2 * M_PI), pi = T(M_PI);
  static constexpr T du = tau, dv = pi;
  static Sphere<T> catalogued() { return {r}; }

  static Numbers<T> naive(T u, T v) {
    const T su = std::sin(tau * u), cu = std::cos(tau * u), sv = std::sin(pi * v), cv = std::cos(pi * v);
    return with_frame<T>({r * sv * cu, r * sv * su, -r * cv}, {-tau * r * sv * su, tau * r * sv * cu, 0},
                         {pi * r * cv * cu, pi * r * cv * su, pi * r * sv});
  }
  static Numbers<T> closed_form(T u, T v) {
    const T su = std::sin(tau * u), cu = std::cos(tau * u), sv = std::sin(pi * v), cv = std::cos(pi * v);
    const T full = tau * r * sv, half = pi * r;
    return {{r * sv * cu, r * sv * su, -r * cv},
            {-full * su, full * cu, 0},
            {half * cv * cu, half * cv * su, half * sv},
            {-su, cu, 0},
            {cv * cu, cv * su, sv},
            {sv * cu, sv * su, -cv}};
  }
  template <class S>
  static Vec3<S> position(const S& u, const S& v) {
    const Turn<S> a = sincos_turns(u), b = sincos_half_turns(v);
    const S s = lift<S>(r) * b.sin;
    return {s * a.cos, s * a.sin, -(lift<S>(r) * b.cos)};
  }
  static Vector<T> position_at(T u, T v) {
    const T s = r * std::sin(pi * v);
    return {s * std::cos(tau * u), s * std::sin(tau * u), -r * std::cos(pi * v)};
  }
#if defined(DARBOUX_BENCHMARK_OCCT)
  static Handle(Geom_Surface) occt() {
    return new Geom_SphericalSurface(gp_Ax3(), r);
  }
  static double occt_v(double v) {
    return M_PI * v - M_PI / 2;
  }
#endif
};

#if defined(DARBOUX_BENCHMARK_OCCT)
template <class Surface>
Numbers<double> by_occt(const Handle(Geom_Surface) & surface, bool second, double u, double v) {
  gp_Pnt p;
  gp_Vec a, b, aa, bb, ab;
  if (second)
    surface->D2(2 * M_PI * u, Surface::occt_v(v), p, a, b, aa, bb, ab);
  else
    surface->D1(2 * M_PI * u, Surface::occt_v(v), p, a, b);
  const double du = Surface::du, dv = Surface::dv;
  return with_frame<double>({p.X(), p.Y(), p.Z()}, {du * a.X(), du * a.Y(), du * a.Z()},
                            {dv * b.X(), dv * b.Y(), dv * b.Z()});
}
#endif

template <class Surface, class T>
void by_hand(Method method, Layout layout, Wanted wanted, const T* u, const T* v, std::size_t n,
             const Destination& to) {
  constexpr Layout separate = Layout::separate, vectors = Layout::vectors, structs = Layout::structs;
  constexpr Wanted all = Wanted::all;
  const auto naive = [](T x, T y) { return Surface::naive(x, y); };
  switch (method) {
    case Method::naive:
      switch (wanted) {
        case Wanted::all:
          return layout == separate  ? loop<separate, all>(naive, u, v, n, to)
                 : layout == vectors ? loop<vectors, all>(naive, u, v, n, to)
                                     : loop<structs, all>(naive, u, v, n, to);
        case Wanted::frame:
          return layout == separate ? loop<separate, Wanted::frame>(naive, u, v, n, to)
                                    : loop<vectors, Wanted::frame>(naive, u, v, n, to);
        case Wanted::tangent4:
          return loop<structs, Wanted::tangent4>(naive, u, v, n, to);
        case Wanted::position:
          return;
      }
      return;
    case Method::points: {
      const auto surface = Surface::catalogued();
      const auto vector = [](const Vec3<T>& a) { return Vector<T>{a.x, a.y, a.z}; };
      if (wanted == all)
        return loop<separate, all>(
            [&](T x, T y) {
              const auto [at_u, at_v, j, f] = sample(surface, x, y);
              return Numbers<T>{vector(j.position), vector(j.dpdu), vector(j.dpdv),
                                vector(f.t),        vector(f.b),    vector(f.n)};
            },
            u, v, n, to);
      return loop<separate, Wanted::frame>(
          [&](T x, T y) {
            const Frame<T> f = frame(surface, x, y);
            return Numbers<T>{{}, {}, {}, vector(f.t), vector(f.b), vector(f.n)};
          },
          u, v, n, to);
    }
    case Method::closed_form:
      return loop<separate, all>([](T x, T y) { return Surface::closed_form(x, y); }, u, v, n, to);
    case Method::dual:
      return loop<separate, all>(
          [](T x, T y) {
            return by_dual<T>([](const auto& a, const auto& b) { return Surface::position(a, b); }, x, y);
          },
          u, v, n, to);
    case Method::differences: {
      const T h = difference_step<T>(2);
      return loop<separate, all>(
          [h](T x, T y) {
            return by_differences<T>(
                2, [](T a, T b) { return Surface::position_at(a, b); }, x, y, h);
          },
          u, v, n, to);
    }
    case Method::occt_d1:
    case Method::occt_d2:
#if defined(DARBOUX_BENCHMARK_OCCT)
      if constexpr (std::same_as<T, double>) {
        static const Handle(Geom_Surface) surface = Surface::occt();
        const bool second = method == Method::occt_d2;
        return loop<separate, all>([second](T x, T y) { return by_occt<Surface>(surface, second, x, y); }, u,
                                   v, n, to);
      }
#endif
      return;
  }
}

// ---- through the types of the catalogue -------------------------------------------------------------------

template <class X, class T>
const auto& instance() {
  static const auto surface = rebind<T>(X{});
  return surface;
}

template <class X, class T>
void naive_through(const T* u, const T* v, std::size_t n, const Destination& to) {
  const auto& surface = instance<X, T>();
  loop<Layout::separate, Wanted::all>([&surface](T x, T y) { return naive<T>(surface, x, y); }, u, v, n, to);
}

// ---- a spline as a textbook has it ------------------------------------------------------------------------

constexpr int spline_degree = 3, net_points = 8;

struct Basis {
  int first;  // control point
  std::array<double, spline_degree + 1> value, derivative;
};

Basis basis_at(const std::vector<double>& knots, int p, double t) {
  int low = p, high = net_points;
  int span = high - 1;
  if (t < knots[static_cast<std::size_t>(high)])
    for (span = (low + high) / 2; t < knots[span] || t >= knots[span + 1]; span = (low + high) / 2)
      (t < knots[span] ? high : low) = span;
  Basis basis{span - p, {1}, {}};
  std::array<double, spline_degree + 1> left, right, lower{};
  for (int j = 1; j <= p; ++j) {
    if (j == p) lower = basis.value;
    left[j] = t - knots[span + 1 - j];
    right[j] = knots[span + j] - t;
    double saved = 0;
    for (int r = 0; r < j; ++r) {
      const double part = basis.value[r] / (right[r + 1] + left[j - r]);
      basis.value[r] = saved + right[r + 1] * part;
      saved = left[j - r] * part;
    }
    basis.value[j] = saved;
  }
  for (int r = 0; r <= p; ++r) {
    const double before = r == 0 ? 0 : lower[r - 1] / (knots[span + r] - knots[span - p + r]);
    const double after = r == p ? 0 : lower[r] / (knots[span + r + 1] - knots[span - p + r + 1]);
    basis.derivative[r] = p * (before - after);
  }
  return basis;
}

Numbers<double> spline_point(const BSplinePatch<double>& spline, double u, double v) {
  const int p = spline.knots_u().degree(), q = spline.knots_v().degree();
  const Basis a = basis_at(spline.knots_u().knots(), p, u), b = basis_at(spline.knots_v().knots(), q, v);
  Vector<double> position = Vector<double>::Zero(), dpdu = position, dpdv = position;
  for (int i = 0; i <= p; ++i) {
    Vector<double> along = Vector<double>::Zero(), slope = along;
    for (int j = 0; j <= q; ++j) {
      const Vec3<double>& x = spline.control_points()[(a.first + i) * net_points + b.first + j];
      const Vector<double> point{x.x, x.y, x.z};
      along += b.value[j] * point;
      slope += b.derivative[j] * point;
    }
    position += a.value[i] * along;
    dpdu += a.derivative[i] * along;
    dpdv += a.value[i] * slope;
  }
  return with_frame<double>(position, dpdu, dpdv);
}

// ---- limits -----------------------------------------------------------------------------------------------

// Each line holds what was computed from its index.
#if defined(__x86_64__)
template <bool past_caches>
void write_sse2(const Destination& to) {
  for (std::size_t at = 0; at < to.bytes; at += 64) {
    const __m128i x = _mm_set1_epi64x(static_cast<long long>(at));
    for (std::size_t k = 0; k < to.arrays; ++k) {
      auto* line = reinterpret_cast<__m128i*>(to.base + k * to.stride + at);
      for (int i = 0; i < 4; ++i)
        if constexpr (past_caches)
          _mm_stream_si128(line + i, x);
        else
          _mm_store_si128(line + i, x);
    }
  }
  if constexpr (past_caches) _mm_sfence();
}
template <bool past_caches>
__attribute__((target("avx2"))) void write_avx2(const Destination& to) {
  for (std::size_t at = 0; at < to.bytes; at += 64) {
    const __m256i x = _mm256_set1_epi64x(static_cast<long long>(at));
    for (std::size_t k = 0; k < to.arrays; ++k) {
      auto* line = reinterpret_cast<__m256i*>(to.base + k * to.stride + at);
      for (int i = 0; i < 2; ++i)
        if constexpr (past_caches)
          _mm256_stream_si256(line + i, x);
        else
          _mm256_store_si256(line + i, x);
    }
  }
  if constexpr (past_caches) _mm_sfence();
}
template <bool past_caches>
__attribute__((target("avx512f"))) void write_avx512(const Destination& to) {
  for (std::size_t at = 0; at < to.bytes; at += 64) {
    const __m512i x = _mm512_set1_epi64(static_cast<long long>(at));
    for (std::size_t k = 0; k < to.arrays; ++k) {
      auto* line = reinterpret_cast<__m512i*>(to.base + k * to.stride + at);
      if constexpr (past_caches)
        _mm512_stream_si512(line, x);
      else
        _mm512_store_si512(line, x);
    }
  }
  if constexpr (past_caches) _mm_sfence();
}
#else
void write_plain(const Destination& to) {
  for (std::size_t at = 0; at < to.bytes; at += 64)
    for (std::size_t k = 0; k < to.arrays; ++k) {
      auto* line = reinterpret_cast<std::size_t*>(to.base + k * to.stride + at);
      for (std::size_t i = 0; i < 64 / sizeof(std::size_t); ++i) line[i] = at;
    }
}
#endif

}  // namespace

#if defined(DARBOUX_BENCHMARK_OCCT)
const bool with_occt = true;
#else
const bool with_occt = false;
#endif

template <class T>
void evaluate_by(Method method, ByHand surface, Layout layout, Wanted wanted, const T* u, const T* v,
                 std::size_t n, const Destination& to) {
  if (surface == ByHand::torus)
    by_hand<TorusByHand<T>>(method, layout, wanted, u, v, n, to);
  else
    by_hand<SphereByHand<T>>(method, layout, wanted, u, v, n, to);
}
template void evaluate_by(Method, ByHand, Layout, Wanted, const double*, const double*, std::size_t,
                          const Destination&);
template void evaluate_by(Method, ByHand, Layout, Wanted, const float*, const float*, std::size_t,
                          const Destination&);

template <class T>
const std::vector<CatalogueLoops<T>>& catalogue_loops() {
  static const std::vector<CatalogueLoops<T>> list = [] {
    std::vector<CatalogueLoops<T>> loops;
    Catalogue::for_each([&]<class X>(const X&) { loops.push_back({X::info.name, naive_through<X, T>}); });
    return loops;
  }();
  return list;
}
template const std::vector<CatalogueLoops<double>>& catalogue_loops();
template const std::vector<CatalogueLoops<float>>& catalogue_loops();

BSplinePatch<double> timed_spline() {
  std::vector<Vec3<double>> points;
  for (int i = 0; i < net_points; ++i)
    for (int j = 0; j < net_points; ++j)
      points.push_back({i / 7.0, j / 7.0, 0.2 * std::sin(1.3 * i + 0.7 * j)});
  const std::vector<double> knots = clamped_knots<double>(spline_degree, net_points);
  return {spline_degree, spline_degree, knots, knots, std::move(points)};
}
void textbook_spline(const double* u, const double* v, std::size_t n, const Destination& to) {
  static const BSplinePatch<double> spline = timed_spline();
  loop<Layout::separate, Wanted::all>([](double x, double y) { return spline_point(spline, x, y); }, u, v, n,
                                      to);
}

std::vector<Writer> writers() {
#if defined(__x86_64__)
  std::vector<Writer> list{{"sse2", write_sse2<true>, write_sse2<false>}};
  if (__builtin_cpu_supports("avx2")) list.push_back({"avx2", write_avx2<true>, write_avx2<false>});
  if (__builtin_cpu_supports("avx512f")) list.push_back({"avx512", write_avx512<true>, write_avx512<false>});
  return list;
#else
  return {{"plain", write_plain, write_plain}};
#endif
}

}  // namespace darboux::bench
