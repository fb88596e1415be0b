/// \file refusal_of.h
/// What a refusal says.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include <darboux/error.h>

namespace darboux::test {

/// The message of the E that f() throws, "accepted" where it throws none.
template <class E = ParameterError, class F>
std::string refusal_of(F&& f) {
  try {
    f();
  } catch (const E& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace darboux::test

/// The statement is refused, in these words among others.
#define EXPECT_REFUSED(statement, words)                                                    \
  EXPECT_NE(::darboux::test::refusal_of([&] { statement; }).find(words), std::string::npos) \
      << ::darboux::test::refusal_of([&] { statement; })
