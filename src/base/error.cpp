#include <darboux/error.h>

#include "text.h"

namespace darboux {

Error::Error(const std::string& subject, const std::string& message)
    : std::runtime_error(message_line(subject, message)) {}

}  // namespace darboux
