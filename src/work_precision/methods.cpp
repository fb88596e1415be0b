// The methods: loops over points, and those of frame_methods().
#include <algorithm>
#include <iterator>

#include <darboux/catalogue.h>
#include <darboux/differentiate.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/work_precision.h>

#include "base/nearest_name.h"
#include "base/text.h"
#include "loops.h"

namespace darboux {
namespace {

template <class T>
void put(const WorkBatch<T>& batch, std::size_t i, const loops::Numbers<T>& x) {
  std::size_t k = 0;
  for (const loops::Vector<T>* a : {&x.position, &x.dpdu, &x.dpdv, &x.t, &x.b, &x.n})
    for (Eigen::Index c = 0; c < 3; ++c) batch.numbers[k++][i] = (*a)[c];
}

// Calls f(surface, u, v) at all points, with the surface as its type in the catalogue.
template <class T, class F>
bool through_its_type(const AnySurface& any, const WorkBatch<T>& batch, const F& f) {
  bool found = false;
  Catalogue::for_each([&]<class X>(const X&) {
    const X* held = found ? nullptr : any.get<X>();
    if (held == nullptr) return;
    found = true;
    const auto surface = rebind<T>(*held);
    for (std::size_t i = 0; i < batch.u.size(); ++i) put(batch, i, f(surface, batch.u[i], batch.v[i]));
  });
  return found;
}

template <class T>
bool naive(const AnySurface& surface, const WorkBatch<T>& batch) {
  return through_its_type(surface, batch, [](const auto& s, T u, T v) { return loops::naive<T>(s, u, v); });
}
template <class T>
bool dual(const AnySurface& surface, const WorkBatch<T>& batch) {
  return through_its_type(surface, batch, [](const auto& s, T u, T v) { return loops::dual<T>(s, u, v); });
}
template <class T>
bool differences_of(int order, const AnySurface& surface, const WorkBatch<T>& batch) {
  const T h = loops::difference_step<T>(order);
  return through_its_type(surface, batch, [order, h](const auto& s, T u, T v) {
    return loops::differences<T>(order, s, u, v, h);
  });
}
template <class T, int order>
bool differences(const AnySurface& surface, const WorkBatch<T>& batch) {
  return differences_of(order, surface, batch);
}

bool by_ridders(const AnySurface& surface, const WorkBatch<double>& batch) {
  for (std::size_t i = 0; i < batch.u.size(); ++i) {
    const double u = batch.u[i], v = batch.v[i];
    const auto along = [&](auto position, double x) {
      return loops::eigen(ridders(position, x, 1. / 8).value);
    };
    put(batch, i,
        loops::with_frame<double>(loops::eigen(surface.jet(u, v).position),
                                  along([&](double x) { return surface.jet(x, v).position; }, u),
                                  along([&](double x) { return surface.jet(u, x).position; }, v)));
  }
  return true;
}

bool many_digits(const AnySurface& surface, const WorkBatch<double>& batch) {
  for (std::size_t i = 0; i < batch.u.size(); ++i) {
    const Jet2<Multiprecision> j = surface.jet(Multiprecision(batch.u[i]), Multiprecision(batch.v[i]));
    const Vec3<Multiprecision> t = unit(j.dpdu), n = unit(cross(j.dpdu, j.dpdv));
    std::size_t k = 0;
    for (const Vec3<Multiprecision>& a : {j.position, j.dpdu, j.dpdv, t, cross(n, t), n})
      for (const Multiprecision& x : {a.x, a.y, a.z}) batch.numbers[k++][i] = static_cast<double>(x);
  }
  return true;
}

template <class T, InstructionSet set>
bool darboux_on(const AnySurface& surface, const WorkBatch<T>& batch) {
  constexpr std::array attributes{Attribute::position, Attribute::dpdu,      Attribute::dpdv,
                                  Attribute::tangent,  Attribute::bitangent, Attribute::normal};
  Outputs<T> outputs;
  for (std::size_t a = 0; a < attributes.size(); ++a)
    outputs.separate(attributes[a], std::span(batch.numbers).subspan(3 * a, 3));
  surface.evaluate(Points<T>::arrays(batch.u, batch.v), outputs, {.instruction_set = set});
  return true;
}

constexpr WorkDomain points = WorkDomain::evaluation;
using Set = InstructionSet;
constexpr const char
    *batches = "evaluate() of Darboux, closed-form frames",
    *by_naive =
        "the surface's formula at the C++ library's sine and cosine, cross product, division by lengths",
    *by_dual = "partials by dual numbers through the position, cross product",
    *by_differences = "partials by central differences of the position, cross product";
constexpr WorkMethod of_evaluation[] = {
    {"darboux-points", "darboux", batches, points, darboux_on<double, Set::points>},
    {"darboux-points-float", "darboux", batches, points, nullptr, darboux_on<float, Set::points>},
    {"darboux-baseline", "darboux", batches, points, darboux_on<double, Set::baseline>},
    {"darboux-baseline-float", "darboux", batches, points, nullptr, darboux_on<float, Set::baseline>},
    {"darboux-avx2", "darboux", batches, points, darboux_on<double, Set::avx2>},
    {"darboux-avx2-float", "darboux", batches, points, nullptr, darboux_on<float, Set::avx2>},
    {"darboux-avx512", "darboux", batches, points, darboux_on<double, Set::avx512>},
    {"darboux-avx512-float", "darboux", batches, points, nullptr, darboux_on<float, Set::avx512>},
    {"naive", "naive", by_naive, points, naive<double>},
    {"naive-float", "naive", by_naive, points, nullptr, naive<float>},
    {"dual", "dual", by_dual, points, dual<double>},
    {"dual-float", "dual", by_dual, points, nullptr, dual<float>},
    {"differences-2", "differences", by_differences, points, differences<double, 2>},
    {"differences-2-float", "differences", by_differences, points, nullptr, differences<float, 2>},
    {"differences-4", "differences", by_differences, points, differences<double, 4>},
    {"differences-4-float", "differences", by_differences, points, nullptr, differences<float, 4>},
    {"differences-6", "differences", by_differences, points, differences<double, 6>},
    {"differences-6-float", "differences", by_differences, points, nullptr, differences<float, 6>},
    {"differences-8", "differences", by_differences, points, differences<double, 8>},
    {"differences-8-float", "differences", by_differences, points, nullptr, differences<float, 8>},
    {"ridders", "ridders", "partials by Ridders' extrapolation of differences, cross product", points,
     by_ridders},
    {"many-digits", "many-digits", "everything in 40 digits, rounded at the end", points, many_digits},
};

// The families of methods over meshes; other methods are their own family.
struct Member {
  std::string_view method, family;
};
constexpr Member members[] = {{"mikktspace", "mikktspace"},
                              {"mikktspace-bitangent", "mikktspace"},
                              {"average", "averages"},
                              {"unit", "averages"},
                              {"area", "averages"},
                              {"angle", "averages"},
                              {"max", "averages"},
                              {"fragment-gradient", "fragment"},
                              {"fragment-solve", "fragment"},
                              {"quadratic", "polynomials"},
                              {"cubic", "polynomials"}};
std::string_view family_of(std::string_view method) {
  for (const Member& member : members)
    if (member.method == method) return member.family;
  return method;
}

}  // namespace

std::span<const WorkMethod> work_methods() {
  static const std::vector<WorkMethod> all = [] {
    std::vector<WorkMethod> list;
    const auto sets = instruction_sets();
    for (const WorkMethod& method : of_evaluation) {
      // Methods for other machines are omitted.
      const std::string_view name = method.name;
      bool here = method.family != "darboux";
      for (const InstructionSet set : sets)
        here = here || name.substr(0, name.find("-float")) == "darboux-" + std::string(name_of(set));
      if (here) list.push_back(method);
    }
    for (const FrameMethod& method : frame_methods())
      list.push_back({method.name, family_of(method.name), method.summary, WorkDomain::meshes, nullptr,
                      nullptr, &method});
    return list;
  }();
  return all;
}

std::vector<const WorkMethod*> find_work_methods(std::string_view name) {
  std::vector<const WorkMethod*> found;
  std::vector<std::string> known, told;
  const auto tell = [&](std::string_view text) {
    if (!text.ends_with("-float") && std::find(told.begin(), told.end(), text) == told.end())
      told.emplace_back(text);
  };
  for (const WorkMethod& method : work_methods()) {
    if (method.name == name) return {&method};
    if (method.family == name) found.push_back(&method);
    for (const std::string_view text : {method.family, method.name}) known.emplace_back(text), tell(text);
  }
  if (found.empty())
    throw ParameterError("method '" + std::string(name) + "'",
                         "unknown" + did_you_mean(name, known) + ", known are " + joined(told) +
                             "; most that evaluate points have a -float form");
  return found;
}

std::size_t find_work_metric(std::string_view name) {
  for (std::size_t k = 0; k < work_metrics.size(); ++k)
    if (work_metrics[k] == name) return k;
  throw ParameterError(
      "metric '" + std::string(name) + "'",
      "unknown, known are " + joined(std::vector<std::string>(work_metrics.begin(), work_metrics.end())));
}

}  // namespace darboux
