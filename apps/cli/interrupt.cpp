#include "interrupt.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <limits>
#include <system_error>

namespace resilin::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds same_request{500};  ///< a second signal within this repeats the first

std::atomic<int> interrupted = 0;  ///< by this signal
std::atomic<Clock::rep> first_time = std::numeric_limits<Clock::rep>::max() / 2;
sigset_t listened_to;

bool is_ignored(int number) {
  struct sigaction action = {};
  return sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

/// As if nobody had caught it.
void die_of(int number) {
  std::signal(number, SIG_DFL);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, number);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  std::raise(number);
}

/// In the listening thread, or in the handler of one that was there before.
void note_interrupt(int number) {
  const int error = errno;
  int none = 0;
  if (interrupted.compare_exchange_strong(none, number)) {
    first_time = Clock::now().time_since_epoch().count();
    interrupted.notify_all();
  } else if (number != SIGHUP &&
             Clock::now().time_since_epoch() - Clock::duration(first_time) > same_request) {
    die_of(number);
  }
  errno = error;
}

/// Takes no memory: there may be none.
void* listen(void*) {
  for (int number = 0; sigwait(&listened_to, &number) == 0;) note_interrupt(number);
  return nullptr;
}

void start_listening() {
  constexpr std::size_t stack_bytes = std::size_t{256} << 10;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, stack_bytes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_t thread{};
  const int error = pthread_create(&thread, &attributes, listen, nullptr);
  pthread_attr_destroy(&attributes);
  if (error != 0) throw std::system_error(error, std::generic_category());
}

}  // namespace

// A thread of its own waits for signals that others block. Handlers alone would not do: METIS puts its own in
// the place of ours while it works, takes SIGTERM for an error of its own and forgets it.
void catch_interrupts() {
  sigemptyset(&listened_to);
  for (const int number : {SIGINT, SIGTERM}) sigaddset(&listened_to, number);
  if (!is_ignored(SIGHUP)) sigaddset(&listened_to, SIGHUP);
  struct sigaction action = {};
  action.sa_handler = note_interrupt;
  action.sa_flags = SA_RESTART;
  action.sa_mask = listened_to;
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (sigismember(&listened_to, number) == 1) sigaction(number, &action, nullptr);
  pthread_sigmask(SIG_BLOCK, &listened_to, nullptr);
  start_listening();
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

void wait_for_interrupt() { interrupted.wait(0); }

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
