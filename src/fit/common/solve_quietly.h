// Ceres, without its line on standard error about invalid steps.
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace darboux {

// ceres::Solve. Its own limit on consecutive invalid steps logs an error whatever the logging type; the limit
// of the options is kept here in its place. \return a summary that is not usable where that limit is reached
ceres::Solver::Summary solve_quietly(ceres::Solver::Options options, ceres::Problem& problem);

}  // namespace darboux
