// The message with which an action is refused, which must be one line.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace station_test {

template <typename Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

}  // namespace station_test
