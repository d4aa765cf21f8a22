#include "turns.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

namespace resilin::python {
namespace {

constexpr auto between_looks = std::chrono::milliseconds(50);  // for Ctrl-C

}  // namespace

void Turns::begin(Kind kind) {
  std::unique_lock lock(mutex_);
  if (is_mine()) {
    // Such as a signal handler: what it would see is neither the state before the step nor the one after.
    if (!is_open_ || kind == Kind::change)
      throw std::runtime_error(
          "simulation: expected a call between its steps, got one from inside a step; call when it is done");
    ++depth_;
    return;
  }
  const std::uint64_t number = ++last_number_;
  waiting_.push_back({number, kind});
  while (!is_next(number)) {
    lock.unlock();
    {
      const nb::gil_scoped_release release;
      std::unique_lock waits(mutex_);
      changed_.wait_for(waits, between_looks, [&] { return is_next(number); });
    }
    const bool is_interrupted = PyErr_CheckSignals() != 0;
    lock.lock();
    if (!is_interrupted) continue;
    std::erase_if(waiting_, [number](const Waiter& waiter) { return waiter.number == number; });
    changed_.notify_all();
    throw nb::python_error();
  }
  take(number);
  depth_ = 1;
}

void Turns::end() {
  const std::lock_guard lock(mutex_);
  if (--depth_ == 0) changed_.notify_all();
}

void Turns::let_others_look() {
  std::unique_lock lock(mutex_);
  const auto looks = [this](const Waiter& waiter) {
    return waiter.kind == Kind::look && waiter.number <= looks_until_;
  };
  const int depth = depth_;
  looks_until_ = last_number_;  // whoever comes later waits for the next pause
  depth_ = 0;
  changed_.notify_all();
  changed_.wait(lock, [&] { return depth_ == 0 && std::ranges::none_of(waiting_, looks); });
  looks_until_ = 0;
  owner_ = std::this_thread::get_id();
  depth_ = depth;
}

void Turns::take(std::uint64_t number) {
  std::erase_if(waiting_, [number](const Waiter& waiter) { return waiter.number == number; });
  owner_ = std::this_thread::get_id();
}

bool Turns::is_next(std::uint64_t number) const {
  if (depth_ > 0) return false;
  if (looks_until_ == 0) return waiting_.front().number == number;
  const auto next = std::ranges::find(waiting_, Kind::look, &Waiter::kind);
  return next != waiting_.end() && next->number == number && number <= looks_until_;
}

}  // namespace resilin::python
