// work_precision.h: errors are the true ones, times are of all methods in turns, what fails is recorded,
// fronts are fronts, and intervals cover.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include <darboux/error.h>
#include <darboux/work_precision.h>

namespace darboux::test::work_precision_test {
namespace {

using Samples = std::vector<WorkSample>;

// All methods; few points and rounds.
WorkOptions few(std::vector<AnySurface> surfaces, std::vector<int> resolutions = {}) {
  WorkOptions options;
  options.surfaces = std::move(surfaces);
  for (const WorkMethod& method : work_methods()) options.methods.push_back(&method);
  options.families = {&find_mesh_family("jittered")};
  options.resolutions = std::move(resolutions);
  options.rounds = 3;
  options.points = 64;
  options.checked = 64;
  options.timeout = 100;  // not what is tested
  return options;
}

const WorkSample& find(const Samples& samples, std::string_view method, int resolution = 0) {
  for (const WorkSample& s : samples)
    if (s.method == method && s.resolution == resolution) return s;
  throw std::runtime_error("no sample of " + std::string(method));
}

// ---- errors -----------------------------------------------------------------------------------------------

class EverySurface : public ::testing::TestWithParam<AnySurface> {};
INSTANTIATE_TEST_SUITE_P(Catalogue, EverySurface, ::testing::ValuesIn(all_surfaces()), [](const auto& info) {
  std::string name(info.param.info().name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

// Every method answers on every surface; Darboux to the same bits on all instruction sets; 40 digits rounded
// once are off by a rounding of each component; formulas are no worse than differences of the second order.
TEST_P(EverySurface, HasErrorsAsTheMethodsPromise) {
  const Samples samples = work_precision(few({GetParam()}));
  std::set<std::string> methods;
  for (const WorkSample& s : samples) {
    methods.insert(s.method);
    EXPECT_EQ(s.failure, "") << s.method;
    EXPECT_EQ(s.rounds.size(), 3u) << s.method;
    EXPECT_GT(s["time_ns"], 0) << s.method;
    EXPECT_LE(s.time_low, s["time_ns"]) << s.method;
    EXPECT_GE(s.time_high, s["time_ns"]) << s.method;
    EXPECT_LE(s["frame_rms"], s["frame_max"]) << s.method;
    EXPECT_GE(s["frame_max"], std::max({s["tangent_max"], s["bitangent_max"], s["normal_max"]})) << s.method;
    if (s.family != "darboux") continue;
    const bool single = s.method.ends_with("-float");
    const WorkSample& points = find(samples, single ? "darboux-points-float" : "darboux-points");
    for (std::size_t k = 2; k < work_metrics.size(); ++k)  // behind the two times
      EXPECT_EQ(s.metric[k], points.metric[k]) << s.method << ' ' << work_metrics[k];
    // A thousandth of what differences are right to: far above any bound of check, at these points.
    EXPECT_LT(s["frame_max"], single ? 1e-2 : 1e-10) << s.method;
  }
  for (const WorkMethod& method : work_methods())
    EXPECT_EQ(methods.contains(std::string(method.name)), method.domain == WorkDomain::evaluation)
        << method.name;
  constexpr double u = 0x1p-53;
  EXPECT_LT(find(samples, "many-digits")["frame_max"], 2 * u);     // sqrt(3) u of a unit vector
  EXPECT_LT(find(samples, "many-digits")["partials_max"], 2 * u);  // of each, of the longest
  // Differences of polynomials may be exact.
  const double of_differences = std::fmax(find(samples, "differences-2")["partials_max"], 16 * u);
  for (const char* method : {"darboux-points", "naive", "dual"})
    EXPECT_LT(find(samples, method)["partials_max"], of_differences) << method;
}

// The exact frame, turned about its normal by a known angle; partials too long by a known share.
double planted_angle = 0, planted_share = 0;
bool turned(const AnySurface& surface, const WorkBatch<double>& batch) {
  find_work_methods("many-digits").front()->in_double(surface, batch);
  for (std::size_t i = 0; i < batch.u.size(); ++i) {
    const double c = std::cos(planted_angle), s = std::sin(planted_angle);
    for (std::size_t k = 0; k < 3; ++k) {
      double &t = batch.numbers[9 + k][i], &b = batch.numbers[12 + k][i];
      const double old = t;
      t = c * t + s * b;
      b = c * b - s * old;
      batch.numbers[3 + k][i] *= 1 + planted_share;
    }
  }
  return true;
}

TEST(WorkPrecision, ErrorsAreThoseThatWerePlanted) {
  static const WorkMethod planted{"turned", "turned", "", WorkDomain::evaluation, turned};
  for (const auto& [angle, share] : {std::pair{1e-13, 1e-13}, {1e-9, 1e-6}, {1e-3, 0.1}, {2.5, 2.0}}) {
    planted_angle = angle;
    planted_share = share;
    WorkOptions options = few({make_surface("sphere")});
    options.methods = {&planted};
    const Samples samples = work_precision(options);
    ASSERT_EQ(samples.size(), 1u);
    const WorkSample& s = samples.front();
    const double rounding = 4 * 0x1p-53;  // of the vectors that are turned
    for (const char* metric : {"tangent_max", "tangent_rms", "bitangent_max", "bitangent_rms", "frame_max"})
      EXPECT_NEAR(s[metric], angle, rounding + 1e-9 * angle) << metric;
    EXPECT_LT(s["normal_max"], rounding);
    EXPECT_NEAR(s["partials_max"], share, 0.01 * share + rounding);  // of the longest among 64 points
    EXPECT_LT(s["position_max"], rounding);
  }
}

// What is no unit vector has no direction, and so no error that is a number; and what has none is on no
// front, though nothing is faster.
bool all_zero(const AnySurface&, const WorkBatch<double>& batch) {
  for (const std::span<double>& numbers : batch.numbers) std::fill(numbers.begin(), numbers.end(), 0.0);
  return true;
}
bool too_long(const AnySurface& surface, const WorkBatch<double>& batch) {
  find_work_methods("many-digits").front()->in_double(surface, batch);
  for (std::size_t k = 9; k < 12; ++k)
    for (double& x : batch.numbers[k]) x *= 1.5;
  return true;
}

TEST(WorkPrecision, WhatIsNoUnitVectorHasAnInfiniteError) {
  static const WorkMethod planted[] = {{"zeros", "zeros", "", WorkDomain::evaluation, all_zero},
                                       {"long", "long", "", WorkDomain::evaluation, too_long}};
  WorkOptions options = few({make_surface("torus")});
  options.methods = {&planted[0], &planted[1], find_work_methods("ridders").front()};
  const Samples samples = work_precision(options);
  for (const char* metric : {"tangent_max", "bitangent_max", "normal_max", "frame_max", "frame_rms"})
    EXPECT_TRUE(std::isinf(find(samples, "zeros")[metric])) << metric;
  EXPECT_TRUE(std::isinf(find(samples, "long")["tangent_max"]));
  EXPECT_LT(find(samples, "long")["normal_max"], 1e-15);
  for (const char* method : {"zeros", "long"}) {
    EXPECT_EQ(find(samples, method).failure, "");
    EXPECT_FALSE(find(samples, method).on_front || find(samples, method).best_of_family) << method;
  }
  EXPECT_TRUE(find(samples, "ridders").on_front);
}

// A method's errors on meshes are those of `converge`, in radians.
TEST(WorkPrecision, ErrorsOnMeshesAreThoseOfConverge) {
  const WorkOptions options = few({make_surface("cylinder")}, {8, 16, 32});
  const Samples samples = work_precision(options);
  ConvergeOptions of_converge;
  of_converge.surfaces = options.surfaces;
  of_converge.families = options.families;
  of_converge.resolutions = options.resolutions;
  of_converge.seeds = 1;
  for (const FrameMethod& method : frame_methods()) of_converge.methods.push_back(&method);
  std::size_t compared = 0;
  for (const FrameMethod& method : frame_methods())
    for (const int n : options.resolutions) {
      double largest = 0, squares = 0, corners = 0;
      for (const Study& study : converge(of_converge)) {
        if (study.method != method.name || study.quantity != "tangent") continue;
        for (const Level& level : study.levels)
          if (level.resolution == n) {
            const auto count = static_cast<double>(level.corners - level.fallback);
            largest = std::max(largest, level.max_deg);
            squares += level.rms_deg * level.rms_deg * count;
            corners += count;
          }
      }
      const WorkSample& s = find(samples, method.name, n);
      EXPECT_DOUBLE_EQ(s["tangent_max"], largest * std::numbers::pi / 180) << method.name;
      EXPECT_NEAR(s["tangent_rms"] / (std::sqrt(squares / corners) * std::numbers::pi / 180), 1, 1e-12);
      EXPECT_EQ(s.points, 12u * static_cast<std::size_t>(n * n));
      EXPECT_EQ(std::isnan(s["normal_max"]), method.needs_normals) << method.name;
      EXPECT_TRUE(std::isnan(s["partials_max"]));
      ++compared;
    }
  EXPECT_EQ(compared, 3 * frame_methods().size());
}

TEST(WorkPrecision, ErrorsDependOnTheOptionsAlone) {
  WorkOptions options = few({make_surface("torus")}, {6});
  const auto errors = [&] {
    std::vector<double> result;
    for (const WorkSample& s : work_precision(options))
      for (std::size_t k = 2; k < work_metrics.size(); ++k)
        if (!std::isnan(s.metric[k])) result.push_back(s.metric[k]);
    return result;
  };
  const std::vector<double> first = errors();
  EXPECT_EQ(errors(), first);
  options.seed = 2;
  EXPECT_NE(errors(), first);
}

// ---- failures ---------------------------------------------------------------------------------------------

int calls_of_slow = 0;
bool slow(const AnySurface&, const WorkBatch<double>& batch) {
  if (batch.u.size() == 1) return true;
  ++calls_of_slow;
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  return true;
}
bool broken(const AnySurface&, const WorkBatch<double>&) {
  throw std::runtime_error("planted");
}
bool absent(const AnySurface&, const WorkBatch<double>&) {
  return false;
}
MeshFrames broken_on_16(const Mesh& mesh, int threads) {
  if (mesh.triangles.size() >= 1024) throw std::runtime_error("too many triangles");
  return find_frame_method("face").compute(mesh, threads);
}
MeshFrames slow_on_8(const Mesh& mesh, int threads) {
  if (mesh.triangles.size() >= 256) std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  return find_frame_method("face").compute(mesh, threads);
}

TEST(WorkPrecision, FailuresAreRecordedAndTheRunGoesOn) {
  static FrameMethod frame_broken = find_frame_method("face"), frame_slow = frame_broken;
  frame_broken.name = "frame-broken";
  frame_broken.compute = broken_on_16;
  frame_slow.name = "frame-slow";
  frame_slow.compute = slow_on_8;
  static const WorkMethod planted[] = {
      {"slow", "planted", "", WorkDomain::evaluation, slow},
      {"broken", "planted", "", WorkDomain::evaluation, broken},
      {"absent", "planted", "", WorkDomain::evaluation, absent},
      {"frame-broken", "planted", "", WorkDomain::meshes, nullptr, nullptr, &frame_broken},
      {"frame-slow", "planted", "", WorkDomain::meshes, nullptr, nullptr, &frame_slow}};
  WorkOptions options = few({make_surface("torus")}, {4, 8, 16});
  options.methods = {&planted[0],
                     &planted[1],
                     &planted[2],
                     find_work_methods("naive").front(),
                     &planted[3],
                     &planted[4],
                     find_work_methods("face").front()};
  options.timeout = 1;
  const Samples samples = work_precision(options);
  EXPECT_TRUE(find(samples, "slow").failure.starts_with("timed out: a call took 1."))
      << find(samples, "slow").failure;
  EXPECT_EQ(calls_of_slow, 1);
  EXPECT_EQ(find(samples, "broken").failure, "failed: planted");
  EXPECT_THROW(find(samples, "absent"), std::runtime_error);
  EXPECT_EQ(find(samples, "frame-broken", 8).failure, "");
  EXPECT_EQ(find(samples, "frame-broken", 16).failure, "failed: too many triangles");
  EXPECT_EQ(find(samples, "frame-slow", 4).failure, "");
  EXPECT_TRUE(find(samples, "frame-slow", 8).failure.starts_with("timed out"));
  EXPECT_EQ(find(samples, "frame-slow", 16).failure, "not run: timed out on 8 rows");
  for (const WorkSample& s : samples) {
    if (s.failure.empty()) {
      EXPECT_EQ(s.rounds.size(), 3u) << s.method;
      continue;
    }
    EXPECT_TRUE(s.rounds.empty() && !s.on_front && !s.best_of_family) << s.method;
    for (const double x : s.metric) EXPECT_TRUE(std::isnan(x));
  }
  for (const int n : options.resolutions) EXPECT_EQ(find(samples, "face", n).failure, "");
  EXPECT_EQ(find(samples, "naive").failure, "");
}

// What float does not hold fails in float alone; without a method in float nobody asks.
TEST(WorkPrecision, ASurfaceThatFloatDoesNotHoldFailsThere) {
  WorkOptions options = few({make_surface("torus"), make_surface("sphere:radius=1e300")});
  options.methods = {find_work_methods("darboux-points").front(),
                     find_work_methods("darboux-points-float").front()};
  const Samples samples = work_precision(options);
  ASSERT_EQ(samples.size(), 4u);
  for (const WorkSample& s : samples) {
    const bool held = s.surface.starts_with("torus") || s.method == "darboux-points";
    EXPECT_EQ(s.failure.starts_with("failed: "), !held) << s.surface << ' ' << s.method << s.failure;
    EXPECT_EQ(s.rounds.empty(), !held) << s.method;
  }
  EXPECT_NE(samples[3].failure.find("radius"), std::string::npos) << samples[3].failure;
  options.methods.pop_back();
  for (const WorkSample& s : work_precision(options)) EXPECT_EQ(s.failure, "") << s.surface;
}

// A mesh that cannot be made is a failure of each method at that resolution, not silence.
TEST(WorkPrecision, AMeshThatCannotBeMadeIsAFailureOfEachMethod) {
  WorkOptions options = few({make_surface("torus:major_radius=1e300")}, {4, 8});
  options.families = {&find_mesh_family("graded"), &find_mesh_family("jittered")};
  options.methods = {find_work_methods("face").front(), find_work_methods("average").front()};
  const Samples samples = work_precision(options);
  ASSERT_EQ(samples.size(), 8u);
  for (const WorkSample& s : samples)
    EXPECT_EQ(s.failure.starts_with("failed: "), s.mesh == "graded") << s.mesh << ' ' << s.failure;
}

// ---- fronts -----------------------------------------------------------------------------------------------

TEST(WorkPrecision, AFrontIsWhatNothingDominatesAndDominatesTheRest) {
  std::mt19937_64 random(5);                                               // NOLINT: the same every time
  const auto number = [&] { return static_cast<double>(random() % 12); };  // ties too
  for (int trial = 0; trial < 200; ++trial) {
    Samples samples(1 + random() % 30);
    for (WorkSample& s : samples) {
      s.surface = random() % 2 == 0 ? "torus" : "sphere";
      s.family = random() % 3 == 0 ? "a" : "b";
      s.domain = WorkDomain::evaluation;
      s.metric.fill(std::numeric_limits<double>::quiet_NaN());
      s.metric[find_work_metric("time_ns")] = number();
      if (random() % 9 != 0)
        s.metric[find_work_metric("frame_max")] =
            random() % 9 == 0 ? std::numeric_limits<double>::infinity() : number();
    }
    mark_fronts(samples);
    const auto beats = [](const WorkSample& a, const WorkSample& b) {
      return a.surface == b.surface && a["time_ns"] <= b["time_ns"] && a["frame_max"] <= b["frame_max"] &&
             (a["time_ns"] < b["time_ns"] || a["frame_max"] < b["frame_max"]);
    };
    for (const WorkSample& s : samples) {
      const auto beaten_by = [&](auto which) {
        return std::any_of(samples.begin(), samples.end(),
                           [&](const WorkSample& other) { return which(other) && beats(other, s); });
      };
      const bool numbers = std::isfinite(s["frame_max"]);
      EXPECT_EQ(s.on_front, numbers && !beaten_by([](const WorkSample&) { return true; }));
      EXPECT_EQ(s.best_of_family,
                numbers && !beaten_by([&](const WorkSample& other) { return other.family == s.family; }));
      EXPECT_TRUE(!numbers || s.on_front ||
                  beaten_by([](const WorkSample& other) { return other.on_front; }));
    }
  }
}

// ---- two runs ---------------------------------------------------------------------------------------------

class Rounds {
 public:
  explicit Rounds(std::uint64_t seed) : random_(seed) {}
  // Times about `typical`: a log-normal spread of 5 %, and now and then a round that something else
  // disturbed.
  std::vector<double> of(double typical, int count) {
    std::vector<double> rounds;
    for (int i = 0; i < count; ++i) {
      const double disturbed = uniform() < 0.1 ? 1 + 2 * uniform() : 1;
      const double normal =
          std::sqrt(-2 * std::log(1 - uniform())) * std::cos(2 * std::numbers::pi * uniform());
      rounds.push_back(typical * std::exp(0.05 * normal) * disturbed);
    }
    return rounds;
  }

 private:
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::mt19937_64 random_;
};

// 95 % of 1000: three standard deviations of the share are 2.1 %; with few rounds more is covered, since
// ranks are whole numbers.
TEST(WorkPrecision, TheIntervalOfADifferenceCovers) {
  for (const auto& [m, n, most] :
       {std::tuple{11, 11, 0.975}, {21, 21, 0.975}, {9, 30, 0.975}, {5, 5, 0.995}}) {
    Rounds rounds(static_cast<std::uint64_t>(m * n));
    int covered = 0;
    for (int trial = 0; trial < 1000; ++trial) {
      const double truth = 0.5 + 0.002 * trial;
      const TimeRatio r = time_ratio(rounds.of(80, m), rounds.of(80 * truth, n));
      EXPECT_LE(r.low, r.ratio);
      EXPECT_LE(r.ratio, r.high);
      covered += r.low <= truth && truth <= r.high;
    }
    EXPECT_GE(covered, 929) << m << ' ' << n;
    EXPECT_LE(covered, 1000 * most) << m << ' ' << n;
  }
  EXPECT_TRUE(std::isinf(time_ratio(std::vector{1.0, 2.0, 3.0}, std::vector{1.0, 2.0, 3.0}).high));
  EXPECT_EQ(time_ratio(std::vector{1.0, 2.0, 3.0}, std::vector{3.0, 6.0, 9.0}).ratio, 3);
}

TEST(WorkPrecision, ComparesWhatBothHave) {
  Rounds rounds(3);
  const auto sample = [&](const std::string& method, double time, double error) {
    WorkSample s;
    s.surface = "torus";
    s.method = s.family = method;
    s.domain = WorkDomain::evaluation;
    s.rounds = rounds.of(time, 21);
    s.metric.fill(std::numeric_limits<double>::quiet_NaN());
    s.metric[find_work_metric("frame_max")] = error;
    return s;
  };
  WorkSample failed = sample("fails", 80, 1e-16);
  failed.failure = "failed: planted";
  failed.rounds.clear();
  const Samples before{sample("same", 80, 1e-16),  sample("slower", 80, 1e-16), sample("faster", 80, 1e-16),
                       sample("worse", 80, 1e-16), sample("better", 80, 1e-16), sample("zero", 80, 0),
                       sample("fails", 80, 1e-16), sample("before", 80, 1)};
  const Samples after{sample("same", 80, 1e-16),
                      sample("slower", 120, 1e-16),
                      sample("faster", 50, 1e-16),
                      sample("worse", 80, 1.2e-16),
                      sample("better", 80, 1e-17),
                      sample("zero", 80, 1e-30),
                      failed,
                      sample("after", 80, 1)};
  const std::vector<WorkComparison> pairs = compare_work(before, after, 0.1);
  ASSERT_EQ(pairs.size(), 7u);
  const std::array<std::string_view, 7> verdicts{"same", "slower",     "faster", "less exact",
                                                 "same", "less exact", "failed"};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_EQ(pairs[i].verdict, verdicts[i]) << pairs[i].after.method;
    EXPECT_EQ(pairs[i].holds(), i == 0 || i == 2 || i == 4);
  }
  EXPECT_EQ(pairs[3].worst_metric, "frame_max");
  EXPECT_NEAR(pairs[3].error_ratio, 1.2, 1e-12);
  EXPECT_TRUE(std::isinf(pairs[5].error_ratio));
  // All is the same where the tolerance is wide, but what failed, and what was exact.
  for (const WorkComparison& c : compare_work(before, after, 10))
    EXPECT_EQ(c.holds(), c.after.method != "fails" && c.after.method != "zero") << c.after.method;
}

// Three rounds prove nothing; an error that is gone is worse; other points are another question.
TEST(WorkPrecision, WhatCannotBeComparedIsNotTheSame) {
  Rounds rounds(4);
  WorkSample before;
  before.surface = "torus";
  before.domain = WorkDomain::evaluation;
  before.points = 64;
  before.metric.fill(std::numeric_limits<double>::quiet_NaN());
  before.metric[find_work_metric("frame_max")] = 1e-16;
  before.rounds = {80, 81, 82};
  WorkSample after = before;
  after.rounds = {800, 810, 820};
  const auto compare = [&] { return compare_work({before}, {after}, 0.1).at(0); };
  EXPECT_EQ(compare().verdict, "undetermined");
  EXPECT_FALSE(compare().holds());
  before.rounds.push_back(83);
  after.rounds.push_back(830);
  EXPECT_EQ(compare().verdict, "slower");
  after.rounds = before.rounds;
  EXPECT_EQ(compare().verdict, "same");
  after.metric[find_work_metric("tangent_max")] = 1;
  EXPECT_EQ(compare().verdict, "same");  // new, not lost
  after.metric[find_work_metric("frame_max")] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(compare().verdict, "less exact");
  EXPECT_EQ(compare().worst_metric, "frame_max");
  after = before;
  after.points = 65;
  EXPECT_TRUE(compare_work({before}, {after}, 0.1).empty());
  after.points = 0;
  after.failure = "failed: planted";
  EXPECT_EQ(compare().verdict, "failed");
}

// Something that disturbs all rounds of one run but the fastest is no change of the program.
TEST(WorkPrecision, ADisturbedRunIsNoSlowerOne) {
  WorkSample quiet, disturbed;
  quiet.surface = disturbed.surface = "torus";
  quiet.metric.fill(1);
  disturbed.metric.fill(1);
  for (int i = 0; i < 21; ++i) {
    quiet.rounds.push_back(100 + i);
    disturbed.rounds.push_back(i == 0 ? 101 : 200 + i);
  }
  const std::vector<WorkComparison> pairs = compare_work({quiet}, {disturbed}, 0.1);
  EXPECT_GT(pairs.front().time.low, 1.5);
  EXPECT_EQ(pairs.front().verdict, "same");
  EXPECT_EQ(compare_work({disturbed}, {quiet}, 0.1).front().verdict, "same");
}

// ---- options ----------------------------------------------------------------------------------------------

TEST(WorkPrecision, AnErrorThatIsNoNumberDoesNotHold) {
  WorkSample s;
  s.metric.fill(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(s.holds());
  s.metric[find_work_metric("frame_max")] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(s.holds());
  s.metric[find_work_metric("frame_max")] = 1;
  s.failure = "timed out";
  EXPECT_FALSE(s.holds());
}

TEST(WorkPrecision, RefusesWhatIsNotThere) {
  EXPECT_THROW(find_work_methods("simd"), ParameterError);
  EXPECT_THROW(find_work_metric("time"), ParameterError);
  EXPECT_EQ(find_work_methods("naive").size(), 1u);
  EXPECT_EQ(find_work_methods("averages").size(), 5u);
  EXPECT_EQ(find_work_methods("differences").size(), 8u);
  const auto refused = [](auto change) {
    WorkOptions options = few({make_surface("plane")}, {4, 8});
    change(options);
    EXPECT_THROW(work_jobs(options), ParameterError);
  };
  refused([](WorkOptions& o) { o.rounds = 2; });
  refused([](WorkOptions& o) { o.points = 15; });
  refused([](WorkOptions& o) { o.checked = 0; });
  refused([](WorkOptions& o) { o.timeout = 0; });
  refused([](WorkOptions& o) { o.resolutions = {8, 8}; });
  refused([](WorkOptions& o) { o.resolutions = {1, 8}; });
  EXPECT_EQ(work_jobs(few({make_surface("plane")}, {4, 8})).size(), 2u);
  EXPECT_EQ(work_jobs(few({make_surface("plane")})).size(), 1u);
}

}  // namespace
}  // namespace darboux::test::work_precision_test
