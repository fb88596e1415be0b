#include <string>

#include <darboux/error.h>
#include <darboux/frame.h>
#include <darboux/surface.h>

#include "base/text.h"

namespace darboux {
std::string describe(const Range& permitted, std::string_view name) {
  return shortest(permitted.minimum) + (permitted.minimum_included ? " <= " : " < ") + std::string(name) +
         " < " + shortest(permitted.maximum);
}

void throw_out_of_range(std::string_view subject, std::string_view name, double value,
                        const Range& permitted) {
  throw ParameterError(std::string(subject),
                       std::string(name) + ": " + expected_got(describe(permitted, name), shortest(value)));
}

void throw_refused(std::string_view subject, std::string_view why) {
  throw ParameterError(std::string(subject), std::string(why));
}

void detail::throw_singular_transform() {
  throw ParameterError("transform",
                       expected_got("an invertible map", "a linear part that is singular or not finite"));
}

}  // namespace darboux
