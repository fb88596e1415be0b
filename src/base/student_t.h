// Student's t distribution.
#pragma once

namespace darboux {

// The value that t with `freedom` > 0 degrees of freedom is below with this probability.
double student_t(double probability, double freedom);

}  // namespace darboux
