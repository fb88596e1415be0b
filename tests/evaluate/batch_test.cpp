// Batches give the bits of single points: for every surface, instruction set, layout, way of storing, number
// of threads and place in the batch.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iostream>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/any_surface.h>
#include <darboux/blocks.h>
#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>

#include "every_surface.h"
#include "random.h"

// Counts what is allocated, by all of this program.
namespace {
std::atomic<std::size_t> allocations = 0;
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace darboux::test::batch_test {
namespace {

template <class T>
constexpr T nan_value = std::numeric_limits<T>::quiet_NaN();

// All numbers of a point in the order of attributes.h, by the functions for single points.
template <class T>
struct Truth {
  std::array<T, all_components> values;
  Status status;         // when everything is asked for
  Status status_of_few;  // when no partial and no direction is
};

template <class X, class T>
Truth<T> truth(const X& surface, T u, T v) {
  const Sample<T> s = sample(surface, u, v);
  const Curvature<T> c = curvature(surface, u, v, s.jet, s.frame);
  Truth<T> result{};
  std::size_t k = 0;
  const auto vec = [&](const Vec3<T>& a) {
    for (const T x : {a.x, a.y, a.z}) result.values[k++] = x;
  };
  for (const Vec3<T>& a : {s.jet.position, s.jet.dpdu, s.jet.dpdv, s.jet.d2pdu2, s.jet.d2pduv, s.jet.d2pdv2,
                           s.frame.t, s.frame.b, s.frame.n})
    vec(a);
  const Vec4<T> t4 = tangent4(s.frame);
  for (const T x :
       {s.frame.handedness, t4.x, t4.y, t4.z, t4.w, c.gaussian, c.mean, c.principal[0], c.principal[1]})
    result.values[k++] = x;
  vec(c.directions[0]);
  vec(c.directions[1]);
  result.status = s.frame.status | (c.status & Status::umbilic);
  result.status_of_few = frame(surface, u, v).status;
  return result;
}

template <class T>
bool same(T a, T b) {
  return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0;
}

// The first component of each attribute in Truth::values.
constexpr std::array<std::size_t, attribute_count> first_component = [] {
  std::array<std::size_t, attribute_count> first{};
  for (std::size_t a = 1; a < attribute_count; ++a)
    first[a] = first[a - 1] + attribute_infos[a - 1].components;
  return first;
}();

enum class Layout { separate, packed, structs, structs_with_gaps, misaligned };
constexpr std::array all_layouts{Layout::separate, Layout::packed, Layout::structs, Layout::structs_with_gaps,
                                 Layout::misaligned};
const char* name(Layout layout) {
  switch (layout) {
    case Layout::separate:
      return "separate";
    case Layout::packed:
      return "packed";
    case Layout::structs:
      return "structs";
    case Layout::structs_with_gaps:
      return "structs with gaps";
    default:
      return "misaligned";
  }
}

// Memory for some attributes in some layout, which knows where each number is and what must not be touched.
template <class T>
class Memory {
 public:
  Memory(Layout layout, Attributes asked, std::size_t points) : asked_(asked), points_(points) {
    std::size_t components = 0;
    for (std::size_t a = 0; a < attribute_count; ++a)
      if (asked.has(static_cast<Attribute>(a))) components += attribute_infos[a].components;
    numbers_.assign((components + 3) * (points + 40) + 64, sentinel);
    while (reinterpret_cast<std::uintptr_t>(&numbers_[begin_]) % 64 != 0) ++begin_;
    std::size_t next = begin_ + (layout == Layout::misaligned ? 1 : 0), offset = 0;
    const bool structs = layout == Layout::structs || layout == Layout::structs_with_gaps;
    const std::size_t gap = layout == Layout::structs_with_gaps ? 1 : 0;
    const std::size_t struct_size = components + 2 * gap;
    // In structs the attributes stand in the opposite order, with a gap before the first and the last.
    for (std::size_t i = 0; i < attribute_count; ++i) {
      const std::size_t a = structs ? attribute_count - 1 - i : i, n = attribute_infos[a].components;
      const auto attribute = static_cast<Attribute>(a);
      if (!asked.has(attribute)) continue;
      if (structs) {
        if (offset == 0) offset = gap;
        if (offset + n == components + gap) offset += gap;
        at_[a] = {next + offset, struct_size, 1};
        outputs.member(attribute, &numbers_[next + offset], points,
                       static_cast<std::ptrdiff_t>(struct_size * sizeof(T)));
        offset += n;
      } else if (layout == Layout::packed) {
        at_[a] = {next, n, 1};
        outputs.packed(attribute, std::span<T>(&numbers_[next], n * points));
        next += n * points + 16 - n * points % 16;
      } else {
        const std::size_t room = points + 16 - points % 16 + (layout == Layout::misaligned ? 3 : 0);
        at_[a] = {next, 1, room};
        std::array<std::span<T>, most_components> arrays;
        for (std::size_t c = 0; c < n; ++c) arrays[c] = {&numbers_[next + c * room], points};
        outputs.separate(attribute, std::span<const std::span<T>>(arrays.data(), n));
        next += n * room;
      }
    }
    status_.assign(points + 1, Status::crease);
    outputs.status(std::span(status_.data(), points));
  }

  // What differs from the truths of the first `n` points, empty when nothing does; all else must be
  // untouched.
  std::string difference(const std::vector<Truth<T>>& truths, std::size_t n) {
    std::vector<T> left = numbers_;
    for (std::size_t a = 0; a < attribute_count; ++a) {
      if (!asked_.has(static_cast<Attribute>(a))) continue;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t c = 0; c < attribute_infos[a].components; ++c) {
          const std::size_t k = at_[a].first + i * at_[a].point_step + c * at_[a].component_step;
          const T expected = truths[i].values[first_component[a] + c];
          if (!same(numbers_[k], expected))
            return std::string(attribute_infos[a].name) + "[" + std::to_string(c) + "] of point " +
                   std::to_string(i) + " is " + std::to_string(numbers_[k]) + ", of the single point " +
                   std::to_string(expected);
          left[k] = sentinel;
        }
    }
    for (const T x : left)
      if (std::memcmp(&x, &sentinel, sizeof x) != 0) return "written beside the results";
    // Overflow is flagged by the partials asked for, umbilic with the directions: where not all are, these
    // may miss.
    const bool everything = asked_.has(Attribute::d2pdu2);
    for (std::size_t i = 0; i < n; ++i) {
      const Status expected = everything ? truths[i].status : truths[i].status_of_few;
      if ((everything ? status_[i] : detail::without(status_[i], Status::overflow)) !=
          (everything ? expected : detail::without(expected, Status::overflow)))
        return "status of point " + std::to_string(i) + " is " +
               std::to_string(static_cast<int>(status_[i])) + ", of the single point " +
               std::to_string(static_cast<int>(expected));
    }
    if (status_[n] != Status::crease) return "written beside the statuses";
    return {};
  }
  const std::vector<Status>& status() const { return status_; }

  Outputs<T> outputs;

 private:
  static constexpr T sentinel = T(-12345.678);
  struct Place {
    std::size_t first, point_step, component_step;
  };
  Attributes asked_;
  std::size_t points_, begin_ = 0;
  std::vector<T> numbers_;
  std::vector<Status> status_;
  std::array<Place, attribute_count> at_{};
};

Attributes all_attributes() {
  Attributes all;
  for (std::size_t a = 0; a < attribute_count; ++a) all |= static_cast<Attribute>(a);
  return all;
}

std::vector<std::pair<std::string, Attributes>> requests() {
  return {{"everything", all_attributes()},
          {"first", Attribute::position | Attribute::dpdu | Attribute::dpdv | Attribute::tangent |
                        Attribute::bitangent | Attribute::normal},
          {"frames", Attribute::tangent | Attribute::bitangent | Attribute::normal | Attribute::handedness},
          {"tangent4", Attribute::tangent4},
          {"position and d2pduv", Attribute::position | Attribute::d2pduv},
          {"principal curvatures", Attribute::principal_curvatures}};
}

// Those that formulas have to look at.
template <class T>
std::vector<T> odd_values() {
  return {T(0),
          T(1),
          T(0.5),
          T(0.25),
          -T(0),
          std::numeric_limits<T>::denorm_min(),
          std::nextafter(T(1), T(0)),
          std::nextafter(T(1), T(2)),
          T(-0.3),
          T(1.7),
          T(1e10),
          T(-1e30),
          std::numeric_limits<T>::max(),
          std::numeric_limits<T>::infinity(),
          nan_value<T>};
}

// Ordinary points, among them in every place of a batch those that lanes leave to the single-point functions.
template <class T>
std::pair<std::vector<T>, std::vector<T>> some_points(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  const std::vector<T> odd = odd_values<T>();
  std::vector<T> u(n), v(n);
  for (std::size_t i = 0; i < n; ++i)
    for (auto* x : {&u[i], &v[i]})
      *x = random.uniform() < (i < 64 ? 0.01 : 0.03) ? odd[random.bits() % odd.size()]
                                                     : static_cast<T>(random.uniform());
  // A run of points on the edges, as in the rows of a grid.
  for (std::size_t i = 100; i < std::min<std::size_t>(n, 140); ++i) v[i] = i < 120 ? T(0) : T(1);
  for (std::size_t i = 170; i < std::min<std::size_t>(n, 210); ++i) u[i] = i < 190 ? T(0.5) : T(0);
  return {u, v};
}

// Parameters within and beyond the sizes for which lanes are used.
template <class X>
X other_parameters(Random& random, int kind) {
  X surface;
  for_each_parameter<X>([&](const auto& p) {
    auto& value = p.of(surface);
    const double before = static_cast<double>(value);
    double changed = kind == 0 ? before * random.uniform(0.5, 2) : random.log_uniform(1e-3, 1e3);
    if (kind == 2) changed = random.log_uniform(1e-12, 1e12);
    if (kind == 3 && random.uniform() < 0.5) changed = 0;
    if (before < 0) changed = -changed;
    if (p.permitted.contains(changed)) value = static_cast<std::remove_cvref_t<decltype(value)>>(changed);
  });
  try {
    return checked(surface);
  } catch (const ParameterError&) {
    return X{};
  }
}

// A surface over T, its type erased so that the tests are compiled once: its batches and its single points.
template <class T>
struct Subject {
  std::string_view name;
  std::function<StatusSummary(const Points<T>&, const Outputs<T>&, const EvaluateOptions&)> evaluate;
  std::function<Truth<T>(T, T)> truth;

  std::vector<Truth<T>> truths(const std::vector<T>& u, const std::vector<T>& v) const {
    std::vector<Truth<T>> result;
    for (std::size_t i = 0; i < u.size(); ++i) result.push_back(truth(u[i], v[i]));
    return result;
  }
};
template <class T, class X>
Subject<T> subject(const X& standard) {
  const auto surface = rebind<T>(standard);
  return {X::info.name,
          [surface](const Points<T>& points, const Outputs<T>& outputs, const EvaluateOptions& options) {
            return evaluate(surface, points, outputs, options);
          },
          [surface](T u, T v) { return batch_test::truth(surface, u, v); }};
}

// Every instruction set, layout and way of storing, for the first n of the points.
template <class T>
void expect_same(const Subject<T>& surface, const std::vector<T>& u, const std::vector<T>& v,
                 const std::vector<Truth<T>>& truths, std::size_t n, Attributes asked,
                 const std::string& what) {
  const auto points = Points<T>::arrays(std::span(u).first(n), std::span(v).first(n));
  for (const InstructionSet set : instruction_sets())
    for (const Layout layout : all_layouts)
      for (const Stores stores : {Stores::cached, Stores::past_caches}) {
        Memory<T> memory(layout, asked, n);
        const StatusSummary summary =
            surface.evaluate(points, memory.outputs, {.stores = stores, .instruction_set = set});
        ASSERT_EQ(memory.difference(truths, n), "")
            << surface.name << ", " << what << ", " << name_of(set) << ", " << name(layout)
            << (stores == Stores::cached ? ", cached, " : ", past caches, ") << n << " points, " << sizeof(T)
            << " bytes";
        ASSERT_EQ(summary.points, n);
        for (std::size_t k = 0; k < status_names.size(); ++k) {
          std::size_t count = 0, first = 0;
          for (std::size_t i = n; i-- > 0;)
            if (has(memory.status()[i], static_cast<Status>(1u << k))) ++count, first = i;
          ASSERT_EQ(summary.count[k], count) << what << ' ' << status_names[k];
          ASSERT_EQ(summary.first[k], first) << what << ' ' << status_names[k];
        }
      }
}

#ifdef DARBOUX_SHORT_TESTS
constexpr std::size_t many = 280;
#else
constexpr std::size_t many = 531;
#endif

template <class T>
void expect_same_for_every_request(const Subject<T>& surface) {
  const auto [u, v] = some_points<T>(many, 41);
  const auto truths = surface.truths(u, v);
  for (const auto& [what, asked] : requests()) expect_same(surface, u, v, truths, many, asked, what);
  // The ends of blocks, groups and registers.
  for (const std::size_t n :
       {0, 1, 2, 7, 8, 15, 16, 17, 31, 33, 47, 48, 63, 64, 65, 255, 256, 257, 271, 272, 273})
    expect_same(surface, u, v, truths, n, requests()[1].second, "first");
}

// Lanes do the work, where nothing is left to the single-point functions.
template <class T>
void expect_lanes(const Subject<T>& surface) {
  const std::vector<T> u(200, T(0.3)), v(200, T(0.2));
  for (const InstructionSet set : instruction_sets()) {
    Memory<T> memory(Layout::packed, all_attributes(), u.size());
    const StatusSummary summary =
        surface.evaluate(Points<T>::arrays(u, v), memory.outputs, {.instruction_set = set});
    EXPECT_EQ(summary.point_by_point, set == InstructionSet::points ? u.size() : 0U)
        << surface.name << ' ' << name_of(set);
  }
}

// Every odd value all along a run, as in a row or column of a grid: there no lane beside it gives it away.
template <class T>
void expect_same_along_edges(const Subject<T>& surface) {
  Random random(52);
  std::vector<T> u, v;
  for (const T x : odd_values<T>())
    for (const bool along_u : {true, false})
      for (int i = 0; i < 40; ++i) {
        const T other = static_cast<T>(random.uniform());
        u.push_back(along_u ? other : x);
        v.push_back(along_u ? x : other);
      }
  const auto truths = surface.truths(u, v);
  for (const auto& [what, asked] : requests())
    expect_same(surface, u, v, truths, u.size(), asked, what + " along edges");
}

// Rows of a grid, whole, in parts, short, and wider than what is prepared at once.
template <class T>
void expect_same_on_grids(const Subject<T>& surface) {
  for (const auto& [columns, rows, first, count] : {std::array<std::size_t, 4>{33, 9, 0, 10},
                                                    {1, 1, 0, 2},
                                                    {9, 30, 2, 25},
                                                    {16, 40, 7, 30},
                                                    {40, 40, 0, 41},
                                                    {512, 3, 1, 3},
                                                    {1100, 2, 1, 2}}) {
    const auto grid = Points<T>::grid(columns, rows, first, count);
    std::vector<Truth<T>> truths;
    for (std::size_t j = first; j < first + count; ++j)
      for (std::size_t i = 0; i <= columns; ++i)
        truths.push_back(surface.truth(static_cast<T>(static_cast<double>(i) / static_cast<double>(columns)),
                                       static_cast<T>(static_cast<double>(j) / static_cast<double>(rows))));
    ASSERT_EQ(grid.size(), truths.size());
    for (const InstructionSet set : instruction_sets())
      for (const Layout layout : {Layout::separate, Layout::structs, Layout::misaligned})
        for (const Stores stores : {Stores::cached, Stores::past_caches})
          for (const Attributes asked : {requests()[1].second, requests()[3].second}) {
            Memory<T> memory(layout, asked, grid.size());
            surface.evaluate(grid, memory.outputs, {.stores = stores, .instruction_set = set});
            ASSERT_EQ(memory.difference(truths, truths.size()), "")
                << surface.name << ' ' << columns << 'x' << rows << name_of(set);
            const std::size_t from = truths.size() / 3, n = truths.size() / 2;
            Memory<T> of_part(layout, asked, n);
            surface.evaluate(grid.part(from, n), of_part.outputs, {.stores = stores, .instruction_set = set});
            ASSERT_EQ(
                of_part.difference({truths.begin() + static_cast<std::ptrdiff_t>(from), truths.end()}, n), "")
                << surface.name << ' ' << columns << 'x' << rows << name_of(set);
          }
  }
}

template <class T>
void expect_same_on_several_threads(const Subject<T>& surface) {
  const std::size_t n = 3 * 2048 + 77;
  const auto [u, v] = some_points<T>(n, 44);
  const auto truths = surface.truths(u, v);
  for (const InstructionSet set : instruction_sets())
    for (const int threads : {1, 2, 3, 0})
      for (const Stores stores : {Stores::cached, Stores::past_caches})
        for (const Layout layout : {Layout::packed, Layout::misaligned, Layout::structs}) {
          Memory<T> memory(layout, requests()[1].second, n);
          const StatusSummary summary =
              surface.evaluate(Points<T>::arrays(u, v), memory.outputs,
                               {.threads = threads, .stores = stores, .instruction_set = set});
          ASSERT_EQ(memory.difference(truths, n), "")
              << surface.name << ' ' << name_of(set) << ' ' << threads << name(layout);
          const auto regular = static_cast<std::size_t>(
              std::count(memory.status().begin(), memory.status().end() - 1, Status::regular));
          ASSERT_EQ(summary.points, n);
          ASSERT_EQ(summary.all_regular(), regular == n);
        }
}

template <class X>
class SameBits : public ::testing::Test {};
TYPED_TEST_SUITE(SameBits, EveryCatalogueSurface, SurfaceNames);

TYPED_TEST(SameBits, ForEveryRequestAndLayout) {
  std::cout << many << " points\n";
  expect_same_for_every_request(subject<double>(TypeParam{}));
  expect_same_for_every_request(subject<float>(TypeParam{}));
}

TYPED_TEST(SameBits, ByLanes) {
  expect_lanes(subject<double>(TypeParam{}));
  expect_lanes(subject<float>(TypeParam{}));
}

TYPED_TEST(SameBits, ForOtherParameters) {
  Random random(42);
  const auto each = [&]<class T>(T) {
    const auto [u, v] = some_points<T>(160, 43);
    for (int k = 0; k < 8; ++k) {
      const Subject<T> other = subject<T>(other_parameters<TypeParam>(random, k % 4));
      const auto truths = other.truths(u, v);
      for (const Attributes asked : {all_attributes(), Attributes(Attribute::tangent4)})
        expect_same(other, u, v, truths, u.size(), asked, "other parameters");
    }
  };
  each(double{});
  each(float{});
}

TYPED_TEST(SameBits, AlongEdges) {
  expect_same_along_edges(subject<double>(TypeParam{}));
  expect_same_along_edges(subject<float>(TypeParam{}));
}

TYPED_TEST(SameBits, OnGrids) {
  expect_same_on_grids(subject<double>(TypeParam{}));
  expect_same_on_grids(subject<float>(TypeParam{}));
}

TYPED_TEST(SameBits, OnSeveralThreads) {
  expect_same_on_several_threads(subject<double>(TypeParam{}));
  expect_same_on_several_threads(subject<float>(TypeParam{}));
}

// What a surface says of its tangent holds: else batches of tangents alone would be wrong.
TYPED_TEST(SameBits, TangentsThatDependOnUAloneDo) {
  const TypeParam surface{};
  if constexpr (requires { surface.tangent_depends_on_u_alone(); }) {
    if (!surface.tangent_depends_on_u_alone()) return;
    Random random(45);
    for (int i = 0; i < 1000; ++i) {
      const double u = random.uniform();
      const Frame<double> f = frame(surface, u, random.uniform(0.001, 0.999)), g = frame(surface, u, 0.25);
      EXPECT_TRUE(f.t == g.t && f.handedness == g.handedness && f.status == g.status);
    }
  }
}

// ---- other sources and surfaces ---------------------------------------------------------------------------

// A user's own type goes the same way, point by point.
struct Wave {
  static constexpr SurfaceInfo info{"wave", "a user's graph", Coordinate::turn, Coordinate::linear};
  template <class S>
  Jet2<S> jet(const Turn<S>& u, const S& v) const {
    const S zero = lift<S>(0.0), one = lift<S>(1.0), tau = two_pi<S>();
    return {.position = {u.sin, v, v * u.cos},
            .dpdu = {tau * u.cos, zero, -(tau * (v * u.sin))},
            .dpdv = {zero, one, u.cos},
            .d2pdu2 = {-(tau * (tau * u.sin)), zero, -(tau * (tau * (v * u.cos)))},
            .d2pduv = {zero, zero, -(tau * u.sin)},
            .d2pdv2 = {zero, zero, zero}};
  }
};

TEST(Batch, OfAUsersSurface) {
  const auto [u, v] = some_points<double>(300, 46);
  std::vector<Truth<double>> truths;
  for (std::size_t i = 0; i < u.size(); ++i) truths.push_back(truth(Wave{}, u[i], v[i]));
  for (const Layout layout : all_layouts) {
    Memory<double> memory(layout, all_attributes(), u.size());
    evaluate(Wave{}, Points<double>::arrays(u, v), memory.outputs);
    EXPECT_EQ(memory.difference(truths, u.size()), "") << name(layout);
  }
}

TEST(Batch, OfASurfaceChosenAtRunTime) {
  const auto [u, v] = some_points<double>(300, 47);
  const auto [fu, fv] = some_points<float>(300, 47);
  for (const AnySurface& surface : all_surfaces()) {
    std::vector<Vec3<double>> n(u.size());
    Outputs<double> outputs;
    outputs.packed(Attribute::normal, std::span<double>(&n[0].x, 3 * n.size()));
    surface.evaluate(Points<double>::arrays(u, v), outputs);
    std::vector<Vec3<float>> p(fu.size());
    Outputs<float> in_float;
    in_float.packed(Attribute::position, std::span<float>(&p[0].x, 3 * p.size()));
    evaluate(surface, Points<float>::arrays(fu, fv), in_float);
    for (std::size_t i = 0; i < u.size(); ++i) {
      const Vec3<double> expected = surface.frame(u[i], v[i]).n;
      EXPECT_TRUE(same(n[i].x, expected.x) && same(n[i].y, expected.y) && same(n[i].z, expected.z));
      const Vec3<float> q = surface.sample_in_float(fu[i], fv[i]).jet.position;
      EXPECT_TRUE(same(p[i].x, q.x) && same(p[i].y, q.y) && same(p[i].z, q.z)) << surface.info().name << i;
    }
  }
}

TEST(Batch, FromInterleavedPairsAndStructs) {
  struct Vertex {
    float weight, u, v, more[2];
  };
  const auto [u, v] = some_points<float>(333, 48);
  std::vector<float> pairs;
  std::vector<Vertex> vertices;
  for (std::size_t i = 0; i < u.size(); ++i) {
    pairs.insert(pairs.end(), {u[i], v[i]});
    vertices.push_back({0, u[i], v[i], {}});
  }
  const auto surface = rebind<float>(Torus{});
  const auto tangents = [&](const Points<float>& points) {
    std::vector<float> t(4 * points.size());
    Outputs<float> outputs;
    outputs.packed(Attribute::tangent4, t);
    evaluate(surface, points, outputs);
    return t;
  };
  const auto expected = tangents(Points<float>::arrays(u, v));
  const auto equal = [](const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), &same<float>);
  };
  EXPECT_TRUE(equal(tangents(Points<float>::interleaved(pairs)), expected));
  const auto members = Points<float>::interleaved(&vertices[0].u, vertices.size(), sizeof(Vertex));
  EXPECT_TRUE(equal(tangents(members), expected));
  EXPECT_EQ(tangents(members.part(100, 50)).size(), 200U);
  EXPECT_TRUE(
      equal(tangents(members.part(300, 33)), std::vector<float>(expected.begin() + 4 * 300, expected.end())));
}

TEST(Batch, SignsOfTangent4FollowTheConvention) {
  const std::vector<double> u{0.1, 0.2}, v{0.3, 0.5};
  const Torus spindle{0.5, 1.0};
  for (const SignConvention sign : {SignConvention::gltf, SignConvention::raw}) {
    std::vector<double> t(8);
    Outputs<double> outputs;
    outputs.packed(Attribute::tangent4, t);
    evaluate(spindle, Points<double>::arrays(u, v), outputs, {.sign = sign});
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(t[4 * i + 3], tangent4(frame(spindle, u[i], v[i]), sign).w);
  }
}

// The caller owns the memory: a call of its own thread takes none, of any size and in any layout.
TEST(Batch, AllocatesNothing) {
  const auto [u, v] = some_points<double>(3000, 51);
  const auto points = Points<double>::arrays(u, v);
  for (const Layout layout : all_layouts)
    for (const Stores stores : {Stores::cached, Stores::past_caches}) {
      Memory<double> memory(layout, all_attributes(), u.size());
      evaluate(Torus{}, points, memory.outputs, {.stores = stores});  // finds the kernels
      const std::size_t before = allocations.load();
      evaluate(Torus{}, points, memory.outputs, {.stores = stores});
      evaluate(Torus{}, Points<double>::grid(40, 40), memory.outputs, {.stores = stores});
      EXPECT_EQ(allocations.load(), before) << name(layout);
    }
  const std::size_t before = allocations.load();
  std::vector<int> one(1);
  EXPECT_GT(allocations.load(), before) << "nothing is counted";
}

// Points in double on a surface whose parameters are floats: no kernel is made for that.
TEST(Batch, InDoubleOfASurfaceOverFloat) {
  const std::vector<double> u(40, 0.1), v(40, 0.3);
  const Torus<float> surface{1.5F, 0.5F};
  std::vector<double> p(120);
  Outputs<double> outputs;
  outputs.packed(Attribute::position, p);
  evaluate(surface, Points<double>::arrays(u, v), outputs);
  EXPECT_EQ(p[117], sample(surface, 0.1, 0.3).jet.position.x);
}

// Sizes within what is proven of each, but not of their products.
TEST(Batch, OverflowIsFlaggedInEveryLane) {
  const std::vector<float> u(40, 0.3F), v(40, 0.5F);
  const OneSheetHyperboloid<float> steep{1.0F, 1e-10F, 1e12F};
  std::vector<float> p(120);
  for (const InstructionSet set : instruction_sets()) {
    Outputs<float> outputs;
    outputs.packed(Attribute::d2pdv2, p);
    const StatusSummary summary =
        evaluate(steep, Points<float>::arrays(u, v), outputs, {.instruction_set = set});
    EXPECT_EQ(summary.count[10], 40U) << name_of(set);
    EXPECT_EQ(status_names[10], "overflow");
  }
}

// The cost of a part of a grid does not grow with the width of its rows: this would take hours.
TEST(Batch, PartsOfAVeryWideGrid) {
  const auto grid = Points<double>::grid(std::size_t{1} << 30, 8);
  std::vector<double> n(3 * 100);
  Outputs<double> outputs;
  outputs.packed(Attribute::normal, n);
  for (const std::size_t first : {std::size_t{5}, std::size_t{1} << 29, (std::size_t{1} << 30) - 50}) {
    for (int i = 0; i < 1000; ++i) evaluate(Sphere{}, grid.part(first, 100), outputs);
    const auto [u, v] = grid[first + 99];
    EXPECT_EQ(n[299], frame(Sphere{}, u, v).n.z);
  }
}

// ---- blocks -----------------------------------------------------------------------------------------------

TEST(Blocks, HandEveryPointOnceInOrder) {
  const auto [u, v] = some_points<double>(2500, 49);
  for (const bool on_grid : {false, true}) {
    const auto points = on_grid ? Points<double>::grid(70, 40) : Points<double>::arrays(u, v);
    std::size_t next = 0, calls = 0;
    const StatusSummary summary = for_each_block(
        Sphere{2.0}, points, Attribute::position | Attribute::normal, [&](const Block<double>& block) {
          EXPECT_EQ(block.first, next);
          EXPECT_TRUE(block(Attribute::dpdu).empty());
          for (std::size_t i = 0; i < block.size(); ++i) {
            const auto [pu, pv] = points[block.first + i];
            const Sample<double> s = sample(Sphere{2.0}, pu, pv);
            EXPECT_TRUE(same(block.vec3(Attribute::position, i).y, s.jet.position.y));
            EXPECT_TRUE(same(block(Attribute::normal, 2)[i], s.frame.n.z));
            EXPECT_EQ(block.status[i], s.frame.status);
          }
          next += block.size();
          ++calls;
        });
    EXPECT_EQ(next, points.size());
    EXPECT_EQ(summary.points, points.size());
    EXPECT_EQ(calls, 3U);
  }
}

TEST(Blocks, PassOnExceptions) {
  const auto [u, v] = some_points<double>(2500, 50);
  int calls = 0;
  EXPECT_THROW(for_each_block(all_surfaces()[0], Points<double>::arrays(u, v), Attribute::normal,
                              [&](const Block<double>&) {
                                if (++calls == 2) throw std::runtime_error("enough");
                              }),
               std::runtime_error);
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace darboux::test::batch_test
