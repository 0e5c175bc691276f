// The rule for names that may become files of a session: a whitelist, so that no name leaves the session's folder,
// hides there, or means something else on another system.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace station {

// Returns one line that says why `name` may not be used, or nothing when it may. Allowed are 1 to 100 ASCII letters,
// digits and the signs . _ - without "..", not beginning with a dot or dash, not ending with a dot, and none of the
// names that Windows keeps for devices.
std::optional<std::string> problem_with_name(std::string_view name);

// A text (UTF-8) as the name of a file or folder: ASCII letters, digits and _ are kept, letters of other alphabets are
// written in Latin ones as Germans do ("Weiße Größe" is Weisse-Groesse), what has no letters as its code ("u1f9f6"),
// and others between them become one -. The name may still be empty or too long.
std::string safe_name(const std::string& text);

}  // namespace station
