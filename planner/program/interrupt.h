// Ctrl-C and its like (ending_signals.h) as a question a plan can ask.
#pragma once

namespace fjr {

// From now on the first of these signals only sets the flag; one that comes again ends the program as usual.
void catch_interrupts();
bool interrupted();

}  // namespace fjr
