// Solvers of Ceres that fail say so to their caller alone.
#include "fit/common/solve_quietly.h"

#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

namespace darboux::test::solve_quietly_test {
namespace {

// With derivatives whose squares overflow: scaled by them, no step is left.
class TooSteep : public ceres::SizedCostFunction<1, 1> {
 public:
  bool Evaluate(const double* const* x, double* residuals, double** jacobians) const override {
    residuals[0] = x[0][0] - 1;
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = 1e200;
    return true;
  }
};

TEST(SolveQuietly, NothingIsPrintedWhereStepsStayInvalid) {
  for (const int most : {5, 10}) {
    double x = 0;
    ceres::Problem problem;
    problem.AddResidualBlock(new TooSteep, nullptr, &x);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_consecutive_invalid_steps = most;
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const ceres::Solver::Summary summary = solve_quietly(options, problem);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_FALSE(summary.IsSolutionUsable());
    EXPECT_EQ(summary.num_unsuccessful_steps, most);
    EXPECT_EQ(x, 0);
  }
}

}  // namespace
}  // namespace darboux::test::solve_quietly_test
