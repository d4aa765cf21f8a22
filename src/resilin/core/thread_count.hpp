#pragma once

namespace resilin {

/// The most threads that users may ask for: on the command line, in Python, and by the environment variable
/// RESILIN_THREADS, which takes the place of all cores. `num_threads` (core/parallel.hpp) throws InputError
/// where that is no whole number from 1 to so many.
constexpr int max_threads = 1024;

}  // namespace resilin
