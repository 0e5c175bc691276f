#pragma once

#include <exception>
#include <functional>
#include <string>

namespace station {

// The message that `action` throws; "" when it throws nothing.
inline std::string message_of(const std::function<void()>& action) {
  try {
    action();
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace station
