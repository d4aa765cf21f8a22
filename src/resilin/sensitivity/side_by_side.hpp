#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace resilin {

/// Runs `task(i)` for i in [0, count), several at once, each alone on its share of the threads: independent
/// computations whose own loops are short. While one such call goes on, others in the same process do their
/// tasks one after another.
///
/// An exception of a task ends the call, once the running tasks are through. Among several the task of the
/// lowest number decides, whatever the number of threads.
/// @param goes_on  asked by the calling thread every 20 ms
/// @param stops    becomes true when it says no; for tasks to look at, in which Interrupted is then due
/// @throws Interrupted  once stopped
void run_side_by_side(std::size_t count, const std::function<void(std::size_t)>& task,
                      const std::function<bool()>& goes_on, std::atomic<bool>& stops);

}  // namespace resilin
