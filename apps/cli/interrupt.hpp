#pragma once

namespace resilin::cli {

/// From now on Ctrl-C (SIGINT) and SIGTERM only set a flag; a second one ends the program at once.
void catch_interrupts();
bool is_interrupted();
/// Sleeps until then.
void wait_for_interrupt();

}  // namespace resilin::cli
