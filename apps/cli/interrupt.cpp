#include "interrupt.hpp"

#include <fcntl.h>
#include <semaphore.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>

namespace resilin::cli {
namespace {

constexpr double same_request = 0.5;  ///< [s]: a second signal within this repeats the first

// A signal handler has nowhere else to put what it knows.
volatile std::sig_atomic_t interrupted = 0;  ///< by this signal
timespec interrupt_time;
sem_t interrupts;

timespec now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time;
}

double seconds_since(const timespec& start) {
  const timespec end = now();
  return static_cast<double>(end.tv_sec - start.tv_sec) +
         1e-9 * static_cast<double>(end.tv_nsec - start.tv_nsec);
}

void note_interrupt(int number) {
  const int error = errno;
  if (interrupted == 0) {
    interrupted = number;
    interrupt_time = now();
    sem_post(&interrupts);
  } else if (number != SIGHUP && seconds_since(interrupt_time) > same_request) {
    std::signal(number, SIG_DFL);
    std::raise(number);  // comes when this handler is left
  }
  errno = error;
}

bool is_ignored(int number) {
  struct sigaction action = {};
  return sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void catch_interrupts() {
  sem_init(&interrupts, 0, 0);
  struct sigaction action = {};
  action.sa_handler = note_interrupt;
  action.sa_flags = SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&action.sa_mask, number);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  if (!is_ignored(SIGHUP)) sigaction(SIGHUP, &action, nullptr);
}

bool is_interrupted() { return interrupted != 0; }

std::string interrupter() {
  switch (interrupted) {
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    default:
      return "the user";
  }
}

void wait_for_interrupt() {
  while (!is_interrupted()) sem_wait(&interrupts);
}

void report_failed_writes() {
  for (const int number : {SIGPIPE, SIGXFSZ}) std::signal(number, SIG_IGN);
  // Opened for the other direction, so that whoever uses the closed stream hears of it.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      static_cast<void>(::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) == stream);
}

void die_of_failed_writes() {
  for (const int number : {SIGPIPE, SIGXFSZ}) std::signal(number, SIG_DFL);
}

}  // namespace resilin::cli
