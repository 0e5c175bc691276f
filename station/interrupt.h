// Ctrl-C and SIGTERM as a question that long work asks between steps.
#pragma once

namespace station {

void watch_interrupts();  // from now on a first ctrl-C only sets the flag; a second one ends the program as usual
bool interrupted();

}  // namespace station
