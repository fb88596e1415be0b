// The errors that a report keeps are those that its statistics are of.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <darboux/assess.h>
#include <darboux/catalogue.h>
#include <darboux/fit_mesh.h>
#include <darboux/frame.h>
#include <darboux/sample_mesh.h>

#include "append_mesh.h"
#include "random_pose.h"

namespace darboux::kept_errors_test {
namespace {

AssessOptions keeping(const References& references = {}) {
  AssessOptions options;
  options.references = references;
  options.keep_errors = true;
  return options;
}

// Turns every tangent by up to 20 degrees about its normal.
void spoil(Mesh& mesh, std::mt19937_64& random) {
  std::uniform_real_distribution<double> angle(-0.35, 0.35);
  for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
    const double a = angle(random);
    const Vec3<double> t = mesh.tangents[v].xyz(), s = cross(mesh.normals[v], t);
    const Vec3<double> turned = std::cos(a) * t + std::sin(a) * s;
    mesh.tangents[v] = {turned.x, turned.y, turned.z, mesh.tangents[v].w};
  }
}

const std::optional<Statistics>& assessed(const ClassReport& c, const Mesh& mesh) {
  return mesh.tangents.empty() ? c.normal_deg : c.tangent_deg;
}

// The statistics of each class from the errors at its corners.
void expect_same_statistics(const Mesh& mesh, const std::vector<VertexClass>& classes,
                            const MeshReport& report) {
  ASSERT_EQ(report.errors_deg.size(), mesh.corners());
  std::array<std::vector<float>, vertex_class_names.size()> errors;
  for (std::size_t c = 0; c < mesh.corners(); ++c)
    if (const float error = report.errors_deg[c]; !std::isnan(error))
      errors[static_cast<std::size_t>(classes[mesh.triangles[c / 3][c % 3]])].push_back(error);
  std::size_t seen = 0;
  for (const ClassReport& c : report.classes) {
    const auto& of_class = errors[static_cast<std::size_t>(c.vertex_class)];
    seen += of_class.size();
    if (report.reference == ReferenceKind::triangles) {  // only what lies outside their cones
      for (const float e : of_class)
        EXPECT_TRUE(e > 0 && e <= static_cast<float>(report.triangles->worst_deg));
      continue;
    }
    ASSERT_EQ(of_class.empty(), !assessed(c, mesh).has_value());
    if (of_class.empty()) continue;
    double squares = 0;
    for (const float e : of_class) squares += static_cast<double>(e) * e;
    const Statistics& s = *assessed(c, mesh);
    EXPECT_EQ(*std::max_element(of_class.begin(), of_class.end()), static_cast<float>(s.max));
    // Each error is rounded by 2^-24 at most.
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(of_class.size())), s.rms, 1e-7 * s.rms);
  }
  std::size_t all = 0;
  for (const auto& of_class : errors) all += of_class.size();
  EXPECT_EQ(seen, all) << "a corner of a class that the report leaves out";
}

TEST(KeptErrors, StatisticsAreOfThem) {
  constexpr std::uint64_t seed = 71;
  std::cout << "seed " << seed << '\n';
  std::mt19937_64 random(seed);
  int references_seen = 0;
  for (const char* kind : {"sphere", "torus", "cylinder", "cone", "plane", "helicoid"})
    for (const bool tangents : {true, false})
      for (const References references :
           {References{true, true, true, true}, References{false, false, true, false},
            References{false, true, false, false}, References{false, false, false, true}}) {
        Mesh mesh = sample_mesh(make_surface(kind), {.columns = 24, .rows = 13, .jitter = 0.25});
        spoil(mesh, random);
        place(mesh, random_pose(random, 1));
        mesh.tangents[40] = {0, 0, 0, 1};
        mesh.tangents[41].x = std::numeric_limits<double>::quiet_NaN();
        if (!tangents) mesh.tangents.clear();
        const Assessment assessment = assess(mesh, keeping(references));
        SCOPED_TRACE(std::string(kind) + " by " +
                     std::string(reference_names[static_cast<std::size_t>(assessment.report.reference)]));
        std::vector<bool> is_pole;
        if (assessment.report.reference == ReferenceKind::analytic)
          for (const Truth& t : truths(mesh, *assessment.fit)) is_pole.push_back(t.pole);
        references_seen += assessment.report.reference != ReferenceKind::none;
        expect_same_statistics(mesh, classify(mesh, is_pole).of_vertex, assessment.report);
        if (assessment.report.reference == ReferenceKind::triangles) {
          EXPECT_EQ(static_cast<std::size_t>(std::count_if(assessment.report.errors_deg.begin(),
                                                           assessment.report.errors_deg.end(),
                                                           [](float e) { return !std::isnan(e); })),
                    assessment.report.triangles->outside);
        }
        // At vertices 40 and 41 nothing is compared.
        if (!tangents) continue;
        for (std::size_t c = 0; c < mesh.corners(); ++c)
          if (const std::uint32_t v = mesh.triangles[c / 3][c % 3]; v == 40 || v == 41) {
            EXPECT_TRUE(std::isnan(assessment.report.errors_deg[c]));
          }
      }
  EXPECT_EQ(references_seen, 6 * (4 + 2))
      << "without tangents there is nothing for MikkTSpace and the triangles";
}

// Against a truth that is given the errors are the angles themselves.
TEST(KeptErrors, AreTheAnglesToTheTruth) {
  std::mt19937_64 random(72);
  const PlacedSurface placed{make_surface("torus:major_radius=1,minor_radius=0.4")};
  Mesh mesh = sample_mesh(placed.surface, {.columns = 20, .rows = 11});
  spoil(mesh, random);
  ValidateOptions options;
  options.keep_errors = true;
  for (const bool tangents : {true, false}) {
    if (!tangents) mesh.tangents.clear();
    const MeshReport report = validate(mesh, placed, options);
    for (std::size_t c = 0; c < mesh.corners(); ++c) {
      const std::uint32_t v = mesh.triangles[c / 3][c % 3];
      const Truth truth = placed.truth(mesh.uvs[v]);
      const double angle = tangents ? angle_between(mesh.tangents[v].xyz(), truth.tangent)
                                    : angle_between(mesh.normals[v], truth.normal);
      // Rounded to float once, and once more here in the angle's last digits.
      EXPECT_NEAR(report.errors_deg[c], angle * 180 / std::numbers::pi, 1e-5);
    }
  }
}

// Parts share out the triangles, and each keeps the errors of its own: those at the vertex its report calls
// the worst, too.
TEST(KeptErrors, PartsShareOutTheTriangles) {
  std::mt19937_64 random(73);
  Mesh mesh;
  for (const char* kind : {"torus", "sphere", "plane", "torus"}) {
    Mesh one = sample_mesh(make_surface(kind), {.columns = 24, .rows = 12});
    spoil(one, random);
    place(one, random_pose(random, 5));
    append(mesh, one);
  }
  // The triangles of the surfaces in turn, so that no part has a run of them.
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  const std::vector<Assessment> assessments = assess_parts(mesh, keeping());
  ASSERT_EQ(assessments.size(), 4u);
  std::vector<int> covered(mesh.triangles.size(), 0);
  for (const Assessment& j : assessments) {
    SCOPED_TRACE("part " + std::to_string(*j.part));
    ASSERT_EQ(3 * j.triangles.size(), j.report.corners);
    ASSERT_EQ(j.report.errors_deg.size(), j.report.corners);
    EXPECT_TRUE(std::is_sorted(j.triangles.begin(), j.triangles.end()));
    for (const std::uint32_t t : j.triangles) ++covered.at(t);
    double largest = 0, squares = 0, of_report = 0, at_worst = -1;
    for (std::size_t c = 0; c < j.report.corners; ++c) {
      const double e = j.report.errors_deg[c];
      ASSERT_FALSE(std::isnan(e));
      largest = std::fmax(largest, e);
      squares += e * e;
    }
    double most = 0;
    std::uint32_t worst = 0;
    for (const ClassReport& c : j.report.classes) {
      of_report += static_cast<double>(c.corners) * c.tangent_deg->rms * c.tangent_deg->rms;
      if (c.tangent_deg->max <= most) continue;
      most = c.tangent_deg->max;
      worst = c.worst->vertex;
    }
    EXPECT_EQ(static_cast<float>(largest), static_cast<float>(most));
    EXPECT_NEAR(squares, of_report, 1e-6 * of_report);
    for (std::size_t c = 0; c < j.report.corners; ++c)
      if (mesh.triangles[j.triangles[c / 3]][c % 3] == worst) at_worst = j.report.errors_deg[c];
    EXPECT_EQ(at_worst, largest);
  }
  EXPECT_EQ(covered, std::vector<int>(mesh.triangles.size(), 1));
}

// A fold whose vertices are shared: nothing is compared there, and the report counts those corners.
TEST(KeptErrors, SharedCreasesHaveNone) {
  Mesh mesh = sample_mesh(make_surface("plane"), {.columns = 8, .rows = 8});
  for (auto& p : mesh.positions)
    if (p.x > 0) p = {0, p.y, -p.x};
  for (const Assessment& j : assess_parts(mesh, keeping())) {
    std::size_t nothing = 0, shared = 0;
    for (const float e : j.report.errors_deg) nothing += std::isnan(e);
    for (const Finding& f : j.report.findings)
      if (f.code == "CREASE_SHARED") shared = f.count;
    EXPECT_GT(shared, 0u);
    EXPECT_EQ(nothing, shared);
  }
}

TEST(KeptErrors, OnlyWhereAskedFor) {
  const Mesh mesh = sample_mesh(make_surface("torus"), {.columns = 12, .rows = 8});
  const Assessment assessment = assess(mesh);
  EXPECT_TRUE(assessment.report.errors_deg.empty());
  EXPECT_TRUE(assessment.triangles.empty());
  EXPECT_FALSE(assessment.part.has_value());
}

}  // namespace
}  // namespace darboux::kept_errors_test
