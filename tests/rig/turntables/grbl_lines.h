// Lines that GRBL 1.1 says.
#pragma once

inline const char* const kBanner = "Grbl 1.1h ['$' for help]";
inline const char* const kUnlock = "[MSG:'$H'|'$X' to unlock]";
