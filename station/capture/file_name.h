// Which names may become files of a session: a whitelist, so that no name leaves the session's folder, hides there,
// or means something else on another system.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace station {

// One clear line when `name` may not be used: ASCII letters, digits and . _ - only, 1 to 100 of them, neither
// beginning with a dot or dash nor ending with a dot, without "..", and none of the names that Windows keeps for
// devices.
std::optional<std::string> problem_with_name(std::string_view name);

}  // namespace station
