// Numbers of many decimal digits from boost, for oracles that share nothing with darboux::Multiprecision.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace darboux::test {

// et_off: without expression templates the formulas' `auto` and return types stay plain numbers.
template <unsigned digits>
using BoostDigits = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<digits>,
                                                  boost::multiprecision::et_off>;
using Boost40 = BoostDigits<40>;

}  // namespace darboux::test
