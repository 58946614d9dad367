// What DDS itself has to say, in the program's log.
#pragma once

namespace fjr::dds {

// To be called before DDS is used. A few lines a second at most: others can cause one with every message they send.
void log_as_the_program_does();

}  // namespace fjr::dds
