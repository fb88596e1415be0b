// What evaluate() is asked for: requests that cannot be right are refused, the instruction set is that of the
// environment.
#include <array>
#include <cstdlib>
#include <iostream>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <darboux/catalogue.h>
#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/local_jets.h>
#include <darboux/local_truth.h>
#include <darboux/sample_mesh.h>

#include "refusal_of.h"

namespace darboux::test::requests_test {
namespace {

TEST(Refusals, NameTheAttributeAndWhatIsPermitted) {
  std::vector<double> x(12);
  const std::span<double> span(x), none(static_cast<double*>(nullptr), 4);
  EXPECT_REFUSED(Outputs<double>().separate(Attribute::normal, {span, span}),
                 "normal: expected an array for each of its 3 components, got 2");
  EXPECT_REFUSED(Outputs<double>().separate(Attribute::normal, {span, none, span}),
                 "normal: expected an array, got null");
  EXPECT_REFUSED(Outputs<double>().member(Attribute::normal, x.data(), 2, 16),
                 "normal: expected a stride that is a multiple of 8 bytes and at least 24, got 16");
  EXPECT_REFUSED(Outputs<double>().member(Attribute::normal, x.data(), 2, 30), "at least 24, got 30");
  EXPECT_REFUSED(Outputs<double>().member(Attribute::normal, x.data(), 2, -24), "at least 24, got -24");
  EXPECT_REFUSED(Outputs<double>().packed(Attribute::normal, span.first(11)),
                 "normal: expected a multiple of 3 packed values, got 11");
  EXPECT_REFUSED(Outputs<double>().packed(Attribute::normal, span).packed(Attribute::normal, span),
                 "asked for twice");
  std::array<char, 64> bytes{};
  auto* const misaligned = reinterpret_cast<double*>(bytes.data() + 1);
  EXPECT_REFUSED(Outputs<double>().member(Attribute::normal, misaligned, 1, 24),
                 "normal: expected its array at a multiple of 8 bytes");
  EXPECT_REFUSED(Outputs<double>().status(nullptr, 2, 4), "status: expected an array, got null");
  std::vector<Status> status(4);
  EXPECT_REFUSED(Outputs<double>().status(status.data(), 2, 3),
                 "status: expected a stride that is a multiple of 4 bytes and at least 4, got 3");
}

TEST(Refusals, OfPoints) {
  const std::vector<double> two(2), three(3);
  EXPECT_REFUSED(Points<double>::arrays(two, three), "got 2 of u and 3 of v");
  EXPECT_REFUSED(Points<double>::interleaved(three), "expected an even number of interleaved values, got 3");
  EXPECT_REFUSED(Points<double>::interleaved(two.data(), 2, 8), "at least 16, got 8");
  EXPECT_REFUSED(Points<double>::interleaved(nullptr, 2, 16), "expected an array of pairs, got null");
  EXPECT_REFUSED(Points<double>::grid(0, 3), "got 0 columns");
  EXPECT_REFUSED(Points<double>::grid(3, std::size_t{1} << 40), "expected 1 to");
  EXPECT_REFUSED(Points<double>::grid(3, 3, 5), "expected a row of points from 0 to 3, got 5");
  EXPECT_REFUSED(Points<double>::part_of_grid(4, 3, 3, 2, 0, 3),
                 "expected some of 4 columns, got 2 from 3 on");
  EXPECT_REFUSED(Points<double>::part_of_grid(4, 3, 0, 4, 1, 0), "expected some of 3 rows, got 0 from 1 on");
  EXPECT_REFUSED(Points<double>::arrays(two, two).part(1, 2), "2 points from 1 on");
  EXPECT_EQ(Points<double>::grid(131071, 65535).size(), std::size_t{1} << 33);
}

TEST(Refusals, NothingIsWrittenWhenThereIsNoRoom) {
  const std::vector<double> u(5, 0.3);
  std::vector<double> p(15, 7), n(12, 7);
  Outputs<double> outputs;
  outputs.packed(Attribute::position, p).packed(Attribute::normal, n);
  const auto points = Points<double>::arrays(u, u);
  EXPECT_REFUSED(evaluate(Torus{}, points, outputs), "normal: expected room for 5 points, got 4");
  std::vector<Status> status(3);
  Outputs<double> with_status;
  with_status.packed(Attribute::position, p).status(status);
  EXPECT_REFUSED(evaluate(Torus{}, points, with_status), "status: expected room for 5 points, got 3");
  EXPECT_REFUSED(evaluate(Torus{}, points.part(0, 1), outputs, {.threads = -1}),
                 "threads: expected 0 (all) or more, got -1");
  EXPECT_EQ(p, std::vector<double>(15, 7));
  EXPECT_EQ(n, std::vector<double>(12, 7));
}

// A part of a grid has the bits of the whole, and those of its points one by one.
TEST(Grids, PartsAreLikeTheWhole) {
  constexpr std::size_t columns = 37, rows = 19;
  const auto normals = [](const Points<double>& points) {
    std::vector<double> n(3 * points.size());
    Outputs<double> outputs;
    outputs.packed(Attribute::normal, n);
    evaluate(Torus{}, points, outputs);
    return n;
  };
  const std::vector<double> whole = normals(Points<double>::grid(columns, rows));
  for (const auto& [first_column, cells_u, first_row, cells_v] : {std::array<std::size_t, 4>{0, 37, 0, 19},
                                                                  {5, 16, 3, 8},
                                                                  {36, 1, 18, 1},
                                                                  {0, 1, 7, 12},
                                                                  {9, 28, 0, 2}}) {
    const auto part = Points<double>::part_of_grid(columns, rows, first_column, cells_u, first_row, cells_v);
    ASSERT_EQ(part.size(), (cells_u + 1) * (cells_v + 1));
    const std::vector<double> n = normals(part);
    std::vector<double> u, v;
    for (std::size_t i = 0; i < part.size(); ++i) {
      u.push_back(part[i].x);
      v.push_back(part[i].y);
    }
    EXPECT_EQ(n, normals(Points<double>::arrays(u, v)));
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::size_t column = first_column + i % (cells_u + 1), row = first_row + i / (cells_u + 1);
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_EQ(n[3 * i + c], whole[3 * (row * (columns + 1) + column) + c]) << column << ' ' << row;
    }
  }
}

TEST(Refusals, ZeroPointsAreNone) {
  Outputs<double> outputs;
  outputs.packed(Attribute::position, {}).status({});
  const StatusSummary summary = evaluate(Torus{}, Points<double>::arrays({}, {}), outputs);
  EXPECT_EQ(summary.points, 0U);
  EXPECT_TRUE(summary.all_regular());
  EXPECT_EQ(evaluate(Torus{}, Points<double>::interleaved(std::span<const double>()), outputs).points, 0U);
  EXPECT_EQ(evaluate(Torus{}, Points<double>::grid(3, 3, 1, 0), outputs).points, 0U);
}

TEST(InstructionSets, AreChosenByTheEnvironment) {
  const std::vector<double> u(40, 0.3);
  std::vector<double> n(120);
  Outputs<double> outputs;
  outputs.packed(Attribute::normal, n);
  const auto points = Points<double>::arrays(u, u);
  for (const InstructionSet set : instruction_sets()) {
    ASSERT_EQ(::setenv("DARBOUX_ISA", std::string(name_of(set)).c_str(), 1), 0);
    EXPECT_EQ(refusal_of([&] { evaluate(Torus{}, points, outputs); }), "accepted") << name_of(set);
    EXPECT_EQ(chosen_instruction_set(), set);
    EXPECT_EQ(evaluate(Torus{}, points, outputs).point_by_point, set == InstructionSet::points ? 40U : 0U);
  }
  ASSERT_EQ(::setenv("DARBOUX_ISA", "altivec", 1), 0);
  EXPECT_REFUSED(evaluate(Torus{}, points, outputs),
                 "DARBOUX_ISA: expected one that this machine and build have (points");
  EXPECT_REFUSED(uv_jets({{{0, 0, 0}}, {}, {{0, 0}}}, {.neighbours = 10}),
                 "DARBOUX_ISA: expected one that this machine and build have (points");
  EXPECT_REFUSED(local_truth(sample_mesh(make_surface("torus"), {.columns = 9, .rows = 9})),
                 "DARBOUX_ISA: expected one that this machine and build have (points");
  EXPECT_EQ(
      refusal_of([&] { evaluate(Torus{}, points, outputs, {.instruction_set = InstructionSet::points}); }),
      "accepted");
  ASSERT_EQ(::unsetenv("DARBOUX_ISA"), 0);
  EXPECT_EQ(chosen_instruction_set(), instruction_sets().back());
  EXPECT_REFUSED(evaluate(Torus{}, points, outputs, {.instruction_set = static_cast<InstructionSet>(77)}),
                 "(points");
  std::cout << "instruction sets:";
  for (const InstructionSet set : instruction_sets()) std::cout << ' ' << name_of(set);
  std::cout << '\n';
#if defined(__x86_64__) || defined(__aarch64__)
  EXPECT_GE(instruction_sets().size(), 2U) << "the kernels of the baseline are missing";
#endif
}

TEST(Summaries, AddUp) {
  StatusSummary first, second;
  first.points = 10;
  first.count[0] = 2;
  first.first[0] = 3;
  second.points = 5;
  second.count[0] = 1;
  second.first[0] = 4;
  second.count[1] = 1;
  second.first[1] = 2;
  first += second;
  EXPECT_EQ(first.points, 15U);
  EXPECT_EQ(first.count[0], 3U);
  EXPECT_EQ(first.first[0], 3U);
  EXPECT_EQ(first.first[1], 12U);
}

}  // namespace
}  // namespace darboux::test::requests_test
