// Measures times in rounds, and errors against the truth.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include <darboux/error.h>
#include <darboux/work_precision.h>

#include "base/quantile.h"
#include "base/rounds.h"
#include "base/text.h"

namespace darboux {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// A method being measured: the members that time_in_rounds() requires, and the sample.
struct Item {
  const WorkMethod* method;
  std::function<void()> run;
  std::size_t points;
  std::vector<double> ns{};
  std::string failure{};
};

// A step that all methods need; rounds::guarded() says why it failed.
struct Attempt {
  std::string failure{};
};

WorkSample sample_of(const Item& item, const AnySurface& surface) {
  WorkSample s;
  s.surface = surface.specification();
  s.method = item.method->name;
  s.family = item.method->family;
  s.domain = item.method->domain;
  s.points = item.points;
  s.failure = item.failure;
  s.metric.fill(nan);
  if (!item.failure.empty()) return s;
  s.rounds = item.ns;
  s.time_low = quantile(item.ns, 0.25);
  s.time_high = quantile(item.ns, 0.75);
  const double middle = quantile(item.ns, 0.5);
  s.metric[find_work_metric("time_ns")] = middle;
  s.metric[find_work_metric("seconds")] = middle * 1e-9 * static_cast<double>(item.points);
  return s;
}

// The largest error and the root mean square. An error that is not a number makes both infinite.
struct Errors {
  double largest = 0, squares = 0;
  std::size_t count = 0;
  void add(double error) {
    if (!std::isfinite(error)) error = infinity;
    largest = std::fmax(largest, error);
    squares += error * error;
    ++count;
  }
  double rms() const { return std::sqrt(squares / static_cast<double>(count)); }
};
void set(WorkSample& s, const std::string& name, const Errors& e) {
  if (e.count == 0) return;
  s.metric[find_work_metric(name + "_max")] = e.largest;
  if (name != "partials" && name != "position") s.metric[find_work_metric(name + "_rms")] = e.rms();
}

// ---- evaluation -------------------------------------------------------------------------------------------

// A vector in 40 digits as the sum of two vectors of doubles.
struct Twofold {
  Vec3<double> high, low;
  explicit Twofold(const Vec3<Multiprecision>& a) {
    const auto rounded = [](const Vec3<Multiprecision>& x) {
      return Vec3<double>{static_cast<double>(x.x), static_cast<double>(x.y), static_cast<double>(x.z)};
    };
    high = rounded(a);
    low = rounded({a.x - Multiprecision(high.x), a.y - Multiprecision(high.y), a.z - Multiprecision(high.z)});
  }
  // The error of `a`, exact if `a` is near.
  Vec3<double> error_of(const Vec3<double>& a) const { return (a - high) - low; }
  // The angle from this unit vector to `a`: a × this = (a - this) × this. A vector that is not unit to a
  // thousandth, such as zero, has no meaningful direction: infinity.
  double angle_to(const Vec3<double>& a) const {
    if (!(std::abs(norm(a) - 1) < 1e-3)) return infinity;
    return std::atan2(norm(cross(error_of(a), high)), dot(a, high));
  }
};

// For each checked point: position, dpdu, dpdv, t, b, n; and the greatest length of the first three.
struct Truth {
  std::vector<std::array<Twofold, 6>> at;
  std::array<double, 3> longest{};
};
template <class T>
Truth truth_at(const AnySurface& surface, const WorkBatch<T>& batch, std::size_t count) {
  Truth truth;
  for (std::size_t i = 0; i < count; ++i) {
    const auto u = static_cast<double>(batch.u[i]), v = static_cast<double>(batch.v[i]);
    const Jet2<Multiprecision> j = surface.jet(Multiprecision(u), Multiprecision(v));
    const Vec3<Multiprecision> t = unit(j.dpdu);
    // On the side that the surface states.
    const Multiprecision side(surface.frame(u, v).handedness);
    const Vec3<Multiprecision> n = side * unit(cross(j.dpdu, j.dpdv));
    truth.at.push_back({Twofold(j.position), Twofold(j.dpdu), Twofold(j.dpdv), Twofold(t),
                        Twofold(cross(n, t)), Twofold(n)});
    for (std::size_t k = 0; k < 3; ++k)
      truth.longest[k] = std::fmax(truth.longest[k], norm(truth.at.back()[k].high));
  }
  return truth;
}

template <class T>
void set_errors(WorkSample& s, const WorkBatch<T>& batch, const Truth& truth, bool keeps_side,
                const AnySurface& surface) {
  Errors position, partials, frame;
  std::array<Errors, 3> of_vector;
  for (std::size_t i = 0; i < truth.at.size(); ++i) {
    const auto vector = [&](std::size_t k) {
      return Vec3<double>{batch.numbers[3 * k][i], batch.numbers[3 * k + 1][i], batch.numbers[3 * k + 2][i]};
    };
    for (std::size_t k = 0; k < 3; ++k)
      (k == 0 ? position : partials).add(norm(truth.at[i][k].error_of(vector(k))) / truth.longest[k]);
    // n of a cross product is on the side of dpdu × dpdv, and so is b.
    const double side =
        keeps_side
            ? 1
            : surface.frame(static_cast<double>(batch.u[i]), static_cast<double>(batch.v[i])).handedness;
    double worst = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = truth.at[i][3 + k].angle_to((k == 0 ? 1 : side) * vector(3 + k));
      of_vector[k].add(angle);
      worst = std::isnan(angle) ? infinity : std::fmax(worst, angle);
    }
    frame.add(worst);
  }
  set(s, "position", position);
  set(s, "partials", partials);
  set(s, "tangent", of_vector[0]);
  set(s, "bitangent", of_vector[1]);
  set(s, "normal", of_vector[2]);
  set(s, "frame", frame);
}

// The surface's numbers rounded to float: the input of float, and of double at the same points.
std::vector<double> values_in_float(const AnySurface& surface) {
  std::vector<double> values;
  for (const ParameterValue& p : surface.parameters()) values.push_back(static_cast<float>(p.value));
  return values;
}

bool has_float(const WorkOptions& options) {
  return std::any_of(options.methods.begin(), options.methods.end(),
                     [](const WorkMethod* m) { return m->in_float != nullptr; });
}

// The methods of one precision on one surface.
template <class T>
class Evaluations {
 public:
  Evaluations(const WorkOptions& options, const AnySurface& given)
      : options_(options), given_(given), surface_(given) {
    if (in_float && has_float(options) && !given.parameters().empty())
      rounds::guarded(in_its_numbers_, [&] { surface_ = given.with(values_in_float(given)); });
    const auto count = static_cast<std::size_t>(options.points);
    std::mt19937_64 random(options.seed);
    // Below 1 in float too.
    const auto uniform = [&] { return static_cast<T>(static_cast<double>(random() >> 40) * 0x1p-24); };
    for (std::size_t i = 0; i < count; ++i) {
      u_.push_back(uniform());
      v_.push_back(uniform());
    }
    // Arrays whose distance is not a power of two.
    const std::size_t stride = count + 40;
    memory_.resize(18 * stride);
    batch_.u = u_;
    batch_.v = v_;
    for (std::size_t k = 0; k < 18; ++k) batch_.numbers[k] = {&memory_[k * stride], count};
  }
  Evaluations(const Evaluations&) = delete;
  Evaluations& operator=(const Evaluations&) = delete;

  // The methods that the surface supports.
  void append_items(std::vector<Item>& items) {
    WorkBatch<T> few = batch_;
    few.u = few.u.first(1);
    few.v = few.v.first(1);
    for (std::span<T>& numbers : few.numbers) numbers = numbers.first(1);
    for (const WorkMethod* method : options_.methods) {
      const auto evaluate = of(*method);
      if (evaluate == nullptr) continue;
      Item item{method, [this, evaluate] { evaluate(surface_, batch_); }, u_.size()};
      bool there = true;
      rounds::guarded(item, [&] { there = evaluate(surface_, few); });
      if (!in_its_numbers_.failure.empty()) item.failure = in_its_numbers_.failure;
      if (there) items.push_back(item);
    }
  }

  // Appends the samples of this precision's items once they have been timed.
  void append_samples(std::vector<Item>& items, std::vector<WorkSample>& samples) {
    Truth truth;
    Attempt at_truth{in_its_numbers_.failure};
    bool there = false;
    for (Item& item : items) {
      if (of(*item.method) == nullptr) continue;
      if (!std::exchange(there, true))
        rounds::guarded(at_truth, [&] {
          truth = truth_at(surface_, batch_,
                           static_cast<std::size_t>(std::min(options_.checked, options_.points)));
        });
      if (item.failure.empty()) item.failure = at_truth.failure;
      std::fill(memory_.begin(), memory_.end(), std::numeric_limits<T>::quiet_NaN());
      rounds::guarded(item, item.run);
      samples.push_back(sample_of(item, given_));
      if (item.failure.empty())
        set_errors(samples.back(), batch_, truth, item.method->family == "darboux", surface_);
    }
  }

 private:
  static constexpr bool in_float = std::same_as<T, float>;
  static auto of(const WorkMethod& method) {
    if constexpr (in_float)
      return method.in_float;
    else
      return method.in_double;
  }

  const WorkOptions& options_;
  const AnySurface& given_;
  AnySurface surface_;  // in its numbers
  Attempt in_its_numbers_;
  std::vector<T> u_, v_, memory_;
  WorkBatch<T> batch_;
};

// Double and float alternate within the same rounds.
std::vector<WorkSample> evaluation_samples(const WorkOptions& options, const AnySurface& surface,
                                           const std::function<void()>& after) {
  Evaluations<double> in_double(options, surface);
  Evaluations<float> in_float(options, surface);
  std::vector<Item> items;
  in_double.append_items(items);
  in_float.append_items(items);
  time_in_rounds(items, options.rounds, options.timeout, after);
  std::vector<WorkSample> samples;
  in_double.append_samples(items, samples);
  in_float.append_samples(items, samples);
  return samples;
}

// ---- meshes -----------------------------------------------------------------------------------------------

// Over all classes together, except poles.
void set_errors(WorkSample& s, const std::vector<LevelSample>& levels) {
  constexpr double radians = std::numbers::pi / 180;
  for (const std::string_view quantity : study_quantities) {
    Errors all;
    for (const LevelSample& level : levels) {
      if (level.method != s.method || level.quantity != quantity || level.vertex_class == VertexClass::pole)
        continue;
      const std::size_t corners = level.level.corners - level.level.fallback;
      all.largest = std::fmax(all.largest, radians * level.level.max_deg);
      all.squares += std::pow(radians * level.level.rms_deg, 2) * static_cast<double>(corners);
      all.count += corners;
    }
    set(s, std::string(quantity), all);
    if (quantity == "tangent") set(s, "frame", all);
  }
}

std::vector<WorkSample> mesh_samples(const WorkOptions& options, const AnySurface& surface,
                                     const MeshFamily& family, const std::function<void()>& after) {
  std::vector<WorkSample> samples;
  std::vector<std::pair<const WorkMethod*, std::string>> stopped;  // with their failure
  for (const int n : options.resolutions) {
    Mesh mesh;
    Attempt at_mesh;
    rounds::guarded(at_mesh, [&] { mesh = sample_mesh(surface, mesh_options(family, n, options.seed)); });
    std::vector<Item> items;
    for (const WorkMethod* method : options.methods) {
      if (method->on_meshes == nullptr) continue;
      Item item{method, [&mesh, method] { mesh_frames(mesh, *method->on_meshes); }, mesh.corners()};
      item.failure = at_mesh.failure;
      for (const auto& [other, why] : stopped)
        if (other == method) item.failure = why;
      items.push_back(item);
    }
    time_in_rounds(items, options.rounds, options.timeout, after);
    ConvergeOptions errors;
    errors.surfaces = {surface};
    errors.families = {&family};
    errors.seed = options.seed;
    for (const Item& item : items)
      if (item.failure.empty()) errors.methods.push_back(item.method->on_meshes);
    std::vector<LevelSample> levels;
    if (!errors.methods.empty())
      rounds::guarded(at_mesh, [&] { levels = run_converge_job(errors, {0, 0, n}); });
    for (Item& item : items) {
      if (item.failure.empty()) item.failure = at_mesh.failure;
      WorkSample s = sample_of(item, surface);
      s.mesh = family.name;
      s.resolution = n;
      if (item.failure.empty()) set_errors(s, levels);
      samples.push_back(s);
      if (item.failure.starts_with("timed out"))
        stopped.emplace_back(item.method, "not run: timed out on " + std::to_string(n) + " rows");
    }
  }
  return samples;
}

void check(const WorkOptions& o) {
  const auto at_least = [](const char* name, auto value, auto least) {
    if (value < least)
      throw ParameterError(name, expected_got("at least " + shortest(least), shortest(value)));
  };
  at_least("rounds", o.rounds, 3);
  at_least("points", o.points, 16);
  at_least("checked", o.checked, 1);
  if (!(o.timeout > 0)) throw ParameterError("timeout", expected_got("seconds above 0", shortest(o.timeout)));
  for (std::size_t i = 0; i < o.resolutions.size(); ++i)
    at_least("resolutions", o.resolutions[i], i == 0 ? 2 : o.resolutions[i - 1] + 1);
}

bool any(const WorkOptions& options, WorkDomain domain) {
  return std::any_of(options.methods.begin(), options.methods.end(),
                     [&](const WorkMethod* m) { return m->domain == domain; });
}

}  // namespace

std::vector<WorkJob> work_jobs(const WorkOptions& options) {
  check(options);
  std::vector<WorkJob> jobs;
  for (std::size_t s = 0; s < options.surfaces.size(); ++s) {
    if (any(options, WorkDomain::evaluation)) jobs.push_back({s, options.families.size()});
    if (any(options, WorkDomain::meshes) && !options.resolutions.empty())
      for (std::size_t f = 0; f < options.families.size(); ++f) jobs.push_back({s, f});
  }
  return jobs;
}

std::vector<WorkSample> run_work_job(const WorkOptions& options, const WorkJob& job,
                                     const std::function<void(double)>& progress) {
  const AnySurface& surface = options.surfaces[job.surface];
  const bool evaluation = job.family == options.families.size();
  double done = 0,
         all = options.rounds * (evaluation ? 1.0 : static_cast<double>(options.resolutions.size()));
  const auto after = [&] {
    if (progress) progress(++done / all);
  };
  if (!evaluation) return mesh_samples(options, surface, *options.families[job.family], after);
  return evaluation_samples(options, surface, after);
}

std::vector<WorkSample> work_precision(const WorkOptions& options,
                                       const std::function<void(double)>& progress) {
  std::vector<WorkSample> samples;
  const std::vector<WorkJob> jobs = work_jobs(options);
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (WorkSample& s : run_work_job(options, jobs[i], [&](double share) {
           if (progress) progress((static_cast<double>(i) + share) / static_cast<double>(jobs.size()));
         }))
      samples.push_back(std::move(s));
  mark_fronts(samples);
  return samples;
}

}  // namespace darboux
