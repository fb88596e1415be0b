#include "solve_quietly.h"

#include <limits>

#include <ceres/iteration_callback.h>

namespace darboux {
namespace {

class InvalidSteps : public ceres::IterationCallback {
 public:
  explicit InvalidSteps(int most) : most_(most) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    consecutive_ = step.step_is_valid ? 0 : consecutive_ + 1;
    return consecutive_ < most_ ? ceres::SOLVER_CONTINUE : ceres::SOLVER_ABORT;
  }

 private:
  int most_, consecutive_ = 0;
};

}  // namespace

ceres::Solver::Summary solve_quietly(ceres::Solver::Options options, ceres::Problem& problem) {
  InvalidSteps invalid_steps(options.max_num_consecutive_invalid_steps);
  options.max_num_consecutive_invalid_steps = std::numeric_limits<int>::max();
  options.callbacks.push_back(&invalid_steps);
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

}  // namespace darboux
