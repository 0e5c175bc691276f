// What an action says when it is refused; "(accepted)" when it is not.
#pragma once

#include <exception>
#include <functional>
#include <string>

inline std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "(accepted)";
}
