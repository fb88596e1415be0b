// Student's t distribution.
#pragma once

namespace darboux {

// The quantile of Student's t with `freedom` > 0 degrees of freedom at this probability.
double student_t(double probability, double freedom);

}  // namespace darboux
