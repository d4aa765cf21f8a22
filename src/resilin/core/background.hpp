#pragma once

#include <functional>
#include <future>

namespace resilin {

/// Calls `job` in a thread of its own, whose loops use no other, and returns at once. Calls it here and now
/// where loops have one thread alone, where the address space is limited, and where no thread is to be had.
/// What `job` throws comes with the future, whose end waits for it.
std::future<void> run_beside(std::function<void()> job);

}  // namespace resilin
