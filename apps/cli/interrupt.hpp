#pragma once

#include <string>

namespace resilin::cli {

/// From now on Ctrl-C (SIGINT), SIGTERM and SIGHUP (the terminal is closed) only set a flag. SIGINT or
/// SIGTERM once more ends the program at once, unless it is the same request that comes twice, as from
/// `timeout`. SIGHUP stays ignored where the program was started so (nohup).
///
/// Threads made later leave the signals alone, as do programs that are started unless they are given an empty
/// signal mask. Threads that are there already must not be in METIS when one comes.
void catch_interrupts();
bool is_interrupted();
/// Who has interrupted: "the user", "SIGTERM".
std::string interrupter();
/// Sleeps until then.
void wait_for_interrupt();

/// Output that nobody reads (SIGPIPE) or that would be too long (SIGXFSZ) gives an
/// error in words, not the end of the process; and no file takes the place of a standard stream that is
/// closed.
void report_failed_writes();
/// Takes that back, for a program that is to take this one's place.
void die_of_failed_writes();

}  // namespace resilin::cli
