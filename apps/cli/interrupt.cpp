#include "interrupt.hpp"

#include <semaphore.h>

#include <cerrno>
#include <csignal>

namespace resilin::cli {
namespace {

// A signal handler has nowhere else to put what it knows.
volatile std::sig_atomic_t interrupted = 0;
sem_t interrupts;

void note_interrupt(int) {
  interrupted = 1;
  const int error = errno;
  sem_post(&interrupts);
  errno = error;
}

}  // namespace

void catch_interrupts() {
  sem_init(&interrupts, 0, 0);
  struct sigaction action = {};
  action.sa_handler = note_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool is_interrupted() { return interrupted != 0; }

void wait_for_interrupt() {
  while (!is_interrupted()) sem_wait(&interrupts);
}

}  // namespace resilin::cli
