#pragma once

#include <exception>
#include <gtest/gtest.h>
#include <string>

#include "core/error.h"

namespace aerate::test {

// What `f` throws, if that is an E; otherwise fails the test. The message and the hint in one text.
template <typename E, typename F>
std::string message_of(const F& f) {
  try {
    f();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const E& error) {
    return std::string(error.what()) + " | " + error.hint();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception: " << error.what();
  }
  return {};
}

// For use as EXPECT_TRUE(contains(text, part)), so that a failure shows both.
inline testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "'" << part << "' is not in: " << text;
}

}  // namespace aerate::test
