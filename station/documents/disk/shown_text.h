// A text from a file or a command line as an error line quotes it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace station {

// The text as it was typed, umlauts and all, if it has at most `most` characters; otherwise its beginning and "...".
// What would break the line or the terminal (control characters, bytes that are not UTF-8) is shown as ?.
std::string shown_text(std::string_view text, std::size_t most = 40);

}  // namespace station
