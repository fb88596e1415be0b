/// \file sanitized.h
/// What a build under a sanitizer cannot show: its runtime has an address space of terabytes, keeps what was
/// freed, replaces the allocator, and wants to be loaded before all other libraries.
#pragma once

#include <gtest/gtest.h>

#include "base/sanitized.h"

/// Skips the rest of a test under a sanitizer, with a message. \param why it cannot hold there
#define DARBOUX_SKIP_IF_SANITIZED(why) \
  if (darboux::sanitized) GTEST_SKIP() << "under a sanitizer " << why
