#include "base/student_t.h"

#include <boost/math/distributions/students_t.hpp>

namespace darboux {

double student_t(double probability, double freedom) {
  return boost::math::quantile(boost::math::students_t(freedom), probability);
}

}  // namespace darboux
