// Ceres, without its line on standard error about invalid steps.
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace darboux {

// ceres::Solve. Its own limit on consecutive invalid steps logs an error whatever the logging type; here the
// limit of the options is enforced instead. \return a summary that is not usable if that limit is reached
ceres::Solver::Summary solve_quietly(ceres::Solver::Options options, ceres::Problem& problem);

}  // namespace darboux
