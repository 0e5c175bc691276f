// A choice in a formula that serves single numbers and packets (packet.h, which has its own) alike.
#pragma once

namespace renderer {

// `yes` where the condition holds, else `no`; both are computed.
template <class S>
S select(bool condition, const S& yes, const S& no) {
  return condition ? yes : no;
}

}  // namespace renderer
