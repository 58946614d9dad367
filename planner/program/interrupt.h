// Lets a plan ask whether Ctrl-C or a similar signal (ending_signals.h) has come.
#pragma once

namespace fjr {

// Makes the first of these signals only set the flag; the second one ends the program as usual.
void catch_interrupts();
bool interrupted();

}  // namespace fjr
