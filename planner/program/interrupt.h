// Ctrl-C and SIGTERM as a question a plan can ask.
#pragma once

namespace fjr {

// From now on the first SIGINT or SIGTERM only sets the flag; a second one ends the program as usual.
void catch_interrupts();
bool interrupted();

}  // namespace fjr
