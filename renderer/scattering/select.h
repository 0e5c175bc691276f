// A choice between two values in a formula that serves single numbers and packets alike (packet.h has its own select).
#pragma once

namespace renderer {

// Returns `yes` where the condition holds, else `no`; both are computed.
template <class S>
S select(bool condition, const S& yes, const S& no) {
  return condition ? yes : no;
}

}  // namespace renderer
